// The bytes that a glTF file's accessors and images look into.
#pragma once

#include "snell/io/gltf/document.h"
#include "snell/io/reference.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace snell::gltf {

// All buffers in memory, and all buffer views checked against them and, where EXT_meshopt_compression has packed them,
// unpacked. The views' bytes live as long as this and the document.
class Buffers
{
  public:
    // Reads the external buffers and unpacks, in parallel. Throws Error if one is missing or too short.
    Buffers(const Document& document, References& references, Budget& budget);

    // The bytes of a buffer view. Throws Error, beginning with `who`, if there is no such view.
    std::string_view view(int index, const std::string& who) const;

    // All buffers together: a bound for how many elements there can be.
    std::size_t total_bytes() const { return total_bytes_; }

  private:
    void load(References& references, Budget& budget);
    std::string_view range(int buffer, std::size_t offset, std::size_t size, const std::string& who) const;
    void unpack(std::size_t view, Budget& budget);

    const Document& document_;
    std::vector<std::shared_ptr<const std::string>> owned_; // by buffer; null: in the document, or missing
    std::vector<std::string_view> buffers_;
    std::vector<std::string> unpacked_; // by view
    std::vector<std::string_view> views_;
    std::size_t total_bytes_ = 0;
};

// The file that a URI of the scene means: as it is written or, if there is no such file, percent-decoded.
std::filesystem::path find_file(const std::string& uri, const std::string& place, References& references);

} // namespace snell::gltf

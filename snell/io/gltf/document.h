// The structure of a glTF file: its JSON, and where its bytes are.
#pragma once

#include "snell/io/gltf/remarks.h"

#include <tiny_gltf.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace snell::gltf {

struct BufferSource
{
    std::string name, uri;
    std::size_t size = 0; // as the JSON says
};

struct ImageSource
{
    std::string name, uri, mime;
    int view = -1; // buffer view, or -1
};

// tinygltf's model of the JSON, with exceptions: buffers and images are listed here and not loaded, `extras` are left
// out, and an index accessor that holds no data (Draco's) is not named by its primitive.
struct Document
{
    std::filesystem::path file;
    std::string bytes;       // of the file
    bool has_binary = false; // whether a GLB has a binary chunk
    std::string_view binary; // that chunk, in `bytes`
    tinygltf::Model model;
    std::vector<BufferSource> buffers;
    std::vector<ImageSource> images;

    Document() = default;
    Document(const Document&) = delete; // `binary` looks into `bytes`
    Document& operator=(const Document&) = delete;
};

// Reads the file and its JSON. What must be an index of another part need not be one yet. Throws Error.
void read_document(Document& document, const std::filesystem::path& file, Remarks& remarks);

// Refuses what extensionsRequired has beyond what is known, and warns of what extensionsUsed has.
void check_extensions(const Document& document, Remarks& remarks);

// For messages: "material 3 'Gold'".
std::string label(const char* what, std::size_t number, const std::string& name);

// all[index], or an Error: "<who> refers to <what> 7, but there are 3".
template <class T>
T& checked(std::vector<T>& all, int index, const char* what, const std::string& who)
{
    if (index < 0 || static_cast<std::size_t>(index) >= all.size())
        throw Error(fmt::format("{} refers to {} {}, but there are {}", who, what, index, all.size()),
                    "write the file again");
    return all[static_cast<std::size_t>(index)];
}
template <class T>
const T& checked(const std::vector<T>& all, int index, const char* what, const std::string& who)
{
    return checked(const_cast<std::vector<T>&>(all), index, what, who);
}

// Reads the members of a JSON object as tinygltf keeps it; whatever is missing or of another type is the default.
class Fields
{
  public:
    explicit Fields(const tinygltf::Value* value) : value_(value && value->IsObject() ? value : nullptr) {}
    // The extension of that name; !exists() if there is none.
    Fields(const tinygltf::ExtensionMap& extensions, const char* name);

    bool exists() const { return value_ != nullptr; }
    const tinygltf::Value* find(const char* key) const;
    Fields object(const char* key) const { return Fields(find(key)); }
    double number(const char* key, double otherwise) const;
    int integer(const char* key, int otherwise) const;
    // A byte count or offset: exact up to 2^53. Negative and fractional ones are refused.
    std::size_t size(const char* key, std::size_t otherwise) const;
    std::string text(const char* key) const;
    std::vector<double> numbers(const char* key) const;

  private:
    const tinygltf::Value* value_;
};

} // namespace snell::gltf

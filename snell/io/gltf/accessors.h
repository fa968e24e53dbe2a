// Typed arrays: views of a buffer's bytes as numbers.
#pragma once

#include "snell/core/vec.h"
#include "snell/io/gltf/buffers.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snell::gltf {

// Reads accessors of every component type, with any stride, normalised or not, sparse or not. All sizes are checked
// against the buffer views before memory is touched. An accessor without a view is zeros; it may have no more elements
// than the file's buffers have bytes, and 65,536. `who` begins the Errors.
class Accessors
{
  public:
    Accessors(const Document& document, const Buffers& buffers, Budget& budget);

    const tinygltf::Accessor& info(int index, const std::string& who) const;
    std::size_t count(int index, const std::string& who) const { return info(index, who).count; }

    // One float a component; integers as they are or, where the accessor says so, normalised to [0, 1] or [-1, 1].
    // which: only those elements, each below count(); empty: all.
    std::vector<float> floats(int index, int components, const std::string& who) const;
    std::vector<vec2> vec2s(int index, const std::string& who, std::span<const uint> which = {}) const;
    std::vector<vec3> vec3s(int index, const std::string& who, std::span<const uint> which = {}) const;
    std::vector<vec4> vec4s(int index, const std::string& who, std::span<const uint> which = {}) const;
    // Colours of three or four numbers; without a fourth it is 1.
    std::vector<vec4> colors(int index, const std::string& who, std::span<const uint> which = {}) const;
    // Unsigned integers; triangles() takes three at a time and leaves out what remains.
    std::vector<uint> indices(int index, const std::string& who) const;
    std::vector<uvec3> triangles(int index, const std::string& who) const;
    std::vector<uvec4> joints(int index, const std::string& who, std::span<const uint> which = {}) const;

  private:
    struct Elements
    {
        const char* data; // null: zeros
        std::size_t stride, count;
        int component_type, components;
        bool is_normalized;
    };

    Elements elements(int index, int components, const std::string& who) const;
    template <class Number>
    void read(int index, int components, const std::string& who, std::span<const uint> which, Number* out) const;
    template <class Number>
    void read_sparse(int index, int components, const std::string& who, Number* out) const;
    template <class Vector, class Number>
    std::vector<Vector> vectors(int index, int components, const std::string& who, std::span<const uint> which) const;

    const Document& document_;
    const Buffers& buffers_;
    Budget& budget_;
};

} // namespace snell::gltf

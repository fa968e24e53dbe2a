#include "snell/io/gltf/accessors.h"

#include "snell/core/parallel.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace snell::gltf {
namespace {

[[noreturn]] void fail(const std::string& who, const std::string& what)
{
    throw Error(fmt::format("{}: {}", who, what), "write the file again");
}

std::size_t component_bytes(int type, const std::string& who)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_INT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    case TINYGLTF_COMPONENT_TYPE_DOUBLE:
        return 8;
    default:
        fail(who, fmt::format("component type {} is not known", type));
    }
}

int component_count(int type, const std::string& who)
{
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return 1;
    case TINYGLTF_TYPE_VEC2:
        return 2;
    case TINYGLTF_TYPE_VEC3:
        return 3;
    case TINYGLTF_TYPE_VEC4:
        return 4;
    case TINYGLTF_TYPE_MAT4:
        return 16;
    default:
        fail(who, "matrices of 2 or 3 columns are used nowhere");
    }
}

template <class Source, class Number>
Number convert(Source value, bool is_normalized)
{
    if constexpr (std::is_integral_v<Source> && std::is_floating_point_v<Number>) {
        if (!is_normalized) return static_cast<Number>(value);
        // -128 and -127 are both -1.
        const Number scaled = static_cast<Number>(value) / static_cast<Number>(std::numeric_limits<Source>::max());
        return std::max(scaled, Number{-1});
    } else {
        return static_cast<Number>(value);
    }
}

constexpr std::size_t grain = 1 << 16;

// Elements of `components` numbers, `stride` bytes apart; element i of `out` is number which[i] of them.
template <class Source, class Number>
void copy(const char* data, std::size_t stride, int components, bool is_normalized, std::size_t count,
          std::span<const uint> which, Number* out)
{
    const std::size_t width = static_cast<std::size_t>(components);
    parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
        if (std::is_same_v<Source, Number> && which.empty() && stride == width * sizeof(Source)) {
            std::memcpy(out + begin * width, data + begin * stride, (end - begin) * stride);
            return;
        }
        for (std::size_t i = begin; i < end; ++i) {
            const char* const element = data + stride * (which.empty() ? i : which[i]);
            for (std::size_t k = 0; k < width; ++k) {
                Source value; // may lie anywhere
                std::memcpy(&value, element + k * sizeof(Source), sizeof(Source));
                out[i * width + k] = convert<Source, Number>(value, is_normalized);
            }
        }
    });
}

template <class Number>
void copy_any(int type, const char* data, std::size_t stride, int components, bool is_normalized, std::size_t count,
              std::span<const uint> which, Number* out, const std::string& who)
{
    const auto as = [&]<class Source>(Source) {
        copy<Source, Number>(data, stride, components, is_normalized, count, which, out);
    };
    if constexpr (std::is_floating_point_v<Number>) {
        switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return as(std::int8_t{});
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return as(std::int16_t{});
        case TINYGLTF_COMPONENT_TYPE_INT:
            return as(std::int32_t{});
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return as(float{});
        case TINYGLTF_COMPONENT_TYPE_DOUBLE:
            return as(double{});
        default:
            break;
        }
    }
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return as(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return as(std::uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return as(std::uint32_t{});
    default:
        fail(who, "must have unsigned integers");
    }
}

// Checks that `count` elements fit into the view from `offset` on, and returns where they begin.
const char* place_in(std::string_view view, std::size_t offset, std::size_t count, std::size_t stride,
                     std::size_t element, const std::string& who)
{
    if (count == 0) return view.data();
    const bool has_room = offset <= view.size() && element <= view.size() - offset &&
                          (count - 1) <= (view.size() - offset - element) / stride;
    if (!has_room)
        fail(who, fmt::format("{} elements of {} bytes, {} apart, from byte {} on are more than its buffer view has: "
                              "{} bytes",
                              count, element, stride, offset, view.size()));
    return view.data() + offset;
}

} // namespace

Accessors::Accessors(const Document& document, const Buffers& buffers, Budget& budget)
    : document_(document), buffers_(buffers), budget_(budget)
{
}

const tinygltf::Accessor& Accessors::info(int index, const std::string& who) const
{
    const tinygltf::Accessor& accessor = checked(document_.model.accessors, index, "accessor", who);
    if (accessor.count > std::numeric_limits<std::uint32_t>::max() - 1)
        fail(who, fmt::format("accessor {} has {} elements", index, accessor.count));
    return accessor;
}

Accessors::Elements Accessors::elements(int index, int components, const std::string& who) const
{
    const tinygltf::Accessor& accessor = info(index, who);
    const std::string place = fmt::format("{}, accessor {}", who, index);
    const int given = component_count(accessor.type, place);
    if (given != components) fail(place, fmt::format("has {} numbers an element, not {}", given, components));
    const std::size_t element = component_bytes(accessor.componentType, place) * static_cast<std::size_t>(components);
    Elements out{nullptr, element, accessor.count, accessor.componentType, components, accessor.normalized};
    if (accessor.bufferView < 0) {
        const std::size_t most = std::max<std::size_t>(buffers_.total_bytes(), 65536);
        if (accessor.count > most)
            fail(place, fmt::format("has no buffer view and {} elements; the file's buffers have {} bytes",
                                    accessor.count, buffers_.total_bytes()));
        return out;
    }
    const std::string_view view = buffers_.view(accessor.bufferView, place);
    const std::size_t stride = document_.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
    if (stride != 0 && stride < element)
        fail(place, fmt::format("its elements of {} bytes are {} bytes apart", element, stride));
    if (stride != 0) out.stride = stride;
    out.data = place_in(view, accessor.byteOffset, out.count, out.stride, element, place);
    return out;
}

template <class Number>
void Accessors::read(int index, int components, const std::string& who, std::span<const uint> which, Number* out) const
{
    const Elements source = elements(index, components, who);
    const std::size_t count = which.empty() ? source.count : which.size();
    const std::size_t width = static_cast<std::size_t>(components);
    if (source.data)
        copy_any(source.component_type, source.data, source.stride, components, source.is_normalized, count, which, out,
                 who);
    else
        std::fill_n(out, count * width, Number{0});
}

// Overwrites the elements that the accessor's sparse part gives.
template <class Number>
void Accessors::read_sparse(int index, int components, const std::string& who, Number* out) const
{
    const tinygltf::Accessor& accessor = info(index, who);
    const auto& sparse = accessor.sparse;
    const std::string place = fmt::format("{}, accessor {}, sparse part", who, index);
    if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > accessor.count)
        fail(place, fmt::format("{} elements of {}", sparse.count, accessor.count));
    const std::size_t count = static_cast<std::size_t>(sparse.count), width = static_cast<std::size_t>(components);
    const std::size_t index_bytes = component_bytes(sparse.indices.componentType, place);
    const std::size_t element = component_bytes(accessor.componentType, place) * width;
    budget_.charge(count, 4 + width * sizeof(Number), place + ": ");

    const char* const where =
        place_in(buffers_.view(sparse.indices.bufferView, place), static_cast<std::size_t>(sparse.indices.byteOffset),
                 count, index_bytes, index_bytes, place);
    std::vector<uint> targets(count);
    copy_any(sparse.indices.componentType, where, index_bytes, 1, false, count, {}, targets.data(), place);
    const char* const data =
        place_in(buffers_.view(sparse.values.bufferView, place), static_cast<std::size_t>(sparse.values.byteOffset),
                 count, element, element, place);
    std::vector<Number> values(count * width);
    copy_any(accessor.componentType, data, element, components, accessor.normalized, count, {}, values.data(), place);
    for (std::size_t i = 0; i < count; ++i) {
        if (targets[i] >= accessor.count) fail(place, fmt::format("element {} of {}", targets[i], accessor.count));
        std::copy_n(values.data() + i * width, width, out + targets[i] * width);
    }
}

template <class Vector, class Number>
std::vector<Vector> Accessors::vectors(int index, int components, const std::string& who,
                                       std::span<const uint> which) const
{
    const tinygltf::Accessor& accessor = info(index, who);
    elements(index, components, who); // checked before memory is asked for
    const std::size_t per_vector = static_cast<std::size_t>(components) * sizeof(Number) / sizeof(Vector);
    const auto numbers = [](std::vector<Vector>& all) { return reinterpret_cast<Number*>(all.data()); };
    if (!accessor.sparse.isSparse || which.empty()) {
        const std::size_t count = which.empty() ? accessor.count : which.size();
        budget_.charge(count, per_vector * sizeof(Vector), who + ": ");
        std::vector<Vector> out(count * per_vector);
        read(index, components, who, which, numbers(out));
        if (accessor.sparse.isSparse) read_sparse(index, components, who, numbers(out));
        return out;
    }
    const std::vector<Vector> all = vectors<Vector, Number>(index, components, who, {});
    std::vector<Vector> out;
    out.reserve(which.size() * per_vector);
    for (const uint i : which)
        out.insert(out.end(), all.begin() + static_cast<std::ptrdiff_t>(i * per_vector),
                   all.begin() + static_cast<std::ptrdiff_t>((i + 1) * per_vector));
    return out;
}

std::vector<float> Accessors::floats(int index, int components, const std::string& who) const
{
    return vectors<float, float>(index, components, who, {});
}

std::vector<vec2> Accessors::vec2s(int index, const std::string& who, std::span<const uint> which) const
{
    return vectors<vec2, float>(index, 2, who, which);
}

std::vector<vec3> Accessors::vec3s(int index, const std::string& who, std::span<const uint> which) const
{
    return vectors<vec3, float>(index, 3, who, which);
}

std::vector<vec4> Accessors::vec4s(int index, const std::string& who, std::span<const uint> which) const
{
    return vectors<vec4, float>(index, 4, who, which);
}

std::vector<vec4> Accessors::colors(int index, const std::string& who, std::span<const uint> which) const
{
    if (info(index, who).type == TINYGLTF_TYPE_VEC4) return vec4s(index, who, which);
    std::vector<vec4> out;
    for (const vec3 color : vec3s(index, who, which)) out.emplace_back(color, 1.0f);
    return out;
}

std::vector<uint> Accessors::indices(int index, const std::string& who) const
{
    return vectors<uint, uint>(index, 1, who, {});
}

std::vector<uvec3> Accessors::triangles(int index, const std::string& who) const
{
    const tinygltf::Accessor& accessor = info(index, who);
    elements(index, 1, who); // checked before memory is asked for
    budget_.charge(accessor.count / 3 + 1, sizeof(uvec3), who + ": ");
    std::vector<uvec3> out((accessor.count + 2) / 3);
    read(index, 1, who, {}, reinterpret_cast<uint*>(out.data()));
    if (accessor.sparse.isSparse) read_sparse(index, 1, who, reinterpret_cast<uint*>(out.data()));
    out.resize(accessor.count / 3);
    return out;
}

std::vector<uvec4> Accessors::joints(int index, const std::string& who, std::span<const uint> which) const
{
    return vectors<uvec4, uint>(index, 4, who, which);
}

} // namespace snell::gltf

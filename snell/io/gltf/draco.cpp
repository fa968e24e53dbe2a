#include "snell/io/gltf/draco.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <draco/compression/decode.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace snell::gltf {
namespace {

[[noreturn]] void fail(const std::string& who, const std::string& what)
{
    throw Error(fmt::format("{}: {}", who, what), "write the file again");
}

// Little-endian groups of 7 bits.
std::uint64_t read_varint(draco::DecoderBuffer& in, const std::string& who)
{
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
        std::uint8_t byte;
        if (!in.Decode(&byte)) break;
        value |= std::uint64_t{byte & 127u} << shift;
        if (byte < 128) return value;
    }
    fail(who, "its Draco data is cut off");
}

// The library asks for memory as the header tells it to, so the header is read first: the bitstream specification's
// section on the header, then the beginning of the connectivity.
std::uint64_t count_faces(std::string_view bytes, const std::string& who)
{
    draco::DecoderBuffer in;
    in.Init(bytes.data(), bytes.size());
    std::array<char, 5> magic = {};
    std::uint8_t major = 0, minor = 0, kind = 0, method = 0;
    std::uint16_t flags = 0;
    const bool is_whole = in.Decode(magic.data(), magic.size()) && in.Decode(&major) && in.Decode(&minor) &&
                          in.Decode(&kind) && in.Decode(&method) && in.Decode(&flags);
    if (!is_whole || std::string_view(magic.data(), magic.size()) != "DRACO") fail(who, "its Draco data has no header");
    if (major != 2 || kind != 1 || method > 1)
        fail(who, fmt::format("its Draco data is of version {}.{}, kind {}, method {}", major, minor, kind, method));
    in.set_bitstream_version(static_cast<std::uint16_t>(major << 8 | minor));
    if (flags & 0x8000u) {
        draco::GeometryMetadata metadata;
        draco::MetadataDecoder decoder;
        if (!decoder.DecodeGeometryMetadata(&in, &metadata)) fail(who, "the metadata of its Draco data is damaged");
    }
    if (method == 1) { // edgebreaker: how it is traversed and the number of vertices come first
        std::uint8_t traversal;
        if (!in.Decode(&traversal)) fail(who, "its Draco data is cut off");
        if (minor < 2) {
            // Versions 2.0 and 2.1 have the number of new vertices here.
            read_varint(in, who);
        }
        read_varint(in, who);
    }
    return read_varint(in, who);
}

} // namespace

DracoMesh::DracoMesh(std::string_view bytes, Budget& budget, const std::string& who) : budget_(budget), who_(who)
{
    const std::uint64_t faces = count_faces(bytes, who);
    // Real meshes have a few faces a byte at most.
    constexpr std::uint64_t most_per_byte = 256;
    if (faces > most_per_byte * bytes.size())
        fail(who, fmt::format("{} bytes of Draco data cannot hold {} triangles", bytes.size(), faces));
    constexpr std::size_t bytes_per_face = 128; // what the library's tables take
    budget.charge(static_cast<std::size_t>(faces), bytes_per_face, who + ": ");

    draco::DecoderBuffer in;
    in.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&in);
    if (!result.ok()) fail(who, fmt::format("its Draco data is damaged: {}", result.status().error_msg()));
    mesh_ = std::move(result).value();
    if (!mesh_ || mesh_->num_points() > 3 * std::max<std::uint64_t>(faces, 1))
        fail(who, "its Draco data has more vertices than its triangles have corners");
}

DracoMesh::~DracoMesh() = default;

std::size_t DracoMesh::vertex_count() const
{
    return mesh_->num_points();
}

std::vector<uvec3> DracoMesh::triangles() const
{
    std::vector<uvec3> out(mesh_->num_faces());
    for (std::uint32_t i = 0; i < out.size(); ++i) {
        const draco::Mesh::Face& face = mesh_->face(draco::FaceIndex(i));
        out[i] = uvec3(face[0].value(), face[1].value(), face[2].value());
    }
    return out;
}

const draco::PointAttribute& DracoMesh::find(int attribute) const
{
    const draco::PointAttribute* const found =
        attribute < 0 ? nullptr : mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(attribute));
    if (!found) fail(who_, fmt::format("its Draco data has no attribute {}", attribute));
    return *found;
}

template <class Vector, class Number>
std::vector<Vector> DracoMesh::read(int attribute, int components, double divisor, Number fill) const
{
    const draco::PointAttribute& source = find(attribute);
    const int given = source.num_components();
    if (given < 1 || given > components)
        fail(who_, fmt::format("attribute {} of its Draco data has {} numbers, not {}", attribute, given, components));
    const std::size_t count = vertex_count();
    budget_.charge(count, sizeof(Vector), who_ + ": ");
    // Where a value is must be checked here: a damaged map may lead anywhere.
    const std::size_t all = source.buffer() ? source.buffer()->data_size() : 0;
    const std::size_t element = static_cast<std::size_t>(given) *
                                static_cast<std::size_t>(std::max(draco::DataTypeLength(source.data_type()), 1));
    const std::size_t stride = static_cast<std::size_t>(std::max<std::int64_t>(source.byte_stride(), 0));
    const std::size_t first = static_cast<std::size_t>(std::max<std::int64_t>(source.byte_offset(), 0));
    const bool is_integer = source.data_type() != draco::DT_FLOAT32 && source.data_type() != draco::DT_FLOAT64;

    std::vector<Vector> out(count);
    for (std::size_t i = 0; i < count; ++i) {
        const bool has_entry = source.is_mapping_identity() || i < source.indices_map_size();
        const std::size_t entry =
            has_entry ? source.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i))).value() : all;
        if (entry >= source.size() || entry * stride + first + element > all)
            fail(who_, fmt::format("attribute {} of its Draco data has no value for vertex {}", attribute, i));
        // The library's own normalisation follows what the data says of itself; glTF's follows the accessor.
        std::array<double, 4> values = {0, 0, 0, 0};
        const auto index = draco::AttributeValueIndex(static_cast<std::uint32_t>(entry));
        bool is_good;
        if (is_integer) {
            std::array<std::int64_t, 4> integers = {};
            is_good = source.ConvertValue<std::int64_t>(index, static_cast<std::int8_t>(given), integers.data());
            for (std::size_t k = 0; k < 4; ++k) values[k] = static_cast<double>(integers[k]);
        } else {
            is_good = source.ConvertValue<double>(index, static_cast<std::int8_t>(given), values.data());
        }
        if (!is_good) fail(who_, fmt::format("attribute {} of its Draco data is damaged", attribute));
        for (int k = 0; k < components; ++k) {
            if (k >= given) {
                out[i][k] = fill;
                continue;
            }
            const double value = values[static_cast<std::size_t>(k)] / divisor;
            if constexpr (std::is_floating_point_v<Number>)
                out[i][k] = static_cast<Number>(divisor == 1.0 ? value : std::max(value, -1.0));
            else
                out[i][k] = static_cast<Number>(std::clamp(value, 0.0, 65535.0));
        }
    }
    return out;
}

std::vector<vec2> DracoMesh::vec2s(int attribute, float divisor) const
{
    return read<vec2>(attribute, 2, divisor, 0.0f);
}

std::vector<vec3> DracoMesh::vec3s(int attribute, float divisor) const
{
    return read<vec3>(attribute, 3, divisor, 0.0f);
}

std::vector<vec4> DracoMesh::vec4s(int attribute, float divisor) const
{
    return read<vec4>(attribute, 4, divisor, 0.0f);
}

std::vector<vec4> DracoMesh::colors(int attribute, float divisor) const
{
    return read<vec4>(attribute, 4, divisor, 1.0f);
}

std::vector<uvec4> DracoMesh::joints(int attribute) const
{
    return read<uvec4>(attribute, 4, 1.0, 0u);
}

} // namespace snell::gltf

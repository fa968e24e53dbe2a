#include "snell/io/ply/vertices.h"

#include "snell/kernel/tone.h"

#include <algorithm>
#include <array>

namespace snell::ply {
namespace {

Slot find_slot(const Property& property)
{
    struct Name
    {
        std::string_view name;
        Slot slot;
    };
    static constexpr Name all[] = {{"x", slot_x},
                                   {"y", slot_y},
                                   {"z", slot_z},
                                   {"nx", slot_nx},
                                   {"ny", slot_ny},
                                   {"nz", slot_nz},
                                   {"normal_x", slot_nx},
                                   {"normal_y", slot_ny},
                                   {"normal_z", slot_nz},
                                   {"u", slot_u},
                                   {"v", slot_v},
                                   {"s", slot_u},
                                   {"t", slot_v},
                                   {"texture_u", slot_u},
                                   {"texture_v", slot_v},
                                   {"u1", slot_u1},
                                   {"v1", slot_v1},
                                   {"tx", slot_tx},
                                   {"ty", slot_ty},
                                   {"tz", slot_tz},
                                   {"tw", slot_tw},
                                   {"red", slot_red},
                                   {"green", slot_green},
                                   {"blue", slot_blue},
                                   {"alpha", slot_alpha},
                                   {"r", slot_red},
                                   {"g", slot_green},
                                   {"b", slot_blue},
                                   {"diffuse_red", slot_red},
                                   {"diffuse_green", slot_green},
                                   {"diffuse_blue", slot_blue}};
    if (!property.is_list)
        for (const Name& name : all)
            if (property.name == name.name) return name.slot;
    return slot_unused;
}

const std::array<float, 256>& byte_colors()
{
    static const std::array<float, 256> colors = [] {
        std::array<float, 256> all{};
        for (std::size_t i = 0; i < 256; ++i) all[i] = srgb_decode(static_cast<float>(i) / 255.0f);
        return all;
    }();
    return colors;
}

} // namespace

Layout read_layout(const Element& vertices)
{
    Layout layout;
    std::array<bool, slot_count + 1> has{};
    std::size_t offset = 0;
    for (const Property& property : vertices.properties) {
        Slot slot = find_slot(property);
        if (has[slot]) slot = slot_unused; // the first of two names for one thing counts
        if (slot == slot_unused)
            layout.unused.push_back(property.name);
        else
            has[slot] = true;
        layout.columns.push_back({&property, slot, offset});
        offset += size_of(property.type);
    }
    layout.row_bytes = vertices.has_lists() ? 0 : offset;
    layout.positions = has[slot_x] && has[slot_y] && has[slot_z];
    layout.normals = has[slot_nx] && has[slot_ny] && has[slot_nz];
    layout.uvs = has[slot_u] && has[slot_v];
    layout.uvs_1 = has[slot_u1] && has[slot_v1];
    layout.tangents = has[slot_tx] && has[slot_ty] && has[slot_tz] && has[slot_tw];
    layout.colors = has[slot_red] && has[slot_green] && has[slot_blue];
    return layout;
}

void resize(Mesh& mesh, const Layout& layout, std::size_t count)
{
    mesh.positions.resize(count);
    if (layout.normals) mesh.normals.resize(count);
    if (layout.uvs) mesh.uvs.resize(count);
    if (layout.uvs_1) mesh.uvs_1.resize(count);
    if (layout.tangents) mesh.tangents.resize(count);
    if (layout.colors) mesh.colors.resize(count, vec4(1.0f));
}

void reserve(Mesh& mesh, const Layout& layout, std::size_t count)
{
    mesh.positions.reserve(count);
    if (layout.normals) mesh.normals.reserve(count);
    if (layout.uvs) mesh.uvs.reserve(count);
    if (layout.uvs_1) mesh.uvs_1.reserve(count);
    if (layout.tangents) mesh.tangents.reserve(count);
    if (layout.colors) mesh.colors.reserve(count);
}

Target target_of(Slot slot, Mesh& mesh, std::size_t first_vertex)
{
    const auto inside = [&](auto& array, int part) {
        if (array.empty()) return Target{};
        constexpr std::size_t stride = sizeof(array[0]) / sizeof(float);
        return Target{&array[0][0] + stride * first_vertex + part, stride};
    };
    switch (slot) {
    case slot_x:
    case slot_y:
    case slot_z:
        return inside(mesh.positions, slot - slot_x);
    case slot_nx:
    case slot_ny:
    case slot_nz:
        return inside(mesh.normals, slot - slot_nx);
    case slot_u:
    case slot_v:
        return inside(mesh.uvs, slot - slot_u);
    case slot_u1:
    case slot_v1:
        return inside(mesh.uvs_1, slot - slot_u1);
    case slot_tx:
    case slot_ty:
    case slot_tz:
    case slot_tw:
        return inside(mesh.tangents, slot - slot_tx);
    case slot_red:
    case slot_green:
    case slot_blue:
    case slot_alpha:
        return inside(mesh.colors, slot - slot_red);
    case slot_unused:
        break;
    }
    return {};
}

float convert(float value, Slot slot, Type type)
{
    if (slot < slot_red || !is_integer(type)) return value;
    const bool is_byte = type == Type::uint8 || type == Type::int8;
    const float part = value / (is_byte ? 255.0f : 65535.0f);
    if (slot == slot_alpha) return part;
    // A text may say anything, not a number included.
    if (is_byte) return byte_colors()[value > 0.0f ? static_cast<std::size_t>(std::min(value, 255.0f)) : 0];
    return srgb_decode(part);
}

} // namespace snell::ply

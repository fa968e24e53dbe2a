#include "snell/bvh/triangle_block.h"

#include "snell/core/error.h"

#include <cstring>
#include <new>

namespace snell {
namespace {

constexpr uint most_vertices = 16;

// What becomes one block.
struct Packing
{
    uint vertices[most_vertices];
    uint vertex_count = 0;
    uint ids[max_leaf_size];
    std::uint8_t corners[max_leaf_size][3];
    uint count = 0;

    uint find(uint vertex) const
    {
        for (uint i = 0; i < vertex_count; ++i)
            if (vertices[i] == vertex) return i;
        return vertex_count;
    }
    // False if its vertices do not fit.
    bool add(const Triangle& tri, uint id)
    {
        const uint corner[3] = {tri.v0, tri.v1, tri.v2};
        const uint before = vertex_count;
        for (uint v = 0; v < 3; ++v) {
            const uint at = find(corner[v]);
            if (at == most_vertices) {
                vertex_count = before;
                return false;
            }
            if (at == vertex_count) vertices[vertex_count++] = corner[v];
            corners[count][v] = static_cast<std::uint8_t>(at);
        }
        ids[count++] = id;
        return true;
    }
};

void append(const PackedScene& scene, const Packing& packing, bool more, std::vector<Line>& lines)
{
    const uint capacity = packing.vertex_count <= 12 ? 12 : 16;
    const std::size_t at = lines.size();
    lines.resize(at + (capacity == 12 ? 3 : 4));
    TriangleBlock& block = *new (&lines[at]) TriangleBlock{};
    block.count = static_cast<std::uint8_t>(packing.count);
    block.capacity = static_cast<std::uint8_t>(capacity);
    block.lanes = static_cast<std::uint8_t>((1u << packing.count) - 1);
    block.more = more ? 1 : 0;
    for (uint lane = 0; lane < max_leaf_size; ++lane) {
        const uint from = lane < packing.count ? lane : 0;
        block.id[lane] = packing.ids[from];
        for (uint v = 0; v < 3; ++v) block.corner[v] |= static_cast<uint>(packing.corners[from][v]) << (4 * lane);
    }
    for (uint axis = 0; axis < 3; ++axis) {
        float* to = block.axis(axis);
        for (uint i = 0; i < capacity; ++i)
            to[i] = scene.positions[packing.vertices[i < packing.vertex_count ? i : 0]][static_cast<int>(axis)];
    }
}

} // namespace

void append_blocks(const PackedScene& scene, std::span<const BinaryTree::Entry> entries, std::vector<Line>& lines)
{
    SNELL_CHECK_LE(entries.size(), std::size_t{max_leaf_size});
    Packing packing;
    for (const BinaryTree::Entry& entry : entries) {
        const Triangle& tri = scene.triangles[entry.index];
        if (packing.add(tri, entry.index)) continue;
        append(scene, packing, true, lines);
        packing = {};
        packing.add(tri, entry.index);
    }
    append(scene, packing, false, lines);
}

Box refill_block(const PackedScene& scene, TriangleBlock& block)
{
    Box box;
    for (uint lane = 0; lane < block.count; ++lane) {
        const Triangle& tri = scene.triangles[block.id[lane]];
        const uint corner[3] = {tri.v0, tri.v1, tri.v2};
        for (uint v = 0; v < 3; ++v) {
            const vec3 p = scene.positions[corner[v]];
            const uint at = block.corner_of(lane, v);
            for (uint axis = 0; axis < 3; ++axis) block.axis(axis)[at] = p[static_cast<int>(axis)];
            box.extend(p);
        }
    }
    return box;
}

} // namespace snell

#include "snell/bvh/triangle_block.h"

#include "snell/core/error.h"

#include <algorithm>
#include <iterator>
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
    std::uint8_t hints[128] = {}; // by the last bits of a vertex: the place of the last one with those bits

    // The place of a vertex, or vertex_count.
    uint find(uint vertex) const
    {
        const uint hint = hints[vertex % std::size(hints)];
        if (hint >= vertex_count) return vertex_count;
        if (vertices[hint] == vertex) return hint;
        if ((vertices[hint] - vertex) % std::size(hints) != 0) return vertex_count; // left from a block before
        for (uint i = 0; i < vertex_count; ++i)
            if (vertices[i] == vertex) return i;
        return vertex_count;
    }
    bool has(uint id) const { return std::find(ids, ids + count, id) != ids + count; }
    void clear() { vertex_count = count = 0; }
    // False if its vertices do not fit; then it takes no more until it is cleared.
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
            if (at == vertex_count) {
                hints[corner[v] % std::size(hints)] = static_cast<std::uint8_t>(at);
                vertices[vertex_count++] = corner[v];
            }
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

uint append_blocks(const PackedScene& scene, std::span<const BinaryTree::Entry> entries, std::vector<Line>& lines)
{
    SNELL_CHECK_LE(entries.size(), std::size_t{max_leaf_size});
    Packing packing;
    uint blocks = 1;
    for (const BinaryTree::Entry& entry : entries) {
        const Triangle& tri = scene.triangles[entry.index];
        if (packing.has(entry.index) || packing.add(tri, entry.index)) continue;
        append(scene, packing, true, lines);
        ++blocks;
        packing.clear();
        packing.add(tri, entry.index);
    }
    append(scene, packing, false, lines);
    return blocks;
}

bool fit_one_block(const PackedScene& scene, std::span<const BinaryTree::Entry> entries)
{
    Packing packing;
    return std::all_of(entries.begin(), entries.end(), [&](const BinaryTree::Entry& entry) {
        return packing.has(entry.index) || packing.add(scene.triangles[entry.index], entry.index);
    });
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

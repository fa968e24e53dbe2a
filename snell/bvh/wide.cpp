#include "snell/bvh/wide.h"

#include "snell/bvh/build.h"
#include "snell/bvh/primitives.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>

namespace snell {
namespace {

// What one tree became: its root, and bounds on what traversing it takes.
struct Converted
{
    WideRoot root;
    uint stack = 0;  // entries that may be waiting while anything below the root is visited
    double cost = 0; // expected steps of a ray that enters the root's box
};

class Converter
{
  public:
    Converter(const PackedScene& packed, WideBvh& target) : scene(packed), wide(target) {}

    Converted convert(const BinaryTree& binary, std::span<const Converted> group_results)
    {
        tree = &binary;
        groups = group_results;
        Converted result;
        if (binary.nodes.empty()) return result;
        first_node = wide.nodes.size();
        first_triangles = wide.triangles.size();
        triangle_leaves.clear();

        for (int axis = 0; axis < 3; ++axis) {
            result.root.lower[axis] = binary.nodes[0].box.lower[axis];
            result.root.upper[axis] = binary.nodes[0].box.upper[axis];
        }
        const Visit visit = emit(0);
        result.root.word = visit.word;
        result.stack = visit.stack;
        const double area = binary.nodes[0].box.half_area();
        result.cost = area > 0 ? visit.cost / area : visit.cost;
        fill_triangles();
        fill_orders();
        return result;
    }

  private:
    struct Visit
    {
        ChildWord word;
        uint stack;  // see Converted
        double cost; // times area
    };

    const PackedScene& scene;
    WideBvh& wide;
    const BinaryTree* tree = nullptr;
    std::span<const Converted> groups;
    std::size_t first_node = 0, first_triangles = 0;
    std::vector<uint> triangle_leaves; // binary leaf of each new triangle block

    // Recursion is as deep as the tree, which builders bound.
    Visit emit(uint index)
    {
        const BinaryNode& node = tree->nodes[index];
        return node.count > 0 ? emit_leaf(index, node) : emit_node(index);
    }

    Visit emit_leaf(uint index, const BinaryNode& node)
    {
        SNELL_CHECK_LE(node.count, max_leaf_size);
        ++wide.leaves;
        const double area = node.box.half_area();
        const auto& entry = tree->order[node.link];
        if (entry.kind == RefKind::instance) {
            // The stack holds the way back to the world while the instance's tree is visited.
            const Converted& group = groups[scene.instances[entry.index].group];
            SNELL_CHECK_LT(entry.index, child_index_mask - 1);
            return {make_child(uint(RefKind::instance), entry.index), 1 + group.stack, area * (1 + group.cost)};
        }
        if (entry.kind == RefKind::sphere) {
            SphereBlock block;
            for (uint lane = 0; lane < max_leaf_size; ++lane)
                block.id[lane] = lane < node.count ? tree->order[node.link + lane].index : none;
            wide.spheres.push_back(block);
            return {make_child(uint(RefKind::sphere), wide.spheres.size() - 1), 0, area * node.count};
        }
        triangle_leaves.push_back(index);
        const std::size_t block = first_triangles + triangle_leaves.size() - 1;
        SNELL_CHECK_LT(block, std::size_t{child_index_mask});
        return {make_child(uint(RefKind::triangle), block), 0, area * node.count};
    }

    // Opens the child with the largest surface until there are eight or only leaves.
    uint gather_children(uint index, std::array<uint, node_width>& children) const
    {
        children[0] = index + 1;
        children[1] = tree->nodes[index].link;
        uint count = 2;
        while (count < node_width) {
            uint widest = none;
            double widest_area = -1;
            for (uint i = 0; i < count; ++i) {
                const BinaryNode& child = tree->nodes[children[i]];
                if (child.count == 0 && child.box.half_area() > widest_area)
                    widest = i, widest_area = child.box.half_area();
            }
            if (widest == none) break;
            const uint opened = children[widest];
            children[widest] = opened + 1;
            children[count++] = tree->nodes[opened].link;
        }
        return count;
    }

    Visit emit_node(uint index)
    {
        std::array<uint, node_width> children;
        const uint count = gather_children(index, children);
        const std::size_t self = wide.nodes.size();
        SNELL_CHECK_LT(self, std::size_t{child_index_mask});
        WideNode& node = wide.nodes.emplace_back();
        for (uint i = 0; i < node_width; ++i) {
            const Box box = i < count ? tree->nodes[children[i]].box : Box();
            for (int axis = 0; axis < 3; ++axis) {
                node.planes[axis][i] = box.lower[axis];
                node.planes[3 + axis][i] = box.upper[axis];
            }
            node.child[i] = word_done;
        }
        // While a child is visited, all its siblings may be waiting.
        Visit visit{make_child(0, self), 0, tree->nodes[index].box.half_area()};
        // Leaves first: those of one node lie side by side.
        for (const bool leaves : {true, false})
            for (uint i = 0; i < count; ++i) {
                if ((tree->nodes[children[i]].count > 0) != leaves) continue;
                const Visit child = emit(children[i]);
                wide.nodes[self].child[i] = child.word; // emit() may have moved the nodes
                visit.stack = std::max(visit.stack, count - 1 + child.stack);
                visit.cost += child.cost;
            }
        return visit;
    }

    void fill_triangles()
    {
        wide.triangles.resize(first_triangles + triangle_leaves.size());
        parallel_ranges(triangle_leaves.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                fill(wide.triangles[first_triangles + i], tree->nodes[triangle_leaves[i]]);
        });
    }

    void fill(TriangleBlock& block, const BinaryNode& leaf) const
    {
        block = {};
        for (uint lane = 0; lane < max_leaf_size; ++lane) {
            const bool used = lane < leaf.count;
            block.id[lane] = used ? tree->order[leaf.link + lane].index : none;
            const Triangle tri = used ? scene.triangles[block.id[lane]] : Triangle{};
            const uint corners[3] = {tri.v0, tri.v1, tri.v2};
            for (int vertex = 0; vertex < 3; ++vertex) {
                const vec3 p = used ? scene.positions[corners[vertex]] : vec3(std::numeric_limits<float>::quiet_NaN());
                for (int axis = 0; axis < 3; ++axis) block.v[vertex][axis][lane] = p[axis];
            }
        }
    }

    void fill_orders()
    {
        parallel_ranges(wide.nodes.size() - first_node, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) order_children(wide.nodes[first_node + i]);
        });
    }

    // Children by their centre along the diagonal of the octant. Unused ones come first, that is, as the farthest.
    static void order_children(WideNode& node)
    {
        for (uint octant = 0; octant < 8; ++octant) {
            std::array<float, node_width> key;
            std::array<uint, node_width> slots = {0, 1, 2, 3, 4, 5, 6, 7};
            for (uint i = 0; i < node_width; ++i) {
                key[i] = 0.0f;
                for (uint axis = 0; axis < 3; ++axis) {
                    const float center = 0.5f * node.planes[axis][i] + 0.5f * node.planes[3 + axis][i];
                    key[i] += (octant >> axis & 1u) ? -center : center;
                }
                if (node.planes[0][i] > node.planes[3][i]) key[i] = std::numeric_limits<float>::infinity();
            }
            std::stable_sort(slots.begin(), slots.end(), [&](uint a, uint b) { return key[a] > key[b]; });
            node.order[octant] = 0;
            for (uint i = 0; i < node_width; ++i) node.order[octant] |= slots[i] << (4 * i);
        }
    }
};

} // namespace

std::size_t WideBvh::bytes() const
{
    return sizeof(WideNode) * nodes.capacity() + sizeof(TriangleBlock) * triangles.capacity() +
           sizeof(SphereBlock) * spheres.capacity() + sizeof(WideRoot) * groups.capacity();
}

WideBvh make_wide(const PackedScene& scene, const BinaryTree& world, std::span<const BinaryTree> groups)
{
    WideBvh wide;
    Converter converter(scene, wide);
    std::vector<Converted> results;
    for (const BinaryTree& group : groups) {
        results.push_back(converter.convert(group, {}));
        wide.groups.push_back(results.back().root);
    }
    const Converted root = converter.convert(world, results);
    wide.world = root.root;
    wide.sah_cost = root.cost;
    wide.stack_size = root.stack + 1; // the word that ends it
    wide.nodes.shrink_to_fit();
    wide.spheres.shrink_to_fit();
    wide.triangles.shrink_to_fit();
    return wide;
}

WideBvh build_wide(const PackedScene& scene, const BuildOptions& options, const TreeCache& cache, CacheUse* use)
{
    std::vector<BinaryTree> groups;
    std::vector<Box> boxes;
    for (const PackedGroup& group : scene.groups) {
        groups.push_back(build_cached(scene, collect_primitives(scene, group), options, cache, use));
        boxes.push_back(groups.back().nodes.empty() ? Box() : groups.back().nodes[0].box);
    }
    std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    collect_instances(scene, boxes, refs);
    return make_wide(scene, build_cached(scene, std::move(refs), options, cache, use), groups);
}

} // namespace snell

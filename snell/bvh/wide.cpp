#include "snell/bvh/wide.h"

#include "snell/bvh/collapse.h"
#include "snell/bvh/primitives.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <numbers>
#include <numeric>

namespace snell {
namespace {

// Subtrees of so many binary nodes are converted by one thread.
constexpr uint piece_size = 8192;

// How far ahead of a leaf its triangles and their vertices are asked for, in entries of the order.
constexpr std::size_t triangles_ahead = 128, vertices_ahead = 48;

struct Visit
{
    ChildWord word;
    uint stack;     // see WideTree
    double cost;    // times area
    double surface; // of sheets that random rays meet as often as what is below
};

// Part of a tree that one thread has made; words of nodes and blocks count from the part's own first ones.
template <class Node>
struct Piece
{
    typename Collapse<Node::width>::Child root{};
    std::vector<Node> nodes;
    std::vector<Line> lines;
    std::vector<SphereBlock> spheres;
    std::size_t leaves = 0;
    Visit visit{word_done, 0, 0, 0};
    std::size_t first_node = 0, first_line = 0, first_sphere = 0; // in the whole
};

template <class Node>
class Converter
{
  public:
    Converter(const PackedScene& packed, const BinaryTree& binary, std::span<const Below> instances)
        : scene(packed), tree(binary), below(instances), collapse(packed, binary)
    {
    }

    WideTree<Node> run()
    {
        WideTree<Node> wide;
        if (tree.nodes.empty()) return wide;
        wide.box = tree.nodes[0].box;
        plan(collapse.root());
        parallel_for(pieces.size(), [&](std::size_t i) {
            Piece<Node>& piece = pieces[i];
            reserve(piece);
            piece.visit = emit(piece, piece.root, nullptr);
        });
        Piece<Node> summit;
        Seams seams;
        const Visit visit = emit(summit, collapse.root(), &seams);
        SNELL_CHECK_EQ(seams.met, pieces.size());

        std::size_t nodes = summit.nodes.size(), lines = summit.lines.size(), spheres = summit.spheres.size();
        for (Piece<Node>& piece : pieces) {
            piece.first_node = nodes, piece.first_line = lines, piece.first_sphere = spheres;
            nodes += piece.nodes.size(), lines += piece.lines.size(), spheres += piece.spheres.size();
            wide.leaves += piece.leaves;
        }
        wide.leaves += summit.leaves;
        SNELL_CHECK_LT(nodes, std::size_t{child_index_mask});
        SNELL_CHECK_LT(lines, std::size_t{child_index_mask} - spare_lines);
        wide.nodes.resize(nodes);
        wide.lines.resize(lines + spare_lines);
        std::memset(static_cast<void*>(&wide.lines[lines]), 0, spare_lines * sizeof(Line));
        new (&wide.lines[lines]) TriangleBlock{{}, 0, 12, 0, 0, {}};
        wide.no_child = make_child(uint(RefKind::triangle), lines);
        wide.spheres.resize(spheres);
        for (const Seam& seam : seams.list) summit.nodes[seam.node].child[seam.slot] = moved(pieces[seam.piece]);
        wide.root = visit.word;
        pieces.push_back(std::move(summit));
        parallel_for(pieces.size(), [&](std::size_t i) { place(pieces[i], wide); });
        wide.stack_size = visit.stack;
        const double area = wide.box.half_area();
        wide.sah_cost = area > 0 ? visit.cost / area : visit.cost;
        return wide;
    }

  private:
    const PackedScene& scene;
    const BinaryTree& tree;
    std::span<const Below> below;
    const Collapse<Node::width> collapse;
    std::vector<Piece<Node>> pieces;

    using Child = typename Collapse<Node::width>::Child;

    static constexpr std::size_t spare_lines = 4;

    // Where the summit's nodes lead to pieces. The root of a tree is always in the summit.
    struct Seam
    {
        std::size_t node;
        uint slot;
        std::size_t piece;
    };
    struct Seams
    {
        std::vector<Seam> list;
        std::size_t met = 0; // pieces
    };

    static ChildWord moved(const Piece<Node>& piece) { return moved(piece, piece.visit.word); }
    static ChildWord moved(const Piece<Node>& piece, ChildWord word)
    {
        switch (word >> 30) {
        case 0:
            return word + static_cast<uint>(piece.first_node);
        case uint(RefKind::triangle):
            return word + static_cast<uint>(piece.first_line);
        case uint(RefKind::sphere):
            return word + static_cast<uint>(piece.first_sphere);
        default:
            return word;
        }
    }

    // Lists the subtrees that are small enough for one thread and are the roots of wide nodes, in depth-first order.
    void plan(const Child& child)
    {
        if (collapse.is_leaf(child)) return;
        if (child.end - child.index <= piece_size && child.index != 0) {
            pieces.emplace_back().root = child;
            return;
        }
        for (const Child& inner : collapse.children(child)) plan(inner);
    }

    // Room for what most pieces hold: arrays that grow are copied.
    void reserve(Piece<Node>& piece) const
    {
        const std::size_t leaves = (piece.root.end - piece.root.index + 1) / 2;
        piece.nodes.reserve(leaves / (Node::width - 1) * 5 / 4 + 8);
        if (below.empty()) piece.lines.reserve(leaves * 4);
    }

    // seams: not null for the summit.
    Visit emit(Piece<Node>& to, const Child& child, Seams* seams)
    {
        if (collapse.is_leaf(child)) return emit_leaf(to, child);
        if (seams != nullptr && seams->met < pieces.size() && pieces[seams->met].root.index == child.index)
            return pieces[seams->met++].visit;
        return emit_node(to, child, seams);
    }

    void prefetch(const BinaryTree::Entry* entry, std::size_t count) const
    {
        const BinaryTree::Entry* const end = collapse.entries_end();
        for (std::size_t i = 0; i < count; ++i, ++entry) {
            if (static_cast<std::size_t>(end - entry) <= triangles_ahead) return;
            const uint index = entry[triangles_ahead].index;
            if (entry[triangles_ahead].kind == RefKind::triangle) __builtin_prefetch(&scene.triangles[index]);
            // The world's own tree has a number that no instance has.
            if (entry[triangles_ahead].kind == RefKind::instance && index < scene.instances.size())
                __builtin_prefetch(&scene.instances[index].group);
            if (entry[vertices_ahead].kind == RefKind::triangle)
                __builtin_prefetch(&scene.positions[scene.triangles[entry[vertices_ahead].index].v0]);
        }
    }

    Visit emit_leaf(Piece<Node>& to, const Child& leaf)
    {
        ++to.leaves;
        const double area = collapse.box(leaf).half_area();
        const std::span<const BinaryTree::Entry> entries = collapse.entries(leaf);
        prefetch(entries.data(), entries.size());
        double surface = 0;
        switch (entries[0].kind) {
        case RefKind::triangle: {
            const std::size_t first = to.lines.size();
            const uint blocks = append_blocks(scene, entries, to.lines);
            for (const BinaryTree::Entry& entry : entries) surface += area_of(scene.triangles[entry.index]);
            return {make_child(uint(RefKind::triangle), first), 0, area * blocks * double(wide_block_cost), surface};
        }
        case RefKind::sphere: {
            SphereBlock& block = to.spheres.emplace_back();
            for (uint lane = 0; lane < max_leaf_size; ++lane)
                block.id[lane] = lane < entries.size() ? entries[lane].index : none;
            for (const BinaryTree::Entry& entry : entries) surface += shadow_of(scene.spheres[entry.index]);
            return {make_child(uint(RefKind::sphere), to.spheres.size() - 1), 0, area * double(wide_block_cost),
                    surface};
        }
        case RefKind::instance: {
            // The stack holds the way back while the instance's tree is visited. How much of its box is filled is not
            // looked at: as if by one sheet.
            const bool is_world = make_child(uint(RefKind::instance), entries[0].index) == word_world;
            const Below& inner = is_world ? below.back() : below[scene.instances[entries[0].index].group];
            return {make_child(uint(RefKind::instance), entries[0].index), 1 + inner.stack,
                    area * (double(wide_node_cost) + inner.cost), area};
        }
        }
        return {word_done, 0, 0, 0};
    }

    double area_of(const Triangle& tri) const
    {
        const vec3 a = scene.positions[tri.v0];
        return 0.5 * double(length(cross(scene.positions[tri.v1] - a, scene.positions[tri.v2] - a)));
    }

    // Half the surface, for a ray meets a sphere's twice.
    static double shadow_of(const Sphere& sphere)
    {
        return 2 * std::numbers::pi * double(sphere.radius) * double(sphere.radius);
    }

    // A node's children as they are found, and then in its slots.
    struct Family
    {
        Box boxes[Node::width];
        ChildWord words[Node::width];
        double worth[Node::width] = {};
        uint slot[Node::width];
        uint count = 0;

        // Any hit is looked for in the last slot first: where a ray is likeliest to be blocked for the time it takes
        // (Ize, Hansen 2011, RTSAH Traversal Order for Occlusion Rays), by the rays that the SAH assumes: of those that
        // meet a box, area meets area as if it were strewn about.
        void fill(Node& node)
        {
            uint by_worth[Node::width];
            std::iota(by_worth, by_worth + count, 0u);
            std::stable_sort(by_worth, by_worth + count, [&](uint a, uint b) { return worth[a] < worth[b]; });
            Box sorted[Node::width];
            for (uint i = 0; i < count; ++i) {
                slot[by_worth[i]] = i;
                sorted[i] = boxes[by_worth[i]];
                node.child[i] = words[by_worth[i]];
            }
            for (uint i = count; i < Node::width; ++i) node.child[i] = word_done;
            node.set_boxes(sorted);
        }

        void add(uint i, const Visit& below)
        {
            words[i] = below.word;
            const double area = boxes[i].half_area();
            const double blocked = 1 - std::exp(-below.surface / area);
            const double ratio = blocked * area / below.cost;
            if (ratio > 0) worth[i] = ratio; // and not if it is NaN
        }
    };

    Visit emit_node(Piece<Node>& to, const Child& child, Seams* seams)
    {
        const auto children = collapse.children(child);
        const std::size_t self = to.nodes.size(), first_seam = seams != nullptr ? seams->list.size() : 0;
        to.nodes.emplace_back();
        Family family;
        family.count = children.count;
        for (uint i = 0; i < children.count; ++i) family.boxes[i] = collapse.box(children.list[i]);
        // While a child is visited, all its siblings may be waiting; those that are not there as well where the
        // rounding of a far ray may take them for met.
        const uint siblings = (Node::empty_is_empty ? children.count : Node::width) - 1;
        Visit visit{make_child(0, self), 0, tree.nodes[child.index].box.half_area() * double(wide_node_cost), 0};
        const auto descend = [&](uint i) {
            const std::size_t met = seams != nullptr ? seams->met : 0;
            const Visit below_it = emit(to, children.list[i], seams);
            if (seams != nullptr && seams->met == met + 1 && pieces[met].root.index == children.list[i].index)
                seams->list.push_back({self, i, met});
            family.add(i, below_it);
            visit.stack = std::max(visit.stack, siblings + below_it.stack);
            visit.cost += below_it.cost;
            visit.surface += below_it.surface;
        };
        // Leaves first: those of one node lie side by side.
        for (uint i = 0; i < children.count; ++i)
            if (collapse.is_leaf(children.list[i])) descend(i);
        for (uint i = 0; i < children.count; ++i)
            if (!collapse.is_leaf(children.list[i])) descend(i);
        family.fill(to.nodes[self]);
        for (std::size_t i = first_seam; seams != nullptr && i < seams->list.size(); ++i)
            if (Seam& seam = seams->list[i]; seam.node == self) seam.slot = family.slot[seam.slot];
        return visit;
    }

    // The summit's words are right as they are.
    void place(Piece<Node>& piece, WideTree<Node>& wide) const
    {
        for (Node& node : piece.nodes)
            for (ChildWord& child : node.child)
                child = child == word_done ? wide.no_child : piece.first_node > 0 ? moved(piece, child) : child;
        const auto copy = [](const auto& from, auto& to, std::size_t first) {
            if (!from.empty()) std::memcpy(static_cast<void*>(&to[first]), from.data(), from.size() * sizeof(from[0]));
        };
        copy(piece.nodes, wide.nodes, piece.first_node);
        copy(piece.lines, wide.lines, piece.first_line);
        copy(piece.spheres, wide.spheres, piece.first_sphere);
        piece = {};
    }
};

} // namespace

template <class Node>
uint WideBvh<Node>::stack_size() const
{
    uint most = first().stack_size;
    return most + 1; // the word that ends it
}

template <class Node>
std::size_t WideBvh<Node>::bytes() const
{
    std::size_t sum = world.bytes() + top.bytes() + sizeof(WideTree<Node>) * groups.capacity();
    for (const WideTree<Node>& group : groups) sum += group.bytes();
    return sum;
}

template <class Node>
std::size_t WideBvh<Node>::nodes() const
{
    std::size_t sum = world.nodes.size() + top.nodes.size();
    for (const WideTree<Node>& group : groups) sum += group.nodes.size();
    return sum;
}

template <class Node>
std::size_t WideBvh<Node>::leaves() const
{
    std::size_t sum = world.leaves + top.leaves;
    for (const WideTree<Node>& group : groups) sum += group.leaves;
    return sum;
}

BuildOptions for_each_frame(BuildOptions options)
{
    if (options.builder.empty() || options.builder == "auto") options.builder = "binned";
    return options;
}

template <class Node>
WideTree<Node> make_wide_tree(const PackedScene& scene, const BinaryTree& tree, std::span<const Below> below)
{
    return Converter<Node>(scene, tree, below).run();
}

template <class Node>
WideTree<Node> make_top_tree(const PackedScene& scene, const WideBvh<Node>& bvh, const BuildOptions& options)
{
    std::vector<Box> boxes;
    std::vector<Below> below;
    for (const WideTree<Node>& group : bvh.groups) {
        boxes.push_back(group.box);
        below.push_back({group.sah_cost, group.stack_size});
    }
    below.push_back({bvh.world.sah_cost, bvh.world.stack_size});
    std::vector<PrimitiveRef> refs;
    refs.reserve(scene.instances.size() + 1);
    advise_big(refs.data(), refs.capacity() * sizeof(PrimitiveRef));
    collect_instances(scene, boxes, refs);
    if (bvh.world.root != word_done)
        refs.push_back({bvh.world.box.lower, word_world & child_index_mask, bvh.world.box.upper, RefKind::instance});
    return make_wide_tree<Node>(scene, build_tree(scene, std::move(refs), options), below);
}

template <class Node>
WideTree<Node> make_group_tree(const PackedScene& scene, const PackedGroup& group, const BuildOptions& options,
                               const TreeCache& cache, CacheUse* use)
{
    std::vector<PrimitiveRef> refs = collect_primitives(scene, group);
    const std::size_t left_out = std::size_t{group.triangle_count} + group.sphere_count - refs.size();
    WideTree<Node> tree = make_wide_tree<Node>(scene, build_cached(scene, std::move(refs), options, cache, use));
    tree.left_out = left_out;
    return tree;
}

template <class Node>
WideBvh<Node> make_wide(const PackedScene& scene, const BuildOptions& options, const TreeCache& cache, CacheUse* use)
{
    WideBvh<Node> bvh;
    std::vector<CacheUse> uses(scene.groups.size() + 1);
    bvh.world = make_group_tree<Node>(scene, scene.world, options, cache, &uses.back());
    bvh.groups.resize(scene.groups.size());
    parallel_for(scene.groups.size(), [&](std::size_t i) {
        bvh.groups[i] = make_group_tree<Node>(scene, scene.groups[i], options, cache, &uses[i]);
    });
    if (!scene.instances.empty()) bvh.top = make_top_tree(scene, bvh, options);
    if (use != nullptr)
        for (const CacheUse& one : uses)
            use->loaded += one.loaded, use->built += one.built, use->refused += one.refused;
    return bvh;
}

#define SNELL_INSTANTIATE(Node)                                                                                        \
    template struct WideBvh<Node>;                                                                                     \
    template WideTree<Node> make_wide_tree<Node>(const PackedScene&, const BinaryTree&, std::span<const Below>);       \
    template WideTree<Node> make_top_tree<Node>(const PackedScene&, const WideBvh<Node>&, const BuildOptions&);        \
    template WideTree<Node> make_group_tree<Node>(const PackedScene&, const PackedGroup&, const BuildOptions&,         \
                                                  const TreeCache&, CacheUse*);                                        \
    template WideBvh<Node> make_wide<Node>(const PackedScene&, const BuildOptions&, const TreeCache&, CacheUse*);
SNELL_INSTANTIATE(Node2)
SNELL_INSTANTIATE(Node4)
SNELL_INSTANTIATE(Node8)
SNELL_INSTANTIATE(QuantisedNode)

} // namespace snell

#include "snell/bvh/wide.h"

#include "snell/bvh/primitives.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <new>

namespace snell {
namespace {

// Subtrees of so many binary nodes are converted by one thread.
constexpr uint piece_size = 8192;

struct Visit
{
    ChildWord word;
    uint stack;  // see WideTree
    double cost; // times area
};

// Part of a tree that one thread has made; words of nodes and blocks count from the part's own first ones.
template <class Node>
struct Piece
{
    uint root, end; // range of binary nodes
    std::vector<Node> nodes;
    std::vector<Line> lines;
    std::vector<SphereBlock> spheres;
    std::size_t leaves = 0;
    Visit visit{word_done, 0, 0};
    std::size_t first_node = 0, first_line = 0, first_sphere = 0; // in the whole
};

template <class Node>
class Converter
{
  public:
    Converter(const PackedScene& packed, const BinaryTree& binary, std::span<const Below> instances)
        : scene(packed), tree(binary), below(instances)
    {
    }

    WideTree<Node> run()
    {
        WideTree<Node> wide;
        if (tree.nodes.empty()) return wide;
        wide.box = tree.nodes[0].box;
        plan(0, static_cast<uint>(tree.nodes.size()));
        parallel_for(pieces.size(), [&](std::size_t i) {
            Piece<Node>& piece = pieces[i];
            piece.visit = emit(piece, piece.root, piece.end, nullptr);
        });
        Piece<Node> summit;
        std::size_t next = 0;
        const Visit visit = emit(summit, 0, static_cast<uint>(tree.nodes.size()), &next);
        SNELL_CHECK_EQ(next, pieces.size());

        std::size_t nodes = summit.nodes.size(), lines = summit.lines.size(), spheres = summit.spheres.size();
        for (Piece<Node>& piece : pieces) {
            piece.first_node = nodes, piece.first_line = lines, piece.first_sphere = spheres;
            nodes += piece.nodes.size(), lines += piece.lines.size(), spheres += piece.spheres.size();
            wide.leaves += piece.leaves;
        }
        wide.leaves += summit.leaves;
        SNELL_CHECK_LT(nodes, std::size_t{child_index_mask});
        SNELL_CHECK_LT(lines, std::size_t{child_index_mask} - 4);
        wide.nodes.resize(nodes);
        wide.lines.resize(lines + 4);
        new (&wide.lines[lines]) TriangleBlock{{}, 0, 12, 0, 0, {}};
        wide.no_child = make_child(uint(RefKind::triangle), lines);
        wide.spheres.resize(spheres);
        // Words of the summit that stand for pieces become those of the pieces' roots.
        for (Node& node : summit.nodes)
            for (uint i = 0; i < Node::width; ++i)
                if (is_piece(node.child[i])) node.child[i] = moved(pieces[piece_of(node.child[i])]);
        pieces.push_back(std::move(summit));
        parallel_for(pieces.size(), [&](std::size_t i) { place(pieces[i], wide); });
        wide.root = is_piece(visit.word) ? moved(pieces[piece_of(visit.word)]) : visit.word;
        wide.stack_size = visit.stack;
        const double area = wide.box.half_area();
        wide.sah_cost = area > 0 ? visit.cost / area : visit.cost;
        return wide;
    }

  private:
    const PackedScene& scene;
    const BinaryTree& tree;
    std::span<const Below> below;
    std::vector<Piece<Node>> pieces;

    // Within the summit a piece is an instance word with a number that no instance has there: summits of trees over
    // instances hold no pieces, see plan().
    static constexpr ChildWord piece_bit = 0xc0000000u;
    bool is_piece(ChildWord word) const { return below.empty() && word >= piece_bit && word != word_done; }
    static std::size_t piece_of(ChildWord word) { return word & child_index_mask; }

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

    uint middle(uint index) const { return tree.nodes[index].link; }

    // Lists the subtrees that are small enough for one thread and are the roots of wide nodes, in depth-first order.
    // Trees over instances are left to one thread.
    void plan(uint index, uint end)
    {
        if (!below.empty() || end - index <= piece_size) {
            if (below.empty() && index != 0 && tree.nodes[index].count == 0) {
                Piece<Node>& piece = pieces.emplace_back();
                piece.root = index, piece.end = end;
            }
            return;
        }
        std::array<uint, Node::width> children, ends;
        const uint count = gather_children(index, end, children, ends);
        for (uint i = 0; i < count; ++i)
            if (tree.nodes[children[i]].count == 0) plan(children[i], ends[i]);
    }

    // next_piece: not null for the summit; counts the pieces met.
    Visit emit(Piece<Node>& to, uint index, uint end, std::size_t* next_piece)
    {
        const BinaryNode& node = tree.nodes[index];
        if (node.count > 0) return emit_leaf(to, node);
        if (next_piece != nullptr && *next_piece < pieces.size() && pieces[*next_piece].root == index) {
            Visit visit = pieces[*next_piece].visit;
            visit.word = piece_bit | static_cast<uint>((*next_piece)++);
            return visit;
        }
        return emit_node(to, index, end, next_piece);
    }

    Visit emit_leaf(Piece<Node>& to, const BinaryNode& node)
    {
        ++to.leaves;
        const double area = node.box.half_area();
        const std::span<const BinaryTree::Entry> entries(&tree.order[node.link], node.count);
        switch (entries[0].kind) {
        case RefKind::triangle: {
            const std::size_t first = to.lines.size();
            append_blocks(scene, entries, to.lines);
            return {make_child(uint(RefKind::triangle), first), 0, area * node.count};
        }
        case RefKind::sphere: {
            SphereBlock& block = to.spheres.emplace_back();
            for (uint lane = 0; lane < max_leaf_size; ++lane)
                block.id[lane] = lane < node.count ? entries[lane].index : none;
            return {make_child(uint(RefKind::sphere), to.spheres.size() - 1), 0, area * node.count};
        }
        case RefKind::instance: {
            // The stack holds the way back while the instance's tree is visited.
            const bool is_world = make_child(uint(RefKind::instance), entries[0].index) == word_world;
            const Below& inner = is_world ? below.back() : below[scene.instances[entries[0].index].group];
            return {make_child(uint(RefKind::instance), entries[0].index), 1 + inner.stack, area * (1 + inner.cost)};
        }
        }
        return {word_done, 0, 0};
    }

    // Opens the child with the largest surface until the node is full or there are only leaves.
    uint gather_children(uint index, uint end, std::array<uint, Node::width>& children,
                         std::array<uint, Node::width>& ends) const
    {
        std::array<double, Node::width> areas; // of those that can be opened, else -1
        const auto put = [&](uint at, uint child, uint child_end) {
            children[at] = child, ends[at] = child_end;
            const BinaryNode& node = tree.nodes[child];
            areas[at] = node.count > 0 ? -1.0 : node.box.half_area();
        };
        put(0, index + 1, middle(index));
        put(1, middle(index), end);
        uint count = 2;
        while (count < Node::width) {
            const uint widest =
                static_cast<uint>(std::max_element(areas.begin(), areas.begin() + count) - areas.begin());
            if (areas[widest] < 0.0) break;
            const uint opened = children[widest], opened_end = ends[widest];
            put(widest, opened + 1, middle(opened));
            put(count++, middle(opened), opened_end);
        }
        return count;
    }

    Visit emit_node(Piece<Node>& to, uint index, uint end, std::size_t* next_piece)
    {
        std::array<uint, Node::width> children, ends;
        const uint count = gather_children(index, end, children, ends);
        const std::size_t self = to.nodes.size();
        Node& node = to.nodes.emplace_back();
        Box boxes[Node::width];
        for (uint i = 0; i < count; ++i) boxes[i] = tree.nodes[children[i]].box;
        for (uint i = 0; i < Node::width; ++i) node.child[i] = word_done;
        node.set_boxes(boxes);
        // While a child is visited, all its siblings may be waiting.
        Visit visit{make_child(0, self), 0, tree.nodes[index].box.half_area()};
        const auto descend = [&](uint i) {
            const Visit child = emit(to, children[i], ends[i], next_piece);
            to.nodes[self].child[i] = child.word; // emit() may have moved the nodes
            visit.stack = std::max(visit.stack, count - 1 + child.stack);
            visit.cost += child.cost;
        };
        // Leaves first: those of one node lie side by side.
        for (uint i = 0; i < count; ++i)
            if (tree.nodes[children[i]].count > 0) descend(i);
        for (uint i = 0; i < count; ++i)
            if (tree.nodes[children[i]].count == 0) descend(i);
        return visit;
    }

    void place(Piece<Node>& piece, WideTree<Node>& wide) const
    {
        Node* node = wide.nodes.data() + piece.first_node;
        for (Node& from : piece.nodes) {
            *node = from;
            for (uint i = 0; i < Node::width; ++i) {
                ChildWord& child = node->child[i];
                if (child == word_done)
                    child = wide.no_child;
                else if (piece.first_node > 0)
                    child = moved(piece, child);
            }
            ++node;
        }
        std::copy(piece.lines.begin(), piece.lines.end(), wide.lines.begin() + std::ptrdiff_t(piece.first_line));
        std::copy(piece.spheres.begin(), piece.spheres.end(),
                  wide.spheres.begin() + std::ptrdiff_t(piece.first_sphere));
        piece.nodes = {};
        piece.lines = {};
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

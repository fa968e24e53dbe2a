// Spatial splits (Stich, Friedrich, Dietrich 2009, Spatial Splits in Bounding Volume Hierarchies).
//
// Top down. Every set of references may grow by a budget of its own: what a node leaves of its budget is divided
// between its children. Large sets lie in one of two arrays, with room for their budget behind them, and their halves
// are written to the other one; small ones are built by one thread on a stack. A set never holds two references to one
// primitive, for the parts of a cut go to different sides.
#include "snell/bvh/build.h"
#include "snell/bvh/clip.h"
#include "snell/bvh/sbvh_bins.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <memory>

namespace snell {
namespace {

using namespace sbvh;

constexpr int sah_depth = 64;               // deeper nodes are cut in the middle: at most 30 levels more
constexpr std::size_t piece_size = 8192;    // subtrees up to here are built by one thread
constexpr std::size_t chunk_size = 1 << 15; // of parallel passes; fixed, for the result must not depend on threads
constexpr double least_overlap = 1e-5;      // of the children, against the root, for trying a spatial split

// What becomes of a reference when its set is divided.
enum class Side
{
    left,
    right,
    both
};

// How to divide a set: at a plane, by the bin of the centre, or by number.
struct Division
{
    enum class Kind
    {
        spatial,
        object,
        halves
    } kind;
    Slabs slabs;
    Split split;
    float plane = 0;
    std::size_t half = 0;
};

// The two parts of a reference.
struct Parts
{
    PrimitiveRef left, right;
};

class Divider
{
  public:
    Divider(const PackedScene& packed, const Division& how) : scene(packed), division(how)
    {
        const Split& split = division.split;
        if (division.kind != Division::Kind::spatial) return;
        left_cost = split.left.half_area() * static_cast<float>(split.left_count);
        right_cost = split.right.half_area() * static_cast<float>(split.right_count);
    }

    // number: the reference's place in its set. parts is written for Side::both.
    Side operator()(const PrimitiveRef& ref, std::size_t number, Parts& parts) const
    {
        if (division.kind == Division::Kind::halves) return number < division.half ? Side::left : Side::right;
        const int axis = division.split.axis;
        if (division.kind == Division::Kind::object) {
            alignas(16) std::int32_t bin[4];
            division.slabs.find(hn::Add(load3(ref.lower), load3(ref.upper)), bin);
            return static_cast<uint>(bin[axis]) < division.split.bin ? Side::left : Side::right;
        }
        if (ref.upper[axis] <= division.plane) return Side::left;
        if (ref.lower[axis] >= division.plane) return Side::right;
        if (ref.kind != RefKind::triangle)
            return 0.5f * ref.lower[axis] + 0.5f * ref.upper[axis] < division.plane ? Side::left : Side::right;
        return straddling(ref, parts);
    }

  private:
    const PackedScene& scene;
    const Division& division;
    float left_cost = 0, right_cost = 0;

    Side straddling(const PrimitiveRef& ref, Parts& parts) const
    {
        // Reference unsplitting: whole on one side, if that costs less. By what the bins said of the sides, whatever
        // becomes of other references, so that the order does not matter.
        const Split& split = division.split;
        const Vec lo = load3(ref.lower), hi = load3(ref.upper);
        WideBox with_left = split.left, with_right = split.right;
        with_left.extend(lo, hi);
        with_right.extend(lo, hi);
        const float both = left_cost + right_cost;
        const float only_left =
            with_left.half_area() * static_cast<float>(split.left_count) + right_cost - split.right.half_area();
        const float only_right =
            with_right.half_area() * static_cast<float>(split.right_count) + left_cost - split.left.half_area();
        if (std::min(only_left, only_right) < both) return only_left <= only_right ? Side::left : Side::right;

        const Triangle& tri = scene.triangles[ref.index];
        const vec3 v[3] = {scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]};
        const CutBoxes cut = cut_triangle(v, split.axis, division.plane);
        const Box whole = {ref.lower, ref.upper};
        const Box left = intersection(cut.below, whole), right = intersection(cut.above, whole);
        // Where earlier cuts have left nothing of one part, the other is all there is.
        if (right.empty()) return Side::left;
        if (left.empty()) return Side::right;
        parts.left = {left.lower, ref.index, left.upper, ref.kind};
        parts.right = {right.lower, ref.index, right.upper, ref.kind};
        return Side::both;
    }
};

// Part of the tree: an inner node over two pieces, or nodes and entries in final order with links that count from their
// own first ones.
struct Piece
{
    std::vector<BinaryNode> nodes;
    std::vector<BinaryTree::Entry> order;
    std::unique_ptr<Piece> left, right;
    std::size_t node_count = 0, entry_count = 0;
};

// References in one of the arrays, and how many more there may become.
struct Set
{
    const PrimitiveRef* refs;
    std::size_t count, budget;
    std::size_t place; // in both arrays; count + budget entries from there on are the set's own
    Extents extents;
};

class Builder
{
  public:
    explicit Builder(const PackedScene& packed) : scene(packed) {}

    BinaryTree run(std::vector<PrimitiveRef> refs, double split_budget)
    {
        BinaryTree tree;
        if (refs.empty()) return tree;
        SNELL_CHECK_LT(refs.size(), std::size_t{1} << 30);
        Set root{refs.data(), refs.size(), 0, 0, {}};
        const double most = static_cast<double>((std::size_t{1} << 30) - 1 - refs.size());
        root.budget = static_cast<std::size_t>(std::clamp(split_budget * double(refs.size()), 0.0, most));
        root.extents = extents_of(root);
        const double area = root.extents.box.box().half_area();
        overlap_limit = least_overlap * area;
        if (root.count > piece_size)
            for (auto& array : arrays) array = std::make_unique_for_overwrite<PrimitiveRef[]>(root.count + root.budget);
        const std::unique_ptr<Piece> top = build_piece(root, 0);
        for (auto& array : arrays) array.reset();
        refs = {};
        tree.nodes.resize(top->node_count);
        tree.order.resize(top->entry_count);
        flatten(*top, tree, 0, 0);
        return tree;
    }

  private:
    const PackedScene& scene;
    std::unique_ptr<PrimitiveRef[]> arrays[2];
    double overlap_limit = 0;

    // Chunks of fixed size; body(chunk, begin, end) for each, in parallel where there is more than one or two.
    template <class Body>
    static void for_chunks(std::size_t count, const Body& body)
    {
        if (chunks(count) == 1)
            body(0, 0, count);
        else
            parallel_for(chunks(count), [&](std::size_t chunk) {
                body(chunk, chunk * chunk_size, std::min((chunk + 1) * chunk_size, count));
            });
    }
    static std::size_t chunks(std::size_t count)
    {
        return count > 2 * chunk_size ? (count + chunk_size - 1) / chunk_size : 1;
    }

    static Extents extents_of(const Set& set)
    {
        std::vector<Extents> parts(chunks(set.count));
        for_chunks(set.count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) parts[chunk].extend(set.refs[i]);
        });
        for (std::size_t i = 1; i < parts.size(); ++i) parts[0].extend(parts[i]);
        return parts[0];
    }

    // Fill(histogram, refs) on all of the set.
    template <class Bins, class Fill>
    static void histogram_of(Bins& histogram, const Set& set, const Fill& fill)
    {
        if (chunks(set.count) == 1) {
            fill(histogram, std::span(set.refs, set.count));
            return;
        }
        std::vector<Bins> parts(chunks(set.count), histogram);
        for_chunks(set.count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            fill(parts[chunk], std::span(set.refs + begin, end - begin));
        });
        for (const Bins& part : parts) histogram.add(part);
    }

    Division object_division(const Set& set) const
    {
        Division division{
            Division::Kind::object,
            Slabs(set.extents.centroid.box(), static_cast<uint>(std::min<std::size_t>(object_bins, 4 + set.count / 2))),
            {}};
        ObjectBins bins(division.slabs.bins);
        histogram_of(bins, set, [&](ObjectBins& histogram, std::span<const PrimitiveRef> refs) {
            add_objects(histogram, refs, division.slabs);
        });
        division.split = bins.best(division.slabs.possible);
        return division;
    }

    Division spatial_division(const Set& set) const
    {
        Division division{Division::Kind::spatial, Slabs(set.extents.box.box(), spatial_bins), {}};
        SpatialBins bins(spatial_bins);
        histogram_of(bins, set, [&](SpatialBins& histogram, std::span<const PrimitiveRef> refs) {
            add_chopped(histogram, scene, refs, division.slabs);
        });
        division.split = bins.best(division.slabs.possible);
        if (division.split.axis >= 0) division.plane = division.slabs.plane(division.split.axis, division.split.bin);
        return division;
    }

    // The ways to divide a set, best first; the last one always works.
    std::vector<Division> divisions(const Set& set, int depth) const
    {
        std::vector<Division> ways;
        if (depth < sah_depth) {
            const Division object = object_division(set);
            const bool possible = object.split.axis >= 0;
            const Box common = intersection(object.split.left.box(), object.split.right.box());
            if (set.budget > 0 && (!possible || common.half_area() > overlap_limit)) {
                const Division spatial = spatial_division(set);
                const Split& split = spatial.split;
                if (split.axis >= 0 && split.cost < object.split.cost &&
                    split.left_count + split.right_count - set.count <= set.budget)
                    ways.push_back(spatial);
            }
            if (possible) ways.push_back(object);
        }
        // All centres in one place, or a hostile distribution that SAH would peel one by one.
        ways.push_back({Division::Kind::halves, Slabs({}, 1), {}, 0, set.count / 2});
        return ways;
    }

    static bool is_leaf(const Set& set)
    {
        if (set.count == 1) return true;
        if (set.count > max_leaf_size || set.refs[0].kind == RefKind::instance) return false;
        return std::all_of(set.refs, set.refs + set.count,
                           [&](const PrimitiveRef& ref) { return ref.kind == set.refs[0].kind; });
    }

    // Shares what is left of a budget, by the surfaces of the references: large ones are worth cutting.
    static std::size_t left_share(std::size_t budget, const Extents& left, const Extents& right)
    {
        const double part = left.weight / (left.weight + right.weight);
        return part >= 0 && part <= 1 ? static_cast<std::size_t>(part * static_cast<double>(budget)) : budget / 2;
    }

    struct Counts
    {
        std::size_t left = 0, right = 0;
    };

    // Divides a large set into `target`: false if a side got nothing, or both more than there is room for.
    bool divide(const Set& set, const Division& division, PrimitiveRef* target, Set& left, Set& right) const
    {
        const Divider side_of(scene, division);
        std::vector<Counts> counts(chunks(set.count) + 1);
        std::vector<std::pair<Extents, Extents>> extents(chunks(set.count));
        for_chunks(set.count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Parts parts;
            for (std::size_t i = begin; i < end; ++i) {
                const Side side = side_of(set.refs[i], i, parts);
                const PrimitiveRef& l = side == Side::both ? parts.left : set.refs[i];
                const PrimitiveRef& r = side == Side::both ? parts.right : set.refs[i];
                if (side != Side::right) ++counts[chunk + 1].left, extents[chunk].first.extend(l);
                if (side != Side::left) ++counts[chunk + 1].right, extents[chunk].second.extend(r);
            }
        });
        for (std::size_t i = 1; i < counts.size(); ++i) {
            counts[i].left += counts[i - 1].left;
            counts[i].right += counts[i - 1].right;
        }
        const Counts all = counts.back();
        if (all.left == 0 || all.right == 0 || all.left + all.right > set.count + set.budget) return false;
        for (std::size_t i = 1; i < extents.size(); ++i) {
            extents[0].first.extend(extents[i].first);
            extents[0].second.extend(extents[i].second);
        }

        const std::size_t budget = set.budget - (all.left + all.right - set.count);
        const std::size_t share = left_share(budget, extents[0].first, extents[0].second);
        const std::size_t middle = set.place + all.left + share;
        left = {target + set.place, all.left, share, set.place, extents[0].first};
        right = {target + middle, all.right, budget - share, middle, extents[0].second};
        for_chunks(set.count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            PrimitiveRef* to_left = target + left.place + counts[chunk].left;
            PrimitiveRef* to_right = target + right.place + counts[chunk].right;
            Parts parts;
            for (std::size_t i = begin; i < end; ++i) {
                const Side side = side_of(set.refs[i], i, parts);
                if (side != Side::right) *to_left++ = side == Side::both ? parts.left : set.refs[i];
                if (side != Side::left) *to_right++ = side == Side::both ? parts.right : set.refs[i];
            }
        });
        return true;
    }

    std::unique_ptr<Piece> build_piece(const Set& set, int depth)
    {
        auto piece = std::make_unique<Piece>();
        if (set.count <= piece_size) {
            std::vector<PrimitiveRef> stack, lefts;
            stack.reserve(set.count + set.budget);
            stack.assign(set.refs, set.refs + set.count);
            build_nodes(*piece, stack, lefts, set.count, set.budget, set.extents, depth);
            piece->node_count = piece->nodes.size();
            piece->entry_count = piece->order.size();
            return piece;
        }
        piece->nodes.push_back({set.extents.box.box(), 0, 0});
        PrimitiveRef* target = arrays[depth % 2].get();
        Set left, right;
        for (const Division& division : divisions(set, depth))
            if (divide(set, division, target, left, right)) break;
        parallel_both([&] { piece->left = build_piece(left, depth + 1); },
                      [&] { piece->right = build_piece(right, depth + 1); });
        piece->node_count = 1 + piece->left->node_count + piece->right->node_count;
        piece->entry_count = piece->left->entry_count + piece->right->entry_count;
        return piece;
    }

    // The last `count` references of the stack are the node's, and are taken from it. Returns what is left of the
    // budget.
    std::size_t build_nodes(Piece& piece, std::vector<PrimitiveRef>& stack, std::vector<PrimitiveRef>& lefts,
                            std::size_t count, std::size_t budget, const Extents& extents, int depth)
    {
        const std::size_t base = stack.size() - count, self = piece.nodes.size();
        const Set set{stack.data() + base, count, budget, 0, extents};
        piece.nodes.push_back({extents.box.box(), 0, 0});
        if (is_leaf(set)) {
            piece.nodes[self].link = static_cast<uint>(piece.order.size());
            piece.nodes[self].count = static_cast<uint>(count);
            for (std::size_t i = base; i < stack.size(); ++i) piece.order.push_back({stack[i].index, stack[i].kind});
            stack.resize(base);
            return budget;
        }
        Extents left, right;
        std::size_t left_count = 0;
        for (const Division& division : divisions(set, depth))
            if (divide_top(stack, lefts, set, division, left, right, left_count)) break;
        const std::size_t right_count = stack.size() - base - left_count;
        const std::size_t rest = budget - (left_count + right_count - count), share = left_share(rest, left, right);
        const std::size_t returned = build_nodes(piece, stack, lefts, left_count, share, left, depth + 1);
        piece.nodes[self].link = static_cast<uint>(piece.nodes.size());
        return build_nodes(piece, stack, lefts, right_count, rest - share + returned, right, depth + 1);
    }

    // Puts the left side's references on top of the right side's. False, and nothing done, as in divide().
    bool divide_top(std::vector<PrimitiveRef>& stack, std::vector<PrimitiveRef>& lefts, const Set& set,
                    const Division& division, Extents& left, Extents& right, std::size_t& left_count) const
    {
        const Divider side_of(scene, division);
        const std::size_t base = stack.size() - set.count;
        std::vector<PrimitiveRef> rights;
        lefts.clear();
        left = right = {};
        Parts parts;
        for (std::size_t i = 0; i < set.count; ++i) {
            const PrimitiveRef& ref = stack[base + i];
            const Side side = side_of(ref, i, parts);
            if (side != Side::right) lefts.push_back(side == Side::both ? parts.left : ref), left.extend(lefts.back());
            if (side != Side::left)
                rights.push_back(side == Side::both ? parts.right : ref), right.extend(rights.back());
        }
        if (lefts.empty() || rights.empty() || lefts.size() + rights.size() > set.count + set.budget) return false;
        stack.resize(base);
        stack.insert(stack.end(), rights.begin(), rights.end());
        stack.insert(stack.end(), lefts.begin(), lefts.end());
        left_count = lefts.size();
        return true;
    }

    static void flatten(const Piece& piece, BinaryTree& tree, std::size_t node, std::size_t entry)
    {
        if (!piece.left) {
            for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
                BinaryNode copy = piece.nodes[i];
                copy.link += static_cast<uint>(copy.count > 0 ? entry : node);
                tree.nodes[node + i] = copy;
            }
            std::copy(piece.order.begin(), piece.order.end(), tree.order.begin() + static_cast<std::ptrdiff_t>(entry));
            return;
        }
        const std::size_t right = node + 1 + piece.left->node_count;
        tree.nodes[node] = piece.nodes.front();
        tree.nodes[node].link = static_cast<uint>(right);
        parallel_both([&] { flatten(*piece.left, tree, node + 1, entry); },
                      [&] { flatten(*piece.right, tree, right, entry + piece.left->entry_count); });
    }
};

} // namespace

BinaryTree build_sbvh(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options)
{
    return Builder(scene).run(std::move(refs), options.split_budget);
}

} // namespace snell

// Spatial splits (Stich, Friedrich, Dietrich 2009, Spatial Splits in Bounding Volume Hierarchies).
//
// Top down. Every set of references may grow by a budget of its own: what a node leaves of its budget is divided
// between its children. A set owns a region in two arrays, with room for its budget; its halves are written to the
// other array, the left one at the region's beginning and the right one at its end, so that what is between them can
// be divided afterwards. A set never holds two references to one primitive: the parts of a cut go to different sides.
#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/bvh/sbvh_sides.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <memory>

namespace snell {
namespace {

using namespace sbvh;

constexpr int halving_depth = 64;           // deeper sets are halved by number: at most 30 levels more
constexpr std::size_t piece_size = 8192;    // subtrees up to here are built by one thread
constexpr std::size_t chunk_size = 1 << 15; // of parallel passes; fixed, for the result must not depend on threads

// When a spatial split is worth trying: the children of the object split have so much surface in common, against the
// root's and against the node's own; and there is more below than a few leaves, which gain nothing. Of small sets there
// are so many that attempts which promise little cost more than they bring.
constexpr double overlap_of_root = 1e-5, overlap_of_large = 0.03, overlap_of_small = 0.2;
constexpr std::size_t least_count = 17;

// Of large sets only so many references are chopped at first. Most attempts end there: a part of the references has
// smaller boxes than all, so if it costs too much, they do. Otherwise it names the axis. More than that a sample may
// not decide: the few large triangles that it misses are what matters.
constexpr std::size_t sample_size = 1024, large_count = 4 * sample_size;

// References in one of the arrays.
struct Set
{
    const PrimitiveRef* refs;
    std::size_t count, budget; // budget: how many more they may become
    std::size_t place;         // where the set's region of count + budget begins
    WeighedExtents extents;

    std::span<const PrimitiveRef> all() const { return {refs, count}; }
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
        least_overlap = overlap_of_root * root.extents.box.box().half_area();
        for (Array& array : arrays)
            array.reset(static_cast<PrimitiveRef*>(allocate_big((root.count + root.budget) * sizeof(PrimitiveRef))));
        const std::unique_ptr<Piece> top = build_piece(root, 0);
        for (Array& array : arrays) array.reset();
        refs = {};
        tree.nodes.resize(top->node_count);
        tree.order.resize(top->entry_count);
        flatten(*top, tree, 0, 0);
        return tree;
    }

  private:
    struct Free
    {
        void operator()(PrimitiveRef* memory) const { free_big(memory); }
    };
    using Array = std::unique_ptr<PrimitiveRef, Free>;

    const PackedScene& scene;
    Array arrays[2];
    double least_overlap = 0;

    // Chunks of fixed size, in parallel; only one, if there are few references.
    static std::size_t chunks(std::size_t count)
    {
        return count > 2 * chunk_size ? (count + chunk_size - 1) / chunk_size : 1;
    }
    // Calls body(chunk, first, references) for each.
    template <class Body>
    static void for_chunks(const Set& set, const Body& body)
    {
        parallel_for(chunks(set.count), [&](std::size_t chunk) {
            const std::size_t first = chunk * chunk_size;
            body(chunk, first, std::span(set.refs + first, std::min(chunk_size, set.count - first)));
        });
    }

    static WeighedExtents extents_of(const Set& set)
    {
        std::vector<WeighedExtents> parts((set.count + chunk_size - 1) / chunk_size);
        parallel_for(parts.size(), [&](std::size_t chunk) {
            WeighedExtents part;
            const std::size_t first = chunk * chunk_size;
            for (const PrimitiveRef& ref : std::span(set.refs + first, std::min(chunk_size, set.count - first)))
                part.extend(ref);
            parts[chunk] = part;
        });
        for (std::size_t i = 1; i < parts.size(); ++i) parts[0].extend(parts[i]);
        return parts[0];
    }

    // The best split of bins that fill(bins, references) fills.
    template <class Bins, class Fill>
    static Split best_split(const Set& set, const Slabs& slabs, const Fill& fill)
    {
        Bins bins(slabs.bins);
        if (chunks(set.count) == 1) {
            fill(bins, set.all());
        } else {
            std::vector<Bins> parts(chunks(set.count), bins);
            for_chunks(set, [&](std::size_t chunk, std::size_t, std::span<const PrimitiveRef> refs) {
                fill(parts[chunk], refs);
            });
            for (const Bins& part : parts) bins.add(part);
        }
        return bins.best(slabs.possible);
    }

    static Split object_split(const Set& set, const Slabs& slabs)
    {
        return best_split<ObjectBins>(
            set, slabs, [&](ObjectBins& bins, std::span<const PrimitiveRef> refs) { add_objects(bins, refs, slabs); });
    }

    // The best spatial split, if it costs less than `most`; else its axis is -1.
    Split spatial_split(const Set& set, Slabs& slabs, float most) const
    {
        if (set.count >= large_count) {
            const std::size_t stride = set.count / sample_size;
            SpatialBins bins(slabs.bins);
            add_chopped(bins, scene, set.all(), slabs, stride);
            const Split sampled = bins.best(slabs.possible);
            if (!(static_cast<float>(stride) * sampled.cost < most)) return {};
            for (int axis = 0; axis < 3; ++axis) slabs.possible[axis] = axis == sampled.axis;
        }
        const Split split =
            best_split<SpatialBins>(set, slabs, [&](SpatialBins& bins, std::span<const PrimitiveRef> refs) {
                add_chopped(bins, scene, refs, slabs);
            });
        return split.cost < most ? split : Split();
    }

    bool try_spatial(const Set& set, const Split& object) const
    {
        if (set.budget == 0 || set.count < least_count) return false;
        if (object.axis < 0) return true;
        const double overlap = intersection(object.left.box(), object.right.box()).half_area();
        const double part = set.count < large_count ? overlap_of_small : overlap_of_large;
        return overlap > least_overlap && overlap > part * set.extents.box.box().half_area();
    }

    // Divides a set of at least two: both sides get at least one reference, and what is left of the budget.
    void divide(const Set& set, int depth, Set& left, Set& right) const
    {
        if (depth < halving_depth) {
            const Slabs by_centre(set.extents.centre.box(),
                                  static_cast<uint>(std::min<std::size_t>(object_bins, 8 + set.count / 8)));
            const Split object = object_split(set, by_centre);
            if (try_spatial(set, object)) {
                Slabs slabs(set.extents.box.box(), spatial_bins);
                const Split split = spatial_split(set, slabs, object.cost);
                if (split.axis >= 0 &&
                    divide_by(ByPlane(scene, split, slabs.plane(split.axis, split.bin)), set, depth, left, right))
                    return;
            }
            if (object.axis >= 0 && divide_by(ByCentre{by_centre, object}, set, depth, left, right)) return;
        }
        // All centres in one place, or a hostile distribution that SAH would peel one by one.
        divide_by(ByNumber{set.count / 2}, set, depth, left, right);
    }

    // False if a side gets nothing, or both more than there is room for.
    template <class SideOf>
    bool divide_by(const SideOf& side_of, const Set& set, int depth, Set& left, Set& right) const
    {
        PrimitiveRef* const region = arrays[depth % 2].get() + set.place;
        const std::size_t room = set.count + set.budget;
        Ends all{region, region + room, {}, {}};
        if (chunks(set.count) == 1) {
            if (!write_sides(set.all(), 0, side_of, all)) return false;
        } else if (!write_chunks(side_of, set, all)) {
            return false;
        }
        const auto left_count = static_cast<std::size_t>(all.left - region);
        const auto right_count = static_cast<std::size_t>(region + room - all.right);
        if (left_count == 0 || right_count == 0) return false;
        const std::size_t budget = room - left_count - right_count;
        // By the surfaces of the references: large ones are worth cutting.
        const double part = all.left_extents.weight / (all.left_extents.weight + all.right_extents.weight);
        const std::size_t share =
            part >= 0 && part <= 1 ? static_cast<std::size_t>(part * static_cast<double>(budget)) : budget / 2;
        left = {region, left_count, share, set.place, all.left_extents};
        right = {all.right, right_count, budget - share, set.place + left_count + share, all.right_extents};
        return true;
    }

    // Counts first: then each chunk knows where its share belongs.
    template <class SideOf>
    static bool write_chunks(const SideOf& side_of, const Set& set, Ends& all)
    {
        std::vector<Counts> counts(chunks(set.count));
        for_chunks(set, [&](std::size_t chunk, std::size_t first, std::span<const PrimitiveRef> refs) {
            counts[chunk] = count_sides(refs, first, side_of);
        });
        Counts sum;
        for (Counts& count : counts) {
            const Counts before = sum;
            sum.left += count.left, sum.right += count.right;
            count = before;
        }
        if (sum.left + sum.right > set.count + set.budget) return false;
        std::vector<Ends> parts(counts.size());
        for_chunks(set, [&](std::size_t chunk, std::size_t first, std::span<const PrimitiveRef> refs) {
            Ends ends{all.left + counts[chunk].left, all.right - counts[chunk].right, {}, {}};
            write_sides(refs, first, side_of, ends);
            parts[chunk] = ends;
        });
        all.left += sum.left;
        all.right -= sum.right;
        for (const Ends& part : parts) {
            all.left_extents.extend(part.left_extents);
            all.right_extents.extend(part.right_extents);
        }
        return true;
    }

    static bool is_leaf(const Set& set)
    {
        if (set.count == 1) return true;
        if (set.count > max_leaf_size || set.refs[0].kind == RefKind::instance) return false;
        return std::all_of(set.refs, set.refs + set.count,
                           [&](const PrimitiveRef& ref) { return ref.kind == set.refs[0].kind; });
    }

    std::unique_ptr<Piece> build_piece(const Set& set, int depth) const
    {
        auto piece = std::make_unique<Piece>();
        if (set.count <= piece_size) {
            piece->nodes.reserve(set.count * 3 / 4 + 1); // leaves of 3 and more
            piece->order.reserve(set.count + set.budget);
            build_nodes(*piece, set, depth);
            piece->node_count = piece->nodes.size();
            piece->entry_count = piece->order.size();
            return piece;
        }
        piece->nodes.push_back({set.extents.box.box(), 0, 0});
        Set left, right;
        divide(set, depth, left, right);
        parallel_both([&] { piece->left = build_piece(left, depth + 1); },
                      [&] { piece->right = build_piece(right, depth + 1); });
        piece->node_count = 1 + piece->left->node_count + piece->right->node_count;
        piece->entry_count = piece->left->entry_count + piece->right->entry_count;
        return piece;
    }

    // Returns what is left of the budget.
    std::size_t build_nodes(Piece& piece, const Set& set, int depth) const
    {
        const std::size_t self = piece.nodes.size();
        if (is_leaf(set)) {
            piece.nodes.push_back(
                {set.extents.box.box(), static_cast<uint>(piece.order.size()), static_cast<uint>(set.count)});
            for (const PrimitiveRef& ref : set.all()) piece.order.push_back({ref.index, ref.kind});
            return set.budget;
        }
        piece.nodes.push_back({set.extents.box.box(), 0, 0});
        Set left, right;
        divide(set, depth, left, right);
        // The right one gets what the left one did not need, and the room as well.
        const std::size_t unused = build_nodes(piece, left, depth + 1);
        right.budget += unused;
        right.place -= unused;
        piece.nodes[self].link = static_cast<uint>(piece.nodes.size());
        return build_nodes(piece, right, depth + 1);
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

#include "snell/bvh/build.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/lang.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>

namespace snell {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

constexpr uint max_bins = 32;
constexpr int sah_depth = 64;               // deeper nodes are cut in the middle: at most 30 levels more
constexpr std::size_t piece_size = 8192;    // subtrees up to here are built by one thread
constexpr std::size_t chunk_size = 1 << 15; // of parallel passes; fixed, for the result must not depend on threads

// A box in registers. The fourth lane carries the index or kind of whatever was loaded last and means nothing.
struct WideBox
{
    Vec lower = hn::Set(Lanes(), std::numeric_limits<float>::infinity());
    Vec upper = hn::Set(Lanes(), -std::numeric_limits<float>::infinity());

    void extend(Vec lo, Vec hi) { lower = hn::Min(lower, lo), upper = hn::Max(upper, hi); }
    void extend(const WideBox& b) { extend(b.lower, b.upper); }
    Box box() const
    {
        alignas(16) float lo[4], hi[4];
        hn::Store(lower, Lanes(), lo);
        hn::Store(upper, Lanes(), hi);
        return {vec3(lo[0], lo[1], lo[2]), vec3(hi[0], hi[1], hi[2])};
    }
    // Half the surface; infinite for an overflow, which only makes the split unattractive.
    float half_area() const
    {
        const Vec e = hn::Sub(upper, lower);
        alignas(16) float x[4];
        hn::Store(e, Lanes(), x);
        return x[0] * x[1] + x[1] * x[2] + x[2] * x[0];
    }
};

// The fourth lane is an integer in disguise; it becomes 0, so that no arithmetic meets a denormal or a NaN.
Vec load3(const vec3& v)
{
    alignas(16) static constexpr uint mask[4] = {~0u, ~0u, ~0u, 0u};
    const hn::RebindToUnsigned<Lanes> du;
    return hn::And(hn::Load(Lanes(), &v.x), hn::BitCast(Lanes(), hn::Load(du, mask)));
}

struct Extents
{
    WideBox box;      // of the primitives
    WideBox centroid; // of twice their centres

    void extend(const PrimitiveRef& ref)
    {
        const Vec lo = load3(ref.lower), hi = load3(ref.upper), c = hn::Add(lo, hi);
        box.extend(lo, hi);
        centroid.extend(c, c);
    }
    void extend(const Extents& e)
    {
        box.extend(e.box);
        centroid.extend(e.centroid);
    }
};

struct Bin
{
    WideBox box;
    uint count = 0;
};

// Maps twice a primitive's centre to a bin on each axis.
struct Binning
{
    Vec origin, scale;
    uint bins = 0;
    bool possible[3] = {};

    Binning(const Extents& extents, std::size_t count)
    {
        bins = static_cast<uint>(std::min<std::size_t>(max_bins, 4 + count / 2));
        const Box c = extents.centroid.box();
        alignas(16) float o[4] = {}, s[4] = {};
        for (int axis = 0; axis < 3; ++axis) {
            o[axis] = c.lower[axis];
            const float width = c.upper[axis] - c.lower[axis];
            s[axis] = 0.99999f * static_cast<float>(bins) / width;
            possible[axis] = width > 0.0f && is_finite(width) && is_finite(s[axis]);
            if (!possible[axis]) s[axis] = 0.0f;
        }
        origin = hn::Load(Lanes(), o);
        scale = hn::Load(Lanes(), s);
    }
    // Bins of the three axes; the fourth number means nothing.
    void find(const PrimitiveRef& ref, std::int32_t (&bin)[4]) const
    {
        const hn::RebindToSigned<Lanes> di;
        const Vec c = hn::Add(load3(ref.lower), load3(ref.upper));
        const auto index = hn::ConvertTo(di, hn::Mul(hn::Sub(c, origin), scale));
        const auto top = hn::Set(di, static_cast<std::int32_t>(bins) - 1);
        hn::StoreU(hn::Max(hn::Min(index, top), hn::Zero(di)), di, bin);
    }
};

struct Histogram
{
    std::array<std::array<Bin, max_bins>, 3> axes;

    void add(std::span<const PrimitiveRef> refs, const Binning& binning)
    {
        for (const PrimitiveRef& ref : refs) {
            alignas(16) std::int32_t bin[4];
            binning.find(ref, bin);
            const Vec lo = load3(ref.lower), hi = load3(ref.upper);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                Bin& b = axes[axis][static_cast<std::size_t>(bin[axis])];
                b.box.extend(lo, hi);
                ++b.count;
            }
        }
    }
    void add(const Histogram& other, uint bins)
    {
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t i = 0; i < bins; ++i) {
                axes[axis][i].box.extend(other.axes[axis][i].box);
                axes[axis][i].count += other.axes[axis][i].count;
            }
    }
};

struct Split
{
    int axis = -1;        // -1: no plane separates the centres
    std::int32_t bin = 0; // the first one on the right
    float cost = std::numeric_limits<float>::infinity();
};

float blocks(uint count)
{
    return static_cast<float>((count + max_leaf_size - 1) / max_leaf_size);
}

Split best_split(const Histogram& histogram, const Binning& binning)
{
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (!binning.possible[axis]) continue;
        const auto& bins = histogram.axes[static_cast<std::size_t>(axis)];
        std::array<float, max_bins> right_cost;
        std::array<uint, max_bins> right_count;
        WideBox box;
        uint count = 0;
        for (uint i = binning.bins - 1; i > 0; --i) {
            box.extend(bins[i].box);
            count += bins[i].count;
            right_cost[i] = count > 0 ? box.half_area() * blocks(count) : 0.0f;
            right_count[i] = count;
        }
        box = WideBox();
        count = 0;
        for (uint i = 1; i < binning.bins; ++i) {
            box.extend(bins[i - 1].box);
            count += bins[i - 1].count;
            if (count == 0 || right_count[i] == 0) continue;
            const float cost = box.half_area() * blocks(count) + right_cost[i];
            if (best.axis < 0 || cost < best.cost) best = {axis, static_cast<std::int32_t>(i), cost};
        }
    }
    return best;
}

// One part of the tree: either nodes in final order with links that count from their own first one, or an inner node
// over two pieces.
struct Piece
{
    std::vector<BinaryNode> nodes;
    std::unique_ptr<Piece> left, right;

    std::size_t size() const { return left ? 1 + left->size() + right->size() : nodes.size(); }
};

class Builder
{
  public:
    explicit Builder(std::vector<PrimitiveRef> primitives) : refs(std::move(primitives)) {}

    BinaryTree run()
    {
        BinaryTree tree;
        if (refs.empty()) return tree;
        SNELL_CHECK_LT(refs.size(), std::size_t{1} << 30);
        const std::unique_ptr<Piece> root = build_piece(0, refs.size(), extents_of(0, refs.size()), 0);
        scratch = {};
        tree.order.resize(refs.size());
        for (std::size_t i = 0; i < refs.size(); ++i) tree.order[i] = {refs[i].index, refs[i].kind};
        refs = {};
        tree.nodes.resize(root->size());
        flatten(*root, tree.nodes, 0);
        return tree;
    }

  private:
    std::vector<PrimitiveRef> refs;
    std::vector<PrimitiveRef> scratch; // of parallel partitions

    std::span<PrimitiveRef> range(std::size_t begin, std::size_t end)
    {
        return std::span(refs).subspan(begin, end - begin);
    }

    // Calls body(chunk, begin, end) for chunks of fixed size that cover [begin, end).
    template <class Body>
    static void for_chunks(std::size_t begin, std::size_t end, const Body& body)
    {
        parallel_for((end - begin + chunk_size - 1) / chunk_size, [&](std::size_t chunk) {
            const std::size_t first = begin + chunk * chunk_size;
            body(chunk, first, std::min(first + chunk_size, end));
        });
    }

    static bool is_big(std::size_t begin, std::size_t end) { return end - begin > 2 * chunk_size; }
    static std::size_t chunks(std::size_t begin, std::size_t end)
    {
        return (end - begin + chunk_size - 1) / chunk_size;
    }

    Extents extents_of(std::size_t begin, std::size_t end)
    {
        Extents all;
        if (!is_big(begin, end)) {
            for (const PrimitiveRef& ref : range(begin, end)) all.extend(ref);
            return all;
        }
        std::vector<Extents> parts(chunks(begin, end));
        for_chunks(begin, end, [&](std::size_t chunk, std::size_t first, std::size_t last) {
            for (const PrimitiveRef& ref : range(first, last)) parts[chunk].extend(ref);
        });
        for (const Extents& part : parts) all.extend(part);
        return all;
    }

    void fill(Histogram& histogram, const Binning& binning, std::size_t begin, std::size_t end)
    {
        if (!is_big(begin, end)) {
            histogram.add(range(begin, end), binning);
            return;
        }
        std::vector<Histogram> parts(chunks(begin, end));
        for_chunks(begin, end, [&](std::size_t chunk, std::size_t first, std::size_t last) {
            parts[chunk].add(range(first, last), binning);
        });
        for (const Histogram& part : parts) histogram.add(part, binning.bins);
    }

    // Moves the references of the left side to the front. Returns where the right side begins.
    template <class IsLeft>
    std::size_t partition(std::size_t begin, std::size_t end, const IsLeft& is_left)
    {
        if (!is_big(begin, end)) {
            const auto part = range(begin, end);
            return begin + static_cast<std::size_t>(std::partition(part.begin(), part.end(), is_left) - part.begin());
        }
        // Count, then copy to where each chunk's share belongs, then copy back.
        std::vector<std::size_t> left(chunks(begin, end) + 1), right(left.size());
        for_chunks(begin, end, [&](std::size_t chunk, std::size_t first, std::size_t last) {
            const auto part = range(first, last);
            left[chunk + 1] = static_cast<std::size_t>(std::count_if(part.begin(), part.end(), is_left));
            right[chunk + 1] = part.size() - left[chunk + 1];
        });
        for (std::size_t i = 1; i < left.size(); ++i) left[i] += left[i - 1], right[i] += right[i - 1];
        const std::size_t middle = begin + left.back();
        for_chunks(begin, end, [&](std::size_t chunk, std::size_t first, std::size_t last) {
            std::size_t to_left = begin + left[chunk], to_right = middle + right[chunk];
            for (const PrimitiveRef& ref : range(first, last)) scratch[is_left(ref) ? to_left++ : to_right++] = ref;
        });
        for_chunks(begin, end, [&](std::size_t, std::size_t first, std::size_t last) {
            std::copy(scratch.begin() + static_cast<std::ptrdiff_t>(first),
                      scratch.begin() + static_cast<std::ptrdiff_t>(last),
                      refs.begin() + static_cast<std::ptrdiff_t>(first));
        });
        return middle;
    }

    bool is_leaf(std::size_t begin, std::size_t end) const
    {
        if (end - begin == 1) return true;
        if (end - begin > max_leaf_size || refs[begin].kind == RefKind::instance) return false;
        for (std::size_t i = begin + 1; i < end; ++i)
            if (refs[i].kind != refs[begin].kind) return false;
        return true;
    }

    // Reorders the references and says where the right child's begin; both sides get at least one.
    std::size_t split(std::size_t begin, std::size_t end, const Extents& extents, int depth)
    {
        if (depth < sah_depth) {
            const Binning binning(extents, end - begin);
            Histogram histogram;
            fill(histogram, binning, begin, end);
            const Split best = best_split(histogram, binning);
            if (best.axis >= 0)
                return partition(begin, end, [&](const PrimitiveRef& ref) {
                    alignas(16) std::int32_t bin[4];
                    binning.find(ref, bin);
                    return bin[best.axis] < best.bin;
                });
        }
        // All centres in one place, or a hostile distribution that SAH would peel one by one.
        return begin + (end - begin) / 2;
    }

    void build_nodes(std::vector<BinaryNode>& nodes, std::size_t begin, std::size_t end, const Extents& extents,
                     int depth)
    {
        const std::size_t self = nodes.size();
        nodes.push_back({extents.box.box(), static_cast<uint>(begin), static_cast<uint>(end - begin)});
        if (is_leaf(begin, end)) return;
        const std::size_t middle = split(begin, end, extents, depth);
        build_nodes(nodes, begin, middle, extents_of(begin, middle), depth + 1);
        nodes[self].link = static_cast<uint>(nodes.size());
        nodes[self].count = 0;
        build_nodes(nodes, middle, end, extents_of(middle, end), depth + 1);
    }

    std::unique_ptr<Piece> build_piece(std::size_t begin, std::size_t end, const Extents& extents, int depth)
    {
        auto piece = std::make_unique<Piece>();
        if (end - begin <= piece_size) {
            build_nodes(piece->nodes, begin, end, extents, depth);
            return piece;
        }
        if (scratch.empty() && is_big(begin, end)) scratch.resize(refs.size()); // the root's, before any task
        piece->nodes.push_back({extents.box.box(), 0, 0});
        const std::size_t middle = split(begin, end, extents, depth);
        parallel_both([&] { piece->left = build_piece(begin, middle, extents_of(begin, middle), depth + 1); },
                      [&] { piece->right = build_piece(middle, end, extents_of(middle, end), depth + 1); });
        return piece;
    }

    static std::size_t flatten(const Piece& piece, std::vector<BinaryNode>& nodes, std::size_t at)
    {
        if (!piece.left) {
            for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
                BinaryNode node = piece.nodes[i];
                if (node.count == 0) node.link += static_cast<uint>(at);
                nodes[at + i] = node;
            }
            return at + piece.nodes.size();
        }
        nodes[at] = piece.nodes.front();
        const std::size_t right = flatten(*piece.left, nodes, at + 1);
        nodes[at].link = static_cast<uint>(right);
        return flatten(*piece.right, nodes, right);
    }
};

} // namespace

BinaryTree build_binned_sah(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    return Builder(std::move(refs)).run();
}

} // namespace snell

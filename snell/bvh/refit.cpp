#include "snell/bvh/refit.h"

#include "snell/bvh/child_order.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell {

// The next floats outwards, so that rounding never cuts into the sphere. Empty if that is not finite.
static Box sphere_box(const Sphere& ball)
{
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::nextafter(ball.center[axis] - std::abs(ball.radius), -infinity()) + 0.0f;
        box.upper[axis] = std::nextafter(ball.center[axis] + std::abs(ball.radius), infinity()) + 0.0f;
    }
    return is_finite3(box.lower) && is_finite3(box.upper) ? box : Box();
}

namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

constexpr float inf = std::numeric_limits<float>::infinity();

// The same coordinate of four points, for x, y and z.
struct Rows
{
    Vec x, y, z;
};

// x, y, z, and a lane that means nothing.
struct Corners
{
    Vec lower = hn::Set(Lanes(), inf), upper = hn::Set(Lanes(), -inf);

    HWY_INLINE void extend(const Corners& c)
    {
        lower = hn::Min(lower, c.lower);
        upper = hn::Max(upper, c.upper);
    }
};

const auto smaller = [](Vec a, Vec b) { return hn::Min(a, b); };
const auto larger = [](Vec a, Vec b) { return hn::Max(a, b); };

HWY_INLINE Rows transpose(Vec p0, Vec p1, Vec p2, Vec p3)
{
    const Lanes d;
    const Vec a = hn::InterleaveLower(d, p0, p2), b = hn::InterleaveLower(d, p1, p3);
    const Vec z0 = hn::InterleaveUpper(d, p0, p2), z1 = hn::InterleaveUpper(d, p1, p3);
    return {hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b), hn::InterleaveLower(d, z0, z1)};
}

// The smallest or largest x, y and z of the four.
template <class Choose>
HWY_INLINE Vec reduce(const Rows& r, Choose choose)
{
    const Lanes d;
    const Vec xz = choose(hn::InterleaveLower(d, r.x, r.z), hn::InterleaveUpper(d, r.x, r.z));
    const Vec yy = choose(hn::InterleaveLower(d, r.y, r.y), hn::InterleaveUpper(d, r.y, r.y));
    return choose(hn::InterleaveLower(d, xz, yy), hn::InterleaveUpper(d, xz, yy));
}

Corners corners_of(const WideNode& node)
{
    const Lanes d;
    const auto both = [&](auto choose, int row) {
        return choose(hn::Load(d, node.planes[row]), hn::Load(d, node.planes[row] + 4));
    };
    return {reduce({both(smaller, 0), both(smaller, 1), both(smaller, 2)}, smaller),
            reduce({both(larger, 3), both(larger, 4), both(larger, 5)}, larger)};
}

// The boxes of a node's children, and what one weighs in the cost; unused ones are empty.
struct Children
{
    Corners box[node_width];
    alignas(16) float weight[node_width] = {};
};

// How far ahead of a block, in blocks, its triangles and then their vertices are asked for.
constexpr std::size_t ahead = 12;

// Nodes that one thread takes at a time, from the last to the first: children come after their parents.
constexpr std::size_t chunk_size = 512;

class Refitter
{
  public:
    Refitter(const PackedScene& scene, const RefitArrays& tree)
        : scene_(scene), tree_(tree), last_(scene.positions.empty() ? 0 : scene.positions.size() - 1)
    {
    }

    Refitted run();

  private:
    const PackedScene& scene_;
    const RefitArrays& tree_;
    const std::size_t last_; // vertex
    float scale_ = 1;        // areas are in units in which the root was about as large as 1: no product overflows

    void find_scale();
    Vec position(uint vertex) const;
    Corners refit_triangles(TriangleBlock& block) const;
    Corners refit_spheres(const SphereBlock& block) const;
    Corners refit_leaf(ChildWord word, float& weight) const;
    void ask_ahead(std::size_t block) const;
    double finish(WideNode& node, const Children& children) const;
    double finish_late(WideNode& node) const;
    double refit_nodes();
};

void Refitter::find_scale()
{
    float size = 0;
    for (int axis = 0; axis < 3; ++axis) size = std::max(size, tree_.root->upper[axis] - tree_.root->lower[axis]);
    if (size > 0 && std::isfinite(1 / size)) scale_ = 1 / size;
}

HWY_INLINE Vec Refitter::position(uint vertex) const
{
    const float* at = &scene_.positions[vertex].x;
    if (HWY_LIKELY(vertex < last_)) return hn::LoadU(Lanes(), at); // reads into the next vertex
    alignas(16) const float three[4] = {at[0], at[1], at[2], 0.0f};
    return hn::Load(Lanes(), three);
}

HWY_INLINE Corners Refitter::refit_triangles(TriangleBlock& block) const
{
    const Lanes d;
    const hn::RebindToUnsigned<Lanes> du;
    const Vec nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
    Vec points[3][max_leaf_size];
    for (uint lane = 0; lane < max_leaf_size; ++lane) {
        const uint id = block.id[lane];
        if (id == none) {
            points[0][lane] = points[1][lane] = points[2][lane] = nan;
            continue;
        }
        const Triangle& triangle = scene_.triangles[id];
        points[0][lane] = position(triangle.v0);
        points[1][lane] = position(triangle.v1);
        points[2][lane] = position(triangle.v2);
    }
    Rows corner[3];
    auto largest = hn::Zero(du);
    const auto magnitude = hn::Set(du, 0x7fffffffu);
    for (int k = 0; k < 3; ++k) {
        corner[k] = transpose(points[k][0], points[k][1], points[k][2], points[k][3]);
        for (const Vec v : {corner[k].x, corner[k].y, corner[k].z})
            largest = hn::Max(largest, hn::And(hn::BitCast(du, v), magnitude));
    }
    const auto unseen = hn::RebindMask(d, hn::Gt(largest, hn::Set(du, 0x7f7fffffu))); // NaN or infinite

    const auto choose = [&](auto best, float otherwise, Vec a, Vec b, Vec c) {
        return hn::IfThenElse(unseen, hn::Set(d, otherwise), best(best(a, b), c));
    };
    const Rows lower = {choose(smaller, inf, corner[0].x, corner[1].x, corner[2].x),
                        choose(smaller, inf, corner[0].y, corner[1].y, corner[2].y),
                        choose(smaller, inf, corner[0].z, corner[1].z, corner[2].z)};
    const Rows upper = {choose(larger, -inf, corner[0].x, corner[1].x, corner[2].x),
                        choose(larger, -inf, corner[0].y, corner[1].y, corner[2].y),
                        choose(larger, -inf, corner[0].z, corner[1].z, corner[2].z)};
    for (int k = 0; k < 3; ++k) {
        hn::Store(hn::IfThenElse(unseen, nan, corner[k].x), d, block.v[k][0]);
        hn::Store(hn::IfThenElse(unseen, nan, corner[k].y), d, block.v[k][1]);
        hn::Store(hn::IfThenElse(unseen, nan, corner[k].z), d, block.v[k][2]);
    }
    // Adding 0 turns -0 into +0, as builders do: min and max of the two depend on the order.
    return {hn::Add(reduce(lower, smaller), hn::Zero(d)), hn::Add(reduce(upper, larger), hn::Zero(d))};
}

Corners Refitter::refit_spheres(const SphereBlock& block) const
{
    Corners all;
    for (const uint id : block.id) {
        if (id == none) continue;
        const Box box = sphere_box(scene_.spheres[id]);
        alignas(16) const float lower[4] = {box.lower.x, box.lower.y, box.lower.z, 0};
        alignas(16) const float upper[4] = {box.upper.x, box.upper.y, box.upper.z, 0};
        all.extend({hn::Load(Lanes(), lower), hn::Load(Lanes(), upper)});
    }
    return all;
}

static uint count_used(const uint* id)
{
    uint count = 0;
    for (uint lane = 0; lane < max_leaf_size; ++lane) count += id[lane] != none ? 1 : 0;
    return count;
}

// weight: the number of primitives in the leaf.
HWY_INLINE Corners Refitter::refit_leaf(ChildWord word, float& weight) const
{
    const uint index = word & child_index_mask;
    switch (static_cast<RefKind>(word >> 30)) {
    case RefKind::triangle:
        ask_ahead(index);
        weight = static_cast<float>(count_used(tree_.triangles[index].id));
        return refit_triangles(tree_.triangles[index]);
    case RefKind::sphere:
        weight = static_cast<float>(count_used(tree_.spheres[index].id));
        return refit_spheres(tree_.spheres[index]);
    default:
        throw Error("a tree with instances cannot be refitted", "build it anew");
    }
}

// Blocks are taken from the last to the first.
HWY_INLINE void Refitter::ask_ahead(std::size_t block) const
{
    if (block < 3 * ahead) return;
    const char* const later = reinterpret_cast<const char*>(&tree_.triangles[block - 3 * ahead]);
    for (std::size_t line = 0; line < sizeof(TriangleBlock); line += 64) __builtin_prefetch(later + line, 1);
    for (const uint id : tree_.triangles[block - ahead].id)
        if (id != none) __builtin_prefetch(&scene_.triangles[id]);
    for (const uint id : tree_.triangles[block - ahead / 2].id) {
        if (id == none) continue;
        const Triangle& triangle = scene_.triangles[id];
        for (const uint vertex : {triangle.v0, triangle.v1, triangle.v2}) __builtin_prefetch(&scene_.positions[vertex]);
    }
}

// Writes the boxes and orders of a node; returns the sum of its children's weights times areas.
HWY_INLINE double Refitter::finish(WideNode& node, const Children& children) const
{
    const Lanes d;
    const Vec scale = hn::Set(d, scale_);
    double cost = 0;
    for (int half = 0; half < 8; half += 4) {
        const Corners* box = children.box + half;
        const Rows lower = transpose(box[0].lower, box[1].lower, box[2].lower, box[3].lower);
        const Rows upper = transpose(box[0].upper, box[1].upper, box[2].upper, box[3].upper);
        hn::Store(lower.x, d, node.planes[0] + half);
        hn::Store(lower.y, d, node.planes[1] + half);
        hn::Store(lower.z, d, node.planes[2] + half);
        hn::Store(upper.x, d, node.planes[3] + half);
        hn::Store(upper.y, d, node.planes[4] + half);
        hn::Store(upper.z, d, node.planes[5] + half);
        const Vec x = hn::Mul(hn::Sub(upper.x, lower.x), scale), y = hn::Mul(hn::Sub(upper.y, lower.y), scale);
        const Vec z = hn::Mul(hn::Sub(upper.z, lower.z), scale);
        const Vec area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
        const Vec weight = hn::Load(d, children.weight + half);
        // Empty boxes have areas of no meaning.
        const Vec part = hn::IfThenElseZero(hn::Ge(x, hn::Zero(d)), hn::Mul(area, weight));
        alignas(16) float parts[4];
        hn::Store(part, d, parts);
        for (const float p : parts) cost += static_cast<double>(p);
    }
    order_children(node);
    return cost;
}

// For a node whose leaves are done, and whose other children were not when it was visited.
double Refitter::finish_late(WideNode& node) const
{
    Children children;
    for (uint slot = 0; slot < node_width; ++slot) {
        const ChildWord word = node.child[slot];
        Corners& box = children.box[slot];
        if (word >> 30 == 0) {
            box = corners_of(tree_.nodes[word]);
            children.weight[slot] = 1.0f;
        } else if (word != word_done) {
            box = refit_leaf(word, children.weight[slot]);
        }
    }
    return finish(node, children);
}

// Returns the sum of weight times area of all that is below the root. Each chunk does what it can by itself; what has
// descendants in later chunks, which is little more than the way from the root to each chunk, follows at the end.
double Refitter::refit_nodes()
{
    struct Chunk
    {
        double cost = 0;
        std::vector<std::size_t> waiting; // descending
    };
    const std::size_t count = tree_.nodes.size();
    std::vector<Chunk> chunks((count + chunk_size - 1) / chunk_size);
    parallel_for(chunks.size(), [&](std::size_t c) {
        const std::size_t begin = c * chunk_size, end = std::min(begin + chunk_size, count);
        std::array<Corners, chunk_size> boxes;
        std::array<std::uint8_t, chunk_size> ready;
        double cost = 0;
        for (std::size_t i = end; i-- > begin;) {
            WideNode& node = tree_.nodes[i];
            const auto is_late = [&](ChildWord word) {
                return word >> 30 == 0 && (word >= end || ready[word - begin] == 0);
            };
            ready[i - begin] = std::none_of(node.child, node.child + node_width, is_late) ? 1 : 0;
            if (ready[i - begin] == 0) {
                chunks[c].waiting.push_back(i);
                continue;
            }
            Children children;
            Corners all;
            for (uint slot = 0; slot < node_width; ++slot) {
                const ChildWord word = node.child[slot];
                if (word == word_done) continue;
                Corners& box = children.box[slot];
                if (word >> 30 == 0) {
                    box = boxes[word - begin];
                    children.weight[slot] = 1.0f;
                } else {
                    box = refit_leaf(word, children.weight[slot]);
                }
                all.extend(box);
            }
            boxes[i - begin] = all;
            cost += finish(node, children);
        }
        chunks[c].cost = cost;
    });
    double cost = 0;
    for (std::size_t c = chunks.size(); c-- > 0;) {
        cost += chunks[c].cost;
        for (const std::size_t i : chunks[c].waiting) cost += finish_late(tree_.nodes[i]);
    }
    return cost;
}

Refitted Refitter::run()
{
    WideRoot& root = *tree_.root;
    Refitted result;
    if (root.word == word_done) return result;
    find_scale();
    Corners box;
    const bool is_leaf = root.word >> 30 != 0;
    if (is_leaf) {
        float weight = 0;
        box = refit_leaf(root.word, weight);
        result.cost = static_cast<double>(weight);
    } else {
        const double below = refit_nodes();
        box = corners_of(tree_.nodes[root.word]);
        result.cost = 1 + below;
    }
    hn::StoreU(box.lower, Lanes(), root.lower);
    hn::StoreU(box.upper, Lanes(), root.upper);
    root.lower[3] = root.upper[3] = 0;
    result.box = {{root.lower[0], root.lower[1], root.lower[2]}, {root.upper[0], root.upper[1], root.upper[2]}};
    const double area = result.box.half_area() * static_cast<double>(scale_) * static_cast<double>(scale_);
    if (!is_leaf && area > 0) result.cost = 1 + (result.cost - 1) / area;
    return result;
}

} // namespace

Refitted refit(const PackedScene& scene, const RefitArrays& tree)
{
    return Refitter(scene, tree).run();
}

} // namespace snell

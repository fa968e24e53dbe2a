#include "snell/bvh/quality.h"

#include "snell/bvh/build.h"
#include "snell/core/parallel.h"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>

namespace snell {
namespace {

using glm::dvec3;

// Entries are numbered in the order in which a walk through the tree meets them: a subtree is a range of numbers.
struct Range
{
    uint begin = 0, end = 0;
};

// A convex polygon with its bounds and surface. Clipping a triangle to a box leaves at most nine corners.
struct Polygon
{
    static constexpr std::size_t capacity = 12;
    std::array<dvec3, capacity> corners;
    std::size_t size = 0;
    dvec3 lower, upper;
    double area = 0;

    void add(const dvec3& p)
    {
        if (size < capacity) corners[size++] = p; // more come from rounding only and enclose next to nothing
    }
    void measure()
    {
        dvec3 sum(0.0);
        lower = upper = corners[0];
        for (std::size_t i = 1; i < size; ++i) {
            lower = glm::min(lower, corners[i]), upper = glm::max(upper, corners[i]);
            sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
        }
        area = size < 3 ? 0.0 : 0.5 * glm::length(sum);
    }
};

// result: the part of `polygon` with sign * p[axis] <= sign * plane. Not measured.
void cut(const Polygon& polygon, int axis, double plane, double sign, Polygon& result)
{
    result.size = 0;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const dvec3 &from = polygon.corners[i], &to = polygon.corners[i + 1 < polygon.size ? i + 1 : 0];
        const double a = sign * (from[axis] - plane), b = sign * (to[axis] - plane);
        if (a <= 0) result.add(from);
        if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
            dvec3 p = from + (to - from) * (a / (a - b));
            p[axis] = plane; // so that cutting there again changes nothing
            result.add(p);
        }
    }
}

bool apart(const Polygon& polygon, const Box& box)
{
    const dvec3 lower(box.lower), upper(box.upper);
    return glm::any(glm::lessThan(polygon.upper, lower)) || glm::any(glm::lessThan(upper, polygon.lower));
}

bool inside(const Polygon& polygon, const Box& box)
{
    const dvec3 lower(box.lower), upper(box.upper);
    return glm::all(glm::lessThanEqual(lower, polygon.lower)) && glm::all(glm::lessThanEqual(polygon.upper, upper));
}

// Makes `result` the part of the polygon that lies in the box.
void clip(const Polygon& polygon, const Box& box, Polygon& result)
{
    Polygon other; // cuts go to and fro between the two
    const Polygon* from = &polygon;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            const double plane = sign > 0 ? box.upper[axis] : box.lower[axis];
            if (sign > 0 ? polygon.upper[axis] <= plane : polygon.lower[axis] >= plane) continue;
            Polygon* to = from == &result ? &other : &result;
            cut(*from, axis, plane, sign, *to);
            from = to;
        }
    if (from != &result) result = *from;
    if (result.size > 0) result.measure();
}

class Overlap
{
  public:
    Overlap(const PackedScene& packed, const BinaryTree& binary) : scene(packed), tree(binary)
    {
        number_entries();
        collect_triangles();
    }

    // EPO; the sum is in a fixed order, so that it does not depend on the threads.
    double measure() const
    {
        constexpr std::size_t chunk = 256;
        std::vector<Areas> parts((entries.size() + chunk - 1) / chunk);
        parallel_for(parts.size(), [&](std::size_t i) {
            const std::size_t end = std::min(entries.size(), (i + 1) * chunk);
            for (std::size_t number = i * chunk; number < end; ++number) add(static_cast<uint>(number), parts[i]);
        });
        Areas sum;
        for (const Areas& part : parts) sum.total += part.total, sum.foreign += part.foreign;
        return sum.total > 0 ? sum.foreign / sum.total : 0.0;
    }

  private:
    struct Areas
    {
        double total = 0;   // of the triangles
        double foreign = 0; // of their parts in boxes that they do not belong to, times what a visit there costs
    };

    const PackedScene& scene;
    const BinaryTree& tree;
    std::vector<Range> ranges; // by node: the numbers of the entries below
    std::vector<uint> entries; // by number: position in tree.order
    std::vector<uint> first;   // by triangle from `lowest` on: where its numbers begin; one more at the end
    std::vector<uint> numbers; // ascending for each triangle
    uint lowest = 0;

    void number_entries()
    {
        ranges.resize(tree.nodes.size());
        std::vector<uint> waiting = {0}, inner;
        while (!waiting.empty()) {
            const uint at = waiting.back();
            waiting.pop_back();
            const BinaryNode& node = tree.nodes[at];
            ranges[at].begin = static_cast<uint>(entries.size());
            if (node.count == 0) {
                inner.push_back(at);
                waiting.push_back(node.link);
                waiting.push_back(at + 1);
                continue;
            }
            for (uint i = 0; i < node.count; ++i) entries.push_back(node.link + i);
            ranges[at].end = static_cast<uint>(entries.size());
        }
        for (std::size_t i = inner.size(); i-- > 0;) ranges[inner[i]].end = ranges[tree.nodes[inner[i]].link].end;
    }

    const BinaryTree::Entry& entry(std::size_t number) const { return tree.order[entries[number]]; }

    void collect_triangles()
    {
        uint highest = 0;
        lowest = std::numeric_limits<uint>::max();
        for (std::size_t i = 0; i < entries.size(); ++i)
            if (entry(i).kind == RefKind::triangle) {
                lowest = std::min(lowest, entry(i).index);
                highest = std::max(highest, entry(i).index);
            }
        if (lowest > highest) return;
        first.resize(highest - lowest + 2);
        for (std::size_t i = 0; i < entries.size(); ++i)
            if (entry(i).kind == RefKind::triangle) ++first[entry(i).index - lowest + 1];
        for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
        numbers.resize(first.back());
        std::vector<uint> next(first.begin(), first.end() - 1);
        for (std::size_t i = 0; i < entries.size(); ++i)
            if (entry(i).kind == RefKind::triangle) numbers[next[entry(i).index - lowest]++] = static_cast<uint>(i);
    }

    // The triangle of an entry, once however many entries it has.
    void add(uint number, Areas& areas) const
    {
        if (entry(number).kind != RefKind::triangle) return;
        const uint index = entry(number).index;
        const std::span<const uint> own =
            std::span(numbers).subspan(first[index - lowest], first[index - lowest + 1] - first[index - lowest]);
        if (own.front() != number) return;
        const Triangle& tri = scene.triangles[index];
        Polygon whole;
        for (const uint vertex : {tri.v0, tri.v1, tri.v2}) whole.add(dvec3(scene.positions[vertex]));
        whole.measure();
        areas.total += whole.area;
        walk(0, whole, own, areas);
    }

    // polygon: what of the triangle lies in the boxes above. Recursion is as deep as the tree, which builders bound.
    void walk(uint at, const Polygon& polygon, std::span<const uint> own, Areas& areas) const
    {
        const BinaryNode& node = tree.nodes[at];
        if (apart(polygon, node.box)) return;
        if (inside(polygon, node.box)) {
            visit(at, polygon, own, areas);
            return;
        }
        Polygon part;
        clip(polygon, node.box, part);
        visit(at, part, own, areas);
    }

    void visit(uint at, const Polygon& part, std::span<const uint> own, Areas& areas) const
    {
        if (!(part.area > 0)) return; // it only touches the box
        const BinaryNode& node = tree.nodes[at];
        const auto found = std::lower_bound(own.begin(), own.end(), ranges[at].begin);
        const bool belongs = found != own.end() && *found < ranges[at].end;
        if (!belongs) areas.foreign += part.area * double{node.count > 0 ? cost_of_block : cost_of_node};
        if (node.count > 0) return;
        walk(at + 1, part, own, areas);
        walk(node.link, part, own, areas);
    }
};

} // namespace

TreeQuality measure_quality(const PackedScene& scene, const BinaryTree& tree, bool with_epo)
{
    TreeQuality quality;
    if (tree.nodes.empty()) return quality;
    std::vector<int> depth(tree.nodes.size());
    double cost = 0, leaf_depths = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const BinaryNode& node = tree.nodes[i];
        const double area = node.box.half_area();
        if (node.count == 0) {
            ++quality.nodes;
            cost += area * double{cost_of_node};
            depth[i + 1] = depth[node.link] = depth[i] + 1; // children come after their parents
        } else {
            ++quality.leaves;
            quality.references += node.count;
            quality.depth = std::max(quality.depth, depth[i]);
            leaf_depths += depth[i];
            cost += area * double{cost_of_block};
        }
    }
    const double area = tree.nodes[0].box.half_area();
    quality.sah = area > 0 ? cost / area : 0.0;
    quality.mean_leaf_depth = leaf_depths / static_cast<double>(quality.leaves);
    quality.mean_leaf_size = static_cast<double>(quality.references) / static_cast<double>(quality.leaves);
    if (with_epo) quality.epo = Overlap(scene, tree).measure();
    return quality;
}

} // namespace snell

#include "snell/io/polygon.h"

#include <cmath>

namespace snell {
namespace {

struct Normal
{
    double x = 0, y = 0, z = 0;
};

Normal newell(std::span<const vec3> corners)
{
    // Relative to the first corner: far from the origin the products would lose the polygon.
    const vec3 o = corners[0];
    Normal n;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const vec3 pf = corners[i], qf = corners[i + 1 < corners.size() ? i + 1 : 0];
        const double px = double(pf.x) - o.x, py = double(pf.y) - o.y, pz = double(pf.z) - o.z;
        const double qx = double(qf.x) - o.x, qy = double(qf.y) - o.y, qz = double(qf.z) - o.z;
        n.x += py * qz - pz * qy;
        n.y += pz * qx - px * qz;
        n.z += px * qy - py * qx;
    }
    return n;
}

} // namespace

vec3 polygon_normal(std::span<const vec3> corners)
{
    if (corners.size() < 3) return vec3(0.0f);
    const Normal n = newell(corners);
    return vec3(static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z));
}

std::span<const uvec3> Triangulator::operator()(std::span<const vec3> corners)
{
    triangles_.clear();
    tests_ = 0;
    const std::size_t count = corners.size();
    if (count < 3) return triangles_;
    if (count == 3) {
        triangles_.push_back(uvec3(0, 1, 2));
        return triangles_;
    }

    // Drop the axis along which the polygon is thinnest, so that its coordinates stay exact, and order the other two
    // so that it runs counter-clockwise.
    const Normal n = newell(corners);
    const double ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    rest_.resize(count);
    for (uint i = 0; i < count; ++i) rest_[i] = i;
    if (!(std::isfinite(ax + ay + az) && ax + ay + az > 0)) {
        fan(rest_);
        return triangles_;
    }
    const int drop = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if ((drop == 0 ? n.x : drop == 1 ? n.y : n.z) < 0) std::swap(u, v);
    points_.resize(count);
    for (std::size_t i = 0; i < count; ++i) points_[i] = {double(corners[i][u]), double(corners[i][v])};

    if (count == 4 && quad()) return triangles_;
    clip();
    return triangles_;
}

// Twice the signed area: > 0 where a, b, c turns left. Nearly exact, for the coordinates are floats.
double Triangulator::turn(uint a, uint b, uint c) const
{
    const Point &p = points_[a], &q = points_[b], &r = points_[c];
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

// The common case: cut along the first diagonal that lies inside.
bool Triangulator::quad()
{
    if (turn(0, 1, 2) > 0 && turn(0, 2, 3) > 0) {
        add(0, 1, 2), add(0, 2, 3);
        return true;
    }
    if (turn(0, 1, 3) > 0 && turn(1, 2, 3) > 0) {
        add(0, 1, 3), add(1, 2, 3);
        return true;
    }
    return false;
}

void Triangulator::add(uint a, uint b, uint c)
{
    triangles_.push_back(uvec3(a, b, c));
}

void Triangulator::fan(std::span<const uint> corners)
{
    for (std::size_t i = 2; i < corners.size(); ++i) add(corners[0], corners[i - 1], corners[i]);
}

void Triangulator::update(uint b)
{
    convex_[b] = turn(previous_[b], b, next_[b]) > 0;
}

void Triangulator::unlink(uint b)
{
    next_[previous_[b]] = next_[b];
    previous_[next_[b]] = previous_[b];
    removed_[b] = 1;
    const uint a = previous_[b], c = next_[b];
    for (const uint corner : {a, c}) {
        const bool was_convex = convex_[corner];
        update(corner);
        // Clipping a corner that is no ear, or rounding, can make a neighbour concave that was not listed as such.
        if (was_convex && !convex_[corner]) concave_.push_back(corner);
    }
}

// Is the triangle at b part of the polygon? It is if b is convex and no other corner reaches into it; only concave
// corners can be the first to do so. One that just touches counts as well: it may be where the polygon folds back.
bool Triangulator::is_ear(uint b)
{
    ++tests_;
    if (!convex_[b]) return false;
    const uint a = previous_[b], c = next_[b];
    for (std::size_t k = 0; k < concave_.size();) {
        ++tests_;
        const uint p = concave_[k];
        if (removed_[p] || convex_[p]) { // out of date
            concave_[k] = concave_.back();
            concave_.pop_back();
            continue;
        }
        ++k;
        if (p == a || p == c) continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
}

void Triangulator::clip()
{
    const uint count = static_cast<uint>(points_.size());
    next_.resize(count);
    previous_.resize(count);
    convex_.assign(count, 0);
    removed_.assign(count, 0);
    concave_.clear();
    for (uint i = 0; i < count; ++i) {
        next_[i] = i + 1 < count ? i + 1 : 0;
        previous_[i] = i > 0 ? i - 1 : count - 1;
    }
    for (uint i = 0; i < count; ++i) {
        update(i);
        if (!convex_[i]) concave_.push_back(i);
    }
    const std::size_t most_tests = std::size_t{tests_per_corner} * count;

    uint left = count, corner = 0, tried = 0;
    while (left > 3 && tests_ < most_tests) {
        if (is_ear(corner)) {
            add(previous_[corner], corner, next_[corner]);
            unlink(corner);
            --left, tried = 0;
            // The one after the next: taking neighbours in turn would make a fan of slivers.
            corner = next_[next_[corner]];
        } else if (++tried <= left) {
            corner = next_[corner];
        } else {
            // A whole round without an ear. A corner on a straight line or a spike spans no area: drop it. If there
            // is none either, the polygon crosses itself; a convex corner is the least harm.
            constexpr uint nothing = 0xffffffffu;
            uint straight = nothing, convex = nothing;
            for (uint i = 0; i < left; ++i, corner = next_[corner]) {
                if (turn(previous_[corner], corner, next_[corner]) == 0) straight = corner;
                if (convex_[corner]) convex = corner;
            }
            const uint chosen = straight != nothing ? straight : convex != nothing ? convex : corner;
            if (chosen != straight) add(previous_[chosen], chosen, next_[chosen]);
            corner = next_[chosen];
            unlink(chosen);
            --left, tried = 0;
        }
    }
    rest_.clear();
    for (uint i = 0; i < left; ++i, corner = next_[corner]) rest_.push_back(corner);
    if (left > 3 || turn(rest_[0], rest_[1], rest_[2]) != 0) fan(rest_);
}

} // namespace snell

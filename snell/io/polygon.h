// Polygons into triangles.
#pragma once

#include "snell/core/vec.h"

#include <span>
#include <vector>

namespace snell {

// The unnormalised normal of a polygon by Newell's method: twice its area long, pointing where its corners run
// counter-clockwise; for a polygon that is not planar, that of the best fitting plane.
vec3 polygon_normal(std::span<const vec3> corners);

// Cuts polygons into triangles by clipping ears (Meisters 1975), in the plane that fits best. Concave polygons, corners
// on a straight line, repeated corners and holes cut open by a bridge (two coincident edges) come out right; the
// triangles keep the polygon's winding. n corners give n - 2 triangles, fewer where a corner spans no area. A polygon
// that crosses itself, has no area or a corner that is not finite gives some triangles between its corners.
//
// Time: O(n r) for r concave corners, and never more than `tests_per_corner` point tests a corner: what is left of a
// larger polygon then is cut as a fan. An object of this class keeps its memory from one polygon to the next.
class Triangulator
{
  public:
    static constexpr std::size_t tests_per_corner = 1000; // polygons of up to 1000 corners are always cut exactly

    // The triangles as indices into `corners`; valid until the next call. Fewer than three corners: none.
    std::span<const uvec3> operator()(std::span<const vec3> corners);

    // How many point tests the last polygon took: a measure of time that is the same on every machine.
    std::size_t tests() const { return tests_; }

  private:
    struct Point
    {
        double x, y;
    };

    bool quad();
    void fan(std::span<const uint> corners);
    void clip();
    double turn(uint a, uint b, uint c) const;
    bool is_ear(uint b);
    void add(uint a, uint b, uint c);
    void unlink(uint b);
    void update(uint b);

    std::vector<Point> points_;
    std::vector<uint> next_, previous_;
    std::vector<uint> concave_;          // corners that were concave or straight when listed
    std::vector<unsigned char> convex_;  // by corner: it turns left, strictly
    std::vector<unsigned char> removed_; // by corner
    std::vector<uint> rest_;
    std::vector<uvec3> triangles_;
    std::size_t tests_ = 0;
};

} // namespace snell

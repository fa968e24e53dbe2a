#include "snell/io/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace snell {
namespace {

double area_of(std::span<const vec3> corners, std::span<const uvec3> triangles)
{
    double area = 0;
    for (const uvec3 t : triangles)
        area += 0.5 * length(cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]));
    return area;
}

// In the plane z = 0: all triangles run counter-clockwise, each corner is used, and the areas add up.
void expect_cut(const std::vector<vec3>& corners, std::size_t triangles_wanted)
{
    Triangulator triangulate;
    const std::span<const uvec3> triangles = triangulate(corners);
    EXPECT_EQ(triangles.size(), triangles_wanted);
    for (const uvec3 t : triangles) {
        ASSERT_LT(max(t.x, max(t.y, t.z)), corners.size());
        EXPECT_GT(cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]).z, 0.0f);
    }
    const double area = 0.5 * length(polygon_normal(corners));
    EXPECT_NEAR(area_of(corners, triangles), area, 1e-5 * area);
}

std::vector<vec3> flat(std::initializer_list<vec2> points)
{
    std::vector<vec3> out;
    for (const vec2 p : points) out.push_back(vec3(p, 0.0f));
    return out;
}

// A simple polygon: star-shaped around the origin, so that a radius for each angle is all it takes.
std::vector<vec3> random_star(std::mt19937& random, int count, float least_radius)
{
    std::uniform_real_distribution<float> radius(least_radius, 1.0f);
    std::vector<vec3> corners;
    for (int i = 0; i < count; ++i) {
        const float angle = 6.2831853f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        corners.push_back(radius(random) * vec3(std::cos(angle), std::sin(angle), 0.0f));
    }
    return corners;
}

TEST(Polygon, TrianglesAndQuads)
{
    Triangulator triangulate;
    EXPECT_TRUE(triangulate({}).empty());
    EXPECT_TRUE(triangulate(flat({{0, 0}, {1, 0}})).empty());
    expect_cut(flat({{0, 0}, {1, 0}, {0, 1}}), 1);
    expect_cut(flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 2);
    // Arrowheads with the concave corner at each place: one diagonal only is right.
    expect_cut(flat({{0, 0}, {2, -1}, {0.5f, 0}, {2, 1}}), 2);
    expect_cut(flat({{2, 1}, {0, 0}, {2, -1}, {0.5f, 0}}), 2);
    expect_cut(flat({{0.5f, 0}, {2, 1}, {0, 0}, {2, -1}}), 2);
}

TEST(Polygon, ConcaveShapes)
{
    expect_cut(flat({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}), 4);                 // L
    expect_cut(flat({{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}), 6); // U
    expect_cut(flat({{0, 0},
                     {4, 0},
                     {4, 3},
                     {1, 3},
                     {1, 1},
                     {3, 1},
                     {3, 2},
                     {2, 2},
                     {2, 1.5f},
                     {2.5f, 1.5f},
                     {2.5f, 1.25f},
                     {1.25f, 1.25f},
                     {1.25f, 2.75f},
                     {3.5f, 2.75f},
                     {3.5f, 0.5f},
                     {0, 0.5f}}),
               14); // a spiral
}

TEST(Polygon, CornersOnStraightLines)
{
    // A triangle with more corners along its sides: all of them are used, or neighbours would have cracks.
    expect_cut(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {0, 2}, {0, 1}}), 7);
    // A repeated corner spans nothing.
    expect_cut(flat({{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}}), 2);
}

TEST(Polygon, HoleCutOpenByABridge)
{
    expect_cut(flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}), 8);
}

TEST(Polygon, HolesCutOpenFromOneCorner)
{
    // A square with four square holes, each joined to the square's first corner, which so coincides with four others.
    std::vector<vec3> corners = flat({{0, 0}, {9, 0}, {9, 9}, {0, 9}});
    for (const vec2 at : {vec2(1, 6), vec2(3, 4.5f), vec2(4.5f, 3), vec2(6, 1)}) {
        corners.push_back(vec3(0));
        for (const vec2 step : {vec2(0, 0), vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)})
            corners.push_back(vec3(at + step, 0.0f));
    }
    EXPECT_FLOAT_EQ(length(polygon_normal(corners)), 2 * (81.0f - 4.0f));
    for (std::size_t i = 0; i < corners.size(); ++i) {
        SCOPED_TRACE(i);
        expect_cut(corners, corners.size() - 2);
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    }
}

TEST(Polygon, AreaIsKeptOnRandomPolygonsInRandomPlanes)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> any(-1.0f, 1.0f);
    Triangulator triangulate;
    for (int i = 0; i < 500; ++i) {
        std::vector<vec3> corners = random_star(random, 3 + i % 60, 0.05f);
        const vec3 u = normalize(vec3(any(random), any(random), any(random)));
        const vec3 v = normalize(cross(u, vec3(any(random), any(random), any(random))));
        const vec3 offset = 100.0f * vec3(any(random), any(random), any(random));
        for (vec3& corner : corners) corner = corner.x * u + corner.y * v + offset;
        const std::span<const uvec3> triangles = triangulate(corners);
        EXPECT_EQ(triangles.size(), corners.size() - 2);
        const vec3 normal = polygon_normal(corners);
        EXPECT_GT(dot(normal, cross(u, v)), 0.0f);
        const double area = 0.5 * length(normal);
        EXPECT_NEAR(area_of(corners, triangles), area, 2e-3 * area) << "polygon " << i;
    }
}

TEST(Polygon, WorthlessPolygonsEndInTrianglesBetweenTheirCorners)
{
    const float nan = std::nanf(""), inf = INFINITY;
    const std::vector<std::vector<vec3>> all = {
        std::vector<vec3>(7, vec3(1.0f)),                                              // a point
        flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}}),                                // a line
        flat({{0, 0}, {2, 2}, {2, 0}, {0, 2}}),                                        // a bow tie
        flat({{0, 3}, {2, -3}, {-3, 1}, {3, 1}, {-2, -3}}),                            // a pentagram
        {vec3(0), vec3(1, 0, 0), vec3(nan, 1, 0), vec3(0, 1, 0), vec3(0, 0, 1)},       // not a number
        {vec3(0), vec3(inf, 0, 0), vec3(1, 1, 0), vec3(0, -inf, 0), vec3(0, 0, 1)},    // infinite
        {vec3(3e38f), vec3(-3e38f, 0, 0), vec3(3e38f, -3e38f, 0), vec3(0), vec3(1.0f)} // overflows
    };
    Triangulator triangulate;
    for (const std::vector<vec3>& corners : all) {
        const std::span<const uvec3> triangles = triangulate(corners);
        EXPECT_LE(triangles.size(), corners.size() - 2);
        for (const uvec3 t : triangles) EXPECT_LT(max(t.x, max(t.y, t.z)), corners.size());
    }
}

TEST(Polygon, HugePolygonsTakeLinearTime)
{
    std::mt19937 random(1);
    Triangulator triangulate;
    // 1000 corners, half of them concave: still exact.
    const std::vector<vec3> large = random_star(random, 1000, 0.01f);
    const double area = 0.5 * length(polygon_normal(large));
    EXPECT_NEAR(area_of(large, triangulate(large)), area, 1e-3 * area);

    // A comb with 10,000 teeth: by plain ear clipping the time grows with the square of their number.
    std::vector<vec3> comb;
    for (int i = 0; i < 10000; ++i) {
        const float x = static_cast<float>(i);
        comb.push_back(vec3(x, 0, 0)), comb.push_back(vec3(x + 0.5f, 1000, 0));
    }
    comb.push_back(vec3(10000, 2000, 0)), comb.push_back(vec3(0, 2000, 0));
    EXPECT_GT(triangulate(comb).size(), 10000u);
    EXPECT_LT(triangulate.tests(), (Triangulator::tests_per_corner + 2) * comb.size());
}

} // namespace
} // namespace snell

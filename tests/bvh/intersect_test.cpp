// The kernel's intersection functions one by one, against places that are known.
#include "snell/kernel/intersect.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

TEST(IntersectSphere, FromOutsideInsideAndSurface)
{
    const Ray outside = make_ray(vec3(0.0f, 0.0f, 5.0f), vec3(0.0f, 0.0f, -2.0f), infinity());
    EXPECT_FLOAT_EQ(intersect_sphere(outside, vec3(0.0f), 1.0f).t, 2.0f); // t counts in lengths of the direction
    const Ray inside = make_ray(vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), infinity());
    EXPECT_FLOAT_EQ(intersect_sphere(inside, vec3(0.0f), 3.0f).t, 3.0f);
    const Ray away = make_ray(vec3(0.0f, 0.0f, 5.0f), vec3(0.0f, 0.0f, 1.0f), infinity());
    EXPECT_FALSE(intersect_sphere(away, vec3(0.0f), 1.0f).ok);

    // From the surface inwards: the far side, not the start.
    const Ray through = make_ray(vec3(1.0f, 0.0f, 0.0f), vec3(-1.0f, 0.0f, 0.0f), infinity());
    EXPECT_FLOAT_EQ(intersect_sphere(through, vec3(0.0f), 1.0f).t, 2.0f);
}

TEST(IntersectSphere, RespectsTheOpenInterval)
{
    Ray ray = make_ray(vec3(-3.0f, 0.0f, 0.0f), vec3(1.0f, 0.0f, 0.0f), infinity()); // hits at 2 and 4
    EXPECT_EQ(intersect_sphere(ray, vec3(0.0f), 1.0f).t, 2.0f);
    ray.t_min = 2.0f;
    EXPECT_EQ(intersect_sphere(ray, vec3(0.0f), 1.0f).t, 4.0f);
    ray.t_max = 4.0f;
    EXPECT_FALSE(intersect_sphere(ray, vec3(0.0f), 1.0f).ok);
    EXPECT_EQ(intersect_sphere(ray, vec3(0.0f), 1.0f).t, 4.0f); // a miss says t_max
    ray.t_max = 1e30f;
    ray.t_min = 4.0f;
    EXPECT_FALSE(intersect_sphere(ray, vec3(0.0f), 1.0f).ok);
}

// Far away, the textbook's discriminant b^2 - 4ac has lost every digit; this one has not.
TEST(IntersectSphere, StaysRoundFarAway)
{
    Random random(1);
    int hits = 0, wrong = 0;
    const float distance = 20'000.0f;
    for (int i = 0; i < 10'000; ++i) {
        const float x = random.range(-1.5f, 1.5f), y = random.range(-1.5f, 1.5f);
        const Ray ray = make_ray(vec3(x, y, distance), vec3(0.0f, 0.0f, -1.0f), infinity());
        const Intersection r = intersect_sphere(ray, vec3(0.0f), 1.0f);
        hits += r.ok;
        wrong += r.ok != (x * x + y * y < 1.0f);
        if (r.ok) {
            EXPECT_NEAR(distance - r.t, std::sqrt(std::max(0.0f, 1.0f - x * x - y * y)), 0.05f);
        }
    }
    EXPECT_GT(hits, 3000);
    EXPECT_LE(wrong, 2);
}

TEST(IntersectSphere, AnyLengthOfDirection)
{
    for (const float scale : {1e-29f, 1e-20f, 1.0f, 1e20f, 1e30f}) {
        const Ray ray = make_ray(vec3(0.0f, 0.0f, 3.0f), vec3(0.0f, 0.0f, -scale), infinity());
        ASSERT_TRUE(is_traceable(ray));
        EXPECT_NEAR(intersect_sphere(ray, vec3(0.0f), 1.0f).t * scale, 2.0f, 1e-5f) << scale;
    }
}

TEST(IntersectPlane, BothSides)
{
    const vec3 up(0.0f, 1.0f, 0.0f);
    EXPECT_FLOAT_EQ(intersect_plane(make_ray(vec3(0.0f, 3.0f, 0.0f), -up, infinity()), up, 1.0f).t, 2.0f);
    EXPECT_FLOAT_EQ(intersect_plane(make_ray(vec3(0.0f, -3.0f, 0.0f), up, infinity()), up, 1.0f).t, 4.0f);
    EXPECT_FALSE(intersect_plane(make_ray(vec3(0.0f, 3.0f, 0.0f), up, infinity()), up, 1.0f).ok);
    EXPECT_FALSE(intersect_plane(make_ray(vec3(0.0f, 1.0f, 0.0f), vec3(1.0f, 0.0f, 0.0f), infinity()), up, 1.0f).ok);
}

// Both tests find the point that the barycentric weights describe; u belongs to vertex 1 and v to vertex 2.
TEST(IntersectTriangle, BarycentricsAndDistance)
{
    Random random(2);
    for (int i = 0; i < 2000; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f), c = random.in_box(1.0f);
        if (length(cross(b - a, c - a)) < 0.1f) continue;
        float u = random.range(0.05f, 0.9f), v = random.range(0.05f, 0.9f);
        if (u + v > 0.95f) u = 0.5f * u, v = 0.5f * v;
        const vec3 target = (1.0f - u - v) * a + u * b + v * c;
        vec3 from = random.in_box(2.0f);
        if (std::abs(dot(normalize(cross(b - a, c - a)), target - from)) < 0.2f) continue;
        const Ray ray = ray_between(from, target); // t is 1 there
        for (const Intersection& r : {intersect_triangle_watertight(ray, shear_ray(ray), a, b, c),
                                      intersect_triangle_moller_trumbore(ray, a, b, c)}) {
            ASSERT_TRUE(r.ok);
            EXPECT_NEAR(r.t, 1.0f, 1e-4f);
            EXPECT_NEAR(r.u, u, 1e-4f);
            EXPECT_NEAR(r.v, v, 1e-4f);
        }
        Ray missing = ray;
        missing.t_max = 0.99f;
        EXPECT_FALSE(intersect_triangle_watertight(missing, shear_ray(missing), a, b, c).ok);
        EXPECT_FALSE(intersect_triangle_moller_trumbore(missing, a, b, c).ok);
        missing = ray;
        missing.t_min = 1.01f;
        EXPECT_FALSE(intersect_triangle_watertight(missing, shear_ray(missing), a, b, c).ok);
        EXPECT_FALSE(intersect_triangle_moller_trumbore(missing, a, b, c).ok);
    }
}

// Signs of a * b - c * d are exact even where the products round to the same float.
TEST(EdgeFunction, HasTheExactSign)
{
    Random random(3);
    int rounded_alike = 0;
    for (int i = 0; i < 200'000; ++i) {
        const float a = random.range(0.5f, 2.0f), b = random.range(0.5f, 2.0f), c = random.range(0.5f, 2.0f);
        float d = a * b / c; // nearly a * b == c * d
        if (i % 3 == 1) d = std::nextafter(d, 4.0f);
        const double exact = double(a) * double(b) - double(c) * double(d); // products of floats are exact in double
        const float w = edge_function(a, b, c, d);
        ASSERT_EQ(w > 0.0f, exact > 0.0) << a << ' ' << b << ' ' << c << ' ' << d;
        ASSERT_EQ(w < 0.0f, exact < 0.0) << a << ' ' << b << ' ' << c << ' ' << d;
        rounded_alike += a * b == c * d && exact != 0.0;
    }
    EXPECT_GT(rounded_alike, 1000) << "the test does not reach the case that it is about";
}

TEST(IsTraceable, SaysWhichRaysHitNothing)
{
    const float nan = std::nanf("");
    Ray good = make_ray(vec3(0.0f), vec3(0.0f, 0.0f, 1.0f), infinity());
    EXPECT_TRUE(is_traceable(good));
    for (const float bad : {nan, infinity(), -infinity()}) {
        Ray ray = good;
        ray.origin.y = bad;
        EXPECT_FALSE(is_traceable(ray));
        ray = good;
        ray.direction.x = bad;
        EXPECT_FALSE(is_traceable(ray));
    }
    for (const float t_max : {nan, 0.0f, -1.0f, -infinity()}) {
        Ray ray = good;
        ray.t_max = t_max;
        EXPECT_FALSE(is_traceable(ray));
    }
    good.direction = vec3(0.0f, -0.0f, 0.0f);
    EXPECT_FALSE(is_traceable(good));
}

TEST(LongestAxis, AllOrders)
{
    for (const float x : {-3.0f, -2.0f, -1.0f, 0.0f, 1.0f, 2.0f, 3.0f})
        for (const float y : {-3.0f, -2.0f, -1.0f, 0.0f, 1.0f, 2.0f, 3.0f})
            for (const float z : {-3.0f, -2.0f, -1.0f, 0.0f, 1.0f, 2.0f, 3.0f}) {
                const vec3 d(x, y, z);
                EXPECT_EQ(std::abs(d[longest_axis(d)]), std::max({std::abs(x), std::abs(y), std::abs(z)}));
            }
}

} // namespace
} // namespace snell::test

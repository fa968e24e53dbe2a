#include "snell/core/error.h"
#include "snell/scene/scene.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace snell {
namespace {

float random(std::mt19937& engine, float low, float high)
{
    return std::uniform_real_distribution<float>(low, high)(engine);
}

vec3 random_vector(std::mt19937& engine, float size)
{
    const float x = random(engine, -size, size), y = random(engine, -size, size), z = random(engine, -size, size);
    return {x, y, z};
}

Transform random_transform(std::mt19937& engine)
{
    const vec3 factors = exp(random_vector(engine, 1.5f)) * sign(random_vector(engine, 1.0f));
    return compose(translation(random_vector(engine, 10.0f)),
                   compose(rotation(random_vector(engine, 1.0f), random(engine, -400.0f, 400.0f)),
                           compose(scaling(factors), rotation(random_vector(engine, 1.0f), 77.0f))));
}

void expect_near(vec3 a, vec3 b, float tolerance)
{
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

TEST(Transform, RotationTurnsCounterClockwise)
{
    expect_near(transform_point(rotation({0, 0, 5}, 90.0f), {1, 0, 0}), {0, 1, 0}, 1e-7f);
    expect_near(transform_point(rotation({0, 1, 0}, 90.0f), {0, 0, 1}), {1, 0, 0}, 1e-7f);
    expect_near(transform_point(rotation({1, 1, 1}, 120.0f), {1, 2, 3}), {3, 1, 2}, 1e-6f);
}

TEST(Transform, RotationNeedsAnAxis)
{
    EXPECT_THROW(rotation(vec3(0.0f), 30.0f), Error);
    EXPECT_THROW(rotation({0, 1, 0}, std::numeric_limits<float>::quiet_NaN()), Error);
}

TEST(Transform, ComposeAppliesTheSecondFirst)
{
    const Transform m = compose(translation({1, 0, 0}), scaling(vec3(2.0f)));
    expect_near(transform_point(m, {1, 1, 1}), {3, 2, 2}, 0.0f);

    std::mt19937 engine(1);
    for (int i = 0; i < 200; ++i) {
        const Transform a = random_transform(engine), b = random_transform(engine);
        const vec3 p = random_vector(engine, 5.0f);
        const vec3 step_by_step = transform_point(a, transform_point(b, p));
        expect_near(transform_point(compose(a, b), p), step_by_step, 1e-5f * (100.0f + length(step_by_step)));
    }
}

TEST(Transform, InverseUndoes)
{
    std::mt19937 engine(2);
    for (int i = 0; i < 500; ++i) {
        const Transform m = random_transform(engine);
        const std::optional<Transform> back = inverse(m);
        ASSERT_TRUE(back.has_value());
        const vec3 p = random_vector(engine, 5.0f);
        expect_near(transform_point(*back, transform_point(m, p)), p, 2e-4f);
        EXPECT_NEAR(determinant(m) * determinant(*back), 1.0f, 1e-4f);
    }
}

TEST(Transform, InverseOfExtremeScales)
{
    for (const vec3 factors : {vec3(1e-6f), vec3(1e6f), vec3(1.0f, 1e-6f, 1e6f), vec3(-1e-10f, 1.0f, 1.0f)}) {
        const std::optional<Transform> back = inverse(compose(rotation({1, 2, 3}, 40.0f), scaling(factors)));
        ASSERT_TRUE(back.has_value()) << factors.x;
    }
}

TEST(Transform, SingularOrInfiniteHasNoInverse)
{
    EXPECT_FALSE(inverse(scaling({1, 0, 1})));
    EXPECT_FALSE(inverse(compose(rotation({1, 2, 3}, 33.0f), compose(scaling({1, 1, 0}), rotation({3, 1, 2}, 21.0f)))));
    Transform m = identity_transform();
    m.y.w = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(inverse(m));
    m.y.w = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(inverse(m));
    EXPECT_FALSE(inverse(Transform{}));
}

TEST(Transform, UniformScale)
{
    const Transform turn = rotation({3, -1, 2}, 123.0f);
    EXPECT_NEAR(uniform_scale(compose(turn, scaling(vec3(2.5f)))), 2.5f, 1e-5f);
    EXPECT_NEAR(uniform_scale(compose(turn, scaling({2.5f, -2.5f, 2.5f}))), 2.5f, 1e-5f);
    EXPECT_EQ(uniform_scale(compose(turn, scaling({1, 1, 1.01f}))), 0.0f);
    Transform shear = identity_transform();
    shear.x.y = 0.1f;
    EXPECT_EQ(uniform_scale(shear), 0.0f);
}

TEST(Bounds, OfSpheresAndMeshes)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    EXPECT_TRUE(scene_bounds(scene).empty());
    place(scene, SphereDesc{"", {1, 2, 3}, 0.5f, grey});
    Bounds bounds = scene_bounds(scene);
    expect_near(bounds.lower, {0.5f, 1.5f, 2.5f}, 0.0f);
    expect_near(bounds.upper, {1.5f, 2.5f, 3.5f}, 0.0f);

    place(scene, make_box("", vec3(-1), vec3(1), grey), compose(translation({10, 0, 0}), rotation({0, 1, 0}, 45.0f)));
    bounds = scene_bounds(scene);
    expect_near(bounds.lower, {0.5f, -1.0f, -std::sqrt(2.0f)}, 1e-6f);
    expect_near(bounds.upper, {10.0f + std::sqrt(2.0f), 2.5f, 3.5f}, 1e-5f);
}

TEST(Bounds, OfAnEllipsoidAreTight)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    const auto sphere = add(scene, SphereDesc{"", vec3(0.0f), 1.0f, grey});
    const auto group = add(scene, Group{"", {}, {sphere}});
    const Transform m = compose(rotation({0, 0, 1}, 45.0f), scaling({3, 1, 1}));
    add(scene, InstanceDesc{"", group, m});
    // x^2 = 9/2 + 1/2 along both x and y.
    expect_near(scene_bounds(scene).upper, {std::sqrt(5.0f), std::sqrt(5.0f), 1.0f}, 1e-6f);
}

TEST(Bounds, IgnoreWhatIsNotSeen)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    Mesh mesh = make_box("", vec3(-1), vec3(1), grey);
    mesh.positions.emplace_back(1000.0f, 0.0f, 0.0f); // in no triangle
    mesh.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
    mesh.triangles.emplace_back(0, 1, 9);
    place(scene, mesh);
    const Bounds bounds = scene_bounds(scene);
    expect_near(bounds.lower, vec3(-1.0f), 0.0f);
    expect_near(bounds.upper, vec3(1.0f), 0.0f);
}

TEST(Bounds, OfManyInstancesHoldThemAll)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    const auto mesh = add(scene, make_torus("", 1.0f, 0.25f, 64, 64, grey)); // 8192 triangles
    const auto group = add(scene, Group{"", {mesh}, {}});
    std::mt19937 engine(3);
    Bounds wanted;
    for (int i = 0; i < 1000; ++i) { // more visits than are made one by one
        const Transform m = random_transform(engine);
        add(scene, InstanceDesc{"", group, m});
        for (std::size_t k = 0; k < scene.meshes[0].positions.size(); k += 7)
            wanted.extend(transform_point(m, scene.meshes[0].positions[k]));
    }
    const Bounds bounds = scene_bounds(scene);
    for (int i = 0; i < 3; ++i) {
        EXPECT_LE(bounds.lower[i], wanted.lower[i] + 1e-4f);
        EXPECT_GE(bounds.upper[i], wanted.upper[i] - 1e-4f);
        EXPECT_LT(bounds.extent()[i], 2.0f * wanted.extent()[i]);
    }
}

} // namespace
} // namespace snell

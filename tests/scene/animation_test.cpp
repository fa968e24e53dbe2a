#include "snell/scene/animation.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/scene.h"
#include "snell/scene/validate_animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace snell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float half_root = 0.70710678f;

#define EXPECT_SAYS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

void expect_near(vec3 a, vec3 b, float tolerance = 1e-6f)
{
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

void expect_same(const Transform& a, const Transform& b)
{
    EXPECT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z);
}

Index<Node> add_node(Scene& scene, Index<Node> parent = {}, vec3 offset = vec3(0.0f))
{
    Node node;
    node.name = std::string(1, static_cast<char>('a' + scene.nodes.size()));
    node.parent = parent;
    node.translation = offset;
    scene.nodes.push_back(node);
    return {static_cast<uint>(scene.nodes.size() - 1)};
}

// The scene's only animation gets another channel.
AnimationChannel& animate(Scene& scene, Index<Node> node, AnimatedProperty property, Interpolation interpolation,
                          std::vector<float> times, std::vector<float> values)
{
    scene.animations.resize(1);
    scene.animations[0].channels.push_back({node, property, interpolation, std::move(times), std::move(values)});
    return scene.animations[0].channels.back();
}

vec3 at(const Scene& scene, Index<Node> node, vec3 p = vec3(0.0f))
{
    return transform_point(node_to_world(scene, node), p);
}

const Index<Animation> first{0};

// ---- nodes and keys ----

TEST(Animation, ParentsMayStandBehindTheirChildren)
{
    Scene scene;
    const auto leaf = add_node(scene, {2}, {1, 0, 0});
    const auto root = add_node(scene, {}, {0, 10, 0});
    const auto middle = add_node(scene, root, {0, 0, 100});
    scene.nodes[middle.value].scale = vec3(2, 3, 4);
    scene.nodes[root.value].rotation = vec4(0, half_root, 0, half_root); // x to -z, z to x
    for (const auto node : {leaf, root, middle}) {
        InstanceDesc instance;
        instance.node = node;
        scene.instances.push_back(instance);
    }
    pose(scene, {}, 0.0f);
    expect_near(at(scene, leaf), {100, 10, -2}, 1e-5f);
    expect_near(at(scene, leaf, {1, 1, 1}), {104, 13, -4}, 1e-5f);
    for (std::size_t i = 0; i < 3; ++i)
        expect_same(scene.instances[i].transform, node_to_world(scene, scene.instances[i].node));
}

TEST(Animation, RotationsTakeTheShortestArcAtConstantSpeed)
{
    for (const float sign : {1.0f, -1.0f}) {
        Scene scene;
        const auto node = add_node(scene);
        animate(scene, node, AnimatedProperty::rotation, Interpolation::linear, {0.0f, 2.0f},
                {0, 0, 0, 1, 0, 0, sign * half_root, sign * half_root}); // 90 degrees about Z
        for (const float t : {0.0f, 0.3f, 1.0f, 1.9f, 2.0f}) {
            pose(scene, first, t);
            const float angle = 0.25f * pi * t;
            expect_near(at(scene, node, {1, 0, 0}), {std::cos(angle), std::sin(angle), 0});
        }
    }
}

TEST(Animation, TinyRotationsDoNotDivideByZero)
{
    Scene scene;
    const auto node = add_node(scene);
    const float s = 1e-6f;
    animate(scene, node, AnimatedProperty::rotation, Interpolation::linear, {0.0f, 1.0f}, {0, 0, 0, 1, 0, 0, s, 1});
    pose(scene, first, 0.5f);
    expect_near(at(scene, node, {1, 0, 0}), {1, s, 0}, 1e-9f);
}

TEST(Animation, StepsAndLinesAndWhatIsBeyondTheKeys)
{
    Scene scene;
    const auto node = add_node(scene);
    for (const bool step : {true, false}) {
        scene.animations.clear();
        animate(scene, node, AnimatedProperty::translation, step ? Interpolation::step : Interpolation::linear,
                {1.0f, 2.0f, 4.0f}, {1, 2, 3, 5, 6, 7, 9, 9, 9});
        const auto x_at = [&](float t) {
            pose(scene, first, t);
            return at(scene, node).x;
        };
        EXPECT_EQ(x_at(-5.0f), 1.0f);
        EXPECT_EQ(x_at(1.0f), 1.0f);
        EXPECT_EQ(x_at(1.75f), step ? 1.0f : 4.0f);
        EXPECT_EQ(x_at(2.0f), 5.0f);
        EXPECT_EQ(x_at(3.0f), step ? 5.0f : 7.0f);
        EXPECT_EQ(x_at(4.0f), 9.0f);
        EXPECT_EQ(x_at(1e30f), 9.0f);
        EXPECT_EQ(x_at(nan), 9.0f);
    }
}

// A Hermite spline through a cubic's values and slopes is that cubic, however long the intervals.
TEST(Animation, SplinesReproduceCubics)
{
    const auto p = [](float t) { return t * t * t - 2.0f * t; };
    const auto slope = [](float t) { return 3.0f * t * t - 2.0f; };
    Scene scene;
    const auto node = add_node(scene);
    const std::vector<float> times = {-1.0f, 0.5f, 3.0f};
    std::vector<float> values;
    for (const float t : times)
        for (const float v : {slope(t), p(t), slope(t)}) values.insert(values.end(), {v, -v, 2.0f * v});
    animate(scene, node, AnimatedProperty::translation, Interpolation::cubic, times, values);
    for (float t = -1.0f; t <= 3.0f; t += 0.125f) {
        pose(scene, first, t);
        expect_near(at(scene, node), {p(t), -p(t), 2.0f * p(t)}, 2e-5f);
    }
    pose(scene, first, 7.0f);
    expect_near(at(scene, node), {21, -21, 42});
}

TEST(Animation, SplinesKnowInTangentsFromOutTangents)
{
    Scene scene;
    const auto node = add_node(scene);
    // One second, values 0 and 0; slope 1 at the start: t (1 - t)^2. What comes in at the start has no effect.
    animate(scene, node, AnimatedProperty::scale, Interpolation::cubic, {0.0f, 1.0f},
            {99, 99, 99, 1, 1, 1, 1, 0, 0, 0, 0, 0, 1, 1, 1, 99, 99, 99});
    pose(scene, first, 0.25f);
    expect_near(at(scene, node, {1, 1, 1}), {1.0f + 0.25f * 0.75f * 0.75f, 1, 1});
}

TEST(Animation, SplinesOfRotationsStayRotations)
{
    Scene scene;
    const auto node = add_node(scene);
    animate(scene, node, AnimatedProperty::rotation, Interpolation::cubic, {0.0f, 1.0f},
            {0, 0, 0, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1, 0, 0, 0, 0, 0, half_root, half_root, 0, 0, 0, 0});
    for (const float t : {0.1f, 0.5f, 0.8f}) {
        pose(scene, first, t);
        const Transform m = node_to_world(scene, node);
        EXPECT_NEAR(determinant(m), 1.0f, 1e-6f);
        EXPECT_NEAR(uniform_scale(m), 1.0f, 1e-6f);
    }
}

TEST(Animation, WhatHasAMatrixStaysWhereItIs)
{
    Scene scene;
    const auto root = add_node(scene), leaf = add_node(scene, root, {1, 0, 0});
    scene.nodes[0].has_matrix = true;
    scene.nodes[0].matrix = {vec4(1, 2, 0, 5), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0)}; // a shear
    animate(scene, root, AnimatedProperty::translation, Interpolation::step, {0.0f}, {7, 7, 7});
    animate(scene, leaf, AnimatedProperty::translation, Interpolation::step, {0.0f}, {0, 1, 0});
    pose(scene, first, 0.0f);
    expect_near(at(scene, leaf), {7, 1, 0});
}

TEST(Animation, CamerasAndLightsFollow)
{
    Scene scene;
    const auto node = add_node(scene, {}, {0, 0, 1000});
    scene.nodes[0].scale = vec3(3.0f);
    animate(scene, node, AnimatedProperty::rotation, Interpolation::step, {0.0f, 1.0f},
            {0, 0, 0, 1, 0, half_root, 0, half_root}); // -z to -x
    CameraDesc camera;
    camera.node = node;
    scene.cameras = {camera, CameraDesc{}};
    LightDesc light;
    light.kind = light_spot;
    light.node = node;
    scene.lights = {light, LightDesc{}};
    for (const bool turned : {false, true}) {
        pose(scene, turned ? first : Index<Animation>{}, 1.0f);
        const vec3 forward = turned ? vec3(-1, 0, 0) : vec3(0, 0, -1);
        expect_near(scene.cameras[0].eye, {0, 0, 1000});
        expect_near(normalize(scene.cameras[0].target - scene.cameras[0].eye), forward);
        expect_near(scene.cameras[0].up, {0, 1, 0});
        expect_near(scene.lights[0].position, {0, 0, 1000});
        expect_near(scene.lights[0].direction, forward);
    }
    EXPECT_EQ(scene.cameras[1].eye, CameraDesc{}.eye);
    EXPECT_EQ(scene.lights[1].direction, LightDesc{}.direction);
}

TEST(Animation, WhatShrinksToNothingStaysInvertible)
{
    Scene scene;
    const auto node = add_node(scene, {}, {5, 0, 0}), child = add_node(scene, node);
    scene.nodes[child.value].rotation = vec4(0.2f, 0.4f, 0.4f, 0.8f);
    animate(scene, node, AnimatedProperty::scale, Interpolation::linear, {0.0f, 1.0f, 2.0f},
            {1, 1, 1, 0, 0, 0, 1, -0.0f, 1});
    animate(scene, child, AnimatedProperty::scale, Interpolation::linear, {0.0f, 2.0f}, {1, 1, 1, 1, 0, 1});
    for (const auto n : {node, child}) {
        InstanceDesc instance;
        instance.node = n;
        scene.instances.push_back(instance);
    }
    for (const float t : {0.0f, 1.0f, 2.0f}) {
        pose(scene, first, t);
        for (const InstanceDesc& instance : scene.instances) {
            EXPECT_TRUE(inverse(instance.transform).has_value()) << t;
            expect_near(transform_point(instance.transform, vec3(0.0f)), {5, 0, 0});
        }
        const vec3 p = transform_point(scene.instances[0].transform, {1, 1, 1});
        if (t == 1.0f) expect_near(p, {5, 0, 0}, 1e-5f);
        if (t == 2.0f) expect_near(p, {6, 0, 1}, 1e-5f);
    }
}

// ---- meshes ----

// One triangle whose vertices have the given weights of two joints: `fixed` at the origin and `bent` at (0, 1, 0).
struct Arm
{
    Scene scene;
    Index<Node> fixed, bent;
    Rig& rig() { return scene.rigs[0]; }
    Mesh& mesh() { return scene.meshes[0]; }

    Arm()
    {
        fixed = add_node(scene);
        bent = add_node(scene, fixed, {0, 1, 0});
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {0, 1, 0}, {0, 3, 0}};
        mesh.normals = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
        mesh.tangents = {{0, 1, 0, 1}, {0, 1, 0, 1}, {0, 1, 0, -1}};
        mesh.triangles = {{0, 1, 2}};
        Rig rig;
        rig.mesh = add(scene, mesh);
        rig.positions = mesh.positions;
        rig.normals = mesh.normals;
        rig.tangents = mesh.tangents;
        rig.skin = {0};
        rig.joints = {{0, 1, 0, 0}, {0, 1, 0, 0}, {0, 1, 0, 0}};
        rig.weights = {{1, 0, 0, 0}, {0.5f, 0.5f, 0, 0}, {0, 1, 0, 0}};
        scene.rigs = {rig};
        scene.skins = {{"arm", {fixed, bent}, {identity_transform(), translation({0, -1, 0})}}};
        // The elbow bends by 90 degrees about Z: +Y goes to -X.
        animate(scene, bent, AnimatedProperty::rotation, Interpolation::linear, {0.0f, 1.0f},
                {0, 0, 0, 1, 0, 0, half_root, half_root});
    }
};

TEST(Skinning, TwoJointsBlendLinearly)
{
    Arm arm;
    pose(arm.scene, first, 1.0f);
    const Mesh& mesh = arm.mesh();
    expect_near(mesh.positions[0], {0, 0, 0});
    expect_near(mesh.positions[1], {0, 1, 0}); // both joints leave the elbow where it is
    expect_near(mesh.positions[2], {-2, 1, 0});
    expect_near(mesh.normals[0], {1, 0, 0});
    expect_near(mesh.normals[1], {half_root, half_root, 0});
    expect_near(mesh.normals[2], {0, 1, 0});
    expect_near(vec3(mesh.tangents[2].x, mesh.tangents[2].y, mesh.tangents[2].z), {-1, 0, 0});
    EXPECT_EQ(mesh.tangents[2].w, -1.0f);

    // Elsewhere the mean of two places is not on the arc.
    arm.rig().weights[2] = {0.25f, 0.75f, 0, 0};
    pose(arm.scene, first, 1.0f);
    expect_near(mesh.positions[2], 0.25f * vec3(0, 3, 0) + 0.75f * vec3(-2, 1, 0));
}

TEST(Skinning, EightInfluencesAreTwoRuns)
{
    Arm arm;
    pose(arm.scene, first, 0.6f);
    const std::vector<vec3> four = arm.mesh().positions;
    Rig& rig = arm.rig();
    for (std::size_t i = 0; i < 3; ++i) { // half of each weight goes to the second run
        rig.weights[i] *= 0.5f;
        const uvec4 joints = rig.joints[i];
        const vec4 weights = rig.weights[i];
        rig.joints.push_back(uvec4(joints.y, joints.x, 0, 0));
        rig.weights.push_back(vec4(weights.y, weights.x, 0, 0));
    }
    pose(arm.scene, first, 0.6f);
    for (std::size_t i = 0; i < 3; ++i) expect_near(arm.mesh().positions[i], four[i]);
}

TEST(Skinning, NormalsFollowByTheInverseTranspose)
{
    Arm arm;
    arm.scene.animations.clear();
    animate(arm.scene, arm.bent, AnimatedProperty::scale, Interpolation::step, {0.0f}, {4, 1, 1});
    const float s = 0.8f, c = 0.6f;
    arm.rig().normals[2] = {s, c, 0};
    arm.rig().tangents[2] = {-c, s, 0, 1};
    for (const float mirror : {1.0f, -1.0f}) {
        for (const float size : {1.0f, 1e-5f}) { // products of three small numbers must not vanish
            arm.scene.animations[0].channels[0].values = {4 * size * mirror, size, size};
            pose(arm.scene, first, 0.0f);
            expect_near(arm.mesh().normals[2], normalize(vec3(mirror * s / 4, c, 0)), 1e-5f);
            const vec4 t = arm.mesh().tangents[2];
            expect_near({t.x, t.y, t.z}, normalize(vec3(mirror * -c * 4, s, 0)), 1e-5f);
            EXPECT_EQ(t.w, mirror); // the bitangent +Z stays where it is
        }
    }
    arm.scene.animations[0].channels[0].values = {0, 0, 0};
    pose(arm.scene, first, 0.0f);
    for (const vec3 n : arm.mesh().normals) EXPECT_NEAR(length(n), 1.0f, 1e-5f);
}

TEST(Skinning, TheMeshsOwnNodeDoesNotMoveIt)
{
    Arm arm;
    pose(arm.scene, first, 0.7f);
    const std::vector<vec3> before = arm.mesh().positions;
    arm.rig().node = add_node(arm.scene, {}, {100, 0, 0});
    pose(arm.scene, first, 0.7f);
    EXPECT_EQ(arm.mesh().positions, before);
}

TEST(Morphing, TargetsAddUp)
{
    Scene scene;
    const auto node = add_node(scene);
    scene.nodes[0].weights = {0.0f, 0.5f};
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals = {{0, 0, 1}, {0, 0, 2}, {0, 0, 1}}; // one is not unit, and stays so at rest
    mesh.tangents = {{1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}};
    mesh.triangles = {{0, 1, 2}};
    Rig rig;
    rig.mesh = add(scene, mesh);
    rig.node = node;
    rig.positions = mesh.positions;
    rig.normals = mesh.normals;
    rig.tangents = mesh.tangents;
    rig.targets.resize(3); // the third has no weight, and so no effect
    rig.targets[0].positions = {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
    rig.targets[0].normals = {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    rig.targets[1].positions = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    rig.targets[1].tangents = {{0, 2, 0}, {0, 0, 0}, {0, 0, 0}};
    rig.targets[2].positions = {{9, 9, 9}, {9, 9, 9}, {9, 9, 9}};
    scene.rigs = {rig};
    animate(scene, node, AnimatedProperty::weights, Interpolation::linear, {0.0f, 1.0f}, {0, 0, 1, 2});

    pose(scene, {}, 0.0f);
    expect_near(scene.meshes[0].positions[0], {0.5f, 0, 0});
    EXPECT_EQ(scene.meshes[0].normals, mesh.normals);
    pose(scene, first, 0.25f);
    expect_near(scene.meshes[0].positions[2], {0.5f, 1, 0.75f});
    expect_near(scene.meshes[0].normals[0], normalize(vec3(0.25f, 0, 1)));
    const vec4 t = scene.meshes[0].tangents[0];
    expect_near({t.x, t.y, t.z}, normalize(vec3(1, 1, 0)));
    EXPECT_EQ(t.w, 1.0f);
}

TEST(Animation, TheRestPoseComesBackToTheBit)
{
    Arm arm;
    Scene& scene = arm.scene;
    scene.nodes[1].rotation = vec4(0.1f, 0.2f, 0.3f, 0.9f); // not unit
    InstanceDesc instance;
    instance.node = arm.bent;
    scene.instances = {instance};
    pose(scene, {}, 0.0f);
    const Scene rest = scene;
    for (const float t : {0.3f, 1.0f}) pose(scene, first, t);
    EXPECT_NE(scene.meshes[0].positions, rest.meshes[0].positions);
    pose(scene, {}, 123.0f);
    EXPECT_EQ(scene.meshes[0].positions, rest.meshes[0].positions);
    EXPECT_EQ(scene.meshes[0].normals, rest.meshes[0].normals);
    EXPECT_EQ(scene.meshes[0].tangents, rest.meshes[0].tangents);
    expect_same(scene.instances[0].transform, rest.instances[0].transform);
    expect_same(node_to_world(scene, arm.bent), node_to_world(rest, arm.bent));
}

TEST(Skinning, DoesNotDependOnTheNumberOfThreads)
{
    Arm arm;
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> number(0.0f, 1.0f);
    Rig& rig = arm.rig();
    constexpr std::size_t count = 20001;
    rig.normals.clear();
    rig.tangents.clear();
    rig.positions.resize(count);
    rig.joints.resize(count, uvec4(0, 1, 0, 0));
    rig.weights.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        rig.positions[i] = vec3(number(engine), number(engine), number(engine));
        const float w = number(engine);
        rig.weights[i] = vec4(w, 1.0f - w, 0, 0);
    }
    arm.mesh() = Mesh{};
    arm.mesh().positions = rig.positions;
    set_thread_count(1);
    pose(arm.scene, first, 0.4f);
    const std::vector<vec3> alone = arm.mesh().positions;
    set_thread_count(0);
    pose(arm.scene, first, 0.4f);
    EXPECT_EQ(arm.mesh().positions, alone);
    EXPECT_NE(alone.back(), rig.positions.back());
}

// ---- what came from outside ----

std::string error_of(Scene scene)
{
    try {
        validate_animation(scene);
    } catch (const Error& error) {
        EXPECT_THROW(pose(scene, {}, 0.0f), Error) << "pose() must be safe on what has not been validated";
        return error.what();
    }
    return "no error";
}

TEST(ValidateAnimation, LeavesGoodOnesAlone)
{
    Arm arm;
    validate_animation(arm.scene);
    EXPECT_TRUE(arm.scene.notes.empty());
    EXPECT_EQ(arm.scene.animations[0].channels.size(), 1u);
    EXPECT_EQ(arm.scene.animations[0].duration, 1.0f);
}

TEST(ValidateAnimation, NodesMustFormTrees)
{
    Scene scene;
    for (uint i = 0; i < 4; ++i) add_node(scene, {i + 1});
    EXPECT_SAYS(error_of(scene), "node 'd' refers to parent 4 of 4");
    scene.nodes[3].parent = {1};
    EXPECT_SAYS(error_of(scene), "is its own ancestor");
    EXPECT_THROW(node_to_world(scene, {0}), Error);
    scene.nodes[3].parent = {3};
    EXPECT_SAYS(error_of(scene), "node 'd' is its own ancestor");
    scene.nodes[3].parent = {};
    EXPECT_EQ(error_of(scene), "no error");
}

TEST(ValidateAnimation, ALongChainTakesLittleTime)
{
    Scene scene;
    constexpr uint count = 200000;
    scene.nodes.resize(count);
    for (uint i = 0; i + 1 < count; ++i) {
        scene.nodes[i].parent = {i + 1};
        scene.nodes[i].translation = {1, 0, 0};
    }
    InstanceDesc instance;
    instance.node = {0};
    scene.instances = {instance};
    validate_animation(scene);
    pose(scene, {}, 0.0f);
    EXPECT_EQ(scene.instances[0].transform.x.w, static_cast<float>(count - 1));
}

TEST(ValidateAnimation, IndicesOutOfRange)
{
    const auto broken = [](const auto& change) {
        Arm arm;
        change(arm);
        return error_of(arm.scene);
    };
    EXPECT_SAYS(broken([](Arm& a) { a.scene.skins[0].joints[1] = {7}; }), "skin 'arm' refers to node 7 of 2");
    EXPECT_SAYS(broken([](Arm& a) { a.scene.skins[0].inverse_bind.pop_back(); }), "inverse bind matrices");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().mesh = {}; }), "rig 0 refers to mesh -1 of 1");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().skin = {1}; }), "refers to skin 1 of 1");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().node = {2}; }), "refers to node 2 of 2");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().joints.pop_back(); }), "rig 0 has 3 sets of weights, and needs 2");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().normals.pop_back(); }), "rig 0 has 2 normals, and needs 3");
    EXPECT_SAYS(broken([](Arm& a) { a.mesh().positions.pop_back(); }), "rig 0 has 3 positions, and needs 2");
    EXPECT_SAYS(broken([](Arm& a) { a.rig().targets = {{{vec3(0.0f)}, {}, {}}}; }), "in a morph target");
    EXPECT_SAYS(broken([](Arm& a) { a.scene.rigs.push_back(a.rig()); }), "mesh 0 has two rigs");
    EXPECT_SAYS(broken([](Arm& a) { a.scene.animations[0].channels[0].node = {}; }), "channel 0 refers to node -1");
    EXPECT_SAYS(broken([](Arm& a) { a.scene.animations[0].channels[0].values.pop_back(); }), "has 7 numbers, and");
    EXPECT_SAYS(broken([](Arm& a) { a.scene.cameras.resize(1), a.scene.cameras[0].node = {9}; }), "camera 0 refers to");
}

TEST(ValidateAnimation, JointsOutOfRange)
{
    Arm arm;
    arm.rig().joints[1].y = 5;
    pose(arm.scene, first, 1.0f); // must not read beyond the joints
    EXPECT_THROW(validate_animation(arm.scene), Error);
    arm.rig().joints[1] = {0, 1, 77, 88}; // of weight 0: files leave anything there
    validate_animation(arm.scene);
    EXPECT_TRUE(arm.scene.notes.empty());
}

TEST(ValidateAnimation, MendsAndSaysSo)
{
    Arm arm;
    Scene& scene = arm.scene;
    arm.rig().weights[0] = {3, 1, 0, 0};
    arm.rig().weights[1] = {nan, -1, 0, 0};
    arm.rig().normals[2] = vec3(0.0f);
    arm.rig().positions[2] = arm.mesh().positions[2] = {1, 3, 0};
    scene.nodes[0].translation.x = nan;
    add_node(scene);
    scene.nodes[2].has_matrix = true;
    animate(scene, arm.fixed, AnimatedProperty::scale, Interpolation::linear, {1.0f, 0.0f}, {1, 1, 1, 2, 2, 2});
    animate(scene, arm.fixed, AnimatedProperty::scale, Interpolation::linear, {0.0f, nan}, {1, 1, 1, 2, 2, 2});
    animate(scene, arm.fixed, AnimatedProperty::scale, Interpolation::linear, {}, {});
    animate(scene, {2}, AnimatedProperty::scale, Interpolation::step, {0.0f}, {1, 1, 1});
    pose(scene, first, 0.5f); // no crash before it is mended
    validate_animation(scene);
    std::string notes;
    for (const Note& note : scene.notes) notes += note.text + "\n";
    EXPECT_SAYS(notes, "node 'a': without meaning, reset: translation");
    EXPECT_SAYS(notes, "channel 1 is left out: its times do not ascend");
    EXPECT_SAYS(notes, "channel 2 is left out: it has numbers that are not finite");
    EXPECT_SAYS(notes, "channel 3 is left out: it has no keys");
    EXPECT_SAYS(notes, "channel 4 is left out: its node has a matrix");
    EXPECT_SAYS(notes, "at 2 vertices were negative or did not sum to 1");
    EXPECT_EQ(scene.notes.size(), 6u);
    EXPECT_EQ(arm.rig().weights[0], vec4(0.75f, 0.25f, 0, 0));
    EXPECT_EQ(arm.rig().weights[1], vec4(1, 0, 0, 0));
    expect_near(arm.rig().normals[2], {0, 0, -1});
}

} // namespace
} // namespace snell

// A small scene in which everything that can move does, and packed scenes compared bit for bit.
#pragma once

#include "snell/scene/packed.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cstring>

namespace snell::test {

inline Index<Node> add_node(Scene& scene, const char* name, vec3 at, Index<Node> parent = {})
{
    Node node;
    node.name = name;
    node.parent = parent;
    node.translation = at;
    scene.nodes.push_back(node);
    return {static_cast<uint>(scene.nodes.size() - 1)};
}

inline void animate(Scene& scene, Index<Node> node, AnimatedProperty property, std::vector<float> times,
                    std::vector<float> values)
{
    Animation& animation = scene.animations.at(0);
    animation.duration = std::max(animation.duration, times.back());
    animation.channels.push_back({node, property, Interpolation::linear, std::move(times), std::move(values)});
}

inline void hang(Scene& scene, Index<Node> node, std::vector<Index<Mesh>> meshes,
                 std::vector<Index<SphereDesc>> spheres = {})
{
    Group group{"hung", std::move(meshes), std::move(spheres)};
    add(scene, InstanceDesc{"hung", add(scene, std::move(group)), identity_transform(), node});
}

// A rig whose mesh morphs with the node's weights. Target 0 moves the vertices, target 1 turns the normals round.
inline Rig morph_rig(const Scene& scene, Index<Mesh> index, Index<Node> node)
{
    const Mesh& mesh = scene.meshes[index.value];
    Rig rig;
    rig.mesh = index;
    rig.node = node;
    rig.positions = mesh.positions;
    rig.normals = mesh.normals;
    rig.tangents = mesh.tangents;
    rig.targets.resize(2);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        rig.targets[0].positions.push_back(0.3f * vec3(mesh.positions[i].y, mesh.positions[i].z, mesh.positions[i].x));
    for (const vec3 n : mesh.normals) rig.targets[1].normals.push_back(-2.0f * n);
    return rig;
}

inline const Index<Animation> first_animation{0};

// Lasts 2 seconds.
inline Scene moving_scene()
{
    Scene scene;
    scene.animations.resize(1);
    scene.environment.radiance = vec3(0.2f);
    const auto grey = add(scene, MaterialDesc{});
    Image image;
    image.width = image.height = 2;
    image.bytes = {255, 80, 0, 255, 0, 255, 80, 255, 80, 0, 255, 255, 255, 255, 255, 255};
    MaterialDesc shining;
    shining.emission = vec3(3.0f, 4.0f, 5.0f);
    const auto glow = add(scene, shining);
    shining.emission_texture.image = add(scene, image);
    const auto picture = add(scene, shining);

    // Still: a floor, a torus with tangents and a mirror, and a mesh that has a rig which nothing moves.
    place(scene, make_checkerboard("floor", 4, 4, 1.0f, grey, add(scene, MaterialDesc{})), translation({0, -1, 0}));
    Mesh ring = make_torus("ring", 0.5f, 0.2f, 12, 8, grey);
    for (const vec3 n : ring.normals) ring.tangents.push_back(vec4(normalize(cross(n, vec3(0.3f, 0.5f, 0.7f))), -1.0f));
    place(scene, ring, compose(translation({-1, 0, 1}), scaling({1, 1, -1})));
    const auto rest = add_node(scene, "rest", {1, 0, 1});
    hang(scene, rest, {add(scene, make_torus("rigid", 0.4f, 0.1f, 9, 6, grey))});
    scene.rigs.push_back(morph_rig(scene, scene.groups.back().meshes[0], rest));

    // What moves as a whole: through a mirror, with children, and a light among it.
    const auto arm = add_node(scene, "arm", {0, 0.5f, 0});
    const auto hand = add_node(scene, "hand", {0.7f, 0, 0}, arm);
    animate(scene, arm, AnimatedProperty::rotation, {0, 2}, {0, 0, 0, 1, 0, 0.7f, 0, 0.7f});
    animate(scene, arm, AnimatedProperty::scale, {0, 1, 2}, {1, 1, 1, 1, 1, -1, 2, 2, 2});
    hang(scene, arm, {add(scene, make_box("box", vec3(-0.2f), vec3(0.2f), grey))});
    hang(scene, hand,
         {add(scene, make_quad("sign", {0, 0, 0}, {0.3f, 0, 0}, {0.3f, 0.4f, 0}, {0, 0.4f, 0}, picture)),
          add(scene, ring)});
    SphereDesc ball;
    ball.radius = 0.15f;
    ball.material = glow;
    const auto swing = add_node(scene, "swing", {-1, 1, 0});
    animate(scene, swing, AnimatedProperty::translation, {0, 2}, {-1, 1, 0, 1, 1, 0});
    hang(scene, swing, {}, {add(scene, ball)});
    const auto crowd = add(scene, Group{"crowd", {add(scene, make_box("one", vec3(0), vec3(0.1f), glow))}, {}});
    for (const auto& [at, node] : {std::pair{vec3(0), swing}, {vec3(1, 1, 1), Index<Node>{}}, {vec3(0), hand}})
        add(scene, InstanceDesc{"one", crowd, translation(at), node});

    // What changes its shape: placed twice, of two materials one of which shines, and skinned.
    const auto breath = add_node(scene, "breath", {0, 0, -1});
    scene.nodes[breath.value].weights = {0.2f, 0};
    animate(scene, breath, AnimatedProperty::weights, {0, 1, 2}, {0, 0, 1, 0, 0.5f, 1});
    const auto lung = add(scene, ring);
    hang(scene, breath, {lung});
    hang(scene, hand, {lung});
    scene.rigs.push_back(morph_rig(scene, lung, breath));
    Mesh two = make_torus("two", 0.3f, 0.1f, 8, 6, grey);
    for (std::size_t i = 0; i < two.triangles.size(); ++i) two.triangle_materials.push_back(i % 3 == 0 ? glow : grey);
    hang(scene, breath, {add(scene, two)});
    scene.rigs.push_back(morph_rig(scene, scene.groups.back().meshes[0], breath));
    const auto skin = add(scene, make_box("skin", {-0.1f, 0, -0.1f}, {0.1f, 1, 0.1f}, grey));
    hang(scene, {}, {skin});
    scene.skins.push_back({"skin", {rest, arm}, {identity_transform(), translation({0, -0.5f, 0})}});
    Rig skinned;
    skinned.mesh = skin;
    skinned.skin = {0};
    skinned.positions = scene.meshes[skin.value].positions;
    for (const vec3 p : skinned.positions) {
        skinned.joints.push_back({0, 1, 0, 0});
        skinned.weights.push_back({1 - p.y, p.y, 0, 0});
    }
    scene.rigs.push_back(skinned);

    LightDesc lamp;
    lamp.node = swing;
    add(scene, lamp);
    lamp.kind = light_directional;
    lamp.node = {};
    add(scene, lamp);
    lamp.kind = light_spot;
    lamp.node = hand;
    add(scene, lamp);
    CameraDesc camera;
    camera.eye = {0, 1, 6};
    add(scene, camera);
    pose(scene, {}, 0.0f);
    validate(scene);
    return scene;
}

template <class T>
bool same_array(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same_packed(const PackedScene& a, const PackedScene& b)
{
    EXPECT_TRUE(same_array(a.positions, b.positions)) << "positions";
    EXPECT_TRUE(same_array(a.normals, b.normals)) << "normals";
    EXPECT_TRUE(same_array(a.uvs, b.uvs)) << "uvs";
    EXPECT_TRUE(same_array(a.tangents, b.tangents)) << "tangents";
    EXPECT_TRUE(same_array(a.colors, b.colors)) << "colors";
    EXPECT_TRUE(same_array(a.triangles, b.triangles)) << "triangles";
    EXPECT_TRUE(same_array(a.surfaces, b.surfaces)) << "surfaces";
    EXPECT_TRUE(same_array(a.spheres, b.spheres)) << "spheres";
    EXPECT_TRUE(same_array(a.planes, b.planes)) << "planes";
    EXPECT_TRUE(same_array(a.instances, b.instances)) << "instances";
    EXPECT_TRUE(same_array(a.materials, b.materials)) << "materials";
    EXPECT_TRUE(same_array(a.lights, b.lights)) << "lights";
    EXPECT_TRUE(same_array(a.texels, b.texels)) << "texels";
    EXPECT_TRUE(same_array(a.slots, b.slots)) << "slots";
    EXPECT_TRUE(same_array(a.environment_cdf, b.environment_cdf)) << "environment_cdf";
    EXPECT_TRUE(same_array(a.groups, b.groups)) << "groups";
    EXPECT_EQ(std::memcmp(&a.world, &b.world, sizeof a.world), 0) << "world";
    EXPECT_EQ(std::memcmp(&a.environment, &b.environment, sizeof a.environment), 0) << "environment";
    EXPECT_EQ(a.center, b.center);
    EXPECT_EQ(a.radius, b.radius);
}

} // namespace snell::test

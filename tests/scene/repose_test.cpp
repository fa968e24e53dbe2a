// A packed scene that follows the poses of its scene is, array by array, what packing it anew would give.
#include "snell/scene/lights.h"
#include "snell/scene/repose.h"
#include "tests/scene/moving_scene.h"

#include <algorithm>

namespace snell::test {
namespace {

PackedScene packed_anew(const Scene& scene)
{
    MotionMap motion;
    return pack(scene, motion);
}

const float moments[] = {0.0f, 0.3f, 1.0f, 1.7f, 0.6f, 2.0f, 0.0f};

TEST(Repose, IsWhatPackingAnewGives)
{
    Scene scene = moving_scene();
    MotionMap motion;
    PackedScene packed = pack(scene, motion);
    ASSERT_GT(packed.instances.size(), 6u);
    for (const float seconds : moments) {
        SCOPED_TRACE(seconds);
        pose(scene, first_animation, seconds);
        repose(scene, packed, motion);
        expect_same_packed(packed, packed_anew(scene));
    }
    pose(scene, {}, 0.0f);
    repose(scene, packed, motion);
    expect_same_packed(packed, packed_anew(scene));
}

// The scene must do what it is for: else the test above compares what never changes.
TEST(Repose, TheTestSceneMovesInEveryWay)
{
    Scene scene = moving_scene();
    pose(scene, first_animation, 0.0f);
    const PackedScene a = packed_anew(scene);
    pose(scene, first_animation, 1.7f);
    const PackedScene b = packed_anew(scene);
    EXPECT_FALSE(same_array(a.positions, b.positions));
    EXPECT_FALSE(same_array(a.normals, b.normals));
    EXPECT_FALSE(same_array(a.triangles, b.triangles)) << "normals that turn round take the winding along";
    EXPECT_FALSE(same_array(a.instances, b.instances));
    EXPECT_NE(a.radius, b.radius);
    ASSERT_EQ(a.lights.size(), b.lights.size());
    std::vector<uint> kinds; // that change
    for (std::size_t i = 0; i < a.lights.size(); ++i)
        if (a.lights[i].position != b.lights[i].position) kinds.push_back(a.lights[i].kind);
    for (const uint kind : {light_point, light_spot, light_triangle, light_sphere})
        EXPECT_NE(std::count(kinds.begin(), kinds.end(), kind), 0) << kind;
    bool mirrored = false;
    pose(scene, first_animation, 0.9f);
    for (const Instance& instance : packed_anew(scene).instances)
        mirrored = mirrored || determinant(instance.to_world) < 0.0f;
    EXPECT_TRUE(mirrored);
}

TEST(Repose, WhatStandsStillLiesInWorldSpace)
{
    const Scene scene = moving_scene();
    MotionMap motion;
    const PackedScene packed = pack(scene, motion);
    std::vector<std::string> world, apart;
    for (const MeshPlacement& placement : motion.plan.mesh_placements)
        (placement.group == none ? world : apart).push_back(scene.meshes[placement.mesh].name);
    EXPECT_EQ(world, (std::vector<std::string>{"floor", "ring", "rigid"}));
    EXPECT_EQ(apart, (std::vector<std::string>{"box", "sign", "ring", "one", "ring", "ring", "two", "skin"}));
    EXPECT_EQ(packed.world.sphere_count, 0u);
    EXPECT_EQ(packed.instances.size(), 10u);
    // Placed twice, the mesh that morphs has its vertices once.
    EXPECT_EQ(motion.plan.mesh_placements[7].first_vertex, motion.plan.mesh_placements[8].first_vertex);
}

TEST(Repose, WithoutAnimationNothingStaysApart)
{
    Scene scene = moving_scene();
    scene.animations.clear();
    MotionMap motion;
    PackedScene kept = pack(scene, motion);
    const PackedScene plain = pack(scene);
    EXPECT_EQ(kept.instances.size(), 3u); // of the crowd
    kept.center = plain.center;           // the crowd's box is a little larger
    kept.radius = plain.radius;
    pack_lights(scene, kept);
    expect_same_packed(kept, plain);
}

TEST(Repose, TheSphereAroundTheSceneHoldsWhatMoves)
{
    Scene scene = moving_scene();
    MotionMap motion;
    PackedScene packed = pack(scene, motion);
    for (const float seconds : moments) {
        pose(scene, first_animation, seconds);
        repose(scene, packed, motion);
        const Bounds bounds = scene_bounds(scene);
        EXPECT_GE(packed.radius, 0.4999f * length(bounds.extent()));
        EXPECT_LE(packed.radius, 0.6f * length(bounds.extent()));
    }
}

// What is infinitely far away lights a larger scene more: it is then chosen more often.
TEST(Repose, PowersFollowTheSizeOfTheScene)
{
    Scene scene;
    scene.animations.resize(1);
    const auto node = add_node(scene, "away", {0, 0, 0});
    animate(scene, node, AnimatedProperty::translation, {0, 1}, {0, 0, 0, 50, 0, 0});
    const auto grey = add(scene, MaterialDesc{});
    hang(scene, node, {add(scene, make_box("box", vec3(-1), vec3(1), grey))});
    place(scene, make_box("still", vec3(-1), vec3(1), grey));
    for (const uint kind : {light_point, light_directional}) {
        LightDesc light;
        light.kind = kind;
        add(scene, light);
    }
    validate(scene);
    MotionMap motion;
    PackedScene packed = pack(scene, motion);
    const float before = packed.lights[1].select_pdf;
    pose(scene, first_animation, 1.0f);
    repose(scene, packed, motion);
    EXPECT_GT(packed.lights[1].select_pdf, before + 0.1f);
    expect_same_packed(packed, packed_anew(scene));
}

// ---- what is said of it ----

class ReposeSays : public ::testing::Test
{
  protected:
    ReposeSays()
    {
        pose(scene, first_animation, 0.5f);
        packed = pack(scene, motion);
    }

    // Poses with those channels alone; the packed scene has been at rest before.
    PackedChanges changes(AnimatedProperty property, const char* node)
    {
        std::erase_if(scene.animations[0].channels, [&](const AnimationChannel& channel) {
            return channel.property != property || scene.nodes[channel.node.value].name != node;
        });
        pose(scene, {}, 0.0f);
        repose(scene, packed, motion);
        pose(scene, first_animation, 0.7f);
        const PackedChanges result = repose(scene, packed, motion);
        EXPECT_FALSE(repose(scene, packed, motion).any()) << "a second time nothing has changed";
        return result;
    }

    uint group_of(const char* mesh)
    {
        for (const MeshPlacement& placement : motion.plan.mesh_placements)
            if (scene.meshes[placement.mesh].name == mesh) return placement.group;
        return none;
    }

    Scene scene = moving_scene();
    MotionMap motion;
    PackedScene packed;
};

TEST_F(ReposeSays, Nothing)
{
    const PackedScene before = packed;
    EXPECT_FALSE(repose(scene, packed, motion).any());
    expect_same_packed(packed, before);
}

TEST_F(ReposeSays, TransformsAlone)
{
    const PackedChanges said = changes(AnimatedProperty::translation, "swing");
    EXPECT_TRUE(said.instances);
    EXPECT_FALSE(said.world);
    EXPECT_TRUE(said.groups.empty());
}

TEST_F(ReposeSays, ShapesAlone)
{
    const PackedChanges said = changes(AnimatedProperty::weights, "breath");
    EXPECT_FALSE(said.instances);
    EXPECT_FALSE(said.world);
    ASSERT_EQ(said.groups.size(), 3u); // the shape that is placed twice, in two groups, and the one of two materials
    EXPECT_TRUE(std::is_sorted(said.groups.begin(), said.groups.end()));
    EXPECT_EQ(said.groups[2], group_of("two"));
}

TEST_F(ReposeSays, ShapesWhoseNormalsAloneTurnRound)
{
    for (AnimationChannel& channel : scene.animations[0].channels)
        if (channel.property == AnimatedProperty::weights) channel.values = {0.2f, 0, 0.2f, 1, 0.2f, 1};
    EXPECT_EQ(changes(AnimatedProperty::weights, "breath").groups.size(), 3u) << "triangles are wound anew";
}

TEST_F(ReposeSays, SkinAndWhatHangsOnItsJoint)
{
    const PackedChanges said = changes(AnimatedProperty::rotation, "arm");
    EXPECT_TRUE(said.instances);
    EXPECT_FALSE(said.world);
    EXPECT_EQ(said.groups, std::vector<uint>{group_of("skin")});
}

TEST_F(ReposeSays, LampsAreFollowedWithoutGeometry)
{
    scene.lights[1].direction = vec3(1, -1, 0);
    EXPECT_FALSE(repose(scene, packed, motion).any());
    expect_same_packed(packed, packed_anew(scene));
}

TEST_F(ReposeSays, WorldWhenWhatLaysThereHasMoved)
{
    for (InstanceDesc& instance : scene.instances)
        if (!instance.node.valid()) instance.transform = compose(scaling({-1, 1, 1}), instance.transform);
    scene.rigs[0].positions[0] += vec3(0.01f); // and a shape that no animation changes
    pose(scene, first_animation, 0.5f);
    const PackedChanges said = repose(scene, packed, motion);
    EXPECT_TRUE(said.world);
    EXPECT_TRUE(said.instances);
    expect_same_packed(packed, packed_anew(scene));
    EXPECT_FALSE(repose(scene, packed, motion).any());
}

TEST_F(ReposeSays, WorldForSpheresThatLayThere)
{
    SphereDesc ball;
    ball.material = scene.meshes[0].material;
    ball.material.value = 1; // shines
    place(scene, ball);
    packed = pack(scene, motion);
    ASSERT_EQ(packed.world.sphere_count, 1u);
    scene.instances.back().transform = translation({1, 2, 3});
    const PackedChanges said = repose(scene, packed, motion);
    EXPECT_TRUE(said.world);
    EXPECT_FALSE(said.instances);
    expect_same_packed(packed, packed_anew(scene));
}

} // namespace
} // namespace snell::test

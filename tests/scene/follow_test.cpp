// A packed scene that follows the edits of its scene is, array by array, what packing it anew would give.
#include "snell/scene/lights.h"
#include "snell/scene/repose.h"
#include "tests/scene/edits.h"

#include "snell/core/error.h"

#include <set>

namespace snell::test {
namespace {

PackedScene packed_anew(const Scene& scene)
{
    MotionMap motion;
    return pack(scene, motion);
}

void expect_same_all(const PackedScene& a, const PackedScene& b)
{
    expect_same_packed(a, b);
    EXPECT_TRUE(same_array(a.principled, b.principled)) << "principled";
    EXPECT_TRUE(same_array(a.albedo, b.albedo)) << "albedo";
    EXPECT_TRUE(same_array(a.textures, b.textures)) << "textures";
    EXPECT_TRUE(same_array(a.srgb, b.srgb)) << "srgb";
    EXPECT_EQ(a.coverage, b.coverage);
}

class Follow : public ::testing::Test
{
  protected:
    // The edit's changes; nothing: it is another layout, and was packed anew.
    std::optional<PackedChanges> edit(Edit edit)
    {
        const AppliedEdit applied = apply_edit(scene, std::move(edit));
        const std::optional<PackedChanges> changes = follow(scene, packed, motion, applied.changes);
        if (!changes) packed = pack(scene, motion);
        expect_same_all(packed, packed_anew(scene));
        return changes;
    }

    void expect_no_geometry(Edit what)
    {
        const std::optional<PackedChanges> changes = edit(std::move(what));
        ASSERT_TRUE(changes.has_value());
        EXPECT_FALSE(changes->any());
    }

    Index<MaterialDesc> material(const char* name) const
    {
        for (uint i = 0; i < scene.materials.size(); ++i)
            if (scene.materials[i].name == name) return {i};
        return {};
    }

    Index<Mesh> mesh(const char* name) const
    {
        for (uint i = 0; i < scene.meshes.size(); ++i)
            if (scene.meshes[i].name == name) return {i};
        return {};
    }

    Scene scene = editable_scene();
    MotionMap motion;
    PackedScene packed = pack(scene, motion);
};

TEST_F(Follow, ColoursTouchNoTree)
{
    SetMaterial set{material("metal"), scene.materials[material("metal").value]};
    set.value.base_color = vec3(0.1f, 0.2f, 0.3f);
    expect_no_geometry(set);
}

TEST_F(Follow, EmissionOnAndOff)
{
    const std::size_t lights = packed.lights.size();
    for (const char* name : {"metal", "coat", "leaf"}) {
        SetMaterial set{material(name), scene.materials[material(name).value]};
        set.value.emission = vec3(2.0f);
        expect_no_geometry(set);
        EXPECT_GT(packed.lights.size(), lights) << name;
        set.value.emission = vec3(0.0f);
        expect_no_geometry(set);
        EXPECT_EQ(packed.lights.size(), lights) << name;
    }
}

TEST_F(Follow, ASphereThatGetsATextureAndLaysTurnedLeavesTheWorld)
{
    scene.instances.back().transform = identity_transform();
    uint turned = none;
    for (uint i = 0; i < scene.instances.size(); ++i) {
        const Group& group = scene.groups[scene.instances[i].group.value];
        if (!group.spheres.empty() && scene.spheres[group.spheres[0].value].material == material("metal")) turned = i;
    }
    ASSERT_NE(turned, none);
    ASSERT_TRUE(edit(SetTransform{turned, rotation(vec3(0, 0, 1), 20.0f)}).has_value());
    SetMaterial set{material("metal"), scene.materials[material("metal").value]};
    set.value.base_texture.image = {0};
    EXPECT_FALSE(edit(set).has_value());
    // and one that becomes an ellipsoid
    set.value.base_texture = {};
    edit(set);
    EXPECT_FALSE(edit(SetTransform{turned, scaling(vec3(1, 2, 1))}).has_value());
}

TEST_F(Follow, AMeshOfOneMaterialGetsAnother)
{
    const Index<Mesh> box = mesh("box");
    expect_no_geometry(AssignMaterial{box, scene.meshes[box.value].material, material("metal")});
}

TEST_F(Follow, AMeshOfSeveralMaterialsIsPackedAnew)
{
    const Index<Mesh> two{static_cast<uint>(scene.meshes.size() - 1)};
    ASSERT_EQ(scene.meshes[two.value].name, "still two");
    EXPECT_FALSE(edit(AssignMaterial{two, material("leaf"), material("metal")}).has_value());
}

TEST_F(Follow, LightsThatComeAndGo)
{
    while (!scene.lights.empty()) expect_no_geometry(RemoveLight{0});
    LightDesc sun;
    sun.kind = light_directional;
    expect_no_geometry(AddLight{0, sun});
    expect_no_geometry(SetLight{0, LightDesc{}});
}

// Without any light the environment gets all samples.
TEST_F(Follow, TheLastLightLeavesTheSamplesToTheEnvironment)
{
    for (uint i = 0; i < scene.materials.size(); ++i) {
        SetMaterial dark{{i}, scene.materials[i]};
        dark.value.emission = vec3(0.0f);
        expect_no_geometry(dark);
    }
    EXPECT_EQ(packed.environment.select_pdf, 0.5f);
    while (!scene.lights.empty()) expect_no_geometry(RemoveLight{0});
    EXPECT_EQ(packed.environment.select_pdf, 1.0f);
    expect_no_geometry(AddLight{0, LightDesc{}});
    EXPECT_EQ(packed.environment.select_pdf, 0.5f);
}

TEST_F(Follow, TheEnvironmentInAllItsParts)
{
    SetEnvironment set{scene.environment};
    set.value.radiance = vec3(0.1f, 0.5f, 0.3f);
    expect_no_geometry(set);
    set.value.to_world = rotation(vec3(0, 1, 0), 77.0f);
    set.value.visible = false;
    expect_no_geometry(set);
    const auto bright = std::make_shared<const Image>(picture("bright", 32, 16, texels_rgba32f, 9));
    expect_no_geometry(AddImage{bright});
    set.value.image = {static_cast<uint>(scene.images.size() - 1)};
    expect_no_geometry(set);
    set.value.mapping = environment_octahedral;
    expect_no_geometry(set);
    set.value.image = {};
    expect_no_geometry(set);
    set.value.radiance = vec3(0.0f);
    expect_no_geometry(set);
}

// The picture is looked at once, not once for each colour.
TEST_F(Follow, TheEnvironmentsCellsAreKept)
{
    const vec3* const cells = motion.environment.means.data();
    ASSERT_NE(cells, nullptr);
    SetEnvironment set{scene.environment};
    set.value.radiance = vec3(0.1f, 0.5f, 0.3f);
    expect_no_geometry(set);
    EXPECT_EQ(motion.environment.means.data(), cells);
}

TEST_F(Follow, TexelsThatChangeInTheirPlace)
{
    for (Image& image : scene.images)
        for (std::uint8_t& byte : image.bytes) byte = static_cast<std::uint8_t>(255 - byte);
    const std::optional<PackedChanges> changes = follow(scene, packed, motion, change_images);
    ASSERT_TRUE(changes.has_value());
    expect_same_all(packed, packed_anew(scene));
}

TEST_F(Follow, SpheresAndPlanes)
{
    for (uint i = 0; i < scene.spheres.size(); ++i) {
        SetSphere set{{i}, scene.spheres[i]};
        set.value.radius *= 1.5f;
        set.value.center.y += 0.5f;
        const std::optional<PackedChanges> changes = edit(set);
        ASSERT_TRUE(changes.has_value());
        EXPECT_TRUE(changes->world != !changes->groups.empty()) << i;
    }
    SetPlane set{0, scene.planes[0]};
    set.value.point.y = -3.0f;
    set.value.material = material("metal");
    expect_no_geometry(set);
}

TEST_F(Follow, AnotherNumberOfInstancesIsAnotherLayout)
{
    add(scene, InstanceDesc{"one more", scene.instances[0].group, translation(vec3(0, 3, 0))});
    EXPECT_FALSE(follow(scene, packed, motion, change_transforms).has_value());
}

TEST_F(Follow, EmissiveEllipsoidsAreRefusedAndCanBeMended)
{
    MaterialDesc& glass = scene.materials[material("glass").value];
    const vec3 dark = glass.emission;
    glass.emission = vec3(1.0f); // not by an edit, which would not do it
    EXPECT_THROW(follow(scene, packed, motion, change_materials), Error);
    glass.emission = dark;
    packed = pack(scene, motion);
    expect_no_geometry(Rename{ScenePart::material, 0, "x"});
}

// What moves is known to shine as soon as it does, and no longer than that.
TEST_F(Follow, MovingALampThatWasNoneBefore)
{
    Index<Node> arm, hand;
    for (uint i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].name == "arm") arm = {i};
        if (scene.nodes[i].name == "hand") hand = {i};
    }
    // Anything else that shines on these nodes would make all lights be listed again.
    while (!scene.lights.empty()) edit(RemoveLight{0});
    for (uint i = 0; i < scene.materials.size(); ++i) {
        SetMaterial dark{{i}, scene.materials[i]};
        dark.value.emission = vec3(0.0f);
        edit(dark);
    }
    packed = pack(scene, motion);
    SetMaterial set{{static_cast<uint>(scene.materials.size())}, MaterialDesc{}};
    edit(AddMaterial{});
    edit(AssignMaterial{mesh("box"), scene.meshes[mesh("box").value].material, set.material});
    for (const float emission : {1.0f, 0.0f, 2.0f}) {
        set.value.emission = vec3(emission);
        expect_no_geometry(set);
        for (const Index<Node> node : {arm, hand}) {
            SetNode move{node, scene.nodes[node.value]};
            move.value.translation.y += 0.5f;
            const std::optional<PackedChanges> changes = edit(move);
            ASSERT_TRUE(changes.has_value());
            EXPECT_TRUE(changes->instances);
        }
    }
}

class FollowRandom : public ::testing::TestWithParam<uint>
{
};

INSTANTIATE_TEST_SUITE_P(, FollowRandom, ::testing::Range(0u, 12u));

TEST_P(FollowRandom, SequencesOfEditsAndPoses)
{
    RandomEdits random(GetParam());
    Scene scene = editable_scene();
    MotionMap motion;
    PackedScene packed = pack(scene, motion);
    int followed = 0;
    EditContext context;
    for (int step = 0; step < 40 && !testing::Test::HasFailure(); ++step) {
        SCOPED_TRACE(step);
        uint changes = change_none;
        const uint count = 1 + random.below(3);
        for (uint i = 0; i < count; ++i) {
            if (random.below(8) == 0) {
                context.animation = {random.below(2) == 0 ? 0 : none};
                context.seconds = random.number(0.0f, 2.0f);
                pose(scene, context.animation, context.seconds);
                changes |= change_pose;
                continue;
            }
            try {
                changes |= apply_edit(scene, random.edit(scene), context).changes;
            } catch (const Error&) {
            }
        }
        if (follow(scene, packed, motion, changes))
            ++followed;
        else
            packed = pack(scene, motion);
        expect_same_all(packed, packed_anew(scene));
    }
    EXPECT_GT(followed, 20);
}

} // namespace
} // namespace snell::test

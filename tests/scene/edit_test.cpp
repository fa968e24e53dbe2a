// Edits: what they do, refuse and mend; that undoing them gives back the scene, byte for byte.
#include "snell/core/error.h"
#include "snell/scene/history.h"
#include "snell/scene/outline.h"
#include "tests/scene/edits.h"

#include <limits>
#include <set>

namespace snell::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class Edits : public ::testing::Test
{
  protected:
    Scene scene = editable_scene();
    const std::string before = bytes(scene);

    void expect_refused(Edit edit, const char* part)
    {
        try {
            apply_edit(scene, std::move(edit));
            ADD_FAILURE() << "not refused: " << part;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
        EXPECT_EQ(bytes(scene), before);
    }

    uint index_of_instance(bool on_node) const
    {
        for (uint i = 0; i < scene.instances.size(); ++i)
            if (scene.instances[i].node.valid() == on_node) return i;
        return none;
    }
};

TEST_F(Edits, OfEachKindGoAndComeBack)
{
    for (uint kind = 0; kind < RandomEdits::kinds; ++kind) {
        SCOPED_TRACE(kind);
        RandomEdits random(kind);
        int applied_count = 0;
        for (int i = 0; i < 20; ++i) {
            const Edit edit = random.edit(scene, kind);
            AppliedEdit applied;
            try {
                applied = apply_edit(scene, edit);
            } catch (const Error&) {
                ASSERT_EQ(bytes(scene), before) << "refused, so nothing may change";
                continue;
            }
            ++applied_count;
            const std::string after = bytes(scene);
            EXPECT_EQ(applied.changes == change_none, std::holds_alternative<Rename>(edit));
            EXPECT_EQ(reapply(scene, applied.inverse), applied.changes);
            ASSERT_EQ(bytes(scene), before);
            EXPECT_EQ(reapply(scene, applied.edit), applied.changes);
            ASSERT_EQ(bytes(scene), after);
            reapply(scene, applied.inverse);
        }
        EXPECT_GT(applied_count, 2);
    }
}

TEST_F(Edits, SayWhatHasToFollow)
{
    const auto changes = [&](Edit edit) { return apply_edit(scene, std::move(edit)).changes; };
    EXPECT_EQ(changes(SetMaterial{{0}, scene.materials[1]}), change_materials);
    EXPECT_EQ(changes(AddMaterial{}), change_materials);
    EXPECT_EQ(changes(SetLight{1, LightDesc{}}), change_lights);
    EXPECT_EQ(changes(AddLight{}), change_lights);
    EXPECT_EQ(changes(RemoveLight{}), change_lights);
    EXPECT_EQ(changes(AddCamera{0, scene.cameras[0]}), change_camera);
    EXPECT_EQ(changes(SetEnvironment{}), change_environment);
    EXPECT_EQ(changes(SetTransform{index_of_instance(false), translation(vec3(1))}), change_transforms);
    EXPECT_EQ(changes(SetNode{{0}, scene.nodes[0]}), change_pose);
    SetSphere sphere{{0}, scene.spheres[0]};
    sphere.value.radius = 2.0f;
    EXPECT_EQ(changes(sphere), change_shapes);
    sphere.value.material = {0};
    EXPECT_EQ(changes(sphere), change_materials);
    EXPECT_EQ(changes(SetPlane{0, scene.planes[0]}), change_shapes);
    EXPECT_EQ(changes(Rename{ScenePart::camera, 0, "x"}), change_none);
    EXPECT_EQ(scene.cameras[0].name, "x");
}

TEST_F(Edits, IndicesOutOfRangeAreRefused)
{
    expect_refused(SetMaterial{{99}, {}}, "there is no material 99");
    expect_refused(SetLight{99, {}}, "there is no light 99");
    expect_refused(RemoveLight{99}, "there is no light 99");
    expect_refused(AddLight{99, {}}, "there is no place for a light 99");
    expect_refused(SetCamera{99, {}}, "there is no camera 99");
    expect_refused(RemoveCamera{99}, "there is no camera 99");
    expect_refused(SetTransform{99, {}}, "there is no instance 99");
    expect_refused(SetNode{{none}, {}}, "there is no node");
    expect_refused(SetSphere{{99}, {}}, "there is no sphere 99");
    expect_refused(SetPlane{99, {}}, "there is no plane 99");
    expect_refused(AssignMaterial{{99}, {0}, {0}}, "there is no mesh 99");
    expect_refused(AssignMaterial{{0}, {0}, {99}}, "there is no material 99");
    expect_refused(Rename{ScenePart::animation, 9, "x"}, "there is no animation 9");
    SetSphere sphere{{0}, scene.spheres[0]};
    sphere.value.material = {};
    expect_refused(sphere, "there is no material");
    SetMaterial textured{{0}, {}};
    textured.value.base_texture.image = {99};
    expect_refused(textured, "image 99");
    SetEnvironment sky;
    sky.value.image = {99};
    expect_refused(sky, "image 99");
}

TEST_F(Edits, WhatHasNoMeaningIsRefused)
{
    const uint free = index_of_instance(false), hung = index_of_instance(true);
    expect_refused(SetTransform{free, scaling(vec3(1, 0, 1))}, "singular");
    expect_refused(SetTransform{free, translation(vec3(nan))}, "NaN");
    expect_refused(SetTransform{hung, translation(vec3(1))}, "hangs on node");
    SetLight light{0, scene.lights[0]};
    ASSERT_TRUE(light.value.node.valid());
    light.value.position.x += 1.0f;
    expect_refused(light, "hangs on node");
    SetCamera camera{0, scene.cameras[0]};
    camera.value.target = camera.value.eye;
    expect_refused(camera, "same point");
    SetEnvironment sheared{scene.environment};
    sheared.value.to_world = scaling(vec3(1, 2, 1));
    expect_refused(sheared, "rotation");
    SetSphere flat{{0}, scene.spheres[0]};
    flat.value.radius = 0.0f;
    expect_refused(flat, "positive radius");
    SetPlane plane{0, scene.planes[0]};
    plane.value.normal = vec3(0);
    expect_refused(plane, "normal");
    SetNode node{{0}, scene.nodes[0]};
    node.value.rotation = vec4(0);
    expect_refused(node, "rotation");
    node = {{0}, scene.nodes[0]};
    node.value.weights.push_back(1.0f);
    expect_refused(node, "weights");
    expect_refused(AddImage{}, "no picture");
    expect_refused(AddImage{std::make_shared<const Image>(Image{"x", 2, 2, texels_rgba8_srgb, {1, 2}, {}})}, "texels");
    expect_refused(RemoveMaterial{}, "undoing");
    expect_refused(RemoveImage{}, "undoing");
    const Index<Mesh> two{static_cast<uint>(scene.meshes.size() - 1)};
    const auto& each = scene.meshes[two.value].triangle_materials;
    expect_refused(AssignMaterial{two, each[0], each[1]}, "already");
    expect_refused(AssignMaterial{two, {0}, each[1]}, "has nothing of material");
    SetMaterial light_as_colour{{0}, scene.materials[0]};
    light_as_colour.value.base_texture.image = scene.environment.image;
    expect_refused(light_as_colour, "not reflectances");
}

TEST_F(Edits, LampsStaySpheres)
{
    uint glass = none;
    for (uint i = 0; i < scene.materials.size(); ++i)
        if (scene.materials[i].name == "glass") glass = i;
    SetMaterial glowing{{glass}, scene.materials[glass]};
    glowing.value.emission = vec3(1.0f);
    expect_refused(glowing, "ellipsoid"); // one of its spheres is one
    // one that is round may shine, and must then stay round
    scene.instances[scene.instances.size() - 2].transform = identity_transform();
    apply_edit(scene, glowing);
    const uint squeezed = static_cast<uint>(scene.instances.size() - 2);
    EXPECT_THROW(apply_edit(scene, SetTransform{squeezed, scaling(vec3(1, 2, 1))}), Error);
}

TEST_F(Edits, TheLastCameraStays)
{
    apply_edit(scene, RemoveCamera{0});
    EXPECT_THROW(apply_edit(scene, RemoveCamera{0}), Error);
    EXPECT_EQ(scene.cameras.size(), 1u);
}

TEST_F(Edits, NumbersAreMendedAsThoseOfFiles)
{
    SetMaterial set{{0}, scene.materials[0]};
    set.value.base_color = vec3(2, 1, 0);
    set.value.emission = vec3(-1, 3, 0);
    AppliedEdit applied = apply_edit(scene, set);
    EXPECT_EQ(scene.materials[0].base_color, vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.materials[0].emission, vec3(0, 3, 0));
    EXPECT_EQ(applied.mended, "colour, emission");
    EXPECT_EQ(std::get<SetMaterial>(applied.edit).value.base_color, vec3(1, 0.5f, 0)) << "what can be done again";
    LightDesc spot;
    spot.kind = light_spot;
    spot.outer_degrees = 999.0f;
    EXPECT_EQ(apply_edit(scene, AddLight{0, spot}).mended, "cone angles");
    EXPECT_EQ(scene.lights[0].outer_degrees, 180.0f);
    Image image = picture("hot", 2, 2, texels_rgba32f, 1);
    image.floats[3] = -1.0f;
    image.floats[5] = nan;
    applied = apply_edit(scene, AddImage{std::make_shared<const Image>(image)});
    EXPECT_EQ(scene.images.back().floats[3], 0.0f);
    EXPECT_EQ(scene.images.back().floats[5], 0.0f);
    EXPECT_NE(applied.mended.find("2 values"), std::string::npos);
    EXPECT_EQ(scene.notes.size(), editable_scene().notes.size()) << "notes are about the file";
}

TEST_F(Edits, ANodeTakesAlongWhatHangsOnIt)
{
    uint lamp = none;
    for (uint i = 0; i < scene.lights.size(); ++i)
        if (scene.lights[i].node.valid()) lamp = i;
    const Index<Node> node = scene.lights[lamp].node;
    const vec3 at = scene.lights[lamp].position;
    SetNode set{node, scene.nodes[node.value]};
    set.value.translation += vec3(0, 0.25f, 0);
    apply_edit(scene, set);
    EXPECT_NE(scene.lights[lamp].position, at);
}

// ---- outlines ----

TEST_F(Edits, OutlinesAreLightAndFollowEveryEdit)
{
    Scene light = outline(scene);
    ASSERT_LT(bytes(light).size(), bytes(scene).size() / 2);
    EXPECT_EQ(bytes(outline(light)), bytes(light));
    const std::vector<MeshFigures> figures = mesh_figures(scene);
    ASSERT_EQ(figures.size(), scene.meshes.size());
    EXPECT_EQ(figures[0].triangles, scene.meshes[0].triangles.size());
    EXPECT_FALSE(figures[0].bounds.empty());
    EXPECT_TRUE(figures[scene.rigs[0].mesh.value].is_rigged);
    RandomEdits random(5);
    EditContext context, context_of_outline;
    context_of_outline.is_outline = true;
    for (int i = 0; i < 300; ++i) {
        SCOPED_TRACE(i);
        if (i % 10 == 0) {
            context.animation = context_of_outline.animation = first_animation;
            context.seconds = context_of_outline.seconds = random.number(0.0f, 2.0f);
            pose(scene, context.animation, context.seconds);
            pose(light, context.animation, context.seconds);
        }
        const Edit edit = random.edit(light);
        bool done = true;
        AppliedEdit applied;
        try {
            applied = apply_edit(light, edit, context_of_outline);
        } catch (const Error&) {
            done = false;
        }
        if (done)
            EXPECT_EQ(reapply(scene, applied.edit, context), applied.changes);
        else
            EXPECT_THROW(apply_edit(scene, edit, context), Error) << "both refuse the same";
        ASSERT_EQ(bytes(outline(scene)), bytes(light));
    }
}

// ---- history ----

TEST(HistoryTest, AllTheWayBackAndForth)
{
    Scene scene = editable_scene();
    History history;
    RandomEdits random(3);
    std::vector<std::string> states = {bytes(scene)};
    std::vector<std::uint64_t> numbers = {history.state()};
    for (int i = 0; i < 60; ++i) {
        std::vector<Edit> edits;
        for (uint k = 0; k <= random.below(3); ++k) edits.push_back(random.edit(scene));
        try {
            history.apply(scene, edits, "step");
        } catch (const Error&) {
            ASSERT_EQ(bytes(scene), states.back()) << "all or none";
            continue;
        }
        states.push_back(bytes(scene));
        numbers.push_back(history.state());
    }
    ASSERT_GT(states.size(), 20u);
    EXPECT_EQ(std::set<std::uint64_t>(numbers.begin(), numbers.end()).size(), numbers.size());
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = states.size() - 1; i-- > 0;) {
            ASSERT_NE(history.undo_label(), nullptr);
            EXPECT_FALSE(history.undo(scene).edits.empty());
            ASSERT_EQ(bytes(scene), states[i]);
            EXPECT_EQ(history.state(), numbers[i]);
        }
        EXPECT_EQ(history.undo_label(), nullptr);
        EXPECT_TRUE(history.undo(scene).edits.empty());
        for (std::size_t i = 1; i < states.size(); ++i) {
            history.redo(scene);
            ASSERT_EQ(bytes(scene), states[i]);
            EXPECT_EQ(history.state(), numbers[i]);
        }
        EXPECT_EQ(history.redo_label(), nullptr);
    }
}

Edit coloured(const Scene& scene, uint material, float red)
{
    SetMaterial set{{material}, scene.materials[material]};
    set.value.base_color.x = red;
    return set;
}

TEST(HistoryTest, ADragIsOneStep)
{
    Scene scene = editable_scene();
    const std::string before = bytes(scene);
    History history;
    for (int i = 0; i < 10; ++i) history.apply(scene, {coloured(scene, 0, 0.05f * static_cast<float>(i))}, "red", 7);
    EXPECT_EQ(history.size(), 1u);
    const std::string after = bytes(scene);
    history.undo(scene);
    EXPECT_EQ(bytes(scene), before);
    history.redo(scene);
    EXPECT_EQ(bytes(scene), after);
}

TEST(HistoryTest, WhatIsNoDragStaysApart)
{
    Scene scene = editable_scene();
    History history;
    history.apply(scene, {coloured(scene, 0, 0.1f)}, "a", 7);
    history.apply(scene, {coloured(scene, 0, 0.2f)}, "another control", 8);
    EXPECT_EQ(history.size(), 2u);
    history.apply(scene, {coloured(scene, 1, 0.3f)}, "another material", 8);
    EXPECT_EQ(history.size(), 3u);
    history.seal();
    history.apply(scene, {coloured(scene, 1, 0.4f)}, "let go", 8);
    EXPECT_EQ(history.size(), 4u);
    history.apply(scene, {coloured(scene, 1, 0.5f)}, "no control");
    history.apply(scene, {coloured(scene, 1, 0.6f)}, "no control");
    EXPECT_EQ(history.size(), 6u);
    history.apply(scene, {AddLight{}}, "adds", 9);
    history.apply(scene, {AddLight{}}, "adds", 9);
    EXPECT_EQ(history.size(), 8u);
    history.apply(scene, {coloured(scene, 0, 0.7f)}, "a", 7);
    history.undo(scene);
    history.redo(scene);
    history.apply(scene, {coloured(scene, 0, 0.8f)}, "after going back and forth", 7);
    EXPECT_EQ(history.size(), 10u);
}

TEST(HistoryTest, AnEditForgetsWhatWasUndone)
{
    Scene scene = editable_scene();
    History history;
    for (const float red : {0.1f, 0.2f, 0.3f}) history.apply(scene, {coloured(scene, 0, red)}, "red");
    history.undo(scene);
    history.undo(scene);
    const std::uint64_t state = history.state();
    history.apply(scene, {coloured(scene, 0, 0.9f)}, "other");
    EXPECT_EQ(history.size(), 2u);
    EXPECT_EQ(history.redo_label(), nullptr);
    EXPECT_NE(history.state(), state);
    history.undo(scene);
    EXPECT_EQ(history.state(), state);
    EXPECT_EQ(scene.materials[0].base_color.x, 0.1f);
}

TEST(HistoryTest, MemoryIsBounded)
{
    Scene scene = editable_scene();
    const std::size_t bound = 400000;
    History history(bound);
    const auto image = std::make_shared<const Image>(picture("large", 64, 64, texels_rgba8_srgb, 4));
    for (int i = 0; i < 100; ++i) {
        history.apply(scene, {AddImage{image}}, "picture");
        for (int k = 0; k < 5; ++k)
            history.apply(scene, {coloured(scene, 0, 0.01f * static_cast<float>(k))}, "drag", 7);
        EXPECT_LE(history.bytes(), bound);
    }
    EXPECT_GT(history.size(), 10u);
    const std::size_t kept = history.size();
    std::size_t undone = 0;
    while (!history.undo(scene).edits.empty()) ++undone;
    EXPECT_EQ(undone, kept);
    EXPECT_NE(history.state(), 0u) << "the beginning is out of reach";
    history.clear();
    EXPECT_EQ(history.bytes(), 0u);
    History small(1);
    small.apply(scene, {AddLight{}}, "light");
    EXPECT_EQ(small.size(), 1u) << "the newest stays";
}

} // namespace
} // namespace snell::test

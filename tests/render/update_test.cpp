// What is prepared follows edits, and makes the pictures that it would make if it were prepared anew.
#include "tests/render/scenes.h"
#include "tests/scene/edits.h"

namespace snell::test {
namespace {

RenderSettings edited_picture()
{
    RenderSettings settings = small_picture("path");
    settings.keep_motion = true;
    settings.width = 24;
    settings.height = 16;
    settings.spp = 2;
    return settings;
}

// Steps of rays are those of another tree once one was refitted.
void expect_pictures_anew(const Prepared& prepared, const Scene& scene, const RenderSettings& settings)
{
    const auto anew = prepare(scene, settings);
    expect_same_packed(prepared.packed, anew->packed);
    Film film = render(prepared, settings).film;
    const Film other = render(*anew, settings).film;
    film.layers.steps = other.layers.steps;
    expect_same_film(film, other);
}

class Update : public ::testing::Test
{
  protected:
    RenderSettings settings = edited_picture();
    Scene scene = editable_scene();
    std::unique_ptr<Prepared> prepared = prepare(scene, settings);
    const Accel* const tree = prepared->accel.get();

    void edit(Edit edit)
    {
        prepared->update(scene, apply_edit(scene, std::move(edit)).changes);
        expect_pictures_anew(*prepared, scene, settings);
    }

    void expect_no_tree_touched()
    {
        EXPECT_TRUE(prepared->updated);
        EXPECT_EQ(prepared->builds, 1u);
        EXPECT_EQ(prepared->accel.get(), tree);
        EXPECT_FALSE(prepared->changes.any());
        EXPECT_EQ(prepared->accel->stats.refitted + prepared->accel->stats.rebuilt, 0u);
    }
};

TEST_F(Update, MaterialsLightsAndEnvironmentTouchNoTree)
{
    RandomEdits random(1);
    for (uint i = 0; i < scene.materials.size(); ++i) {
        SetMaterial set{{i}, scene.materials[i]};
        set.value.base_color = random.vector(0.1f, 0.9f);
        edit(set);
        expect_no_tree_touched();
        set.value.emission = i % 2 == 0 ? vec3(2.0f) : vec3(0.0f);
        set.value.single_sided = true;
        try {
            edit(set);
        } catch (const Error&) {
            continue; // an ellipsoid may not shine
        }
        expect_no_tree_touched();
    }
    edit(SetLight{0, random.light(scene.lights[0])});
    edit(AddLight{1, random.light({})});
    edit(RemoveLight{0});
    SetEnvironment sky{scene.environment};
    sky.value.radiance = vec3(0.5f, 0.1f, 0.2f);
    sky.value.visible = false;
    edit(sky);
    edit(AddMaterial{});
    edit(SetPlane{0, {"plane", vec3(0, -1.2f, 0), vec3(0.1f, 1, 0), {0}}});
    expect_no_tree_touched();
}

TEST_F(Update, TheCameraIsFollowed)
{
    SetCamera set{0, scene.cameras[0]};
    set.value.fov_degrees = 60.0f;
    edit(set);
    expect_no_tree_touched();
    edit(AddCamera{0, scene.cameras[1]});
    EXPECT_EQ(prepared->camera.eye, scene.cameras[0].eye);
}

TEST_F(Update, TransformsAndSpheresTouchTheirTreesAlone)
{
    for (uint i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].node.valid()) continue;
        edit(SetTransform{i, compose(scene.instances[i].transform, translation(vec3(0.1f)))});
        EXPECT_TRUE(prepared->updated);
        EXPECT_TRUE(prepared->changes.any());
        EXPECT_LE(prepared->accel->stats.refitted + prepared->accel->stats.rebuilt, 1u);
    }
    for (uint i = 0; i < scene.spheres.size(); ++i) {
        SetSphere set{{i}, scene.spheres[i]};
        set.value.radius *= 0.8f;
        edit(set);
        EXPECT_TRUE(prepared->updated);
        EXPECT_EQ(prepared->accel->stats.refitted + prepared->accel->stats.rebuilt, 1u);
    }
    EXPECT_EQ(prepared->builds, 1u);
    EXPECT_EQ(prepared->accel.get(), tree);
}

TEST_F(Update, AnotherLayoutIsPackedAndBuiltAnew)
{
    edit(
        SetTransform{static_cast<uint>(scene.instances.size() - 1), scaling(vec3(1, 2, 1))}); // a mesh: nothing special
    EXPECT_TRUE(prepared->updated);
    prepared->update(scene, change_everything);
    EXPECT_FALSE(prepared->updated);
    EXPECT_EQ(prepared->builds, 2u);
    EXPECT_FALSE(prepared->changes.any());
    expect_pictures_anew(*prepared, scene, settings);
    place(scene, make_torus("new", 0.5f, 0.2f, 12, 8, {0}));
    prepared->update(scene, change_everything);
    expect_pictures_anew(*prepared, scene, settings);
}

TEST_F(Update, AfterAFailureTheNextOneMendsEverything)
{
    uint glass = none;
    for (uint i = 0; i < scene.materials.size(); ++i)
        if (scene.materials[i].name == "glass") glass = i;
    scene.materials[glass].emission = vec3(1.0f); // one of its spheres is an ellipsoid
    EXPECT_THROW(prepared->update(scene, change_materials), Error);
    scene.materials[glass].emission = vec3(0.0f);
    prepared->update(scene, change_none);
    EXPECT_FALSE(prepared->updated);
    expect_pictures_anew(*prepared, scene, settings);
}

TEST(UpdateSettings, OverridesOfMaterialsAreAppliedAgain)
{
    for (const bool textures : {false, true})
        for (const bool diffuse : {false, true}) {
            SCOPED_TRACE(testing::Message() << textures << diffuse);
            RenderSettings settings = edited_picture();
            settings.image_textures = textures;
            settings.force_diffuse = diffuse;
            Scene scene = editable_scene();
            const auto prepared = prepare(scene, settings);
            RandomEdits random(11);
            for (int i = 0; i < 25; ++i) {
                SCOPED_TRACE(i);
                try {
                    const Edit edit = random.edit(scene, RandomEdits::kinds - 1 - random.below(2));
                    prepared->update(scene, apply_edit(scene, edit).changes);
                } catch (const Error&) {
                    continue;
                }
                expect_pictures_anew(*prepared, scene, settings);
            }
        }
}

TEST(UpdateSettings, RandomEditsWithEveryStructure)
{
    for (const char* accel : {"bvh8", "bvh8q", "bvh2", "brute"}) {
        SCOPED_TRACE(accel);
        RenderSettings settings = edited_picture();
        settings.accel = accel;
        settings.layers = false;
        Scene scene = editable_scene();
        const auto prepared = prepare(scene, settings);
        RandomEdits random(17);
        std::size_t kept = 0;
        for (int i = 0; i < 30; ++i) {
            SCOPED_TRACE(i);
            uint changes = change_none;
            for (int k = 0; k < 3; ++k) {
                try {
                    changes |= apply_edit(scene, random.edit(scene)).changes;
                } catch (const Error&) {
                }
            }
            prepared->update(scene, changes);
            kept += prepared->updated ? 1 : 0;
            expect_pictures_anew(*prepared, scene, settings);
        }
        EXPECT_GT(kept, 15u);
    }
}

} // namespace
} // namespace snell::test

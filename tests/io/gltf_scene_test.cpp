// Nodes and what hangs on them: instances, skins, morph targets, lights, cameras, animations, variants.
#include "tests/io/gltf_files.h"

#include "snell/scene/camera_models.h"

namespace snell {
namespace {

using namespace test;

vec3 at(const Transform& m, vec3 p)
{
    return transform_point(m, p);
}

void expect_near(vec3 a, vec3 b, float tolerance = 1e-5f)
{
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(GltfScene, HierarchyOfMatricesAndParts)
{
    Gltf file = Gltf::triangle();
    file.root["nodes"][0] = {
        {"mesh", 0}, {"name", "leaf"}, {"scale", {2, 2, 2}}, {"rotation", {0, 0, 0.70710678, 0.70710678}}};
    file.append("nodes", {{"children", {0}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}});
    file.root["scenes"][0]["nodes"] = {1};
    const Scene scene = load(file);
    ASSERT_EQ(scene.nodes.size(), 2u);
    EXPECT_EQ(scene.nodes[0].parent.value, 1u);
    EXPECT_TRUE(scene.nodes[1].has_matrix);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].node.value, 0u);
    expect_near(at(scene.instances[0].transform, {1, 0, 0}), {10, 22, 30}); // x turns to y, twice as long
}

TEST(GltfScene, OnlyTheDefaultSceneIsShown)
{
    Gltf file = Gltf::triangle();
    file.append("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    file.append("scenes", {{"nodes", {1}}, {"name", "second"}});
    file.root["scene"] = 1;
    const Scene scene = load(file);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].transform.x.w, 5.0f);
    EXPECT_NE(notes_of(scene).find("has 2 scenes; scene 1 'second' is shown"), std::string::npos);
    file.root.erase("scenes");
    file.root.erase("scene");
    EXPECT_EQ(load(file).instances.size(), 2u);
}

TEST(GltfScene, AMeshThatIsShownTwiceIsOneGroup)
{
    Gltf file = Gltf::triangle();
    file.node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
    const Scene scene = load(file);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.groups.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_LT(determinant(scene.instances[1].transform), 0.0f);
}

TEST(GltfScene, TreesOnly)
{
    Gltf file = Gltf::triangle();
    file.append("nodes", {{"children", {2}}});
    file.append("nodes", {{"children", {1}}});
    EXPECT_NE(error_of(file).find("its own ancestor"), std::string::npos);
    file.root["nodes"][1]["children"] = {0};
    file.root["nodes"][2]["children"] = {0};
    EXPECT_NE(error_of(file).find("both have node 0"), std::string::npos);
    file.root["nodes"][2]["children"] = {7};
    EXPECT_NE(error_of(file).find("refers to node 7, but there are 3"), std::string::npos);
}

TEST(GltfScene, DeepHierarchies)
{
    Gltf file = Gltf::triangle();
    constexpr int depth = 20000;
    json nodes = json::array();
    for (int i = 0; i < depth; ++i) nodes.push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
    nodes.push_back({{"mesh", 0}});
    file.root["nodes"] = nodes;
    file.root["scenes"][0]["nodes"] = {0};
    EXPECT_EQ(load(file).instances.at(0).transform.x.w, static_cast<float>(depth));
}

TEST(GltfScene, GpuInstancing)
{
    Gltf file = Gltf::triangle();
    const json attributes = {
        {"TRANSLATION", file.accessor<float>({1, 0, 0, 0, 2, 0, 0, 0, 3}, "VEC3")},
        {"ROTATION", file.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 0, 32767}, "VEC4", true)},
        {"SCALE", file.accessor<float>({1, 1, 1, 2, 2, 2, 0, 0, 0}, "VEC3")}};
    file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    file.root["nodes"][0]["translation"] = {100, 0, 0};
    const Scene scene = load(file);
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_near(at(scene.instances[0].transform, {1, 0, 0}), {102, 0, 0});
    expect_near(at(scene.instances[1].transform, {1, 0, 0}), {98, 2, 0}); // half a turn
    EXPECT_NE(notes_of(scene).find("1 of 3 are flattened"), std::string::npos);

    // Where the node moves, its instances follow.
    file.append("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                               {"samplers",
                                {{{"input", file.accessor<float>({0, 1}, "SCALAR")},
                                  {"output", file.accessor<float>({0, 0, 0, 0, 50, 0}, "VEC3")}}}}});
    Scene moving = load(file);
    pose(moving, {0}, 1.0f);
    ASSERT_EQ(moving.instances.size(), 3u);
    expect_near(at(moving.instances[0].transform, {1, 0, 0}), {2, 50, 0});
}

Gltf skinned()
{
    Gltf file = Gltf::triangle();
    json& attributes = file.primitive()["attributes"];
    attributes["JOINTS_0"] = file.accessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    attributes["WEIGHTS_0"] = file.accessor<std::uint8_t>({255, 0, 0, 0, 128, 127, 0, 0, 255, 0, 0, 0}, "VEC4", true);
    file.root["nodes"][0] = {{"mesh", 0}, {"skin", 0}, {"translation", {1000, 0, 0}}};
    file.node({{"name", "first"}});
    file.node({{"name", "second"}, {"translation", {0, 10, 0}}});
    // By columns: moves by -10 along y.
    const std::vector<float> inverse = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,   0, 1,
                                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -10, 0, 1};
    file.append("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", file.accessor(inverse, "MAT4")}});
    return file;
}

TEST(GltfScene, SkinsFollowTheirJoints)
{
    Gltf file = skinned();
    Scene scene = load(file);
    EXPECT_EQ(notes_of(scene), "");
    ASSERT_EQ(scene.rigs.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_FALSE(scene.instances[0].node.valid());        // where its node is does not matter
    expect_near(scene.meshes[0].positions[1], {1, 0, 0}); // at rest: where it is in the file
    EXPECT_NEAR(scene.rigs[0].weights[1].x + scene.rigs[0].weights[1].y, 1.0f, 1e-6f);
    scene.nodes[2].translation = vec3(0, 10, 4);
    pose(scene, {}, 0.0f);
    expect_near(scene.meshes[0].positions[0], {0, 0, 0});
    expect_near(scene.meshes[0].positions[1], {1, 0, 4.0f * 128 / 255});
    expect_near(scene.meshes[0].positions[2], {0, 1, 4});
}

TEST(GltfScene, SkinsThatDoNotFit)
{
    Gltf file = skinned();
    file.root["skins"][0]["joints"] = {1};
    EXPECT_NE(notes_of(load(file)).find("weights are for joints that its skin of 1 does not have"), std::string::npos);
    file.root["skins"][0]["joints"] = {1, 9};
    EXPECT_NE(error_of(file).find("refers to node 9"), std::string::npos);
    file.root["skins"][0]["joints"] = {1, 2, 1};
    EXPECT_NE(error_of(file).find("3 joints and 2 inverse bind matrices"), std::string::npos);
    file.root["skins"][0]["joints"] = json::array();
    EXPECT_NE(error_of(file).find("no joints"), std::string::npos);
    file.root["skins"][0]["joints"] = {1, 2};
    file.root["nodes"][0]["skin"] = 4;
    EXPECT_NE(error_of(file).find("refers to skin 4"), std::string::npos);
    Gltf bare = Gltf::triangle();
    bare.append("skins", {{"joints", {0}}});
    bare.root["nodes"][0]["skin"] = 0;
    EXPECT_NE(notes_of(load(bare)).find("no joints; it stays at rest"), std::string::npos);
    EXPECT_EQ(triangle_count(load(bare)), 1u);
}

TEST(GltfScene, MorphTargetsPerNode)
{
    Gltf file = Gltf::triangle();
    const int target = file.accessor<float>({0, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3");
    file.primitive()["targets"] = {{{"POSITION", target}}, json::object()};
    file.root["meshes"][0]["weights"] = {0.25, 0};
    file.node({{"mesh", 0}, {"weights", {1, 0}}});
    const Scene scene = load(file);
    ASSERT_EQ(scene.rigs.size(), 2u);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.nodes[0].weights, (std::vector<float>{0.25f, 0}));
    EXPECT_EQ(scene.meshes[0].positions[0].z, 0.25f);
    EXPECT_EQ(scene.meshes[1].positions[0].z, 1.0f);
    EXPECT_EQ(scene.rigs[0].positions[0].z, 0.0f);
}

TEST(GltfScene, AnimationsOfAllKinds)
{
    Gltf file = Gltf::triangle();
    const int target = file.accessor<float>({0, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3");
    file.primitive()["targets"] = {{{"POSITION", target}}};
    const int times = file.accessor<float>({0, 2}, "SCALAR");
    json samplers = json::array(), channels = json::array();
    const auto add = [&](const char* path, const char* interpolation, int output) {
        channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", 0}, {"path", path}}}});
        samplers.push_back({{"input", times}, {"output", output}, {"interpolation", interpolation}});
    };
    add("translation", "CUBICSPLINE",
        file.accessor<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0}, "VEC3"));
    add("rotation", "LINEAR", file.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0}, "VEC4", true));
    add("scale", "STEP", file.accessor<float>({1, 1, 1, 3, 3, 3}, "VEC3"));
    add("weights", "LINEAR", file.accessor<std::uint8_t>({0, 255}, "SCALAR", true));
    file.append("animations", {{"name", "all"}, {"channels", channels}, {"samplers", samplers}});
    Scene scene = load(file);
    EXPECT_EQ(notes_of(scene), "");
    ASSERT_EQ(scene.animations.size(), 1u);
    EXPECT_EQ(scene.animations[0].channels.size(), 4u);
    EXPECT_EQ(scene.animations[0].duration, 2.0f);
    pose(scene, {0}, 1.0f);
    EXPECT_NEAR(scene.meshes[0].positions[0].z, 0.5f, 1e-6f);
    // Half way: moved by 2, turned by a quarter, not yet scaled.
    expect_near(at(scene.instances[0].transform, {1, 0, 0}), {2, 1, 0});
    pose(scene, {0}, 2.0f);
    expect_near(at(scene.instances[0].transform, {1, 0, 0}), {4 - 3, 0, 0});
}

TEST(GltfScene, ChannelsThatMakeNoSenseAreLeftOut)
{
    Gltf file = Gltf::triangle();
    const int good = file.accessor<float>({0, 1}, "SCALAR"), falling = file.accessor<float>({1, 0}, "SCALAR");
    const int two = file.accessor<float>({0, 0, 0, 1, 1, 1}, "VEC3"),
              three = file.accessor<float>({0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3");
    const auto notes = [&](int input, int output, json target, const char* interpolation = "LINEAR") {
        file.root["animations"] = json::array();
        file.append("animations",
                    {{"channels", {{{"sampler", 0}, {"target", std::move(target)}}}},
                     {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}}});
        const Scene scene = load(file);
        EXPECT_EQ(scene.animations.at(0).channels.size(), notes_of(scene).empty() ? 1u : 0u);
        return notes_of(scene);
    };
    const json move = {{"node", 0}, {"path", "translation"}};
    EXPECT_EQ(notes(good, two, move), "");
    EXPECT_NE(notes(falling, two, move).find("do not ascend"), std::string::npos);
    EXPECT_NE(notes(good, three, move).find("2 keys need 6 numbers, and it has 9"), std::string::npos);
    EXPECT_NE(notes(good, two, move, "CUBICSPLINE").find("need 18"), std::string::npos);
    EXPECT_NE(notes(good, two, move, "MAGIC").find("MAGIC"), std::string::npos);
    EXPECT_NE(notes(good, two, {{"node", 0}, {"path", "weights"}}).find("no morph targets"), std::string::npos);
    EXPECT_NE(notes(good, two, {{"path", "pointer"}}).find("moves no node"), std::string::npos);
    file.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_NE(notes(good, two, move).find("has a matrix"), std::string::npos);
    file.root["animations"][0]["channels"][0]["sampler"] = 3;
    EXPECT_NE(error_of(file).find("refers to sampler 3"), std::string::npos);
}

TEST(GltfScene, Lights)
{
    Gltf file = Gltf::triangle();
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"name", "bulb"}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}},
        {{"type", "directional"}, {"intensity", 3}},
        {{"type", "area"}}};
    for (int i = 0; i < 4; ++i)
        file.node({{"translation", {0, 0, 7}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    const Scene scene = load(file);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].name, "bulb");
    EXPECT_EQ(scene.lights[0].emission, vec3(8, 4, 0));
    EXPECT_EQ(scene.lights[0].position, vec3(0, 0, 7));
    EXPECT_EQ(scene.lights[1].kind, light_spot);
    EXPECT_NEAR(scene.lights[1].inner_degrees, 5.7295780f, 1e-4f);
    EXPECT_NEAR(scene.lights[1].outer_degrees, 28.647890f, 1e-4f);
    EXPECT_EQ(scene.lights[2].kind, light_directional);
    EXPECT_EQ(scene.lights[2].direction, vec3(0, 0, -1));
    EXPECT_NE(notes_of(scene).find("'area' is not known"), std::string::npos);
}

TEST(GltfScene, Cameras)
{
    Gltf file = Gltf::triangle();
    const auto perspective = [](double aspect) {
        return json{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}, {"aspectRatio", aspect}}}};
    };
    file.append("cameras", perspective(1.5));
    file.append("cameras", perspective(0.5));
    file.append("cameras",
                {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0}, {"zfar", 100}}}});
    for (int i = 0; i < 3; ++i) file.node({{"camera", i}, {"translation", {0.5, 0.5, 10}}});
    const Scene scene = load(file);
    ASSERT_EQ(scene.cameras.size(), 3u);
    EXPECT_NEAR(scene.cameras[0].fov_degrees, 57.29578f, 1e-4f);
    EXPECT_NEAR(scene.cameras[1].fov_degrees, 2 * 57.29578f * std::atan(0.5f * std::tan(0.5f)), 1e-4f);
    EXPECT_EQ(scene.cameras[0].model.kind, camera_pinhole);
    EXPECT_EQ(scene.cameras[2].model.kind, camera_orthographic);
    const Camera flat = make_camera(scene.cameras[2], 400, 200);
    expect_near(camera_ray(flat, {400, 100}).origin, {2.5f, 0.5f, 10});
    expect_near(camera_ray(flat, {200, 0}).origin, {0.5f, 1.5f, 10});
    expect_near(camera_ray(flat, {399, 1}).direction, {0, 0, -1});
    expect_near(scene.cameras[0].eye, {0.5f, 0.5f, 10});
    EXPECT_EQ(notes_of(scene), "");
}

TEST(GltfScene, Variants)
{
    Gltf file = Gltf::with_material({{"name", "plain"}});
    file.append("materials", {{"name", "red"}});
    file.root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "day"}}, {{"name", "night"}}};
    file.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {1}}}};
    const auto shown = [&](const char* variant) {
        LoadOptions options;
        options.variant = variant;
        const Scene scene = load(file, options);
        EXPECT_EQ(scene.variants, (std::vector<std::string>{"day", "night"}));
        return scene.materials[scene.meshes[0].material.value].name;
    };
    EXPECT_EQ(shown(""), "plain");
    EXPECT_EQ(shown("day"), "plain");
    EXPECT_EQ(shown("night"), "red");
    LoadOptions wrong;
    wrong.variant = "nigth";
    EXPECT_NE(error_of(file, wrong).find("did you mean 'night'"), std::string::npos);
}

TEST(GltfScene, ProgressNeverFalls)
{
    LoadOptions options;
    double last = 0.0;
    int calls = 0;
    options.progress = [&](const LoadProgress& progress) {
        EXPECT_GE(progress.fraction, last);
        EXPECT_LE(progress.fraction, 1.0);
        last = progress.fraction;
        ++calls;
    };
    load(Gltf::triangle(), options);
    EXPECT_GE(calls, 4);
}

} // namespace
} // namespace snell

// Scenes that are written as pbrt files and read back: the same fields, and the same pictures, bit for bit.
#include "tests/io/pbrt_write.h"

#include "snell/io/file.h"
#include "snell/io/ply/ply.h"
#include "snell/io/ply/write.h"
#include "snell/scene/builtin.h"
#include "snell/scene/camera_models.h"
#include "snell/scene/shapes.h"

#include <sstream>

namespace snell {
namespace {

using namespace test;

// ---- scenes ----

TEST(PbrtWrite, BuiltInScenesComeBack)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(std::string(builtin.name));
        const std::string name(builtin.name);
        Scene scene = *make_builtin_scene(name == "sphereflake" ? "sphereflake:4" : name);
        validate(scene);
        const Folder folder;
        const Scene back = write_and_read(folder, scene);
        if (name == "whitted") // a checkerboard of two materials in one mesh
            EXPECT_EQ(placed(back).size(), placed(scene).size() + 1);
        else if (name == "grid") // six walls of three materials each
            EXPECT_EQ(placed(back).size(), placed(scene).size() + 12);
        else
            expect_same(scene, back);
        expect_same_picture(scene, back, name);
        // Once more: what was split stays so.
        const Folder again;
        expect_same(back, write_and_read(again, back));
    }
}

// Every field of every material set to something unusual.
Scene unusual_scene()
{
    Scene scene;
    scene.name = "unusual";
    const Index<Image> color = add(scene, noise("colour \"quoted\\name\"", texels_rgba8_srgb, 5, true));
    const Index<Image> data = add(scene, noise("data", texels_rgba8_linear, 4, false));
    const Index<Image> floats = add(scene, noise("floats", texels_rgba32f, 3, true));
    uint count = 0;
    const auto ref = [&](Index<Image> image) {
        TextureRef r;
        r.image = image;
        r.uv_set = count % 2;
        r.wrap_u = count % 3, r.wrap_v = count / 2 % 3;
        r.filter = count / 3 % 2;
        const float x = static_cast<float>(count);
        if (count % 2 == 1) r.row_u = vec3(1.5f, 0.1f * x, -0.3f), r.row_v = vec3(-0.2f, 0.7f, x / 3.0f);
        if (count % 4 == 2) r.row_u = vec3(2.0f, 0.0f, 0.1f), r.row_v = vec3(0.0f, -3.0f, 1.0f);
        ++count;
        return r;
    };
    const auto number = [&](Index<Image> image) {
        TextureRef r = ref(image);
        r.channel = count % 4;
        return r;
    };

    MaterialDesc all;
    all.name = "all";
    all.kind = material_principled;
    all.base_color = {0.9f, 0.8f, 1.0f / 3.0f};
    all.base_texture = ref(color);
    all.ior = 1.33f;
    all.absorption = {0.1f, 0.2f, 0.3f};
    all.emission = {0.5f, 1.0f / 7.0f, 0.25f};
    all.emission_texture = ref(color);
    all.two_sided_emission = true, all.single_sided = true;
    all.normal_texture = number(data);
    all.normal_texture.channel = 0;
    all.normal_scale = -0.75f;
    all.coverage = coverage_mask;
    all.opacity = 0.9f, all.cutoff = 0.1f;
    all.opacity_texture = number(data);
    float value = 0.1f;
    for (const pbrt::NumberSlot& slot : pbrt::number_slots) {
        all.principled.*slot.number = value += 0.05f;
        if (slot.texture != nullptr) all.principled.*slot.texture = number(count % 2 == 0 ? data : floats);
    }
    all.principled.anisotropy_rotation = -2.5f;
    all.principled.iridescence_ior = 1.8f;
    all.principled.iridescence_thickness_min = 123.4f, all.principled.iridescence_thickness_max = 567.8f;
    for (const pbrt::ColorSlot& slot : pbrt::color_slots) {
        all.principled.*slot.color = vec3(value, 0.5f * value, 0.3f);
        all.principled.*slot.texture = ref(count % 2 == 0 ? color : floats);
    }
    for (const pbrt::MapSlot& slot : pbrt::map_slots) all.principled.*slot.texture = number(data);
    all.principled.thin_walled = false;

    std::vector<MaterialDesc> materials = {all, MaterialDesc{}, all};
    materials[1].name = "all"; // again
    materials[1].base_color = {0.1f, 0.7f, 0.3f};
    materials[1].base_texture = ref(color);
    materials[1].normal_texture.image = data;
    materials[1].emission = {3.0f, 2.0f, 1.0f};
    materials[1].two_sided_emission = true;
    materials[2].principled = {}; // numbers without textures, and usual ones
    materials[2].base_texture = materials[2].normal_texture = materials[2].opacity_texture = {};
    materials[2].emission_texture = {};
    materials[2].name = "";
    materials[2].coverage = coverage_blend;
    const auto more = [&](const char* name, uint kind) -> MaterialDesc& {
        MaterialDesc& m = materials.emplace_back();
        m.name = name;
        m.kind = kind;
        return m;
    };
    MaterialDesc& paint = more("paint", material_mix);
    paint.base_color = {0.2f, 0.3f, 0.4f}, paint.specular = {0.3f, 0.2f, 0.1f}, paint.alpha = 0.21f;
    paint.base_texture = ref(floats), paint.texture_tints_specular = true;
    MaterialDesc& glass = more("glass", material_dielectric);
    glass.base_color = {0.9f, 0.95f, 1.0f}, glass.base_texture = ref(color), glass.ior = 1.7f, glass.alpha = 0.3f;
    glass.absorption = {0.5f, 0.25f, 0.0f};
    MaterialDesc& metal = more("metal", material_conductor);
    metal.base_color = vec3(1.0f), metal.specular = {0.2f, 0.9f, 1.1f}, metal.absorption = {3.9f, 2.4f, 2.1f};
    metal.alpha = 0.0123f;
    MaterialDesc& mirror = more("mirror", material_mirror);
    mirror.base_color = vec3(0.77f), mirror.base_texture = ref(color);
    more("flat", material_unlit).base_color = {0.3f, 0.6f, 0.9f};
    materials.back().base_texture = ref(color);

    MaterialDesc& usual = more("textures alone", material_principled); // beside numbers that are as usual
    usual.principled = all.principled;
    for (const pbrt::NumberSlot& slot : pbrt::number_slots)
        usual.principled.*slot.number = PrincipledDesc{}.*slot.number;
    for (const pbrt::ColorSlot& slot : pbrt::color_slots) usual.principled.*slot.color = PrincipledDesc{}.*slot.color;
    usual.emission_texture = ref(color);

    float x = -3.0f;
    for (const MaterialDesc& m : materials) {
        const Index<MaterialDesc> index = add(scene, m);
        Mesh mesh = make_torus("ring " + m.name, 0.3f, 0.15f, x < 0 ? 6 : 12, 5, index);
        mesh.uvs_1.assign(mesh.positions.size(), vec2(0.3f, 0.1f * x));
        mesh.tangents.assign(mesh.positions.size(), vec4(1.0f, 0.0f, 0.0f, x < 0 ? -1.0f : 1.0f));
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            mesh.colors.emplace_back(0.5f + 0.5f / static_cast<float>(i + 1), 1.0f, 0.9f, 0.7f);
        place(scene, std::move(mesh), compose(translation({x, 0.7f, 0.2f * x}), rotation({1, 2, 3}, 40.0f * x)));
        SphereDesc ball;
        ball.name = "ball " + m.name;
        ball.center = {x, 0.1f * x, 1.0f};
        ball.radius = 0.33f;
        ball.material = index;
        place(scene, ball);
        x += 0.8f;
    }
    PlaneDesc floor;
    floor.name = "floor";
    floor.point = {0, -1.0f / 3.0f, 0}, floor.normal = {0.1f, 3.0f, 0.0f};
    floor.material = {1};
    add(scene, floor);

    // A group of everything, placed twice, and one that flattens its spheres.
    Group group;
    group.name = "group";
    Mesh ring = make_torus("ring", 0.3f, 0.1f, 9, 7, {1});
    for (vec3& n : ring.normals) n *= 1.00001f; // the length is nobody's business
    group.meshes = {add(scene, make_box("box", vec3(-0.2f), vec3(0.2f), {1})), add(scene, ring)};
    SphereDesc small;
    small.name = "small"; // a textured mirror
    small.center = {0.1f, 0.5f, 0.1f}, small.radius = 0.2f, small.material = {7};
    group.spheres = {add(scene, small)};
    const Index<Group> both = add(scene, group);
    add(scene, InstanceDesc{"first", both, compose(translation({-1, 1, 1}), rotation({0, 1, 0}, 33.0f))});
    add(scene, InstanceDesc{"second", both, scaling({-1, 1, 1.5f})});
    SphereDesc egg = small;
    egg.name = "egg";
    Group eggs{"eggs", {}, {add(scene, egg)}};
    add(scene, InstanceDesc{"eggs", add(scene, eggs), compose(translation({1, 1, 1}), scaling({1, 2, 0.7f}))});

    LightDesc spot;
    spot.name = "spot";
    spot.kind = light_spot;
    spot.position = {1.1f, 4.0f, 2.2f}, spot.direction = {-0.3f, -1.7f, -0.9f};
    spot.inner_degrees = 0.1f, spot.outer_degrees = 47.3f, spot.emission = {30.0f, 20.0f, 10.0f};
    add(scene, spot);
    spot.kind = light_directional, spot.name = "sun", spot.emission = {0.3f, 0.2f, 0.1f};
    add(scene, spot);
    spot.kind = light_point, spot.name = "";
    add(scene, spot);
    CameraDesc camera;
    camera.name = "left";
    camera.eye = {-0.7f, 1.3f, 5.1f}, camera.target = {0.1f, 0.2f, 0.3f}, camera.up = {0.1f, 0.9f, 0.0f};
    camera.fov_degrees = 51.3f;
    add(scene, camera);
    camera.name = "mirrored";
    camera.mirrored = true;
    add(scene, camera);
    for (uint kind = 0; kind < camera_model_count; ++kind) {
        CameraDesc other = camera;
        other.name = camera_models()[kind].name;
        other.model = usual_model(kind);
        CameraModel& m = other.model;
        const bool says_fov = kind != camera_orthographic && kind != camera_equirectangular && kind != camera_lens;
        if (!says_fov) other.fov_degrees = camera_models()[kind].usual_fov;
        if (kind == camera_pinhole) m.lens_radius = 0.1f, m.blades = 5, m.blade_rotation_degrees = 11.5f;
        if (kind == camera_pinhole || kind == camera_lens) m.focus_distance = 3.3f;
        if (kind == camera_orthographic) m.half_side = 1.7f;
        if (kind == camera_hmd) m.eye_distance = 0.07f, m.k = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f};
        if (kind == camera_kannala_brandt) m.k = {0.01f, 0.02f, 0.03f, 0.04f};
        if (kind == camera_brown_conrady) {
            m.k = {0.01f, 0.02f, 0.03f, 0.04f, 0.05f, 0.06f, 0.007f, 0.008f};
            m.calibrated_width = 640.0f, m.calibrated_height = 480.0f;
            m.focal = {500.0f, 501.0f}, m.center = {320.5f, 240.25f};
        }
        if (kind == camera_lens) m.film_diagonal = 30.0f, m.stop_diameter = 9.5f, m.millimetre = 0.01f;
        add(scene, other);
    }
    scene.environment.image = add(scene, noise("sky", texels_rgba32f, 8, false));
    scene.environment.radiance = {0.5f, 0.4f, 0.3f};
    scene.environment.to_world = compose(rotation({1, 2, 3}, 77.0f), scaling({-1, 1, 1}));
    scene.environment.visible = false;
    scene.hints.width = 123, scene.hints.height = 77, scene.hints.crop_window = {0.1f, 0.9f, 0.0f, 1.0f / 3.0f};
    scene.hints.spp = 17, scene.hints.seed = 4'000'000'000u, scene.hints.sampler = "independent";
    scene.hints.integrator = "path", scene.hints.max_depth = 9, scene.hints.output = "a \"b\".exr";
    return scene;
}

TEST(PbrtWrite, EveryFieldComesBack)
{
    Scene scene = unusual_scene();
    const std::size_t before = scene.notes.size();
    validate(scene);
    EXPECT_EQ(scene.notes.size(), before) << scene.notes.back().text; // the test's own numbers are good ones
    const Folder folder;
    const Scene back = write_and_read(folder, scene);
    expect_same(scene, back);
    expect_same_picture(scene, back, "unusual");
    EXPECT_EQ(back.hints.width, scene.hints.width);
    EXPECT_EQ(back.hints.height, scene.hints.height);
    EXPECT_EQ(back.hints.crop_window, scene.hints.crop_window);
    EXPECT_EQ(back.hints.spp, scene.hints.spp);
    EXPECT_EQ(back.hints.seed, scene.hints.seed);
    EXPECT_EQ(back.hints.sampler, scene.hints.sampler);
    EXPECT_EQ(back.hints.integrator, scene.hints.integrator);
    EXPECT_EQ(back.hints.max_depth, scene.hints.max_depth);
    EXPECT_EQ(back.hints.output, scene.hints.output);
    std::set<std::string> names;
    for (const Image& image : back.images) names.insert(image.name);
    for (const Image& image : scene.images) EXPECT_EQ(names.count(image.name), 1u) << image.name;
}

TEST(PbrtWrite, PicturesOfTheSkyInBytes)
{
    Scene scene = *make_builtin_scene("cornell");
    scene.environment.image = add(scene, noise("sky", texels_rgba8_srgb, 6, false));
    scene.environment.radiance = vec3(2.5f);
    scene.environment.mapping = environment_octahedral;
    validate(scene);
    const Folder folder;
    const Scene back = write_and_read(folder, scene);
    expect_same(scene, back);
    expect_same_picture(scene, back, "sky");
}

TEST(PbrtWrite, MeshesOfSeveralMaterialsAreSplit)
{
    Scene scene;
    Mesh mesh = make_torus("ring", 0.5f, 0.2f, 16, 8, {0});
    for (const char* name : {"red", "green", "lamp"}) {
        MaterialDesc m;
        m.name = name;
        m.base_color = {0.1f * static_cast<float>(scene.materials.size()), 0.5f, 0.3f};
        if (scene.materials.size() == 2) m.emission = vec3(4.0f);
        add(scene, m);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        mesh.triangle_materials.push_back({static_cast<uint>(i * i % 3)}); // 0 or 1, never 2
    mesh.triangle_materials[5] = {2};
    place(scene, mesh, rotation({1, 0, 0}, 30.0f));
    validate(scene);
    const Folder folder;
    const Scene back = write_and_read(folder, scene);
    ASSERT_EQ(back.meshes.size(), 3u);
    EXPECT_EQ(back.meshes[0].triangles.size() + back.meshes[1].triangles.size() + 1, mesh.triangles.size());
    EXPECT_EQ(back.meshes[2].positions.size(), 3u);
    for (uint i = 0; i < 3; ++i) {
        EXPECT_EQ(back.meshes[i].name, "ring");
        expect_same(scene, scene.materials[i], back, back.materials[back.meshes[i].material.value]);
    }
    expect_same_picture(scene, back, "split");
}

// What pbrt itself knows is said in its words alone: no parameter that it would stop at.
TEST(PbrtWrite, PlainScenesAreInPbrtsOwnWords)
{
    const Folder folder;
    const Scene scene = *make_builtin_scene("cornell");
    write_and_read(folder, scene);
    const std::string text = read_file(folder_path(folder) / "out.pbrt");
    EXPECT_NE(text.find("AreaLightSource \"diffuse\" \"rgb L\" [ 15 15 15 ]"), text.npos);
    EXPECT_NE(text.find("Scale -1 1 1\nLookAt"), text.npos);
    const std::set<std::string> known = {"integer maxdepth", "float fov", "string type", "rgb reflectance", "rgb L",
                                         "integer indices",  "point3 P",  "normal N",    "point2 uv"};
    std::size_t parameters = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.find("Attribute ") != line.npos) continue; // pbrt passes over what it does not know there
        for (std::size_t at = 0; (at = line.find('"', at)) != line.npos;) {
            const std::size_t end = line.find('"', at + 1);
            const std::string word = line.substr(at + 1, end - at - 1);
            at = end + 1;
            for (const char* type : {"integer ", "float ", "string ", "rgb ", "point3 ", "point2 ", "normal ", "bool "})
                if (word.starts_with(type)) {
                    EXPECT_EQ(known.count(word), 1u) << word;
                    ++parameters;
                }
        }
    }
    EXPECT_GT(parameters, 30u);
}

// ---- files ----

TEST(PbrtWrite, FilesOfOthersStay)
{
    const Folder folder;
    const Scene scene = *make_builtin_scene("cornell");
    const std::filesystem::path file = folder.write("mine.pbrt", "WorldBegin # by hand");
    const auto error = [&](const std::filesystem::path& to) -> std::string {
        try {
            write_pbrt(scene, to);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_NE(error(file).find("not one that snell convert has written"), std::string::npos);
    EXPECT_EQ(read_file(file), "WorldBegin # by hand");
    write_pbrt(scene, file, {.overwrite = true});
    EXPECT_EQ(error(file), ""); // now it is ours
    EXPECT_NE(error(file.parent_path() / "scene.txt").find(".pbrt"), std::string::npos);
    EXPECT_NE(error(file.parent_path() / "none" / "a.pbrt"), "");
    folder.write("b_meshes", "a file");
    EXPECT_NE(error(file.parent_path() / "b.pbrt").find("is no folder"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(file.parent_path() / "b.pbrt"));
    EXPECT_NE(error(file.parent_path() / "a\nb.pbrt").find("control character"), std::string::npos);
}

TEST(PbrtWrite, SaysWhatIsLost)
{
    Scene scene = *make_builtin_scene("cornell");
    scene.variants = {"a"};
    scene.animations.emplace_back();
    add(scene, MaterialDesc{});
    std::vector<Note> notes;
    const Folder folder;
    write_and_read(folder, scene, &notes);
    std::string all;
    for (const Note& n : notes) all += n.text + "\n";
    for (const char* word : {"moves", "variants", "materials that nothing uses: 1"})
        EXPECT_NE(all.find(word), std::string::npos) << word << " in " << all;
}

TEST(PlyWrite, EveryAttributeComesBack)
{
    Mesh mesh = make_torus("ring", 0.5f, 0.2f, 16, 8, {});
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const float x = static_cast<float>(i) / 7.0f;
        mesh.uvs_1.emplace_back(x, -x);
        mesh.tangents.emplace_back(x, 1.0f, 0.0f, i % 2 == 0 ? 1.0f : -1.0f);
        mesh.colors.emplace_back(0.1f * x, 0.2f, 0.3f, 0.4f + 0.01f * x);
    }
    const Folder folder;
    const std::filesystem::path file = folder_path(folder) / "ring.ply";
    write_ply(file, mesh);
    const Scene scene = load_ply(file);
    expect_same(mesh, scene.meshes.at(0));
    EXPECT_TRUE(scene.notes.empty());
    mesh.normals.clear(), mesh.uvs.clear(), mesh.uvs_1.clear(), mesh.tangents.clear(), mesh.colors.clear();
    write_ply(file, mesh);
    expect_same(mesh, load_ply(file).meshes.at(0));
}

} // namespace
} // namespace snell

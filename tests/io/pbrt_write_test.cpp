// Scenes that are written as pbrt files and read back: the same fields, and the same pictures, bit for bit.
#include "tests/io/gltf_files.h"

#include "snell/io/file.h"
#include "snell/io/pbrt/slots.h"
#include "snell/io/pbrt/write.h"
#include "snell/io/ply/ply.h"
#include "snell/io/ply/write.h"
#include "snell/render/render.h"
#include "snell/scene/builtin.h"
#include "snell/scene/shapes.h"

#include <png.h>

#include <cstring>
#include <set>
#include <sstream>

namespace snell {
namespace {

using namespace test;

// A field more than here stops the compiler: teach it to the writer, the reader and the comparisons below.
[[maybe_unused]] void know_every_field(const MaterialDesc& material, const PrincipledDesc& principled,
                                       const LightDesc& light, const CameraDesc& camera, const Mesh& mesh,
                                       const EnvironmentDesc& environment, const TextureRef& texture)
{
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17,
                                      f18, f19] = material;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15, f16, f17,
                                      f18, f19, f20, f21, f22, f23, f24, f25, f26, f27, f28, f29, f30, f31, f32, f33,
                                      f34] = principled;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7] = light;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6] = camera;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7, f8, f9] = mesh;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4] = environment;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7] = texture;
    }
}

// ---- comparing ----

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const Transform& a, const Transform& b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

void expect_same(const Mesh& a, const Mesh& b)
{
    if (!a.name.empty()) {
        EXPECT_EQ(a.name, b.name);
    }
    EXPECT_TRUE(same_bytes(a.positions, b.positions)) << a.name;
    EXPECT_TRUE(same_bytes(a.normals, b.normals)) << a.name;
    EXPECT_TRUE(same_bytes(a.tangents, b.tangents)) << a.name;
    EXPECT_TRUE(same_bytes(a.uvs, b.uvs)) << a.name;
    EXPECT_TRUE(same_bytes(a.uvs_1, b.uvs_1)) << a.name;
    EXPECT_TRUE(same_bytes(a.colors, b.colors)) << a.name;
    EXPECT_TRUE(same_bytes(a.triangles, b.triangles)) << a.name;
}

// Numbers of images differ; what is behind them must not.
void expect_same(const Scene& sa, const TextureRef& a, const Scene& sb, TextureRef b, const std::string& what)
{
    ASSERT_EQ(a.valid(), b.valid()) << what;
    if (!a.valid()) return;
    const Image &x = sa.images[a.image.value], &y = sb.images[b.image.value];
    EXPECT_EQ(x.width, y.width) << what;
    EXPECT_EQ(x.format, y.format) << what;
    EXPECT_TRUE(same_bytes(x.bytes, y.bytes)) << what;
    EXPECT_TRUE(same_bytes(x.floats, y.floats)) << what;
    b.image = a.image;
    EXPECT_EQ(a, b) << what;
}

void expect_same(const Scene& sa, const MaterialDesc& a, const Scene& sb, const MaterialDesc& b)
{
    const std::string& who = a.name;
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind) << who;
    EXPECT_EQ(a.base_color, b.base_color) << who;
    EXPECT_EQ(a.emission, b.emission) << who;
    EXPECT_EQ(a.two_sided_emission, b.two_sided_emission) << who;
    EXPECT_EQ(a.single_sided, b.single_sided) << who;
    EXPECT_EQ(a.alpha, b.alpha) << who;
    EXPECT_EQ(a.specular, b.specular) << who;
    EXPECT_EQ(a.ior, b.ior) << who;
    EXPECT_EQ(a.absorption, b.absorption) << who;
    EXPECT_EQ(a.texture_tints_specular, b.texture_tints_specular) << who;
    EXPECT_EQ(a.normal_scale, b.normal_scale) << who;
    EXPECT_EQ(a.coverage, b.coverage) << who;
    EXPECT_EQ(a.opacity, b.opacity) << who;
    EXPECT_EQ(a.cutoff, b.cutoff) << who;
    const auto texture = [&](const TextureRef& x, const TextureRef& y, std::string_view what) {
        expect_same(sa, x, sb, y, fmt::format("{}: {}", who, what));
    };
    texture(a.base_texture, b.base_texture, "base");
    texture(a.emission_texture, b.emission_texture, "emission");
    texture(a.normal_texture, b.normal_texture, "normal");
    texture(a.opacity_texture, b.opacity_texture, "opacity");
    EXPECT_EQ(a.principled.thin_walled, b.principled.thin_walled) << who;
    for (const pbrt::NumberSlot& slot : pbrt::number_slots) {
        EXPECT_EQ(a.principled.*slot.number, b.principled.*slot.number) << who << ": " << slot.name;
        if (slot.texture != nullptr) texture(a.principled.*slot.texture, b.principled.*slot.texture, slot.name);
    }
    for (const pbrt::ColorSlot& slot : pbrt::color_slots) {
        EXPECT_EQ(a.principled.*slot.color, b.principled.*slot.color) << who << ": " << slot.name;
        texture(a.principled.*slot.texture, b.principled.*slot.texture, slot.name);
    }
    for (const pbrt::MapSlot& slot : pbrt::map_slots)
        texture(a.principled.*slot.texture, b.principled.*slot.texture, slot.name);
}

// One mesh or sphere at one place, in the order of instances, groups and their lists.
struct Placed
{
    const InstanceDesc* instance = nullptr;
    const Mesh* mesh = nullptr;
    const SphereDesc* sphere = nullptr;
    Index<MaterialDesc> material;
};

std::vector<Placed> placed(const Scene& scene)
{
    std::vector<Placed> all;
    for (const InstanceDesc& instance : scene.instances) {
        const Group& group = scene.groups[instance.group.value];
        for (const Index<Mesh> m : group.meshes)
            all.push_back({&instance, &scene.meshes[m.value], nullptr, scene.meshes[m.value].material});
        for (const Index<SphereDesc> s : group.spheres)
            all.push_back({&instance, nullptr, &scene.spheres[s.value], scene.spheres[s.value].material});
    }
    return all;
}

// For scenes whose meshes have one material each.
void expect_same(const Scene& a, const Scene& b)
{
    const std::vector<Placed> pa = placed(a), pb = placed(b);
    ASSERT_EQ(pa.size(), pb.size());
    std::set<std::pair<uint, uint>> compared;
    for (std::size_t i = 0; i < pa.size(); ++i) {
        EXPECT_TRUE(same(pa[i].instance->transform, pb[i].instance->transform)) << i;
        if (!pa[i].instance->name.empty()) {
            EXPECT_EQ(pa[i].instance->name, pb[i].instance->name);
        }
        ASSERT_EQ(pa[i].mesh == nullptr, pb[i].mesh == nullptr);
        if (compared.emplace(pa[i].material.value, pb[i].material.value).second)
            expect_same(a, a.materials[pa[i].material.value], b, b.materials[pb[i].material.value]);
        if (pa[i].mesh != nullptr) {
            expect_same(*pa[i].mesh, *pb[i].mesh);
            continue;
        }
        const SphereDesc &sa = *pa[i].sphere, &sb = *pb[i].sphere;
        EXPECT_EQ(sa.center, sb.center) << i;
        EXPECT_EQ(sa.radius, sb.radius) << i;
        if (!sa.name.empty()) {
            EXPECT_EQ(sa.name, sb.name);
        }
    }
    std::set<uint> used_a, used_b;
    for (const auto& [x, y] : compared) used_a.insert(x), used_b.insert(y);
    EXPECT_EQ(used_a.size(), compared.size());
    EXPECT_EQ(used_b.size(), compared.size()) << "equal materials stay one";

    ASSERT_EQ(a.planes.size(), b.planes.size());
    for (std::size_t i = 0; i < a.planes.size(); ++i) {
        EXPECT_EQ(a.planes[i].name, b.planes[i].name);
        EXPECT_EQ(a.planes[i].point, b.planes[i].point);
        EXPECT_EQ(a.planes[i].normal, b.planes[i].normal);
        expect_same(a, a.materials[a.planes[i].material.value], b, b.materials[b.planes[i].material.value]);
    }
    ASSERT_EQ(a.lights.size(), b.lights.size());
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        const LightDesc &x = a.lights[i], &y = b.lights[i];
        EXPECT_EQ(x.name, y.name);
        EXPECT_EQ(x.kind, y.kind);
        EXPECT_EQ(x.emission, y.emission) << x.name;
        if (x.kind != light_directional) {
            EXPECT_EQ(x.position, y.position) << x.name;
        }
        if (x.kind != light_point) {
            EXPECT_EQ(x.direction, y.direction) << x.name;
        }
        if (x.kind == light_spot) {
            EXPECT_EQ(x.inner_degrees, y.inner_degrees) << x.name;
            EXPECT_EQ(x.outer_degrees, y.outer_degrees) << x.name;
        }
    }
    ASSERT_EQ(a.cameras.size(), b.cameras.size());
    for (std::size_t i = 0; i < a.cameras.size(); ++i) {
        const CameraDesc &x = a.cameras[i], &y = b.cameras[i];
        EXPECT_EQ(x.name, y.name);
        EXPECT_EQ(x.eye, y.eye);
        EXPECT_EQ(x.target, y.target);
        EXPECT_EQ(x.up, y.up);
        EXPECT_EQ(x.fov_degrees, y.fov_degrees);
        EXPECT_EQ(x.mirrored, y.mirrored);
    }
    EXPECT_EQ(a.environment.radiance, b.environment.radiance);
    EXPECT_EQ(a.environment.visible, b.environment.visible);
    ASSERT_EQ(a.environment.image.valid(), b.environment.image.valid());
    if (!a.environment.image.valid()) return;
    EXPECT_EQ(a.environment.mapping, b.environment.mapping);
    EXPECT_TRUE(same(a.environment.to_world, b.environment.to_world));
    EXPECT_EQ(a.images[a.environment.image.value].name, b.images[b.environment.image.value].name);
}

Film picture(Scene scene, int size = 32, uint spp = 4)
{
    complete(scene, 1.0f);
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.spp = spp;
    return render(*prepare(scene, settings), settings).film;
}

void expect_same_picture(const Scene& a, const Scene& b, const std::string& what)
{
    const Film x = picture(a), y = picture(b);
    EXPECT_TRUE(same_bytes(x.sum, y.sum)) << what;
    float sum = 0.0f;
    for (const vec3& v : x.sum) sum += v.x + v.y + v.z;
    EXPECT_GT(sum, 0.0f) << what << ": black pictures say nothing";
}

std::filesystem::path folder_path(const Folder& folder)
{
    return folder.write("here", "").parent_path();
}

// The file's scene.
Scene write_and_read(const Folder& folder, const Scene& scene, std::vector<Note>* notes = nullptr)
{
    const std::filesystem::path file = folder_path(folder) / "out.pbrt";
    const std::vector<Note> said = write_pbrt(scene, file);
    if (notes != nullptr) *notes = said;
    Scene back = load_scene(file);
    for (const Note& n : back.notes) EXPECT_EQ(n.kind, Note::Kind::info) << n.text;
    return back;
}

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
        else
            expect_same(scene, back);
        expect_same_picture(scene, back, name);
        // Once more: what was split stays so.
        const Folder again;
        expect_same(back, write_and_read(again, back));
    }
}

Image noise(const char* name, uint format, uint size, bool has_alpha)
{
    Image image;
    image.name = name;
    image.width = size, image.height = size + 1;
    image.format = format;
    uint state = size * 31u + format;
    for (std::size_t i = 0; i < std::size_t{4} * image.width * image.height; ++i) {
        state = state * 1664525u + 1013904223u;
        const uint byte = i % 4 == 3 && !has_alpha ? 255u : state >> 24;
        if (format == texels_rgba32f)
            image.floats.push_back(static_cast<float>(byte) / 255.0f * 0.999f);
        else
            image.bytes.push_back(static_cast<std::uint8_t>(byte));
    }
    return image;
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

// ---- files of others ----

TEST(PbrtWrite, AnObjOfSeveralMaterialsComesBack)
{
    const Folder folder;
    folder.write("m.mtl", "newmtl red\nKd .8 .1 .1\nnewmtl shiny\nKd .2 .2 .3\nKs .4 .4 .4\nNs 50\nillum 2\n"
                          "newmtl lamp\nKd 0 0 0\nKe 5 4 3\nnewmtl glass\nillum 7\nNi 1.4\nd 0.5\nKd .9 .9 .9\n");
    const std::filesystem::path file =
        folder.write("a.obj", "mtllib m.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\n"
                              "v -1 2 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 1 0\nusemtl red\nf 1/1/1 4/2/1 3/3/1 2/1/1\n"
                              "usemtl shiny\nf 1 2 6 5\nusemtl lamp\nf 5 6 7 8\nusemtl glass\nf 4/1 8/2 7/3\n");
    const Scene scene = load_scene(file);
    const Scene back = write_and_read(folder, scene);
    EXPECT_EQ(triangle_count(scene), triangle_count(back));
    for (const MaterialDesc& m : scene.materials) {
        const MaterialDesc* other = find_material(back, m.name);
        ASSERT_NE(other, nullptr) << m.name;
        expect_same(scene, m, back, *other);
    }
    expect_same_picture(scene, back, "obj");
}

// Every extension's numbers and textures, from a file.
TEST(PbrtWrite, AGltfOfEveryExtensionComesBack)
{
    const Folder folder;
    Image noisy = noise("", texels_rgba8_srgb, 4, true);
    png_image png = {};
    png.version = PNG_IMAGE_VERSION;
    png.width = noisy.width, png.height = noisy.height;
    png.format = PNG_FORMAT_RGBA;
    std::string bytes(65536, '\0');
    png_alloc_size_t size = bytes.size();
    ASSERT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, noisy.bytes.data(), 0, nullptr));
    folder.write("noise.png", bytes.substr(0, size));

    Gltf file;
    file.append("images", {{"uri", "noise.png"}});
    file.append("samplers", {{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}, {"minFilter", 9728}});
    file.append("textures", {{"source", 0}});
    file.append("textures", {{"source", 0}, {"sampler", 0}});
    const json plain = {{"index", 0}, {"texCoord", 1}};
    const json moved = {
        {"index", 1},
        {"extensions",
         {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.7}, {"scale", {1.5, 0.75}}}}}}};
    const auto normal = [&](double scale) {
        json map = plain;
        map["scale"] = scale;
        return map;
    };
    file.append("materials",
                {{"name", "all"},
                 {"pbrMetallicRoughness",
                  {{"baseColorFactor", {0.9, 0.8, 0.7, 0.6}},
                   {"baseColorTexture", moved},
                   {"metallicFactor", 0.4},
                   {"roughnessFactor", 0.7},
                   {"metallicRoughnessTexture", plain}}},
                 {"normalTexture", normal(0.5)},
                 {"emissiveFactor", {0.1, 0.2, 0.3}},
                 {"emissiveTexture", moved},
                 {"alphaMode", "BLEND"},
                 {"doubleSided", true},
                 {"extensions",
                  {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}},
                   {"KHR_materials_ior", {{"ior", 1.4}}},
                   {"KHR_materials_specular",
                    {{"specularFactor", 0.6},
                     {"specularTexture", plain},
                     {"specularColorFactor", {0.9, 0.5, 1.3}},
                     {"specularColorTexture", moved}}},
                   {"KHR_materials_clearcoat",
                    {{"clearcoatFactor", 0.5},
                     {"clearcoatTexture", plain},
                     {"clearcoatRoughnessFactor", 0.3},
                     {"clearcoatRoughnessTexture", moved},
                     {"clearcoatNormalTexture", normal(0.3)}}},
                   {"KHR_materials_sheen",
                    {{"sheenColorFactor", {0.3, 0.2, 0.1}},
                     {"sheenColorTexture", plain},
                     {"sheenRoughnessFactor", 0.4},
                     {"sheenRoughnessTexture", moved}}},
                   {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", plain}}},
                   {"KHR_materials_volume",
                    {{"thicknessFactor", 1}, {"attenuationDistance", 0.7}, {"attenuationColor", {0.3, 0.6, 0.9}}}},
                   {"KHR_materials_anisotropy",
                    {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 1.1}, {"anisotropyTexture", plain}}},
                   {"KHR_materials_iridescence",
                    {{"iridescenceFactor", 0.8},
                     {"iridescenceTexture", moved},
                     {"iridescenceIor", 1.7},
                     {"iridescenceThicknessMinimum", 150},
                     {"iridescenceThicknessMaximum", 650},
                     {"iridescenceThicknessTexture", plain}}},
                   {"KHR_materials_dispersion", {{"dispersion", 0.2}}},
                   {"KHR_materials_diffuse_transmission",
                    {{"diffuseTransmissionFactor", 0.2},
                     {"diffuseTransmissionTexture", moved},
                     {"diffuseTransmissionColorFactor", {0.9, 0.8, 0.4}},
                     {"diffuseTransmissionColorTexture", plain}}}}}});
    file.mesh({{"POSITION", file.accessor<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0.5}, "VEC3")},
               {"NORMAL", file.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f, 0, 0, 1}, "VEC3")},
               {"TANGENT", file.accessor<float>({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1, 0, 1, 0, 1}, "VEC4")},
               {"TEXCOORD_0", file.accessor<float>({0, 0, 2, 0, 2, 2, 0, 2}, "VEC2")},
               {"TEXCOORD_1", file.accessor<float>({0, 0, 0.5f, 0, 0.5f, 1, 0, 1}, "VEC2")},
               {"COLOR_0", file.accessor<float>({1, 1, 1, 1, 0.5f, 1, 1, 1, 1, 0.3f, 1, 0.5f, 1, 1, 1, 1}, "VEC4")}},
              {{"material", 0}, {"indices", file.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR")}});
    file.node({{"name", "sheet"}, {"mesh", 0}, {"rotation", {0.1, 0.2, 0.3, 0.927361849549570}}});
    const Scene scene = load_scene(folder.write("a.gltf", file.text()));
    EXPECT_EQ(notes_of(scene), "");
    // The file has set them all: none is as it was.
    const MaterialDesc& m = scene.materials.at(0);
    for (const pbrt::NumberSlot& slot : pbrt::number_slots) {
        EXPECT_NE(m.principled.*slot.number, PrincipledDesc{}.*slot.number) << slot.name;
        if (slot.texture != nullptr) {
            EXPECT_TRUE((m.principled.*slot.texture).valid()) << slot.name;
        }
    }
    const Scene back = write_and_read(folder, scene);
    expect_same(scene, back);
    expect_same_picture(scene, back, "gltf");
}

TEST(PbrtWrite, ScenesOfOthersComeBack)
{
    const std::filesystem::path shared = std::filesystem::path(SNELL_SOURCE_DIR) / "../shared/scenes";
    for (const char* name :
         {"gltf/DamagedHelmet/glTF-Binary/DamagedHelmet.glb",
          "gltf/AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb",
          "gltf/LightsPunctualLamp/glTF/LightsPunctualLamp.gltf", "gltf/SheenChair/glTF/SheenChair.gltf",
          "pbrt/bitterli-coffee/scene-v4.pbrt", "mesh/cornell_box_mcguire/CornellBox-Glossy.obj"}) {
        if (!std::filesystem::exists(shared / name)) {
            std::cout << "left out: no " << name << " in ../shared/scenes\n";
            continue;
        }
        SCOPED_TRACE(name);
        const Scene scene = load_scene(shared / name);
        const Folder folder;
        expect_same_picture(scene, write_and_read(folder, scene), name);
    }
}

} // namespace
} // namespace snell

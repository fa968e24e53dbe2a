// What the tests of the pbrt writer share: comparing scenes, field by field and by their pictures.
#pragma once

#include "tests/io/mesh_files.h"

#include "snell/io/pbrt/slots.h"
#include "snell/io/pbrt/write.h"
#include "snell/render/render.h"

#include <cstring>
#include <set>
#include <vector>

namespace snell::test {

// A field more than here stops the compiler: teach it to the writer, the reader and the comparisons below.
[[maybe_unused]] inline void know_every_field(const MaterialDesc& material, const PrincipledDesc& principled,
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
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7] = camera;
    }
    {
        [[maybe_unused]] const auto& [f0, f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12, f13, f14, f15] =
            camera.model;
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

inline bool same(const Transform& a, const Transform& b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

inline void expect_same(const Mesh& a, const Mesh& b)
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
inline void expect_same(const Scene& sa, const TextureRef& a, const Scene& sb, TextureRef b, const std::string& what)
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

inline void expect_same(const Scene& sa, const MaterialDesc& a, const Scene& sb, const MaterialDesc& b)
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

inline std::vector<Placed> placed(const Scene& scene)
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
inline void expect_same(const Scene& a, const Scene& b)
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
        CameraModel same_name = y.model;
        same_name.lens.name = x.model.lens.name; // it is that of the file now
        EXPECT_TRUE(x.model == same_name) << "camera " << i << " of kind " << x.model.kind;
    }
    EXPECT_EQ(a.environment.radiance, b.environment.radiance);
    EXPECT_EQ(a.environment.visible, b.environment.visible);
    ASSERT_EQ(a.environment.image.valid(), b.environment.image.valid());
    if (!a.environment.image.valid()) return;
    EXPECT_EQ(a.environment.mapping, b.environment.mapping);
    EXPECT_TRUE(same(a.environment.to_world, b.environment.to_world));
    EXPECT_EQ(a.images[a.environment.image.value].name, b.images[b.environment.image.value].name);
}

inline Film picture(Scene scene, int size = 32, uint spp = 4)
{
    complete(scene, 1.0f);
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.spp = spp;
    return render(*prepare(scene, settings), settings).film;
}

inline void expect_same_picture(const Scene& a, const Scene& b, const std::string& what)
{
    const Film x = picture(a), y = picture(b);
    EXPECT_TRUE(same_bytes(x.sum, y.sum)) << what;
    float sum = 0.0f;
    for (const vec3& v : x.sum) sum += v.x + v.y + v.z;
    EXPECT_GT(sum, 0.0f) << what << ": black pictures say nothing";
}

inline std::filesystem::path folder_path(const Folder& folder)
{
    return folder.write("here", "").parent_path();
}

// The file's scene.
inline Scene write_and_read(const Folder& folder, const Scene& scene, std::vector<Note>* notes = nullptr)
{
    const std::filesystem::path file = folder_path(folder) / "out.pbrt";
    const std::vector<Note> said = write_pbrt(scene, file);
    if (notes != nullptr) *notes = said;
    Scene back = load_scene(file);
    for (const Note& n : back.notes) EXPECT_EQ(n.kind, Note::Kind::info) << n.text;
    return back;
}

// Texels that differ, and are the same every time.
inline Image noise(const char* name, uint format, uint size, bool has_alpha)
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

} // namespace snell::test

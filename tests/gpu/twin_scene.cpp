#include "tests/gpu/twin_scene.h"

#include "snell/core/error.h"
#include "snell/kernel/albedo.h"
#include "snell/kernel/ray.h"
#include "snell/scene/albedo_tables.h"
#include "snell/scene/lens.h"

#include <cmath>
#include <random>

namespace snell::test {

GpuScene::GpuScene(const Gpu& gpu, const SceneWords& scene)
{
    for (const auto& words : scene.arrays) {
        arrays.push_back(gpu.make_buffer(words.size() * sizeof(std::uint32_t)));
        if (!words.empty()) std::memcpy(arrays.back()->data, words.data(), arrays.back()->bytes);
    }
    const SceneView addresses = scene.with_addresses([&](std::size_t i) { return arrays[i]->address; });
    view = gpu.make_buffer(sizeof(SceneView));
    std::memcpy(view->data, &addresses, sizeof(SceneView));
}

namespace {
class Draw
{
  public:
    float range(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    uint below(uint n) { return std::uniform_int_distribution<uint>(0u, n - 1u)(engine); }
    bool coin() { return below(2) == 1; }
    vec3 box(float low, float high)
    {
        const float x = range(low, high), y = range(low, high), z = range(low, high);
        return vec3(x, y, z);
    }
    vec3 direction()
    {
        for (;;) {
            const vec3 v = box(-1.0f, 1.0f);
            if (const float l = length(v); l > 0.1f && l < 1.0f) return v / l;
        }
    }

  private:
    std::mt19937 engine{7};
};

Instance make_instance(Draw& draw, uint number)
{
    const vec3 x = draw.direction();
    const vec3 y = normalize(cross(x, draw.direction()));
    const vec3 z = cross(x, y);
    const float s = draw.range(0.3f, 2.0f), t = number == 0 ? -s : s; // the first one mirrors
    const vec3 o = draw.box(-2.0f, 2.0f);
    Instance instance{};
    instance.to_world = {
        {s * x.x, t * y.x, s * z.x, o.x}, {s * x.y, t * y.y, s * z.y, o.y}, {s * x.z, t * y.z, s * z.z, o.z}};
    instance.to_object = {{x / s, -dot(x, o) / s}, {y / t, -dot(y, o) / t}, {z / s, -dot(z, o) / s}};
    instance.group = number;
    instance.light_base = number;
    instance.object = 100u + number;
    return instance;
}

Material make_material(Draw& draw, uint number)
{
    const auto slot = [&] { return draw.coin() ? draw.below(scene_slots) : none; };
    Material m{};
    m.kind = number % 4 == 3 ? material_principled : (number - number / 4) % material_principled;
    m.base_color = draw.box(0.0f, 1.0f);
    m.emission = number % 3 == 0 ? draw.box(0.0f, 8.0f) : vec3(0.0f);
    m.alpha = draw.coin() ? 0.0f : draw.range(0.02f, 1.0f);
    m.specular = m.kind == material_conductor ? draw.box(0.1f, 3.0f) : draw.box(0.0f, 0.5f);
    m.ior = draw.range(0.6f, 2.4f);
    m.absorption = m.kind == material_conductor ? draw.box(0.5f, 6.0f)
                   : draw.coin()                ? draw.box(0.0f, 1.5f)
                                                : vec3(0.0f);
    m.flags = draw.below(4) | (draw.below(4) == 0 ? material_single_sided : 0u);
    m.base_slot = slot();
    m.emission_slot = slot();
    m.normal_slot = slot();
    if (m.normal_slot != none || draw.below(4) == 0) m.flags |= material_needs_tangents;
    m.normal_scale = draw.range(-2.0f, 2.0f);
    m.coverage = draw.below(3);
    m.opacity = draw.range(0.3f, 1.0f);
    m.cutoff = draw.range(0.1f, 0.6f);
    m.opacity_slot = slot();
    m.principled = none;
    if (m.kind == material_principled) {
        m.principled = number / 4;
        m.ior = draw.range(1.1f, 2.4f);
        m.flags |= draw.coin() ? material_needs_tangents : 0u;
    }
    return m;
}

// Layers come and go with the bits of the number, so that each is met alone and with others.
Principled make_principled(Draw& draw, uint number)
{
    const auto slot = [&] { return draw.below(4) == 0 ? draw.below(scene_slots) : none; };
    const auto share = [&](uint bit) { return number >> bit & 1u ? draw.range(0.2f, 1.0f) : 0.0f; };
    Principled p{};
    p.metallic = draw.below(3) == 0 ? draw.range(0.0f, 1.0f) : 0.0f;
    p.roughness = number % 4 == 2 ? 0.0f : draw.range(0.2f, 1.0f);
    p.specular = draw.coin() ? 1.0f : draw.range(0.0f, 1.0f);
    p.specular_color = draw.box(0.0f, 1.0f);
    p.transmission = share(0);
    p.thin_walled = number >> 1 & 1u;
    p.glass_table = draw.coin() ? albedo_length : none;
    p.dispersion = p.thin_walled == 0u ? draw.range(0.0f, 3.0f) : 0.0f;
    p.clearcoat = share(2);
    p.clearcoat_roughness = draw.coin() ? 0.0f : draw.range(0.1f, 1.0f);
    p.clearcoat_normal_scale = draw.range(-2.0f, 2.0f);
    p.sheen_color = draw.coin() ? draw.box(0.0f, 1.0f) : vec3(0.0f);
    p.sheen_roughness = draw.range(0.1f, 1.0f);
    p.anisotropy = number % 3 == 0 ? draw.range(0.2f, 1.0f) : 0.0f;
    p.anisotropy_rotation = draw.range(-3.0f, 3.0f);
    p.iridescence = draw.below(3) == 0 ? draw.range(0.0f, 1.0f) : 0.0f;
    p.iridescence_ior = draw.range(1.0f, 2.0f);
    p.iridescence_thickness_min = draw.range(0.0f, 400.0f);
    p.iridescence_thickness_max = draw.range(100.0f, 800.0f);
    p.diffuse_transmission = draw.coin() ? draw.range(0.0f, 1.0f) : 0.0f;
    p.diffuse_transmission_color = draw.box(0.0f, 1.0f);
    for (uint* place : {&p.metallic_slot, &p.roughness_slot, &p.specular_slot, &p.specular_color_slot,
                        &p.clearcoat_slot, &p.clearcoat_roughness_slot, &p.sheen_color_slot, &p.sheen_roughness_slot,
                        &p.transmission_slot, &p.iridescence_slot, &p.iridescence_thickness_slot,
                        &p.diffuse_transmission_slot, &p.diffuse_transmission_color_slot})
        *place = slot();
    p.clearcoat_normal_slot = number % 3 == 0 ? none : draw.below(scene_slots);
    p.anisotropy_slot = draw.coin() ? draw.below(scene_slots) : none;
    return p;
}

TextureSlot make_slot(Draw& draw)
{
    TextureSlot slot{};
    slot.texture = draw.below(scene_textures);
    slot.uv_set = draw.below(2);
    slot.wrap_u = draw.below(3);
    slot.wrap_v = draw.below(3);
    slot.filter_mode = draw.below(4) == 0 ? filter_nearest : filter_bilinear;
    slot.channel = draw.below(4);
    slot.row_u = draw.coin() ? vec3(1.0f, 0.0f, 0.0f) : draw.box(-2.0f, 2.0f);
    slot.row_v = draw.coin() ? vec3(0.0f, 1.0f, 0.0f) : draw.box(-2.0f, 2.0f);
    return slot;
}

// Appends a cumulative distribution; one cell in four has no share in it.
void add_cdf(Draw& draw, std::vector<float>& cdf, uint count)
{
    std::vector<float> weights;
    float total = 0.0f, sum = 0.0f;
    for (uint i = 0; i < count; ++i) {
        weights.push_back(draw.below(4) == 0 ? 0.0f : draw.range(0.01f, 1.0f));
        total += weights.back();
    }
    cdf.push_back(0.0f);
    for (uint i = 0; i < count; ++i) cdf.push_back(i + 1 == count ? 1.0f : (sum += weights[i]) / total);
}

Light make_light(Draw& draw, uint number)
{
    // as the packing of scenes does: point, directional and spot lights first
    const uint kinds[] = {light_point, light_directional, light_spot, light_point, light_directional, light_spot};
    Light light{};
    light.kind = number < 6 ? kinds[number] : number < 14 ? light_triangle : light_sphere;
    light.position = draw.box(-2.0f, 2.0f);
    light.direction = draw.direction();
    light.emission = draw.box(0.1f, 10.0f);
    light.flags = light.kind < light_triangle ? 0u : draw.below(8); // two-sided, textured, mirrored
    light.primitive = none;
    light.instance = none;
    if (light.kind == light_spot) {
        light.cos_outer = draw.range(0.3f, 0.8f);
        light.cos_inner = draw.range(light.cos_outer + 0.05f, 1.0f);
    } else if (light.kind == light_triangle) {
        light.direction *= draw.range(0.1f, 2.0f);
        light.edge = draw.direction() * draw.range(0.1f, 2.0f);
        light.cos_outer = 0.5f * length(cross(light.direction, light.edge));
        light.normal = normalize(cross(light.direction, light.edge));
        light.primitive = pack_primitive(kind_triangle, number);
    } else if (light.kind == light_sphere) {
        light.cos_inner = draw.range(0.01f, 0.8f);
        light.primitive = pack_primitive(kind_sphere, number - 14u);
        if (draw.coin()) light.instance = draw.below(scene_instances);
    }
    light.select_pdf = draw.range(0.01f, 0.1f);
    light.alias_threshold = draw.range(0.0f, 1.0f);
    light.alias = draw.below(scene_lights);
    return light;
}

std::uint32_t word_of(float x)
{
    return floatBitsToUint(x);
}
} // namespace

SceneWords random_scene()
{
    Draw draw;
    SceneWords scene;

    std::vector<vec3> positions, normals;
    std::vector<vec4> tangents, colors;
    std::vector<vec2> uvs;
    std::vector<Triangle> triangles;
    std::vector<Surface> surfaces;
    const uint per_surface = scene_triangles / scene_surfaces;
    uint primitives = 0;
    const auto next_material = [&] { return 5 * primitives++ % scene_materials; }; // of four in a row one is principled
    for (uint k = 0; k < scene_surfaces; ++k) { // each a mesh of its own; which attributes it has are the bits of k
        Surface s{};
        s.material = next_material();
        s.object = k;
        s.first_vertex = static_cast<uint>(positions.size());
        s.normal_base = k & 1u ? static_cast<uint>(normals.size()) : none;
        s.uv_base = k & 2u ? static_cast<uint>(uvs.size()) : none;
        s.color_base = k & 4u ? static_cast<uint>(colors.size()) : none;
        s.tangent_base = k & 8u ? static_cast<uint>(tangents.size()) : none;
        s.first_triangle = static_cast<uint>(triangles.size());
        s.first_light = k % 3 == 0 ? 6u : none;
        for (uint v = 0; v < scene_vertices; ++v) {
            positions.push_back(draw.box(-2.0f, 2.0f));
            if (k & 1u) normals.push_back(draw.direction());
            if (k & 2u) uvs.emplace_back(draw.range(-3.0f, 3.0f), draw.range(-3.0f, 3.0f));
            if (k & 4u) colors.emplace_back(draw.box(0.0f, 1.0f), draw.range(0.0f, 1.0f));
            if (k & 8u) tangents.emplace_back(draw.direction(), draw.coin() ? 1.0f : -1.0f);
        }
        s.uv_1_base = k % 3 == 2 ? static_cast<uint>(uvs.size()) : none;
        for (uint v = 0; v < scene_vertices && k % 3 == 2; ++v)
            uvs.emplace_back(draw.range(-3.0f, 3.0f), draw.range(-3.0f, 3.0f));
        for (uint t = 0; t < per_surface; ++t) {
            const uint first = s.first_vertex + draw.below(16);
            triangles.push_back({first, first + 1 + draw.below(15), first + 16 + draw.below(16), k});
        }
        surfaces.push_back(s);
    }
    SNELL_CHECK_EQ(colors.size(), std::size_t{scene_lens_first});
    const FocusedLens lens = focus_lens(*find_lens("double-gauss"), 2000.0, 43.2);
    SNELL_CHECK_EQ(lens.table.size(), std::size_t{scene_lens_interfaces + scene_lens_pupils});
    colors.insert(colors.end(), lens.table.begin(), lens.table.end());
    colors.emplace_back(lens.system.rear_z, lens.system.entrance_z, lens.system.gain, lens.system.film_radius);
    scene.set(&SceneView::positions, positions);
    scene.set(&SceneView::normals, normals);
    scene.set(&SceneView::uvs, uvs);
    scene.set(&SceneView::colors, colors);
    scene.set(&SceneView::tangents, tangents);
    scene.set(&SceneView::triangles, triangles);
    scene.set(&SceneView::surfaces, surfaces);

    std::vector<Sphere> spheres;
    for (uint i = 0; i < scene_spheres; ++i)
        spheres.push_back(
            {draw.box(-1.0f, 1.0f), draw.range(0.05f, 0.8f), next_material(), 200 + i, i % 2 ? 14u + i % 2 : none, 0});
    scene.set(&SceneView::spheres, spheres);
    std::vector<Plane> planes;
    for (uint i = 0; i < scene_planes; ++i)
        planes.push_back({draw.direction(), draw.range(-1.0f, 1.0f), next_material(), 300 + i, 0, 0});
    scene.set(&SceneView::planes, planes);
    std::vector<Instance> instances;
    for (uint i = 0; i < scene_instances; ++i) instances.push_back(make_instance(draw, i));
    scene.set(&SceneView::instances, instances);
    std::vector<Material> materials;
    for (uint i = 0; i < scene_materials; ++i) materials.push_back(make_material(draw, i));
    scene.set(&SceneView::materials, materials);
    std::vector<Principled> principled;
    for (uint i = 0; i < scene_principled; ++i) principled.push_back(make_principled(draw, i));
    scene.set(&SceneView::principled, principled);
    std::vector<TextureSlot> slots;
    for (uint i = 0; i < scene_slots; ++i) slots.push_back(make_slot(draw));
    scene.set(&SceneView::slots, slots);
    std::vector<Light> lights;
    for (uint i = 0; i < scene_lights; ++i) lights.push_back(make_light(draw, i));
    scene.set(&SceneView::lights, lights);

    std::vector<Texture> textures;
    std::vector<std::uint32_t> texels;
    const uint sizes[][2] = {{1, 1}, {3, 5}, {8, 4}, {17, 16}};
    for (uint i = 0; i < scene_textures; ++i) {
        Texture texture{};
        texture.offset = static_cast<uint>(texels.size());
        texture.width = sizes[i % 4][0];
        texture.height = sizes[i % 4][1];
        texture.format = i % 3;
        const uint channels = texture.format == texels_rgba32f ? 4 : 1;
        for (uint t = 0; t < channels * texture.width * texture.height; ++t)
            texels.push_back(channels == 4 ? word_of(draw.range(0.0f, 2.0f)) : draw.below(~0u));
        textures.push_back(texture);
    }
    scene.set(&SceneView::textures, textures);
    scene.set(&SceneView::texels, texels);
    std::vector<float> srgb;
    for (int i = 0; i < 256; ++i) {
        const double c = i / 255.0;
        srgb.push_back(static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4)));
    }
    scene.set(&SceneView::srgb, srgb);
    const float glass_iors[] = {1.5f};
    scene.set(&SceneView::albedo, albedo_tables(glass_iors, true).values);

    scene.tail.light_count = scene_lights;
    scene.tail.delta_light_count = 6;
    scene.tail.plane_count = scene_planes;
    scene.tail.coverage = scene_has_holes | scene_has_single_sided;
    Environment& e = scene.tail.environment;
    e.radiance = vec3(0.25f, 0.5f, 0.75f);
    e.texture = 2;
    const Instance turned = make_instance(draw, 1);
    const auto unit_row = [](vec4 row) { return normalize(vec3(row)); }; // of a rotation times a scale
    e.row_x = unit_row(turned.to_object.x), e.row_y = unit_row(turned.to_object.y),
    e.row_z = unit_row(turned.to_object.z);
    e.mapping = environment_equirectangular;
    e.is_visible = 1;
    e.columns = scene_columns;
    e.rows = scene_rows;
    e.select_pdf = 0.5f;
    std::vector<float> cdf;
    add_cdf(draw, cdf, scene_rows);
    for (uint row = 0; row < scene_rows; ++row) add_cdf(draw, cdf, scene_columns);
    scene.set(&SceneView::environment_cdf, cdf);
    scene.tail.scene_radius = 4.0f;
    scene.tail.scene_center = vec3(0.1f, -0.2f, 0.3f);
    return scene;
}

std::uint32_t pattern_word(std::size_t i)
{
    return word_of(static_cast<float>(i % (1u << 22) + 1));
}

SceneWords pattern_scene()
{
    SceneWords scene;
    constexpr std::size_t words = 4096;
    std::size_t next = 0;
    for (auto& array : scene.arrays)
        for (std::size_t i = 0; i < words; ++i) array.push_back(pattern_word(next++));
    std::uint32_t tail[sizeof(SceneView) / sizeof(std::uint32_t)];
    for (std::uint32_t& word : tail) word = pattern_word(next++);
    std::memcpy(&scene.tail, tail, sizeof(tail)); // the addresses in it are replaced by with_addresses()
    return scene;
}

} // namespace snell::test

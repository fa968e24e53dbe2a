#include "snell/core/error.h"
#include "snell/kernel/ray.h"
#include "snell/scene/builtin.h"
#include "snell/scene/lights.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace snell {
namespace {

constexpr double pi_d = 3.14159265358979323846;

MaterialDesc glow(vec3 radiance, bool two_sided = false)
{
    MaterialDesc m;
    m.emission = radiance;
    m.two_sided_emission = two_sided;
    return m;
}

void expect_near(vec3 a, vec3 b, float tolerance)
{
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

// What the table really draws by.
std::vector<double> drawn(const std::vector<Light>& lights)
{
    std::vector<double> p(lights.size(), 0.0);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double kept = static_cast<double>(lights[i].alias_threshold);
        p[i] += kept;
        p.at(lights[i].alias) += 1.0 - kept;
    }
    for (double& x : p) x /= static_cast<double>(lights.size());
    return p;
}

void expect_sound_table(const std::vector<Light>& lights)
{
    if (lights.empty()) return;
    double sum = 0.0;
    const std::vector<double> p = drawn(lights);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        ASSERT_GE(lights[i].alias_threshold, 0.0f);
        ASSERT_LE(lights[i].alias_threshold, 1.0f);
        ASSERT_EQ(lights[i].select_pdf, static_cast<float>(p[i])) << "light " << i;
        sum += static_cast<double>(lights[i].select_pdf);
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
}

// Every light, made again from the primitive it names; and every emissive primitive finds its light.
void expect_wired(const PackedScene& packed)
{
    std::size_t area_lights = 0;
    const auto visit = [&](const PackedGroup& group, const Instance* instance, uint instance_index) {
        const auto world = [&](vec3 p) { return instance != nullptr ? transform_point(instance->to_world, p) : p; };
        const uint base = instance != nullptr ? instance->light_base : 0u;
        for (uint t = group.first_triangle; t < group.first_triangle + group.triangle_count; ++t) {
            const Triangle triangle = packed.triangles[t];
            const Surface& surface = packed.surfaces[triangle.surface];
            const Material& material = packed.materials[surface.material];
            ASSERT_EQ(surface.first_light == none, is_black(material.emission));
            if (surface.first_light == none) continue;
            ++area_lights;
            const Light& light = packed.lights.at(base + surface.first_light + t - surface.first_triangle);
            ASSERT_EQ(light.kind, light_triangle);
            EXPECT_EQ(light.primitive, pack_primitive(kind_triangle, t));
            EXPECT_EQ(light.instance, instance_index);
            EXPECT_EQ(light.emission, material.emission);
            const vec3 a = packed.positions[triangle.v0], b = packed.positions[triangle.v1],
                       c = packed.positions[triangle.v2];
            EXPECT_EQ(light.position, world(a));
            expect_near(light.direction + light.edge, world(b) + world(c) - 2.0f * world(a), 1e-5f);
            const vec3 normal = cross(light.direction, light.edge);
            EXPECT_NEAR(light.cos_outer, 0.5f * length(normal), 1e-5f * length(normal));
            // The light's front is the primitive's.
            vec3 front = cross(b - a, c - a);
            if (instance != nullptr) front = transform_normal(instance->to_object, front);
            EXPECT_NEAR(dot(normalize(front), normalize(normal)), 1.0f, 1e-4f);
        }
        for (uint s = group.first_sphere; s < group.first_sphere + group.sphere_count; ++s) {
            const Sphere& sphere = packed.spheres[s];
            const Material& material = packed.materials[sphere.material];
            ASSERT_EQ(sphere.light == none, is_black(material.emission));
            if (sphere.light == none) continue;
            ++area_lights;
            const Light& light = packed.lights.at(base + sphere.light);
            ASSERT_EQ(light.kind, light_sphere);
            EXPECT_EQ(light.primitive, pack_primitive(kind_sphere, s));
            EXPECT_EQ(light.instance, instance_index);
            expect_near(light.position, world(sphere.center), 1e-5f);
            const vec3 rim = world(sphere.center + vec3(0, sphere.radius, 0));
            EXPECT_NEAR(light.cos_inner, length(rim - light.position), 1e-4f * light.cos_inner);
        }
    };
    visit(packed.world, nullptr, none);
    for (uint i = 0; i < packed.instances.size(); ++i)
        visit(packed.groups[packed.instances[i].group], &packed.instances[i], i);
    const auto delta = std::count_if(packed.lights.begin(), packed.lights.end(),
                                     [](const Light& light) { return light.primitive == none; });
    EXPECT_EQ(area_lights + static_cast<std::size_t>(delta), packed.lights.size());
}

TEST(AliasTable, DrawsByPower)
{
    std::mt19937 engine(11);
    std::uniform_real_distribution<double> number(0.0, 1.0);
    for (const std::size_t count : {1u, 2u, 3u, 10u, 1000u, 100'000u}) {
        std::vector<Light> lights(count);
        std::vector<double> powers(count);
        double total = 0.0;
        for (double& power : powers) {
            power = number(engine) < 0.2 ? 0.0 : std::exp(8.0 * number(engine));
            total += power;
        }
        powers[0] += 1.0;
        total += 1.0;
        build_alias_table(lights, powers);
        expect_sound_table(lights);
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(lights[i].select_pdf > 0.0f, powers[i] > 0.0);
            EXPECT_NEAR(static_cast<double>(lights[i].select_pdf), powers[i] / total, 2e-7);
        }
    }
}

TEST(AliasTable, WithoutPowerAllAreAlike)
{
    std::vector<Light> lights(3);
    build_alias_table(lights, std::vector<double>(3, 0.0));
    for (const Light& light : lights) EXPECT_NEAR(light.select_pdf, 1.0f / 3.0f, 1e-7f);
    build_alias_table({}, {});
}

TEST(AliasTable, NeverDrawsADarkLight)
{
    // The first light is the last to find a partner; by then rounding may have used the others up.
    std::mt19937 engine(12);
    std::uniform_real_distribution<double> number(0.1, 1.0);
    for (std::size_t count = 2; count < 200; ++count) {
        std::vector<Light> lights(count);
        std::vector<double> powers(count);
        for (double& power : powers) power = number(engine);
        powers[0] = 0.0;
        build_alias_table(lights, powers);
        expect_sound_table(lights);
        EXPECT_EQ(lights[0].select_pdf, 0.0f) << count;
    }
}

TEST(Lights, PowersFollowTheTextbook)
{
    LightDesc desc;
    desc.emission = vec3(2.0f); // of luminance 2
    EXPECT_NEAR(light_power(make_light(desc), 3.0), 4.0 * pi_d * 2.0, 1e-5);
    desc.kind = light_directional;
    EXPECT_NEAR(light_power(make_light(desc), 3.0), pi_d * 9.0 * 2.0, 1e-5);
    desc.kind = light_spot;
    desc.inner_degrees = 59.999f;
    desc.outer_degrees = 60.0f;
    EXPECT_NEAR(light_power(make_light(desc), 3.0), 2.0 * pi_d * 0.5 * 2.0, 1e-3);

    Material material = {};
    material.emission = vec3(2.0f);
    Light quad = make_triangle_light({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, material, 0, none);
    EXPECT_NEAR(light_power(quad, 9.0), pi_d * 3.0 * 2.0, 1e-5);
    quad.flags = light_two_sided;
    EXPECT_NEAR(light_power(quad, 9.0), 2.0 * pi_d * 3.0 * 2.0, 1e-5);
    const Light ball = make_sphere_light(vec3(0.0f), 0.5f, material, 0, none);
    EXPECT_NEAR(light_power(ball, 9.0), pi_d * (pi_d * 4.0 * 0.25) * 2.0, 1e-5);
}

TEST(Lights, DeltaLights)
{
    LightDesc desc;
    desc.kind = light_spot;
    desc.position = {1, 2, 3};
    desc.direction = {0, 0, -7};
    desc.inner_degrees = 0.0f;
    desc.outer_degrees = 90.0f;
    Light light = make_light(desc);
    EXPECT_EQ(light.position, desc.position);
    EXPECT_EQ(light.direction, vec3(0, 0, -1));
    EXPECT_EQ(light.cos_inner, 1.0f);
    EXPECT_NEAR(light.cos_outer, 0.0f, 1e-7f);
    EXPECT_EQ(light.primitive, none);
    EXPECT_EQ(light.instance, none);
    desc.inner_degrees = desc.outer_degrees = 30.0f;
    light = make_light(desc);
    EXPECT_GT(light.cos_inner, light.cos_outer); // the fall-off divides by the difference
}

TEST(Lights, AreWiredToTheirPrimitives)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    const auto one = add(scene, glow({1, 2, 3}));
    const auto two = add(scene, glow({5, 5, 5}, true));
    add(scene, LightDesc{});
    add(scene, LightDesc{});
    // In the world: a mesh whose triangles are dark and bright in turn, and two spheres.
    Mesh torus = make_torus("torus", 1.0f, 0.3f, 12, 8, grey);
    for (std::size_t i = 0; i < torus.triangles.size(); ++i)
        torus.triangle_materials.push_back(i % 3 == 0 ? grey : i % 3 == 1 ? one : two);
    const Transform mirrored = compose(rotation({1, 2, 0}, 50.0f), scaling({-1, 2, 3}));
    place(scene, torus, mirrored);
    place(scene, SphereDesc{"", {9, 0, 0}, 1.0f, one});
    place(scene, SphereDesc{"", {9, 0, 9}, 1.0f, grey});
    // By instances: emissive and dark spheres and meshes, and one that mirrors.
    Group group;
    group.meshes = {add(scene, torus), add(scene, make_box("box", vec3(0), vec3(1), grey)),
                    add(scene, make_box("box", vec3(0), vec3(1), two))};
    group.spheres = {add(scene, SphereDesc{"", {0, 1, 0}, 0.5f, grey}),
                     add(scene, SphereDesc{"", {1, 1, 0}, 0.5f, two})};
    const auto often = add(scene, group);
    add(scene, InstanceDesc{"", often, translation({10, 0, 0})});
    add(scene, InstanceDesc{"", often, compose(rotation({1, 2, 0}, 50.0f), scaling({-2, 2, 2}))});
    const auto dark = add(scene, Group{"", {group.meshes[1]}, {}});
    add(scene, InstanceDesc{"", dark, translation({0, 4, 0})});
    add(scene, InstanceDesc{"", dark, translation({0, 6, 0})});
    add(scene, InstanceDesc{"", often, translation({0, 9, 0})});
    validate(scene);
    const PackedScene packed = pack(scene);

    EXPECT_EQ(packed.instances.size(), 5u);
    EXPECT_EQ(packed.lights.size(), 2u + 128u + 1u + 3u * (128u + 12u + 1u));
    expect_wired(packed);
    expect_sound_table(packed.lights);
    // Half of the choices go by power, half to all lights alike.
    const Light& a = packed.lights[packed.instances[0].light_base];
    const double expected = light_power(a, static_cast<double>(packed.radius));
    double total = 0.0;
    for (const Light& light : packed.lights) total += light_power(light, static_cast<double>(packed.radius));
    const double alike = 1.0 / static_cast<double>(packed.lights.size());
    EXPECT_NEAR(static_cast<double>(a.select_pdf), 0.5 * expected / total + 0.5 * alike, 1e-6);
}

TEST(Lights, AnEmissiveEllipsoidIsRefused)
{
    Scene scene;
    const auto lamp = add(scene, glow(vec3(1.0f)));
    const auto group = add(scene, Group{"", {}, {add(scene, SphereDesc{"bulb", vec3(0.0f), 1.0f, lamp})}});
    add(scene, InstanceDesc{"stretched", group, scaling({1, 2, 1})});
    validate(scene);
    try {
        pack(scene);
        FAIL() << "an emissive ellipsoid was packed";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("'bulb'"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("'stretched'"), std::string::npos) << error.what();
    }
    scene.instances[0].transform = scaling(vec3(2.0f));
    EXPECT_NEAR(pack(scene).lights.at(0).cos_inner, 2.0f, 1e-6f);
}

TEST(Lights, OfTheBuiltInScenesAreSound)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        Scene scene = builtin.make();
        validate(scene);
        const PackedScene packed = pack(scene);
        expect_wired(packed);
        expect_sound_table(packed.lights);
    }
}

} // namespace
} // namespace snell

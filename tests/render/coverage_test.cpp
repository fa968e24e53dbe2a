// Surfaces with holes: what goes through is what should, in camera rays, shadow rays and everywhere else, whatever the
// order of work.
#include "snell/render/integrator.h"
#include "tests/analytic/probe.h"
#include "tests/render/scenes.h"

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

Index<MaterialDesc> half_there(Scene& scene, float opacity, uint coverage = coverage_blend)
{
    MaterialDesc m;
    m.base_color = vec3(0.0f);
    m.coverage = coverage;
    m.opacity = opacity;
    return add(scene, m);
}

// A black sheet of 20 x 20 at a height, larger than all that matters.
void add_sheet(Scene& scene, float height, Index<MaterialDesc> material)
{
    place(scene, polygon({{-10, height, -10}, {-10, height, 10}, {10, height, 10}, {10, height, -10}}, material));
}

TEST(Coverage, AHalfTransparentSheetHalvesTheLight)
{
    // point light (shadow rays), environment (BSDF sampling), and both for the camera's look through it
    for (const float opacity : {0.5f, 0.25f}) {
        Scene scene;
        add_plane(scene, vec3(0.0f), vec3(0, 1, 0), diffuse(scene, 0.5f));
        add_sheet(scene, 1.0f, half_there(scene, opacity));
        Scene by_point = scene, by_sky = scene;
        add_point_light(by_point, vec3(0, 2, 0), 4.0f);
        by_sky.environment.radiance = vec3(1.0f);
        const double through = 1 - double{opacity};
        const double point = 0.5 / pi_d * 4 / 4 * through, sky = 0.5 * through;
        for (Scene* s : {&by_point, &by_sky}) {
            for (const float eye : {0.5f, 3.0f}) { // below the sheet and above it
                look(*s, vec3(0, eye, 0.3f), vec3(0.0f));
                const double seen = (s == &by_point ? point : sky) * (eye > 1 ? through : 1);
                SCOPED_TRACE(fmt::format("opacity {}, eye {}, {}", opacity, eye, s == &by_sky ? "sky" : "point"));
                for (const Technique& t : techniques())
                    if (s == &by_sky || t.name != "BSDF sampling") // which finds no point
                        expect_value(measure(*s, probe_settings("path", t.parameters, 512)), seen, 0.02);
                expect_value(measure(*s, probe_settings("whitted", {}, 512)), seen, 0.02);
            }
        }
    }
}

// From behind, the camera looks through a single-sided sheet; light does not.
TEST(Coverage, SingleSidedSheetsAreSeenFromTheFrontOnly)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0, 1, 0), diffuse(scene, 0.5f));
    MaterialDesc white;
    white.base_color = vec3(1.0f);
    white.single_sided = true;
    add_sheet(scene, 1.0f, add(scene, white)); // its front is up
    add_point_light(scene, vec3(0, 2, 0), 4.0f);
    look(scene, vec3(0, 0.5f, 0.3f), vec3(0.0f, 0.9f, 0.0f)); // up from below: past the sheet, at nothing
    expect_value(measure(scene, probe_settings("path", {}, 16)), 0.0, 1e-6);
    expect_value(measure(scene, probe_settings("albedo", {}, 16)), 0.0, 1e-6);
    look(scene, vec3(0, 0.5f, 0.3f), vec3(0.0f)); // at the floor: in the sheet's shadow but for light from far around
    EXPECT_LT(measure(scene, probe_settings("path", {}, 16)).mean, 1e-5);
    look(scene, vec3(0, 3.0f, 0.3f), vec3(0.0f, 1.0f, 0.0f)); // at the front
    expect_value(measure(scene, probe_settings("albedo", {}, 16)), 1.0, 1e-6);
}

TEST(Coverage, TwentyLayers)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    const auto sheer = half_there(scene, 0.1f);
    for (int i = 0; i < 20; ++i) add_sheet(scene, static_cast<float>(i), sheer);
    look(scene, vec3(0, 30, 1), vec3(0.0f));
    expect_value(measure(scene, probe_settings("path", {}, 512)), std::pow(0.9, 20), 0.02);
    scene.materials[0].opacity = 0.5f;
    RenderSettings settings = probe_settings("path", {}, 512);
    const Measurement m = measure(scene, settings);
    EXPECT_LT(m.mean, 1e-3); // 1e-6
    scene.materials[0].opacity = 0.0f;
    expect_value(measure(scene, probe_settings("path", {}, 4)), 1.0);
}

TEST(Coverage, ASphereHasTwoSides)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    add_sphere(scene, vec3(0.0f), 1.0f, half_there(scene, 0.5f));
    look(scene, vec3(0, 0, 5), vec3(0.0f));
    expect_value(measure(scene, probe_settings("path", {}, 512)), 0.25, 0.02);
}

TEST(Coverage, MasksAreAllOrNothing)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    MaterialDesc m;
    m.base_color = vec3(0.0f);
    m.coverage = coverage_mask;
    Image alpha;
    alpha.width = 2, alpha.height = 1;
    alpha.format = texels_rgba8_linear;
    alpha.bytes = {255, 255, 255, 120, 255, 255, 255, 136}; // below and above the cutoff
    m.opacity_texture.image = add(scene, alpha);
    m.opacity_texture.channel = 3;
    m.opacity_texture.filter = filter_nearest;
    Mesh sheet = polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, add(scene, m));
    sheet.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    place(scene, sheet);
    const auto seen_at = [&](float x) {
        look(scene, vec3(x, 0.1f, 3), vec3(x, 0.1f, 0));
        const Film film = render_film(scene, probe_settings("path", {}, 4));
        return film.sum[0].x / static_cast<float>(film.sample_count[0]);
    };
    EXPECT_EQ(seen_at(-0.5f), 1.0f);
    EXPECT_EQ(seen_at(0.5f), 0.0f);
    scene.materials[0].cutoff = 0.4f; // 0.47 is not below
    EXPECT_EQ(seen_at(-0.5f), 0.0f);
    // the vertex colours' fourth number counts as well
    scene.meshes[0].colors.assign(4, vec4(1.0f, 1.0f, 1.0f, 0.8f));
    EXPECT_EQ(seen_at(-0.5f), 1.0f);
    EXPECT_EQ(seen_at(0.5f), 0.0f);
}

// Leaves of a mask and of a blend over mixed_scene(), with a hole-punched lamp.
Scene leafy_scene()
{
    Scene scene = mixed_scene();
    Image leaf;
    leaf.width = leaf.height = 4;
    for (uint i = 0; i < 16; ++i)
        for (const uint byte : {40u, 160u, 60u, i * 16u}) leaf.bytes.push_back(static_cast<std::uint8_t>(byte));
    const auto image = add(scene, leaf);
    for (const uint coverage : {coverage_mask, coverage_blend}) {
        MaterialDesc m;
        m.base_texture.image = image;
        m.coverage = coverage;
        m.opacity_texture.image = image;
        m.opacity_texture.channel = 3;
        const auto material = add(scene, m);
        const float z = coverage == coverage_mask ? 1.5f : 2.0f;
        Mesh mesh = polygon({{-3, -1, z}, {3, -1, z}, {3, 2, z}, {-3, 2, z}}, material);
        mesh.uvs = {{0, 0}, {3, 0}, {3, 2}, {0, 2}};
        place(scene, mesh);
    }
    scene.materials[scene.meshes[1].material.value].coverage = coverage_blend; // the instanced lamp
    scene.materials[scene.meshes[1].material.value].opacity = 0.7f;
    validate(scene);
    return scene;
}

TEST(Coverage, DoesNotDependOnTheOrderOfWork)
{
    const Scene scene = leafy_scene();
    for (const char* integrator : {"path", "whitted", "ao", "albedo"}) {
        SCOPED_TRACE(integrator);
        RenderSettings settings = small_picture(integrator);
        settings.threads = 1;
        const Film plain = render(scene, settings).film;
        settings.threads = 3;
        settings.tile_size = 5;
        expect_same_film(render(scene, settings).film, plain);
        settings.accel = "brute";
        Film brute = render(scene, settings).film;
        brute.layers.steps = plain.layers.steps; // the one thing that accelerators differ in
        expect_same_film(brute, plain);
    }
}

TEST(Coverage, WhatAlwaysCoversChangesNothing)
{
    Scene scene = mixed_scene();
    const RenderSettings settings = small_picture("path");
    const Film plain = render(scene, settings).film;
    for (MaterialDesc& m : scene.materials) m.coverage = coverage_blend; // opacity 1
    Film covered = render(scene, settings).film;
    // light sampling takes emissive surfaces with coverage for textured ones, which changes no value here
    EXPECT_TRUE(same_bits(covered.sum, plain.sum));
}

TEST(Coverage, RaysOfCustomIntegratorsPassToo)
{
    Scene scene;
    add_sheet(scene, 1.0f, half_there(scene, 0.5f));
    look(scene, vec3(0, 2, 1), vec3(0.0f));
    validate(scene);
    const auto prepared = prepare(scene, RenderSettings());
    const SceneView view = prepared->packed.view();
    const RayScene rays(view, *prepared->accel);
    int hits = 0, blocked = 0;
    constexpr int count = 4000;
    for (int i = 0; i < count; ++i) {
        const float x = 1e-3f * static_cast<float>(i);
        const Ray ray = make_ray(vec3(x, 2.0f, 0.1f), vec3(0, -1, 0), infinity());
        hits += is_hit(rays.intersect(ray));
        blocked += rays.occluded(ray);
    }
    EXPECT_NEAR(hits, count / 2, 4 * std::sqrt(count / 4.0));
    EXPECT_EQ(hits, blocked); // the same ray finds the same surface
}

} // namespace
} // namespace snell::test

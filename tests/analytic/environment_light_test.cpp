// Light from environments made of pictures, and from lamps with textures and holes: every technique gives the same
// known answer.
#include "tests/analytic/probe.h"

#include "snell/kernel/environment.h"
#include "snell/scene/packed.h"

#include <functional>

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

// value(x, y) of each texel.
Image picture_of(uint width, uint height, const std::function<float(uint, uint)>& value)
{
    Image image;
    image.width = width, image.height = height;
    image.format = texels_rgba32f;
    for (uint y = 0; y < height; ++y)
        for (uint x = 0; x < width; ++x) {
            const float v = value(x, y);
            image.floats.insert(image.floats.end(), {v, v, v, 1.0f});
        }
    return image;
}

// A plane under a picture of the sky, seen from above.
Scene floor_under(const Image& sky, uint mapping, const Transform& to_world)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0, 1, 0), diffuse(scene, 0.5f));
    scene.environment.image = add(scene, sky);
    scene.environment.mapping = mapping;
    scene.environment.radiance = vec3(1.0f);
    scene.environment.to_world = to_world;
    look(scene, vec3(0, 2, 3), vec3(0.0f));
    return scene;
}

// The same integral with a fine grid: brightness of an albedo of 1/2 under the upper half of the sky.
double by_quadrature(Scene scene)
{
    validate(scene);
    const PackedScene packed = pack(scene);
    const SceneView view = packed.view();
    constexpr int rings = 1500, sectors = 3000;
    double sum = 0;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            const double c2 = (i + 0.5) / rings, c = std::sqrt(c2), r = std::sqrt(1 - c2); // uniform in cos^2
            const double turn = 2 * pi_d * (j + 0.5) / sectors;
            sum += double{environment_radiance(view, vec3(r * std::cos(turn), c, r * std::sin(turn))).y};
        }
    return 0.5 * sum / rings / sectors;
}

TEST(EnvironmentLight, AConstantPictureIsAConstantEnvironment)
{
    for (const uint mapping : {environment_equirectangular, environment_octahedral}) {
        const Image white = picture_of(8, 4, [](uint, uint) { return 0.75f; });
        const Scene scene = floor_under(white, mapping, rotation(vec3(1, 1, 0), 30.0f));
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(t.name);
            expect_value(measure(scene, probe_settings("path", t.parameters)), 0.5 * 0.75);
        }
        expect_value(measure(scene, probe_settings("whitted")), 0.5 * 0.75);
    }
}

TEST(EnvironmentLight, EveryTechniqueFindsTheSun)
{
    // a dim sky with a sun of one texel, near the seam and turned; its octahedral sister
    for (const uint mapping : {environment_equirectangular, environment_octahedral}) {
        const bool square = mapping == environment_octahedral;
        const uint width = square ? 16 : 32, height = 16;
        const Image sky = picture_of(width, height, [&](uint x, uint y) {
            return x == (square ? 9u : 0u) && y == (square ? 6u : 3u) ? 300.0f : 0.2f + 0.01f * static_cast<float>(y);
        });
        const Transform map = square ? rotation(vec3(1, 0, 0.2f), -70.0f) : rotation(vec3(0, 1, 0.1f), 10.0f);
        const Scene scene = floor_under(sky, mapping, map);
        const double exact = by_quadrature(scene);
        EXPECT_GT(exact, 0.3); // the sun is on the sky
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(t.name);
            const bool blind = t.name == "BSDF sampling";
            const Measurement m = measure(scene, probe_settings("path", t.parameters, blind ? 1024 : 256));
            EXPECT_NEAR(m.mean, exact, 4 * m.error + 1e-3 * exact);
            EXPECT_LE(m.error, (blind ? 0.04 : 0.004) * exact);
        }
        const Measurement m = measure(scene, probe_settings("whitted"));
        EXPECT_NEAR(m.mean, exact, 4 * m.error + 1e-3 * exact);
    }
}

TEST(EnvironmentLight, ChoosingBetweenItAndLampsFavoursNeither)
{
    // Both are found by both kinds of sampling; only with the right probabilities do the weights add up to 1.
    Scene scene = floor_under(picture_of(4, 2, [](uint, uint y) { return y == 0 ? 1.0f : 0.0f; }),
                              environment_equirectangular, identity_transform());
    const double sky = by_quadrature(scene);
    Scene lamp_only;
    for (Scene* s : {&scene, &lamp_only}) {
        if (s == &lamp_only) add_plane(*s, vec3(0.0f), vec3(0, 1, 0), diffuse(*s, 0.5f));
        place(*s, polygon({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, diffuse(*s, 0.0f, 3.0f)));
        look(*s, vec3(0, 0.5f, 3), vec3(0.0f));
    }
    // a square of side 2 at distance 1: form factor 4 / pi * atan(a) * a' with a = 1 / sqrt(2)
    const double a = 1 / std::sqrt(2.0), factor = 4 / pi_d * a * std::atan(a);
    const double lamp = 0.5 * 3 * factor;
    expect_value(measure(lamp_only, probe_settings("path")), lamp);
    // the lamp is black from above and hides its part of the sky: measured once, by BSDF sampling
    const Measurement both = measure(scene, probe_settings("path", {{"nee", "0"}}, 4096));
    EXPECT_GT(both.mean, lamp);
    EXPECT_LT(both.mean, lamp + sky);
    for (const Technique& t : techniques()) {
        SCOPED_TRACE(t.name);
        const Measurement m = measure(scene, probe_settings("path", t.parameters, 1024));
        EXPECT_NEAR(m.mean, both.mean, 4 * std::hypot(m.error, both.error)) << "error " << m.error;
        EXPECT_LE(m.error, 0.005 * both.mean);
    }
    const Measurement m = measure(scene, probe_settings("whitted", {}, 1024));
    EXPECT_NEAR(m.mean, both.mean, 4 * std::hypot(m.error, both.error));
}

TEST(EnvironmentLight, HiddenFromTheCameraOnly)
{
    Scene scene = floor_under(picture_of(2, 1, [](uint, uint) { return 2.0f; }), environment_equirectangular,
                              identity_transform());
    scene.environment.visible = false;
    for (const char* integrator : {"path", "whitted"})
        expect_value(measure(scene, probe_settings(integrator)), 1.0); // the floor is lit all the same
    look(scene, vec3(0, 2, 3), vec3(0, 5, 0));
    for (const char* integrator : {"path", "whitted"}) {
        const Film film = render_film(scene, probe_settings(integrator, {}, 4));
        for (const vec3 sum : film.sum) EXPECT_EQ(sum, vec3(0.0f));
    }
    scene.environment.visible = true;
    expect_value(measure(scene, probe_settings("path", {}, 4)), 2.0);
}

// A lamp of 2 x 2 over a floor, its emission multiplied by a checkerboard of 0 and 1, or half of it cut away.
Scene textured_lamp(bool holes, bool instanced, bool mirrored)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0, 1, 0), diffuse(scene, 0.5f));
    MaterialDesc shine;
    shine.base_color = vec3(0.0f);
    shine.emission = vec3(4.0f);
    // dark where x < 0 on the left half, so that the answer is half of the symmetric lamp's
    Image halves;
    halves.width = 2, halves.height = 1;
    halves.format = texels_rgba8_linear;
    halves.bytes = {0, 0, 0, 0, 255, 255, 255, 255};
    TextureRef& ref = holes ? shine.opacity_texture : shine.emission_texture;
    ref.image = add(scene, halves);
    ref.filter = filter_nearest;
    ref.channel = 3;
    if (holes) shine.coverage = coverage_mask;
    Mesh lamp = polygon({{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, add(scene, shine));
    lamp.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Group group;
    group.meshes = {add(scene, lamp)};
    InstanceDesc placed;
    placed.group = add(scene, group);
    placed.transform = translation(vec3(0, 1, 0));
    if (mirrored) placed.transform = compose(placed.transform, scaling(vec3(-1, 1, 1)));
    add(scene, placed);
    if (instanced) { // far away, so that the group stays in object space
        placed.transform = translation(vec3(0, -1000, 0));
        add(scene, placed);
    }
    look(scene, vec3(0, 0.5f, 3), vec3(0.0f));
    return scene;
}

TEST(TexturedLamp, HalfOfItShines)
{
    const double a = 1 / std::sqrt(2.0), factor = 4 / pi_d * a * std::atan(a);
    const double half = 0.5 * 0.5 * 4 * factor;
    for (const bool holes : {false, true})
        for (const bool instanced : {false, true})
            for (const bool mirrored : {false, true}) {
                SCOPED_TRACE(fmt::format("holes {} instanced {} mirrored {}", holes, instanced, mirrored));
                const Scene scene = textured_lamp(holes, instanced, mirrored);
                for (const Technique& t : techniques()) {
                    SCOPED_TRACE(t.name);
                    expect_value(measure(scene, probe_settings("path", t.parameters, 256)), half, 0.02);
                }
                expect_value(measure(scene, probe_settings("whitted", {}, 256)), half, 0.02);
            }
}

// Off the middle: the shining half counts by where it is, so a texture that is looked up elsewhere shows.
TEST(TexturedLamp, TheRightHalfShines)
{
    for (const bool mirrored : {false, true})
        for (const bool instanced : {false, true}) {
            Scene scene = textured_lamp(false, instanced, mirrored);
            look(scene, vec3(1.0f, 0.3f, 3), vec3(1.0f, 0, 0));
            const Measurement seen = measure(scene, probe_settings("path", {{"nee", "0"}}, 1024));
            EXPECT_LT(seen.error, 0.02 * seen.mean);
            const Measurement drawn = measure(scene, probe_settings("path", {{"mis", "0"}}, 256));
            EXPECT_NEAR(drawn.mean, seen.mean, 4 * std::hypot(seen.error, drawn.error));
            // (1, 0, 0) lies under the edge of the shining half, or under the edge of the dark one
            const double near_half = 0.5 * 4 / pi_d * 0.5; // far from exact: only which of the two it is
            EXPECT_EQ(drawn.mean > 0.5 * near_half, !mirrored) << drawn.mean;
        }
}

TEST(TexturedLamp, ASphereShinesOnOneSide)
{
    // bright where u > 1/2: longitude is counted from -Z over -X to +Z and +X, so on the side of +X
    Scene scene;
    add_plane(scene, vec3(-1.5f, 0, 0), vec3(1, 0, 0), diffuse(scene, 0.5f));
    add_plane(scene, vec3(1.5f, 0, 0), vec3(-1, 0, 0), diffuse(scene, 0.5f));
    MaterialDesc shine;
    shine.base_color = vec3(0.0f);
    shine.emission = vec3(4.0f);
    Image halves;
    halves.width = 2, halves.height = 1;
    halves.format = texels_rgba8_linear;
    halves.bytes = {0, 0, 0, 255, 255, 255, 255, 255};
    shine.emission_texture.image = add(scene, halves);
    shine.emission_texture.filter = filter_nearest;
    add_sphere(scene, vec3(0.0f), 0.5f, add(scene, shine));
    for (const float side : {1.0f, -1.0f}) {
        look(scene, vec3(0, 0, 1.2f), vec3(1.5f * side, 0, 0));
        const Measurement seen = measure(scene, probe_settings("path", {{"nee", "0"}, {"max_depth", "1"}}, 1024));
        const Measurement drawn = measure(scene, probe_settings("path", {{"mis", "0"}, {"max_depth", "1"}}));
        EXPECT_NEAR(drawn.mean, seen.mean, 4 * std::hypot(seen.error, drawn.error) + 1e-9) << side;
        // sin^2 of the sphere's cone
        EXPECT_NEAR(drawn.mean, side > 0 ? 0.5 * 4 * sqr(0.5f / 1.5f) : 0.0, 0.01);
    }
}

} // namespace
} // namespace snell::test

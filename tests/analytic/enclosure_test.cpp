// Closed rooms, in which light bounces for ever: the sum is a geometric series.
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

// Without roulette a path bounces 1000 times here: few of them must do.
uint samples_for(const Technique& t)
{
    return t.parameters.count("rr") > 0 ? 2 : 256;
}

// A unit sphere of albedo 1/2 around a point light of intensity pi: the wall gets irradiance pi and sends back
// 1/2 * pi / pi = 1/2, all of which comes back with the same factor: 1/2 + 1/4 + ... = 1.
Scene lamp_in_a_sphere()
{
    Scene scene;
    add_sphere(scene, vec3(0.0f), 1.0f, diffuse(scene, 0.5f));
    add_point_light(scene, vec3(0.0f), static_cast<float>(std::numbers::pi));
    look(scene, vec3(0.3f, 0.1f, -0.2f), vec3(-0.5f, 0.2f, 0.7f), 60.0f); // all points are alike
    return scene;
}

TEST(Enclosure, LampInASphere)
{
    for (const char* sampler : {"sobol", "independent"})
        for (const Technique& t : techniques()) {
            if (t.parameters.count("nee") > 0) continue; // nobody hits a point
            SCOPED_TRACE(testing::Message() << t.name << ", " << sampler);
            RenderSettings settings = probe_settings("path", t.parameters, samples_for(t));
            settings.sampler = sampler;
            expect_value(measure(lamp_in_a_sphere(), settings), 1);
        }
    // direct light alone, whatever the number of reflections that are followed
    for (const char* depth : {"0", "1", "12"})
        expect_value(measure(lamp_in_a_sphere(), probe_settings("whitted", {{"max_depth", depth}}, 4)), 0.5, 1e-6);
}

// Every bounce but the last adds its term exactly.
TEST(Enclosure, DepthLimitCutsTheSeries)
{
    double sum = 0;
    for (int depth = 1; depth <= 4; ++depth) {
        sum += std::pow(0.5, depth);
        SCOPED_TRACE(testing::Message() << "max_depth " << depth);
        const Parameters parameters = {{"max_depth", std::to_string(depth)}, {"rr", "0"}};
        expect_value(measure(lamp_in_a_sphere(), probe_settings("path", parameters, 16)), sum, 1e-6);
    }
    expect_value(measure(lamp_in_a_sphere(), probe_settings("path", {{"max_depth", "0"}})), 1); // no limit
}

// The film's layers are the terms.
TEST(Enclosure, LayersAreTheTerms)
{
    RenderSettings settings = probe_settings("path");
    settings.layers = true;
    const Film film = render_film(lamp_in_a_sphere(), settings);
    double direct = 0, indirect = 0, emission = 0, all = 0;
    for (std::size_t i = 0; i < film.sum.size(); ++i) {
        direct += double{film.layers.direct[i].x}, indirect += double{film.layers.indirect[i].x};
        emission += double{film.layers.emission[i].x}, all += double{film.sum[i].x};
    }
    const double n = static_cast<double>(film.sum.size()) * settings.spp;
    EXPECT_NEAR(direct / n, 0.5, 1e-4);
    EXPECT_EQ(emission, 0.0);
    EXPECT_NEAR(direct + indirect, all, 1e-4 * all);
}

// Walls of albedo a that emit 1: radiance 1 / (1 - a) everywhere.
TEST(Enclosure, GlowingSphere)
{
    for (const float albedo : {0.0f, 0.5f, 0.8f}) {
        Scene scene;
        add_sphere(scene, vec3(0.0f), 1.0f, diffuse(scene, albedo, 1.0f, true));
        look(scene, vec3(0.3f, 0.1f, -0.2f), vec3(-0.5f, 0.2f, 0.7f), 60.0f);
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(testing::Message() << t.name << ", albedo " << albedo);
            expect_value(measure(scene, probe_settings("path", t.parameters, samples_for(t))),
                         1 / (1 - double{albedo}));
        }
        expect_value(measure(scene, probe_settings("whitted")), 1 + double{albedo});
    }
}

// The same in a box of triangles, whose fronts look inwards.
TEST(Enclosure, GlowingBox)
{
    Scene scene;
    const Index<MaterialDesc> wall = diffuse(scene, 0.6f, 1.0f);
    Mesh box;
    for (uint i = 0; i < 8; ++i) box.positions.emplace_back(i & 1u, i >> 1 & 1u, i >> 2 & 1u);
    const uint faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& f : faces) {
        box.triangles.emplace_back(f[0], f[1], f[2]);
        box.triangles.emplace_back(f[0], f[2], f[3]);
    }
    box.material = wall;
    place(scene, box);
    look(scene, vec3(0.3f, 0.6f, 0.4f), vec3(0.9f, 0.2f, 0.7f), 60.0f);
    for (const Technique& t : techniques()) {
        if (t.parameters.count("mis") > 0) continue; // its variance is infinite where walls meet
        SCOPED_TRACE(t.name);
        expect_value(measure(scene, probe_settings("path", t.parameters, samples_for(t))), 2.5, 0.02);
    }
}

// Glowing mirrors: each reflection keeps r of what the one before showed.
TEST(Enclosure, RoomOfMirrors)
{
    Scene scene;
    MaterialDesc mirror;
    mirror.kind = material_mirror;
    mirror.base_color = vec3(0.5f);
    mirror.emission = vec3(1.0f);
    mirror.two_sided_emission = true;
    add_sphere(scene, vec3(0.0f), 1.0f, add(scene, mirror));
    look(scene, vec3(0.3f, 0.1f, -0.2f), vec3(-0.5f, 0.2f, 0.7f), 60.0f);
    for (const Technique& t : techniques()) {
        SCOPED_TRACE(t.name);
        expect_value(measure(scene, probe_settings("path", t.parameters, samples_for(t))), 2);
    }
    for (int depth = 0; depth <= 4; ++depth) { // whitted follows so many reflections, path scatters so often
        SCOPED_TRACE(testing::Message() << "depth " << depth);
        const double sum = 2 - std::pow(0.5, depth);
        const std::string limit = std::to_string(depth);
        expect_value(measure(scene, probe_settings("whitted", {{"max_depth", limit}}, 4)), sum, 1e-6);
        if (depth == 0) continue;
        const Parameters parameters = {{"max_depth", limit}, {"rr", "0"}};
        expect_value(measure(scene, probe_settings("path", parameters, 4)), sum, 1e-6);
    }
}

// A conductor of known reflectance, at the incidence that the geometry gives: from the centre, always straight.
TEST(Enclosure, RoomOfMetal)
{
    Scene scene;
    MaterialDesc metal;
    metal.kind = material_conductor;
    metal.specular = vec3(1.0f);
    metal.absorption = vec3(2.0f); // k^2 / (4 + k^2) = 1/2
    metal.emission = vec3(1.0f);
    metal.two_sided_emission = true;
    add_sphere(scene, vec3(0.0f), 1.0f, add(scene, metal));
    look(scene, vec3(0.0f), vec3(-0.5f, 0.2f, 0.7f), 60.0f);
    expect_value(measure(scene, probe_settings("path")), 2);
}

} // namespace
} // namespace snell::test

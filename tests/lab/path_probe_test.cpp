// A replayed sample is the renderer's, bit for bit, and what the record says of it holds together.
#include "snell/lab/path_probe.h"

#include "snell/kernel/mis.h"
#include "snell/kernel/record.h"
#include "snell/scene/builtin.h"
#include "tests/render/scenes.h"

#include <random>

namespace snell::test {
namespace {

// Scenes by name: all that are built in, small, and the two of these tests.
std::vector<std::pair<std::string, Scene>> scenes()
{
    std::vector<std::pair<std::string, Scene>> all;
    for (const BuiltinScene& builtin : builtin_scenes()) {
        const std::string name(builtin.name);
        const bool small = builtin.make_with != nullptr && name != "many-lights";
        Scene scene = small ? builtin.make_with(std::max(builtin.least, 1)) : builtin.make();
        validate(scene);
        complete(scene, 1.0f);
        all.emplace_back(name, std::move(scene));
    }
    all.emplace_back("mixed", mixed_scene());
    all.emplace_back("principled", principled_scene());
    return all;
}

RenderSettings tiny(const std::string& integrator)
{
    RenderSettings settings;
    settings.width = 24;
    settings.height = 20;
    settings.spp = 3;
    settings.seed = 5;
    settings.threads = 1;
    settings.integrator = integrator;
    return settings;
}

bool same_bits(vec3 a, vec3 b)
{
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(PathProbe, RadianceIsTheRenderersToTheBit)
{
    std::size_t samples = 0, lit = 0, indirect = 0;
    for (const auto& [name, scene] : scenes()) {
        const auto prepared = prepare(scene, tiny("path"));
        for (const char* integrator : {"path", "direct", "whitted", "ao", "furnace", "normals", "steps", "primitive"}) {
            const bool is_light = std::string(integrator) == "path" || std::string(integrator) == "whitted";
            const RenderSettings settings = tiny(integrator);
            std::mt19937 random(7);
            for (int i = 0; i < (is_light ? 400 : 40); ++i) {
                const int x = static_cast<int>(random() % 24), y = static_cast<int>(random() % 20);
                const auto sample = static_cast<uint>(random() % 1000);
                const ProbedPath path = probe_path(*prepared, prepared->camera, settings, x, y, sample);
                const vec3 wanted = render_sample(*prepared, prepared->camera, settings, x, y, sample);
                ASSERT_TRUE(same_bits(path.radiance, wanted))
                    << name << ", " << integrator << ": sample " << sample << " of " << x << "," << y << " is "
                    << path.radiance.x << " " << path.radiance.y << " " << path.radiance.z << ", rendered " << wanted.x
                    << " " << wanted.y << " " << wanted.z;
                ++samples;
                lit += !is_black(wanted);
                indirect += !is_black(path.layers[layer_indirect]);
            }
        }
    }
    EXPECT_GT(samples, 5000u);
    EXPECT_GT(lit, samples / 3);
    EXPECT_GT(indirect, samples / 10);
}

// What a viewer shows: the replayed samples of a pixel, summed as a film sums them, are the film's pixel.
TEST(PathProbe, SamplesAddUpToTheFilm)
{
    for (const char* integrator : {"path", "whitted"}) {
        const RenderSettings settings = [&] {
            RenderSettings s = tiny(integrator);
            s.spp = 19;
            s.layers = true;
            return s;
        }();
        const auto prepared = prepare(principled_scene(), settings);
        const Film film = render(*prepared, settings).film;
        for (int y = 0; y < settings.height; y += 3)
            for (int x = 0; x < settings.width; x += 3) {
                Film one(1, 1, false);
                vec3 direct(0.0f);
                for (uint s = 0; s < settings.spp; ++s) {
                    const ProbedPath path = probe_path(*prepared, prepared->camera, settings, x, y, s);
                    one.add_sample(0, path.radiance);
                    direct += path.layers[layer_direct];
                }
                const auto pixel = static_cast<std::size_t>(y * settings.width + x);
                ASSERT_TRUE(same_bits(one.sum[0], film.sum[pixel])) << integrator << " " << x << "," << y;
                ASSERT_TRUE(same_bits(direct, film.layers.direct[pixel])) << integrator << " " << x << "," << y;
            }
    }
}

TEST(PathProbe, SwitchesOfTheIntegratorCount)
{
    const auto prepared = prepare(mixed_scene(), tiny("path"));
    for (const char* key : {"nee", "mis", "rr"}) {
        RenderSettings settings = tiny("path");
        settings.parameters[key] = "0";
        settings.parameters["max_depth"] = "6";
        settings.sampler = "independent";
        settings.pixel_jitter = false;
        for (int i = 0; i < 200; ++i) {
            const int x = i % 24, y = i % 19;
            const uint sample = static_cast<uint>(i);
            const ProbedPath path = probe_path(*prepared, prepared->camera, settings, x, y, sample);
            ASSERT_TRUE(same_bits(path.radiance, render_sample(*prepared, prepared->camera, settings, x, y, sample)))
                << key;
            for (const ProbedVertex& v : path.vertices) {
                if (std::string(key) == "nee") {
                    EXPECT_TRUE(v.lights.empty());
                }
                if (std::string(key) == "rr") {
                    EXPECT_EQ(v.survival, 1.0f);
                }
                EXPECT_LE(v.arriving.depth, 6u);
            }
        }
    }
}

// The parts of the record say the same as each other.
TEST(PathProbe, TheRecordHoldsTogether)
{
    std::size_t vertices = 0, survived = 0, by_event[8] = {}, by_ending[8] = {}, blocked = 0, weighed = 0, holes = 0;
    for (const auto& [name, scene] : scenes()) {
        const RenderSettings settings = tiny("path");
        const auto prepared = prepare(scene, settings);
        SCOPED_TRACE(name);
        for (int i = 0; i < 300; ++i) {
            const ProbedPath path =
                probe_path(*prepared, prepared->camera, settings, (7 * i) % 24, (5 * i) % 20, static_cast<uint>(i));
            ASSERT_FALSE(path.vertices.empty());
            EXPECT_EQ(path.vertices[0].parent, -1);
            EXPECT_EQ(static_cast<int>(path.film_position.x), path.x);
            EXPECT_EQ(static_cast<int>(path.film_position.y), path.y);
            std::size_t visible = 0;
            for (std::size_t k = 0; k < path.vertices.size(); ++k) {
                const ProbedVertex& v = path.vertices[k];
                ++vertices;
                ++by_ending[v.ending];
                holes += v.passed_holes;
                EXPECT_EQ(v.is_surface, is_hit(v.hit));
                EXPECT_EQ(v.is_surface, v.ending != ending_escaped);
                EXPECT_EQ(v.ending == ending_none, k + 1 < path.vertices.size());
                if (v.is_surface) { // the vertex lies where its ray has met something
                    EXPECT_LT(length(ray_at(v.ray, v.hit.t) - v.surface.position), 1e-3f * (1.0f + v.hit.t));
                }
                EXPECT_TRUE(v.emission_weight >= 0.0f && v.emission_weight <= 1.0f);
                if (v.emission_pdf > 0.0f && v.arriving.pdf > 0.0f) {
                    EXPECT_EQ(v.emission_weight, power_heuristic(v.arriving.pdf, v.emission_pdf));
                }
                EXPECT_TRUE(same_bits(v.emitted, v.throughput * v.emission * v.emission_weight));
                ASSERT_LE(v.lights.size(), 1u);
                for (const ProbedLight& light : v.lights) {
                    visible += light.was_traced && !light.is_blocked;
                    blocked += light.is_blocked;
                    if (light.is_blocked) {
                        EXPECT_LE(light.blocked_at, 1.001f * length(light.ray.direction) * light.ray.t_max);
                    }
                    if (light.was_traced && light.bsdf_pdf > 0.0f) {
                        ++weighed;
                        EXPECT_NEAR(light.weight + power_heuristic(light.bsdf_pdf, light.drawn.pdf), 1.0f, 1e-5f);
                    }
                    if (light.light != none) {
                        ASSERT_LT(light.light, prepared->packed.lights.size());
                    }
                    if (light.was_traced && v.arriving.medium == none) {
                        const vec3 wanted =
                            v.throughput * light.bsdf * light.drawn.radiance * (light.weight / light.drawn.pdf);
                        for (int c = 0; c < 3; ++c) // absorption inside of what the light shines through
                            EXPECT_LE(light.value[c], wanted[c] * 1.0001f + 1e-6f);
                    }
                }
                ASSERT_LE(v.continuations.size(), 1u);
                if (v.ending != ending_none) continue;
                const ProbedVertex::Continuation& c = v.continuations.at(0);
                const ProbedVertex& after = path.vertices[k + 1];
                ++by_event[c.event];
                ASSERT_EQ(c.vertex, static_cast<int>(k + 1));
                EXPECT_EQ(after.parent, static_cast<int>(k));
                vec3 throughput = v.throughput * c.weight;
                if (v.survival < 1.0f) throughput = throughput / v.survival;
                survived += v.survival < 1.0f;
                EXPECT_TRUE(same_bits(after.arriving.throughput, throughput));
                const bool is_specular = c.event == event_specular_reflection || c.event == event_specular_refraction;
                EXPECT_EQ(after.arriving.pdf, is_specular ? 0.0f : c.pdf);
                const bool through = c.event >= event_diffuse_transmission;
                const float sides = dot(v.ray.direction, v.surface.geometric_normal) *
                                    dot(after.ray.direction, v.surface.geometric_normal);
                EXPECT_EQ(sides > 0.0f, through) << event_name(c.event);
                if (v.material_kind == material_diffuse) {
                    EXPECT_EQ(c.event, event_diffuse_reflection);
                }
                if (v.material_kind == material_mirror) {
                    EXPECT_EQ(c.event, event_specular_reflection);
                }
            }
            std::size_t by_light = 0;
            for (const Contribution& one : path.contributions) by_light += one.light >= 0;
            EXPECT_EQ(by_light, visible);
        }
    }
    EXPECT_GT(vertices, 3000u);
    EXPECT_GT(survived, 30u);
    EXPECT_GT(blocked, 30u);
    EXPECT_GT(weighed, 300u);
    EXPECT_GT(holes, 10u);
    for (const uint event : {event_diffuse_reflection, event_glossy_reflection, event_specular_reflection,
                             event_glossy_refraction, event_specular_refraction})
        EXPECT_GT(by_event[event], 10u) << event_name(event);
    for (const uint ending : {ending_escaped, ending_absorbed, ending_roulette})
        EXPECT_GT(by_ending[ending], 5u) << ending_name(ending);
}

TEST(PathProbe, WhittedBranches)
{
    const RenderSettings settings = tiny("whitted");
    const auto prepared = prepare(mixed_scene(), settings);
    std::size_t forks = 0;
    for (int y = 0; y < settings.height; ++y)
        for (int x = 0; x < settings.width; ++x)
            for (const ProbedVertex& v : probe_path(*prepared, prepared->camera, settings, x, y, 0).vertices)
                forks += v.continuations.size() == 2 && v.continuations[0].event == event_specular_reflection &&
                         v.continuations[1].event == event_specular_refraction && v.continuations[1].vertex >= 0;
    EXPECT_GT(forks, 3u);
}

TEST(PathProbe, RefusesWhatIsNotThere)
{
    const auto prepared = prepare(mixed_scene(), tiny("path"));
    EXPECT_THROW(probe_path(*prepared, prepared->camera, tiny("path"), 24, 0, 0), Error);
    EXPECT_THROW(probe_path(*prepared, prepared->camera, tiny("path"), 0, -1, 0), Error);
    EXPECT_THROW(probe_path(*prepared, prepared->camera, tiny("parth"), 0, 0, 0), Error);
}

} // namespace
} // namespace snell::test

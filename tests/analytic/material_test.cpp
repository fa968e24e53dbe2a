// All materials under light from area lights and sky: the ways to find light must agree, also where there is no closed
// form; and the energy that rough surfaces return is the one of theory.
#include "tests/analytic/probe.h"
#include "tests/stat/microfacet_reference.h"

namespace snell::test {
namespace {

struct Named
{
    std::string name;
    MaterialDesc material;
};

std::vector<Named> materials()
{
    std::vector<Named> result;
    const auto put = [&](std::string name, uint kind, float alpha) -> MaterialDesc& {
        MaterialDesc m;
        m.kind = kind;
        m.alpha = alpha;
        m.base_color = vec3(0.6f);
        result.push_back({std::move(name), m});
        return result.back().material;
    };
    put("diffuse", material_diffuse, 0.0f);
    put("mix with a mirror", material_mix, 0.0f).specular = vec3(0.3f);
    put("glossy mix", material_mix, 0.3f).specular = vec3(0.3f);
    for (const float alpha : {0.2f, 0.6f}) {
        MaterialDesc& metal = put(alpha < 0.5f ? "metal" : "rough metal", material_conductor, alpha);
        metal.specular = vec3(0.2f);
        metal.absorption = vec3(3.0f);
        MaterialDesc& frosted = put(alpha < 0.5f ? "frosted glass" : "rough glass", material_dielectric, alpha);
        frosted.base_color = vec3(0.9f);
        frosted.absorption = vec3(0.4f);
    }
    return result;
}

// A ball of the material on a floor, before a large light, a ball that glows, and a dim sky.
Scene ball_scene(const MaterialDesc& material)
{
    Scene scene;
    scene.environment.radiance = vec3(0.2f);
    add_plane(scene, vec3(0.0f, -1.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.4f));
    place(scene, polygon({{-2, 3, -1}, {2, 3, -1}, {2, 3, 2}, {-2, 3, 2}}, diffuse(scene, 0.0f, 2.0f)));
    add_sphere(scene, vec3(2.5f, 0.0f, 1.0f), 0.8f, diffuse(scene, 0.0f, 1.5f));
    add_sphere(scene, vec3(0.0f), 1.0f, add(scene, material));
    look(scene, vec3(0.5f, 1.0f, 6.0f), vec3(0.0f), 24.0f);
    return scene;
}

// Mean of the difference between two pictures of the same expectation, pixel by pixel.
Measurement difference(const std::vector<double>& a, const std::vector<double>& b)
{
    std::vector<double> d(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
    return mean_of(d);
}

TEST(Materials, AllWaysToFindLightAgree)
{
    for (const Named& n : materials()) {
        const Scene scene = ball_scene(n.material);
        std::vector<std::vector<double>> pictures;
        uint seed = 0;
        for (const Technique& t : techniques()) {
            RenderSettings settings = probe_settings("path", t.parameters, t.parameters.count("nee") > 0 ? 512 : 256);
            settings.width = settings.height = 24;
            settings.seed += ++seed; // no two of them share their random numbers
            pictures.push_back(pixel_means(render_film(scene, settings)));
        }
        for (std::size_t i = 1; i < pictures.size(); ++i) {
            const Measurement d = difference(pictures[0], pictures[i]);
            EXPECT_NEAR(d.mean, 0, 4 * d.error) << n.name << ", " << techniques()[i].name << " against MIS";
            EXPECT_LT(d.error, 0.01) << n.name << ": too noisy to tell anything";
        }
    }
}

// A ball of perfectly reflecting facets in light of 1 from everywhere, seen straight and at 60 degrees.
TEST(Materials, RoughReflectionReturnsWhatSmithSays)
{
    for (const float alpha : {0.1f, 0.5f, 1.0f})
        for (const double z : {1.0, 0.5}) {
            SCOPED_TRACE(testing::Message() << "alpha " << alpha << ", cosine " << z);
            Scene scene;
            scene.environment.radiance = vec3(1.0f);
            MaterialDesc m;
            m.kind = material_mix;
            m.base_color = vec3(0.0f);
            m.specular = vec3(1.0f);
            m.alpha = alpha;
            add_sphere(scene, vec3(0.0f), 1.0f, add(scene, m));
            const auto x = static_cast<float>(std::sqrt(1 - z * z));
            look(scene, vec3(x, 0.0f, 8.0f), vec3(x, 0.0f, 0.0f), 1e-3f);
            for (const Technique& t : techniques()) {
                SCOPED_TRACE(t.name);
                const Measurement found = measure(scene, probe_settings("path", t.parameters));
                EXPECT_NEAR(found.mean, smith_albedo(double{alpha}, z), 4 * found.error + 1e-3);
            }
        }
}

} // namespace
} // namespace snell::test

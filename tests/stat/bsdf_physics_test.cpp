// What physics asks of scattering: reciprocity, energy, and the published formulas, in double precision.
#include "tests/stat/bsdf_cases.h"
#include "tests/stat/direction_bins.h"
#include "tests/stat/microfacet_reference.h"

namespace snell::test {
namespace {

TEST(BsdfPhysics, RoughDielectricIsWalters)
{
    Draw draw(450);
    int compared[2] = {0, 0};
    for (const float alpha : {0.05f, 0.3f, 1.0f})
        for (const float ior : {1.5f, 1.0f / 1.5f, 2.4f}) {
            MaterialPoint m = material_point_of(material_dielectric, alpha);
            m.base_color = vec3(1.0f);
            m.ior = ior;
            for (int k = 0; k < 20'000; ++k) {
                const vec3 o = draw.direction(), i = draw.direction();
                if (abs(o.z) < 0.01f || abs(i.z) < 0.01f) continue;
                const double reference = reference_dielectric(double{alpha}, double{ior}, o, i);
                const float f = eval_bsdf(m, o, i).y;
                // facets seen almost edge-on may fall on either side of that edge
                if ((reference == 0) != (f == 0.0f)) {
                    ASSERT_LT(std::max(reference, double{f}), 2e-2) << describe({"dielectric", m}, o);
                    continue;
                }
                ASSERT_NEAR(f, reference, 1e-2 * reference + 1e-5)
                    << alpha << " " << ior << " wo " << o.z << " wi " << i.z;
                if (reference > 1e-4) ++compared[o.z * i.z > 0.0f ? 0 : 1];
            }
        }
    EXPECT_GT(compared[0], 10'000);
    EXPECT_GT(compared[1], 2'000);
}

TEST(BsdfPhysics, RoughConductorIsWalters)
{
    Draw draw(451);
    for (const float alpha : {0.05f, 0.3f, 1.0f}) {
        const MaterialPoint m = material_point_of(material_conductor, alpha);
        for (int k = 0; k < 20'000; ++k) {
            const vec3 o = draw.direction();
            vec3 i = draw.direction();
            if (i.z * o.z < 0.0f) i.z = -i.z;
            if (abs(o.z) < 0.01f || abs(i.z) < 0.01f) continue;
            const glm::dvec3 h = glm::normalize(glm::dvec3(o) + glm::dvec3(i));
            const double g =
                1 / (1 + reference_lambda(double{o.z}, double{alpha}) + reference_lambda(double{i.z}, double{alpha}));
            const double dg = g * reference_d(std::abs(h.z), double{alpha}) / (4 * std::abs(double{o.z}));
            const vec3 fresnel = fresnel_conductor(static_cast<float>(glm::dot(glm::dvec3(o), h)), m.specular, m.k);
            const vec3 f = eval_bsdf(m, o, i);
            for (int a = 0; a < 3; ++a)
                ASSERT_NEAR(f[a], dg * double{fresnel[a]}, 1e-3 * dg + 1e-7) << alpha << " " << o.z << " " << i.z;
        }
    }
}

TEST(BsdfPhysics, LambertAndMix)
{
    const vec3 o = normalize(vec3(0.3f, 0.1f, 0.5f)), i = normalize(vec3(-0.6f, 0.2f, 0.7f));
    const MaterialPoint diffuse = material_point_of(material_diffuse, 0.0f);
    EXPECT_NEAR(eval_bsdf(diffuse, o, i).x, 0.8f * i.z / 3.14159265f, 1e-6f);
    EXPECT_NEAR(eval_bsdf(diffuse, -o, -i).x, 0.8f * i.z / 3.14159265f, 1e-6f) << "both sides";
    EXPECT_EQ(eval_bsdf(diffuse, o, -i).x, 0.0f) << "opaque";
    // a mix is the sum of its parts
    const MaterialPoint mix = material_point_of(material_mix, 0.4f);
    const float specular = eval_ggx_reflection(0.4f, o, i);
    for (int a = 0; a < 3; ++a)
        EXPECT_NEAR(eval_bsdf(mix, o, i)[a], eval_bsdf(diffuse, o, i)[a] + mix.specular[a] * specular, 1e-6f);
}

// f(wo, wi) = f(wi, wo) for reflection; f(wo, wi) / n(wo)^2 = f(wi, wo) / n(wi)^2 for refraction (Veach 1997, 5.3).
TEST(BsdfPhysics, Reciprocity)
{
    Draw draw(452);
    for (const BsdfCase& c : all_cases()) {
        int pairs = 0;
        for (int k = 0; k < 4000; ++k) {
            const vec3 a = draw.direction(), b = draw.direction();
            if (abs(a.z) < 0.02f || abs(b.z) < 0.02f) continue;
            const double na = a.z > 0.0f ? 1 : double{c.material.ior}, nb = b.z > 0.0f ? 1 : double{c.material.ior};
            const glm::dvec3 ab = glm::dvec3(eval_bsdf(c.material, a, b)) / (std::abs(double{b.z}) * na * na);
            const glm::dvec3 ba = glm::dvec3(eval_bsdf(c.material, b, a)) / (std::abs(double{a.z}) * nb * nb);
            for (int x = 0; x < 3; ++x)
                ASSERT_NEAR(ab[x], ba[x], 5e-3 * std::max(ab[x], ba[x]) + 2e-5)
                    << describe(c, a) << ", wi " << b.x << " " << b.y << " " << b.z;
            pairs += ab.x > 1e-5 ? 1 : 0;
        }
        // narrow lobes are met seldom by chance: take pairs from sampling as well
        for (int k = 0; k < 4000; ++k) {
            const vec3 a = draw.direction();
            const vec2 u = draw.next2();
            const BsdfSample s = sample_bsdf(c.material, a, u, draw.next());
            if (s.pdf == 0.0f || s.is_delta != 0u || abs(a.z) < 0.05f || abs(s.wi.z) < 0.05f) continue;
            const vec3 b = s.wi;
            const double na = a.z > 0.0f ? 1 : double{c.material.ior}, nb = b.z > 0.0f ? 1 : double{c.material.ior};
            const double ab = double{eval_bsdf(c.material, a, b).y} / (std::abs(double{b.z}) * na * na);
            const double ba = double{eval_bsdf(c.material, b, a).y} / (std::abs(double{a.z}) * nb * nb);
            ASSERT_NEAR(ab, ba, 1e-2 * std::max(ab, ba) + 2e-5) << describe(c, a);
            ++pairs;
        }
        if (has_smooth_part(c.material)) {
            EXPECT_GT(pairs, 1000) << c.name;
        }
    }
}

struct Energy
{
    glm::dvec3 mean{0.0}, error{0.0}; // of what comes back, by sampling
};

Energy energy_by_sampling(const MaterialPoint& m, vec3 wo, int n, Draw& draw)
{
    glm::dvec3 sum(0.0), squares(0.0);
    for (int i = 0; i < n; ++i) {
        const vec2 u = draw.next2();
        const glm::dvec3 e(returned_energy(sample_bsdf(m, wo, u, draw.next())));
        sum += e, squares += e * e;
    }
    const double count = n;
    Energy result;
    result.mean = sum / count;
    for (int a = 0; a < 3; ++a)
        result.error[a] = std::sqrt(std::max(squares[a] / count - result.mean[a] * result.mean[a], 0.0) / count);
    return result;
}

// No material returns more than it gets; glossy ones lose what single scattering loses, and not much of it when smooth.
TEST(BsdfPhysics, WhiteFurnace)
{
    Draw draw(453);
    std::vector<BsdfCase> cases = all_cases();
    for (BsdfCase& c : cases) { // as white as they come
        c.material.base_color = vec3(1.0f);
        if (c.material.kind == material_mix) c.material.base_color = vec3(1.0f) - c.material.specular;
    }
    for (const BsdfCase& c : cases)
        for (const vec3& wo : outgoing_directions()) {
            SCOPED_TRACE(describe(c, wo));
            const Energy e = energy_by_sampling(c.material, wo, 20'000, draw);
            for (int a = 0; a < 3; ++a) {
                EXPECT_LE(e.mean[a], 1 + 4 * e.error[a] + 1e-5);
                if (c.material.kind != material_conductor && c.material.alpha <= 0.02f && abs(wo.z) > 0.3f) {
                    // smooth surfaces lose next to nothing
                    EXPECT_GE(e.mean[a], 1 - 4 * e.error[a] - 5e-3);
                }
            }
        }
}

// What sampling finds is the integral of eval: no part is lost or counted twice.
TEST(HeavyBsdfPhysics, SamplingFindsTheIntegralOfEval)
{
    Draw draw(454);
    for (const BsdfCase& c : all_cases()) {
        if (!has_smooth_part(c.material) || (c.material.alpha > 0.0f && c.material.alpha < 0.2f)) continue;
        for (const vec3& wo : outgoing_directions()) {
            SCOPED_TRACE(describe(c, wo));
            const DirectionBins bins(vec3(0.0f, 0.0f, 1.0f), 16, 24);
            const auto integral_of = [&](int channel) {
                const std::vector<double> cells = bins.integrate(
                    [&](vec3 wi) {
                        const double eta = wo.z > 0.0f ? double{c.material.ior} : 1 / double{c.material.ior};
                        const double undo = wi.z * wo.z < 0.0f ? eta * eta : 1;
                        return double{eval_bsdf(c.material, wo, wi)[channel]} * undo;
                    },
                    1e-6);
                return std::accumulate(cells.begin(), cells.end(), 0.0);
            };
            MaterialPoint m = c.material;
            const Energy e = energy_by_sampling(m, wo, 40'000, draw);
            // the perfect mirror in a smooth mix is no part of eval
            const double delta = m.kind == material_mix && m.alpha == 0.0f ? double{m.specular.y} : 0;
            EXPECT_NEAR(e.mean.y, integral_of(1) + delta, 4.5 * e.error.y + 1e-3);
        }
    }
}

// The energy of a rough surface that reflects all light, by quadrature over its visible facets: F = 1, so what is left
// is G2 / G1, and the height-correlated form is known to keep between 1 and about 0.45 of it at alpha 1.
TEST(BsdfPhysics, RoughReflectionLosesWhatSmithSays)
{
    Draw draw(455);
    for (const float alpha : {0.1f, 0.5f, 1.0f})
        for (const float z : {0.95f, 0.5f, 0.15f}) {
            const vec3 wo(std::sqrt(1.0f - z * z), 0.0f, z);
            const double exact = smith_albedo(double{alpha}, double{z});
            double sum = 0, squares = 0;
            constexpr int samples = 100'000;
            for (int i = 0; i < samples; ++i) {
                const vec3 wi = sample_ggx_reflection(alpha, wo, draw.next2());
                double w = 0;
                if (wi.z > 0.0f)
                    w = double{eval_ggx_reflection(alpha, wo, wi)} / double{pdf_ggx_reflection(alpha, wo, wi)};
                sum += w, squares += w * w;
            }
            const double mean = sum / samples;
            EXPECT_NEAR(mean, exact, 4 * std::sqrt((squares / samples - mean * mean) / samples) + 1e-3)
                << alpha << " " << z;
        }
}

} // namespace
} // namespace snell::test

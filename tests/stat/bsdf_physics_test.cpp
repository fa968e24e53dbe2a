// What physics asks of scattering: reciprocity, energy, and the published formulas, in double precision.
#include "tests/stat/bsdf_cases.h"
#include "tests/stat/direction_bins.h"

namespace snell::test {
namespace {

// --- Walter et al. 2007, equations 20, 21, 33, 34 as printed, with Heitz's 2014 height-correlated masking
// ---------------

double reference_d(double cos_m, double alpha)
{
    if (cos_m <= 0) return 0;
    const double c2 = cos_m * cos_m, tan2 = (1 - c2) / c2, a2 = alpha * alpha;
    return a2 / (std::numbers::pi * c2 * c2 * (a2 + tan2) * (a2 + tan2));
}

double reference_lambda(double c, double alpha)
{
    const double tan2 = (1 - c * c) / (c * c);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

double reference_fresnel(double c, double ior)
{
    const double g2 = ior * ior - 1 + c * c;
    if (g2 <= 0) return 1;
    const double g = std::sqrt(g2), a = (g - c) / (g + c), b = (c * (g + c) - 1) / (c * (g - c) + 1);
    return 0.5 * a * a * (1 + b * b);
}

// BSDF * |cos wi| of a rough dielectric without tint. eta_o, eta_i: indices on the sides of wo and wi.
double reference_dielectric(double alpha, double ior, glm::dvec3 o, glm::dvec3 i)
{
    const double eta_o = o.z > 0 ? 1 : ior, eta_i = i.z > 0 ? 1 : ior;
    const bool reflects = o.z * i.z > 0;
    glm::dvec3 h = reflects ? (o.z > 0 ? 1.0 : -1.0) * (i + o) : -(eta_i * i + eta_o * o);
    h = glm::normalize(h);
    if (h.z < 0) h = -h;
    const double oh = glm::dot(o, h), ih = glm::dot(i, h);
    if (oh * o.z <= 0 || ih * i.z <= 0) return 0;
    const double g = 1 / (1 + reference_lambda(o.z, alpha) + reference_lambda(i.z, alpha));
    const double other = o.z > 0 ? ior : 1 / ior;
    const double fresnel = reference_fresnel(std::abs(oh), other);
    if (reflects) return fresnel * g * reference_d(h.z, alpha) / (4 * std::abs(o.z));
    const double sum = eta_i * ih + eta_o * oh;
    // equation 21 with the roles of radiance: light arrives from i, so the index of the side it leaves to is squared
    return std::abs(oh * ih / o.z) * eta_o * eta_o * (1 - fresnel) * g * reference_d(h.z, alpha) / (sum * sum);
}

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
                ASSERT_NEAR(f, reference, 2e-3 * reference + 1e-6)
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
                ASSERT_NEAR(ab[x], ba[x], 2e-3 * std::max(ab[x], ba[x]) + 1e-5)
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
            ASSERT_NEAR(ab, ba, 5e-3 * std::max(ab, ba) + 1e-5) << describe(c, a);
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
            // directly: integrate D G2 / (4 cos) over directions in double precision
            constexpr int n = 400;
            double exact = 0;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    // over facets m, in the variable in which D cos is uniform; d(wi) = 4 (wo.m) d(m)
                    const double s = (i + 0.5) / n, p = 2 * std::numbers::pi * (j + 0.5) / n,
                                 a2 = double{alpha * alpha};
                    const double tan2 = a2 * s / (1 - s), cm = 1 / std::sqrt(1 + tan2), sm = std::sqrt(1 - cm * cm);
                    const glm::dvec3 m(sm * std::cos(p), sm * std::sin(p), cm);
                    const double om = glm::dot(glm::dvec3(wo), m);
                    if (om <= 0) continue;
                    const double iz = 2 * om * cm - double{z};
                    if (iz <= 0) continue;
                    const double g2 =
                        1 / (1 + reference_lambda(double{z}, double{alpha}) + reference_lambda(iz, double{alpha}));
                    exact += g2 * om / (double{z} * cm) / (n * n); // D(m) cm d(m) is 1 / n^2
                }
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

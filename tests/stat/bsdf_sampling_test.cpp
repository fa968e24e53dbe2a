// sample_bsdf against pdf_bsdf, for all materials: chi-square, and that weight, pdf and eval belong together.
#include "tests/stat/bsdf_cases.h"
#include "tests/stat/direction_bins.h"

namespace snell::test {
namespace {

enum class Side
{
    both,
    same, // reflection
    other // refraction
};

struct View
{
    DirectionBins bins;
    Side side;
};

// Cells that resolve the lobes of this material for light that goes to wo. Narrow lobes are looked at one by one, in
// cells around the mirror direction and around the refracted one.
std::vector<View> views_of(const MaterialPoint& m, vec3 wo)
{
    const vec3 up(0.0f, 0.0f, 1.0f);
    if (m.alpha == 0.0f || m.alpha > 0.2f || m.kind == material_diffuse)
        return {{DirectionBins(up, 16, 24), Side::both}};
    const double exponent = m.alpha < 0.05f ? 6 : 4;
    std::vector<View> views = {{DirectionBins(vec3(-wo.x, -wo.y, wo.z), 28, 24, exponent), Side::same}};
    if (m.kind == material_dielectric) {
        const DielectricSplit split = split_dielectric(wo.z, m.ior);
        if (split.reflectance < 0.9f)
            views.push_back({DirectionBins(refract_direction(wo, up, split), 28, 24, exponent), Side::other});
    }
    return views;
}

void check_density(const BsdfCase& c, vec3 wo, std::uint64_t stream, int count)
{
    for (const View& view : views_of(c.material, wo)) {
        const auto seen = [&](vec3 wi) {
            return view.side == Side::both || (view.side == Side::same) == (wi.z * wo.z > 0.0f);
        };
        Draw draw(stream);
        expect_density(
            view.bins, [&](vec3 wi) { return seen(wi) ? double{pdf_bsdf(c.material, wo, wi)} : 0.0; },
            [&] {
                const vec2 u = draw.next2();
                const BsdfSample s = sample_bsdf(c.material, wo, u, draw.next());
                return s.pdf > 0.0f && s.is_delta == 0u && seen(s.wi) ? s.wi : vec3(0.0f);
            },
            count);
    }
}

// Delta parts and samples below the surface are what the density lacks.
TEST(HeavyBsdfSampling, DirectionsFollowTheDensity)
{
    const int count = long_tests() ? 1'000'000 : 100'000;
    std::uint64_t stream = 400;
    for (const BsdfCase& c : all_cases()) {
        if (!has_smooth_part(c.material)) continue;
        for (const vec3& wo : outgoing_directions()) {
            SCOPED_TRACE(describe(c, wo));
            check_density(c, wo, stream++, count);
        }
    }
}

// A few of the same, for builds that are slow.
TEST(BsdfSampling, DirectionsFollowTheDensity)
{
    const vec3 wo = normalize(vec3(0.5f, -0.3f, 0.6f));
    for (const uint kind : {material_diffuse, material_mix, material_dielectric, material_conductor}) {
        const BsdfCase c{fmt::format("kind {}", kind), material_point_of(kind, 0.5f)};
        SCOPED_TRACE(describe(c, wo));
        check_density(c, wo, 390 + kind, 20'000);
        check_density(c, -wo, 395 + kind, 20'000);
    }
}

TEST(BsdfSampling, WeightPdfAndEvalBelongTogether)
{
    Draw draw(380);
    for (const BsdfCase& c : all_cases())
        for (const vec3& wo : outgoing_directions()) {
            SCOPED_TRACE(describe(c, wo));
            for (int i = 0; i < 300; ++i) {
                const vec2 u = draw.next2();
                const BsdfSample s = sample_bsdf(c.material, wo, u, draw.next());
                if (s.pdf == 0.0f) continue;
                ASSERT_TRUE(s.pdf > 0.0f && is_finite(s.pdf) && is_finite3(s.weight)) << s.pdf;
                ASSERT_NEAR(length(s.wi), 1.0f, 1e-5f);
                ASSERT_TRUE(s.weight.x >= 0.0f && s.weight.y >= 0.0f && s.weight.z >= 0.0f);
                const bool crosses = s.wi.z * wo.z < 0.0f;
                ASSERT_EQ(s.eta != 1.0f, crosses) << "eta is told when the sample crosses the surface";
                if (s.is_delta != 0u) {
                    ASSERT_LE(s.pdf, 1.0f);
                    continue;
                }
                ASSERT_NEAR(s.pdf, pdf_bsdf(c.material, wo, s.wi), 1e-4f * s.pdf);
                const vec3 f = eval_bsdf(c.material, wo, s.wi);
                for (int a = 0; a < 3; ++a) ASSERT_NEAR(s.weight[a] * s.pdf, f[a], 1e-4f * f[a] + 1e-9f);
            }
        }
}

// Where eval is not 0, sampling must be able to go.
TEST(BsdfSampling, DensityCoversTheBsdf)
{
    Draw draw(381);
    for (const BsdfCase& c : all_cases())
        for (int i = 0; i < 5000; ++i) {
            const vec3 wo = draw.direction(), wi = draw.direction();
            const vec3 f = eval_bsdf(c.material, wo, wi);
            const float pdf = pdf_bsdf(c.material, wo, wi);
            ASSERT_TRUE(is_finite3(f) && is_finite(pdf) && pdf >= 0.0f && min(f.x, min(f.y, f.z)) >= 0.0f);
            if (max3(f) > 0.0f) {
                ASSERT_GT(pdf, 0.0f) << describe(c, wo);
            }
            if (!has_smooth_part(c.material)) {
                ASSERT_TRUE(max3(f) == 0.0f && pdf == 0.0f) << c.name;
            }
        }
}

// The parts of a material are chosen as often as their probability says, and delta parts go where they must.
TEST(BsdfSampling, DeltaPartsAndTheirProbabilities)
{
    Draw draw(382);
    constexpr int n = 40'000;
    for (const BsdfCase& c : smooth_cases())
        for (const vec3& wo : outgoing_directions()) {
            SCOPED_TRACE(describe(c, wo));
            double reflected = 0, refracted = 0, p_reflected = 0, p_refracted = 0;
            for (int i = 0; i < n; ++i) {
                const vec2 u = draw.next2();
                const BsdfSample s = sample_bsdf(c.material, wo, u, draw.next());
                if (s.is_delta == 0u) continue;
                if (s.wi.z * wo.z > 0.0f) {
                    ASSERT_EQ(s.wi, vec3(-wo.x, -wo.y, wo.z));
                    reflected += 1, p_reflected = double{s.pdf};
                } else {
                    // Snell's law: sines in proportion of the indices
                    ASSERT_NEAR(s.wi.x * s.eta, -wo.x, 2e-6f * s.eta);
                    ASSERT_NEAR(s.wi.y * s.eta, -wo.y, 2e-6f * s.eta);
                    refracted += 1, p_refracted = double{s.pdf};
                }
            }
            for (const auto& [count, p] : {std::pair{reflected, p_reflected}, std::pair{refracted, p_refracted}}) {
                const double deviation = std::sqrt(std::max(n * p * (1 - p), 1e-3));
                EXPECT_GE(normal_p((count - n * p) / deviation), significance()) << count / n << " for " << p;
            }
            if (c.material.kind == material_dielectric) {
                EXPECT_NEAR(p_refracted, 1.0 - double{split_dielectric(wo.z, 1.5f).reflectance}, 1e-6);
            }
        }
}

} // namespace
} // namespace snell::test

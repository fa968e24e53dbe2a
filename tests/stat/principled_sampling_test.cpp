// sample_principled against pdf_principled, and what the principled surface is in cases that are known otherwise.
#include "snell/kernel/bsdf.h"
#include "tests/stat/direction_bins.h"
#include "tests/stat/principled_cases.h"

namespace snell::test {
namespace {

std::string describe(const PrincipledCase& c, vec3 wo)
{
    return fmt::format("{}, wo {} {} {}", c.name, wo.x, wo.y, wo.z);
}

std::vector<vec3> outgoing()
{
    return {direction_of(1.0f, 0.0f),  direction_of(0.7f, 2.0f),   direction_of(0.2f, 4.0f),
            direction_of(0.03f, 1.0f), direction_of(-0.85f, 3.0f), direction_of(-0.3f, 5.0f)};
}

void check_density(const PrincipledCase& c, vec3 wo, const DirectionBins& bins, std::uint64_t stream, int count)
{
    SCOPED_TRACE(describe(c, wo));
    const PrincipledPoint p = resolve(c.point, wo);
    if (!principled_has_smooth_part(p)) return;
    Draw draw(stream);
    expect_density(
        bins, [&](vec3 wi) { return double{pdf_principled(p, wo, wi)}; },
        [&] {
            const vec2 u = draw.next2();
            const BsdfSample s = sample_principled(p, wo, u, draw.next());
            return s.pdf > 0.0f && s.is_delta == 0u ? s.wi : vec3(0.0f);
        },
        count);
}

// Delta parts and samples below the surface are what the density lacks.
TEST(HeavyPrincipledSampling, DirectionsFollowTheDensity)
{
    const int count = long_tests() ? 500'000 : 30'000;
    std::uint64_t stream = 2000;
    for (const float roughness : {0.0f, 0.5f, 0.85f})
        for (const PrincipledCase& c : coloured_cases(roughness)) {
            // needles that no quadrature finds: NarrowLobesFollowTheDensity looks closer
            if (c.point.anisotropy > 0.0f && roughness == 0.0f) continue;
            const std::vector<vec3> all = outgoing();
            for (std::size_t i = 0; i < all.size(); ++i) {
                ++stream;
                // of all pairs a third, another one each time
                if (!long_tests() && stream % 3 != 0) continue;
                // what is not smooth here is Lambert's, sheen's or a coat's of alpha 0.1 and more
                check_density(c, all[i], DirectionBins(vec3(0.0f, 0.0f, 1.0f), 16, 24), stream, count);
            }
        }
}

// Narrow lobes: cells around the mirror direction, or around the refracted one.
TEST(HeavyPrincipledSampling, NarrowLobesFollowTheDensity)
{
    const vec3 up(0.0f, 0.0f, 1.0f);
    const int count = long_tests() ? 500'000 : 50'000;
    std::uint64_t stream = 2500;
    for (const float roughness : {0.1f, 0.2f}) {
        PrincipledPoint metal = plain_principled_point(roughness * roughness);
        metal.metallic = 1.0f;
        PrincipledPoint brushed = metal;
        brushed.anisotropy = 0.1f;
        for (const vec3 wo : {direction_of(0.8f, 1.0f), direction_of(-0.4f, 2.0f)}) {
            const vec3 mirrored(-wo.x, -wo.y, wo.z);
            check_density({"narrow metal", metal}, wo, DirectionBins(mirrored, 28, 24, 5), ++stream, count);
            check_density({"brushed metal", brushed}, wo, DirectionBins(mirrored, 28, 24, 5), ++stream, count);
            PrincipledPoint glass = glass_point(1.5f, roughness);
            glass.specular = 0.0f; // refraction alone; from inside there is still reflection
            const DielectricSplit split = split_dielectric(wo.z, 1.5f);
            if (split.reflectance < 1.0f)
                check_density({"narrow glass", glass}, wo, DirectionBins(refract_direction(wo, up, split), 28, 24, 5),
                              ++stream, count);
        }
    }
}

TEST(PrincipledSampling, WeightPdfAndEvalBelongTogether)
{
    Draw draw(2600);
    for (const float roughness : {0.0f, 0.05f, 0.3f, 1.0f})
        for (const PrincipledCase& c : coloured_cases(roughness))
            for (const vec3& wo : outgoing()) {
                SCOPED_TRACE(describe(c, wo));
                const PrincipledPoint p = resolve(c.point, wo);
                for (int i = 0; i < 100; ++i) {
                    const vec2 u = draw.next2();
                    const BsdfSample s = sample_principled(p, wo, u, draw.next());
                    if (s.pdf == 0.0f) continue;
                    ASSERT_TRUE(s.pdf > 0.0f && is_finite(s.pdf) && is_finite3(s.weight)) << s.pdf;
                    ASSERT_NEAR(length(s.wi), 1.0f, 1e-5f);
                    ASSERT_TRUE(s.weight.x >= 0.0f && s.weight.y >= 0.0f && s.weight.z >= 0.0f);
                    if (s.is_delta != 0u) {
                        ASSERT_LE(s.pdf, 1.0001f);
                        continue;
                    }
                    const float pdf = pdf_principled(p, wo, s.wi);
                    const vec3 f = eval_principled(p, wo, s.wi);
                    ASSERT_NEAR(s.pdf, pdf, 1e-4f * s.pdf);
                    for (int a = 0; a < 3; ++a) ASSERT_NEAR(s.weight[a] * s.pdf, f[a], 1e-4f * f[a] + 1e-9f);
                    // no sample is worth much more than all light there is
                    ASSERT_LT(max3(s.weight) * s.eta * s.eta, 40.0f);
                }
            }
}

// Where eval is not 0, sampling must be able to go.
TEST(PrincipledSampling, DensityCoversTheBsdf)
{
    Draw draw(2601);
    int above = 0, below = 0;
    for (int k = 0; k < 3000; ++k) {
        const PrincipledPoint given = random_principled_point(draw);
        const vec3 wo = draw.direction();
        const PrincipledPoint p = resolve(given, wo);
        for (int i = 0; i < 20; ++i) {
            const vec3 wi = draw.direction();
            const vec3 f = eval_principled(p, wo, wi);
            const float pdf = pdf_principled(p, wo, wi);
            ASSERT_TRUE(is_finite3(f) && is_finite(pdf) && pdf >= 0.0f && min(f.x, min(f.y, f.z)) >= 0.0f) << k;
            if (max3(f) > 0.0f) {
                ASSERT_GT(pdf, 0.0f) << k;
                (wo.z * wi.z > 0.0f ? above : below) += 1;
            }
            if (!principled_has_smooth_part(p)) {
                ASSERT_TRUE(max3(f) == 0.0f && pdf == 0.0f) << k;
            }
        }
    }
    EXPECT_GT(above, 15'000);
    EXPECT_GT(below, 3'000);
}

TEST(PrincipledSampling, NothingIsInfiniteOrNoNumber)
{
    Draw draw(2602);
    const float heights[] = {1.0f, 0.3f, 1e-2f, 1e-4f, 1e-6f, 1e-8f, 1e-20f, 1e-39f};
    int samples = 0;
    for (int k = 0; k < 20'000; ++k) {
        PrincipledPoint given = random_principled_point(draw);
        if (k % 5 == 0) given.ior = std::pow(10.0f, 60.0f * (draw.next() - 0.5f));
        if (k % 7 == 0) given.iridescence_thickness = std::pow(10.0f, 60.0f * (draw.next() - 0.5f));
        vec3 wo = draw.direction();
        if (k % 2 == 0) wo = normalize(vec3(wo.x, wo.y, 0.0f)) + vec3(0.0f, 0.0f, heights[k / 2 % 8]);
        wo = normalize(wo);
        if (k % 3 == 0) wo.z = -wo.z;
        if (wo.z == 0.0f) continue;
        const PrincipledPoint p = resolve(given, wo);
        const float total = p.p_coat + p.p_sheen + p.p_facets + p.p_straight + p.p_diffuse + p.p_through;
        ASSERT_TRUE(total == 0.0f || std::abs(total - 1.0f) < 1e-5f) << k << " " << total;
        const vec3 albedo = principled_albedo(p);
        ASSERT_TRUE(is_finite3(albedo) && min(albedo.x, min(albedo.y, albedo.z)) >= 0.0f && max3(albedo) <= 1.0f) << k;
        for (int i = 0; i < 10; ++i) {
            vec2 u = draw.next2();
            if (i == 0) u = vec2(0.0f);
            if (i == 1) u = vec2(1.0f - 0x1p-24f);
            const BsdfSample s = sample_principled(p, wo, u, i == 2 ? 1.0f - 0x1p-24f : draw.next());
            ASSERT_TRUE(s.pdf >= 0.0f && is_finite(s.pdf)) << k << " pdf " << s.pdf;
            if (s.pdf == 0.0f) continue;
            ++samples;
            ASSERT_TRUE(is_finite3(s.weight) && is_finite3(s.wi) && is_finite(s.eta)) << k;
            const vec3 f = eval_principled(p, wo, s.wi);
            ASSERT_TRUE(is_finite3(f)) << k;
        }
    }
    EXPECT_GT(samples, 100'000);
}

// --- What it is in cases known otherwise ---------------------------------------------------------------------------

TEST(PrincipledKnown, SmoothWhiteMetalIsAMirror)
{
    PrincipledPoint given = plain_principled_point(0.0f);
    given.metallic = 1.0f;
    for (const vec3& wo : outgoing()) {
        const PrincipledPoint p = resolve(given, wo);
        const BsdfSample s = sample_principled(p, wo, vec2(0.3f, 0.7f), 0.5f);
        EXPECT_EQ(s.is_delta, 1u);
        EXPECT_EQ(s.wi, vec3(-wo.x, -wo.y, wo.z));
        EXPECT_NEAR(s.pdf, 1.0f, 1e-6f);
        EXPECT_NEAR(s.weight.y, 1.0f, 1e-6f);
        EXPECT_FALSE(principled_has_smooth_part(p));
    }
}

// A solid's smooth surface is the dielectric of bsdf.h: same directions, same radiance, same probabilities.
TEST(PrincipledKnown, SmoothGlassIsTheDielectric)
{
    MaterialPoint m{};
    m.kind = material_dielectric;
    m.base_color = vec3(1.0f);
    Draw draw(2610);
    for (const float ior : {0.7f, 1.05f, 1.5f, 2.4f})
        for (const vec3& wo : outgoing()) {
            m.ior = ior;
            const PrincipledPoint p = resolve(glass_point(ior, 0.0f), wo);
            for (int i = 0; i < 20; ++i) {
                const float u = draw.next();
                const BsdfSample s = sample_principled(p, wo, vec2(0.5f), u);
                const BsdfSample t = sample_smooth_dielectric(m, wo, u);
                ASSERT_EQ(s.is_delta, 1u);
                ASSERT_NEAR(length(s.wi - t.wi), 0.0f, 1e-6f) << ior << " " << wo.z << " " << u;
                ASSERT_NEAR(s.pdf, t.pdf, 2e-6f);
                ASSERT_NEAR(s.weight.x, t.weight.x, 2e-5f * t.weight.x);
                ASSERT_EQ(s.eta, t.eta);
            }
        }
}

// Rough glass is Walter's but for the gain.
TEST(PrincipledKnown, RoughGlassIsTheDielectricTimesAGain)
{
    MaterialPoint m{};
    m.kind = material_dielectric;
    m.base_color = vec3(1.0f);
    Draw draw(2611);
    for (const float ior : {1.33f, 2.4f})
        for (const float roughness : {0.3f, 0.9f})
            for (const vec3& wo : outgoing()) {
                m.ior = ior;
                m.alpha = roughness * roughness;
                const PrincipledPoint p = resolve(glass_point(ior, roughness), wo);
                const float gain = p.glass_weight.x;
                ASSERT_GE(gain, 0.996f);
                for (int i = 0; i < 200; ++i) {
                    const vec3 wi = draw.direction();
                    const float expected = gain * eval_rough_dielectric(m, wo, wi).x;
                    ASSERT_NEAR(eval_principled(p, wo, wi).x, expected, 1e-3f * expected + 1e-6f);
                }
            }
}

// Without reflection of its own the opaque body is Lambert's.
TEST(PrincipledKnown, WithoutSpecularItIsLambert)
{
    PrincipledPoint given = plain_principled_point(0.25f);
    given.specular = 0.0f;
    given.base_color = vec3(0.2f, 0.5f, 0.8f);
    Draw draw(2612);
    for (const vec3& wo : outgoing()) {
        const PrincipledPoint p = resolve(given, wo);
        for (int i = 0; i < 100; ++i) {
            const vec3 wi = draw.direction();
            for (int a = 0; a < 3; ++a)
                ASSERT_NEAR(eval_principled(p, wo, wi)[a], eval_lambert(given.base_color, wo, wi)[a], 1e-6f);
        }
        given.diffuse_transmission = 1.0f;
        given.diffuse_transmission_color = given.base_color;
        const PrincipledPoint through = resolve(given, wo);
        given.diffuse_transmission = 0.0f;
        const vec3 wi = draw.direction(), mirrored(wi.x, wi.y, -wi.z);
        ASSERT_EQ(eval_principled(through, wo, mirrored), eval_principled(p, wo, wi)) << "the same, on the other side";
    }
}

// Thin glass sends the mirror image of its reflection through, and light of the smooth one goes straight on.
TEST(PrincipledKnown, ThinGlass)
{
    const vec3 wo = direction_of(0.6f, 1.0f);
    PrincipledPoint given = plain_principled_point(0.0f);
    given.transmission = 1.0f;
    given.base_color = vec3(0.9f, 0.5f, 0.2f);
    const BsdfSample s = sample_principled(resolve(given, wo), wo, vec2(0.5f), 0.99f);
    EXPECT_EQ(s.wi, -wo);
    EXPECT_EQ(s.eta, 1.0f);
    const float f = 0.04f + 0.96f * std::pow(0.4f, 5.0f); // Schlick
    EXPECT_NEAR(s.weight.x * s.pdf, 0.9f * (1 - f), 1e-5f);
    EXPECT_NEAR(s.weight.z * s.pdf, 0.2f * (1 - f), 1e-5f);

    given.alpha = 0.3f;
    given.specular = 0.0f;
    const PrincipledPoint through = resolve(given, wo);
    given.metallic = 1.0f;
    given.base_color = vec3(1.0f);
    const PrincipledPoint metal = resolve(given, wo);
    Draw draw(2613);
    for (int i = 0; i < 200; ++i) {
        const vec3 wi = draw.direction();
        const float g = eval_principled(metal, wo, vec3(wi.x, wi.y, std::abs(wi.z))).x;
        EXPECT_NEAR(eval_principled(through, wo, wi).x, wi.z < 0.0f ? 0.9f * g : 0.0f, 1e-5f * (1 + g));
    }
}

TEST(PrincipledKnown, DispersionSpreadsTheIndex)
{
    EXPECT_EQ(dispersed_ior(1.5f, 0.0f), vec3(1.5f));
    // KHR_materials_dispersion: n_F - n_C = (n_d - 1) / V, 20 / V given
    const vec3 n = dispersed_ior(1.5f, 20.0f / 55.0f);
    EXPECT_NEAR(n.z - n.x, 0.5f / 55.0f, 1e-6f);
    EXPECT_EQ(n.y, 1.5f);
}

// A film of no thickness is none; one of 300 nm on glass is coloured; a thick one is grey again.
TEST(PrincipledKnown, Films)
{
    const vec3 base(0.04f);
    const vec3 none_there = film_reflectance(1.0f, 1.4f, 0.0f, base);
    const vec3 thin = film_reflectance(1.0f, 1.9f, 300.0f, base);
    const vec3 thick = film_reflectance(1.0f, 1.9f, 20'000.0f, base);
    EXPECT_NEAR(none_there.x, 0.04f, 1e-4f);
    EXPECT_NEAR(none_there.z, 0.04f, 1e-4f);
    EXPECT_GT(max3(thin) - min(thin.x, min(thin.y, thin.z)), 0.05f);
    EXPECT_LT(max3(thick) - min(thick.x, min(thick.y, thick.z)), 1e-3f);
    // without interference, two interfaces in series: r + t^2 s / (1 - r s)
    const double r = std::pow(0.9 / 2.9, 2), s = std::pow((1.5 - 1.9) / 3.4, 2);
    EXPECT_NEAR(thick.y, r + (1 - r) * (1 - r) * s / (1 - r * s), 1e-3);
    // a quarter wave of 550 nm in a film of sqrt(1.5) on glass of 1.5: hardly any green comes back
    EXPECT_LT(film_reflectance(1.0f, std::sqrt(1.5f), 550.0f / 4 / std::sqrt(1.5f), base).y, 0.004f);
}

} // namespace
} // namespace snell::test

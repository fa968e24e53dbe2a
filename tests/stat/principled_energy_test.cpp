// The principled surface and energy: where nothing absorbs, all light returns.
#include "tests/stat/principled_cases.h"

#include <cmath>
#include <map>

namespace snell::test {
namespace {

double energy_of(const BsdfSample& s)
{
    // refraction's scaling of radiance by 1 / eta^2 is no loss of energy
    return s.pdf > 0.0f ? double{mean3(s.weight)} * double{s.eta} * double{s.eta} : 0.0;
}

// What returns to wo of light of 1 from everywhere: a weighted mean of samples. Each lobe gets all points of a
// Fibonacci lattice, and of the facets both what reflects and what refracts, so that little noise is left.
double returned(const PrincipledPoint& point, vec3 wo, int count, int step)
{
    const PrincipledPoint p = resolve(point, wo);
    const vec3 upper(wo.x, wo.y, std::abs(wo.z));
    const float probabilities[] = {p.p_coat, p.p_sheen, p.p_facets, p.p_straight, p.p_diffuse, p.p_through};
    const auto drawn = [&](vec2 u, float u_lobe) {
        return energy_of(sample_principled(p, wo, u, min(u_lobe, 1.0f - 0x1p-24f)));
    };
    double sum = 0;
    float start = 0.0f;
    for (const float& chosen : probabilities) {
        for (int i = 0; i < count && chosen > 0.0f; ++i) {
            const double q = (i + 0.5) / count;
            const vec2 u(static_cast<float>(q * q * (3 - 2 * q)),
                         static_cast<float>(std::fmod((static_cast<double>(i) * step + 0.25) / count, 1.0)));
            const double weight = 6 * q * (1 - q) / count * double{chosen};
            if (&chosen != &probabilities[2]) {
                sum += weight * drawn(u, start + 0.5f * chosen);
                continue;
            }
            vec3 h(0.0f, 0.0f, 1.0f);
            if (p.alphas.x > 0.0f)
                h = from_facet_frame(p, sample_anisotropic_visible(to_facet_frame(p, upper), p.alphas, u));
            const float r = split_facet(p, dot(upper, h)).p_reflected;
            if (r > 0.0f) sum += weight * double{r} * drawn(u, start + chosen * r * 0.5f);
            if (r < 1.0f) sum += weight * double{1.0f - r} * drawn(u, start + chosen * (0.5f + 0.5f * r));
        }
        start += chosen;
    }
    return sum;
}

struct Range
{
    double least = 2, most = 0;
    std::string where_least, where_most;
    void add(double x, const std::string& where)
    {
        if (x < least) least = x, where_least = where;
        if (x > most) most = x, where_most = where;
    }
};

std::vector<float> cosines()
{
    if (long_tests())
        return {0.05f, 0.06f, 0.08f, 0.1f, 0.15f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.75f, 0.8f, 0.9f, 1.0f};
    return {0.05f, 0.12f, 0.33f, 0.62f, 0.75f, 1.0f};
}

TEST(HeavyPrincipledEnergy, WhiteFurnaceKeepsAllLight)
{
    Range range;
    const int steps = long_tests() ? 25 : 10;
    for (int k = 0; k <= steps; ++k) {
        // not on the nodes of the tables
        const float roughness =
            (static_cast<float>(k) + (k > 0 && k < steps ? 0.3f : 0.0f)) / static_cast<float>(steps);
        for (const PrincipledCase& c : white_cases(roughness))
            for (const float z : cosines())
                for (const float side : {1.0f, -1.0f}) {
                    const vec3 wo = direction_of(side * z, 0.7f);
                    range.add(long_tests() ? returned(c.point, wo, 4181, 2584) : returned(c.point, wo, 1597, 987),
                              fmt::format("{}, cos {}", c.name, side * z));
                }
    }
    EXPECT_GE(range.least, 0.99) << range.where_least;
    EXPECT_LE(range.most, 1.001) << range.where_most;
    fmt::print("white furnace from {:.5f} ({}) to {:.5f} ({})\n", range.least, range.where_least, range.most,
               range.where_most);
}

// The table of anisotropy is coarse, and of anisotropic glass only bounds are known.
TEST(HeavyPrincipledEnergy, WhiteFurnaceWithAnisotropy)
{
    std::map<std::string, Range> ranges;
    for (const float roughness : {0.0f, 0.1f, 0.25f, 0.5f, 0.8f, 1.0f})
        for (const float strength : {0.2f, 0.5f, 0.7f, 1.0f})
            for (const float z : cosines())
                for (const float azimuth : {0.0f, 0.5f, 1.1f, 1.45f, 1.57f}) {
                    const vec3 wo = direction_of(z, azimuth);
                    const std::string where =
                        fmt::format("roughness {}, anisotropy {}, cos {}, azimuth {}", roughness, strength, z, azimuth);
                    PrincipledPoint p = plain_principled_point(roughness * roughness);
                    p.anisotropy = strength;
                    p.metallic = 1.0f;
                    ranges["metal"].add(returned(p, wo, 610, 377), where);
                    p.metallic = 0.0f;
                    ranges["opaque"].add(returned(p, wo, 610, 377), where);
                    p = glass_point(1.5f, roughness);
                    p.anisotropy = strength;
                    ranges["glass"].add(returned(p, wo, 610, 377), where);
                    ranges["glass"].add(returned(p, -wo, 610, 377), where);
                }
    for (const auto& [name, r] : ranges) {
        EXPECT_GE(r.least, name == "glass" ? 0.4 : 0.97) << name << " " << r.where_least;
        EXPECT_LE(r.most, name == "glass" ? 1.01 : 1.03) << name << " " << r.where_most;
        fmt::print("anisotropic {} from {:.4f} ({}) to {:.4f} ({})\n", name, r.least, r.where_least, r.most,
                   r.where_most);
    }
}

// Coloured surfaces absorb, and none returns more than it got, in any channel.
TEST(PrincipledEnergy, NothingReturnsMoreThanItGot)
{
    Draw draw(470);
    for (int k = 0; k < 300; ++k) {
        PrincipledPoint p = random_principled_point(draw);
        p.anisotropy = 0.0f;
        p.clearcoat_normal = vec3(0.0f, 0.0f, 1.0f);
        p.glass_table = none; // of the index it has, random as it is
        const vec3 wo = direction_of(0.05f + 0.95f * draw.next(), 1.0f);
        EXPECT_LE(returned(p, wo, 377, 233), 1.01) << k;
    }
}

// The albedo that denoisers are given is what returns, where no lobe's approximation is in it.
TEST(PrincipledEnergy, AlbedoIsWhatReturns)
{
    for (const float roughness : {0.0f, 0.4f, 0.9f})
        for (const char* kind : {"metal", "opaque", "sheen", "clearcoat"})
            for (const float z : {0.1f, 0.5f, 1.0f}) {
                PrincipledPoint p = plain_principled_point(roughness * roughness);
                p.base_color = vec3(0.3f, 0.6f, 0.9f);
                if (kind[0] == 'm') p.metallic = 1.0f;
                if (kind[0] == 's') p.sheen_color = vec3(0.5f), p.sheen_alpha = 0.2f;
                if (kind[0] == 'c') p.clearcoat = 1.0f, p.clearcoat_alpha = 0.1f;
                const vec3 wo = direction_of(z, 0.2f);
                EXPECT_NEAR(returned(p, wo, 1597, 987), double{mean3(principled_albedo(resolve(p, wo)))}, 0.002)
                    << kind << " " << roughness << " " << z;
            }
}

TEST(PrincipledEnergy, TablesAreTheSameAndShared)
{
    const std::vector<float> iors = {1.5f, 1.33f, 1.5f, std::nanf(""), 0.0f};
    const AlbedoTables t = albedo_tables(iors, false);
    EXPECT_EQ(t.values.size(), albedo_length + 2 * glass_tables_length);
    EXPECT_EQ(t.glass_table, (std::vector<uint>{albedo_length + glass_tables_length, albedo_length,
                                                albedo_length + glass_tables_length, none, none}));
    // 1.5 has the numbers that it has in the other set
    for (uint i = 0; i < glass_tables_length; ++i)
        ASSERT_EQ(t.values[t.glass_table[0] + i], tables().values[glass_table_of(1.5f) + i]);
    for (const float x : t.values) ASSERT_TRUE(std::isfinite(x));
}

TEST(HeavyPrincipledEnergy, ManyIndicesShareTables)
{
    std::vector<float> many;
    for (int i = 0; i < 20; ++i) many.push_back(1.1f + 0.002f * static_cast<float>(i));
    const AlbedoTables shared = albedo_tables(many, false);
    EXPECT_EQ(shared.values.size(), albedo_length + 16 * glass_tables_length);
    EXPECT_EQ(shared.glass_table.front(), albedo_length);
    EXPECT_EQ(shared.glass_table.back(), albedo_length + 15 * glass_tables_length);
    for (std::size_t i = 1; i < many.size(); ++i) EXPECT_GE(shared.glass_table[i], shared.glass_table[i - 1]);
}

} // namespace
} // namespace snell::test

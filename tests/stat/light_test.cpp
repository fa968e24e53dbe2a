// Light sampling: directions against pdf_light, solid angles in closed form, and the choice between lights.
#include "snell/kernel/intersect.h"
#include "snell/kernel/path.h"
#include "snell/scene/lights.h"
#include "tests/stat/direction_bins.h"

namespace snell::test {
namespace {

int draws()
{
    return long_tests() ? 1'000'000 : 200'000;
}

Light triangle_light(vec3 a, vec3 b, vec3 c, bool two_sided)
{
    Material material{};
    material.emission = vec3(1.0f, 2.0f, 3.0f);
    material.flags = two_sided ? material_two_sided_emission : 0u;
    return make_triangle_light(a, b, c, material, none, none);
}

Light sphere_light(vec3 center, float radius, bool two_sided)
{
    Material material{};
    material.emission = vec3(1.0f, 2.0f, 3.0f);
    material.flags = two_sided ? material_two_sided_emission : 0u;
    return make_sphere_light(center, radius, material, none, none);
}

// Solid angle of a triangle (Van Oosterom and Strackee 1983).
double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c)
{
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double numerator = glm::dot(a, glm::cross(b, c));
    const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::abs(std::atan2(numerator, denominator));
}

// Where a direction from a point meets the light, and the normal there: in double precision, by other means than the
// renderer's.
struct Meeting
{
    bool hit = false;
    vec3 point{0.0f}, normal{0.0f};
};

Meeting meet(const Light& light, vec3 from, vec3 direction)
{
    const glm::dvec3 o(from), d(direction);
    Meeting m;
    if (light.kind == light_triangle) {
        const glm::dvec3 a(light.position), e1(light.direction), e2(light.edge), n = glm::cross(e1, e2);
        const double along = glm::dot(d, n);
        if (along == 0 || (along > 0 && (light.flags & light_two_sided) == 0u)) return m;
        const double t = glm::dot(a - o, n) / along;
        const glm::dvec3 p = o + t * d;
        const double u = glm::dot(glm::cross(p - a, e2), n) / glm::dot(n, n);
        const double v = glm::dot(glm::cross(e1, p - a), n) / glm::dot(n, n);
        m.hit = t > 0 && u >= 0 && v >= 0 && u + v <= 1;
        m.point = vec3(p), m.normal = vec3(glm::normalize(n));
        return m;
    }
    const glm::dvec3 c(light.position);
    const double r = double{light.cos_inner}, b = glm::dot(c - o, d);
    const glm::dvec3 nearest = o + b * d - c;
    const double discriminant = r * r - glm::dot(nearest, nearest);
    if (discriminant <= 0) return m;
    const bool inside = glm::length(c - o) < r;
    const double t = b + (inside ? 1 : -1) * std::sqrt(discriminant);
    if (t <= 0 || (inside && (light.flags & light_two_sided) == 0u)) return m;
    const glm::dvec3 p = o + t * d;
    m.hit = true, m.point = vec3(p), m.normal = vec3(glm::normalize(p - c));
    return m;
}

struct Configuration
{
    std::string name;
    Light light;
    vec3 point;
    double reach; // 1 - cos of a cone around the light's middle that contains it; 2: everything
    int cuts = 3; // of the cells of directions, for the light's edges go through them
};

std::vector<Configuration> configurations()
{
    const vec3 a(-1.0f, 2.0f, -0.5f), b(1.0f, 2.0f, -0.7f), c(0.2f, 2.0f, 1.5f);
    const bool down = cross(b - a, c - a).y < 0.0f;
    const Light near_light = triangle_light(a, down ? b : c, down ? c : b, false);
    const Light both_sides = triangle_light(a, b, c, true);
    return {
        {"triangle, near", near_light, vec3(0.1f, 1.2f, 0.1f), 2},
        {"triangle, very near a corner", near_light, vec3(0.1f, 1.9f, 0.1f), 2},
        {"triangle, far", near_light, vec3(30.0f, -80.0f, 10.0f), 1e-3},
        {"triangle, grazing", near_light, vec3(4.0f, 1.7f, 0.1f), 0.1, 6},
        {"triangle, both sides, from above", both_sides, vec3(0.3f, 3.0f, 0.2f), 2},
        {"sphere, near", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1.0f, false), vec3(0.3f, 0.8f, 0.2f), 2},
        {"sphere, touching", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1.0f, false), vec3(0.0f, 0.98f, 0.0f), 2},
        {"sphere, far", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1.0f, false), vec3(100.0f, 50.0f, -30.0f), 2e-4},
        {"sphere, tiny", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1e-3f, false), vec3(3.0f, 0.0f, 0.0f), 2e-7},
        {"sphere, both sides, from inside", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1.0f, true), vec3(0.3f, 2.4f, 0.1f),
         2},
        {"sphere, both sides, from outside", sphere_light(vec3(0.0f, 2.0f, 0.0f), 1.0f, true), vec3(2.0f, 0.4f, 0.1f),
         2},
    };
}

vec3 middle(const Light& light)
{
    return light.kind == light_sphere ? light.position : light.position + (light.direction + light.edge) / 3.0f;
}

TEST(Light, DirectionsFollowTheDensity)
{
    std::uint64_t stream = 500;
    for (const Configuration& c : configurations()) {
        SCOPED_TRACE(c.name);
        Draw draw(stream++);
        // an axis beside the middle: the rings must not run along the edge of a sphere
        const vec3 axis = middle(c.light) - c.point;
        const float aside = c.reach < 2 ? 0.2f * std::sqrt(static_cast<float>(c.reach)) : 0.2f;
        const DirectionBins bins(normalize(axis) + aside * make_frame(normalize(axis)).s, 12, 16, 2, c.reach);
        expect_density(
            bins,
            [&](vec3 w) {
                const Meeting m = meet(c.light, c.point, w);
                return m.hit ? double{pdf_light(c.light, c.point, m.point, m.normal)} : 0.0;
            },
            [&] {
                const LightSample s = sample_light(c.light, c.point, draw.next2());
                return s.pdf > 0.0f ? s.direction : vec3(0.0f);
            },
            draws(), c.cuts);
    }
}

bool meets_itself(const Light& light, const Ray& ray)
{
    if (light.kind == light_sphere) return intersect_sphere(ray, light.position, light.cos_inner).ok;
    return intersect_triangle_watertight(ray, shear_ray(ray), light.position, light.position + light.direction,
                                         light.position + light.edge)
        .ok;
}

TEST(Light, SamplesAreConsistent)
{
    Draw draw(540);
    for (const Configuration& c : configurations()) {
        SCOPED_TRACE(c.name);
        int missed = 0;
        for (int i = 0; i < 5000; ++i) {
            const LightSample s = sample_light(c.light, c.point, draw.next2());
            if (s.pdf == 0.0f) continue;
            ASSERT_EQ(s.is_delta, 0u);
            ASSERT_EQ(s.is_infinite, 0u);
            ASSERT_NEAR(length(s.direction), 1.0f, 1e-5f);
            ASSERT_EQ(s.radiance, c.light.emission);
            // the target is where the direction leads, on the near side of the light
            const vec3 to = s.target - c.point;
            ASSERT_NEAR(length(cross(normalize(to), s.direction)), 0.0f, 3e-4f + 1e-4f / length(to))
                << "but for the offset";
            const Meeting m = meet(c.light, c.point, s.direction);
            if (!m.hit) { // at the rim, by rounding
                ++missed;
                continue;
            }
            ASSERT_FALSE(meets_itself(c.light, make_ray(c.point, to, 1.0f))) << "the shadow ray ends before the light";
            const float pdf = pdf_light(c.light, c.point, m.point, m.normal);
            ASSERT_NEAR(s.pdf, pdf, 0.01f * pdf) << "both techniques must agree on the density";
        }
        EXPECT_LT(missed, 50);
    }
}

// The mean of 1 / pdf is the solid angle: known in closed form.
TEST(Light, SolidAngles)
{
    std::uint64_t stream = 560;
    for (const Configuration& c : configurations()) {
        SCOPED_TRACE(c.name);
        Draw draw(stream++);
        double exact;
        if (c.light.kind == light_triangle) {
            const glm::dvec3 a = glm::dvec3(c.light.position) - glm::dvec3(c.point);
            exact = solid_angle(a, a + glm::dvec3(c.light.direction), a + glm::dvec3(c.light.edge));
        } else {
            const double s = double{c.light.cos_inner} / glm::length(glm::dvec3(c.light.position - c.point));
            exact = s > 1 ? 4 * std::numbers::pi : 2 * std::numbers::pi * s * s / (1 + std::sqrt(1 - s * s));
        }
        double sum = 0, squares = 0;
        for (int i = 0; i < draws(); ++i) {
            const LightSample s = sample_light(c.light, c.point, draw.next2());
            const double x = s.pdf > 0.0f ? 1 / double{s.pdf} : 0;
            sum += x, squares += x * x;
        }
        const double n = draws(), mean = sum / n;
        const double error = std::sqrt(std::max(squares / n - mean * mean, 0.0) / n);
        EXPECT_NEAR(mean, exact, 4 * error + 2e-5 * exact);
    }
}

TEST(Light, OneSidedLightsAreDarkFromBehind)
{
    Draw draw(580);
    const Light triangle = triangle_light(vec3(0.0f), vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f), false); // +z
    const Light sphere = sphere_light(vec3(0.0f), 1.0f, false);
    for (int i = 0; i < 1000; ++i) {
        EXPECT_EQ(sample_light(triangle, vec3(0.2f, 0.2f, -1.0f), draw.next2()).pdf, 0.0f);
        EXPECT_GT(sample_light(triangle, vec3(0.2f, 0.2f, 1.0f), draw.next2()).pdf, 0.0f);
        EXPECT_EQ(sample_light(sphere, vec3(0.2f, 0.2f, -0.3f), draw.next2()).pdf, 0.0f);
    }
    // what light sampling cannot draw, it must not claim to: the other technique would be weighed down
    EXPECT_EQ(pdf_light(sphere, vec3(0.2f, 0.2f, -0.3f), vec3(0.0f, 0.0f, 1.0f), vec3(0.0f, 0.0f, 1.0f)), 0.0f);
}

// Next to the surface of a sphere light, outside: half of all directions see it.
TEST(Light, SphereAtItsSurface)
{
    Draw draw(581);
    const Light sphere = sphere_light(vec3(0.0f), 1.0f, false);
    for (const float gap : {1e-2f, 1e-4f, 2e-5f, 4e-6f}) {
        const vec3 point(0.0f, 0.0f, 1.0f + gap);
        double sum = 0;
        constexpr int n = 1000;
        for (int i = 0; i < n; ++i) {
            const LightSample s = sample_light(sphere, point, draw.next2());
            ASSERT_GT(s.pdf, 0.0f) << "gap " << gap;
            sum += 1 / double{s.pdf} / n;
            ASSERT_NEAR(pdf_light(sphere, point, s.target, normalize(s.target)), s.pdf, 1e-3f * s.pdf);
        }
        const double s = 1 / double{point.z};
        EXPECT_NEAR(sum, 2 * std::numbers::pi * (1 - std::sqrt(1 - s * s)), 1e-4) << "gap " << gap;
    }
}

TEST(Light, PointSpotAndDirectional)
{
    LightDesc desc;
    desc.position = vec3(1.0f, 4.0f, 2.0f);
    desc.emission = vec3(10.0f, 20.0f, 30.0f);
    const vec3 point(1.0f, 1.0f, -2.0f);
    LightSample s = sample_light(make_light(desc), point, vec2(0.3f, 0.4f));
    EXPECT_EQ(s.is_delta, 1u);
    EXPECT_EQ(s.pdf, 1.0f);
    EXPECT_NEAR(s.radiance.y, 20.0f / 25.0f, 1e-6f) << "inverse square";
    EXPECT_NEAR(length(s.direction - vec3(0.0f, 0.6f, 0.8f)), 0.0f, 1e-6f);
    EXPECT_EQ(s.target, desc.position);
    EXPECT_EQ(sample_light(make_light(desc), desc.position, vec2(0.0f)).pdf, 0.0f) << "at the light itself";

    desc.kind = light_directional;
    desc.direction = vec3(0.0f, -2.0f, 0.0f);
    s = sample_light(make_light(desc), point, vec2(0.3f, 0.4f));
    EXPECT_EQ(s.is_infinite, 1u);
    EXPECT_EQ(s.direction, vec3(0.0f, 1.0f, 0.0f));
    EXPECT_EQ(s.radiance, desc.emission);

    desc.kind = light_spot;
    desc.position = vec3(0.0f);
    desc.direction = vec3(0.0f, -1.0f, 0.0f);
    desc.inner_degrees = 20.0f;
    desc.outer_degrees = 40.0f;
    const Light spot = make_light(desc);
    float before = 1.0f;
    for (int degrees = 0; degrees < 90; ++degrees) {
        const float a = static_cast<float>(degrees) * 0.01745329252f;
        s = sample_light(spot, 2.0f * vec3(std::sin(a), -std::cos(a), 0.0f), vec2(0.0f));
        const float fraction = s.radiance.x / (10.0f / 4.0f);
        if (degrees < 20) {
            EXPECT_NEAR(fraction, 1.0f, 1e-5f) << degrees;
        }
        if (degrees > 40) {
            EXPECT_EQ(fraction, 0.0f) << degrees;
        }
        EXPECT_LE(fraction, before + 1e-6f) << "no ripples";
        EXPECT_GE(fraction, before - 0.15f) << "no steps";
        before = fraction;
    }
}

// A view with lights and nothing else.
struct LightList
{
    std::vector<Light> lights;
    SceneView view{};

    explicit LightList(const std::vector<double>& powers) : lights(powers.size(), Light{})
    {
        build_alias_table(lights, powers);
        view.lights.at = lights.data();
        view.light_count = static_cast<uint>(lights.size());
    }
};

TEST(Light, ChoiceFollowsThePowers)
{
    Draw draw(590);
    std::vector<double> many(1000);
    for (double& power : many) power = std::exp(double{draw.between(-6.0f, 6.0f)});
    const std::vector<std::vector<double>> lists = {
        {1}, {1, 1}, {1, 3}, {0, 1, 2}, {5, 0, 0, 5, 1e-3}, {0, 0, 0}, {1e-30, 1e-30, 2e-30}, {1, 1e9}, many};
    for (const std::vector<double>& powers : lists) {
        SCOPED_TRACE(testing::Message() << powers.size() << " lights, the first " << powers[0]);
        const LightList list(powers);
        const double total = std::accumulate(powers.begin(), powers.end(), 0.0);
        std::vector<double> expected, observed(powers.size(), 0.0);
        double sum = 0;
        for (std::size_t i = 0; i < powers.size(); ++i) {
            const double p = double{list.lights[i].select_pdf};
            const double wanted = total > 0 ? powers[i] / total : 1 / static_cast<double>(powers.size());
            EXPECT_NEAR(p, wanted, 1e-6 * wanted + 1e-7) << i;
            if (total > 0 && powers[i] == 0) {
                EXPECT_EQ(p, 0.0) << i;
            }
            sum += p;
            expected.push_back(p * draws());
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        for (int i = 0; i < draws(); ++i) observed[select_light(list.view, draw.next())] += 1;
        const ChiSquare test = chi_square(observed, expected);
        EXPECT_GE(test.p, significance()) << test.statistic << " / " << test.degrees;
        // the ends of the interval
        EXPECT_LT(select_light(list.view, 0.0f), powers.size());
        EXPECT_LT(select_light(list.view, 0.99999994f), powers.size());
        EXPECT_GT(list.lights[select_light(list.view, 0.0f)].select_pdf, 0.0f);
        EXPECT_GT(list.lights[select_light(list.view, 0.99999994f)].select_pdf, 0.0f);
    }
}

TEST(Light, EnvironmentIsUniform)
{
    Draw draw(595);
    SceneView view = {};
    view.environment.radiance = vec3(2.0f);
    view.environment.texture = none;
    expect_density(
        DirectionBins(normalize(vec3(1.0f, 1.0f, 0.2f)), 16, 24), [](vec3) { return double{pdf_uniform_sphere()}; },
        [&] {
            const LightSample s = sample_environment(view, draw.next2());
            EXPECT_EQ(s.is_infinite, 1u);
            EXPECT_EQ(s.pdf, pdf_uniform_sphere());
            return s.direction;
        },
        draws());
}

} // namespace
} // namespace snell::test

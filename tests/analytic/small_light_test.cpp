// Lights without area: what they do is known exactly, and both integrators must do it.
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

// A floor of albedo 0.6 that is seen at the origin.
Scene floor_scene()
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.6f));
    look(scene, vec3(-1.5f, 0.8f, 2.0f), vec3(0.0f), 1e-4f);
    return scene;
}

void expect_exactly(const Scene& scene, double irradiance, uint spp = 4)
{
    for (const char* integrator : {"path", "whitted"}) {
        SCOPED_TRACE(integrator);
        expect_value(measure(scene, probe_settings(integrator, {}, spp)), 0.6 / pi_d * irradiance, 1e-5);
    }
}

TEST(PointLight, InverseSquareAndCosine)
{
    for (const vec3& p :
         {vec3(0.0f, 1.0f, 0.0f), vec3(0.0f, 2.0f, 0.0f), vec3(3.0f, 0.5f, -1.0f), vec3(40.0f, 90.0f, 7.0f)}) {
        SCOPED_TRACE(testing::Message() << p.x << " " << p.y << " " << p.z);
        Scene scene = floor_scene();
        add_point_light(scene, p, 10.0f);
        const glm::dvec3 d(p);
        expect_exactly(scene, 10 * d.y / std::pow(glm::length(d), 3));
    }
}

TEST(PointLight, FromBelowNothing)
{
    Scene scene = floor_scene();
    add_point_light(scene, vec3(0.0f, -1.0f, 0.0f), 10.0f);
    expect_exactly(scene, 0);
}

TEST(PointLight, CastsShadows)
{
    Scene scene = floor_scene();
    add_point_light(scene, vec3(0.0f, 4.0f, 0.0f), 10.0f);
    Scene beyond = scene, between = scene;
    add_sphere(between, vec3(0.0f, 2.0f, 0.0f), 0.1f, diffuse(between, 0.0f));
    add_sphere(beyond, vec3(0.0f, 6.0f, 0.0f), 1.0f, diffuse(beyond, 0.0f));
    expect_exactly(between, 0);
    expect_exactly(beyond, 10.0 / 16);
}

// The choice between lights must not show in the mean; Whitted asks them all.
TEST(PointLight, Several)
{
    Scene scene = floor_scene();
    add_point_light(scene, vec3(0.0f, 1.0f, 0.0f), 1.0f);
    add_point_light(scene, vec3(0.0f, 2.0f, 0.0f), 100.0f);
    add_point_light(scene, vec3(0.0f, -2.0f, 0.0f), 50.0f);
    LightDesc sun;
    sun.kind = light_directional;
    sun.direction = vec3(0.0f, -1.0f, 0.0f);
    sun.emission = vec3(2.0f);
    add(scene, sun);
    const double exact = 0.6 / pi_d * (1 + 25 + 2);
    expect_value(measure(scene, probe_settings("whitted", {}, 4)), exact, 1e-6);
    expect_value(measure(scene, probe_settings("path")), exact);
    expect_value(measure(scene, probe_settings("path", {{"mis", "0"}})), exact);
}

TEST(DirectionalLight, Cosine)
{
    for (const vec3& d : {vec3(0.0f, -1.0f, 0.0f), vec3(3.0f, -4.0f, 0.0f), vec3(0.1f, -0.02f, 5.0f)}) {
        Scene scene = floor_scene();
        LightDesc sun;
        sun.kind = light_directional;
        sun.direction = d;
        sun.emission = vec3(3.0f);
        add(scene, sun);
        expect_exactly(scene, 3 * -double{d.y} / double{length(d)});
    }
}

TEST(SpotLight, ConesAndWhatIsBetween)
{
    for (const double degrees : {0.0, 19.0, 24.0, 30.0, 37.0, 41.0, 80.0}) {
        SCOPED_TRACE(testing::Message() << degrees << " degrees off the axis");
        const double a = degrees * pi_d / 180;
        Scene scene = floor_scene();
        LightDesc spot;
        spot.kind = light_spot;
        spot.position = vec3(0.0f, 2.0f, 0.0f);
        spot.direction = vec3(static_cast<float>(std::sin(a)), static_cast<float>(-std::cos(a)), 0.0f);
        spot.emission = vec3(8.0f);
        spot.inner_degrees = 20.0f;
        spot.outer_degrees = 40.0f;
        add(scene, spot);
        const double outer = std::cos(40 * pi_d / 180), inner = std::cos(20 * pi_d / 180);
        const double x = std::clamp((std::cos(a) - outer) / (inner - outer), 0.0, 1.0);
        expect_exactly(scene, 8.0 / 4 * x * x * (3 - 2 * x));
    }
}

// Light on the back of a surface of two sides: the eye is there as well.
TEST(PointLight, LambertOnBothSides)
{
    Scene scene = floor_scene();
    look(scene, vec3(-1.5f, -0.8f, 2.0f), vec3(0.0f), 1e-4f);
    add_point_light(scene, vec3(0.0f, -2.0f, 0.0f), 10.0f);
    expect_exactly(scene, 10.0 / 4);
}

} // namespace
} // namespace snell::test

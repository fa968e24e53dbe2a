// Glass: Fresnel's plate, absorption over a known way, and that no light gets lost.
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

// Reflectance of an interface in the textbook's form, with angles: (sin^2(a - b) / sin^2(a + b) + tan^2(..) /
// tan^2(..)) / 2.
double fresnel(double angle, double ior)
{
    if (angle == 0) return std::pow((ior - 1) / (ior + 1), 2);
    const double t = std::asin(std::sin(angle) / ior);
    return 0.5 * (std::pow(std::sin(angle - t) / std::sin(angle + t), 2) +
                  std::pow(std::tan(angle - t) / std::tan(angle + t), 2));
}

// A plate of glass between two glowing walls, seen under an angle: dark behind and bright before it shows what is
// reflected, the other way round what passes.
struct Plate
{
    double degrees, ior, thickness, absorption;
};

Scene plate_scene(const Plate& p, float behind, float before)
{
    Scene scene;
    const auto t = static_cast<float>(p.thickness);
    const Index<MaterialDesc> material = glass(scene, static_cast<float>(p.ior), static_cast<float>(p.absorption));
    add_plane(scene, vec3(0.0f), vec3(0.0f, 0.0f, 1.0f), material);
    add_plane(scene, vec3(0.0f, 0.0f, -t), vec3(0.0f, 0.0f, -1.0f), material);
    add_plane(scene, vec3(0.0f, 0.0f, -5.0f), vec3(0.0f, 0.0f, 1.0f), diffuse(scene, 0.0f, behind));
    add_plane(scene, vec3(0.0f, 0.0f, 5.0f), vec3(0.0f, 0.0f, -1.0f), diffuse(scene, 0.0f, before));
    const auto a = static_cast<float>(p.degrees * std::numbers::pi / 180);
    look(scene, 3.0f * vec3(std::sin(a), 0.0f, std::cos(a)), vec3(0.0f), 1e-4f);
    return scene;
}

const Plate plates[] = {{0, 1.5, 0.3, 0},    {45, 1.5, 0.3, 0},   {75, 1.5, 0.3, 0},   {0, 1.5, 0.7, 1.3},
                        {60, 1.5, 0.7, 1.3}, {30, 2.4, 0.2, 0.5}, {56.31, 1.5, 1, 0.2}};

TEST(Glass, PlateReflectsAndTransmits)
{
    for (const Plate& p : plates) {
        SCOPED_TRACE(testing::Message() << p.degrees << " degrees, index " << p.ior << ", absorption " << p.absorption);
        const double a = p.degrees * std::numbers::pi / 180, r = fresnel(a, p.ior);
        const double way = p.thickness / std::cos(std::asin(std::sin(a) / p.ior));
        const double t = std::exp(-p.absorption * way); // of one passage
        // any number of reflections inside
        const double transmitted = (1 - r) * (1 - r) * t / (1 - r * r * t * t);
        const double reflected = r + (1 - r) * (1 - r) * r * t * t / (1 - r * r * t * t);
        for (const bool see_through : {true, false}) {
            const Scene scene = plate_scene(p, see_through ? 1.0f : 0.0f, see_through ? 0.0f : 1.0f);
            const double exact = see_through ? transmitted : reflected;
            SCOPED_TRACE(see_through ? "transmitted" : "reflected");
            expect_value(measure(scene, probe_settings("path")), exact, 0.02);
            expect_value(measure(scene, probe_settings("path", {{"rr", "0"}})), exact, 0.02);
            // Whitted's cut-off leaves out what is darker than 1/256 of the picture
            const Measurement w = measure(scene, probe_settings("whitted", {}, 1));
            EXPECT_LE(w.mean, exact + 1e-4);
            EXPECT_GE(w.mean, exact - 1.5 / 256);
        }
    }
}

// One passage through an absorbing body without reflection: Beer and Lambert alone.
TEST(Glass, BeerLambertThroughABall)
{
    Scene scene;
    add_sphere(scene, vec3(0.0f), 0.8f, glass(scene, 1.0f, 0.9f));
    add_plane(scene, vec3(0.0f, 0.0f, -3.0f), vec3(0.0f, 0.0f, 1.0f), diffuse(scene, 0.0f, 1.0f));
    for (const double offset : {0.0, 0.4, 0.7}) { // from the axis
        const auto x = static_cast<float>(offset);
        look(scene, vec3(x, 0.0f, 3.0f), vec3(x, 0.0f, 0.0f), 1e-4f);
        const double exact = std::exp(-0.9 * 2 * std::sqrt(0.64 - offset * offset));
        expect_value(measure(scene, probe_settings("path", {{"rr", "0"}}, 4)), exact, 1e-4);
        expect_value(measure(scene, probe_settings("whitted", {}, 4)), exact, 1e-4);
    }
}

// Along the axis of a glass ball the way is the diameter, and reflections stay on the axis.
TEST(Glass, BeerLambertThroughAGlassBall)
{
    Scene scene;
    add_sphere(scene, vec3(0.0f), 0.8f, glass(scene, 1.5f, 0.5f));
    add_plane(scene, vec3(0.0f, 0.0f, -3.0f), vec3(0.0f, 0.0f, 1.0f), diffuse(scene, 0.0f, 1.0f));
    look(scene, vec3(0.0f, 0.0f, 3.0f), vec3(0.0f), 1e-4f);
    const double r = 0.04, t = std::exp(-0.5 * 1.6);
    expect_value(measure(scene, probe_settings("path")), (1 - r) * (1 - r) * t / (1 - r * r * t * t));
}

// The same glass as an instance that is scaled: distances are the world's.
TEST(Glass, AbsorptionCountsWorldDistances)
{
    Scene scene;
    SphereDesc ball;
    ball.radius = 1.0f;
    ball.material = glass(scene, 1.0f, 0.9f);
    Group group;
    group.spheres = {add(scene, ball)};
    const Index<Group> g = add(scene, group);
    InstanceDesc instance;
    instance.group = g;
    instance.transform = compose(translation(vec3(0.0f, 0.0f, 0.0f)), scaling(vec3(0.5f, 0.8f, 0.25f)));
    add(scene, instance);
    instance.transform = translation(vec3(100.0f, 0.0f, 0.0f)); // placed twice, it stays an instance
    add(scene, instance);
    add_plane(scene, vec3(0.0f, 0.0f, -3.0f), vec3(0.0f, 0.0f, 1.0f), diffuse(scene, 0.0f, 1.0f));
    look(scene, vec3(0.0f, 0.0f, 3.0f), vec3(0.0f), 1e-4f);
    expect_value(measure(scene, probe_settings("path", {{"rr", "0"}}, 4)), std::exp(-0.9 * 0.5), 1e-4);
}

// A lamp and what it lights, both in coloured glass: light is absorbed on its way from the lamp as well.
TEST(Glass, LightInsideIsAbsorbedToo)
{
    constexpr double sigma = 0.7;
    for (const bool point_light : {true, false}) {
        Scene scene;
        add_sphere(scene, vec3(0.0f), 4.0f, glass(scene, 1.0f, static_cast<float>(sigma)));
        const Index<MaterialDesc> paper = diffuse(scene, 0.5f);
        place(scene, polygon({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}, paper));
        look(scene, vec3(3.0f, 6.0f, 0.0f), vec3(0.0f));
        const double seen_through = 4.0 * sigma; // from the ball's surface to its centre
        const std::vector<std::pair<std::string, Parameters>> ways = {
            {"path", {}}, {"path", {{"mis", "0"}}}, {"whitted", {}}};
        double exact = 0;
        if (point_light) {
            add_point_light(scene, vec3(0.0f, 2.0f, 0.0f), 8.0f);
            exact = 0.5 / std::numbers::pi * (8.0 / 4.0) * std::exp(-2.0 * sigma - seen_through);
        } else {
            // A lamp so small that all of it is equally far away: pi r^2 L / d^2.
            add_sphere(scene, vec3(0.0f, 2.0f, 0.0f), 0.002f, diffuse(scene, 0.0f, 1e6f));
            const double d = 2.0, r = 0.002;
            const double irradiance = 1e6 * std::numbers::pi * r * r / (d * d);
            // the lamp's front is nearer than its centre by two thirds of its radius on average
            exact = 0.5 / std::numbers::pi * irradiance * std::exp(-sigma * (d - 2.0 / 3.0 * r) - seen_through);
        }
        for (const auto& [integrator, parameters] : ways) {
            SCOPED_TRACE(integrator + (parameters.empty() ? "" : " " + parameters.begin()->first));
            expect_value(measure(scene, probe_settings(integrator, parameters, 64)), exact, 1e-3);
        }
    }
}

// Seen from inside a medium, all is brighter by the square of its index: the light of a half space is squeezed into a
// cone. From the centre of a ball all rays leave straight, and what is reflected comes back: n^2, whatever R is.
TEST(Glass, RadianceInsideIsScaled)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    add_sphere(scene, vec3(0.0f), 1.0f, glass(scene, 1.5f));
    look(scene, vec3(0.0f), vec3(0.3f, 0.5f, 1.0f), 1.0f);
    for (const Technique& t : techniques()) {
        SCOPED_TRACE(t.name);
        expect_value(measure(scene, probe_settings("path", t.parameters)), 2.25);
    }
    EXPECT_NEAR(measure(scene, probe_settings("whitted", {}, 1)).mean, 2.25, 0.01);
}

// In light of 1 from everywhere a body without absorption shows 1: what enters comes out again.
TEST(Glass, ClearBodiesVanishInWhiteLight)
{
    for (const float ior : {1.0f, 1.5f, 2.4f, 0.75f}) {
        SCOPED_TRACE(ior);
        Scene scene;
        scene.environment.radiance = vec3(1.0f);
        add_sphere(scene, vec3(0.0f), 1.0f, glass(scene, ior));
        look(scene, vec3(0.0f, 0.0f, 5.0f), vec3(0.0f), 20.0f);
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(t.name);
            expect_value(measure(scene, probe_settings("path", t.parameters)), 1);
        }
        expect_value(measure(scene, probe_settings("furnace")), 1);
        const double w = measure(scene, probe_settings("whitted", {}, 4)).mean;
        EXPECT_LE(w, 1 + 1e-4);
        EXPECT_GE(w, 0.97);
    }
}

// Rough glass loses what would be scattered twice by its facets, and never gains. (From inside that is a lot: a tenth
// of the facets reflect totally at alpha 0.3.) With the index of its surroundings it is not there.
TEST(Glass, RoughBallsLoseLittle)
{
    for (const float ior : {1.0f, 1.5f})
        for (const float alpha : {0.05f, 0.3f}) {
            SCOPED_TRACE(testing::Message() << "ior " << ior << ", alpha " << alpha);
            Scene scene;
            scene.environment.radiance = vec3(1.0f);
            add_sphere(scene, vec3(0.0f), 1.0f, glass(scene, ior, 0.0f, alpha));
            look(scene, vec3(0.0f, 0.0f, 5.0f), vec3(0.0f), 15.0f);
            const Measurement m = measure(scene, probe_settings("path"));
            EXPECT_LE(m.mean, 1 + 4 * m.error);
            EXPECT_GE(m.mean, ior == 1.0f ? 1 - 4 * m.error - 1e-5 : alpha < 0.1f ? 0.97 : 0.75);
        }
}

} // namespace
} // namespace snell::test

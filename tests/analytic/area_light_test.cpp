// Light of polygons and spheres on a diffuse floor, whose irradiance is known in closed form: every way to find the
// light must give the same number.
#include "tests/analytic/irradiance.h"
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

std::vector<glm::dvec3> doubles(const std::vector<vec3>& points)
{
    return std::vector<glm::dvec3>(points.begin(), points.end());
}

// A floor of albedo 0.5 at y = 0, seen obliquely at `point`.
Scene floor_scene(vec3 point)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.5f));
    look(scene, point + vec3(-1.5f, 0.3f, 2.0f), point);
    return scene;
}

// Radiance of the floor for that irradiance.
double outgoing(double irradiance)
{
    return 0.5 / pi_d * irradiance;
}

void expect_by_all_techniques(const Scene& scene, double exact, uint spp = 256)
{
    for (const Technique& t : techniques()) {
        SCOPED_TRACE(t.name);
        const bool searches = t.parameters.count("nee") > 0;
        expect_value(measure(scene, probe_settings("path", t.parameters, searches ? 4 * spp : spp)), exact, 0.02);
    }
    SCOPED_TRACE("whitted");
    expect_value(measure(scene, probe_settings("whitted", {}, spp)), exact, 0.02);
}

struct Polygon
{
    std::string name;
    std::vector<vec3> corners; // counter-clockwise seen from the floor
};

std::vector<Polygon> polygons()
{
    return {{"square overhead", {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}},
            {"slanted triangle", {{-1, 1, -1}, {1.5f, 2, -1.2f}, {0.5f, 3.5f, 1.5f}}},
            {"near and large", {{-2, 0.5f, -2}, {2, 0.5f, -2}, {2, 0.5f, 2}, {-2, 0.5f, 2}}},
            {"wall through the horizon", {{1, -1, -2}, {1, -1, 2}, {1, 3, 2}, {1, 3, -2}}},
            {"pentagon", {{0, 3, -1}, {1, 3, -0.3f}, {0.6f, 3, 0.8f}, {-0.6f, 3, 0.8f}, {-1, 3, -0.3f}}}};
}

TEST(AreaLight, PolygonsFollowLambertsFormula)
{
    for (const Polygon& p : polygons())
        for (const vec3& point : {vec3(0.0f), vec3(0.6f, 0.0f, -0.4f)}) {
            SCOPED_TRACE(testing::Message() << p.name << " at " << point.x);
            Scene scene = floor_scene(point);
            place(scene, polygon(p.corners, diffuse(scene, 0.0f, 3.0f)));
            expect_by_all_techniques(scene, outgoing(3 * polygon_irradiance(doubles(p.corners), point, {0, 1, 0})));
        }
}

TEST(AreaLight, ShinesOnItsFrontOnly)
{
    std::vector<vec3> corners = polygons()[0].corners;
    std::reverse(corners.begin(), corners.end());
    for (const bool two_sided : {false, true}) {
        Scene scene = floor_scene(vec3(0.0f));
        place(scene, polygon(corners, diffuse(scene, 0.0f, 3.0f, two_sided)));
        const double exact = two_sided ? outgoing(3 * polygon_irradiance(doubles(corners), {0, 0, 0}, {0, 1, 0})) : 0;
        expect_by_all_techniques(scene, exact);
    }
}

// Vertex normals decide where the outside of a surface is; light sampling and hits must agree on it.
TEST(AreaLight, VertexNormalsAgainstTheWinding)
{
    for (const bool towards_floor : {true, false}) {
        Scene scene = floor_scene(vec3(0.0f));
        Mesh mesh = polygon(polygons()[0].corners, diffuse(scene, 0.0f, 3.0f)); // wound towards the floor
        mesh.normals.assign(mesh.positions.size(), vec3(0.0f, towards_floor ? -1.0f : 1.0f, 0.0f));
        place(scene, mesh);
        std::vector<double> means;
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(testing::Message() << t.name << ", normals to the floor: " << towards_floor);
            const double lit = outgoing(3 * polygon_irradiance(doubles(polygons()[0].corners), {0, 0, 0}, {0, 1, 0}));
            expect_value(measure(scene, probe_settings("path", t.parameters)), towards_floor ? lit : 0, 0.02);
        }
    }
}

TEST(AreaLight, SpheresFollowTheClosedForm)
{
    struct Ball
    {
        vec3 center;
        float radius;
    };
    for (const Ball& b :
         {Ball{{0, 2, 0}, 0.5f}, Ball{{1, 1.2f, 0.5f}, 1.1f}, Ball{{3, 40, 5}, 4.0f}, Ball{{0, 3, 1}, 0.02f}}) {
        SCOPED_TRACE(testing::Message() << "radius " << b.radius);
        Scene scene = floor_scene(vec3(0.0f));
        add_sphere(scene, b.center, b.radius, diffuse(scene, 0.0f, 2.0f));
        const double exact = outgoing(2 * sphere_irradiance(b.center, double{b.radius}, {0, 0, 0}, {0, 1, 0}));
        if (b.radius < 0.1f) { // nobody finds that by chance
            expect_value(measure(scene, probe_settings("path")), exact);
            expect_value(measure(scene, probe_settings("path", {{"mis", "0"}})), exact);
        } else {
            expect_by_all_techniques(scene, exact, 512);
        }
    }
}

// A sphere that shines inwards and has all of the floor in it.
TEST(AreaLight, SphereFromInside)
{
    Scene scene = floor_scene(vec3(0.3f, 0.0f, 0.2f));
    add_sphere(scene, vec3(0.0f, 1.0f, 0.0f), 20.0f, diffuse(scene, 0.0f, 1.0f, true));
    expect_by_all_techniques(scene, outgoing(pi_d));
}

// Several lights at once, of different kinds and strengths: the choice between them must not show.
TEST(AreaLight, ManyLightsAdd)
{
    Scene scene = floor_scene(vec3(0.0f));
    const std::vector<vec3> quad = polygons()[0].corners;
    std::vector<vec3> pentagon = polygons()[4].corners;
    for (vec3& p : pentagon) p += vec3(4.0f, 0.0f, 1.0f);
    place(scene, polygon(quad, diffuse(scene, 0.0f, 3.0f)));
    place(scene, polygon(pentagon, diffuse(scene, 0.0f, 10.0f)));
    add_sphere(scene, vec3(-4.0f, 2.0f, 0.0f), 1.0f, diffuse(scene, 0.0f, 5.0f));
    const glm::dvec3 up(0, 1, 0), origin(0);
    const double exact = outgoing(3 * polygon_irradiance(doubles(quad), origin, up) +
                                  10 * polygon_irradiance(doubles(pentagon), origin, up) +
                                  5 * sphere_irradiance({-4, 2, 0}, 1, origin, up));
    expect_by_all_techniques(scene, exact, 512);
}

// Sky and light together; the light covers a part of the sky.
TEST(AreaLight, EnvironmentAndLight)
{
    Scene scene = floor_scene(vec3(0.0f));
    scene.environment.radiance = vec3(0.7f);
    const std::vector<vec3> quad = polygons()[0].corners;
    place(scene, polygon(quad, diffuse(scene, 0.0f, 3.0f)));
    const double form = polygon_irradiance(doubles(quad), {0, 0, 0}, {0, 1, 0});
    expect_by_all_techniques(scene, outgoing(0.7 * (pi_d - form) + 3 * form), 512);
}

// Environment alone, a convex object of albedo 1: nothing is gained or lost, exactly.
TEST(AreaLight, WhiteObjectsVanishInWhiteLight)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    add_sphere(scene, vec3(0.0f), 1.0f, diffuse(scene, 1.0f));
    look(scene, vec3(0.0f, 0.0f, 5.0f), vec3(0.0f), 30.0f);
    const RenderSettings settings = probe_settings("path", {}, 32);
    for (const double v : pixel_means(render_film(scene, settings))) EXPECT_NEAR(v, 1, 1e-5);
    expect_value(measure(scene, probe_settings("path", {{"mis", "0"}})), 1);
    expect_value(measure(scene, probe_settings("whitted")), 1);

    // concave as well, for the furnace asks for no light sampling
    Scene more = scene;
    add_sphere(more, vec3(0.5f, 0.9f, 0.4f), 0.5f, diffuse(more, 1.0f));
    add_plane(more, vec3(0.0f, -1.2f, 0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(more, 1.0f));
    place(more, polygon(polygons()[0].corners, diffuse(more, 1.0f, 100.0f))); // the furnace has no emitters
    more.environment.radiance = vec3(0.2f);
    for (const double v : pixel_means(render_film(more, probe_settings("furnace", {}, 32)))) EXPECT_NEAR(v, 1, 1e-5);
}

} // namespace
} // namespace snell::test

// Lights that reach the world through transforms shine as if they had been built there.
#include "tests/analytic/irradiance.h"
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

const std::vector<vec3> square = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}; // front to -y

struct Placement
{
    std::string name;
    Transform transform;
};

std::vector<Placement> placements()
{
    const Transform up = translation(vec3(0.0f, 2.0f, 0.0f));
    return {{"moved", up},
            {"turned", compose(up, rotation(vec3(1.0f, 0.3f, 0.5f), 25.0f))},
            {"stretched", compose(up, scaling(vec3(0.5f, 3.0f, 1.5f)))},
            {"stretched and turned",
             compose(up, compose(rotation(vec3(0.0f, 1.0f, 1.0f), 20.0f), scaling(vec3(0.5f, 2.0f, 1.5f))))},
            {"sheared", compose(up, compose(scaling(vec3(0.5f, 2.0f, 1.5f)), rotation(vec3(1.0f, 0.0f, 1.0f), 30.0f)))},
            {"mirrored in x", compose(up, scaling(vec3(-1.0f, 1.0f, 1.0f)))},
            {"mirrored through a point",
             compose(up, compose(rotation(vec3(1.0f, 0.0f, 0.0f), 180.0f), scaling(vec3(-1.0f))))}};
}

// count 1: the group is moved into the world when packed; 2: it stays an instance. The second one is under the floor.
Scene placed(const Placement& p, int count, bool with_normals)
{
    Scene scene;
    add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.5f));
    Mesh mesh = polygon(square, diffuse(scene, 0.0f, 3.0f));
    if (with_normals) mesh.normals.assign(4, vec3(0.0f, -1.0f, 0.0f));
    Group group;
    group.meshes = {add(scene, mesh)};
    InstanceDesc instance;
    instance.group = add(scene, group);
    instance.transform = p.transform;
    add(scene, instance);
    if (count == 2) {
        instance.transform = translation(vec3(0.0f, -30.0f, 0.0f));
        add(scene, instance);
    }
    look(scene, vec3(-1.5f, 0.3f, 2.0f), vec3(0.0f));
    return scene;
}

TEST(Instances, PolygonLights)
{
    for (const Placement& p : placements())
        for (const int count : {1, 2})
            for (const bool with_normals : {false, true}) {
                SCOPED_TRACE(testing::Message() << p.name << ", placed " << count << ", normals " << with_normals);
                std::vector<glm::dvec3> corners;
                for (const vec3& c : square) corners.emplace_back(transform_point(p.transform, c));
                const double exact = 3 * 0.5 / std::numbers::pi * polygon_irradiance(corners, {0, 0, 0}, {0, 1, 0});
                for (const Technique& t : techniques()) {
                    SCOPED_TRACE(t.name);
                    if (t.parameters.count("rr") > 0) continue;
                    expect_value(measure(placed(p, count, with_normals), probe_settings("path", t.parameters, 128)),
                                 exact, 0.02);
                }
            }
}

TEST(Instances, SphereLights)
{
    for (const bool mirror : {false, true}) {
        Scene scene;
        add_plane(scene, vec3(0.0f), vec3(0.0f, 1.0f, 0.0f), diffuse(scene, 0.5f));
        SphereDesc ball;
        ball.radius = 0.25f;
        ball.center = vec3(0.5f, 0.0f, 0.0f);
        ball.material = diffuse(scene, 0.0f, 4.0f);
        Group group;
        group.spheres = {add(scene, ball)};
        InstanceDesc instance;
        instance.group = add(scene, group);
        const vec3 factors = mirror ? vec3(-2.0f, 2.0f, 2.0f) : vec3(2.0f);
        instance.transform = compose(translation(vec3(0.0f, 2.0f, 0.0f)), scaling(factors));
        add(scene, instance);
        instance.transform = translation(vec3(0.0f, -30.0f, 0.0f));
        add(scene, instance);
        look(scene, vec3(-1.5f, 0.3f, 2.0f), vec3(0.0f));
        const double exact =
            4 * 0.5 / std::numbers::pi * sphere_irradiance({mirror ? -1 : 1, 2, 0}, 0.5, {0, 0, 0}, {0, 1, 0});
        for (const Technique& t : techniques()) {
            SCOPED_TRACE(t.name);
            expect_value(measure(scene, probe_settings("path", t.parameters, 512)), exact, 0.02);
        }
    }
}

// A mirror that is turned by its instance reflects as one that was built so.
TEST(Instances, ReflectionsTurnWithTheSurface)
{
    Scene scene;
    MaterialDesc mirror;
    mirror.kind = material_mirror;
    mirror.base_color = vec3(0.5f);
    const Index<MaterialDesc> m = add(scene, mirror);
    Mesh mesh = polygon({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}, m); // front to +y
    mesh.normals.assign(4, vec3(0.0f, 1.0f, 0.0f));
    Group group;
    group.meshes = {add(scene, mesh)};
    InstanceDesc instance;
    instance.group = add(scene, group);
    // Turned by atan(1/2) and stretched by 2 it lies at 45 degrees; its normal must turn by the inverse transpose.
    instance.transform = compose(scaling(vec3(1.0f, 2.0f, 1.0f)), rotation(vec3(0.0f, 0.0f, 1.0f), 26.565051f));
    add(scene, instance);
    instance.transform = translation(vec3(0.0f, -30.0f, 0.0f));
    add(scene, instance);
    add_sphere(scene, vec3(-9.0f, 0.0f, 0.0f), 0.05f, diffuse(scene, 0.0f, 2.0f));
    look(scene, vec3(0.0f, 5.0f, 0.0f), vec3(0.0f), 1e-3f); // from above, into -x
    expect_value(measure(scene, probe_settings("path", {{"rr", "0"}}, 4)), 1, 1e-5);
    expect_value(measure(scene, probe_settings("whitted", {}, 4)), 1, 1e-5);
}

} // namespace
} // namespace snell::test

// What the views and layers show of a hit: interpolated attributes, distances, ids, against values worked out by hand.
#include "snell/kernel/views.h"
#include "tests/render/scenes.h"

namespace snell::test {
namespace {

// A right triangle in the plane z = 0 whose point (x, y) has the barycentric weights 1 - x - y, x, y. Three vertices
// with everything different.
Scene triangle_scene(bool mirrored_instance)
{
    Scene scene;
    scene.environment.radiance = vec3(1.0f);
    MaterialDesc m;
    m.base_color = vec3(0.5f, 1.0f, 1.0f);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs = {{0.1f, 0.2f}, {0.9f, 0.3f}, {0.2f, 0.8f}};
    mesh.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    mesh.normals = {normalize(vec3(-0.2f, -0.2f, 1)), normalize(vec3(0.5f, 0, 1)), normalize(vec3(0, 0.5f, 1))};
    mesh.triangles = {{0, 1, 2}};
    if (mirrored_instance) // the same triangle, built the other way round in x and put back by the instance
        for (std::size_t i = 0; i < 3; ++i) mesh.positions[i].x *= -1.0f, mesh.normals[i].x *= -1.0f;
    if (mirrored_instance) mesh.triangles = {{0, 2, 1}};
    mesh.material = add(scene, m);
    Group group;
    group.meshes = {add(scene, mesh)};
    InstanceDesc instance;
    instance.group = add(scene, group);
    if (mirrored_instance) instance.transform = scaling(vec3(-1.0f, 1.0f, 1.0f));
    add(scene, instance);
    instance.transform = translation(vec3(0.0f, 0.0f, -100.0f)); // a second one, so that it stays an instance
    if (mirrored_instance) add(scene, instance);
    validate(scene);
    return scene;
}

struct Spot
{
    float x, y;
};
constexpr Spot spots[] = {{0.2f, 0.1f}, {0.1f, 0.6f}, {0.7f, 0.2f}, {0.33f, 0.33f}};

vec3 view_at(Scene scene, Spot s, const char* integrator, Film* film = nullptr)
{
    CameraDesc camera;
    camera.eye = vec3(s.x, s.y, 2.0f);
    camera.target = vec3(s.x, s.y, 0.0f);
    camera.fov_degrees = 0.01f;
    scene.cameras = {camera};
    RenderSettings settings;
    settings.width = settings.height = 1;
    settings.spp = 4;
    settings.integrator = integrator;
    settings.layers = true;
    const Film f = render(scene, settings).film;
    if (film != nullptr) *film = f;
    return f.picture().pixels[0];
}

void expect_near(vec3 found, vec3 wanted, float tolerance = 2e-4f)
{
    EXPECT_NEAR(found.x, wanted.x, tolerance);
    EXPECT_NEAR(found.y, wanted.y, tolerance);
    EXPECT_NEAR(found.z, wanted.z, tolerance);
}

TEST(Views, TriangleAttributesAreInterpolated)
{
    for (const bool mirrored : {false, true}) {
        const Scene scene = triangle_scene(mirrored);
        for (const Spot s : spots) {
            SCOPED_TRACE(testing::Message() << "at " << s.x << "," << s.y << (mirrored ? ", mirrored twice" : ""));
            const float w = 1.0f - s.x - s.y;
            expect_near(view_at(scene, s, "uv"),
                        vec3(w * 0.1f + s.x * 0.9f + s.y * 0.2f, w * 0.2f + s.x * 0.3f + s.y * 0.8f, 0.0f));
            expect_near(view_at(scene, s, "albedo"), vec3(0.5f * w, s.x, s.y));
            const vec3 n = w * normalize(vec3(-0.2f, -0.2f, 1)) + s.x * normalize(vec3(0.5f, 0, 1)) +
                           s.y * normalize(vec3(0, 0.5f, 1));
            expect_near(view_at(scene, s, "normals"), 0.5f * normalize(n) + 0.5f);
            expect_near(view_at(scene, s, "geometric-normals"), vec3(0.5f, 0.5f, 1.0f));
            // the second triangle's vertices are named the other way round
            expect_near(view_at(scene, s, "barycentrics"), mirrored ? vec3(w, s.y, s.x) : vec3(w, s.x, s.y));
        }
    }
}

TEST(Views, SidesAndNumbers)
{
    Scene scene = triangle_scene(true); // two instances
    const vec3 front = view_at(scene, {0.2f, 0.2f}, "facing");
    EXPECT_GT(front.z, front.x);
    Scene turned = triangle_scene(false);
    for (vec3& n : turned.meshes[0].normals) n = -n;
    std::swap(turned.meshes[0].triangles[0][1], turned.meshes[0].triangles[0][2]);
    const vec3 back = view_at(turned, {0.2f, 0.2f}, "facing");
    EXPECT_GT(back.x, back.z);
    const vec3 numbers[] = {view_at(scene, {0.2f, 0.2f}, "object"), view_at(scene, {0.2f, 0.2f}, "instance"),
                            view_at(scene, {0.2f, 0.2f}, "primitive")};
    expect_near(numbers[0], id_color(0), 1e-6f);
    expect_near(numbers[1], id_color(0), 1e-6f);
    expect_near(numbers[2], id_color(0), 1e-6f);
    expect_near(view_at(triangle_scene(false), {0.2f, 0.2f}, "instance"), id_color(none), 1e-6f); // placed once
    for (uint i = 0; i < 1000; ++i) EXPECT_GT(length(id_color(i) - id_color(i + 1)), 0.01f) << i;
}

TEST(Views, LayersTellTheFirstHit)
{
    for (const bool mirrored : {false, true}) {
        Film film;
        view_at(triangle_scene(mirrored), {0.2f, 0.1f}, "path", &film);
        const FilmLayers& layers = film.layers;
        expect_near(layers.position[0] / 4.0f, vec3(0.2f, 0.1f, 0.0f));
        expect_near(layers.geometric_normal[0] / 4.0f, vec3(0.0f, 0.0f, 1.0f));
        expect_near(layers.albedo[0] / 4.0f, vec3(0.35f, 0.2f, 0.1f));
        EXPECT_NEAR(layers.depth[0] / 4.0f, 2.0f, 1e-5f);
        EXPECT_EQ(layers.object[0], 0u);
        EXPECT_EQ(layers.hit_count[0], 4u);
        EXPECT_EQ(layers.sample_count[0], 4u);
    }
    Film film;
    view_at(triangle_scene(false), {2.0f, 2.0f}, "path", &film); // beside it
    EXPECT_EQ(film.layers.object[0], none);
    EXPECT_EQ(film.layers.hit_count[0], 0u);
    expect_near(film.picture().pixels[0], vec3(1.0f));
}

// Behind a mirror albedo and normal are those of what is seen in it; the position stays that of the mirror.
TEST(Views, LayersLookIntoMirrors)
{
    Scene scene = triangle_scene(false);
    MaterialDesc mirror;
    mirror.kind = material_mirror;
    mirror.base_color = vec3(1.0f);
    PlaneDesc plane;
    plane.point = vec3(0.0f, 0.0f, 3.0f);
    plane.normal = vec3(0.0f, 0.0f, -1.0f);
    plane.material = add(scene, mirror);
    add(scene, plane);
    CameraDesc camera;
    camera.eye = vec3(0.2f, 0.1f, 1.0f); // away from the triangle, into the mirror
    camera.target = vec3(0.2f, 0.1f, 3.0f);
    camera.fov_degrees = 0.01f;
    scene.cameras = {camera};
    RenderSettings settings;
    settings.width = settings.height = 1;
    settings.spp = 4;
    settings.layers = true;
    const Film film = render(scene, settings).film;
    expect_near(film.layers.albedo[0] / 4.0f, vec3(0.35f, 0.2f, 0.1f));
    EXPECT_GT(film.layers.normal[0].z, 3.5f);
    expect_near(film.layers.position[0] / 4.0f, vec3(0.2f, 0.1f, 3.0f));
    EXPECT_NEAR(film.layers.depth[0] / 4.0f, 2.0f, 1e-5f);
}

TEST(Views, Depth)
{
    const Scene scene = triangle_scene(false);
    RenderSettings settings;
    const auto prepared = prepare(
        [&] {
            Scene s = scene;
            add(s, CameraDesc{});
            return s;
        }(),
        settings);
    const PackedScene& packed = prepared->packed;
    const float far_side = length(packed.center - vec3(0.2f, 0.2f, 2.0f)) + packed.radius;
    expect_near(view_at(scene, {0.2f, 0.2f}, "depth"), vec3(2.0f / far_side), 1e-4f);
}

} // namespace
} // namespace snell::test

// Normal maps tilt the normal the way the texture coordinates grow: on meshes with tangents and without, mirrored or
// not, in world or in object space, and on spheres.
#include "tests/analytic/probe.h"

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

const vec3 tilts[] = {{0.5f, 0.0f, 0.8660254f},
                      {-0.5f, 0.0f, 0.8660254f},
                      {0.0f, 0.5f, 0.8660254f},
                      {0.0f, -0.5f, 0.8660254f},
                      {0.48f, 0.36f, 0.8f}};

// A material whose normal is `tilt` in tangent space everywhere.
Index<MaterialDesc> tilted(Scene& scene, vec3 tilt, uint uv_set = 0)
{
    Image image;
    image.width = image.height = 1;
    image.format = texels_rgba32f;
    image.floats = {0.5f + 0.5f * tilt.x, 0.5f + 0.5f * tilt.y, 0.5f + 0.5f * tilt.z, 1.0f};
    MaterialDesc m;
    m.base_color = vec3(0.5f);
    m.normal_texture.image = add(scene, image);
    m.normal_texture.uv_set = uv_set;
    return add(scene, m);
}

// Light from one side shows the normal: brightness of a point that is seen, against the world normal it should have.
void expect_normal(Scene scene, vec3 point, vec3 geometric, vec3 normal)
{
    look(scene, point + 3.0f * geometric + vec3(0.01f, 0.02f, 0.01f), point);
    for (const vec3 offset : {vec3(0.5f, 0.1f, 0.0f), vec3(-0.3f, 0.6f, 0.2f), vec3(0.1f, -0.4f, 0.6f)}) {
        LightDesc light;
        light.kind = light_directional;
        const vec3 toward = normalize(geometric + 0.7f * offset);
        light.direction = -toward;
        light.emission = vec3(2.0f);
        scene.lights = {light};
        const Measurement m = measure(scene, probe_settings("path", {}, 1));
        EXPECT_NEAR(m.mean, 0.5 / pi_d * 2 * double{dot(normal, toward)}, 2e-4) << offset.x;
    }
}

TEST(NormalMap, TiltsAlongTheTextureCoordinates)
{
    for (const vec3 tilt : tilts)
        for (const int variant : {0, 1, 2, 3}) // tangents; of the opposite hand; texture coordinates; the second ones
            for (const bool instanced : {false, true})
                for (const bool mirrored : {false, true}) {
                    SCOPED_TRACE(fmt::format("tilt {} {} variant {} instanced {} mirrored {}", tilt.x, tilt.y, variant,
                                             instanced, mirrored));
                    // facing +Z; u grows along +X and v along +Y, or for variant 1 u along -X
                    Scene scene;
                    Mesh mesh = polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {0});
                    mesh.material = tilted(scene, tilt, variant == 3 ? 1 : 0);
                    const float hand = variant == 1 ? -1.0f : 1.0f;
                    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
                    if (variant == 1)
                        for (vec2& uv : mesh.uvs) uv.x = 1.0f - uv.x;
                    if (variant == 3) {
                        mesh.uvs_1 = mesh.uvs;
                        for (vec2& uv : mesh.uvs) uv = -uv; // not these
                    }
                    if (variant <= 1) {
                        mesh.normals.assign(4, vec3(0, 0, 1));
                        mesh.tangents.assign(4, vec4(hand, 0, 0, hand));
                    }
                    Group group;
                    group.meshes = {add(scene, mesh)};
                    InstanceDesc placed;
                    placed.group = add(scene, group);
                    placed.transform = compose(rotation(vec3(1, 2, -1), 100.0f), scaling(vec3(2.0f, 3.0f, 1.0f)));
                    if (mirrored) placed.transform = compose(placed.transform, scaling(vec3(1, -1, 1)));
                    add(scene, placed);
                    const Transform map = placed.transform;
                    if (instanced) {
                        placed.transform = translation(vec3(0, -1000, 0));
                        add(scene, placed);
                    }
                    const vec3 u = normalize(transform_vector(map, vec3(hand, 0, 0)));
                    const vec3 v = normalize(transform_vector(map, vec3(0, 1, 0)));
                    const vec3 n = normalize(transform_vector(map, vec3(0, 0, 1)));
                    expect_normal(scene, transform_point(map, vec3(0.1f, -0.2f, 0)), n,
                                  tilt.x * u + tilt.y * v + tilt.z * n);
                }
}

TEST(NormalMap, OnASphere)
{
    for (const vec3 tilt : tilts)
        for (const bool mirrored : {false, true}) {
            SCOPED_TRACE(fmt::format("tilt {} {} mirrored {}", tilt.x, tilt.y, mirrored));
            Scene scene;
            Group group;
            group.spheres = {add(scene, SphereDesc{"", vec3(0.0f), 1.0f, tilted(scene, tilt)})};
            InstanceDesc placed;
            placed.group = add(scene, group);
            placed.transform = compose(rotation(vec3(1, 2, -1), 100.0f), scaling(vec3(mirrored ? -1.0f : 1.0f, 1, 1)));
            add(scene, placed);
            // at a longitude of 40 degrees from +Z towards +X, at a latitude of 25
            const float a = 40.0f * pi / 180.0f, b = 25.0f * pi / 180.0f;
            const vec3 n(sin(a) * cos(b), sin(b), cos(a) * cos(b)), u(cos(a), 0, -sin(a));
            const vec3 v(-sin(a) * sin(b), cos(b), -cos(a) * sin(b));
            const vec3 world_n = transform_vector(placed.transform, n);
            expect_normal(scene, world_n, world_n,
                          transform_vector(placed.transform, tilt.x * u + tilt.y * v + tilt.z * n));
        }
}

TEST(NormalMap, ScaleFlattensAndBackSidesSeeTheSameBumps)
{
    Scene scene;
    Mesh mesh = polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {0});
    mesh.material = tilted(scene, tilts[0]);
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    place(scene, mesh);
    expect_normal(scene, vec3(0.0f), vec3(0, 0, -1), -tilts[0]);
    scene.materials[0].normal_scale = 0.5f;
    expect_normal(scene, vec3(0.0f), vec3(0, 0, 1), normalize(vec3(0.25f, 0.0f, 0.8660254f)));
    scene.materials[0].normal_scale = 0.0f;
    expect_normal(scene, vec3(0.0f), vec3(0, 0, 1), vec3(0, 0, 1));
}

TEST(NormalMap, CreatesNoLight)
{
    Scene scene;
    Draw draw(77);
    Image bumps;
    bumps.width = bumps.height = 16;
    bumps.format = texels_rgba32f;
    for (int i = 0; i < 256; ++i) {
        vec3 n = draw.direction();
        n.z = abs(n.z);
        bumps.floats.insert(bumps.floats.end(), {0.5f + 0.5f * n.x, 0.5f + 0.5f * n.y, 0.5f + 0.5f * n.z, 1.0f});
    }
    MaterialDesc white;
    white.base_color = vec3(1.0f);
    white.normal_texture.image = add(scene, bumps);
    Mesh mesh = polygon({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, add(scene, white));
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    place(scene, mesh);
    for (const float slant : {0.0f, 1.0f, 3.0f, 20.0f}) {
        SCOPED_TRACE(slant);
        look(scene, 3.0f * normalize(vec3(slant, 0.3f * slant, 1.0f)), vec3(0.3f, 0.2f, 0), 10.0f);
        const RenderSettings settings = probe_settings("furnace", {{"rr", "0"}}, 64);
        const Film film = render_film(scene, settings);
        double mean = 0;
        for (std::size_t i = 0; i < film.sum.size(); ++i) {
            const double value = double{film.sum[i].y} / film.sample_count[i];
            EXPECT_LE(value, 1 + 1e-5);
            mean += value / static_cast<double>(film.sum.size());
        }
        EXPECT_GT(mean, 0.4); // light is lost below the true surface
    }
}

} // namespace
} // namespace snell::test

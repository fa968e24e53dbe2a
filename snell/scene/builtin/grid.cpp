// A room to look through lenses at: checkered walls and floor, so that every line in the picture should be straight,
// and a ruled frame in the middle. All lengths are metres.
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

namespace snell {
namespace {

constexpr float half = 2.0f; // of the room's width, height and depth
constexpr uint squares = 16; // a side

// Squares over a wall from `corner` along `across` and `along`, which are as long as the wall; facing cross(across,
// along). Every fourth line of squares is marked, to count by.
Mesh make_wall(const char* name, vec3 corner, vec3 across, vec3 along, Index<MaterialDesc> light,
               Index<MaterialDesc> dark, Index<MaterialDesc> marked)
{
    Mesh mesh;
    mesh.name = name;
    mesh.material = light;
    for (uint j = 0; j <= squares; ++j)
        for (uint i = 0; i <= squares; ++i)
            mesh.positions.push_back(corner + across * (static_cast<float>(i) / squares) +
                                     along * (static_cast<float>(j) / squares));
    for (uint j = 0; j < squares; ++j)
        for (uint i = 0; i < squares; ++i) {
            const uint a = j * (squares + 1) + i;
            mesh.triangles.emplace_back(a, a + 1, a + squares + 2);
            mesh.triangles.emplace_back(a, a + squares + 2, a + squares + 1);
            const bool is_light = (i + j) % 2 == 0;
            const bool is_marked = i == squares / 2 || j == squares / 2;
            const Index<MaterialDesc> material = !is_light ? dark : is_marked ? marked : light;
            mesh.triangle_materials.insert(mesh.triangle_materials.end(), 2, material);
        }
    return mesh;
}

// Thin bars in the plane z: a grid of lines to see through.
void place_rulers(Scene& scene, float z, Index<MaterialDesc> material)
{
    constexpr float reach = 1.5f, thick = 0.006f;
    for (int i = -3; i <= 3; ++i) {
        const float at = 0.5f * static_cast<float>(i);
        place(scene,
              make_box("upright ruler", {at - thick, -reach, z - thick}, {at + thick, reach, z + thick}, material));
        place(scene,
              make_box("level ruler", {-reach, at - thick, z - thick}, {reach, at + thick, z + thick}, material));
    }
}

} // namespace

Scene make_grid()
{
    Scene scene;
    scene.name = "grid";
    const auto white = add(scene, diffuse("white", vec3(0.75f)));
    const auto black = add(scene, diffuse("black", vec3(0.06f)));
    const auto red = add(scene, diffuse("red", {0.65f, 0.08f, 0.05f}));
    const auto green = add(scene, diffuse("green", {0.12f, 0.5f, 0.1f}));
    const auto blue = add(scene, diffuse("blue", {0.1f, 0.2f, 0.65f}));
    const auto yellow = add(scene, diffuse("yellow", {0.8f, 0.6f, 0.05f}));
    const auto rulers = add(scene, diffuse("ruler", {0.8f, 0.35f, 0.02f}));
    const auto lamp = add(scene, emitter("lamp", vec3(9.0f)));

    const float h = half, w = 2.0f * half;
    place(scene, make_wall("back wall", {-h, -h, -h}, {w, 0, 0}, {0, w, 0}, white, black, red));
    place(scene, make_wall("front wall", {h, -h, h}, {-w, 0, 0}, {0, w, 0}, white, black, yellow));
    place(scene, make_wall("left wall", {-h, -h, h}, {0, 0, -w}, {0, w, 0}, white, black, green));
    place(scene, make_wall("right wall", {h, -h, -h}, {0, 0, w}, {0, w, 0}, white, black, blue));
    place(scene, make_wall("floor", {-h, -h, h}, {w, 0, 0}, {0, 0, -w}, white, black, red));
    place(scene, make_wall("ceiling", {-h, h, -h}, {w, 0, 0}, {0, 0, w}, white, black, red));
    place(scene, make_quad("lamp", {-0.6f, h - 0.01f, -0.6f}, {0.6f, h - 0.01f, -0.6f}, {0.6f, h - 0.01f, 0.6f},
                           {-0.6f, h - 0.01f, 0.6f}, lamp));
    place_rulers(scene, -1.0f, rulers);
    place(scene, SphereDesc{"near ball", {0.45f, -0.3f, 0.0f}, 0.12f, green});
    place(scene, SphereDesc{"far ball", {-0.6f, 0.25f, -1.6f}, 0.2f, blue});
    add(scene, CameraDesc{"middle", {0, 0, 1.2f}, {0, 0, -1.0f}, {0, 1, 0}, 70.0f});
    return scene;
}

} // namespace snell

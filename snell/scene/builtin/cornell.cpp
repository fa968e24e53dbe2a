// The Cornell box in the proportions of our reference picture: a room of 2 x 2 x 2 open towards +Z.
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

namespace snell {

// A block that stands on the floor: four corners of its base in the order of the reference file, and its height.
static Mesh make_block(const char* name, const vec2 (&base)[4], float height, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = name;
    mesh.material = material;
    for (const float y : {0.0f, height})
        for (const vec2 corner : base) mesh.positions.emplace_back(corner.x, y, corner.y);
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}, {0, 5, 1}, {0, 4, 5},
                      {1, 6, 2}, {1, 5, 6}, {2, 7, 3}, {2, 6, 7}, {3, 4, 0}, {3, 7, 4}};
    return mesh;
}

Scene make_cornell()
{
    Scene scene;
    scene.name = "cornell";
    const auto white = add(scene, diffuse("white", vec3(0.73f)));
    const auto left = add(scene, diffuse("left wall", {0.63f, 0.065f, 0.05f}));
    const auto right = add(scene, diffuse("right wall", {0.14f, 0.45f, 0.091f}));
    const auto lamp = add(scene, emitter("lamp", vec3(15.0f)));

    place(scene, make_quad("floor", {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, white));
    place(scene, make_quad("ceiling", {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, white));
    place(scene, make_quad("back wall", {-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, white));
    place(scene, make_quad("left wall", {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}, {-1, 0, 1}, left));
    place(scene, make_quad("right wall", {1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}, right));
    place(scene, make_quad("lamp", {-0.25f, 1.99f, -0.25f}, {0.25f, 1.99f, -0.25f}, {0.25f, 1.99f, 0.25f},
                           {-0.25f, 1.99f, 0.25f}, lamp));
    place(scene, make_block("tall block",
                            {{-0.732820583f, -0.479771066f},
                             {-0.200228934f, -0.652820583f},
                             {-0.027179417f, -0.120228934f},
                             {-0.559771066f, 0.052820583f}},
                            1.2f, white));
    place(scene, make_block("short block",
                            {{0.234098746f, -0.049629409f},
                             {0.769629409f, 0.114098746f},
                             {0.605901254f, 0.649629409f},
                             {0.070370591f, 0.485901254f}},
                            0.6f, white));
    add(scene, CameraDesc{"front", {0, 1, 4}, {0, 1, 0}, {0, 1, 0}, 39.0f});
    return scene;
}

} // namespace snell

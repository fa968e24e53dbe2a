#include "bench_scene.h"

#include "console.h"

#include "snell/core/error.h"
#include "snell/lab/ray_sets.h"
#include "snell/render/params.h"
#include "snell/scene/shapes.h"

namespace snell::app {

static MaterialDesc plain(const char* name, vec3 color, vec3 emission = vec3(0.0f))
{
    MaterialDesc material;
    material.name = name;
    material.base_color = color;
    material.emission = emission;
    return material;
}

void add_room(Scene& scene)
{
    Bounds bounds = scene_bounds(scene);
    if (bounds.empty()) throw Error("--room: the scene has nothing to put a room around", "leave --room out");
    const float size = max3(bounds.extent());
    const vec3 margin(size, 0.002f * size, size); // the floor is just below
    vec3 lower = bounds.lower - margin;
    vec3 upper = bounds.upper + vec3(size);
    for (const CameraDesc& camera : scene.cameras) {
        lower = min(lower, camera.eye - vec3(0.1f * size));
        upper = max(upper, camera.eye + vec3(0.1f * size));
    }
    const auto wall = add(scene, plain("wall", vec3(0.7f)));
    const auto lamp = add(scene, plain("lamp", vec3(0.0f), vec3(10.0f)));
    Mesh room = make_box("room", lower, upper, wall);
    for (uvec3& triangle : room.triangles) std::swap(triangle.y, triangle.z); // seen from inside
    place(scene, std::move(room));
    const vec3 c = 0.5f * (lower + upper), half = 0.15f * (upper - lower);
    const float y = upper.y - 0.02f * (upper.y - lower.y);
    place(scene, make_quad("lamp", {c.x - half.x, y, c.z - half.z}, {c.x + half.x, y, c.z - half.z},
                           {c.x + half.x, y, c.z + half.z}, {c.x - half.x, y, c.z + half.z}, lamp));
}

BenchScene open_bench_scene(const std::string& name, const SceneChoice& choice, const CameraChoice& camera, bool room,
                            std::size_t rays)
{
    SceneChoice this_one = choice;
    this_one.name = name;
    Scene scene = open_chosen(this_one);
    if (room) {
        complete_camera(scene, 1.0f); // which looks at the scene, not at the room
        if (camera.eye) {
            CameraDesc chosen;
            chosen.eye = *camera.eye;
            add(scene, chosen);
            add_room(scene);
            scene.cameras.pop_back();
        } else {
            add_room(scene);
        }
    }
    choose_camera(scene, camera, 1.0f);
    console().notes(scene);
    const int side = ray_set_side(rays);
    BenchScene result;
    result.packed = pack(scene);
    result.camera_desc = scene.cameras.at(0);
    result.camera = make_camera(result.camera_desc, side, side);
    return result;
}

} // namespace snell::app

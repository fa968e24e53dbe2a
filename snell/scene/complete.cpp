// A camera and light for scenes that came without.
#include "snell/core/error.h"
#include "snell/scene/lit.h"
#include "snell/scene/scene.h"
#include "snell/scene/studio.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell {

static constexpr float fov_degrees = 40.0f;
static constexpr float margin = 1.06f; // how much wider than the scene the picture is

struct View
{
    vec3 forward, right, up; // orthonormal
};

// Looking that many degrees down from the level direction `level`.
static View look_down(float degrees, vec3 level, vec3 up)
{
    const float angle = degrees * pi / 180.0f;
    View view;
    view.forward = std::cos(angle) * level - std::sin(angle) * up;
    view.right = normalize(cross(level, up));
    view.up = cross(view.right, view.forward);
    return view;
}

static std::array<vec3, 8> corners(const Bounds& bounds)
{
    std::array<vec3, 8> result;
    for (uint i = 0; i < 8; ++i)
        result[i] = vec3(i & 1u ? bounds.upper.x : bounds.lower.x, i & 2u ? bounds.upper.y : bounds.lower.y,
                         i & 4u ? bounds.upper.z : bounds.lower.z);
    return result;
}

// The nearest eye from which all corners lie inside the picture. In camera coordinates (x, y, depth) a corner is
// inside when |x - eye.x| <= tan_x (depth - eye.depth), and so for y: linear, hence solved by the extreme corners.
static CameraDesc frame(const Bounds& bounds, const View& view, vec3 up, float aspect)
{
    const float tan_short = std::tan(0.5f * fov_degrees * pi / 180.0f) / margin;
    const vec2 tangent(tan_short * std::max(aspect, 1.0f), tan_short / std::min(aspect, 1.0f));

    const vec3 center = bounds.center();
    vec2 right_most(-1e30f), left_most(-1e30f); // of x - tangent * depth, and of -x - tangent * depth
    float nearest = 1e30f;
    for (const vec3 corner : corners(bounds)) {
        const vec3 p = corner - center;
        const vec2 xy(dot(p, view.right), dot(p, view.up));
        const float depth = dot(p, view.forward);
        right_most = max(right_most, xy - tangent * depth);
        left_most = max(left_most, -xy - tangent * depth);
        nearest = std::min(nearest, depth);
    }
    const vec2 depths = -0.5f * (right_most + left_most) / tangent;
    const vec2 eye = 0.5f * (right_most - left_most);
    const float size = std::max(length(bounds.extent()), 1e-6f * std::max(1.0f, length(center)));
    // A flat scene seen face on needs the distance; a point or a line would let the eye touch it.
    const float depth = std::min({depths.x, depths.y, nearest - 0.01f * size});

    CameraDesc camera;
    camera.name = "framing";
    camera.fov_degrees = fov_degrees;
    camera.up = up;
    camera.eye = center + eye.x * view.right + eye.y * view.up + depth * view.forward;
    camera.target = camera.eye - depth * view.forward;
    return camera;
}

// Whether the triangles form a room that is open to one side along Z: a ceiling, a floor and a back wall that fill most
// of the sides of the bounds, and little in front (the water of an aquarium, say). Such a room is looked into at level,
// as a stage is. The result is the way to look: -1 or 1 along Z; 0 if it is no such room.
static int look_into_room(const Scene& scene, const Bounds& bounds)
{
    const vec3 extent = bounds.extent();
    if (!(std::min({extent.x, extent.y, extent.z}) > 0.0f)) return 0;
    const vec3 tolerance = 0.03f * extent;
    vec3 low_area(0.0f), high_area(0.0f); // covered on the sides at bounds.lower and bounds.upper, by axis
    std::vector<uint> uses(scene.groups.size(), 0);
    for (const InstanceDesc& instance : scene.instances) ++uses[instance.group.value];
    for (const InstanceDesc& instance : scene.instances) {
        if (uses[instance.group.value] > 1) continue; // furniture
        for (const Index<Mesh> index : scene.groups[instance.group.value].meshes) {
            const Mesh& mesh = scene.meshes[index.value];
            for (const uvec3 t : mesh.triangles) {
                vec3 p[3];
                for (int k = 0; k < 3; ++k) p[k] = transform_point(instance.transform, mesh.positions[t[k]]);
                const vec3 lower = min(p[0], min(p[1], p[2])), upper = max(p[0], max(p[1], p[2]));
                const vec3 area = 0.5f * abs(cross(p[1] - p[0], p[2] - p[0])); // projected along each axis
                for (int axis = 0; axis < 3; ++axis) {
                    if (upper[axis] <= bounds.lower[axis] + tolerance[axis]) low_area[axis] += area[axis];
                    if (lower[axis] >= bounds.upper[axis] - tolerance[axis]) high_area[axis] += area[axis];
                }
            }
        }
    }
    const vec3 side(extent.y * extent.z, extent.z * extent.x, extent.x * extent.y);
    const vec3 low = low_area / side, high = high_area / side;
    constexpr float wall = 0.6f, open = 0.5f;
    if (low.y < wall || high.y < wall) return 0;
    return low.z > wall && high.z < open ? -1 : high.z > wall && low.z < open ? 1 : 0;
}

static void add_camera(Scene& scene, const Bounds& bounds, float aspect, vec3 up)
{
    if (bounds.empty()) {
        CameraDesc camera;
        camera.name = "default";
        if (scene.planes.empty()) {
            add(scene, camera);
            note(scene, Note::Kind::warning, "the scene is empty: there is nothing to see");
            return;
        }
        // Stand on the front of the first plane, as high above it as a person above the ground, and look ahead.
        const PlaneDesc& plane = scene.planes.front();
        const vec3 normal = normalize(plane.normal);
        const vec3 aside = abs(normal.z) < 0.9f ? vec3(0, 0, 1) : vec3(0, -1, 0);
        const vec3 back = normalize(aside - dot(aside, normal) * normal);
        camera.eye = plane.point + 1.7f * normal + 6.0f * back;
        camera.target = plane.point + 0.5f * normal;
        camera.up = normal;
        add(scene, camera);
        note(scene, Note::Kind::info, "no camera, and only infinite planes: one was placed in front of the first");
        return;
    }

    const vec3 extent = bounds.extent();
    const float largest = max3(extent);
    // Along -Z where +Y is up, along +Y where +Z is; something flat that would be seen edge on, from its side.
    const vec3 aside = std::abs(up.x) < 0.9f * length(up) ? vec3(1, 0, 0) : vec3(0, 0, 1);
    vec3 level = normalize(cross(up, aside));
    const vec3 right = cross(level, normalize(up));
    const float width = dot(abs(right), extent), depth = dot(abs(level), extent);
    if (width < 1e-3f * largest && depth > width) level = -right;
    const bool flat = dot(abs(normalize(up)), extent) < 0.03f * largest;
    const int room = up == vec3(0, 1, 0) ? look_into_room(scene, bounds) : 0;
    if (room != 0) level = vec3(0, 0, static_cast<float>(room));
    const float down = room != 0 ? 0.0f : flat ? 40.0f : 15.0f;
    const CameraDesc camera = frame(bounds, look_down(down, level, normalize(up)), up, aspect);
    add(scene, camera);
    note(scene, Note::Kind::info,
         fmt::format("no camera: {} with --eye {:.6g},{:.6g},{:.6g} --target {:.6g},{:.6g},{:.6g} --fov {:.6g}",
                     room != 0 ? "looking into the room" : "framing the scene", camera.eye.x, camera.eye.y,
                     camera.eye.z, camera.target.x, camera.target.y, camera.target.z, camera.fov_degrees));
}

void complete_camera(Scene& scene, float aspect, vec3 up)
{
    if (!(aspect > 0.0f && std::isfinite(aspect)))
        throw Error(fmt::format("a picture cannot have an aspect of {}", aspect), "give a positive width and height");
    if (scene.cameras.empty()) add_camera(scene, scene_bounds(scene), aspect, up);
}

void complete_light(Scene& scene)
{
    if (is_lit(scene)) return;
    add_studio(scene);
    note(scene, Note::Kind::info,
         "no light: a neutral studio (a grey room with three softboxes, the brightest over the camera's left shoulder) "
         "was put around the scene");
}

void complete(Scene& scene, float aspect)
{
    complete_camera(scene, aspect);
    complete_light(scene);
}

} // namespace snell

// Repair of what came from outside: what can be mended is mended and noted, what has no meaning is an Error.
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/camera_models.h"
#include "snell/scene/scene.h"
#include "snell/scene/validate_animation.h"
#include "snell/scene/validate_material.h"
#include "snell/scene/validate_mesh.h"
#include "snell/scene/validate_parts.h"

#include <algorithm>
#include <cmath>

namespace snell {

// The grey that primitives without a material share; added when first needed.
class DefaultMaterial
{
  public:
    explicit DefaultMaterial(Scene& scene) : scene_(scene) {}

    // Makes sure that `material` is one of the scene's; who(): whose it is.
    template <class Who>
    void check(Index<MaterialDesc>& material, const Who& who)
    {
        if (!material.valid()) {
            if (uses_++ == 0) {
                first_ = who();
                MaterialDesc grey;
                grey.name = "default grey";
                grey_ = add(scene_, grey);
            }
            material = grey_;
        }
        if (material.value >= scene_.materials.size())
            throw Error(fmt::format("{} refers to material {} of {}", who(), material.value, scene_.materials.size()));
    }

    // One note for all of them.
    void report() const
    {
        if (uses_ == 1) warn(scene_, fmt::format("{} has no material: a grey one is used", first_));
        if (uses_ > 1)
            warn(scene_, fmt::format("{} and {} more have no material: a grey one is used", first_, uses_ - 1));
    }

  private:
    Scene& scene_;
    Index<MaterialDesc> grey_;
    std::string first_;
    std::size_t uses_ = 0;
};

// ---- primitives and their places ----

bool is_sphere(const SphereDesc& sphere)
{
    return sphere.radius > 0.0f && is_seen(vec3(sphere.radius)) && is_seen(sphere.center);
}

// Removes spheres without extent from the groups; they stay in the scene's list, so that no index changes.
static void mend_spheres(Scene& scene, DefaultMaterial& fallback)
{
    std::vector<bool> bad(scene.spheres.size(), false);
    std::size_t dropped = 0;
    std::string first;
    for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
        SphereDesc& sphere = scene.spheres[i];
        const auto who = [&] { return fmt::format("sphere {}", label(sphere.name, i)); };
        fallback.check(sphere.material, who);
        if (!is_sphere(sphere)) {
            bad[i] = true;
            if (dropped++ == 0)
                first = fmt::format("{} (radius {}, centre {}, {}, {})", who(), sphere.radius, sphere.center.x,
                                    sphere.center.y, sphere.center.z);
        }
    }
    if (dropped > 0)
        warn(scene, fmt::format("dropped {} spheres without a positive radius or a finite centre, the first: {}",
                                dropped, first));
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        Group& group = scene.groups[g];
        for (const Index<Mesh> mesh : group.meshes)
            if (mesh.value >= scene.meshes.size())
                throw Error(fmt::format("group {} refers to mesh {} of {}", label(group.name, g), mesh.value,
                                        scene.meshes.size()));
        for (const Index<SphereDesc> sphere : group.spheres)
            if (sphere.value >= scene.spheres.size())
                throw Error(fmt::format("group {} refers to sphere {} of {}", label(group.name, g), sphere.value,
                                        scene.spheres.size()));
        std::erase_if(group.spheres, [&](Index<SphereDesc> sphere) { return bad[sphere.value]; });
    }
}

void check_plane(const PlaneDesc& plane, std::size_t number)
{
    const auto who = [&] { return fmt::format("plane {}", label(plane.name, number)); };
    if (!is_finite3(plane.normal) || is_black(plane.normal))
        throw Error(
            fmt::format("{} has the normal ({}, {}, {})", who(), plane.normal.x, plane.normal.y, plane.normal.z),
            "give a finite direction of non-zero length");
    if (!is_seen(plane.point))
        throw Error(
            fmt::format("{} goes through the point ({}, {}, {})", who(), plane.point.x, plane.point.y, plane.point.z),
            "give a finite point");
}

static void check_planes(Scene& scene, DefaultMaterial& fallback)
{
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
        PlaneDesc& plane = scene.planes[i];
        fallback.check(plane.material, [&] { return fmt::format("plane {}", label(plane.name, i)); });
        check_plane(plane, i);
    }
}

void check_instance(const InstanceDesc& instance, std::size_t number)
{
    const auto who = [&] { return fmt::format("instance {}", label(instance.name, number)); };
    if (!is_usable(instance.transform))
        throw Error(fmt::format("{}: the transform has a number that is NaN, infinite or beyond 1e18", who()));
    if (!inverse(instance.transform))
        throw Error(fmt::format("{}: the transform is singular, it flattens what it places", who()),
                    "give every axis a scale other than 0");
}

static void check_instances(const Scene& scene)
{
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const InstanceDesc& instance = scene.instances[i];
        if (instance.group.value >= scene.groups.size())
            throw Error(fmt::format("instance {} refers to group {} of {}", label(instance.name, i),
                                    static_cast<std::int32_t>(instance.group.value), scene.groups.size()));
        check_instance(instance, i);
    }
}

// ---- lights and cameras ----

std::string mend_light(LightDesc& light, std::size_t number)
{
    const std::string who = fmt::format("light {}", label(light.name, number));
    if (light.kind != light_point && light.kind != light_directional && light.kind != light_spot)
        throw Error(fmt::format("{}: kind {} is not a point, directional or spot light", who, light.kind),
                    "give a mesh or sphere an emissive material for an area light");
    std::string mended;
    const auto say = [&mended](const char* what) { mended += (mended.empty() ? "" : ", ") + std::string(what); };
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(light.emission[i]) || light.emission[i] < 0.0f) {
            light.emission[i] = 0.0f;
            if (mended.empty()) say("emission");
        }
    if (light.kind != light_directional && !is_seen(light.position)) {
        // Anywhere else would be a guess: it stays, but dark.
        light.position = vec3(0.0f);
        light.emission = vec3(0.0f);
        say("position (the light is off)");
    }
    if (light.kind != light_point && (!is_finite3(light.direction) || is_black(light.direction))) {
        light.direction = LightDesc{}.direction;
        say("direction");
    }
    if (light.kind == light_spot) {
        const float inner = light.inner_degrees, outer = light.outer_degrees;
        if (!std::isfinite(outer)) light.outer_degrees = LightDesc{}.outer_degrees;
        light.outer_degrees = std::clamp(light.outer_degrees, 0.1f, 180.0f);
        if (!std::isfinite(inner)) light.inner_degrees = 0.0f;
        light.inner_degrees = std::clamp(light.inner_degrees, 0.0f, light.outer_degrees);
        if (inner != light.inner_degrees || outer != light.outer_degrees) say("cone angles");
    }
    return mended;
}

std::string mend_camera(CameraDesc& camera, std::size_t number)
{
    const std::string who = fmt::format("camera {}", label(camera.name, number));
    if (!is_finite3(camera.eye) || !is_finite3(camera.target))
        throw Error(fmt::format("{}: eye or target is NaN or infinite", who));
    if (camera.eye == camera.target)
        throw Error(fmt::format("{}: eye and target are the same point", who), "move one of them");
    if (const std::string fault = camera_fault(camera); !fault.empty())
        throw Error(fmt::format("{}: {}", who, fault));
    const vec3 view = normalize(camera.target - camera.eye);
    const bool usable = is_finite3(camera.up) && !is_black(camera.up);
    if (!usable || length(cross(view, normalize(camera.up))) < 1e-4f) {
        camera.up = abs(view.y) < 0.9f ? vec3(0, 1, 0) : vec3(0, 0, -1);
        return "the up direction is zero or along the view; replaced";
    }
    return {};
}

void validate(Scene& scene)
{
    validate_materials(scene);

    std::vector<bool> changes_shape(scene.meshes.size(), false);
    for (const Rig& rig : scene.rigs)
        if (rig.mesh.value < scene.meshes.size()) changes_shape[rig.mesh.value] = true;
    DefaultMaterial fallback(scene);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        Mesh& mesh = scene.meshes[i];
        const auto who = [&] { return fmt::format("mesh {}", label(mesh.name, i)); };
        const bool uses_own = mesh.triangle_materials.empty()
                                  ? !mesh.triangles.empty()
                                  : std::find(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                                              Index<MaterialDesc>{}) != mesh.triangle_materials.end();
        if (uses_own) fallback.check(mesh.material, who);
        for (std::string& text : validate_mesh(mesh, who(), scene.materials.size(), changes_shape[i]))
            warn(scene, std::move(text));
    }
    mend_spheres(scene, fallback);
    check_planes(scene, fallback);
    fallback.report();
    check_instances(scene);
    validate_animation(scene);
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
        if (const std::string mended = mend_light(scene.lights[i], i); !mended.empty())
            warn(scene, fmt::format("light {}: mended: {}", label(scene.lights[i].name, i), mended));
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        if (const std::string mended = mend_camera(scene.cameras[i], i); !mended.empty())
            warn(scene, fmt::format("camera {}: {}", label(scene.cameras[i].name, i), mended));
    validate_environment(scene);
}

} // namespace snell

#include "tests/reference_scenes.h"

#include "snell/core/error.h"
#include "snell/scene/builtin.h"
#include "snell/scene/shapes.h"

#include <algorithm>
#include <string_view>

namespace snell::test {

template <class T>
static T& find(std::vector<T>& items, std::string_view name)
{
    const auto found = std::find_if(items.begin(), items.end(), [&](const T& item) { return item.name == name; });
    if (found == items.end()) throw Error(fmt::format("no '{}' in the scene", name));
    return *found;
}

Scene make_cornell_diffuse_reference()
{
    Scene scene = find_builtin_scene("cornell")->make();
    find(scene.materials, "left wall").base_color = vec3(0.5f);
    find(scene.materials, "right wall").base_color = vec3(0.3f);
    validate(scene);
    return scene;
}

Scene make_cornell_reference()
{
    Scene scene = make_cornell_diffuse_reference();
    std::erase_if(scene.instances, [](const InstanceDesc& instance) { return instance.name == "short block"; });

    MaterialDesc metal;
    metal.name = "rough metal";
    metal.kind = material_conductor;
    metal.base_color = vec3(1.0f);
    metal.specular = vec3(1.0f);   // eta
    metal.absorption = vec3(6.0f); // k
    metal.alpha = 0.15f;
    find(scene.meshes, "tall block").material = add(scene, metal);

    MaterialDesc glass;
    glass.name = "glass";
    glass.kind = material_dielectric;
    glass.base_color = vec3(1.0f);
    glass.ior = 1.5f;
    place(scene, SphereDesc{"glass ball", {0.42f, 0.38f, 0.3f}, 0.38f, add(scene, glass)});
    validate(scene);
    return scene;
}

Scene make_glass_checker_reference()
{
    Scene scene;
    scene.name = "glass_checker";
    scene.environment.radiance = vec3(0.2f);
    MaterialDesc light, dark;
    light.base_color = vec3(0.8f);
    dark.base_color = vec3(0.1f);
    const auto even = add(scene, light), odd = add(scene, dark);
    place(scene, make_checkerboard("floor", 16, 16, 0.5f, even, odd));

    MaterialDesc glass;
    glass.name = "absorbing glass";
    glass.kind = material_dielectric;
    glass.base_color = vec3(1.0f);
    glass.ior = 1.5f;
    glass.absorption = vec3(0.6f);
    place(scene, SphereDesc{"ball", {0, 0.8f, 0}, 0.7f, add(scene, glass)});

    LightDesc point;
    point.position = {2, 4, 2};
    point.emission = vec3(20.0f);
    add(scene, point);
    add(scene, CameraDesc{"front", {0, 1.6f, 4}, {0, 0.7f, 0}, {0, 1, 0}, 36.0f});
    validate(scene);
    return scene;
}

} // namespace snell::test

// Whitted 1980, An improved illumination model for shaded display: the picture everybody remembers. A hollow glass ball
// floats in front of a mirror ball over a red and yellow checkerboard, under a blue sky.
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

namespace snell {

Scene make_whitted()
{
    Scene scene;
    scene.name = "whitted";
    scene.environment.radiance = vec3(0.25f, 0.45f, 0.85f);
    const auto red = add(scene, diffuse("red", {0.72f, 0.035f, 0.02f}));
    const auto yellow = add(scene, diffuse("yellow", {0.85f, 0.68f, 0.05f}));
    const auto shell = add(scene, glass("glass", 1.5f));
    const auto hollow = add(scene, glass("air in glass", 1.0f / 1.5f));
    const auto silver = add(scene, mix_of("silver", vec3(0.12f), vec3(0.78f), 0.0f));

    place(scene, make_checkerboard("floor", 12, 22, 1.0f, red, yellow), translation({1.5f, 0.0f, -5.0f}));
    const vec3 bubble(-0.35f, 2.0f, 1.2f);
    place(scene, SphereDesc{"bubble, outside", bubble, 1.0f, shell});
    place(scene, SphereDesc{"bubble, inside", bubble, 0.93f, hollow});
    place(scene, SphereDesc{"mirror ball", {1.15f, 1.25f, -1.0f}, 1.0f, silver});

    LightDesc lamp;
    lamp.name = "lamp";
    lamp.position = {-4.0f, 9.0f, 5.0f};
    lamp.emission = vec3(290.0f, 280.0f, 260.0f);
    add(scene, lamp);
    add(scene, CameraDesc{"1980", {0.0f, 2.6f, 7.6f}, {0.3f, 1.6f, 0.0f}, {0, 1, 0}, 31.0f});
    return scene;
}

} // namespace snell

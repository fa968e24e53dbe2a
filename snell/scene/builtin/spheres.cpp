// All primitives and all materials side by side, on an infinite checkered plane. From left to right:
//   back row    smooth gold, rough copper, a textured ball, a torus (a mesh) of brushed gold
//   middle row  glass, rough glass, coloured glass (absorbing), a lamp
//   front row   diffuse, polished paint (mix), satin paint (rough mix), a mirror
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

namespace snell {

Scene make_spheres()
{
    Scene scene;
    scene.name = "spheres";
    scene.environment.radiance = vec3(0.34f, 0.40f, 0.50f);

    MaterialDesc floor = diffuse("floor", vec3(1.0f));
    floor.base_texture.image = add(scene, make_checker_image("floor", {0.78f, 0.76f, 0.72f}, {0.42f, 0.42f, 0.44f}));
    add(scene, PlaneDesc{"floor", vec3(0.0f), vec3(0, 1, 0), add(scene, floor)});

    MaterialDesc checkered = mix_of("checkered", vec3(0.94f), vec3(0.05f), 0.1f);
    checkered.base_texture.image = add(scene, make_checker_image("ball", {0.95f, 0.75f, 0.3f}, {0.15f, 0.35f, 0.6f}));

    const auto ball = [&](int column, int row, const MaterialDesc& material) {
        const vec3 center(1.25f * (static_cast<float>(column) - 1.5f), 0.5f, -1.55f * static_cast<float>(row));
        place(scene, SphereDesc{material.name, center, 0.5f, add(scene, material)});
    };
    ball(0, 0, diffuse("diffuse", {0.75f, 0.12f, 0.08f}));
    ball(1, 0, mix_of("polished paint", {0.05f, 0.22f, 0.62f}, vec3(0.08f), 0.0f));
    ball(2, 0, mix_of("satin paint", {0.08f, 0.42f, 0.14f}, vec3(0.15f), 0.25f));
    ball(3, 0, mirror("mirror", vec3(0.92f)));
    ball(0, 1, glass("glass", 1.5f));
    ball(1, 1, glass("rough glass", 1.5f, 0.2f));
    ball(2, 1, glass("coloured glass", 1.5f, 0.0f, {0.25f, 2.2f, 1.6f}));
    ball(3, 1, emitter("lamp", {2.6f, 1.7f, 0.8f}));
    ball(0, 2, metal("gold", gold_eta, gold_k, 0.0f));
    ball(1, 2, metal("rough copper", copper_eta, copper_k, 0.25f));
    ball(2, 2, checkered);
    const auto brushed = add(scene, metal("brushed gold", gold_eta, gold_k, 0.15f));
    place(scene, make_torus("torus", 0.38f, 0.15f, 96, 48, brushed),
          compose(translation({1.875f, 0.5f, -3.1f}), rotation({1, 0, 0.35f}, 62.0f)));

    // A soft box above, and a small bright lamp that gives hard shadows.
    const auto soft = add(scene, emitter("soft box", vec3(7.0f)));
    place(scene, make_quad("soft box", {-3.5f, 6.0f, -2.5f}, {-0.5f, 6.0f, -2.5f}, {-0.5f, 6.0f, 0.5f},
                           {-3.5f, 6.0f, 0.5f}, soft));
    LightDesc lamp;
    lamp.name = "point lamp";
    lamp.position = {4.0f, 6.0f, 5.0f};
    lamp.emission = vec3(55.0f, 50.0f, 42.0f);
    add(scene, lamp);
    add(scene, CameraDesc{"front", {0.0f, 5.2f, 5.2f}, {0.0f, 0.18f, -1.35f}, {0, 1, 0}, 37.0f});
    return scene;
}

} // namespace snell

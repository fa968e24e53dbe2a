// Veach and Guibas 1995, Optimally combining sampling techniques for Monte Carlo rendering: the scene of figure 2, with
// the numbers of our reference picture.
#include "snell/scene/builtin/makers.h"
#include "snell/scene/shapes.h"

namespace snell {

Scene make_veach_mis()
{
    Scene scene;
    scene.name = "veach-mis";
    const auto grey = add(scene, diffuse("grey", vec3(0.4f)));
    place(scene, make_quad("floor", {-10, -4.14615f, -10}, {-10, -4.14615f, 10}, {10, -4.14615f, 10},
                           {10, -4.14615f, -10}, grey));
    place(scene, make_quad("back wall", {-10, -10, -2}, {10, -10, -2}, {10, 10, -2}, {-10, 10, -2}, grey));

    struct Plate
    {
        float alpha, near_y, near_z, far_y, far_z;
    };
    for (const Plate& p : {Plate{0.005f, -2.70651f, 0.25609f, -2.08375f, -0.526323f},
                           Plate{0.02f, -3.28825f, 1.36972f, -2.83856f, 0.476536f},
                           Plate{0.05f, -3.73096f, 2.70046f, -3.43378f, 1.74564f},
                           Plate{0.1f, -3.99615f, 4.0667f, -3.82069f, 3.08221f}}) {
        // eta 1 and k 6: a grey metal of reflectance 0.9 at normal incidence.
        const auto plate = add(scene, metal("plate", vec3(1.0f), vec3(6.0f), p.alpha));
        place(scene, make_quad("plate", {-4, p.near_y, p.near_z}, {4, p.near_y, p.near_z}, {4, p.far_y, p.far_z},
                               {-4, p.far_y, p.far_z}, plate));
    }

    struct Lamp
    {
        vec3 center;
        float radius, radiance;
    };
    for (const Lamp& l :
         {Lamp{{10, 10, 4}, 0.5f, 800.0f}, Lamp{{-3.75f, 0, 0}, 0.03333f, 901.803f}, Lamp{{-1.25f, 0, 0}, 0.1f, 100.0f},
          Lamp{{1.25f, 0, 0}, 0.3f, 11.1111f}, Lamp{{3.75f, 0, 0}, 0.9f, 1.23457f}}) {
        const auto light = add(scene, emitter("lamp", vec3(l.radiance)));
        place(scene, SphereDesc{"lamp", l.center, l.radius, light});
    }
    add(scene, CameraDesc{"front", {0, 2, 15}, {0, 1.69521f, 14.0476f}, {0, 0.952421f, -0.304787f}, 38.0f});
    return scene;
}

} // namespace snell

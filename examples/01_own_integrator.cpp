// An integrator of your own: one function in one file, registered by name.
//
//     build/release/examples/example_01_own_integrator [picture.png [scene]]
//
// This one is the first renderer of every course: the nearest surface, shaded by the cosine between its normal and the
// way to the camera, with ambient occlusion from one random ray a sample.
#include "snell/io/image/write.h"
#include "snell/io/load.h"
#include "snell/kernel/views.h"
#include "snell/render/integrator.h"
#include "snell/render/render.h"

#include <cstdio>
#include <exception>

using namespace snell;

// The radiance that arrives along `ray`. It is called once a sample; the renderer averages.
static vec3 soft_headlight(const RayScene& scene, const Ray& ray, SampleStream& sampler)
{
    const Hit hit = scene.intersect(ray);
    if (!is_hit(hit)) return vec3(0.1f, 0.1f, 0.12f);

    const Vertex vertex = make_vertex(scene.view, ray, hit);
    const SurfacePoint& surface = vertex.surface;
    const float side = dot(surface.shading_normal, ray.direction) > 0.0f ? -1.0f : 1.0f;
    const vec3 normal = side * surface.shading_normal;

    const vec3 direction = to_world(make_frame(normal), sample_cosine_hemisphere(sampler.next_2d()));
    const vec3 origin = offset_toward(surface.position, surface.geometric_normal, direction);
    const bool open = !scene.occluded(make_ray(origin, direction, 0.5f * scene.view.scene_radius));

    const float headlight = -dot(normal, ray.direction);
    return material_albedo(vertex.material) * (0.3f * headlight + (open ? 0.7f : 0.0f));
}

int main(int argc, char** argv)
try {
    const char* const picture = argc > 1 ? argv[1] : "own_integrator.png";
    register_integrator("headlight", "lambertian headlight with ambient occlusion", soft_headlight);

    RenderSettings settings;
    settings.width = 256;
    settings.height = 256;
    settings.spp = 16;
    settings.integrator = "headlight";

    Scene scene = open_scene(argc > 2 ? argv[2] : "spheres");
    complete(scene, 1.0f);
    const RenderResult result = render(scene, settings);
    write_picture(picture, result.film.picture());
    std::printf("%s: %llu samples in %.2f s\n", picture, static_cast<unsigned long long>(result.stats.samples),
                result.stats.render_seconds);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
}

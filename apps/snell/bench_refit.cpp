#include "bench_refit.h"

#include "bench_lane.h"
#include "console.h"

#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/lab/cross_check.h"

#ifdef SNELL_HAS_EMBREE
#include "bench/embree_rays.h"

#include "snell/bvh/embree_scene.h"
#endif

#include <fmt/format.h>

#include <memory>

namespace snell::app {

// A wave through the scene, a hundredth of its radius high.
static void deform(std::vector<vec3>& positions, const std::vector<vec3>& rest, float radius, int frame)
{
    const float amount = 0.01f * radius, phase = 0.9f * static_cast<float>(frame + 1);
    parallel_ranges(rest.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec3 p = rest[i] * (7.0f / radius);
            positions[i] = rest[i] + amount * vec3(sin(p.y + phase), sin(p.z + 1.3f * phase), sin(p.x + 0.7f * phase));
        }
    });
}

// Rays of a small picture of the scene.
static std::vector<Ray> test_rays(const Camera& camera)
{
    constexpr int side = 256;
    std::vector<Ray> rays;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            rays.push_back(camera_ray(camera, vec2((static_cast<float>(x) + 0.5f) / side * camera.width,
                                                   (static_cast<float>(y) + 0.5f) / side * camera.height)));
    return rays;
}

RefitFigures measure_refit(const std::string& name, BenchScene& bench, const AccelInfo& info, AccelOptions options,
                           bool with_embree, int frames, std::vector<std::string>& failures)
{
    PackedScene& scene = bench.packed;
    RefitFigures figures;
    figures.scene = name;
    figures.triangles = scene.triangles.size();
    console().info(fmt::format("{}: refitting {} triangles", name, figures.triangles));
    options.update = UpdatePolicy::refit;
    const std::unique_ptr<Accel> accel = info.make(scene, options);
#ifdef SNELL_HAS_EMBREE
    std::unique_ptr<EmbreeScene> embree;
    EmbreeSceneOptions dynamic;
    dynamic.dynamic = true;
    if (with_embree && scene.planes.empty()) embree = std::make_unique<EmbreeScene>(scene, dynamic);
#else
    (void)with_embree;
#endif

    const std::vector<vec3> rest = scene.positions;
    PackedChanges changes;
    changes.world = true;
    std::vector<double> ours, theirs;
    for (int frame = -1; frame < frames; ++frame) { // the first one warms up
        deform(scene.positions, rest, scene.radius, frame);
        const Timer timer;
        accel->update(changes);
        if (frame >= 0) ours.push_back(timer.seconds());
#ifdef SNELL_HAS_EMBREE
        if (!embree) continue;
        embree->update(changes);
        if (frame >= 0) theirs.push_back(embree->build_seconds()); // the vertices are copied outside its clock
#endif
    }
    figures.ours = spread_of(ours);
    figures.embree = spread_of(theirs);
    if (figures.embree.median > 0 && figures.ours.median > 0)
        figures.ratio = figures.embree.median / figures.ours.median;

    const Timer timer;
    const std::unique_ptr<Accel> fresh = info.make(scene, options);
    figures.rebuild_seconds = timer.seconds();
    const std::vector<Ray> rays = test_rays(bench.camera);
    std::vector<Hit> expected(rays.size()), found(rays.size());
    fresh->intersect(rays, expected);
    accel->intersect(rays, found);
    if (const Disagreement d = compare_hits(rays, expected, found); d.count > 0)
        failures.push_back(
            fmt::format("{}: after refitting, {} of {} rays hit something else than after rebuilding: {}", name,
                        d.count, rays.size(), d.text));
#ifdef SNELL_HAS_EMBREE
    if (!embree) return figures;
    bench::EmbreeRays queries(rays, 1, false);
    queries.trace(embree->handle(), 0, rays.size(), true);
    queries.hits(found);
    const Disagreement d = compare_hits_like_embree(scene, rays, expected, found);
    if (d.count > allowed_disagreements(rays.size()))
        failures.push_back(fmt::format("{}: after refitting, Embree disagrees about {} of {} rays: {}", name, d.count,
                                       rays.size(), d.text));
#endif
    return figures;
}

} // namespace snell::app

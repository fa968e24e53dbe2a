#include "bench/embree_path.h"

#include "snell/bvh/embree_rays.h"
#include "snell/bvh/embree_scene.h"
#include "snell/core/parallel.h"
#include "snell/kernel/intersect.h"
#include "snell/kernel/path.h"

#include <atomic>

namespace snell::bench {

struct EmbreePathTracer::Impl
{
    const PackedScene& packed;
    EmbreeScene scene;

    Impl(const PackedScene& p, const EmbreeSceneOptions& options) : packed(p), scene(p, options) {}
    Hit intersect(Ray ray) const;
    bool occluded(const Ray& ray) const;
};

static EmbreeSceneOptions options_for(EmbreeQuality quality)
{
    EmbreeSceneOptions options;
    if (quality == EmbreeQuality::high) options.quality = snell::EmbreeQuality::high;
    return options;
}

EmbreePathTracer::EmbreePathTracer(const PackedScene& scene, EmbreeQuality quality)
    : impl_(std::make_unique<Impl>(scene, options_for(quality)))
{
}

EmbreePathTracer::~EmbreePathTracer() = default;

double EmbreePathTracer::build_seconds() const
{
    return impl_->scene.build_seconds();
}

// The planes come first, so that Embree's ray ends at the nearest of them.
Hit EmbreePathTracer::Impl::intersect(Ray ray) const
{
    Hit on_plane = miss(ray.t_max);
    for (uint i = 0; i < packed.planes.size(); ++i) {
        const Intersection r = intersect_plane(ray, packed.planes[i].normal, packed.planes[i].offset);
        if (!r.ok) continue;
        on_plane = {r.t, 0.0f, 0.0f, pack_primitive(kind_plane, i), none};
        ray.t_max = r.t;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query = to_query(ray);
    rtcIntersect1(scene.handle(), &context, &query);
    return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? on_plane : to_hit(packed, query, ray.t_max);
}

bool EmbreePathTracer::Impl::occluded(const Ray& ray) const
{
    for (const Plane& plane : packed.planes)
        if (intersect_plane(ray, plane.normal, plane.offset).ok) return true;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = to_embree(ray);
    rtcOccluded1(scene.handle(), &context, &query);
    return query.tfar < 0.0f;
}

std::uint64_t EmbreePathTracer::render(const RenderParams& params, uint count, Film& film) const
{
    const SceneView view = impl_->packed.view();
    std::atomic<std::uint64_t> all_rays = 0;
    constexpr uint tile = 16;
    const uint columns = (params.width + tile - 1) / tile;
    const uint rows = (params.height + tile - 1) / tile;
    parallel_for(columns * rows, [&](std::size_t i) {
        const uint x0 = static_cast<uint>(i) % columns * tile;
        const uint y0 = static_cast<uint>(i) / columns * tile;
        std::uint64_t rays = 0;
        for (uint y = y0; y < std::min(y0 + tile, params.height); ++y)
            for (uint x = x0; x < std::min(x0 + tile, params.width); ++x)
                for (uint s = 0; s < count; ++s) {
                    CameraPath path = generate_camera_path(params, x, y, s, 0);
                    vec3 radiance(0.0f);
                    for (;;) {
                        rays += 1;
                        const Hit hit = impl_->intersect(path.ray);
                        const PathStep step = shade_path(view, params, path.state, path.ray, hit);
                        radiance += step.emitted;
                        if (step.has_connection != 0u) {
                            rays += 1;
                            if (!impl_->occluded(step.connection.ray)) radiance += step.connection.value;
                        }
                        if (step.has_next == 0u) break;
                        path = step.next;
                    }
                    if (is_finite3(radiance)) film.sum[y * params.width + x] += radiance;
                    film.sample_count[y * params.width + x] += 1;
                }
        all_rays += rays;
    });
    return all_rays;
}

} // namespace snell::bench

#include "bench/embree_path.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/kernel/path.h"

#include <embree3/rtcore.h>

#include <atomic>

namespace snell::bench {

struct EmbreePathTracer::Impl
{
    const PackedScene& packed;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    double build_seconds = 0;

    explicit Impl(const PackedScene& p) : packed(p) {}
    ~Impl()
    {
        if (scene != nullptr) rtcReleaseScene(scene);
        if (device != nullptr) rtcReleaseDevice(device);
    }
    Hit intersect(const Ray& ray) const;
    bool occluded(const Ray& ray) const;
};

EmbreePathTracer::EmbreePathTracer(const PackedScene& scene, EmbreeQuality quality)
    : impl_(std::make_unique<Impl>(scene))
{
    if (!scene.spheres.empty() || !scene.planes.empty() || !scene.instances.empty())
        throw Error("the comparison with Embree takes scenes of triangles without instances",
                    "give it an OBJ, PLY or STL file, or the built-in cornell");
    const Timer timer;
    impl_->device = rtcNewDevice(nullptr);
    if (impl_->device == nullptr) throw Error("Embree does not start", "check the installation of libembree");
    impl_->scene = rtcNewScene(impl_->device);
    rtcSetSceneBuildQuality(impl_->scene,
                            quality == EmbreeQuality::high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copies: Embree reads 16 bytes at each vertex, so a shared buffer would have to end with padding.
    auto* vertices = static_cast<vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                sizeof(vec3), scene.positions.size()));
    auto* indices = static_cast<uvec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                sizeof(uvec3), scene.triangles.size()));
    std::copy(scene.positions.begin(), scene.positions.end(), vertices);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        indices[i] = uvec3(scene.triangles[i].v0, scene.triangles[i].v1, scene.triangles[i].v2);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(impl_->scene, geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene);
    impl_->build_seconds = timer.seconds();
}

EmbreePathTracer::~EmbreePathTracer() = default;

double EmbreePathTracer::build_seconds() const
{
    return impl_->build_seconds;
}

static RTCRay to_embree(const Ray& ray)
{
    RTCRay r{};
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = ray.t_min;
    r.tfar = ray.t_max;
    r.mask = 0xffffffffu;
    return r;
}

Hit EmbreePathTracer::Impl::intersect(const Ray& ray) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{to_embree(ray), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return miss(ray.t_max);
    return {query.ray.tfar, query.hit.u, query.hit.v, pack_primitive(kind_triangle, query.hit.primID), none};
}

bool EmbreePathTracer::Impl::occluded(const Ray& ray) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = to_embree(ray);
    rtcOccluded1(scene, &context, &query);
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

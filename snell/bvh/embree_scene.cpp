#ifdef SNELL_HAS_EMBREE
#include "snell/bvh/embree_scene.h"

#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/kernel/intersect.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>

namespace snell {
namespace {

constexpr uint triangle_geometry = 0, sphere_geometry = 1, first_instance_geometry = 2;

// What the callbacks of a group's spheres look at.
struct SphereRun
{
    const PackedScene* scene = nullptr;
    uint first = 0;
};

void bound_sphere(const RTCBoundsFunctionArguments* arguments)
{
    const auto& run = *static_cast<const SphereRun*>(arguments->geometryUserPtr);
    const Sphere& ball = run.scene->spheres[run.first + arguments->primID];
    const vec3 c = ball.center;
    const float r = abs(ball.radius), inf = infinity();
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = std::nextafter(c.x - r, -inf), box.upper_x = std::nextafter(c.x + r, inf);
    box.lower_y = std::nextafter(c.y - r, -inf), box.upper_y = std::nextafter(c.y + r, inf);
    box.lower_z = std::nextafter(c.z - r, -inf), box.upper_z = std::nextafter(c.z + r, inf);
}

Ray ray_of_lane(RTCRayN* rays, uint count, uint lane)
{
    Ray ray;
    ray.origin = {RTCRayN_org_x(rays, count, lane), RTCRayN_org_y(rays, count, lane), RTCRayN_org_z(rays, count, lane)};
    ray.direction = {RTCRayN_dir_x(rays, count, lane), RTCRayN_dir_y(rays, count, lane),
                     RTCRayN_dir_z(rays, count, lane)};
    ray.t_min = RTCRayN_tnear(rays, count, lane);
    ray.t_max = std::nextafter(RTCRayN_tfar(rays, count, lane), infinity()); // Embree's interval includes its end
    return ray;
}

// Embree's packets have at most so many lanes, and a hit so many rows: normal, u, v, primitive, geometry, instance.
constexpr uint most_lanes = 16, hit_rows = 8;

// The point of the ray of a lane where it meets the sphere, as a hit in that lane; the context's filter is asked about
// the nearer and then the farther one. If it is accepted the ray ends there. valid: that of the callback.
bool meet_sphere(const int* valid, const SphereRun& run, uint primitive, uint geometry, RTCIntersectContext* context,
                 void* user, RTCRayN* rays, uint count, uint lane, RTCHit& hit)
{
    if (valid[lane] == 0) return false;
    const Sphere& ball = run.scene->spheres[run.first + primitive];
    Ray ray = ray_of_lane(rays, count, lane);
    float& end = RTCRayN_tfar(rays, count, lane);
    const float last = end;
    for (;;) {
        const Intersection found = intersect_sphere(ray, ball.center, ball.radius);
        if (!found.ok) break;
        const vec3 normal = ray_at(ray, found.t) - ball.center;
        hit = {normal.x, normal.y, normal.z, 0.0f, 0.0f, primitive, geometry, {context->instID[0]}};
        end = found.t;
        if (context->filter == nullptr) return true;
        alignas(64) float rows[hit_rows * most_lanes] = {};
        int asked[most_lanes] = {};
        asked[lane] = -1;
        rtcCopyHitToHitN(reinterpret_cast<RTCHitN*>(rows), &hit, count, lane);
        const RTCFilterFunctionNArguments question = {asked, user, context, rays, reinterpret_cast<RTCHitN*>(rows),
                                                      count};
        context->filter(&question);
        if (asked[lane] != 0) return true;
        ray.t_min = found.t;
    }
    end = last;
    return false;
}

void intersect_sphere_lanes(const RTCIntersectFunctionNArguments* a)
{
    SNELL_CHECK_LE(a->N, most_lanes);
    const auto& run = *static_cast<const SphereRun*>(a->geometryUserPtr);
    RTCRayN* rays = RTCRayHitN_RayN(a->rayhit, a->N);
    RTCHit hit;
    for (uint lane = 0; lane < a->N; ++lane)
        if (meet_sphere(a->valid, run, a->primID, a->geomID, a->context, a->geometryUserPtr, rays, a->N, lane, hit))
            rtcCopyHitToHitN(RTCRayHitN_HitN(a->rayhit, a->N), &hit, a->N, lane);
}

void occlude_sphere_lanes(const RTCOccludedFunctionNArguments* a)
{
    SNELL_CHECK_LE(a->N, most_lanes);
    const auto& run = *static_cast<const SphereRun*>(a->geometryUserPtr);
    RTCHit hit;
    for (uint lane = 0; lane < a->N; ++lane)
        if (meet_sphere(a->valid, run, a->primID, a->geomID, a->context, a->geometryUserPtr, a->ray, a->N, lane, hit))
            RTCRayN_tfar(a->ray, a->N, lane) = -infinity();
}

// A scene of Embree's that goes away by itself.
struct SceneHandle
{
    RTCScene scene = nullptr;

    explicit SceneHandle(RTCDevice device) : scene(rtcNewScene(device)) {}
    ~SceneHandle()
    {
        if (scene != nullptr) rtcReleaseScene(scene);
    }
    SceneHandle(SceneHandle&& other) noexcept : scene(std::exchange(other.scene, nullptr)) {}
    SceneHandle& operator=(SceneHandle&&) = delete;
};

RTCBuildQuality quality_of(EmbreeQuality quality)
{
    switch (quality) {
    case EmbreeQuality::low:
        return RTC_BUILD_QUALITY_LOW;
    case EmbreeQuality::medium:
        return RTC_BUILD_QUALITY_MEDIUM;
    case EmbreeQuality::high:
        break;
    }
    return RTC_BUILD_QUALITY_HIGH;
}

} // namespace

struct EmbreeScene::Impl
{
    const PackedScene& packed;
    const EmbreeSceneOptions options;
    std::vector<float> vertices; // copies, and one number more, for Embree reads 16 bytes at each
    std::vector<SphereRun> runs; // of the groups, then of the world
    RTCDevice device = nullptr;
    std::vector<SceneHandle> groups;
    std::optional<SceneHandle> world;
    double seconds = 0;
    std::atomic<std::int64_t> bytes = 0;
    std::mutex error_lock;
    std::string error;

    Impl(const PackedScene& scene, const EmbreeSceneOptions& chosen) : packed(scene), options(chosen) {}
    ~Impl()
    {
        world.reset();
        groups.clear();
        if (device != nullptr) rtcReleaseDevice(device);
    }

    void start();
    void build();
    void check();
    void copy_vertices(const PackedGroup& group);
    void add_primitives(RTCScene scene, const PackedGroup& group, SphereRun& run);
    void add_instance(uint number);
    void update_primitives(RTCScene scene, const PackedGroup& group);
    RTCScene new_scene(SceneHandle& handle) const;
    bool is_empty(const PackedGroup& group) const { return group.triangle_count == 0 && group.sphere_count == 0; }
};

void EmbreeScene::Impl::start()
{
    device = rtcNewDevice(nullptr);
    if (device == nullptr)
        throw Error(fmt::format("Embree does not start (its error {})", static_cast<int>(rtcGetDeviceError(nullptr))),
                    "check the installation of libembree3-3, or take another --accel");
    rtcSetDeviceErrorFunction(
        device,
        [](void* self, RTCError code, const char* text) {
            auto& impl = *static_cast<Impl*>(self);
            const std::lock_guard lock(impl.error_lock);
            if (impl.error.empty()) impl.error = fmt::format("{} (its error {})", text, static_cast<int>(code));
        },
        this);
    rtcSetDeviceMemoryMonitorFunction(
        device,
        [](void* self, ssize_t change, bool) {
            static_cast<Impl*>(self)->bytes += change;
            return true;
        },
        this);
}

void EmbreeScene::Impl::check()
{
    const std::lock_guard lock(error_lock);
    if (!error.empty())
        throw Error(fmt::format("Embree cannot build its tree: {}", error), "take another --accel, or a smaller scene");
}

RTCScene EmbreeScene::Impl::new_scene(SceneHandle& handle) const
{
    int flags = RTC_SCENE_FLAG_NONE;
    if (options.robust) flags |= RTC_SCENE_FLAG_ROBUST;
    if (options.dynamic) flags |= RTC_SCENE_FLAG_DYNAMIC;
    if (options.filter) flags |= RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
    rtcSetSceneFlags(handle.scene, static_cast<RTCSceneFlags>(flags));
    // Only scenes of low quality have a tree for each geometry, which can be refitted; how good those are is then said
    // by the geometries.
    rtcSetSceneBuildQuality(handle.scene, options.dynamic ? RTC_BUILD_QUALITY_LOW : quality_of(options.quality));
    return handle.scene;
}

void EmbreeScene::Impl::copy_vertices(const PackedGroup& group)
{
    uint first = none, last = 0;
    for (uint i = 0; i < group.triangle_count; ++i) {
        const Triangle& tri = packed.triangles[group.first_triangle + i];
        first = std::min({first, tri.v0, tri.v1, tri.v2});
        last = std::max({last, tri.v0, tri.v1, tri.v2});
    }
    if (first <= last) std::memcpy(&vertices[3 * first], &packed.positions[first], (last - first + 1) * sizeof(vec3));
}

// The geometries are as good as the scene, or made for refitting.
void EmbreeScene::Impl::add_primitives(RTCScene scene, const PackedGroup& group, SphereRun& run)
{
    const auto attach = [&](RTCGeometry geometry, uint number) {
        rtcSetGeometryBuildQuality(geometry, options.dynamic ? RTC_BUILD_QUALITY_REFIT : quality_of(options.quality));
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, number);
        rtcReleaseGeometry(geometry);
    };
    if (group.triangle_count > 0) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0,
                                   sizeof(vec3), packed.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   packed.triangles.data() + group.first_triangle, 0, sizeof(Triangle),
                                   group.triangle_count);
        attach(geometry, triangle_geometry);
    }
    if (group.sphere_count > 0) {
        run = {&packed, group.first_sphere};
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, group.sphere_count);
        rtcSetGeometryUserData(geometry, &run);
        rtcSetGeometryBoundsFunction(geometry, bound_sphere, nullptr);
        rtcSetGeometryIntersectFunction(geometry, intersect_sphere_lanes);
        rtcSetGeometryOccludedFunction(geometry, occlude_sphere_lanes);
        attach(geometry, sphere_geometry);
    }
}

void EmbreeScene::Impl::add_instance(uint number)
{
    const Instance& instance = packed.instances[number];
    if (is_empty(packed.groups[instance.group])) return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, groups[instance.group].scene);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, &instance.to_world);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(world->scene, geometry, first_instance_geometry + number);
    rtcReleaseGeometry(geometry);
}

void EmbreeScene::Impl::build()
{
    static_assert(sizeof(Transform) == 12 * sizeof(float));
    vertices.resize(3 * packed.positions.size() + 1);
    if (!packed.positions.empty())
        std::memcpy(vertices.data(), packed.positions.data(), packed.positions.size() * sizeof(vec3));
    runs.resize(packed.groups.size() + 1);
    start();
    const Timer timer;
    groups.reserve(packed.groups.size());
    for (std::size_t i = 0; i < packed.groups.size(); ++i) {
        groups.emplace_back(device);
        RTCScene scene = new_scene(groups.back());
        add_primitives(scene, packed.groups[i], runs[i]);
        rtcCommitScene(scene);
    }
    world.emplace(device);
    RTCScene scene = new_scene(*world);
    add_primitives(scene, packed.world, runs.back());
    for (uint i = 0; i < packed.instances.size(); ++i) add_instance(i);
    rtcCommitScene(scene);
    seconds = timer.seconds();
    check();
}

void EmbreeScene::Impl::update_primitives(RTCScene scene, const PackedGroup& group)
{
    if (group.triangle_count > 0) {
        RTCGeometry geometry = rtcGetGeometry(scene, triangle_geometry);
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
    }
    if (group.sphere_count > 0) rtcCommitGeometry(rtcGetGeometry(scene, sphere_geometry));
}

EmbreeScene::EmbreeScene(const PackedScene& scene, const EmbreeSceneOptions& options)
    : impl_(std::make_unique<Impl>(scene, options))
{
    impl_->build();
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::update(const PackedChanges& changes)
{
    if (!changes.any()) return;
    Impl& impl = *impl_;
    const PackedScene& packed = impl.packed;
    if (changes.world) impl.copy_vertices(packed.world);
    for (const uint group : changes.groups) impl.copy_vertices(packed.groups[group]);

    const Timer timer;
    for (const uint group : changes.groups) {
        impl.update_primitives(impl.groups[group].scene, packed.groups[group]);
        rtcCommitScene(impl.groups[group].scene);
    }
    if (changes.world) impl.update_primitives(impl.world->scene, packed.world);
    // The bounds of an instance are those of its group, so it has to be committed if only the group has changed.
    for (uint i = 0; i < packed.instances.size(); ++i) {
        const Instance& instance = packed.instances[i];
        if (impl.is_empty(packed.groups[instance.group])) continue;
        if (!changes.instances && !std::binary_search(changes.groups.begin(), changes.groups.end(), instance.group))
            continue;
        RTCGeometry geometry = rtcGetGeometry(impl.world->scene, first_instance_geometry + i);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, &instance.to_world);
        rtcCommitGeometry(geometry);
    }
    rtcCommitScene(impl.world->scene);
    impl.seconds = timer.seconds();
    impl.check();
}

RTCScene EmbreeScene::handle() const
{
    return impl_->world->scene;
}

double EmbreeScene::build_seconds() const
{
    return impl_->seconds;
}

std::size_t EmbreeScene::bytes() const
{
    return static_cast<std::size_t>(std::max<std::int64_t>(impl_->bytes, 0));
}

} // namespace snell
#endif

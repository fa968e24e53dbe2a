#include "snell/bvh/embree.h"

#include "snell/core/error.h"

#ifndef SNELL_HAS_EMBREE

namespace snell {

std::unique_ptr<Accel> make_embree(const PackedScene&, const AccelOptions&)
{
    throw Error("this snell was built without Embree",
                "install the package libembree-dev and build again, or take another --accel");
}

} // namespace snell

#else

#include "snell/bvh/embree_batch.h"
#include "snell/bvh/embree_rays.h"
#include "snell/bvh/embree_scene.h"
#include "snell/core/timer.h"
#include "snell/kernel/intersect.h"

#include <algorithm>
#include <array>

namespace snell {
namespace {

// A packet in Embree's order: twelve rows of the rays, eight of the hits.
constexpr uint most_packet_lanes = 16, ray_rows = 12, hit_rows = 8;
struct alignas(64) Packet
{
    float rows[(ray_rows + hit_rows) * most_packet_lanes];
    alignas(64) int valid[most_packet_lanes];
};

void put(Packet& packet, uint width, uint lane, const RTCRay& ray)
{
    auto* rays = reinterpret_cast<RTCRayN*>(packet.rows);
    RTCRayN_org_x(rays, width, lane) = ray.org_x;
    RTCRayN_org_y(rays, width, lane) = ray.org_y;
    RTCRayN_org_z(rays, width, lane) = ray.org_z;
    RTCRayN_tnear(rays, width, lane) = ray.tnear;
    RTCRayN_dir_x(rays, width, lane) = ray.dir_x;
    RTCRayN_dir_y(rays, width, lane) = ray.dir_y;
    RTCRayN_dir_z(rays, width, lane) = ray.dir_z;
    RTCRayN_time(rays, width, lane) = 0.0f;
    RTCRayN_tfar(rays, width, lane) = ray.tfar;
    RTCRayN_mask(rays, width, lane) = ray.mask;
    RTCRayN_id(rays, width, lane) = ray.id;
    RTCRayN_flags(rays, width, lane) = 0;
    packet.valid[lane] = -1;
}

EmbreeQuality quality_for(const BuildOptions& options)
{
    if (!options.builder.empty() && find_builder(options.builder) == nullptr)
        build_tree({}, {}, options); // throws, and names the nearest
    if (options.builder == "lbvh") return EmbreeQuality::low;
    if (options.builder == "sbvh") return EmbreeQuality::high;
    return EmbreeQuality::medium;
}

class EmbreeAccel : public Accel
{
  public:
    EmbreeAccel(const PackedScene& packed, const AccelOptions& chosen)
        : scene(packed), options(chosen),
          test(chosen.triangle_test == TriangleTest::moller_trumbore ? test_moller_trumbore : test_watertight)
    {
        build(false);
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        trace(rays, nullptr, hits);
    }

    void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), after.size());
        std::vector<Ray> onward(rays.begin(), rays.end());
        for (std::size_t i = 0; i < rays.size(); ++i) onward[i].t_min = float_before(after[i].t);
        trace(onward, after.data(), hits);
    }

    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        SNELL_CHECK_EQ(rays.size(), steps.size());
        intersect(rays, hits);
        std::fill(steps.begin(), steps.end(), 0u);
    }

    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override;

    void update(const PackedChanges& changes) override;

  private:
    const PackedScene& scene;
    const AccelOptions options;
    const uint test;
    std::unique_ptr<EmbreeScene> tree;
    bool refits = false;
    uint packet_width = 0;
    vec3 lower{0.0f}, upper{0.0f};

    void build(bool dynamic);
    void take_stats();
    void trace(std::span<const Ray> rays, const Hit* after, std::span<Hit> hits) const;
    bool start(EmbreeBatch& batch, uint lane, RTCRay& ray) const;
    void trace_chunk(EmbreeBatch& batch, std::size_t count) const;
    void occlude_chunk(std::span<const Ray> rays, std::uint8_t* blocked) const;
    bool meets_plane(const Ray& ray) const;
    std::size_t chunk_length() const;
    EmbreeLane lane_for(const Ray& ray) const;
};

void EmbreeAccel::build(bool dynamic)
{
    EmbreeSceneOptions chosen;
    chosen.quality = quality_for(options.build);
    chosen.robust = options.triangle_test == TriangleTest::watertight;
    chosen.dynamic = dynamic;
    chosen.filter = true;
    const Timer timer;
    tree.reset(); // not two at once
    tree = std::make_unique<EmbreeScene>(scene, chosen);
    refits = dynamic;
    stats.build_seconds = timer.seconds();
    RTCDevice device = rtcGetSceneDevice(tree->handle());
    packet_width = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0  ? 16
                   : rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0 ? 8
                                                                                                  : 4;
    rtcReleaseDevice(device); // rtcGetSceneDevice() retains it
    take_stats();
}

void EmbreeAccel::take_stats()
{
    stats.bytes = tree->bytes() + scene.positions.size() * sizeof(vec3);
    RTCBounds box;
    rtcGetSceneBounds(tree->handle(), &box);
    lower = {box.lower_x, box.lower_y, box.lower_z};
    upper = {box.upper_x, box.upper_y, box.upper_z};
}

void EmbreeAccel::update(const PackedChanges& changes)
{
    stats.refitted = stats.rebuilt = 0;
    if (!changes.any()) return;
    const Timer timer;
    const bool refit = options.update == UpdatePolicy::refit;
    const std::size_t trees = changes.groups.size() + (changes.world ? 1 : 0);
    if (refit && !refits && trees > 0) {
        build(true);
        stats.rebuilt = trees;
    } else {
        tree->update(changes);
        (refits ? stats.refitted : stats.rebuilt) = trees;
    }
    take_stats();
    stats.build_seconds = timer.seconds();
}

// Beyond, Embree's numbers overflow; it refuses such geometry itself.
constexpr float far_away = 1e18f;

bool is_near(vec3 p)
{
    return max3(abs(p)) <= far_away;
}

// Rays that begin behind their origin, or far away, begin at the scene's box at the earliest, so that no digits are
// lost.
EmbreeLane EmbreeAccel::lane_for(const Ray& ray) const
{
    EmbreeLane lane;
    const float longest = max3(abs(ray.direction));
    if (longest < 0x1p-20f || longest > 0x1p20f) lane.scale = std::exp2(-std::floor(std::log2(longest)));
    if (ray.t_min < 0.0f || !is_near(ray.origin)) {
        double enter = ray.t_min;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = ray.direction[axis];
            if (d == 0) continue;
            const double margin = 1e-3 * (double(upper[axis]) - lower[axis]) + 1e-3 * std::abs(ray.origin[axis]);
            const double a = (lower[axis] - margin - ray.origin[axis]) / d;
            const double b = (upper[axis] + margin - ray.origin[axis]) / d;
            enter = std::max(enter, std::min(a, b));
        }
        lane.start = enter < 0 || !is_near(ray.origin) ? static_cast<float>(enter) : 0.0f;
    }
    return lane;
}

// The ray of a lane as Embree takes it, after the planes have had their say. False: there is nothing to ask.
bool EmbreeAccel::start(EmbreeBatch& batch, uint lane, RTCRay& ray) const
{
    const Ray& ours = batch.rays[lane];
    Hit& hit = batch.hits[lane];
    hit = miss(ours.t_max);
    if (!is_traceable(ours)) return false;
    const ShearedRay& shear = batch.shears[lane] = shear_ray(ours);
    for (uint i = 0; i < scene.planes.size(); ++i) {
        const uint primitive = pack_primitive(kind_plane, i);
        const Intersection r = meet_primitive(batch, lane, primitive, none, ours, shear);
        if (r.ok && is_better_hit(r.t, primitive, none, hit)) hit = {r.t, 0.0f, 0.0f, primitive, none};
    }
    const EmbreeLane& map = batch.lanes[lane] = lane_for(ours);
    Ray shifted = ours;
    if (map.start != 0.0f) shifted.origin = ray_at(ours, map.start);
    if (map.scale != 1.0f) shifted.direction = ours.direction * map.scale;
    shifted.t_min = max(map.to_embree(ours.t_min), 0.0f);
    shifted.t_min = max(shifted.t_min - shifted.t_min * embree_slack, 0.0f);
    shifted.t_max = a_little_later(map.to_embree(hit.t));
    if (!is_finite3(shifted.origin) || !is_near(shifted.origin) || !(shifted.t_max >= shifted.t_min)) return false;
    ray = to_embree(shifted);
    ray.id = lane;
    return true;
}

std::size_t EmbreeAccel::chunk_length() const
{
    switch (options.traversal) {
    case Traversal::packets:
        return packet_width;
    case Traversal::stream:
        return embree_stream_length;
    case Traversal::automatic:
    case Traversal::single:
        break;
    }
    return 1;
}

void EmbreeAccel::trace(std::span<const Ray> rays, const Hit* after, std::span<Hit> hits) const
{
    const SceneView view = scene.view();
    EmbreeBatch batch;
    rtcInitIntersectContext(&batch.context);
    batch.context.filter = settle_hits;
    batch.scene = &scene;
    batch.view = &view;
    batch.test = test;
    const std::size_t length = chunk_length();
    for (std::size_t i = 0; i < rays.size(); i += length) {
        batch.rays = &rays[i];
        batch.after = after == nullptr ? nullptr : after + i;
        batch.hits = &hits[i];
        trace_chunk(batch, std::min(length, rays.size() - i));
    }
}

void EmbreeAccel::trace_chunk(EmbreeBatch& batch, std::size_t count) const
{
    RTCRay ray;
    const auto no_hit_yet = [](RTCHit& hit) {
        hit.geomID = RTC_INVALID_GEOMETRY_ID;
        hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    };
    if (options.traversal == Traversal::packets) {
        Packet packet = {};
        auto* all = reinterpret_cast<RTCRayHitN*>(packet.rows);
        for (uint lane = 0; lane < count; ++lane)
            if (start(batch, lane, ray)) put(packet, packet_width, lane, ray);
        for (uint lane = 0; lane < packet_width; ++lane) {
            RTCHitN_geomID(RTCRayHitN_HitN(all, packet_width), packet_width, lane) = RTC_INVALID_GEOMETRY_ID;
            RTCHitN_instID(RTCRayHitN_HitN(all, packet_width), packet_width, lane, 0) = RTC_INVALID_GEOMETRY_ID;
        }
        void* rows = packet.rows;
        if (packet_width == 16)
            rtcIntersect16(packet.valid, tree->handle(), &batch.context, static_cast<RTCRayHit16*>(rows));
        else if (packet_width == 8)
            rtcIntersect8(packet.valid, tree->handle(), &batch.context, static_cast<RTCRayHit8*>(rows));
        else
            rtcIntersect4(packet.valid, tree->handle(), &batch.context, static_cast<RTCRayHit4*>(rows));
        return;
    }
    std::array<RTCRayHit, embree_stream_length> queries;
    uint asked = 0;
    for (uint lane = 0; lane < count; ++lane) {
        if (!start(batch, lane, queries[asked].ray)) continue;
        no_hit_yet(queries[asked].hit);
        ++asked;
    }
    if (options.traversal == Traversal::stream)
        rtcIntersect1M(tree->handle(), &batch.context, queries.data(), asked, sizeof(RTCRayHit));
    else if (asked == 1)
        rtcIntersect1(tree->handle(), &batch.context, queries.data());
}

bool EmbreeAccel::meets_plane(const Ray& ray) const
{
    for (const Plane& plane : scene.planes)
        if (intersect_plane(ray, plane.normal, plane.offset).ok) return true;
    return false;
}

void EmbreeAccel::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const
{
    SNELL_CHECK_EQ(rays.size(), blocked.size());
    const std::size_t length = chunk_length();
    for (std::size_t i = 0; i < rays.size(); i += length)
        occlude_chunk(rays.subspan(i, std::min(length, rays.size() - i)), &blocked[i]);
}

void EmbreeAccel::occlude_chunk(std::span<const Ray> rays, std::uint8_t* blocked) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    std::array<RTCRay, embree_stream_length> queries;
    uint asked = 0;
    for (uint lane = 0; lane < rays.size(); ++lane) {
        const Ray& ray = rays[lane];
        blocked[lane] = 0;
        if (!is_traceable(ray)) continue;
        if (meets_plane(ray)) {
            blocked[lane] = 1;
            continue;
        }
        const EmbreeLane map = lane_for(ray);
        if (map.start == 0.0f && map.scale == 1.0f && is_near(ray.origin)) {
            Ray forward = ray;
            forward.t_min = max(ray.t_min, 0.0f);
            if (!(forward.t_min < forward.t_max)) continue; // all of it is behind the origin, and the scene is not
            queries[asked] = to_embree(forward);
            queries[asked++].id = lane;
        } else {
            Hit hit;
            trace({&ray, 1}, nullptr, {&hit, 1});
            blocked[lane] = is_hit(hit) ? 1 : 0;
        }
    }
    if (options.traversal == Traversal::packets) {
        Packet packet = {};
        for (uint i = 0; i < asked; ++i) put(packet, packet_width, i, queries[i]);
        void* rows = packet.rows;
        if (packet_width == 16)
            rtcOccluded16(packet.valid, tree->handle(), &context, static_cast<RTCRay16*>(rows));
        else if (packet_width == 8)
            rtcOccluded8(packet.valid, tree->handle(), &context, static_cast<RTCRay8*>(rows));
        else
            rtcOccluded4(packet.valid, tree->handle(), &context, static_cast<RTCRay4*>(rows));
        for (uint i = 0; i < asked; ++i)
            queries[i].tfar = RTCRayN_tfar(reinterpret_cast<RTCRayN*>(packet.rows), packet_width, i);
    } else if (options.traversal == Traversal::stream) {
        rtcOccluded1M(tree->handle(), &context, queries.data(), asked, sizeof(RTCRay));
    } else if (asked == 1) {
        rtcOccluded1(tree->handle(), &context, queries.data());
    }
    for (uint i = 0; i < asked; ++i)
        if (queries[i].tfar < 0.0f) blocked[queries[i].id] = 1;
}

} // namespace

std::unique_ptr<Accel> make_embree(const PackedScene& scene, const AccelOptions& options)
{
    return std::make_unique<EmbreeAccel>(scene, options);
}

} // namespace snell
#endif

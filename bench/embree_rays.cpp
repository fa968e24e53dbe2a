#include "bench/embree_rays.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <variant>
#include <vector>

namespace snell::bench {

namespace {

void reset_hit(RTCRayHit& query)
{
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}
void reset_hit(RTCRay&) {}
template <class Packet>
requires requires(Packet p)
{
    p.hit.geomID[0];
}
void reset_hit(Packet& packet)
{
    std::fill(std::begin(packet.hit.geomID), std::end(packet.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    std::fill(std::begin(packet.hit.instID[0]), std::end(packet.hit.instID[0]), RTC_INVALID_GEOMETRY_ID);
}
template <class Packet>
requires requires(Packet p)
{
    p.tfar[0];
}
void reset_hit(Packet&) {}

// The ray part of a query, whichever it is.
template <class Query>
auto& ray_of(Query& query)
{
    if constexpr (requires { query.ray; })
        return query.ray;
    else
        return query;
}

template <class Query>
constexpr bool is_packet = requires(Query q)
{
    ray_of(q).tfar[0];
};

template <class Query>
constexpr uint width_of()
{
    if constexpr (is_packet<Query>)
        return static_cast<uint>(sizeof(ray_of(std::declval<Query&>()).tfar) / sizeof(float));
    else
        return 1;
}

// One number of a query: of a single ray, or of a lane.
template <class Field>
auto& lane_of(Field& field, uint lane)
{
    if constexpr (std::is_array_v<Field>)
        return field[lane];
    else
        return field;
}

template <class Query>
void set_ray(Query& query, uint lane, const Ray& ray)
{
    auto& r = ray_of(query);
    lane_of(r.org_x, lane) = ray.origin.x, lane_of(r.org_y, lane) = ray.origin.y, lane_of(r.org_z, lane) = ray.origin.z;
    lane_of(r.dir_x, lane) = ray.direction.x, lane_of(r.dir_y, lane) = ray.direction.y;
    lane_of(r.dir_z, lane) = ray.direction.z;
    lane_of(r.tnear, lane) = ray.t_min;
    lane_of(r.tfar, lane) = ray.t_max;
    lane_of(r.time, lane) = 0.0f;
    lane_of(r.mask, lane) = 0xffffffffu;
    lane_of(r.id, lane) = 0;
    lane_of(r.flags, lane) = 0;
}

template <class Query>
using Queries = std::vector<Query>;

alignas(64) constexpr std::array<int, 16> all_lanes = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

void call(const int*, RTCScene scene, RTCIntersectContext* context, RTCRayHit& query)
{
    rtcIntersect1(scene, context, &query);
}
void call(const int*, RTCScene scene, RTCIntersectContext* context, RTCRay& query)
{
    rtcOccluded1(scene, context, &query);
}
void call(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8& query)
{
    rtcIntersect8(valid, scene, context, &query);
}
void call(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8& query)
{
    rtcOccluded8(valid, scene, context, &query);
}
void call(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16& query)
{
    rtcIntersect16(valid, scene, context, &query);
}
void call(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay16& query)
{
    rtcOccluded16(valid, scene, context, &query);
}

} // namespace

struct EmbreeRays::Impl
{
    std::span<const Ray> rays;
    std::variant<Queries<RTCRayHit>, Queries<RTCRay>, Queries<RTCRayHit8>, Queries<RTCRay8>, Queries<RTCRayHit16>,
                 Queries<RTCRay16>>
        queries;
};

EmbreeRays::EmbreeRays(std::span<const Ray> rays, uint width, bool any_hit) : impl_(std::make_unique<Impl>())
{
    impl_->rays = rays;
    const std::size_t count = (rays.size() + width - 1) / width;
    switch (width) {
    case 1:
        if (any_hit)
            impl_->queries = Queries<RTCRay>(count);
        else
            impl_->queries = Queries<RTCRayHit>(count);
        break;
    case 8:
        if (any_hit)
            impl_->queries = Queries<RTCRay8>(count);
        else
            impl_->queries = Queries<RTCRayHit8>(count);
        break;
    default:
        SNELL_CHECK_EQ(width, 16u);
        if (any_hit)
            impl_->queries = Queries<RTCRay16>(count);
        else
            impl_->queries = Queries<RTCRayHit16>(count);
        break;
    }
    reset();
}

EmbreeRays::~EmbreeRays() = default;

void EmbreeRays::reset()
{
    std::visit(
        [&]<class Query>(Queries<Query>& queries) {
            constexpr uint width = width_of<Query>();
            parallel_ranges(queries.size(), 1024, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    for (uint lane = 0; lane < width; ++lane) {
                        const std::size_t ray = i * width + lane;
                        // Lanes beyond the last ray: an empty interval.
                        set_ray(queries[i], lane,
                                ray < impl_->rays.size() ? impl_->rays[ray]
                                                         : make_ray(vec3(0.0f), vec3(0.0f, 0.0f, 1.0f), -1.0f));
                    }
                    reset_hit(queries[i]);
                }
            });
        },
        impl_->queries);
}

void EmbreeRays::trace(RTCScene scene, std::size_t begin, std::size_t end, bool coherent)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    std::visit(
        [&]<class Query>(Queries<Query>& queries) {
            constexpr uint width = width_of<Query>();
            const std::size_t last = (end + width - 1) / width;
            for (std::size_t i = begin / width; i < last; ++i) {
                if constexpr (width > 1) {
                    if ((i + 1) * width > impl_->rays.size()) { // the last packet
                        alignas(64) std::array<int, 16> valid = {};
                        for (std::size_t ray = i * width; ray < impl_->rays.size(); ++ray) valid[ray - i * width] = -1;
                        call(valid.data(), scene, &context, queries[i]);
                        continue;
                    }
                }
                call(all_lanes.data(), scene, &context, queries[i]);
            }
        },
        impl_->queries);
}

void EmbreeRays::hits(std::span<Hit> hits) const
{
    std::visit(
        [&]<class Query>(const Queries<Query>& queries) {
            if constexpr (requires(const Query& q) { q.hit; }) {
                constexpr uint width = width_of<Query>();
                for (std::size_t i = 0; i < hits.size(); ++i) {
                    const Query& query = queries[i / width];
                    const auto lane = static_cast<uint>(i % width);
                    const bool hit = lane_of(query.hit.geomID, lane) != RTC_INVALID_GEOMETRY_ID;
                    hits[i] = miss(impl_->rays[i].t_max);
                    if (!hit) continue;
                    hits[i].t = lane_of(query.ray.tfar, lane);
                    hits[i].u = lane_of(query.hit.u, lane);
                    hits[i].v = lane_of(query.hit.v, lane);
                    hits[i].primitive = pack_primitive(kind_triangle, lane_of(query.hit.primID, lane) & 0x3fffffffu);
                }
            }
        },
        impl_->queries);
}

void EmbreeRays::blocked(std::span<std::uint8_t> blocked) const
{
    std::visit(
        [&]<class Query>(const Queries<Query>& queries) {
            constexpr uint width = width_of<Query>();
            for (std::size_t i = 0; i < blocked.size(); ++i)
                blocked[i] = lane_of(ray_of(queries[i / width]).tfar, static_cast<uint>(i % width)) < 0.0f;
        },
        impl_->queries);
}

} // namespace snell::bench

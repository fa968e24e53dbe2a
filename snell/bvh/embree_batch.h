// What Embree finds, settled by our own kernels; only where it is installed (SNELL_HAS_EMBREE).
#pragma once

#include "snell/kernel/intersect.h"
#include "snell/scene/packed.h"

#include <embree3/rtcore.h>

#include <array>

namespace snell {

// Embree cannot look behind a ray's origin and cannot divide by directions of less than 1e-18. So it gets rays whose
// t counts from `start`, in lengths of `scale` times the direction: t' = (t - start) / scale. Mostly they are 0 and 1.
struct EmbreeLane
{
    float start = 0.0f, scale = 1.0f;
    float to_embree(float t) const { return (t - start) / scale; }
};

// Embree's t differ from ours in the last places, and which hits count is for ours to say: it is asked about a little
// more.
inline constexpr float embree_slack = 0x1p-16f;
inline float a_little_later(float t)
{
    return t + abs(t) * embree_slack;
}

inline constexpr std::size_t embree_stream_length = 64; // also the most lanes

// Rays that Embree is asked about together. RTCRay::id is the lane.
struct EmbreeBatch
{
    RTCIntersectContext context; // first: filters get its address
    const PackedScene* scene;
    const SceneView* view;
    uint test;
    const Ray* rays;  // by lane
    const Hit* after; // by lane; nullptr: the nearest hits are wanted
    Hit* hits;        // by lane: the best so far
    std::array<EmbreeLane, embree_stream_length> lanes;
    std::array<ShearedRay, embree_stream_length> shears; // of rays
};

// Where the ray of a lane meets a primitive, by our own kernels and behind batch.after; as in brute.cpp. The ray and
// its shear are those of the primitive's own space.
Intersection meet_primitive(const EmbreeBatch& batch, uint lane, uint primitive, uint instance, const Ray& ray,
                            const ShearedRay& shear);

// The filter of EmbreeBatch::context: puts hits that are better than what a lane has into it, and has Embree go on up
// to there and a little further, for what lies at the same t may come first in our order.
void settle_hits(const RTCFilterFunctionNArguments* arguments);

} // namespace snell

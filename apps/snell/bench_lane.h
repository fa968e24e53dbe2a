// One structure about to trace one set of rays: the clock around it, and the check of its answers.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/lab/cross_check.h"
#include "snell/lab/ray_sets.h"

#ifdef SNELL_HAS_EMBREE
#include "bench/embree_rays.h"
#endif

#include <functional>
#include <memory>
#include <vector>

namespace snell::app {

using Trace = std::function<void(std::size_t begin, std::size_t end)>;

struct Lane
{
    std::size_t row = 0;
    Trace trace;
    std::function<void()> reset = [] {}; // outside the clock, before each run
    std::function<Disagreement()> check; // of the last run with the reference
    std::size_t allowed = 0;             // disagreements
    std::vector<double> one, all, wall;
};

// The answers that all others are compared with: those of our first structure.
struct Answers
{
    std::vector<Hit> hits;
    std::vector<std::uint8_t> blocked;
    bool known = false;
};

struct Spent
{
    double cpu = 0, wall = 0; // seconds
};

// Traces rays in batches of 4,096: on this thread, or on all of them. cpu is what threads spend in batches, summed, not
// what they wait for each other.
Spent run_once(std::size_t rays, bool all_threads, const Trace& trace);

// The first lane whose check() is called fills `reference`; all others are compared with that, ours bit for bit,
// Embree's but for rounding. own: where ours writes its answers; several lanes may share it. lie: check() spoils more
// answers than may differ before it compares. What is referred to must outlive the lane.
Lane our_lane(const Accel& accel, std::size_t row, const RaySet& set, Answers& reference, Answers& own, bool lie);
#ifdef SNELL_HAS_EMBREE
Lane embree_lane(RTCScene scene, std::size_t row, const RaySet& set, const std::shared_ptr<bench::EmbreeRays>& rays,
                 bool coherent, Answers& reference, const PackedScene& packed, bool lie);
#endif

// compare_hits_nearly() with the tolerances that Embree gets.
Disagreement compare_hits_like_embree(const PackedScene& scene, std::span<const Ray> rays,
                                      std::span<const Hit> expected, std::span<const Hit> found);

// CPU time so far: of this thread, and of the whole process.
double thread_cpu_seconds();
double process_cpu_seconds();

} // namespace snell::app

#include "bench_lane.h"

#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/kernel/surface.h"

#include <algorithm>
#include <atomic>

#include <time.h>

namespace snell::app {

static constexpr std::size_t batch_size = 4096;

static double clock_seconds(clockid_t clock)
{
    timespec now = {};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double thread_cpu_seconds()
{
    return clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

double process_cpu_seconds()
{
    return clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

Spent run_once(std::size_t rays, bool all_threads, const Trace& trace)
{
    const std::size_t batches = (rays + batch_size - 1) / batch_size;
    std::atomic<std::int64_t> nanoseconds = 0;
    const auto run = [&](std::size_t begin, std::size_t end) {
        const double start = thread_cpu_seconds();
        for (std::size_t b = begin; b < end; ++b) trace(b * batch_size, std::min(rays, (b + 1) * batch_size));
        nanoseconds += static_cast<std::int64_t>(1e9 * (thread_cpu_seconds() - start));
    };
    const Timer timer;
    if (all_threads)
        parallel_ranges(batches, 1, run);
    else
        run(0, batches);
    return {1e-9 * static_cast<double>(nanoseconds), timer.seconds()};
}

// Makes the first `count` answers wrong.
static void falsify(const RaySet& set, Answers& answers, std::size_t count)
{
    for (std::size_t i = 0; i < std::min(count, set.rays.size()); ++i) {
        if (set.any_hit)
            answers.blocked[i] ^= 1;
        else
            answers.hits[i] = is_hit(answers.hits[i]) ? miss(set.rays[i].t_max) : Hit{1.0f, 0.0f, 0.0f, 0, none};
    }
}

// The first answers to come here are those that all others are compared with.
static void remember_first(Answers& reference, const Answers& answers)
{
    if (reference.known) return;
    reference = answers;
    reference.known = true;
}

Lane our_lane(const Accel& accel, std::size_t row, const RaySet& set, Answers& reference, Answers& own, bool lie)
{
    Lane lane;
    lane.row = row;
    if (set.any_hit) {
        own.blocked.resize(set.rays.size());
        lane.trace = [&accel, &set, &own](std::size_t begin, std::size_t end) {
            accel.occluded(std::span(set.rays).subspan(begin, end - begin),
                           std::span(own.blocked).subspan(begin, end - begin));
        };
    } else {
        own.hits.resize(set.rays.size());
        lane.trace = [&accel, &set, &own](std::size_t begin, std::size_t end) {
            accel.intersect(std::span(set.rays).subspan(begin, end - begin),
                            std::span(own.hits).subspan(begin, end - begin));
        };
    }
    // Or a structure that leaves an answer out would have that of the one before.
    lane.reset = [&own] {
        std::fill(own.hits.begin(), own.hits.end(), Hit{-1.0f, -1.0f, -1.0f, 0, 0});
        std::fill(own.blocked.begin(), own.blocked.end(), std::uint8_t{2});
    };
    lane.check = [&set, &reference, &own, lie] {
        if (lie && reference.known) falsify(set, own, 1);
        remember_first(reference, own);
        return set.any_hit ? compare_blocked(set.rays, reference.blocked, own.blocked)
                           : compare_hits(set.rays, reference.hits, own.hits);
    };
    return lane;
}

Disagreement compare_hits_like_embree(const PackedScene& scene, std::span<const Ray> rays,
                                      std::span<const Hit> expected, std::span<const Hit> found)
{
    const SceneView view = scene.view();
    const auto cosine = [&view](const Ray& ray, const Hit& hit) {
        const vec3 n = surface_point(view, ray, hit).geometric_normal;
        const float c = abs(dot(n, normalize(ray.direction)));
        return is_finite3(n) ? static_cast<double>(c) : 1.0;
    };
    return compare_hits_nearly(rays, expected, found, 1e-4, 1e-5 * static_cast<double>(scene.radius), cosine);
}

#ifdef SNELL_HAS_EMBREE
Lane embree_lane(RTCScene scene, std::size_t row, const RaySet& set, const std::shared_ptr<bench::EmbreeRays>& rays,
                 bool coherent, Answers& reference, const PackedScene& packed, bool lie)
{
    Lane lane;
    lane.row = row;
    lane.allowed = allowed_disagreements(set.rays.size());
    lane.trace = [rays, scene, coherent](std::size_t begin, std::size_t end) {
        rays->trace(scene, begin, end, coherent);
    };
    lane.reset = [rays] { rays->reset(); };
    lane.check = [rays, &set, &reference, &packed, lie, allowed = lane.allowed] {
        Answers answers;
        answers.hits.resize(set.any_hit ? 0 : set.rays.size());
        answers.blocked.resize(set.any_hit ? set.rays.size() : 0);
        rays->hits(answers.hits);
        rays->blocked(answers.blocked);
        if (lie) falsify(set, answers, allowed + 1);
        remember_first(reference, answers);
        if (set.any_hit) return compare_blocked(set.rays, reference.blocked, answers.blocked);
        return compare_hits_like_embree(packed, set.rays, reference.hits, answers.hits);
    };
    return lane;
}
#endif

} // namespace snell::app

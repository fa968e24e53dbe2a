#include "snell/bvh/bvh8.h"

#include "snell/bvh/simd/traverse.h"
#include "snell/core/error.h"

#include <chrono>

namespace snell {
namespace {

// Where prefetching begins to pay: below, the tree nearly fits the second-level cache and it only costs.
constexpr std::size_t prefetch_bytes = std::size_t{4} << 20;

// Do neighbours in the batch point the same way, as camera rays and shadow rays to a small light do? They share nodes
// and triangles, and then packets are faster than keeping many single rays in flight.
bool is_coherent(std::span<const Ray> rays)
{
    constexpr std::size_t pairs = 16;
    if (rays.size() < 2 * pairs) return false;
    std::size_t alike = 0;
    for (std::size_t i = 0; i < pairs; ++i) {
        const std::size_t at = i * (rays.size() - 1) / pairs;
        const vec3 a = rays[at].direction, b = rays[at + 1].direction;
        const float along = dot(a, b);
        if (along > 0.0f && along * along > 0.9f * dot(a, a) * dot(b, b)) ++alike;
    }
    return alike >= pairs * 3 / 4;
}

class Bvh8 : public Accel
{
  public:
    Bvh8(const PackedScene& scene, const AccelOptions& options, bool one_by_one) : single(one_by_one)
    {
        const auto start = std::chrono::steady_clock::now();
        bvh = build_wide(scene);
        stats.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        stats.bytes = bvh.bytes();
        stats.nodes = bvh.nodes.size();
        stats.leaves = bvh.leaves;
        stats.sah_cost = bvh.sah_cost;
        input = {&bvh, &scene, options.triangle_test, stats.bytes > prefetch_bytes};
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        if (single)
            trace_single(input, rays, hits);
        else if (is_coherent(rays))
            trace_packets(input, rays, hits);
        else
            trace_stream(input, rays, hits);
    }

    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override
    {
        SNELL_CHECK_EQ(rays.size(), blocked.size());
        if (single)
            trace_single_any(input, rays, blocked);
        else if (is_coherent(rays))
            trace_packets_any(input, rays, blocked);
        else
            trace_stream_any(input, rays, blocked);
    }

    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), steps.size());
        trace_counted(input, rays, hits, steps);
    }

  private:
    WideBvh bvh;
    TraceInput input;
    bool single;
};

} // namespace

std::unique_ptr<Accel> make_bvh8(const PackedScene& scene, const AccelOptions& options)
{
    return std::make_unique<Bvh8>(scene, options, false);
}

std::unique_ptr<Accel> make_bvh8_single(const PackedScene& scene, const AccelOptions& options)
{
    return std::make_unique<Bvh8>(scene, options, true);
}

} // namespace snell

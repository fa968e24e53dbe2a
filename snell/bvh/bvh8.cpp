#include "snell/bvh/bvh8.h"

#include "snell/bvh/simd/ray_state.h"
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

// Trees of so few nodes are faster in packets whichever way the rays go, for all of them visit the same nodes; measured
// for random rays in rooms full of boxes, with vectors of 4, 8 and 16.
constexpr std::size_t small_tree = 20;

class Bvh8 : public Accel
{
  public:
    Bvh8(const PackedScene& packed, const AccelOptions& chosen, bool one_by_one)
        : scene(packed), options(chosen), single(one_by_one)
    {
        // What moves is built for one frame, and so not kept.
        TreeCache cache;
        cache.folder = options.cache;
        build(cache);
    }

    void build(const TreeCache& cache)
    {
        CacheUse use;
        const auto start = std::chrono::steady_clock::now();
        bvh = build_wide(scene, options.build, cache, &use);
        stats.loaded = use.loaded;
        stats.refused = use.refused;
        stats.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        stats.bytes = bvh.bytes();
        stats.nodes = bvh.nodes.size();
        stats.leaves = bvh.leaves;
        stats.sah_cost = bvh.sah_cost;
        // Packets go through instances, and do Moeller and Trumbore's test, ray by ray: then they gain nothing.
        packets = scene.instances.empty() && options.triangle_test == TriangleTest::watertight;
        small = bvh.nodes.size() <= small_tree;
        input = {&bvh, &scene, options.triangle_test, stats.bytes > prefetch_bytes};
    }

    void update(const PackedChanges& changes) override
    {
        if (changes.any()) build({});
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        switch (choose_kernel(rays)) {
        case Kernel::single:
            return trace_single(input, rays, hits);
        case Kernel::packets:
            return trace_packets(input, rays, hits);
        case Kernel::stream:
            return trace_stream(input, rays, hits);
        }
    }

    void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), after.size());
        std::vector<Ray> onward(rays.begin(), rays.end());
        for (std::size_t i = 0; i < rays.size(); ++i) onward[i].t_min = float_before(after[i].t);
        trace_single_next(input, onward, after, hits);
    }

    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override
    {
        SNELL_CHECK_EQ(rays.size(), blocked.size());
        switch (choose_kernel(rays)) {
        case Kernel::single:
            return trace_single_any(input, rays, blocked);
        case Kernel::packets:
            return trace_packets_any(input, rays, blocked);
        case Kernel::stream:
            return trace_stream_any(input, rays, blocked);
        }
    }

    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), steps.size());
        trace_counted(input, rays, hits, steps);
    }

  private:
    enum class Kernel
    {
        single,
        packets,
        stream
    };

    const PackedScene& scene;
    const AccelOptions options;
    WideBvh bvh;
    TraceInput input;
    const bool single;
    bool packets = false, small = false;

    Kernel choose_kernel(std::span<const Ray> rays) const
    {
        if (single) return Kernel::single;
        if (packets && small) return Kernel::packets;
        if (!is_coherent(rays)) return Kernel::stream;
        return packets ? Kernel::packets : Kernel::single;
    }
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

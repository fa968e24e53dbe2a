#include "snell/bvh/wide_accel.h"

#include "snell/bvh/inspect.h"
#include "snell/bvh/refit.h"
#include "snell/bvh/simd/ray_state.h"
#include "snell/bvh/simd/traverse.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"

#include <algorithm>

namespace snell {
namespace {

// Where prefetching begins to pay: below, the tree fits the second-level cache and it only costs.
constexpr std::size_t prefetch_bytes = std::size_t{1} << 20;

// So many rays of a batch show whether rays in flight are the best way for the rest; fewer than four times as many are
// not worth a second way.
constexpr std::size_t rays_to_probe = 512;

// What most neighbours in a batch have in common.
struct Coherence
{
    bool same_way = false;   // they point the same way, as camera rays and shadow rays to a small light do
    bool same_place = false; // they start much nearer to each other than the batch is wide
};
Coherence coherence_of(std::span<const Ray> rays)
{
    constexpr std::size_t pairs = 16;
    if (rays.size() < 2 * pairs) return {};
    float apart[pairs]; // squared
    std::size_t alike = 0, near = 0;
    Box origins;
    for (std::size_t i = 0; i < pairs; ++i) {
        const std::size_t at = i * (rays.size() - 1) / pairs;
        const vec3 a = rays[at].direction, b = rays[at + 1].direction;
        const float along = dot(a, b);
        if (along > 0.0f && along * along > 0.9f * dot(a, a) * dot(b, b)) ++alike;
        const vec3 between = rays[at].origin - rays[at + 1].origin;
        apart[i] = dot(between, between);
        origins.extend(rays[at].origin);
    }
    // Rays of a tile of pixels are a few hundredths of their batch apart, shuffled ones a tenth and more.
    const vec3 extent = origins.extent();
    for (const float distance : apart) near += distance <= dot(extent, extent) * sqr(1.0f / 32.0f);
    constexpr std::size_t most = pairs * 3 / 4;
    return {alike >= most, near >= most};
}

// Trees of so few nodes are faster in packets whichever way the rays go, for all of them visit the same nodes; measured
// for random rays in rooms full of boxes, with vectors of 4, 8 and 16.
constexpr std::size_t small_tree = 20;

template <class Node>
class WideAccel : public Accel, public Inspectable
{
  public:
    WideAccel(const PackedScene& packed, const AccelOptions& chosen) : scene(packed), options(chosen)
    {
        TreeCache cache;
        cache.folder = options.cache;
        build(cache);
    }

    void update(const PackedChanges& changes) override
    {
        const Timer timer;
        stats.refitted = stats.rebuilt = 0;
        if (changes.any()) {
            std::vector<std::uint8_t> refitted(changes.groups.size(), 0);
            parallel_for(changes.groups.size(), [&](std::size_t i) {
                const uint group = changes.groups[i];
                refitted[i] = follow(bvh.groups[group], scene.groups[group], built_costs[group]) ? 1 : 0;
            });
            if (changes.world) refitted.push_back(follow(bvh.world, scene.world, built_costs.back()) ? 1 : 0);
            stats.refitted = static_cast<std::size_t>(std::count(refitted.begin(), refitted.end(), 1));
            stats.rebuilt = refitted.size() - stats.refitted;
            if (!scene.instances.empty()) bvh.top = make_top_tree(scene, bvh, for_each_frame(options.build));
            settle();
        }
        stats.build_seconds = timer.seconds();
    }

    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        const TraceKernels<Node> kernels = trace_kernels<Node>();
        switch (choose(rays, false)) {
        case Traversal::single:
            return kernels.single(input, rays, hits);
        case Traversal::packets:
            return kernels.packets(input, rays, hits);
        default:
            break;
        }
        const bool probe =
            options.traversal == Traversal::automatic && packets_pay() && rays.size() >= 4 * rays_to_probe;
        const std::size_t done = kernels.stream(input, rays, hits, probe ? rays_to_probe : 0);
        if (done < rays.size()) kernels.packets(input, rays.subspan(done), hits.subspan(done));
    }

    void intersect_next(std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), after.size());
        std::vector<Ray> onward(rays.begin(), rays.end());
        for (std::size_t i = 0; i < rays.size(); ++i) onward[i].t_min = float_before(after[i].t);
        trace_kernels<Node>().next(input, onward, after, hits);
    }

    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override
    {
        SNELL_CHECK_EQ(rays.size(), blocked.size());
        std::vector<uint> primitives(rays.size());
        find_blockers(rays, primitives);
        for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = primitives[i] != none;
    }

    void find_blockers(std::span<const Ray> rays, std::span<uint> primitives) const override
    {
        SNELL_CHECK_EQ(rays.size(), primitives.size());
        const TraceKernels<Node> kernels = trace_kernels<Node>();
        switch (choose(rays, true)) {
        case Traversal::single:
            return kernels.single_any(input, rays, primitives);
        case Traversal::packets:
            return kernels.packets_any(input, rays, primitives);
        default:
            return kernels.stream_any(input, rays, primitives);
        }
    }

    void intersect_counted(std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps) const override
    {
        SNELL_CHECK_EQ(rays.size(), hits.size());
        SNELL_CHECK_EQ(rays.size(), steps.size());
        trace_kernels<Node>().counted(input, rays, hits, steps);
    }

    std::vector<TreeView> trees() const override { return list_trees(input); }
    RayWalk walk(const Ray& ray) const override { return walk_ray(input, ray); }

    const TraceInput<Node>& trees_to_trace() const { return input; }

  private:
    const PackedScene& scene;
    const AccelOptions options;
    WideBvh<Node> bvh;
    std::vector<double> built_costs; // of the trees of groups and of the world, when they were last built
    TraceInput<Node> input;

    void build(const TreeCache& cache)
    {
        const Timer timer;
        CacheUse use;
        bvh = make_wide<Node>(scene, options.build, cache, &use);
        for (const WideTree<Node>& group : bvh.groups) built_costs.push_back(group.sah_cost);
        built_costs.push_back(bvh.world.sah_cost);
        stats.loaded = use.loaded;
        stats.refused = use.refused;
        stats.build_seconds = timer.seconds();
        settle();
    }

    // Makes a tree follow its primitives; false: it was built anew. What moves is built for a few frames, and so not
    // kept in the cache.
    bool follow(WideTree<Node>& tree, const PackedGroup& group, double& built_cost)
    {
        // What was not finite when the tree was built has no place in it.
        if (options.update != UpdatePolicy::rebuild && tree.root != word_done && tree.left_out == 0) {
            refit(scene, tree);
            const bool is_good =
                options.update == UpdatePolicy::refit || tree.sah_cost <= options.rebuild_factor * built_cost;
            if (is_good && !tree.box.empty()) return true;
        }
        tree = make_group_tree<Node>(scene, group, options.build);
        built_cost = tree.sah_cost;
        return false;
    }

    // What follows from the trees.
    void settle()
    {
        stats.bytes = bvh.bytes();
        stats.nodes = bvh.nodes();
        stats.leaves = bvh.leaves();
        stats.sah_cost = bvh.sah_cost();
        input = {&bvh, &scene, options.triangle_test, stats.bytes > prefetch_bytes};
    }

    // They know the watertight test only. They go through instances ray by ray, and then gain nothing.
    bool packets_pay() const { return options.triangle_test == TriangleTest::watertight && !bvh.has_instances(); }

    Traversal choose(std::span<const Ray> rays, bool any) const
    {
        const bool packets = options.triangle_test == TriangleTest::watertight;
        if (options.traversal == Traversal::packets) return packets ? Traversal::packets : Traversal::single;
        if (options.traversal != Traversal::automatic) return options.traversal;
        const bool pay = packets_pay();
        if (pay && bvh.world.nodes.size() <= small_tree) return Traversal::packets;
        // Neighbours share nodes and triangles, and then packets are faster than keeping many single rays in flight; of
        // rays that ask for any hit, those from one place are neighbours enough.
        const Coherence coherence = coherence_of(rays);
        if (any && pay && coherence.same_place) return Traversal::packets;
        if (!coherence.same_way) return Traversal::stream;
        return pay ? Traversal::packets : Traversal::single;
    }
};

} // namespace

template <class Node>
std::unique_ptr<Accel> make_wide_accel(const PackedScene& scene, const AccelOptions& options)
{
    return std::make_unique<WideAccel<Node>>(scene, options);
}

template <class Node>
const TraceInput<Node>* find_wide_trees(const Accel& accel)
{
    const auto* wide = dynamic_cast<const WideAccel<Node>*>(&accel);
    return wide != nullptr ? &wide->trees_to_trace() : nullptr;
}

template const TraceInput<Node2>* find_wide_trees<Node2>(const Accel&);
template const TraceInput<QuantisedNode>* find_wide_trees<QuantisedNode>(const Accel&);

template std::unique_ptr<Accel> make_wide_accel<Node2>(const PackedScene&, const AccelOptions&);
template std::unique_ptr<Accel> make_wide_accel<Node4>(const PackedScene&, const AccelOptions&);
template std::unique_ptr<Accel> make_wide_accel<Node8>(const PackedScene&, const AccelOptions&);
template std::unique_ptr<Accel> make_wide_accel<QuantisedNode>(const PackedScene&, const AccelOptions&);

} // namespace snell

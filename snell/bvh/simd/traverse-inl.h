// The traversal, one ray after the other and with several in flight. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_TRAVERSE_INL_H
#undef SNELL_BVH_SIMD_TRAVERSE_INL_H
#else
#define SNELL_BVH_SIMD_TRAVERSE_INL_H
#endif

#include "snell/bvh/simd/leaves-inl.h"

#include <algorithm>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The stacks of the rays in flight, each with room for everything the tree can ask for and for whole vectors: first all
// words, then, `stride` later, the bits of the distances at which the ray enters the boxes.
class Stacks
{
  public:
    Stacks(std::size_t rays, uint entries)
        : stride((entries + 2 * node_width + 15) / 16 * 16), memory(2 * rays * stride)
    {
    }
    ChildWord* stack(std::size_t ray) { return memory.data() + 2 * ray * stride; }

    const std::size_t stride;

  private:
    std::vector<uint> memory;
};

// Everything a traversal needs to go on with one ray, apart from visiting inner nodes.
template <Query query, TriangleTest test>
class Walker
{
  public:
    // before: Query::next's hits, one a ray.
    Walker(const TraceInput& in, std::span<const Ray> batch, std::size_t stack_stride, std::span<const Hit> before = {})
        : input(in), bvh(*in.bvh), rays(batch), stride(stack_stride), after(before)
    {
    }

    // The state's stack is set. Sets the rest to the root, after looking at the planes. False if there is nothing to
    // traverse.
    bool start(RayState& s, std::size_t index) const
    {
        const Ray& ray = rays[index];
        s.ray_index = static_cast<uint>(index);
        s.hit = miss(ray.t_max);
        s.steps = 0;
        s.stack_size = 0;
        if (!is_traceable(ray)) return false;
        s.t_min = ray.t_min;
        s.best = float_before(ray.t_max);
        if (query == Query::next) s.after = after[index];
        for (std::size_t i = 0; i < input.scene->planes.size(); ++i) {
            const Plane& plane = input.scene->planes[i];
            if (query == Query::counted) ++s.steps;
            const Intersection r = intersect_plane(ray, plane.normal, plane.offset);
            const uint primitive = pack_primitive(kind_plane, static_cast<uint>(i));
            if (query == Query::next && !is_later_hit(r.t, primitive, none, s.after)) continue;
            if (r.ok && is_better_hit(r.t, primitive, none, s.hit)) accept(s, r.t, 0.0f, 0.0f, primitive, none);
        }
        if (bvh.world.word == word_done || (query == Query::any && is_hit(s.hit))) return false;
        enter_space(s, ray, bvh.world, none);
        push(s, word_done);
        s.current = bvh.world.word;
        return true;
    }

    // Visits the leaf, instance or marker that is `current`. True if a hit was found or improved. What comes next is
    // on the stack.
    HWY_INLINE bool visit_leaf(RayState& s) const
    {
        const uint index = s.current & child_index_mask;
        switch (RefKind(s.current >> 30)) {
        case RefKind::triangle:
            return visit_triangles<query, test>(bvh.triangles[index], s);
        case RefKind::sphere:
            return visit_spheres<query>(input, bvh.spheres[index], s);
        case RefKind::instance:
            if (s.current == word_leave_instance)
                enter_space(s, rays[s.ray_index], bvh.world, none);
            else
                enter_instance(s, index);
            return false;
        }
        return false;
    }

    // Markers stay on the stack whatever the nearest hit.
    void push(RayState& s, ChildWord word) const
    {
        s.stack[s.stack_size] = word;
        s.stack[s.stack_size + stride] = floatBitsToUint(-INFINITY);
        ++s.stack_size;
    }

    const TraceInput& input;
    const WideBvh& bvh;
    const std::span<const Ray> rays;
    const std::size_t stride; // of Stacks
    const std::span<const Hit> after;

  private:
    void enter_instance(RayState& s, uint index) const
    {
        const Instance& instance = input.scene->instances[index];
        const WideRoot& root = bvh.groups[instance.group];
        const Ray local = ray_to_object(rays[s.ray_index], instance.to_object);
        if (!is_traceable(local) || root.word == word_done) return;
        push(s, word_leave_instance);
        enter_space(s, local, root, index);
        push(s, root.word);
    }
};

// Traces one ray until its stack is empty. For any hit: until the first, whose primitive is then 0, whatever it was.
template <Query query, TriangleTest test>
HWY_INLINE void walk(const Walker<query, test>& walker, RayState& s)
{
    const std::size_t stride = walker.stride;
    const WideNode* const nodes = walker.bvh.nodes.data();
    ChildWord* const stack = s.stack;
    uint size = s.stack_size;
    ChildWord current = s.current;
    SlabRay slab_ray = load_slab_ray(s);
    while (current != word_done) {
        if (current <= child_index_mask) {
            const WideNode& node = nodes[current];
            const Slabs slabs = test_slabs(node, slab_ray, s.best, 0);
            if (query == Query::counted) ++s.steps;
            if (hn::MaxLanes(Slabs::Tag()) == node_width) {
                // One child is the most frequent case, and neighbouring rays agree on it.
                const uint met = mask_bits(Slabs::Tag(), hn::Le(slabs.enter, slabs.leave));
                if (met != 0 && (met & (met - 1)) == 0) {
                    current = node.child[hwy::Num0BitsBelowLS1Bit_Nonzero32(met)];
                    continue;
                }
                if (met != 0) size = push_children<query>(node, s, slab_ray, slabs, stride, size);
            } else {
                size = push_children<query>(node, s, slab_ray, slabs, stride, size);
            }
        } else {
            s.current = current;
            s.stack_size = size;
            const bool improved = walker.visit_leaf(s);
            size = s.stack_size;
            if (current >= make_child(uint(RefKind::instance), 0)) slab_ray = load_slab_ray(s);
            if (improved && query == Query::any) {
                s.hit.primitive = 0;
                return;
            }
        }
        do --size;
        while (query != Query::any && uintBitsToFloat(stack[stride + size]) > s.best);
        current = stack[size];
    }
}

template <Query query, TriangleTest test, class Finish>
HWY_INLINE void trace_one_by_one(const TraceInput& input, std::span<const Ray> rays, std::span<const Hit> after,
                                 const Finish& finish)
{
    Stacks stacks(1, input.bvh->stack_size);
    const Walker<query, test> walker(input, rays, stacks.stride, after);
    RayState s;
    s.stack = stacks.stack(0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (walker.start(s, i)) walk(walker, s);
        finish(s);
    }
}

template <Query query, class Finish>
HWY_INLINE void single(const TraceInput& input, std::span<const Ray> rays, const Finish& finish,
                       std::span<const Hit> after = {})
{
    if (input.triangle_test == TriangleTest::watertight)
        trace_one_by_one<query, TriangleTest::watertight>(input, rays, after, finish);
    else
        trace_one_by_one<query, TriangleTest::moller_trumbore>(input, rays, after, finish);
}

void single_closest(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    single<Query::closest>(input, rays, [&](const RayState& s) { hits[s.ray_index] = s.hit; });
}

void single_next(const TraceInput& input, std::span<const Ray> rays, std::span<const Hit> after, std::span<Hit> hits)
{
    single<Query::next>(
        input, rays, [&](const RayState& s) { hits[s.ray_index] = s.hit; }, after);
}

void single_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    single<Query::any>(input, rays, [&](const RayState& s) { blocked[s.ray_index] = is_hit(s.hit); });
}

void single_counted(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps)
{
    single<Query::counted>(input, rays, [&](const RayState& s) {
        hits[s.ray_index] = s.hit;
        steps[s.ray_index] = s.steps;
    });
}

// Rays in flight. Two lists: rays whose next stop is an inner node, and the rest. Inner nodes are visited in rounds,
// one node a ray and round, so that the processor overlaps the work and the cache misses of independent rays; a ray
// that comes to a leaf changes lists without a branch. When few are left in the first list, all leaves are visited,
// where rays also end and new ones begin.
template <Query query, TriangleTest test, class Finish>
HWY_INLINE void trace_in_flight(const TraceInput& input, std::span<const Ray> rays, const Finish& finish)
{
    constexpr std::size_t flight = 16;
    Stacks stacks(flight, input.bvh->stack_size);
    const std::size_t stride = stacks.stride;
    const Walker<query, test> walker(input, rays, stride);
    const WideNode* const nodes = walker.bvh.nodes.data();
    const TriangleBlock* const blocks = walker.bvh.triangles.data();
    RayState states[flight];
    for (std::size_t slot = 0; slot < flight; ++slot) states[slot].stack = stacks.stack(slot);
    std::uint8_t inner[flight + 1], other[2 * flight];
    std::size_t inner_count = 0, other_count = 0, next_ray = 0;

    const auto sort_in = [&](std::size_t slot) {
        const bool is_inner = states[slot].current <= child_index_mask;
        inner[inner_count] = other[other_count] = static_cast<std::uint8_t>(slot);
        inner_count += is_inner;
        other_count += !is_inner;
    };
    // Gives the slot to the next ray that has something to traverse.
    const auto refill = [&](std::size_t slot) {
        while (next_ray < rays.size()) {
            if (walker.start(states[slot], next_ray++)) {
                sort_in(slot);
                return;
            }
            finish(states[slot]);
        }
    };
    const auto fetch = [&](ChildWord word) {
        if (!input.prefetch) return;
        const bool inner_node = word <= child_index_mask;
        const char* lines = inner_node ? reinterpret_cast<const char*>(nodes + word)
                                       : reinterpret_cast<const char*>(blocks + (word & child_index_mask));
        // A sphere block, an instance or a marker makes an address that is fetched in vain; that is harmless.
        for (int line = 0; line < 3; ++line) __builtin_prefetch(lines + 64 * line);
        __builtin_prefetch(lines + (inner_node ? 192 : 128));
    };

    for (std::size_t slot = 0; slot < flight; ++slot) refill(slot);
    while (inner_count + other_count > 0) {
        while (inner_count > (other_count > 0 ? flight / 4 : 0)) {
            std::size_t still = 0;
            for (std::size_t i = 0; i < inner_count; ++i) {
                const std::size_t slot = inner[i];
                RayState& s = states[slot];
                const WideNode& node = nodes[s.current];
                const SlabRay slab_ray = load_slab_ray(s);
                const Slabs slabs = test_slabs(node, slab_ray, s.best, 0);
                s.stack_size = push_children<query>(node, s, slab_ray, slabs, stride, s.stack_size) - 1;
                s.current = s.stack[s.stack_size];
                fetch(s.current);
                const bool is_inner = s.current <= child_index_mask;
                inner[still] = static_cast<std::uint8_t>(slot);
                still += is_inner;
                other[other_count] = static_cast<std::uint8_t>(slot);
                other_count += !is_inner;
            }
            inner_count = still;
        }
        const std::size_t count = other_count;
        std::uint8_t todo[flight];
        std::copy(other, other + count, todo);
        other_count = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t slot = todo[i];
            RayState& s = states[slot];
            if (s.current == word_done) {
                finish(s);
                refill(slot);
                continue;
            }
            const bool improved = walker.visit_leaf(s);
            if (improved && query == Query::any) {
                s.hit.primitive = 0;
                finish(s);
                refill(slot);
                continue;
            }
            if (improved) drop_farther(s, stride);
            s.current = s.stack[--s.stack_size];
            fetch(s.current);
            sort_in(slot);
        }
    }
}

template <Query query, class Finish>
HWY_INLINE void stream(const TraceInput& input, std::span<const Ray> rays, const Finish& finish)
{
    if (input.triangle_test == TriangleTest::watertight)
        trace_in_flight<query, TriangleTest::watertight>(input, rays, finish);
    else
        trace_in_flight<query, TriangleTest::moller_trumbore>(input, rays, finish);
}

void stream_closest(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    stream<Query::closest>(input, rays, [&](const RayState& s) { hits[s.ray_index] = s.hit; });
}

void stream_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    stream<Query::any>(input, rays, [&](const RayState& s) { blocked[s.ray_index] = is_hit(s.hit); });
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif

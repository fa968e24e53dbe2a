// The traversal, one ray after the other and with several in flight. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_TRAVERSE_INL_H
#undef SNELL_BVH_SIMD_TRAVERSE_INL_H
#else
#define SNELL_BVH_SIMD_TRAVERSE_INL_H
#endif

#include "snell/bvh/simd/leaves-inl.h"
#include "snell/bvh/simd/ray_setup-inl.h"

#include <algorithm>
#include <bit>
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
        : stride((entries + 2 * 16 + 15) / 16 * 16), memory(rays * (2 * stride + line))
    {
    }
    // A cache line apart from a multiple of the size: else they would compete for a few sets of the cache.
    ChildWord* stack(std::size_t ray) { return memory.data() + ray * (2 * stride + line); }

    const std::size_t stride;

  private:
    static constexpr std::size_t line = 16;
    std::vector<uint> memory;
};

// What a batch of rays is answered with: hits, or primitives that are in the way.
template <Query query>
using Answer = std::conditional_t<query == Query::any, uint, Hit>;
HWY_INLINE void give(Hit& answer, const Hit& hit)
{
    answer = hit;
}
HWY_INLINE void give(uint& answer, const Hit& hit)
{
    answer = hit.primitive;
}

// What is left to do of a ray that has left its packet; all of it in the world's tree.
struct Rest
{
    static constexpr uint most = 14;
    uint ray, count;
    float best; // as in RayState
    Hit hit;
    ChildWord word[most]; // to visit, the nearest first
    float enter[most];    // no ray enters its box before this
};

// Everything a traversal needs to go on with one ray, apart from visiting inner nodes.
template <Query query, class Node>
class Walker
{
  public:
    using State = RayState<Node>;

    // before: Query::next's hits, one a ray.
    Walker(const TraceInput<Node>& in, std::span<const Ray> batch, std::size_t stack_stride,
           std::span<const Hit> before = {})
        : input(in), bvh(*in.bvh), first(in.bvh->first()), rays(batch), stride(stack_stride), after(before)
    {
    }

    // The state's stack is set. Sets the rest to the root, after looking at the planes. False if there is nothing to
    // traverse.
    HWY_INLINE bool start(State& s, std::size_t index) const
    {
        const Ray& ray = rays[index];
        s.ray_index = static_cast<uint>(index);
        s.hit = miss(ray.t_max);
        s.steps = 0;
        s.top = s.stack;
        if (!is_traceable(ray)) return false;
        s.best = float_before(ray.t_max);
        if (query == Query::next) s.after = after[index];
        if (HWY_UNLIKELY(!input.scene->planes.empty())) meet_planes(s, ray);
        if (first.root == word_done || (query == Query::any && is_hit(s.hit))) return false;
        enter_space(s, ray, first, none);
        push(s, word_done);
        s.current = first.root;
        return true;
    }

    // The same for a ray that is ready for the first tree.
    HWY_INLINE bool start(State& s, std::size_t index, const RaySetup& setup, bool traceable) const
    {
        const Ray& ray = rays[index];
        s.ray_index = static_cast<uint>(index);
        s.hit = miss(ray.t_max);
        if (!traceable) return false;
        static_cast<RaySetup&>(s) = setup;
        if (HWY_UNLIKELY(!input.scene->planes.empty())) meet_planes(s, ray);
        if (first.root == word_done || (query == Query::any && is_hit(s.hit))) return false;
        set_tree(s, ray, first);
        s.top = s.stack;
        push(s, word_done);
        return true;
    }

    // For a ray that has begun in a packet.
    HWY_INLINE void go_on(State& s, const Rest& rest, const RaySetup& setup) const
    {
        static_cast<RaySetup&>(s) = setup;
        s.ray_index = rest.ray;
        s.hit = rest.hit;
        s.best = rest.best;
        set_tree(s, rays[rest.ray], bvh.world);
        s.top = s.stack;
        push(s, word_done);
        for (uint k = rest.count; k-- > 0;) {
            *s.top = rest.word[k];
            s.top[stride] = floatBitsToUint(rest.enter[k]);
            ++s.top;
        }
        s.current = *--s.top;
    }

    // Visits the leaf, instance or marker that is `current`. True if a hit was found or improved. What comes next is
    // on the stack.
    HWY_INLINE bool visit_leaf(State& s) const
    {
        if (RefKind(s.current >> 30) != RefKind::triangle) return visit_other(s);
        const TriangleBlock* block = &block_at(s.lines(), s.current & child_index_mask);
        if (HWY_UNLIKELY(input.triangle_test != TriangleTest::watertight))
            return visit_by_moller_trumbore<query>(block, s);
        return visit_triangles<query, TriangleTest::watertight>(block, s);
    }

    // The same for all but triangles.
    HWY_INLINE bool visit_other(State& s) const
    {
        const uint index = s.current & child_index_mask;
        if (RefKind(s.current >> 30) == RefKind::sphere)
            return visit_spheres<query>(*input.scene, s.tree->spheres[index], s);
        if (s.current == word_leave_instance)
            enter_space(s, rays[s.ray_index], first, none);
        else
            enter_instance(s, index);
        return false;
    }

    // Markers stay on the stack whatever the nearest hit.
    HWY_INLINE void push(State& s, ChildWord word) const
    {
        *s.top = word;
        s.top[stride] = floatBitsToUint(-INFINITY);
        ++s.top;
    }

    const TraceInput<Node>& input;
    const WideBvh<Node>& bvh;
    const WideTree<Node>& first;
    const std::span<const Ray> rays;
    const std::size_t stride; // of Stacks
    const std::span<const Hit> after;

  private:
    void meet_planes(State& s, const Ray& ray) const
    {
        for (std::size_t i = 0; i < input.scene->planes.size(); ++i) {
            const Plane& plane = input.scene->planes[i];
            if (query == Query::counted) ++s.steps;
            const Intersection r = intersect_plane(ray, plane.normal, plane.offset);
            const uint primitive = pack_primitive(kind_plane, static_cast<uint>(i));
            if (query == Query::next && !is_later_hit(r.t, primitive, none, s.after)) continue;
            if (r.ok && is_better_hit(r.t, primitive, none, s.hit)) accept(s, r.t, 0.0f, 0.0f, primitive, none);
        }
    }

    void enter_instance(State& s, uint index) const
    {
        if (s.current == word_world) return enter(s, rays[s.ray_index], bvh.world, none);
        const Instance& instance = input.scene->instances[index];
        const Ray local = ray_to_object(rays[s.ray_index], instance.to_object);
        if (is_traceable(local)) enter(s, local, bvh.groups[instance.group], index);
    }

    void enter(State& s, const Ray& ray, const WideTree<Node>& tree, uint instance) const
    {
        if (tree.root == word_done) return;
        push(s, word_leave_instance);
        enter_space(s, ray, tree, instance);
        push(s, tree.root);
    }
};

// Traces one ray until its stack is empty. For any hit: until the first, of which the primitive alone is noted.
template <Query query, class Node>
HWY_NOINLINE void walk(const Walker<query, Node>& walker, RayState<Node>& s)
{
    const std::size_t stride = walker.stride;
    const Node* nodes = s.nodes();
    ChildWord* top = s.top;
    ChildWord current = s.current;
    SlabRay<Node> slab_ray = load_slab_ray(s);
    while (current != word_done) {
        if (current <= child_index_mask) {
            const Node& node = nodes[current];
            const Slabs<Node> slabs = test_slabs(node, slab_ray, s.best, 0);
            if (query == Query::counted) ++s.steps;
            if (hn::MaxLanes(NodeTag<Node>()) == Node::width) {
                // One child is the most frequent case, and neighbouring rays agree on it.
                const uint met = mask_bits(NodeTag<Node>(), hn::Le(slabs.enter, slabs.leave));
                if (met != 0 && (met & (met - 1)) == 0) {
                    current = node.child[hwy::Num0BitsBelowLS1Bit_Nonzero32(met)];
                    continue;
                }
                if (met != 0) top = push_children<query>(node, s, slab_ray, slabs, stride, top);
            } else {
                top = push_children<query>(node, s, slab_ray, slabs, stride, top);
            }
        } else {
            s.current = current;
            s.top = top;
            const bool improved = walker.visit_leaf(s);
            top = s.top;
            if (current >= make_child(uint(RefKind::instance), 0)) {
                slab_ray = load_slab_ray(s);
                nodes = s.nodes();
            }
            if (improved && query == Query::any) return;
        }
        do --top;
        while (query != Query::any && uintBitsToFloat(top[stride]) > s.best);
        current = *top;
    }
}

// finish(state) takes what was found.
template <Query query, class Node, class Finish>
HWY_INLINE void single(const TraceInput<Node>& input, std::span<const Ray> rays, const Finish& finish,
                       std::span<const Hit> after = {})
{
    Stacks stacks(1, input.bvh->stack_size());
    const Walker<query, Node> walker(input, rays, stacks.stride, after);
    RayState<Node> s;
    s.stack = stacks.stack(0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (walker.start(s, i)) walk(walker, s);
        finish(s);
    }
}

template <class Node>
void single_closest(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    single<Query::closest>(input, rays, [&](const RayState<Node>& s) { hits[s.ray_index] = s.hit; });
}

template <class Node>
void single_next(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<const Hit> after,
                 std::span<Hit> hits)
{
    single<Query::next>(
        input, rays, [&](const RayState<Node>& s) { hits[s.ray_index] = s.hit; }, after);
}

template <class Node>
void single_any(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<uint> blockers)
{
    single<Query::any>(input, rays, [&](const RayState<Node>& s) { blockers[s.ray_index] = s.hit.primitive; });
}

template <class Node>
void single_counted(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<Hit> hits,
                    std::span<uint> steps)
{
    single<Query::counted>(input, rays, [&](const RayState<Node>& s) {
        hits[s.ray_index] = s.hit;
        steps[s.ray_index] = s.steps;
    });
}

// Rays in flight, in three lists: those whose next stop is an inner node, a block of triangles, or something else.
// Inner nodes are visited in turn, one node a ray, so that the processor overlaps the work and the cache misses of
// independent rays; a ray changes lists without a branch. The list of inner nodes is a ring, for the end of a list is a
// branch that nobody can predict. When few rays are left in it, the other lists are worked off, where rays also end and
// new ones begin.
// Traces all rays, or if `rests` is not empty what is left of some of them.
// Returns how many of them are done, from the first on: all, unless the first `probe` ones (0: do not look) have
// visited few inner nodes each.
template <Query query, class Node>
HWY_NOINLINE std::size_t trace_in_flight(const TraceInput<Node>& input, std::span<const Ray> rays,
                                         std::span<const Rest> rests, std::span<Answer<query>> answers,
                                         std::size_t probe = 0)
{
    std::size_t count_of_rays = rests.empty() ? rays.size() : rests.size();
    constexpr std::size_t flight = 32;
    constexpr std::size_t enough = flight / 4; // rays at inner nodes that keep the processor busy
    Stacks stacks(flight, input.bvh->stack_size() + (rests.empty() ? 0 : Rest::most + 1));
    const std::size_t stride = stacks.stride;
    const bool prefetch = input.prefetch;
    const Walker<query, Node> walker(input, rays, stride);
    RayState<Node> states[flight];
    ReadyRays ready;
    for (std::size_t slot = 0; slot < flight; ++slot) states[slot].stack = stacks.stack(slot);
    std::uint8_t ring[flight], leaves[2 * flight], others[2 * flight];
    std::size_t ring_begin = 0, ring_end = 0, leaf_count = 0, other_count = 0, next_ray = 0;

    const auto sort_in = [&](std::size_t slot, ChildWord word) __attribute__((always_inline))
    {
        ring[ring_end % flight] = leaves[leaf_count] = others[other_count] = static_cast<std::uint8_t>(slot);
        ring_end += word <= child_index_mask;
        leaf_count += word - (child_index_mask + 1) <= child_index_mask;
        other_count += word >> 31;
    };
    // Inlined by force: GCC 12 takes a function that only prefetches for one without effects, and drops it.
    const auto fetch = [&](const RayState<Node>& s, ChildWord word) __attribute__((always_inline))
    {
        if (!prefetch) return;
        // A sphere block, an instance or a marker makes an address that is fetched in vain; that is harmless. Which of
        // the two it is nobody can predict, so there is no branch.
        constexpr uint node_shift = std::countr_zero(sizeof(Node)), line_shift = std::countr_zero(sizeof(Line));
        const uint is_node = word <= child_index_mask;
        const std::byte* const lines = s.parts[is_node] + (static_cast<std::size_t>(word & child_index_mask)
                                                           << (line_shift + (node_shift - line_shift) * is_node));
        constexpr int most = sizeof(Node) > 192 ? 4 : 3;
        for (int line = 0; line < most; ++line) __builtin_prefetch(lines + 64 * line);
    };
    // Begins with the next ray that has something to traverse; false if there is none. The lists are no business of
    // this function: it is not inlined, and what it refers to is kept in memory, not in registers.
    const auto begin_next = [&](RayState<Node>& s, std::size_t visits) {
        if (HWY_UNLIKELY(next_ray == probe) && visits <= few_visits * probe) count_of_rays = next_ray;
        while (next_ray < count_of_rays) {
            const std::size_t i = next_ray++, lane = i % ReadyRays::size;
            if (lane == 0)
                ready.prepare<Node::row_bytes>(walker.first.box, walker.first.root,
                                               [&](std::size_t ahead) HWY_ATTR -> const Ray& {
                                                   const std::size_t at = std::min(i + ahead, count_of_rays - 1);
                                                   return rays[rests.empty() ? at : rests[at].ray];
                                               });
            if (!rests.empty()) {
                walker.go_on(s, rests[i], ready.setup[lane]);
                return true;
            }
            if (walker.start(s, i, ready.setup[lane], (ready.traceable >> lane & 1u) != 0)) return true;
            give(answers[s.ray_index], s.hit);
        }
        return false;
    };

    for (std::size_t slot = 0; slot < flight && begin_next(states[slot], none); ++slot)
        sort_in(slot, states[slot].current);
    for (;;) {
        const std::size_t least = leaf_count + other_count > 0 ? enough : 0;
        if (ring_begin == ring_end && leaf_count + other_count == 0) return next_ray;
        while (ring_end - ring_begin > least) {
            const std::size_t slot = ring[ring_begin++ % flight];
            RayState<Node>& s = states[slot];
            const Node& node = s.nodes()[s.current];
            const SlabRay<Node> slab_ray = load_slab_ray(s);
            const Slabs<Node> slabs = test_slabs(node, slab_ray, s.best, 0);
            s.top = push_children<query>(node, s, slab_ray, slabs, stride, s.top) - 1;
            const ChildWord word = *s.top;
            s.current = word;
            fetch(s, word);
            sort_in(slot, word);
        }
        std::uint8_t todo[flight];
        std::size_t count = leaf_count;
        std::copy(leaves, leaves + flight, todo);
        leaf_count = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t slot = todo[i];
            RayState<Node>& s = states[slot];
            const TriangleBlock* block = &block_at(s.lines(), s.current & child_index_mask);
            if (query == Query::any) {
                // A ray that is blocked is done, and goes to those that are.
                const uint blocker = blocker_in(block, s);
                s.hit.primitive = blocker;
                s.current = *--s.top | (0u - static_cast<uint>(blocker != none));
                fetch(s, s.current);
                sort_in(slot, s.current);
                continue;
            }
            const bool improved = visit_triangles<query, TriangleTest::watertight>(block, s);
            if (improved) drop_farther(s, stride);
            s.current = *--s.top;
            fetch(s, s.current);
            sort_in(slot, s.current);
        }
        {
            count = other_count;
            std::copy(others, others + flight, todo);
            other_count = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t slot = todo[i];
                RayState<Node>& s = states[slot];
                if (s.current == word_done) {
                    give(answers[s.ray_index], s.hit);
                    if (begin_next(s, ring_begin)) sort_in(slot, s.current);
                    continue;
                }
                const bool improved = walker.visit_other(s);
                if (improved && query == Query::any) {
                    give(answers[s.ray_index], s.hit);
                    if (begin_next(s, ring_begin)) sort_in(slot, s.current);
                    continue;
                }
                if (improved) drop_farther(s, stride);
                s.current = *--s.top;
                fetch(s, s.current);
                sort_in(slot, s.current);
            }
        }
    }
}

template <class Node>
std::size_t stream_closest(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<Hit> hits,
                           std::size_t probe)
{
    if (input.triangle_test == TriangleTest::watertight)
        return trace_in_flight<Query::closest>(input, rays, {}, hits, probe);
    single_closest(input, rays, hits);
    return rays.size();
}

template <class Node>
void stream_any(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<uint> blockers)
{
    if (input.triangle_test != TriangleTest::watertight) return single_any(input, rays, blockers);
    trace_in_flight<Query::any>(input, rays, {}, blockers);
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif

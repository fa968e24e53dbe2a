// Packets: up to 64 rays that go through the tree together, for batches of rays that see much the same of the scene. A
// node or a triangle is fetched once for all of them, and each operation works on whole vectors of rays. Compiled once
// for each instruction set.
#if defined(SNELL_BVH_SIMD_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_PACKET_INL_H
#undef SNELL_BVH_SIMD_PACKET_INL_H
#else
#define SNELL_BVH_SIMD_PACKET_INL_H
#endif

#include "snell/bvh/simd/packet_leaves-inl.h"
#include "snell/bvh/simd/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <Query query, class Node>
class PacketTracer
{
  public:
    PacketTracer(const TraceInput<Node>& in, std::span<const Ray> batch, std::span<Answer<query>> to)
        : input(in), bvh(*in.bvh), rays(batch), answers(to), stacks(1, in.bvh->stack_size()),
          walker(in, batch, stacks.stride), entries(in.bvh->stack_size() + Node::width)
    {
        for (State& s : states) s.stack = stacks.stack(0);
    }

    // A block of rays that have the octant and the longest axis in common goes as it is. Others wait until their packet
    // is full: measured, full packets are worth more than near neighbours.
    void trace_all()
    {
        if (bvh.first().root == word_done) {
            for (std::size_t i = 0; i < rays.size(); ++i) trace_alone(i);
            return;
        }
        Packet p;
        for (std::size_t begin = 0; begin < rays.size(); begin += packet_size) {
            Waiting block;
            block.count = static_cast<uint>(std::min<std::size_t>(rays.size() - begin, packet_size));
            for (uint i = 0; i < block.count; ++i) block.ray[i] = static_cast<uint>(begin) + i;
            gather(p, block);
            alignas(64) uint kinds[packet_size] = {};
            kinds_of(p, kinds);
            if (kinds[0] != no_kind && is_all_one(p, kinds)) {
                trace_packet(p);
                continue;
            }
            for (uint i = 0; i < block.count; ++i) {
                if (kinds[i] == no_kind) {
                    trace_alone(block.ray[i]);
                    continue;
                }
                Waiting& group = waiting[kinds[i]];
                group.ray[group.count++] = block.ray[i];
                if (group.count == packet_size) trace_group(p, group);
            }
        }
        for (Waiting& group : waiting) trace_group(p, group);
        if (!rests.empty()) trace_rests();
    }

  private:
    struct Waiting
    {
        uint count = 0;
        uint ray[packet_size];
    };
    // Of the stack. Whether a ray meets the child's box is found out when the entry is popped: by then more of them
    // have their hits.
    struct Entry
    {
        const Node* parent; // nullptr: no box to test
        ChildWord word;
        uint child;  // of the parent
        Lanes lanes; // that met the parent
        float enter; // no ray enters the box before this
    };

    using State = RayState<Node>;

    const TraceInput<Node>& input;
    const WideBvh<Node>& bvh;
    const std::span<const Ray> rays;
    const std::span<Answer<query>> answers;
    Stacks stacks; // of a ray that goes its own way
    const Walker<query, Node> walker;
    std::vector<Entry> entries;
    Waiting waiting[no_kind];
    State states[packet_size];
    Lanes prepared = 0; // those of the states that belong to the current packet's rays

    // What the lanes in `left` do later on their own.
    Lanes left = 0;
    uint later_count[packet_size];
    ChildWord later_word[packet_size][Rest::most];
    float later_enter[packet_size][Rest::most];
    std::vector<Rest> rests;

    // Fewer than this go on alone: below an inner node, later and with many others in flight.
    static constexpr uint least_together = query == Query::any ? 16 : 8;

    HWY_NOINLINE void trace_alone(std::size_t index)
    {
        State& s = states[0];
        if (walker.start(s, index)) walk(walker, s);
        give(answers[index], s.hit);
    }

    // Puts off what is below a child for these lanes.
    void leave(Packet& p, Lanes lanes, const WideTree<Node>& tree, const Entry& entry)
    {
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes));
            if ((left >> lane & 1u) == 0) later_count[lane] = 0;
            left |= Lanes{1} << lane;
            if (later_count[lane] == Rest::most) {
                visit_one_by_one(p, Lanes{1} << lane, tree, entry.word);
                continue;
            }
            later_word[lane][later_count[lane]] = entry.word;
            later_enter[lane][later_count[lane]++] = entry.enter;
        }
    }

    // The packet is through: makes a Rest of what a lane put off. False if nothing counts any more.
    bool put_off(const Packet& p, uint lane)
    {
        if (p.best[lane] == -INFINITY) return false;
        Rest rest;
        rest.ray = p.ray_index[lane];
        rest.best = p.best[lane];
        rest.hit = {p.t[lane], p.u[lane], p.v[lane], p.primitive[lane], p.instance[lane]};
        rest.count = 0;
        for (uint i = 0; i < later_count[lane]; ++i)
            if (later_enter[lane][i] <= rest.best) {
                rest.word[rest.count] = later_word[lane][i];
                rest.enter[rest.count++] = later_enter[lane][i];
            }
        if (rest.count == 0) return false;
        rests.push_back(rest);
        return true;
    }

    void trace_rests()
    {
        trace_in_flight<query>(input, rays, rests, answers);
        rests.clear();
    }

    void trace_group(Packet& p, Waiting& group)
    {
        if (group.count < least_together) {
            for (uint i = 0; i < group.count; ++i) trace_alone(group.ray[i]);
        } else {
            gather(p, group);
            trace_packet(p);
        }
        group.count = 0;
    }

    void gather(Packet& p, const Waiting& group)
    {
        p.count = group.count;
        // The vectors are filled up with copies of the first ray.
        const uint whole = (group.count + 15) / 16 * 16;
        for (uint lane = 0; lane < whole; lane += 4) {
            const Ray* four[4];
            for (uint i = 0; i < 4; ++i) four[i] = &rays[group.ray[lane + i < group.count ? lane + i : 0]];
            put_four(p, lane, four);
        }
        std::copy(group.ray, group.ray + group.count, p.ray_index);
    }

    // The rays are there, all of one kind.
    void trace_packet(Packet& p)
    {
        const vec3 d(p.direction[0][0], p.direction[1][0], p.direction[2][0]);
        p.octant = floatBitsToUint(d.x) >> 31 | floatBitsToUint(d.y) >> 31 << 1 | floatBitsToUint(d.z) >> 31 << 2;
        p.kz = longest_axis(d);
        p.kx = next_axis[p.kz];
        p.ky = next_axis[p.kx];
        set_missed(p);
        if (!input.scene->planes.empty()) meet_planes(p);
        prepared = left = 0;
        const PacketBounds bounds = enter_world(p, bvh.first().box);
        traverse(p, bounds, bvh.first(), 0);
        for (Lanes rest = left; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(rest));
            if (!put_off(p, lane)) left &= ~(Lanes{1} << lane);
        }
        for (Lanes rest = all_lanes(p) & ~left; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(rest));
            give(answers[p.ray_index[lane]], Hit{p.t[lane], p.u[lane], p.v[lane], p.primitive[lane], p.instance[lane]});
        }
        if (rests.size() >= 512) trace_rests();
    }

    void meet_planes(Packet& p) const
    {
        for (uint lane = 0; lane < p.count; ++lane)
            for (std::size_t i = 0; i < input.scene->planes.size(); ++i) {
                const Plane& plane = input.scene->planes[i];
                const Intersection r = intersect_plane(rays[p.ray_index[lane]], plane.normal, plane.offset);
                const uint primitive = pack_primitive(kind_plane, static_cast<uint>(i));
                const Hit found = {p.t[lane], 0.0f, 0.0f, p.primitive[lane], none};
                if (!r.ok || !is_better_hit(r.t, primitive, none, found)) continue;
                p.t[lane] = r.t;
                p.primitive[lane] = primitive;
                p.best[lane] = query == Query::any ? -INFINITY : r.t;
            }
    }

    // Runs visit(state) for the ray of a lane, with what it has found, and takes over what it finds.
    template <class Visit>
    HWY_INLINE void visit_alone(Packet& p, uint lane, const WideTree<Node>& tree, const Visit& visit)
    {
        State& s = states[lane];
        if (!(prepared >> lane & 1u)) {
            prepared |= Lanes{1} << lane;
            s.ray_index = p.ray_index[lane];
            s.steps = 0;
            enter_space(s, rays[s.ray_index], tree, none);
        }
        s.best = p.best[lane];
        s.hit = {p.t[lane], p.u[lane], p.v[lane], p.primitive[lane], p.instance[lane]};
        visit(s);
        p.best[lane] = query == Query::any && is_hit(s.hit) ? -INFINITY : s.best;
        p.t[lane] = s.hit.t;
        p.u[lane] = s.hit.u;
        p.v[lane] = s.hit.v;
        p.primitive[lane] = s.hit.primitive;
        p.instance[lane] = s.hit.instance;
    }

    // Everything below a child, for the rays in `lanes` one by one.
    HWY_NOINLINE void visit_one_by_one(Packet& p, Lanes lanes, const WideTree<Node>& tree, ChildWord word)
    {
        for (; lanes != 0; lanes &= lanes - 1)
            visit_alone(p, static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes)), tree, [&](State& s) HWY_ATTR {
                s.top = s.stack;
                walker.push(s, word_done);
                s.current = word;
                walk(walker, s);
            });
    }

    HWY_NOINLINE void visit_exactly(Packet& p, Lanes lanes, const WideTree<Node>& tree, const TriangleBlock& block,
                                    uint triangle)
    {
        for (; lanes != 0; lanes &= lanes - 1)
            visit_alone(p, static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes)), tree,
                        [&](State& s) HWY_ATTR { visit_triangle_exactly<Query::closest>(block, triangle, s); });
    }

    // What the rays have of the stack begins at `base`.
    void traverse(Packet& p, const PacketBounds& bounds, const WideTree<Node>& tree, std::size_t base)
    {
        const Node* const nodes = tree.nodes.data();
        float best = most_of(p, p.best);
        if (best == -INFINITY) return;
        std::size_t size = base + 1;
        entries[base] = {nullptr, tree.root, 0, all_lanes(p), -FLT_MAX};
        while (size > base) {
            const Entry entry = entries[--size];
            if (entry.enter > best) continue;
            const Lanes lanes = entry.parent == nullptr
                                    ? entry.lanes
                                    : lanes_in_box(p, bounds, *entry.parent, entry.child, entry.lanes);
            if (lanes == 0) continue;
            const ChildWord word = entry.word;
            if (word <= child_index_mask) {
                if (hwy::PopCount(lanes) >= least_together) {
                    size = push_children(nodes[word], p, bounds, best, lanes, size);
                    continue;
                }
                if (!bvh.has_instances()) {
                    leave(p, lanes, tree, entry);
                    continue;
                }
                visit_one_by_one(p, lanes, tree, word);
            } else if (RefKind(word >> 30) == RefKind::triangle) {
                if (hwy::PopCount(lanes) == 1 && !bvh.has_instances()) {
                    leave(p, lanes, tree, entry);
                    continue;
                }
                visit_triangles(p, lanes, bounds, best, tree, &block_at(tree.lines.data(), word & child_index_mask));
            } else if (RefKind(word >> 30) == RefKind::sphere) {
                for (const uint id : tree.spheres[word & child_index_mask].id)
                    if (id != none)
                        visit_sphere<query>(p, lanes, input.scene->spheres[id], pack_primitive(kind_sphere, id));
            } else if (word == word_world) {
                // The states of rays that went their own way belong to another tree.
                prepared = 0;
                if (bvh.world.root != word_done) traverse(p, bounds, bvh.world, size);
                prepared = 0;
            } else {
                visit_one_by_one(p, lanes, tree, word);
            }
            best = most_of(p, p.best);
            if (query == Query::any && best == -INFINITY) return;
        }
    }

    HWY_INLINE void visit_triangles(Packet& p, Lanes lanes, const PacketBounds& bounds, float best,
                                    const WideTree<Node>& tree, const TriangleBlock* block)
    {
        for (;; block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
            for (uint rest = triangles_in_bounds(*block, bounds, best); rest != 0; rest &= rest - 1) {
                const auto triangle = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
                const Lanes unsure = visit_triangle<query>(p, lanes, *block, triangle);
                if (HWY_UNLIKELY(unsure != 0)) visit_exactly(p, unsure, tree, *block, triangle);
            }
            if (!block->more) return;
        }
    }

    // Pushes the children that any ray may meet, the nearest last. Returns the new number of entries.
    HWY_INLINE std::size_t push_children(const Node& node, const Packet& p, const PacketBounds& bounds, float best,
                                         Lanes lanes, std::size_t size)
    {
        const uint order = query == Query::any ? order_of_slots<Node>() : node.order(p.octant);
        alignas(32) float enters[Node::width];
        for (uint rest = children_in_bounds(node, order, bounds, best, enters); rest != 0; rest &= rest - 1) {
            const auto at = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
            const uint child = order >> (Node::order_bits * at) & (Node::width - 1);
            entries[size++] = {&node, node.child[child], child, lanes, enters[child]};
        }
        return size;
    }
};

template <class Node>
void packets_closest(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    PacketTracer<Query::closest, Node>(input, rays, hits).trace_all();
}

template <class Node>
void packets_any(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<uint> blockers)
{
    PacketTracer<Query::any, Node>(input, rays, blockers).trace_all();
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif

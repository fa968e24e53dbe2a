// Packets: 16 rays that go through the tree together, for batches of rays that see much the same of the scene. A node
// or a triangle is fetched once for all of them, and each operation works on whole vectors of rays. Compiled once for
// each instruction set.
#if defined(SNELL_BVH_SIMD_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_PACKET_INL_H
#undef SNELL_BVH_SIMD_PACKET_INL_H
#else
#define SNELL_BVH_SIMD_PACKET_INL_H
#endif

#include "snell/bvh/simd/packet_rays-inl.h"
#include "snell/bvh/simd/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Lanes of `ok` where (t, number) is_better_hit(). A packet is in world space, where the instance never decides a tie
// for the newcomer.
HWY_INLINE hn::Mask<Packet::Tag> better_lanes(const Packet& p, uint first, hn::Mask<Packet::Tag> ok,
                                              hn::Vec<Packet::Tag> t, uint number)
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    const auto old_t = hn::Load(d, p.t + first);
    const auto smaller = hn::VecFromMask(du, hn::Gt(hn::Load(du, p.primitive + first), hn::Set(du, number)));
    const auto wins_tie = hn::And(hn::Eq(t, old_t), hn::MaskFromVec(hn::BitCast(d, smaller)));
    return hn::And(ok, hn::Or(hn::Lt(t, old_t), wins_tie));
}

template <Query query>
HWY_INLINE void accept_lanes(Packet& p, uint first, hn::Mask<Packet::Tag> lanes, hn::Vec<Packet::Tag> t,
                             hn::Vec<Packet::Tag> u, hn::Vec<Packet::Tag> v, uint number)
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    const auto put = [&](hn::Vec<Packet::Tag> x, float* to)
                         HWY_ATTR { hn::Store(hn::IfThenElse(lanes, x, hn::Load(d, to)), d, to); };
    const auto put_uint = [&](uint x, uint* to) HWY_ATTR {
        const auto set = hn::MaskFromVec(hn::BitCast(du, hn::VecFromMask(d, lanes)));
        hn::Store(hn::IfThenElse(set, hn::Set(du, x), hn::Load(du, to)), du, to);
    };
    put(t, p.t + first);
    put(u, p.u + first);
    put(v, p.v + first);
    put_uint(number, p.primitive + first);
    put_uint(none, p.instance + first);
    put(query == Query::any ? hn::Set(d, -INFINITY) : t, p.best + first);
}

// intersect_sphere(), operation by operation, on vectors of rays.
template <Query query>
HWY_INLINE void visit_sphere(Packet& p, const Sphere& ball, uint number)
{
    const Packet::Tag d;
    const auto zero = hn::Zero(d);
    const auto dot = [](auto ax, auto ay, auto az, auto bx, auto by, auto bz)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz)); };
    for_parts([&](uint i) HWY_ATTR {
        const auto rx = hn::Load(d, p.direction[0] + i), ry = hn::Load(d, p.direction[1] + i);
        const auto rz = hn::Load(d, p.direction[2] + i);
        const auto longest = hn::Max(hn::Abs(rx), hn::Max(hn::Abs(ry), hn::Abs(rz)));
        const auto scale = hn::Div(hn::Set(d, 1.0f), longest);
        const auto dx = hn::Mul(rx, scale), dy = hn::Mul(ry, scale), dz = hn::Mul(rz, scale);
        const auto fx = hn::Sub(hn::Load(d, p.origin[0] + i), hn::Set(d, ball.center.x));
        const auto fy = hn::Sub(hn::Load(d, p.origin[1] + i), hn::Set(d, ball.center.y));
        const auto fz = hn::Sub(hn::Load(d, p.origin[2] + i), hn::Set(d, ball.center.z));
        const auto a = dot(dx, dy, dz, dx, dy, dz);
        const auto b = hn::Neg(dot(fx, fy, fz, dx, dy, dz));
        const auto along = hn::Div(b, a);
        const auto nx = hn::Add(fx, hn::Mul(along, dx)), ny = hn::Add(fy, hn::Mul(along, dy));
        const auto nz = hn::Add(fz, hn::Mul(along, dz));
        const auto r2 = hn::Mul(hn::Set(d, ball.radius), hn::Set(d, ball.radius));
        const auto discriminant = hn::Sub(r2, dot(nx, ny, nz, nx, ny, nz));
        const auto best = hn::Load(d, p.best + i), t_min = hn::Load(d, p.t_min + i);
        const auto met = hn::And(hn::Gt(discriminant, zero), hn::Ne(best, hn::Set(d, -INFINITY)));
        if (hn::AllFalse(d, met)) return;

        const auto root = hn::Sqrt(hn::Mul(a, discriminant));
        const auto q = hn::IfThenElse(hn::Ge(b, zero), hn::Add(b, root), hn::Sub(b, root));
        const auto c = hn::Sub(dot(fx, fy, fz, fx, fy, fz), r2);
        const auto t0 = hn::Mul(hn::Div(c, q), scale), t1 = hn::Mul(hn::Div(q, a), scale);
        const auto in_order = hn::Lt(t0, t1);
        const auto near = hn::IfThenElse(in_order, t0, t1), far = hn::IfThenElse(in_order, t1, t0);
        const auto t = hn::IfThenElse(hn::Gt(near, t_min), near, far);
        const auto ok = hn::And(met, hn::And(hn::Gt(t, t_min), hn::Le(t, best)));
        const auto better = better_lanes(p, i, ok, t, number);
        if (!hn::AllFalse(d, better)) accept_lanes<query>(p, i, better, t, zero, zero, number);
    });
}

template <Query query, class Node, class Finish>
class PacketTracer
{
  public:
    PacketTracer(const TraceInput<Node>& in, std::span<const Ray> batch, const Finish& when_done)
        : input(in), bvh(*in.bvh), rays(batch), finish(when_done), stacks(1, in.bvh->stack_size()),
          walker(in, batch, stacks.stride), words(in.bvh->stack_size() + Node::width),
          entries(in.bvh->stack_size() + Node::width)
    {
        for (State& s : states) s.stack = stacks.stack(0);
    }

    // Rays of the same octant and longest axis wait for each other until they are a packet.
    void trace_all()
    {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& ray = rays[i];
            if (!is_traceable(ray) || bvh.first().root == word_done) {
                trace_alone(i);
                continue;
            }
            const vec3 d = ray.direction;
            const uint octant =
                floatBitsToUint(d.x) >> 31 | floatBitsToUint(d.y) >> 31 << 1 | floatBitsToUint(d.z) >> 31 << 2;
            Waiting& group = waiting[octant * 3 + static_cast<uint>(longest_axis(d))];
            group.ray[group.count++] = static_cast<uint>(i);
            if (group.count == packet_size) trace_group(group);
        }
        for (Waiting& group : waiting) trace_group(group);
    }

  private:
    struct Waiting
    {
        uint count = 0;
        uint ray[packet_size];
    };
    struct alignas(64) Entry
    {
        float enter[packet_size]; // where each ray enters the box; +infinity: never
    };

    using State = RayState<Node>;

    const TraceInput<Node>& input;
    const WideBvh<Node>& bvh;
    const std::span<const Ray> rays;
    const Finish& finish;
    Stacks stacks; // of a ray that goes its own way
    const Walker<query, TriangleTest::watertight, Node> walker;
    std::vector<ChildWord> words;
    std::vector<Entry> entries;
    Waiting waiting[24];
    State states[packet_size];
    uint prepared = 0; // bits of the states that belong to the current packet's rays

    // Fewer than this are traced one by one.
    static constexpr uint least_together = 3;

    void trace_alone(std::size_t index)
    {
        State& s = states[0];
        if (walker.start(s, index)) walk(walker, s);
        finish(index, s.hit);
    }

    void trace_group(Waiting& group)
    {
        if (group.count < least_together) {
            for (uint i = 0; i < group.count; ++i) trace_alone(group.ray[i]);
        } else {
            Packet p;
            gather(p, group);
            traverse_all(p);
            for (uint lane = 0; lane < p.count; ++lane)
                finish(p.ray_index[lane], Hit{p.t[lane], p.u[lane], p.v[lane], p.primitive[lane], p.instance[lane]});
        }
        group.count = 0;
    }

    void gather(Packet& p, const Waiting& group)
    {
        p.count = group.count;
        for (uint lane = 0; lane < packet_size; ++lane) {
            const uint index = group.ray[lane < group.count ? lane : 0];
            const Ray& ray = rays[index];
            const float numbers[8] = {ray.origin.x,    ray.origin.y,    ray.origin.z,    ray.t_min,
                                      ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max};
            for (int axis = 0; axis < 3; ++axis) {
                p.origin[axis][lane] = numbers[axis];
                p.direction[axis][lane] = numbers[4 + axis];
            }
            p.t_min[lane] = numbers[3];
            p.best[lane] = lane < group.count ? float_before(numbers[7]) : -INFINITY;
            p.t[lane] = numbers[7];
            p.u[lane] = p.v[lane] = 0.0f;
            p.primitive[lane] = p.instance[lane] = none;
            p.ray_index[lane] = index;
        }
        const vec3 d = rays[group.ray[0]].direction;
        p.octant = floatBitsToUint(d.x) >> 31 | floatBitsToUint(d.y) >> 31 << 1 | floatBitsToUint(d.z) >> 31 << 2;
        p.kz = longest_axis(d);
        p.kx = next_axis[p.kz];
        p.ky = next_axis[p.kx];
        if (!input.scene->planes.empty()) meet_planes(p);
        prepared = 0;
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
            prepared |= 1u << lane;
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
    HWY_NOINLINE void visit_one_by_one(Packet& p, uint lanes, const WideTree<Node>& tree, ChildWord word)
    {
        for (; lanes != 0; lanes &= lanes - 1)
            visit_alone(p, static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)), tree, [&](State& s) HWY_ATTR {
                s.stack_size = 0;
                walker.push(s, word_done);
                s.current = word;
                walk(walker, s);
            });
    }

    HWY_NOINLINE void visit_exactly(Packet& p, uint lanes, const WideTree<Node>& tree, const TriangleBlock& block,
                                    uint triangle)
    {
        for (; lanes != 0; lanes &= lanes - 1)
            visit_alone(p, static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)), tree,
                        [&](State& s) HWY_ATTR { visit_triangle_exactly<Query::closest>(block, triangle, s); });
    }

    // watertight() with vectors of rays instead of triangles.
    HWY_INLINE void visit_triangle(Packet& p, const WideTree<Node>& tree, const TriangleBlock& block, uint triangle)
    {
        const Packet::Tag d;
        const uint number = pack_primitive(kind_triangle, block.id[triangle]);
        const float* const lists[3] = {block.axis(0), block.axis(1), block.axis(2)};
        const uint at[3] = {block.corner_of(triangle, 0), block.corner_of(triangle, 1), block.corner_of(triangle, 2)};
        const auto corner = [&](int vertex, int axis) HWY_ATTR { return hn::Set(d, lists[axis][at[vertex]]); };
        uint unsure_bits = 0;
        for_parts([&](uint i) HWY_ATTR {
            const auto ox = hn::Load(d, p.origin[p.kx] + i), oy = hn::Load(d, p.origin[p.ky] + i);
            const auto oz = hn::Load(d, p.origin[p.kz] + i);
            const auto sx = hn::Load(d, p.shear[0] + i), sy = hn::Load(d, p.shear[1] + i);
            const auto az = hn::Sub(corner(0, p.kz), oz);
            const auto bz = hn::Sub(corner(1, p.kz), oz);
            const auto cz = hn::Sub(corner(2, p.kz), oz);
            const auto ax = hn::Sub(hn::Sub(corner(0, p.kx), ox), hn::Mul(sx, az));
            const auto ay = hn::Sub(hn::Sub(corner(0, p.ky), oy), hn::Mul(sy, az));
            const auto bx = hn::Sub(hn::Sub(corner(1, p.kx), ox), hn::Mul(sx, bz));
            const auto by = hn::Sub(hn::Sub(corner(1, p.ky), oy), hn::Mul(sy, bz));
            const auto cx = hn::Sub(hn::Sub(corner(2, p.kx), ox), hn::Mul(sx, cz));
            const auto cy = hn::Sub(hn::Sub(corner(2, p.ky), oy), hn::Mul(sy, cz));
            const auto w0 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
            const auto w1 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
            const auto w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
            const auto side = hn::Mul(hn::Min(w0, hn::Min(w1, w2)), hn::Max(w0, hn::Max(w1, w2)));
            const auto best = hn::Load(d, p.best + i);
            const auto searching = hn::Ne(best, hn::Set(d, -INFINITY));
            const auto unsure = hn::And(hn::Eq(side, hn::Zero(d)), searching);
            const auto inside = hn::And(hn::Gt(side, hn::Zero(d)), searching);
            if (HWY_LIKELY(hn::AllFalse(d, hn::Or(inside, unsure)))) return;
            unsure_bits |= packet_bits(i, unsure);

            const auto sz = hn::Load(d, p.shear[2] + i);
            const auto det = hn::Add(hn::Add(w0, w1), w2);
            const auto weighted = hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))),
                                          hn::Mul(w2, hn::Mul(sz, cz)));
            const auto t = hn::Div(weighted, det);
            const auto near = hn::And(hn::Gt(t, hn::Load(d, p.t_min + i)), hn::Le(t, best));
            const auto better = better_lanes(p, i, hn::And(inside, near), t, number);
            if (!hn::AllFalse(d, better))
                accept_lanes<query>(p, i, better, t, hn::Div(w1, det), hn::Div(w2, det), number);
        });
        if (HWY_UNLIKELY(unsure_bits != 0)) visit_exactly(p, unsure_bits, tree, block, triangle);
    }

    void traverse_all(Packet& p)
    {
        const PacketBounds<Node> bounds = enter_world<Node>(p, bvh.first().box);
        traverse(p, bounds, bvh.first(), 0);
    }

    // What the rays have of the stack begins at `base`.
    void traverse(Packet& p, const PacketBounds<Node>& bounds, const WideTree<Node>& tree, std::size_t base)
    {
        const Packet::Tag d;
        const Node* const nodes = tree.nodes.data();
        float best = most_of(p.best);
        if (best == -INFINITY) return;
        std::size_t size = base + 1;
        words[base] = tree.root;
        for_parts([&](uint i) HWY_ATTR { hn::Store(hn::Set(d, -FLT_MAX), d, entries[base].enter + i); });
        while (size > base) {
            --size;
            const ChildWord word = words[size];
            uint active = 0;
            for_parts([&](uint i) HWY_ATTR {
                active |= packet_bits(i, hn::Le(hn::Load(d, entries[size].enter + i), hn::Load(d, p.best + i)));
            });
            if (active == 0) continue;
            if (word <= child_index_mask) {
                if (hwy::PopCount(active) >= least_together) {
                    size = push_children(nodes[word], p, bounds, best, size);
                    continue;
                }
                visit_one_by_one(p, active, tree, word);
            } else if (RefKind(word >> 30) == RefKind::triangle) {
                const TriangleBlock* block = &block_at(tree.lines.data(), word & child_index_mask);
                for (;; block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
                    for (uint i = 0; i < block->count; ++i) visit_triangle(p, tree, *block, i);
                    if (!block->more) break;
                }
            } else if (RefKind(word >> 30) == RefKind::sphere) {
                for (const uint id : tree.spheres[word & child_index_mask].id)
                    if (id != none) visit_sphere<query>(p, input.scene->spheres[id], pack_primitive(kind_sphere, id));
            } else if (word == word_world) {
                // The states of rays that went their own way belong to another tree.
                prepared = 0;
                if (bvh.world.root != word_done) traverse(p, bounds, bvh.world, size);
                prepared = 0;
            } else {
                visit_one_by_one(p, active, tree, word);
            }
            best = most_of(p.best);
            if (query == Query::any && best == -INFINITY) return;
        }
    }

    // Pushes the children that any ray meets, the nearest last. Returns the new number of entries.
    HWY_INLINE std::size_t push_children(const Node& node, const Packet& p, const PacketBounds<Node>& bounds,
                                         float best, std::size_t size)
    {
        const Packet::Tag d;
        const uint order = node.order(p.octant);
        for (uint rest = children_in_bounds(node, order, bounds, best); rest != 0; rest &= rest - 1) {
            const auto at = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
            const uint child = order >> (Node::order_bits * at) & (Node::width - 1);
            bool met = false;
            for_parts([&](uint i) HWY_ATTR {
                auto enter = hn::Load(d, p.t_min + i), leave = hn::Load(d, p.best + i);
                for (int axis = 0; axis < 3; ++axis) {
                    const auto inverse = hn::Load(d, p.inverse[axis] + i);
                    enter = hn::Max(enter, hn::MulSub(hn::Set(d, plane_of(node, bounds.row[axis], child)), inverse,
                                                      hn::Load(d, p.enter[axis] + i)));
                    leave = hn::Min(leave, hn::MulSub(hn::Set(d, plane_of(node, bounds.row[axis] ^ 1u, child)), inverse,
                                                      hn::Load(d, p.leave[axis] + i)));
                }
                const auto hit = hn::Le(enter, leave);
                met = met || !hn::AllFalse(d, hit);
                hn::Store(hn::IfThenElse(hit, enter, hn::Set(d, INFINITY)), d, entries[size].enter + i);
            });
            words[size] = node.child[child];
            size += met;
        }
        return size;
    }
};

template <class Node>
void packets_closest(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    const auto finish = [&](std::size_t index, const Hit& hit) { hits[index] = hit; };
    PacketTracer<Query::closest, Node, decltype(finish)>(input, rays, finish).trace_all();
}

template <class Node>
void packets_any(const TraceInput<Node>& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    const auto finish = [&](std::size_t index, const Hit& hit) { blocked[index] = is_hit(hit); };
    PacketTracer<Query::any, Node, decltype(finish)>(input, rays, finish).trace_all();
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif

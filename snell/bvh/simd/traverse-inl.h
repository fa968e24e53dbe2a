// The traversal, compiled once for each instruction set (Highway's way: the toggling include guard lets it be read
// again and again).
#if defined(SNELL_BVH_SIMD_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_TRAVERSE_INL_H
#undef SNELL_BVH_SIMD_TRAVERSE_INL_H
#else
#define SNELL_BVH_SIMD_TRAVERSE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

enum class Query
{
    closest,
    counted, // closest, and counts steps
    any
};

// The stacks of the rays in flight, each with room for everything the tree can ask for plus one vector of slack.
class Stacks
{
  public:
    Stacks(std::size_t rays, uint entries)
        : stride((entries + 2 * node_width + 15) / 16 * 16), words(rays * stride), distances(rays * stride)
    {
    }
    ChildWord* word(std::size_t ray) { return words.data() + ray * stride; }
    float* distance(std::size_t ray) { return distances.data() + ray * stride; }

  private:
    std::size_t stride;
    std::vector<ChildWord> words;
    std::vector<float> distances; // where the ray enters the box
};

// Lanes of a mask as bits.
template <class D>
HWY_INLINE uint mask_bits(D d, hn::Mask<D> mask)
{
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return bits[0];
}

HWY_INLINE uint leave_row(const RayState& s, uint axis)
{
    return (3 + 2 * axis) * node_width - s.enter_row[axis];
}

// Pushes the children of a node that the ray meets, the nearest last.
HWY_INLINE void visit_node(const WideNode& node, RayState& s, ChildWord* words, float* distances)
{
    const hn::CappedTag<float, node_width> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    constexpr std::size_t n = hn::MaxLanes(d);
    const float* planes = &node.planes[0][0];

    const auto slab = [&](uint row, float origin, float inverse, std::size_t half) HWY_ATTR {
        return hn::Mul(hn::Sub(hn::Load(d, planes + row + half), hn::Set(d, origin)), hn::Set(d, inverse));
    };
    const auto enter = [&](std::size_t half) HWY_ATTR {
        const auto x = slab(s.enter_row[0], s.enter_origin[0], s.inverse[0], half);
        const auto y = slab(s.enter_row[1], s.enter_origin[1], s.inverse[1], half);
        const auto z = slab(s.enter_row[2], s.enter_origin[2], s.inverse[2], half);
        return hn::Max(hn::Max(x, y), hn::Max(z, hn::Set(d, s.t_min)));
    };
    const auto leave = [&](std::size_t half) HWY_ATTR {
        const auto x = slab(leave_row(s, 0), s.leave_origin[0], s.inverse[0], half);
        const auto y = slab(leave_row(s, 1), s.leave_origin[1], s.inverse[1], half);
        const auto z = slab(leave_row(s, 2), s.leave_origin[2], s.inverse[2], half);
        return hn::Min(hn::Min(x, y), hn::Min(z, hn::Set(d, s.best)));
    };

    words += s.stack_size;
    distances += s.stack_size;
    const uint order = node.order[s.octant];
    if constexpr (n == node_width) {
        const auto t = enter(0);
        const auto missed = hn::Inf(d);
        const auto key = hn::IfThenElse(hn::Le(t, leave(0)), t, missed);
        const auto shifted = hn::Shr(hn::Set(du, order), hn::ShiftLeft<2>(hn::Iota(du, 0)));
        const auto slots = hn::And(shifted, hn::Set(du, node_width - 1));
        const auto sorted = hn::TableLookupLanes(key, hn::IndicesFromVec(d, slots));
        const auto children = hn::TableLookupLanes(hn::Load(du, node.child), hn::IndicesFromVec(du, slots));
        const auto met = hn::Lt(sorted, missed);
        hn::StoreU(hn::Compress(sorted, met), d, distances);
        hn::StoreU(hn::Compress(children, hn::RebindMask(du, met)), du, words);
        s.stack_size += static_cast<uint>(hn::CountTrue(d, met));
    } else {
        alignas(16) float t[node_width];
        uint met = 0;
        for (std::size_t half = 0; half < node_width; half += n) {
            const auto entered = enter(half);
            hn::Store(entered, d, t + half);
            met |= mask_bits(d, hn::Le(entered, leave(half))) << half;
        }
        uint count = 0;
        for (uint i = 0; i < node_width; ++i) {
            const uint slot = order >> (4 * i) & (node_width - 1);
            words[count] = node.child[slot];
            distances[count] = t[slot];
            count += met >> slot & 1u;
        }
        s.stack_size += count;
    }
}

// Takes what lies beyond the nearest hit off the stack, so that popping needs no comparison.
HWY_INLINE void drop_farther(RayState& s, ChildWord* words, float* distances)
{
    uint kept = 0;
    for (uint i = 0; i < s.stack_size; ++i) {
        words[kept] = words[i];
        distances[kept] = distances[i];
        kept += distances[i] <= s.best;
    }
    s.stack_size = kept;
}

// What both triangle tests hand over: t of the four lanes, and u and v times the determinant.
struct FourTriangles
{
    hn::Vec<hn::FixedTag<float, 4>> t, u, v, det;
    hn::Mask<hn::FixedTag<float, 4>> ok, unsure; // unsure: the kernel function must decide, whatever ok says
};

// intersect_triangle_watertight, operation by operation, on four triangles.
HWY_INLINE FourTriangles watertight(const TriangleBlock& block, const RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const auto ox = hn::Set(d, s.shear_origin[0]), oy = hn::Set(d, s.shear_origin[1]);
    const auto oz = hn::Set(d, s.shear_origin[2]);
    const auto sx = hn::Set(d, s.shear.sx), sy = hn::Set(d, s.shear.sy), sz = hn::Set(d, s.shear.sz);
    const int kx = s.shear.kx, ky = s.shear.ky, kz = s.shear.kz;
    const auto az = hn::Sub(hn::Load(d, block.v[0][kz]), oz);
    const auto bz = hn::Sub(hn::Load(d, block.v[1][kz]), oz);
    const auto cz = hn::Sub(hn::Load(d, block.v[2][kz]), oz);
    const auto ax = hn::Sub(hn::Sub(hn::Load(d, block.v[0][kx]), ox), hn::Mul(sx, az));
    const auto ay = hn::Sub(hn::Sub(hn::Load(d, block.v[0][ky]), oy), hn::Mul(sy, az));
    const auto bx = hn::Sub(hn::Sub(hn::Load(d, block.v[1][kx]), ox), hn::Mul(sx, bz));
    const auto by = hn::Sub(hn::Sub(hn::Load(d, block.v[1][ky]), oy), hn::Mul(sy, bz));
    const auto cx = hn::Sub(hn::Sub(hn::Load(d, block.v[2][kx]), ox), hn::Mul(sx, cz));
    const auto cy = hn::Sub(hn::Sub(hn::Load(d, block.v[2][ky]), oy), hn::Mul(sy, cz));

    const auto w0 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto w1 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto zero = hn::Zero(d);
    const auto outside =
        hn::And(hn::Lt(hn::Min(w0, hn::Min(w1, w2)), zero), hn::Gt(hn::Max(w0, hn::Max(w1, w2)), zero));
    const auto det = hn::Add(hn::Add(w0, w1), w2);
    const auto weighted =
        hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))), hn::Mul(w2, hn::Mul(sz, cz)));
    const auto t = hn::Div(weighted, det); // NaN where det is 0 or anything was NaN
    const auto inside = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    // Where an edge function is 0, its sign needs a closer look (edge_function in the kernel).
    const auto on_edge = hn::Or(hn::Or(hn::Eq(w0, zero), hn::Eq(w1, zero)), hn::Eq(w2, zero));
    const auto unsure = hn::AndNot(outside, on_edge);
    return {t, w1, w2, det, hn::AndNot(hn::Or(outside, on_edge), inside), unsure};
}

// The same for intersect_triangle_moller_trumbore.
HWY_INLINE FourTriangles moller_trumbore(const TriangleBlock& block, const RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const auto vertex = [&](int i, int axis) HWY_ATTR { return hn::Load(d, block.v[i][axis]); };
    const auto cross_term = [](auto a, auto b, auto c, auto e)
                                HWY_ATTR { return hn::Sub(hn::Mul(a, b), hn::Mul(c, e)); };
    const auto e1x = hn::Sub(vertex(1, 0), vertex(0, 0)), e2x = hn::Sub(vertex(2, 0), vertex(0, 0));
    const auto e1y = hn::Sub(vertex(1, 1), vertex(0, 1)), e2y = hn::Sub(vertex(2, 1), vertex(0, 1));
    const auto e1z = hn::Sub(vertex(1, 2), vertex(0, 2)), e2z = hn::Sub(vertex(2, 2), vertex(0, 2));
    const auto dx = hn::Set(d, s.ray.direction.x), sx = hn::Sub(hn::Set(d, s.ray.origin.x), vertex(0, 0));
    const auto dy = hn::Set(d, s.ray.direction.y), sy = hn::Sub(hn::Set(d, s.ray.origin.y), vertex(0, 1));
    const auto dz = hn::Set(d, s.ray.direction.z), sz = hn::Sub(hn::Set(d, s.ray.origin.z), vertex(0, 2));
    const auto px = cross_term(dy, e2z, dz, e2y), qx = cross_term(sy, e1z, sz, e1y);
    const auto py = cross_term(dz, e2x, dx, e2z), qy = cross_term(sz, e1x, sx, e1z);
    const auto pz = cross_term(dx, e2y, dy, e2x), qz = cross_term(sx, e1y, sy, e1x);
    const auto dot = [](auto ax, auto bx, auto ay, auto by, auto az, auto bz)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz)); };
    const auto det = dot(e1x, px, e1y, py, e1z, pz);
    const auto u_det = dot(sx, px, sy, py, sz, pz);
    const auto v_det = dot(dx, qx, dy, qy, dz, qz);
    const auto u = hn::Div(u_det, det), v = hn::Div(v_det, det);
    const auto t = hn::Div(dot(e2x, qx, e2y, qy, e2z, qz), det);
    const auto zero = hn::Zero(d);
    const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)));
    const auto near = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    return {t, u_det, v_det, det, hn::And(hn::And(inside, near), hn::Ne(det, zero)), hn::FirstN(d, 0)};
}

HWY_INLINE void accept(RayState& s, float t, float u, float v, uint primitive, uint instance)
{
    s.best = t;
    s.hit = {t, u, v, primitive, instance};
}

// One triangle of a block by the kernel function, for rays that meet an edge to within rounding.
HWY_NOINLINE bool visit_triangle_exactly(const TriangleBlock& block, uint lane, RayState& s)
{
    vec3 v[3];
    for (int vertex = 0; vertex < 3; ++vertex)
        for (int axis = 0; axis < 3; ++axis) v[vertex][axis] = block.v[vertex][axis][lane];
    const Intersection r = intersect_triangle_watertight(s.ray, s.shear, v[0], v[1], v[2]);
    const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
    if (!r.ok || !is_better_hit(r.t, primitive, s.instance, s.hit)) return false;
    accept(s, r.t, r.u, r.v, primitive, s.instance);
    return true;
}

template <Query query, TriangleTest test>
HWY_INLINE bool visit_triangles(const TriangleBlock& block, RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const FourTriangles r = test == TriangleTest::watertight ? watertight(block, s) : moller_trumbore(block, s);
    if (query == Query::counted)
        for (const uint id : block.id) s.steps += id != none;
    if (HWY_LIKELY(hn::AllFalse(d, hn::Or(r.ok, r.unsure)))) return false;
    const uint ok = mask_bits(d, r.ok);
    if (query == Query::any && ok != 0) return true;
    const uint unsure = mask_bits(d, r.unsure);

    alignas(16) float t[4], u[4], v[4], det[4];
    hn::Store(r.t, d, t);
    hn::Store(r.u, d, u);
    hn::Store(r.v, d, v);
    hn::Store(r.det, d, det);
    bool improved = false;
    for (uint lane = 0; lane < 4; ++lane) {
        if (unsure >> lane & 1u) {
            improved = visit_triangle_exactly(block, lane, s) || improved;
            continue;
        }
        const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
        if (!(ok >> lane & 1u) || !is_better_hit(t[lane], primitive, s.instance, s.hit)) continue;
        accept(s, t[lane], u[lane] / det[lane], v[lane] / det[lane], primitive, s.instance);
        improved = true;
    }
    return improved;
}

template <Query query>
HWY_INLINE bool visit_spheres(const TraceInput& input, const SphereBlock& block, RayState& s)
{
    bool improved = false;
    for (const uint id : block.id) {
        if (id == none) break;
        if (query == Query::counted) ++s.steps;
        const Sphere& ball = input.scene->spheres[id];
        const Intersection r = intersect_sphere(s.ray, ball.center, ball.radius);
        const uint primitive = pack_primitive(kind_sphere, id);
        if (!r.ok || !is_better_hit(r.t, primitive, s.instance, s.hit)) continue;
        accept(s, r.t, 0.0f, 0.0f, primitive, s.instance);
        improved = true;
        if (query == Query::any) break;
    }
    return improved;
}

// Everything a traversal needs to go on with one ray, apart from visiting inner nodes.
template <Query query, TriangleTest test>
class Walker
{
  public:
    Walker(const TraceInput& in, std::span<const Ray> batch) : input(in), bvh(*in.bvh), rays(batch) {}

    // Sets the state to the root, after looking at the planes. False if there is nothing to traverse.
    bool start(RayState& s, std::size_t index, ChildWord* words, float* distances) const
    {
        const Ray& ray = rays[index];
        s.ray_index = static_cast<uint>(index);
        s.hit = miss(ray.t_max);
        s.steps = 0;
        s.stack_size = 0;
        if (!is_traceable(ray)) return false;
        s.t_min = ray.t_min;
        s.best = float_before(ray.t_max);
        for (std::size_t i = 0; i < input.scene->planes.size(); ++i) {
            const Plane& plane = input.scene->planes[i];
            if (query == Query::counted) ++s.steps;
            const Intersection r = intersect_plane(ray, plane.normal, plane.offset);
            const uint primitive = pack_primitive(kind_plane, static_cast<uint>(i));
            if (r.ok && is_better_hit(r.t, primitive, none, s.hit)) accept(s, r.t, 0.0f, 0.0f, primitive, none);
        }
        if (bvh.world.box.empty() || (query == Query::any && is_hit(s.hit))) return false;
        enter_space(s, ray, bvh.world, none);
        push(s, words, distances, word_done);
        s.current = bvh.world.word;
        return true;
    }

    // Visits the leaf, instance or marker that is `current`. True if a hit was found or improved. What comes next is
    // on the stack.
    HWY_INLINE bool visit_leaf(RayState& s, ChildWord* words, float* distances) const
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
                enter_instance(s, index, words, distances);
            return false;
        }
        return false;
    }

    const TraceInput& input;
    const WideBvh& bvh;
    const std::span<const Ray> rays;

  private:
    // Markers stay on the stack whatever the nearest hit.
    static void push(RayState& s, ChildWord* words, float* distances, ChildWord word)
    {
        words[s.stack_size] = word;
        distances[s.stack_size] = -INFINITY;
        ++s.stack_size;
    }

    void enter_instance(RayState& s, uint index, ChildWord* words, float* distances) const
    {
        const Instance& instance = input.scene->instances[index];
        const WideRoot& root = bvh.groups[instance.group];
        const Ray local = ray_to_object(rays[s.ray_index], instance.to_object);
        if (!is_traceable(local) || root.box.empty()) return;
        push(s, words, distances, word_leave_instance);
        enter_space(s, local, root, index);
        push(s, words, distances, root.word);
    }
};

template <Query query, TriangleTest test, class Finish>
HWY_INLINE void trace_one_by_one(const TraceInput& input, std::span<const Ray> rays, const Finish& finish)
{
    const Walker<query, test> walker(input, rays);
    Stacks stacks(1, input.bvh->stack_size);
    ChildWord* const words = stacks.word(0);
    float* const distances = stacks.distance(0);
    RayState s;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (walker.start(s, i, words, distances)) {
            while (s.current != word_done) {
                if (s.current <= child_index_mask) {
                    visit_node(walker.bvh.nodes[s.current], s, words, distances);
                    if (query == Query::counted) ++s.steps;
                } else if (walker.visit_leaf(s, words, distances) && query == Query::any) {
                    s.hit.primitive = 0;
                    break;
                }
                do --s.stack_size;
                while (distances[s.stack_size] > s.best);
                s.current = words[s.stack_size];
            }
        }
        finish(s);
    }
}

template <Query query, class Finish>
HWY_INLINE void single(const TraceInput& input, std::span<const Ray> rays, const Finish& finish)
{
    if (input.triangle_test == TriangleTest::watertight)
        trace_one_by_one<query, TriangleTest::watertight>(input, rays, finish);
    else
        trace_one_by_one<query, TriangleTest::moller_trumbore>(input, rays, finish);
}

void single_closest(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    single<Query::closest>(input, rays, [&](const RayState& s) { hits[s.ray_index] = s.hit; });
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
    const Walker<query, test> walker(input, rays);
    const WideNode* const nodes = walker.bvh.nodes.data();
    Stacks stacks(flight, input.bvh->stack_size);
    RayState states[flight];
    std::uint8_t inner[flight], other[2 * flight];
    std::size_t inner_count = 0, other_count = 0, next_ray = 0;

    const auto sort_in = [&](std::size_t slot) {
        if (states[slot].current <= child_index_mask)
            inner[inner_count++] = static_cast<std::uint8_t>(slot);
        else
            other[other_count++] = static_cast<std::uint8_t>(slot);
    };
    // Gives the slot to the next ray that has something to traverse.
    const auto refill = [&](std::size_t slot) {
        while (next_ray < rays.size()) {
            if (walker.start(states[slot], next_ray++, stacks.word(slot), stacks.distance(slot))) {
                sort_in(slot);
                return;
            }
            finish(states[slot]);
        }
    };
    const auto fetch = [&](ChildWord word) {
        if (!input.prefetch) return;
        const char* lines =
            word <= child_index_mask
                ? reinterpret_cast<const char*>(nodes + word)
                : reinterpret_cast<const char*>(walker.bvh.triangles.data() + (word & child_index_mask));
        // An instance, a sphere or a marker makes an address that is fetched in vain; that is harmless.
        for (int line = 0; line < 4; ++line) __builtin_prefetch(lines + 64 * line);
    };

    for (std::size_t slot = 0; slot < flight; ++slot) refill(slot);
    while (inner_count + other_count > 0) {
        while (inner_count > (other_count > 0 ? flight / 4 : 0)) {
            std::size_t still = 0;
            for (std::size_t i = 0; i < inner_count; ++i) {
                const std::size_t slot = inner[i];
                RayState& s = states[slot];
                visit_node(nodes[s.current], s, stacks.word(slot), stacks.distance(slot));
                s.current = stacks.word(slot)[--s.stack_size];
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
            const bool improved = walker.visit_leaf(s, stacks.word(slot), stacks.distance(slot));
            if (improved && query == Query::any) {
                s.hit.primitive = 0;
                finish(s);
                refill(slot);
                continue;
            }
            if (improved) drop_farther(s, stacks.word(slot), stacks.distance(slot));
            s.current = stacks.word(slot)[--s.stack_size];
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

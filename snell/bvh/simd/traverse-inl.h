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

// Lanes of a mask as bits.
template <class D>
HWY_INLINE uint mask_bits(D d, hn::Mask<D> mask)
{
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return bits[0];
}

// Prepares for a tree in the space of `ray`, which is traceable; the root's box is not empty.
HWY_INLINE void enter_space(RayState& s, const Ray& ray, const WideRoot& root, uint instance)
{
    const hn::FixedTag<float, 4> d; // x, y, z, and a lane of no meaning
    const auto origin = hn::LoadU(d, &ray.origin.x);
    const auto direction = hn::LoadU(d, &ray.direction.x);
    const auto reciprocal = hn::Div(hn::Set(d, 1.0f), direction);
    const auto lower = hn::Load(d, root.lower), upper = hn::Load(d, root.upper);
    const auto distance = hn::Max(hn::Abs(hn::Sub(lower, origin)), hn::Abs(hn::Sub(upper, origin)));
    const auto coordinate = hn::Max(hn::Abs(origin), hn::Max(hn::Abs(lower), hn::Abs(upper)));
    alignas(16) float distances[4], coordinates[4];
    hn::Store(distance, d, distances);
    hn::Store(coordinate, d, coordinates);
    const float reach = max(max(distances[0], distances[1]), distances[2]);
    const float limit = 1e36f / (max(max(coordinates[0], coordinates[1]), coordinates[2]) + 1e-2f);

    const auto relative = hn::Mul(hn::Abs(origin), hn::Set(d, 0x1p-22f));
    const auto slack = hn::Add(relative, hn::Set(d, reach * 0x1p-21f + 1e-30f));
    const auto along = hn::CopySign(slack, reciprocal);
    const auto inverse = hn::Max(hn::Min(reciprocal, hn::Set(d, limit)), hn::Set(d, -limit));
    hn::Store(inverse, d, s.inverse);
    hn::Store(hn::Mul(hn::Add(origin, along), inverse), d, s.enter_term);
    hn::Store(hn::Mul(hn::Sub(origin, along), inverse), d, s.leave_term);
    s.octant = mask_bits(d, hn::Lt(reciprocal, hn::Zero(d))) & 7u;
    s.instance = instance;
    s.ray = ray;

    // shear_ray(), from arrays: vec3's operator[] branches.
    alignas(16) float o[4], r[4], v[4];
    hn::Store(origin, d, o);
    hn::Store(reciprocal, d, r);
    hn::Store(direction, d, v);
    const int kz = longest_axis(ray.direction);
    const int kx = next_axis[kz], ky = next_axis[kx];
    s.shear = {kx, ky, kz, v[kx] / v[kz], v[ky] / v[kz], r[kz]};
    s.shear_origin[0] = o[kx];
    s.shear_origin[1] = o[ky];
    s.shear_origin[2] = o[kz];
}

// The part of the state that slab tests need, in registers.
struct SlabRay
{
    using Tag = hn::CappedTag<float, node_width>;
    using Vec = hn::Vec<Tag>;
    Vec inverse_x, inverse_y, inverse_z, enter_x, enter_y, enter_z, leave_x, leave_y, leave_z, t_min;
    SlabRows rows;
};

HWY_INLINE SlabRay load_slab_ray(const RayState& s)
{
    const SlabRay::Tag d;
    return {hn::Set(d, s.inverse[0]),    hn::Set(d, s.inverse[1]),    hn::Set(d, s.inverse[2]),
            hn::Set(d, s.enter_term[0]), hn::Set(d, s.enter_term[1]), hn::Set(d, s.enter_term[2]),
            hn::Set(d, s.leave_term[0]), hn::Set(d, s.leave_term[1]), hn::Set(d, s.leave_term[2]),
            hn::Set(d, s.t_min),         rows_by_octant[s.octant]};
}

// Where the ray enters and leaves the boxes of a node, or of half of it where vectors are short.
struct Slabs
{
    using Tag = SlabRay::Tag;
    SlabRay::Vec enter, leave;
};

HWY_INLINE Slabs test_slabs(const WideNode& node, const SlabRay& r, float best, std::size_t half)
{
    const Slabs::Tag d;
    const float* planes = &node.planes[0][0] + half;
    const auto enter_x = hn::MulSub(hn::Load(d, planes + r.rows.enter[0]), r.inverse_x, r.enter_x);
    const auto enter_y = hn::MulSub(hn::Load(d, planes + r.rows.enter[1]), r.inverse_y, r.enter_y);
    const auto enter_z = hn::MulSub(hn::Load(d, planes + r.rows.enter[2]), r.inverse_z, r.enter_z);
    const auto leave_x = hn::MulSub(hn::Load(d, planes + r.rows.leave[0]), r.inverse_x, r.leave_x);
    const auto leave_y = hn::MulSub(hn::Load(d, planes + r.rows.leave[1]), r.inverse_y, r.leave_y);
    const auto leave_z = hn::MulSub(hn::Load(d, planes + r.rows.leave[2]), r.inverse_z, r.leave_z);
    return {hn::Max(hn::Max(enter_x, enter_y), hn::Max(enter_z, r.t_min)),
            hn::Min(hn::Min(leave_x, leave_y), hn::Min(leave_z, hn::Set(d, best)))};
}

// Lane numbers in the low three bits, whatever is above.
template <class D, class V>
HWY_INLINE auto lanes_of(D d, V numbers)
{
    const hn::RebindToUnsigned<D> du;
    return hn::IndicesFromVec(d, hn::And(numbers, hn::Set(du, hn::MaxLanes(d) - 1)));
}

// Pushes the children that the ray meets, the nearest last. Returns the new number of entries.
template <Query query>
HWY_INLINE uint push_children(const WideNode& node, const RayState& s, const SlabRay& slab_ray, const Slabs& slabs,
                              std::size_t stride, uint size)
{
    const Slabs::Tag d;
    const hn::RebindToUnsigned<Slabs::Tag> du;
    constexpr std::size_t n = hn::MaxLanes(d);
    ChildWord* const words = s.stack + size;
    uint* const distances = words + stride;
    const uint order = node.order[s.octant];
    if constexpr (n == node_width) {
        const auto by_lane = hn::ShiftLeft<2>(hn::Iota(du, 0));
        const auto front_to_back = hn::Shr(hn::Set(du, order), by_lane);
        const auto children = hn::Load(du, node.child);
#if HWY_TARGET <= HWY_AVX3
        const auto enter = hn::TableLookupLanes(slabs.enter, lanes_of(d, front_to_back));
        const auto leave = hn::TableLookupLanes(slabs.leave, lanes_of(d, front_to_back));
        const auto met = hn::RebindMask(du, hn::Le(enter, leave));
        const auto sorted = hn::TableLookupLanes(children, lanes_of(du, front_to_back));
        hn::StoreU(hn::Compress(sorted, met), du, words);
        if (query != Query::any) hn::StoreU(hn::Compress(hn::BitCast(du, enter), met), du, distances);
        return size + static_cast<uint>(hn::CountTrue(du, met));
#else
        // Highway's Compress copies its table to the stack at each call when GCC 12 compiles it for AVX2.
        const auto met = hn::VecFromMask(d, hn::Le(slabs.enter, slabs.leave));
        const uint bits = mask_bits(d, hn::MaskFromVec(hn::TableLookupLanes(met, lanes_of(d, front_to_back))));
        const auto kept = hn::Shr(hn::Set(du, lane_lists.lanes[bits]), by_lane);
        const auto lanes = hn::TableLookupLanes(front_to_back, lanes_of(du, kept));
        hn::StoreU(hn::TableLookupLanes(children, lanes_of(du, lanes)), du, words);
        if (query != Query::any)
            hn::StoreU(hn::TableLookupLanes(hn::BitCast(du, slabs.enter), lanes_of(du, lanes)), du, distances);
        return size + static_cast<uint>(hwy::PopCount(bits));
#endif
    } else {
        alignas(16) uint t[node_width];
        uint met = 0;
        Slabs part = slabs;
        for (std::size_t half = 0;; part = test_slabs(node, slab_ray, s.best, half)) {
            hn::Store(hn::BitCast(du, part.enter), du, t + half);
            met |= mask_bits(d, hn::Le(part.enter, part.leave)) << half;
            half += n;
            if (half >= node_width) break;
        }
        uint count = 0;
        for (uint i = 0; i < node_width; ++i) {
            const uint lane = order >> (4 * i) & (node_width - 1);
            words[count] = node.child[lane];
            distances[count] = t[lane];
            count += met >> lane & 1u;
        }
        return size + count;
    }
}

// Stores the lanes in `set` of both vectors side by side and returns how many they are.
HWY_INLINE uint store_lanes(uint set, hn::Vec<hn::RebindToUnsigned<Slabs::Tag>> a, uint* to_a,
                            hn::Vec<hn::RebindToUnsigned<Slabs::Tag>> b, uint* to_b)
{
    const hn::RebindToUnsigned<Slabs::Tag> du;
    const auto lanes = hn::Shr(hn::Set(du, lane_lists.lanes[set]), hn::ShiftLeft<2>(hn::Iota(du, 0)));
    hn::StoreU(hn::TableLookupLanes(a, lanes_of(du, lanes)), du, to_a);
    hn::StoreU(hn::TableLookupLanes(b, lanes_of(du, lanes)), du, to_b);
    return static_cast<uint>(hwy::PopCount(set));
}

// Takes what lies beyond the nearest hit off the stack, so that popping needs no comparison.
HWY_INLINE void drop_farther(RayState& s, std::size_t stride)
{
    const Slabs::Tag d;
    const hn::RebindToUnsigned<Slabs::Tag> du;
    constexpr uint n = hn::MaxLanes(d);
    uint* const words = s.stack;
    uint* const distances = s.stack + stride;
    uint kept = 0;
    for (uint i = 0; i < s.stack_size; i += n) {
        const auto distance = hn::LoadU(du, distances + i);
        const uint all = s.stack_size - i < n ? (1u << (s.stack_size - i)) - 1 : (1u << n) - 1;
        const uint near = all & mask_bits(d, hn::Le(hn::BitCast(d, distance), hn::Set(d, s.best)));
        kept += store_lanes(near, hn::LoadU(du, words + i), words + kept, distance, distances + kept);
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
    // Positive: all three have the same sign. 0: one is 0 or nearly so, and its sign needs a closer look (edge_function
    // in the kernel). Negative: outside.
    const auto side = hn::Mul(hn::Min(w0, hn::Min(w1, w2)), hn::Max(w0, hn::Max(w1, w2)));
    const auto det = hn::Add(hn::Add(w0, w1), w2);
    const auto weighted =
        hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))), hn::Mul(w2, hn::Mul(sz, cz)));
    const auto t = hn::Div(weighted, det); // NaN where det is 0 or anything was NaN
    const auto inside = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    const auto zero = hn::Zero(d);
    return {t, w1, w2, det, hn::And(hn::Gt(side, zero), inside), hn::Eq(side, zero)};
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
    for (uint rest = ok | unsure; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        if (HWY_UNLIKELY(unsure >> lane & 1u)) {
            improved = visit_triangle_exactly(block, lane, s) || improved;
            continue;
        }
        const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
        if (!is_better_hit(t[lane], primitive, s.instance, s.hit)) continue;
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
    Walker(const TraceInput& in, std::span<const Ray> batch, std::size_t stack_stride)
        : input(in), bvh(*in.bvh), rays(batch), stride(stack_stride)
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
        for (std::size_t i = 0; i < input.scene->planes.size(); ++i) {
            const Plane& plane = input.scene->planes[i];
            if (query == Query::counted) ++s.steps;
            const Intersection r = intersect_plane(ray, plane.normal, plane.offset);
            const uint primitive = pack_primitive(kind_plane, static_cast<uint>(i));
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

    const TraceInput& input;
    const WideBvh& bvh;
    const std::span<const Ray> rays;
    const std::size_t stride; // of Stacks

  private:
    // Markers stay on the stack whatever the nearest hit.
    void push(RayState& s, ChildWord word) const
    {
        s.stack[s.stack_size] = word;
        s.stack[s.stack_size + stride] = floatBitsToUint(-INFINITY);
        ++s.stack_size;
    }

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

template <Query query, TriangleTest test, class Finish>
HWY_INLINE void trace_one_by_one(const TraceInput& input, std::span<const Ray> rays, const Finish& finish)
{
    Stacks stacks(1, input.bvh->stack_size);
    const std::size_t stride = stacks.stride;
    const Walker<query, test> walker(input, rays, stride);
    const WideNode* const nodes = walker.bvh.nodes.data();
    ChildWord* const stack = stacks.stack(0);
    RayState s;
    s.stack = stack;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (walker.start(s, i)) {
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
                        break;
                    }
                }
                do --size;
                while (query != Query::any && uintBitsToFloat(stack[stride + size]) > s.best);
                current = stack[size];
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

// Rays through the two levels of trees, with a short stack: each level of a tree takes one entry, a node with the
// children that are still to be visited (after Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs
// Through Compressed Wide BVHs). The trees are those of snell/bvh/, byte for byte.
#include "snell/kernel/bounds.h"
#include "snell/kernel/coverage.h"
#include "snell/kernel/features.h"
#include "snell/kernel/intersect.h"
#include "snell/vulkan/shaders/child_words.glsl"

layout(constant_id = 1) const uint tree_layout = 1u;     // layout_*
layout(constant_id = 2) const uint triangle_test = 0u;   // test_*
layout(constant_id = 3) const uint stack_size = 32u;     // entries that no ray can exceed
layout(constant_id = 4) const uint scene_coverage = 0u;  // SceneView::coverage
layout(constant_id = 5) const uint counts_steps = 0u;    // 1: steps are counted

const uint query_closest = 0u;
const uint query_any = 1u;
const uint query_next = 2u; // closest behind a given hit

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer QuadArray
{
    uvec4 at[];
};

// What a ray needs in the space of one tree.
struct Space
{
    Ray ray;
    vec3 inverse;
    vec3 enter_term, leave_term; // origin * inverse, for the planes where the ray enters and leaves boxes
    uint octant;                 // bit i: the direction is negative on axis i
    ShearedRay shear;
    QuadArray nodes;
    WordArray node_words;
    WordArray lines;
    WordArray spheres;
    uint instance;
};

// The slab test must not miss a box in which a primitive test finds a hit: boxes are seen from two origins, a little
// apart (why that is enough: snell/bvh/simd/ray_state.h). The margins are larger than there, for Vulkan lets a division
// be wrong by 2.5 units in the last place, and the planes of quantised nodes are taken through the ray's map at once.
const float slack_by_reach = 24.0f * 5.9604644775390625e-8f;
const float slack_by_origin = 10.0f * 5.9604644775390625e-8f;

Space enter_space(Ray ray, GpuTree tree, uint instance)
{
    Space s;
    s.ray = ray;
    vec3 distances = max(abs(tree.lower - ray.origin), abs(tree.upper - ray.origin));
    float reach = max3(distances);
    float limit = 1e36f / (max3(max(abs(ray.origin), max(abs(tree.lower), abs(tree.upper)))) + 1e-2f);
    vec3 slack = abs(ray.origin) * slack_by_origin + vec3(reach * slack_by_reach + 1e-30f);
    s.octant = 0u;
    for (int axis = 0; axis < 3; ++axis) {
        float d = ray.direction[axis];
        bool negative = (floatBitsToUint(d) & 0x80000000u) != 0u;
        float size = d == 0.0f ? limit : min(magnitude(1.0f / d), limit);
        float inverse = negative ? -size : size;
        float along = negative ? -slack[axis] : slack[axis];
        s.inverse[axis] = inverse;
        s.enter_term[axis] = (ray.origin[axis] + along) * inverse;
        s.leave_term[axis] = (ray.origin[axis] - along) * inverse;
        if (negative) s.octant |= 1u << axis;
    }
    s.shear = shear_ray(ray);
    s.nodes = QuadArray(tree.nodes);
    s.node_words = WordArray(tree.nodes);
    s.lines = WordArray(tree.lines);
    s.spheres = WordArray(tree.spheres);
    s.instance = instance;
    return s;
}

// Children of a quantised node that the ray meets up to `best`, as bits.
uint meet_quantised(Space s, uint node, float best)
{
    uint at = node * 8u;
    uvec4 q0 = s.nodes.at[at];
    uvec4 q1 = s.nodes.at[at + 1u];
    uvec4 q2 = s.nodes.at[at + 2u];
    uvec4 q3 = s.nodes.at[at + 3u];
    uvec4 q4 = s.nodes.at[at + 4u];
    vec3 origin = uintBitsToFloat(q0.xyz);
    vec3 step = uintBitsToFloat(uvec3(q0.w, q1.xy)) * s.inverse; // exact: the scale is a power of two
    vec3 enter_base = origin * s.inverse - s.enter_term;
    vec3 leave_base = origin * s.inverse - s.leave_term;
    bvec3 negative = bvec3((s.octant & 1u) != 0u, (s.octant & 2u) != 0u, (s.octant & 4u) != 0u);
    uvec2 enter_x = negative.x ? q2.xy : q1.zw;
    uvec2 leave_x = negative.x ? q1.zw : q2.xy;
    uvec2 enter_y = negative.y ? q3.xy : q2.zw;
    uvec2 leave_y = negative.y ? q2.zw : q3.xy;
    uvec2 enter_z = negative.z ? q4.xy : q3.zw;
    uvec2 leave_z = negative.z ? q3.zw : q4.xy;
    uint met = 0u;
    for (int child = 0; child < 8; ++child) {
        int word = child >> 2;
        int shift = (child & 3) << 3;
        vec3 entering = vec3(float(enter_x[word] >> shift & 255u), float(enter_y[word] >> shift & 255u),
                             float(enter_z[word] >> shift & 255u));
        vec3 leaving = vec3(float(leave_x[word] >> shift & 255u), float(leave_y[word] >> shift & 255u),
                            float(leave_z[word] >> shift & 255u));
        vec3 near = entering * step + enter_base;
        vec3 far = leaving * step + leave_base;
        float enter = max(max(near.x, near.y), max(near.z, s.ray.t_min));
        float leave = min(min(far.x, far.y), min(far.z, best));
        if (enter <= leave) met |= 1u << child;
    }
    return met;
}

// The same for a node of two children with float planes. (Boxes of children that are not there are infinitely far away.)
uint meet_binary(Space s, uint node, float best)
{
    uint at = node * 4u;
    uvec4 qx = s.nodes.at[at];
    uvec4 qy = s.nodes.at[at + 1u];
    uvec4 qz = s.nodes.at[at + 2u];
    uint met = 0u;
    for (int child = 0; child < 2; ++child) {
        vec3 lower = uintBitsToFloat(uvec3(qx[child], qy[child], qz[child]));
        vec3 upper = uintBitsToFloat(uvec3(qx[child + 2], qy[child + 2], qz[child + 2]));
        bvec3 negative = bvec3((s.octant & 1u) != 0u, (s.octant & 2u) != 0u, (s.octant & 4u) != 0u);
        vec3 near = mix(lower, upper, negative) * s.inverse - s.enter_term;
        vec3 far = mix(upper, lower, negative) * s.inverse - s.leave_term;
        float enter = max(max(near.x, near.y), max(near.z, s.ray.t_min));
        float leave = min(min(far.x, far.y), min(far.z, best));
        if (enter <= leave) met |= 1u << child;
    }
    return met;
}

// Bits that one slot takes in the order of children; a word of an entry: slots from far to near, and above bit 24 which
// of them are still to be visited.
uint slot_bits() { return tree_layout == layout_quantised ? 3u : 1u; }
uint node_width() { return tree_layout == layout_quantised ? 8u : 2u; }
uint first_child_word(uint node) { return tree_layout == layout_quantised ? node * 32u + 18u : node * 16u + 12u; }

uint order_of(Space s, uint node)
{
    if (tree_layout == layout_quantised) {
        uint bit = 24u * s.octant; // three bytes each
        uint word = node * 32u + 26u + (bit >> 5);
        uint low = s.node_words.at[word] >> (bit & 31u);
        uint high = (bit & 31u) > 8u ? s.node_words.at[word + 1u] << (32u - (bit & 31u)) : 0u;
        return (low | high) & 0xffffffu;
    }
    return s.node_words.at[node * 16u + 14u + (s.octant >> 2)] >> (8u * (s.octant & 3u)) & 3u;
}

// Slots as they come: the last one first, which is where any hit is likeliest to be found for its cost (see wide.h of
// snell/bvh/).
uint order_for_any() { return tree_layout == layout_quantised ? 0xfac688u : 2u; }

// What a visit of a node leaves to be done.
uint visit_node(Space s, uint node, uint query, float best)
{
    uint met = tree_layout == layout_quantised ? meet_quantised(s, node, best) : meet_binary(s, node, best);
    if (met == 0u) return 0u;
    uint order = query == query_any ? order_for_any() : order_of(s, node);
    uint waiting = 0u;
    for (uint i = 0u; i < node_width(); ++i) waiting |= (met >> (order >> (slot_bits() * i) & (node_width() - 1u)) & 1u) << i;
    return waiting << 24 | order;
}

// Takes a hit if it counts; ties go as in all structures.
bool take(uint query, Hit after, float t, float u, float v, uint primitive, uint instance, inout Hit hit)
{
    if (query == query_next && !is_later_hit(t, primitive, instance, after)) return false;
    if (!is_better_hit(t, primitive, instance, hit)) return false;
    hit.t = t;
    hit.u = u;
    hit.v = v;
    hit.primitive = primitive;
    hit.instance = instance;
    return true;
}

vec3 block_vertex(WordArray lines, uint list, uint capacity, uint corners, uint lane)
{
    uint at = list + (corners >> (4u * lane) & 15u);
    return uintBitsToFloat(uvec3(lines.at[at], lines.at[at + capacity], lines.at[at + 2u * capacity]));
}

// A leaf of triangles: one block, or several one after the other (snell/bvh/triangle_block.h).
bool visit_block(Space s, uint line, uint query, Hit after, inout Hit hit, inout uint steps)
{
    bool found = false;
    uint more = 1u;
    while (more != 0u) {
        uint at = line * 16u;
        uint corner_0 = s.lines.at[at];
        uint corner_1 = s.lines.at[at + 1u];
        uint corner_2 = s.lines.at[at + 2u];
        uint sizes = s.lines.at[at + 3u]; // count, capacity, lanes, more
        uint count = sizes & 255u;
        uint capacity = sizes >> 8 & 255u;
        more = sizes >> 24;
        if (counts_steps != 0u) steps += count;
        for (uint lane = 0u; lane < count; ++lane) {
            vec3 v0 = block_vertex(s.lines, at + 12u, capacity, corner_0, lane);
            vec3 v1 = block_vertex(s.lines, at + 12u, capacity, corner_1, lane);
            vec3 v2 = block_vertex(s.lines, at + 12u, capacity, corner_2, lane);
            Intersection r = triangle_test == test_moller_trumbore
                                 ? intersect_triangle_moller_trumbore(s.ray, v0, v1, v2)
                                 : intersect_triangle_watertight(s.ray, s.shear, v0, v1, v2);
            if (!r.ok) continue;
            uint primitive = pack_primitive(kind_triangle, s.lines.at[at + 4u + lane]);
            if (take(query, after, r.t, r.u, r.v, primitive, s.instance, hit)) found = true;
        }
        if (query == query_any && found) return true;
        line += capacity == 12u ? 3u : 4u;
    }
    return found;
}

bool visit_sphere_block(SceneView scene, Space s, uint block, uint query, Hit after, inout Hit hit, inout uint steps)
{
    bool found = false;
    for (uint i = 0u; i < 8u; ++i) {
        uint id = s.spheres.at[block * 8u + i];
        if (id == none) break;
        if (counts_steps != 0u) steps += 1u;
        Sphere ball = scene.spheres.at[id];
        uint primitive = pack_primitive(kind_sphere, id);
        Intersection r = intersect_sphere(s.ray, ball.center, ball.radius);
        if (query == query_next && r.ok && !is_later_hit(r.t, primitive, s.instance, after)) { // the far side may be
            Ray onward = s.ray;
            onward.t_min = r.t;
            r = intersect_sphere(onward, ball.center, ball.radius);
        }
        if (r.ok && take(query, after, r.t, 0.0f, 0.0f, primitive, s.instance, hit)) found = true;
        if (query == query_any && found) break;
    }
    return found;
}

bool visit_planes(SceneView scene, Ray ray, uint query, Hit after, inout Hit hit, inout uint steps)
{
    bool found = false;
    for (uint i = 0u; i < scene.plane_count; ++i) {
        if (counts_steps != 0u) steps += 1u;
        Plane plane = scene.planes.at[i];
        Intersection r = intersect_plane(ray, plane.normal, plane.offset);
        if (r.ok && take(query, after, r.t, 0.0f, 0.0f, pack_primitive(kind_plane, i), none, hit)) found = true;
    }
    return found;
}

// The nearest hit of the ray; for query_any some hit; for query_next the nearest behind `after`. A miss: as miss().
Hit trace(SceneView scene, Ray whole, uint query, Hit after, inout uint steps)
{
    Ray ray = whole;
    Hit hit = miss(ray.t_max);
    if (query == query_next) ray.t_min = float_before(after.t);
    if (!is_traceable(ray)) return hit;
    if (may_have(feature_planes) && visit_planes(scene, ray, query, after, hit, steps) && query == query_any) return hit;
    if (job.first.root == word_done) return hit;

    uvec2 stack[stack_size];
    uint top = 0u;
    uint ground = 0u;      // of the stack: entries below it belong to the tree over the instances
    bool is_below = false; // in a tree that the one over the instances has led to
    uvec2 open = uvec2(0u); // a node, and as visit_node
    Space s = enter_space(ray, job.first, none);
    uint word = job.first.root;
    for (;;) {
        uint kind = word >> 30;
        uint index = word & child_index_mask;
        if (kind == kind_node) {
            if (counts_steps != 0u) steps += 1u;
            uint waiting = visit_node(s, index, query, hit.t);
            if (waiting >> 24 != 0u) {
                if (open.y >> 24 != 0u) stack[top++] = open;
                open = uvec2(index, waiting);
            }
        } else if (kind == kind_block) {
            if (visit_block(s, index, query, after, hit, steps) && query == query_any) return hit;
        } else if (may_have(feature_spheres) && kind == kind_sphere_block) {
            if (visit_sphere_block(scene, s, index, query, after, hit, steps) && query == query_any) return hit;
        } else if (may_have(feature_instances)) {
            Ray local = ray;
            GpuTree tree = job.world;
            uint instance = none;
            if (word != word_world) {
                Instance placed = scene.instances.at[index];
                local = ray_to_object(ray, placed.to_object);
                tree = job.groups.at[placed.group];
                instance = index;
            }
            if (tree.root != word_done && is_traceable(local)) {
                if (open.y >> 24 != 0u) stack[top++] = open;
                open = uvec2(0u);
                ground = top;
                is_below = true;
                s = enter_space(local, tree, instance);
                word = tree.root;
                continue;
            }
        }
        while (open.y >> 24 == 0u) {
            if (top == ground) {
                if (!is_below) return hit;
                is_below = false;
                ground = 0u;
                s = enter_space(ray, job.first, none);
                if (top == 0u) return hit;
            }
            open = stack[--top];
        }
        uint nearest = uint(findMSB(open.y >> 24));
        open.y ^= 1u << (24u + nearest);
        uint slot = open.y >> (slot_bits() * nearest) & (node_width() - 1u);
        word = s.node_words.at[first_child_word(open.x) + slot];
    }
    return hit;
}

// The nearest hit, but for surfaces with holes where the ray passes through; see snell/kernel/coverage.h.
Hit trace_covered(SceneView scene, Ray ray, uint seed, bool from_camera, inout uint steps)
{
    uint query = query_closest;
    uint holes = scene_coverage & (from_camera ? scene_has_holes | scene_has_single_sided : scene_has_holes);
    Hit after = miss(ray.t_max);
    for (;;) {
        uint more_steps = 0u;
        Hit hit = trace(scene, ray, query, after, more_steps);
        if (query == query_closest) steps += more_steps; // up to the first surface, with holes or not
        if (holes == 0u || !is_hit(hit) || !passes_through(scene, ray, hit, seed, from_camera)) return hit;
        after = hit;
        query = query_next;
    }
}

// Whether something blocks the ray that has no hole where it is met.
bool is_blocked(SceneView scene, Ray ray, uint seed)
{
    uint query = query_any;
    Hit after = miss(ray.t_max);
    uint no_steps = 0u;
    for (;;) {
        Hit hit = trace(scene, ray, query, after, no_steps);
        if (!is_hit(hit)) return false;
        if ((scene_coverage & scene_has_holes) == 0u || !may_have_hole(scene, hit.primitive, false)) return true;
        if (query == query_any) {
            query = query_closest;
            continue;
        }
        if (!passes_through(scene, ray, hit, seed, false)) return true;
        after = hit;
        query = query_next;
    }
}

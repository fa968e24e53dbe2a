#include "snell/bvh/inspect.h"

#include "snell/bvh/simd/ray_state.h"
#include "snell/bvh/simd/traverse.h"

#include <fmt/format.h>

#include <cmath>

namespace snell {

std::string_view to_string(TreeNodeKind kind)
{
    switch (kind) {
    case TreeNodeKind::inner:
        return "node";
    case TreeNodeKind::triangles:
        return "triangles";
    case TreeNodeKind::spheres:
        return "spheres";
    case TreeNodeKind::instance:
        return "instance";
    default:
        return "world";
    }
}

const Inspectable* find_trees(const Accel& accel)
{
    return dynamic_cast<const Inspectable*>(&accel);
}

namespace {

template <uint width>
Box child_box(const FloatNode<width>& node, uint lane)
{
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = node.planes[2 * axis][lane];
        box.upper[axis] = node.planes[2 * axis + 1][lane];
    }
    return box;
}

Box child_box(const QuantisedNode& node, uint lane)
{
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] =
            std::fma(static_cast<float>(node.planes[2 * axis][lane]), node.scale[axis], node.origin[axis]);
        box.upper[axis] =
            std::fma(static_cast<float>(node.planes[2 * axis + 1][lane]), node.scale[axis], node.origin[axis]);
    }
    return box;
}

template <class Node>
uint primitives_of(const WideTree<Node>& tree, ChildWord word)
{
    const uint index = word & child_index_mask;
    uint count = 0;
    if (RefKind(word >> 30) == RefKind::triangle) {
        for (const TriangleBlock* block = &block_at(tree.lines.data(), index);;
             block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
            count += block->count;
            if (!block->more) return count;
        }
    }
    for (const uint id : tree.spheres[index].id) count += id != none;
    return count;
}

TreeNodeKind kind_of(ChildWord word)
{
    if (word == word_world) return TreeNodeKind::world;
    switch (word >> 30) {
    case 0:
        return TreeNodeKind::inner;
    case uint(RefKind::triangle):
        return TreeNodeKind::triangles;
    case uint(RefKind::sphere):
        return TreeNodeKind::spheres;
    default:
        return TreeNodeKind::instance;
    }
}

template <class Node>
TreeView list_tree(const WideTree<Node>& tree, std::string name, uint group)
{
    TreeView view;
    view.name = std::move(name);
    view.group = group;
    view.sah_cost = tree.sah_cost;
    if (tree.root == word_done) return view;
    const auto add = [&](ChildWord word, const Box& box, uint parent) {
        TreeNode node;
        node.box = box;
        node.word = word;
        node.kind = kind_of(word);
        node.parent = parent;
        node.depth = parent == none ? 0 : view.nodes[parent].depth + 1;
        if (node.kind == TreeNodeKind::triangles || node.kind == TreeNodeKind::spheres)
            node.primitives = primitives_of(tree, word);
        view.nodes.push_back(node);
    };
    add(tree.root, tree.box, none);
    for (uint i = 0; i < view.nodes.size(); ++i) {
        if (view.nodes[i].kind != TreeNodeKind::inner) continue;
        const Node& node = tree.nodes[view.nodes[i].word];
        for (uint lane = 0; lane < Node::width; ++lane) {
            if (node.child[lane] == tree.no_child) continue;
            add(node.child[lane], child_box(node, lane), i);
            ++view.nodes[i].children;
        }
    }
    return view;
}

// As nodes-inl.h, leaves-inl.h and traverse-inl.h do it, one operation after the other.
template <class Node>
class PlainWalk
{
  public:
    PlainWalk(const TraceInput<Node>& from, const Ray& of_world)
        : input(from), bvh(*from.bvh), world_ray(of_world), best(of_world.t_max)
    {
    }

    RayWalk run()
    {
        result.hit = miss(world_ray.t_max);
        if (!is_traceable(world_ray)) return result;
        best = float_before(world_ray.t_max);
        meet_planes();
        if (bvh.first().root == word_done) return result;
        enter_space(world_ray, bvh.first(), bvh.has_instances() ? 1 : 0, none);
        visit({bvh.first().root, bvh.first().box, world_ray.t_min, best});
        while (!waiting.empty()) {
            const Waiting next = waiting.back();
            waiting.pop_back();
            if (next.enter > best) {
                WalkStep& step = note(WalkStep::What::skipped, next);
                step.best = result.hit.t;
                continue;
            }
            visit(next);
        }
        return result;
    }

  private:
    struct Waiting
    {
        ChildWord word;
        Box box;
        float enter, leave;
    };

    const TraceInput<Node>& input;
    const WideBvh<Node>& bvh;
    const Ray world_ray;
    RayWalk result;
    std::vector<Waiting> waiting;
    float best;

    // The space that the ray is in.
    Ray ray;
    ShearedRay sheared;
    const WideTree<Node>* tree = nullptr;
    uint tree_number = 0, instance = none, octant = 0;
    vec3 inverse, enter_term, leave_term;

    WalkStep& note(WalkStep::What what, const Waiting& at)
    {
        WalkStep step;
        step.what = what;
        step.tree = tree_number;
        step.instance = instance;
        step.word = at.word;
        step.box = at.box;
        step.enter = at.enter;
        step.leave = at.leave;
        step.best = result.hit.t;
        result.steps.push_back(step);
        return result.steps.back();
    }

    void enter_space(const Ray& local, const WideTree<Node>& of, uint number, uint of_instance)
    {
        ray = local;
        tree = &of;
        tree_number = number;
        instance = of_instance;
        sheared = shear_ray(ray);
        float reach = 0, coordinate = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float o = ray.origin[axis], lower = of.box.lower[axis], upper = of.box.upper[axis];
            reach = max(reach, max(std::abs(lower - o), std::abs(upper - o)));
            coordinate = max(coordinate, max(std::abs(o), max(std::abs(lower), std::abs(upper))));
        }
        const float limit = 1e36f / (coordinate + 1e-2f);
        octant = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float o = ray.origin[axis], reciprocal = 1.0f / ray.direction[axis];
            const float slack = std::abs(o) * slack_by_origin + (reach * slack_by_reach + 1e-30f);
            const float along = std::copysign(slack, reciprocal);
            inverse[axis] = max(min(reciprocal, limit), -limit);
            enter_term[axis] = (o + along) * inverse[axis];
            leave_term[axis] = (o - along) * inverse[axis];
            if (reciprocal < 0.0f) octant |= 1u << axis;
        }
    }

    void accept(float t, float u, float v, uint primitive)
    {
        best = t;
        result.hit = {t, u, v, primitive, instance};
    }

    bool take(const Intersection& r, uint primitive)
    {
        if (!r.ok || !is_better_hit(r.t, primitive, instance, result.hit)) return false;
        accept(r.t, r.u, r.v, primitive);
        return true;
    }

    void meet_planes()
    {
        if (input.scene->planes.empty()) return;
        WalkStep step;
        step.what = WalkStep::What::planes;
        for (uint i = 0; i < input.scene->planes.size(); ++i) {
            const Plane& plane = input.scene->planes[i];
            const Intersection r = intersect_plane(world_ray, plane.normal, plane.offset);
            if (take(r, pack_primitive(kind_plane, i))) ++step.met;
            ++step.tested;
        }
        result.counted += step.tested;
        step.best = result.hit.t;
        result.steps.push_back(step);
    }

    void visit(const Waiting& at)
    {
        switch (kind_of(at.word)) {
        case TreeNodeKind::inner:
            return visit_node(at);
        case TreeNodeKind::triangles:
            return visit_triangles(at);
        case TreeNodeKind::spheres:
            return visit_spheres(at);
        case TreeNodeKind::world:
            return enter(at, world_ray, bvh.world, 0, none);
        case TreeNodeKind::instance:
            break;
        }
        if (at.word == word_leave_instance) {
            enter_space(world_ray, bvh.first(), 1, none);
            note(WalkStep::What::leave, at);
            return;
        }
        const uint index = at.word & child_index_mask;
        const Instance& placed = input.scene->instances[index];
        const Ray local = ray_to_object(world_ray, placed.to_object);
        if (is_traceable(local)) enter(at, local, bvh.groups[placed.group], 2 + placed.group, index);
    }

    void enter(const Waiting& at, const Ray& local, const WideTree<Node>& of, uint number, uint of_instance)
    {
        if (of.root == word_done) return;
        note(WalkStep::What::enter, at);
        const float always = -std::numeric_limits<float>::infinity();
        waiting.push_back({word_leave_instance, at.box, always, best});
        enter_space(local, of, number, of_instance);
        waiting.push_back({of.root, of.box, always, best});
    }

    void visit_node(const Waiting& at)
    {
        const Node& node = tree->nodes[at.word];
        ++result.counted;
        WalkStep& step = note(WalkStep::What::node, at);
        const uint order = node.order(octant);
        for (uint i = 0; i < Node::width; ++i) {
            const uint lane = order >> (Node::order_bits * i) & (Node::width - 1);
            const Box box = child_box(node, lane);
            float enter = ray.t_min, leave = best;
            for (int axis = 0; axis < 3; ++axis) {
                const bool negative = (octant >> axis & 1u) != 0;
                const float near = negative ? box.upper[axis] : box.lower[axis];
                const float far = negative ? box.lower[axis] : box.upper[axis];
                enter = max(enter, std::fma(near, inverse[axis], -enter_term[axis]));
                leave = min(leave, std::fma(far, inverse[axis], -leave_term[axis]));
            }
            if (node.child[lane] != tree->no_child) ++step.tested;
            if (!(enter <= leave)) continue;
            ++step.met;
            waiting.push_back({node.child[lane], box, enter, leave});
        }
    }

    void visit_triangles(const Waiting& at)
    {
        uint tested = 0, met = 0;
        for (const TriangleBlock* block = &block_at(tree->lines.data(), at.word & child_index_mask);;
             block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
            for (uint lane = 0; lane < block->count; ++lane) {
                const vec3 a = block->vertex(lane, 0), b = block->vertex(lane, 1), c = block->vertex(lane, 2);
                const Intersection r = input.triangle_test == TriangleTest::watertight
                                           ? intersect_triangle_watertight(ray, sheared, a, b, c)
                                           : intersect_triangle_moller_trumbore(ray, a, b, c);
                met += take(r, pack_primitive(kind_triangle, block->id[lane]));
            }
            tested += block->count;
            if (!block->more) break;
        }
        note_leaf(at, tested, met);
    }

    void visit_spheres(const Waiting& at)
    {
        uint tested = 0, met = 0;
        for (const uint id : tree->spheres[at.word & child_index_mask].id) {
            if (id == none) break;
            ++tested;
            const Sphere& ball = input.scene->spheres[id];
            met += take(intersect_sphere(ray, ball.center, ball.radius), pack_primitive(kind_sphere, id));
        }
        note_leaf(at, tested, met);
    }

    void note_leaf(const Waiting& at, uint tested, uint met)
    {
        WalkStep& step = note(WalkStep::What::leaf, at);
        step.tested = tested;
        step.met = met;
        result.counted += tested;
    }
};

} // namespace

template <class Node>
std::vector<TreeView> list_trees(const TraceInput<Node>& input)
{
    const WideBvh<Node>& bvh = *input.bvh;
    std::vector<TreeView> all;
    all.push_back(list_tree(bvh.world, "world", none));
    all.push_back(list_tree(bvh.top, "instances", none));
    for (uint group = 0; group < bvh.groups.size(); ++group)
        all.push_back(list_tree(bvh.groups[group], fmt::format("group {}", group), group));
    return all;
}

template <class Node>
RayWalk walk_ray(const TraceInput<Node>& input, const Ray& ray)
{
    return PlainWalk<Node>(input, ray).run();
}

#define SNELL_INSPECT(Node)                                                                                            \
    template std::vector<TreeView> list_trees(const TraceInput<Node>&);                                                \
    template RayWalk walk_ray(const TraceInput<Node>&, const Ray&);
SNELL_INSPECT(Node2)
SNELL_INSPECT(Node4)
SNELL_INSPECT(Node8)
SNELL_INSPECT(QuantisedNode)

} // namespace snell

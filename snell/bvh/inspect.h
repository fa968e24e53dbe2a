// Trees to look at: their nodes one by one, and what a ray does in them, step by step.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/bvh/node.h"

#include <string>
#include <vector>

namespace snell {

enum class TreeNodeKind
{
    inner,
    triangles,
    spheres,
    instance,
    world // among instances: the tree of what lies in world space
};
std::string_view to_string(TreeNodeKind kind);

// A node or leaf. The box is the one that rays are tested against before they visit it: that of its parent's child,
// rounded outwards in quantised trees; of a root, that of the tree.
struct TreeNode
{
    Box box; // in the space of its tree
    TreeNodeKind kind = TreeNodeKind::inner;
    ChildWord word = word_done;
    uint parent = none;  // place in TreeView::nodes; none: the root
    uint depth = 0;      // the root has 0
    uint primitives = 0; // of a leaf: triangles or spheres in it; else 0
    uint children = 0;   // of an inner node
};

// One tree of a structure of two levels.
struct TreeView
{
    std::string name;            // "world", "instances", "group 3"
    uint group = none;           // Instance::group; none: in world space
    std::vector<TreeNode> nodes; // parents before their children; none: nothing to hit
    double sah_cost = 0;         // expected cost of a ray that enters the box, in visits of nodes
};

// A step of a ray through the trees.
struct WalkStep
{
    enum class What
    {
        planes,  // all infinite planes of the scene are tested first
        node,    // the boxes of its children are tested
        leaf,    // its primitives are tested
        skipped, // was waiting, but lies behind the nearest hit that has been found meanwhile
        enter,   // an instance, or the world's tree: the ray goes on in its space
        leave
    };
    What what = What::node;
    uint tree = 0;              // number in Inspectable::trees()
    uint instance = none;       // whose tree it is
    ChildWord word = word_done; // of the node or leaf
    Box box;                    // of it, in the space of its tree
    float enter = 0, leave = 0; // t of the ray in the box, as it was met; from t_min and to the nearest hit until then
    float best = 0;             // t of the nearest hit afterwards; t_max of the ray: none yet
    uint tested = 0;            // boxes or primitives
    uint met = 0;               // node: children that the ray meets; leaf: primitives that became the nearest hit
};

struct RayWalk
{
    std::vector<WalkStep> steps;
    Hit hit;
    uint counted = 0; // nodes visited plus primitives tested, as Accel::intersect_counted counts them
};

// What structures with trees are, beside Accel. The walk is done in plain code, node by node in the order of
// Traversal::single, and gives the hit of intersect(); its steps are those of intersect_counted(), but where the
// processor rounds the slab test otherwise (before AVX2 it has no fused multiply-add) and a box is just met or missed.
class Inspectable
{
  public:
    virtual ~Inspectable() = default;
    // In this order: the world; the tree over the instances; the groups.
    virtual std::vector<TreeView> trees() const = 0;
    virtual RayWalk walk(const Ray& ray) const = 0;
};

// nullptr: a structure without trees of ours (brute, embree).
const Inspectable* find_trees(const Accel& accel);

// For WideAccel.
template <class Node>
struct TraceInput;
template <class Node>
std::vector<TreeView> list_trees(const TraceInput<Node>& input);
template <class Node>
RayWalk walk_ray(const TraceInput<Node>& input, const Ray& ray);

} // namespace snell

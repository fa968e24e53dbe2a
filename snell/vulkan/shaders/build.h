// What the kernels that build and refit trees find in memory, read by both languages: C++ fills it in, GLSL works on it.
#ifndef SNELL_VULKAN_SHADERS_BUILD_H
#define SNELL_VULKAN_SHADERS_BUILD_H
#include "snell/kernel/bounds.h"
#include "snell/vulkan/shaders/job.h"
SNELL_BEGIN

SNELL_CONST uint wide_dispatch = 32768u; // see build.glsl

// Items that a workgroup of group_size takes in passes that count and place: so many for each invocation.
SNELL_CONST uint items_each = 16u;
SNELL_CONST uint block_items = 1024u;
// Digits of the radix sort: 4 bits of 32-bit keys.
SNELL_CONST uint digit_count = 16u;
SNELL_CONST uint digit_bits = 4u;
SNELL_CONST uint key_bits = 30u;
// How far along the curve a cluster looks for the one to be joined with, to either side.
SNELL_CONST uint search_radius = 8u;
// Triangles or spheres of a leaf, at most: triangles share no vertices here, and four of them fill a block's twelve.
SNELL_CONST uint leaf_most = 4u;
SNELL_CONST uint lines_of_block = 3u;
// Levels of wide nodes that one submission makes.
SNELL_CONST uint levels_at_once = 32u;

// A node of the binary tree. The leaves come first, in the order of the curve.
struct BuildNode
{
    vec3 lower;
    uint left; // of a leaf: the child word of its primitive (snell/bvh/node.h)
    vec3 upper;
    uint right; // none: a leaf
    uint below; // primitives, at most 255 are counted; from bit 8 on, a bit for each of their kinds
};
SNELL_LAYOUT(BuildNode, 36)
SNELL_BUFFER(BuildNodeBuffer, BuildNode)
SNELL_BUFFER(AabbBuffer, Aabb)

// Where the children of a wide node go, once it is known who they are.
struct WidePlan
{
    uint root;   // node of the binary tree
    uint node;   // of the first child that is a node; the others follow it
    uint line;   // of the first one that is a block of triangles
    uint sphere; // of the first one that is a block of spheres
};
SNELL_LAYOUT(WidePlan, 16)
SNELL_BUFFER(PlanBuffer, WidePlan)

struct BuildCounters
{
    uint clusters[2];        // of even and odd rounds
    uint nodes[2];           // of the binary tree, likewise
    uint cluster_groups[3];  // for vkCmdDispatchIndirect: one invocation a cluster,
    uint block_groups[3];    // one workgroup a block of clusters,
    uint level_groups[3];    // one invocation a wide node of the level
    uint low[3], high[3];    // of the box of all, as integers that are ordered like floats
    uint root;               // child word of the finished tree; word_done: nothing to hit
    uint wide, lines, spheres, leaves; // of the finished tree: nodes, lines, sphere blocks, leaves
    uint level_begin[34];    // the first wide node of each level of this submission, the last end behind them
    float cost;              // of the finished tree, as WideTree::sah_cost
};
SNELL_LAYOUT(BuildCounters, 236)
SNELL_BUFFER(BuildCountersBuffer, BuildCounters)

// A tree that is built or refitted.
struct BuildJob
{
    Vec3Array positions;
    TriangleArray triangles;
    SphereArray spheres;
    InstanceArray instances;
    TreeBuffer groups;          // trees over instances
    uint first_triangle, triangle_count;
    uint first_sphere, sphere_count;
    uint instance_count;        // more than 0: a tree over instances, and the world's tree behind them if there is one
    uint has_world;
    uint count;                 // of primitives in all
    float cost_below;           // of a ray in what instances lead to: reckoned alike for all
    GpuTree tree;               // build: the world's tree, for trees over instances; refit: the tree
    AabbBuffer boxes;           // build: of the primitives, in the order of the scene; refit: of the nodes
    WordBuffer codes_0, codes_1, places_0, places_1; // of the primitives, sorted from one pair to the other
    WordBuffer sums;            // of blocks
    BuildNodeBuffer nodes;
    WordBuffer clusters_0, clusters_1, wanted;
    PlanBuffer plans;
    BuildCountersBuffer counters;
    WordBuffer costs;           // floats: of workgroups
    WordBuffer order;           // refit: the nodes, level by level
    WordBuffer out_nodes, out_lines, out_spheres; // the finished tree
    uint no_child;              // its word in the place of children that are not there
    uint pad0;
};
SNELL_LAYOUT(BuildJob, 272)
SNELL_BUFFER(BuildJobBuffer, BuildJob)

// What differs between dispatches.
struct BuildPush
{
    BuildJobBuffer job;
    uint round; // of sorting, of joining, or number of a level
    uint which; // see the kernels
    uint first, count;
    uint to;
    uint pad0;
};
SNELL_LAYOUT(BuildPush, 32)

SNELL_END
#endif

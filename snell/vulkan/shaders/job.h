// What the kernels of the GPU backend find in memory, read by both languages: C++ fills it in, GLSL works on it. Arrays
// are device addresses, 8 bytes on both sides.
#ifndef SNELL_VULKAN_SHADERS_JOB_H
#define SNELL_VULKAN_SHADERS_JOB_H
#include "snell/kernel/film.h"

#ifdef __cplusplus
#include <cstdint>
#define SNELL_BUFFER(Name, T)                                                                                          \
    struct Name                                                                                                        \
    {                                                                                                                  \
        std::uint64_t address;                                                                                         \
    };
#else
#define SNELL_BUFFER(Name, T)                                                                                          \
    layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Name                                           \
    {                                                                                                                  \
        T at[];                                                                                                        \
    };
#endif

SNELL_BEGIN

// Paths that a workgroup takes. A multiple of every subgroup size there is, and nothing depends on that size.
SNELL_CONST uint group_size = 64u;

// Waves of paths that one submission holds: a wave is one bounce of all paths.
SNELL_CONST uint waves_at_once = 8u;

// Layouts of trees by number: nodes of snell/bvh/node.h.
SNELL_CONST uint layout_binary = 0u;    // Node2
SNELL_CONST uint layout_quantised = 1u; // QuantisedNode

SNELL_BUFFER(WordBuffer, uint)
SNELL_BUFFER(RayBuffer, Ray)
SNELL_BUFFER(StateBuffer, PathState)
SNELL_BUFFER(HitBuffer, Hit)
SNELL_BUFFER(ConnectionBuffer, Connection)

// A WideTree of snell/bvh/wide.h.
struct GpuTree
{
    WordBuffer nodes;
    WordBuffer lines;   // triangle blocks
    WordBuffer spheres; // sphere blocks
    vec3 lower;         // of the root's box
    uint root;          // child word; word_done: nothing to hit
    vec3 upper;
    uint pad0;
};
SNELL_LAYOUT(GpuTree, 56)
SNELL_BUFFER(TreeBuffer, GpuTree)

SNELL_BUFFER(SlotBuffer, SampleSlot)

// What the pictures beside the colour record of one sample: FirstHit, and what led to it.
struct GpuFirstHit
{
    vec3 albedo; // of what is seen in mirrors and through glass; 0: of nothing
    vec3 normal;
    vec3 geometric_normal;
    vec3 position;
    vec2 uv;
    float depth;
    uint object, material;
    uint steps;   // of the traversal
    uint has_hit; // 0: all above but steps mean nothing
};
SNELL_LAYOUT(GpuFirstHit, 76)
SNELL_BUFFER(FirstHitBuffer, GpuFirstHit)

// Pixels that have lost samples which are not finite, as many as a film keeps.
SNELL_CONST uint dropped_pixels = 16u;

// What has been left out of the film.
struct GpuDropped
{
    uint samples;
    uint sample_number, pixel; // of one of them
    vec3 radiance;             // of that sample
    uint pixels[16];           // the first ones of the film, in ascending order; none: there are no more
};
SNELL_LAYOUT(GpuDropped, 88)
SNELL_BUFFER(DroppedBuffer, GpuDropped)

struct GpuPixelLayers
{
    PixelLight light;
    PixelHits hits;
};
SNELL_LAYOUT(GpuPixelLayers, 116)
SNELL_BUFFER(PixelSumsBuffer, PixelSums)
SNELL_BUFFER(PixelLayersBuffer, GpuPixelLayers)

// The film: pixels of a part of the picture, row by row.
struct GpuFilm
{
    PixelSumsBuffer sums;
    PixelLayersBuffer layers;
    DroppedBuffer dropped;
    uint x0, y0, columns;
    uint has_layers;
};
SNELL_LAYOUT(GpuFilm, 40)

// Paths that are sorted by material: a bin for each kind, and the last one for those that have met nothing.
SNELL_CONST uint sort_bins = 8u;
SNELL_CONST uint bin_of_misses = material_kinds;

// How many there are of what the stages hand on, wave by wave, and the workgroups for them.
struct GpuCounters
{
    uint paths[9];        // that enter the wave; [waves_at_once]: that are left for the next submission
    uint connections[8];  // that the wave has made
    uint path_groups[27]; // three numbers for each wave: what vkCmdDispatchIndirect reads
    uint connection_groups[24];
    uint paths_taken[8];       // by workgroups that fetch them
    uint connections_taken[8]; // the same
    uint bin_sizes[64];        // sorting by material: eight for each wave
    uint bin_filled[64];
};
SNELL_LAYOUT(GpuCounters, 848)
SNELL_BUFFER(CountersBuffer, GpuCounters)

// The two continuations that Whitted's renderer may have at a surface, before they find their places in the queue.
struct GpuBranches
{
    Ray ray_0;
    PathState state_0;
    Ray ray_1;
    PathState state_1;
};
SNELL_LAYOUT(GpuBranches, 152)
SNELL_BUFFER(BranchBuffer, GpuBranches)

// Everything that stays the same for all kernels of a render.
struct GpuJob
{
    SceneView scene;
    TreeBuffer groups;        // by Instance::group
    RayBuffer rays_0, rays_1; // two queues of paths: one is read while the other is filled
    StateBuffer states_0, states_1;
    HitBuffer hits; // of the paths of the wave
    WordBuffer steps;
    WordBuffer bins, sorted; // sorting by material: by path, its bin; then the paths in order
    ConnectionBuffer connections;
    SlotBuffer slots;          // by sample of the batch
    SlotBuffer lit;            // Whitted's renderer: by path of the wave
    BranchBuffer branches;     // the same
    WordBuffer branch_counts;  // the same: 0 to 2; then sums over 64 of them, and so on
    FirstHitBuffer first_hits; // by sample of the batch
    CountersBuffer counters;
    GpuFilm film;
    GpuTree world; // that of what lies in world space
    GpuTree first; // where rays begin: the tree over the instances, or the world's where there are none
    RenderParams params;
};
SNELL_LAYOUT(GpuJob, 744)
SNELL_BUFFER(JobBuffer, GpuJob)

// What differs between dispatches.
struct GpuPush
{
    JobBuffer job;
    uint queue;        // 0 or 1: the queue of paths that is read
    uint wave;         // number of the wave in its submission
    uint from_camera;  // 1: the paths are camera rays
    uint which;        // view_*, or the number of a connection or bounce
    uint count;        // of items, where the counters do not say it
    uint first_pixel;  // generate, finalize: of the batch, counted in the rows of the region
    uint first_sample; // the same
    uint samples;      // the same: of each pixel
    uint x0, y0;       // the same: of the region
    uint columns;      // the same: of the region
    uint offset;       // scan: of the sums that are read, in branch_counts
    uint to;           // scan: of the sums that are written
    uint pad0;
};
SNELL_LAYOUT(GpuPush, 64)

SNELL_END
#endif

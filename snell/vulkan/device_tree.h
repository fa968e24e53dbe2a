// Trees that live on the device, which builds and refits them itself.
#pragma once

#include "snell/bvh/wide.h"
#include "snell/vulkan/gpu.h"
#include "snell/vulkan/shaders/build.h"

#include <memory>
#include <span>
#include <vector>

namespace snell {

// One tree, as the kernels trace it.
struct DeviceTree
{
    GpuTree on_device{{0}, {0}, {0}, vec3(0.0f), word_done, vec3(0.0f), 0}; // at first: nothing to hit
    uint levels = 0;     // of nodes
    std::size_t nodes = 0, leaves = 0;
    double sah_cost = 0;      // as WideTree::sah_cost
    double built_cost = 0;    // when it was last built
    std::size_t left_out = 0; // as WideTree::left_out
    ChildWord no_child = word_done;

    // For refits: where the nodes of each level begin, and the end, in `order`; empty: they lie level by level.
    std::vector<uint> level_begin, order;
    std::unique_ptr<GpuBuffer> order_memory; // of `order`, from the first refit on
    // Its memory, if the device has built it; else that is the owner's of a tree that the host has built.
    std::unique_ptr<GpuBuffer> node_memory, line_memory, sphere_memory;

    std::size_t bytes() const; // of its own memory
};

// Describes a tree that the host has built and somebody has copied to the device: on_device needs addresses only.
template <class Node>
DeviceTree describe_host_tree(const WideTree<Node>& tree);

// Builds trees by parallel locally-ordered clustering of primitives along a Morton curve (Meister and Bittner 2018; on
// GPUs: Benthin, Drabinski, Tessari, Dittebrandt 2022, PLOC++), and collapses the binary tree level by level, the
// largest boxes first. Leaves hold up to four triangles or spheres. A tree is made anew in each build; its hits are
// those of any other tree.
class TreeBuilder
{
  public:
    // layout: layout_* of the kernels.
    TreeBuilder(std::shared_ptr<Gpu> gpu, std::uint32_t layout);
    ~TreeBuilder();

    // What is built over; scene: with addresses of the device.
    struct Input
    {
        SceneView scene{};
        PackedGroup group;              // of a tree over triangles and spheres
        uint instance_count = 0;        // more than 0: of a tree over instances
        VkDeviceAddress groups{};       // of GpuTree: what they lead to
        const GpuTree* world = nullptr; // the world's tree beside them; null: none
        double cost_below = 0;          // of a ray in what instances lead to
    };
    // Throws Error if the device has not enough memory; the tree is then as it was.
    void build(DeviceTree& tree, const Input& input);

    // Makes trees over triangles and spheres follow them, as refit() of snell/bvh/refit.h does. inputs: one for each.
    void refit(std::span<DeviceTree* const> trees, std::span<const Input> inputs);

  private:
    struct Scratch;

    void record_sort(const BuildPush& job, std::size_t count);
    void record_joins(const BuildPush& job, std::size_t count);
    std::vector<uint> make_levels(const BuildPush& job);
    void emit(DeviceTree& tree, BuildJob job, std::vector<uint> level_begin);
    void put(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes);
    void dispatch(const char* kernel, const BuildPush& push, std::size_t items);
    void dispatch_indirect(const char* kernel, const BuildPush& push, std::size_t offset);
    void part(std::size_t count);
    void run_and_read_counters(std::size_t count = 1);
    void reserve_jobs(std::size_t count);
    static std::size_t groups_of(const DeviceTree& tree);
    void record_refit(const DeviceTree& tree, BuildPush push);

    const std::shared_ptr<Gpu> gpu_;
    const std::uint32_t layout_;
    Gpu::Commands commands_;
    std::unique_ptr<Scratch> scratch_;
    std::unique_ptr<GpuBuffer> jobs_, counters_, counters_seen_; // of the trees that are worked on
    std::vector<BuildCounters> seen_;                            // that the last commands have left
};

} // namespace snell

// A scene on a Vulkan device.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/core/hash.h"
#include "snell/vulkan/device_tree.h"
#include "snell/vulkan/gpu.h"
#include "snell/vulkan/shaders/job.h"

#include <span>

namespace snell {

// Arrays of the host and their copies on the device.
class DeviceArrays
{
  public:
    explicit DeviceArrays(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

    struct Item
    {
        const void* data = nullptr; // host
        std::size_t bytes = 0;
    };
    // Makes the device have what these arrays have now; returns how many bytes were copied. Where the items are as many
    // and as large as the last time, only those whose contents have changed are copied.
    std::size_t follow(const std::vector<Item>& items);
    VkDeviceAddress address(std::size_t item) const { return places_[item].address; }
    std::size_t bytes() const { return bytes_; }

  private:
    struct Place
    {
        std::size_t bytes = 0;
        std::size_t buffer = 0, offset = 0;
        VkDeviceAddress address = 0;
        Hash128 hash;
    };
    void place(const std::vector<Item>& items);

    const std::shared_ptr<Gpu> gpu_;
    std::vector<Place> places_;
    std::vector<std::unique_ptr<GpuBuffer>> buffers_;
    std::size_t bytes_ = 0;
};

class Queues;
struct QueueKinds;

class VulkanScene final : public DeviceScene
{
  public:
    // See make_device_scene().
    VulkanScene(std::shared_ptr<Gpu> gpu, const PackedScene& scene, const AccelInfo& layout,
                const AccelOptions& options, const Accel* built);
    ~VulkanScene() override;

    std::unique_ptr<Backend> make_backend(const BackendJob& job) override;
    void update(const PackedChanges& changes) override;
    std::string title() const override { return gpu_->info().info.title; }
    std::size_t bytes() const override;

    const std::shared_ptr<Gpu>& gpu() const { return gpu_; }
    // The constants of the kernels that trace rays: snell/vulkan/shaders/trace.glsl.
    std::vector<std::uint32_t> trace_constants(bool counts_steps) const;
    // The constants of the kernels that shade.
    std::vector<std::uint32_t> shade_constants() const { return {features_}; }
    // Fills in what of a job belongs to the scene.
    void describe(GpuJob& job) const;

    // Queues for so many paths at least: those that the last picture has left, or new ones.
    std::unique_ptr<Queues> take_queues(std::size_t capacity, QueueKinds kinds);
    void give_queues(std::unique_ptr<Queues> queues);

  private:
    const std::shared_ptr<Gpu> gpu_;
    const PackedScene& scene_;
    const AccelOptions options_;
    const std::uint32_t layout_, triangle_test_;
    DeviceArrays arrays_, host_trees_, groups_; // host_trees_: built by the host; groups_: of GpuTree
    TreeBuilder builder_;
    SceneView view_{};              // with addresses of the device
    std::vector<DeviceTree> trees_; // of the groups, and last the world's
    DeviceTree top_;                // over the instances
    std::uint32_t features_ = 0, stack_size_ = 0;

    DeviceTree& world() { return trees_.back(); }
    const DeviceTree& world() const { return trees_.back(); }
    bool has_instances() const { return top_.on_device.root != word_done; }
    void upload_arrays();
    void copy_trees(const Accel& built);
    TreeBuilder::Input input_for(std::size_t tree) const;
    void follow_trees(const PackedChanges& changes);
    void upload_groups();
    void build_top();
    void settle();

    std::mutex queues_mutex_;
    std::vector<std::unique_ptr<Queues>> free_queues_;
};

} // namespace snell

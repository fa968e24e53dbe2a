// Devices that can render: the processor, and GPUs.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/core/error.h"
#include "snell/scene/packed.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace snell {

class Backend;
struct BackendJob;

// A GPU, or what drives the processor like one.
struct GpuInfo
{
    std::string device;             // for --device: "gpu:0"
    std::string title;              // what the driver calls it
    std::string type;               // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    std::string driver;             // its name and version
    std::uint64_t memory_bytes = 0; // that are nearest to the device
    std::string refusal;            // why it cannot be used; empty: it can
};

struct GpuList
{
    std::vector<GpuInfo> gpus;
    std::string problem; // why there are none, and what to do about it; empty if there are some
};
GpuList list_gpus();

// "cpu", "gpu", "gpu:2" (that number in the list), "auto".
bool is_device_name(const std::string& name);

// The device that a name stands for: "cpu" or "gpu:N". "gpu" is the best one that can be used: a discrete GPU before an
// integrated one before a virtual one before a processor. "auto" is a discrete GPU, or the CPU where there is none. The
// name must be a device name. Throws Error where a GPU is asked for that is not there or cannot be used.
struct DeviceChoice
{
    std::string device;
    std::string reason; // one line: what was chosen, and why
};
DeviceChoice choose_device(const std::string& name);

// The structures that GPUs trace; the first one is what they take if nobody asks for another.
std::span<const std::string_view> gpu_accels();

// A device has failed for good in the middle of its work: what it was given is lost, what it had given is not.
class DeviceLost : public Error
{
  public:
    using Error::Error;
};

// What a device keeps of a scene between renders: its arrays and trees. Refers to the PackedScene that it was made of.
class DeviceScene
{
  public:
    virtual ~DeviceScene() = default;

    // The job's scene is the one that this was made of.
    virtual std::unique_ptr<Backend> make_backend(const BackendJob& job) = 0;

    // Follows the scene's arrays, whatever has changed in them; only what has is copied again. `changes` says which trees
    // must follow: they are refitted or built anew on the device, by the AccelOptions. Nobody may render meanwhile.
    // Throws Error if the device has not enough memory.
    virtual void update(const PackedChanges& changes) = 0;

    virtual std::string title() const = 0; // of the device
    virtual std::size_t bytes() const = 0; // on the device

    double upload_seconds = 0;      // of the last making or update()
    std::size_t uploaded_bytes = 0; // the same
    AccelStats tree_stats;          // of the device's trees
};

// device: a GPU, as choose_device() names it. layout: one of gpu_accels(). built: a structure of that layout over the
// scene, whose trees are copied to the device; null: the device builds its own. Throws Error if the device cannot be
// used, has not enough memory or fails its self-test.
std::unique_ptr<DeviceScene> make_device_scene(const std::string& device, const PackedScene& scene,
                                               const AccelInfo& layout, const AccelOptions& options,
                                               const Accel* built);

} // namespace snell

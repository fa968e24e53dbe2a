// What a build without Vulkan has in the place of its backend.
#include "snell/core/error.h"
#include "snell/render/device.h"
#include "snell/render/render.h"

namespace snell {

static constexpr const char* problem =
    "this build of snell has no GPU backend; build it again with libvulkan-dev and glslc installed, or use "
    "--device cpu";

GpuList list_gpus()
{
    return {{}, problem};
}

std::unique_ptr<DeviceScene> make_device_scene(const std::string&, const PackedScene&, const AccelInfo&,
                                               const AccelOptions&, const Accel*)
{
    throw Error(problem);
}

} // namespace snell

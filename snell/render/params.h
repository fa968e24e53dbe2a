// From settings, as people give them, to the parameters that kernels take.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/integrator.h"
#include "snell/render/settings.h"
#include "snell/scene/camera_models.h"

namespace snell {

// Throws Error for an unknown sampler, an unknown parameter of the integrator, or a value that is none.
RenderParams make_render_params(const RenderSettings& settings, const IntegratorInfo& integrator,
                                const CameraDesc& camera, float scene_radius);

} // namespace snell

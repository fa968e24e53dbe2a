// From settings, as people give them, to the parameters that kernels take.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/integrator.h"
#include "snell/render/settings.h"
#include "snell/scene/camera_models.h"

namespace snell {

// What paths have in common, and what its camera points to.
struct ReadyParams : RenderParams
{
    std::shared_ptr<const FocusedLens> glass; // ReadyCamera::glass
};

// Throws Error for an unknown sampler, an unknown parameter of the integrator, or a value that is none.
ReadyParams make_render_params(const RenderSettings& settings, const IntegratorInfo& integrator,
                               const CameraDesc& camera, float scene_radius);

} // namespace snell

// The shade stage of the path tracer.
#ifndef TWIN_CASES
#include "snell/kernel/path.h"
#include "tests/gpu/draw.h"
SNELL_BEGIN
SNELL_FN void give_path_step(PathStep step)
{
    give(step.emitted);
    give(step.layer);
    give(step.has_connection);
    give(step.has_next);
    if (step.has_connection != 0u) give_connection(step.connection);
    if (step.has_next != 0u) give_camera_path(step.next);
}
SNELL_END
#else

TWIN_BUILTIN(shade_path, 1e-3f, 1e-3f, 0.005f) // all branches of all materials and lights
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint nothing = index_below(16u);
    if (nothing == 0u) hit = miss(ray.t_max);
    give_path_step(shade_path(scene, params, state, ray, hit));
}

#endif

// Light from infinitely far away.
#ifndef TWIN_CASES
#include "snell/kernel/environment.h"
#include "tests/gpu/draw.h"
#else

TWIN(octahedral_direction, 1e-5f, 1e-5f, 0.0f)
{
    vec2 p = unit2();
    give(octahedral_direction(p));
}
TWIN_BUILTIN(octahedral_point, 1e-5f, 1e-4f, 0.0f) // 1 - z near the poles
{
    vec3 w = direction();
    give(octahedral_point(w));
}
TWIN_BUILTIN(environment_point, 1e-5f, 1e-4f, 0.001f) // the left and the right edge are the same direction
{
    SceneView s = draw_environment(scene);
    vec3 w = direction();
    give(environment_point(s.environment, w));
}
TWIN(environment_direction, 1e-5f, 1e-5f, 0.0f)
{
    SceneView s = draw_environment(scene);
    vec2 p = unit2();
    give(environment_direction(s.environment, p));
    give(environment_solid_angle(s.environment, p));
}
TWIN_BUILTIN(environment_radiance, 1e-3f, 1e-3f, 0.001f) // the fraction between texels; the seam
{
    SceneView s = draw_environment(scene);
    vec3 w = direction();
    give(environment_radiance(s, w));
}
TWIN_BUILTIN(pdf_environment, 1e-4f, 1e-6f, 0.002f) // at the edge of a cell
{
    SceneView s = draw_environment(scene);
    vec3 w = direction();
    give(pdf_environment(s, w));
}
TWIN(find_cell, 0.0f, 0.0f, 0.0f)
{
    uint row = index_below(scene_rows);
    float u = unit();
    uint first = scene_rows + 1u + row * (scene_columns + 1u);
    give(find_cell(scene, 0u, scene_rows, u));
    give(find_cell(scene, first, scene_columns, u));
}
TWIN(place_in_cell, 1e-5f, 1e-6f, 0.0f)
{
    uint cell = index_below(scene_rows);
    float u = unit();
    give(place_in_cell(scene, cell, u));
}
TWIN_BUILTIN(sample_environment, 1e-3f, 1e-3f, 0.02f) // at the edge of a cell, where random numbers of 0 lead
{
    SceneView s = draw_environment(scene);
    vec2 u = unit2();
    give_light_sample(sample_environment(s, u));
}

#endif

// Surfaces with holes.
#ifndef TWIN_CASES
#include "snell/kernel/coverage.h"
#include "tests/gpu/draw.h"
#else

TWIN(material_of, 0.0f, 0.0f, 0.0f)
{
    Hit hit = draw_hit();
    give(material_of(scene, hit.primitive));
}
TWIN(may_have_hole, 0.0f, 0.0f, 0.0f)
{
    Hit hit = draw_hit();
    uint from_camera = index_below(2u);
    give(may_have_hole(scene, hit.primitive, from_camera != 0u));
}
TWIN_BUILTIN(passes_through, 0.0f, 0.0f, 0.002f) // next to the cutoff, or to the random number
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint seed = word();
    give(passes_through(scene, ray, hit, seed, (seed & 1u) == 0u));
}

#endif

// Surfaces with holes.
#ifndef TWIN_CASES
#include "snell/kernel/coverage.h"
#include "tests/gpu/draw.h"
#else

TWIN_BUILTIN(passes_through, 0.0f, 0.0f, 0.002f) // next to the cutoff, or to the random number
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint seed = word();
    give(passes_through(scene, ray, hit, seed, (seed & 1u) == 0u));
}

#endif

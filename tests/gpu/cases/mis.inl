// Weights of multiple importance sampling.
#ifndef TWIN_CASES
#include "snell/kernel/mis.h"
SNELL_BEGIN
// A density, 0 and infinity included.
SNELL_FN_COLD float draw_pdf()
{
    float pdf = magnitude(1e-8f, 1e12f);
    uint special = index_below(16u);
    if (special == 0u) pdf = 0.0f;
    if (special == 1u) pdf = infinity();
    return pdf;
}
SNELL_END
#else

TWIN(heuristics, 1e-6f, 0.0f, 0.0f)
{
    float a = draw_pdf();
    float b = draw_pdf();
    if (!is_finite(a) && !is_finite(b)) b = 1.0f; // at most one of them
    give(balance_heuristic(a, b));
    give(power_heuristic(a, b));
}

#endif

// Multiple importance sampling (Veach 1997, chapter 9): the weight of a sample drawn with density pdf_a that another
// technique could have drawn with density pdf_b. At most one of them may be infinite; 0 if pdf_a is 0.
#ifndef SNELL_KERNEL_MIS_H
#define SNELL_KERNEL_MIS_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

SNELL_FN float balance_heuristic(float pdf_a, float pdf_b)
{
    return pdf_a > 0.0f ? pdf_a / (pdf_a + pdf_b) : 0.0f;
}

// Exponent 2. As a ratio, so that squares of large densities do not overflow.
SNELL_FN float power_heuristic(float pdf_a, float pdf_b)
{
    if (!(pdf_a > 0.0f)) return 0.0f;
    float r = pdf_b / pdf_a;
    return 1.0f / (1.0f + r * r);
}

SNELL_END
#endif

// Random boxes for cases, and their results given away.
#ifndef SNELL_TESTS_GPU_DRAW_BOXES_H
#define SNELL_TESTS_GPU_DRAW_BOXES_H
#include "snell/kernel/wide_boxes.h"
#include "tests/gpu/scene_sizes.h"
SNELL_BEGIN

SNELL_FN_COLD Aabb draw_aabb(float size)
{
    vec3 a = point(size);
    vec3 b = point(size);
    Aabb box = {min(a, b), max(a, b)};
    return box;
}

// `count` boxes in the first slots, some of them alike, none in the others.
SNELL_FN_COLD ChildBoxes draw_child_boxes(uint count)
{
    float size = magnitude(1e-3f, 1e3f);
    uint alike = index_below(8u);
    ChildBoxes boxes;
    for (uint i = 0u; i < 8u; ++i) {
        boxes.at[i] = empty_aabb();
        Aabb box = draw_aabb(size);
        if (i < count) boxes.at[i] = box;
    }
    if (alike > 0u && alike < count) boxes.at[alike] = boxes.at[alike - 1u];
    return boxes;
}

SNELL_FN void give_aabb(Aabb box)
{
    give(box.lower);
    give(box.upper);
}

SNELL_END
#endif

// What there is in a scene: all, where nobody has said otherwise.
#ifndef TWIN_CASES
#include "snell/kernel/features.h"
#include "snell/kernel/scene_view.h"
#include "tests/gpu/draw.h"
#else

TWIN(may_have, 0.0f, 0.0f, 0.0f)
{
    uint bit = index_below(32u);
    give(may_have(1u << bit));
    uint kind = index_below(material_kinds);
    uint which = index_below(material_kinds);
    give(is_material(kind, which));
}
#endif

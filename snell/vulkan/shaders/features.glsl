// What the scene has, as a constant of the pipeline: see snell/kernel/features.h. Comes first in an entry point.
#include "snell/kernel/lang.h"

layout(constant_id = 0) const uint scene_features = 0xffffffffu;
#define SNELL_FEATURES scene_features
#include "snell/kernel/features.h"

// From here on as expressions of constants: what falls away is then seen without looking into functions (spirv.h).
#define may_have(feature) ((SNELL_FEATURES & (feature)) != 0u)
#define is_material(kind, which) (may_have(1u << (which)) && (kind) == (which))

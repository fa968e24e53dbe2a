// What the scene has, as a constant of the pipeline: see snell/kernel/features.h. Comes first in an entry point.
#include "snell/kernel/lang.h"

layout(constant_id = 0) const uint scene_features = 0xffffffffu;
#define SNELL_FEATURES scene_features

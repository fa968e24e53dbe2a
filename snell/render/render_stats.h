// Sums and differences of what renders have counted.
#pragma once

#include "snell/render/render.h"

namespace snell {

// Rays, samples and stage times of both.
void add(RenderStats& sum, const RenderStats& more);
// Those of `later` that are not in `earlier`, of the same render.
RenderStats difference(const RenderStats& later, const RenderStats& earlier);

} // namespace snell

// The stages of the CPU backend: generate, extend, shade, connect; finalize is in tile.cpp.
#pragma once

#include "snell/cpu/batch.h"
#include "snell/render/integrator.h"

namespace snell {

// Fills batch.paths with the camera rays of `count` samples from `first_sample` for each pixel of the tile, and clears
// the slots: sample s of pixel p (counted in rows) has slot p * count + s.
void generate_stage(const StageContext& context, Batch& batch, const Region& tile, uint first_sample, uint count);

// Carry the paths of a generated batch to their ends. Contributions to a slot are added in an order that depends on
// that slot's own rays only: this is why a picture does not depend on the tile size.
void run_path(const StageContext& context, Batch& batch);
void run_whitted(const StageContext& context, Batch& batch);
void run_ambient_occlusion(const StageContext& context, Batch& batch);
void run_view(const StageContext& context, Batch& batch, uint view); // view_*
void run_custom(const StageContext& context, Batch& batch, const RadianceFunction& radiance);

// First-hit pictures of the samples [first_sample, first_sample + count) of a tile, added to the film's layers.
void record_first_hits(const StageContext& context, Batch& batch, const Region& tile, uint first_sample, uint count,
                       Film& film);

} // namespace snell

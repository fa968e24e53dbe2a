// The tables of snell/kernel/albedo.h: directional albedos by quadrature.
#pragma once

#include "snell/core/vec.h"

#include <span>
#include <vector>

namespace snell {

struct AlbedoTables
{
    std::vector<float> values;     // SceneView::albedo
    std::vector<uint> glass_table; // for each ior that was asked for: Principled::glass_table, or none
};

// The tables that every scene with principled materials needs, and those for rough solid glass of each of `iors`
// (indices inside over outside; repetitions cost nothing, and what is no index has no table). anisotropic: whether any
// material is. The same numbers in every run. What was computed is kept by the process: some 20 ms on one core the
// first time, 50 ms for each new index and 60 ms for anisotropy, shared among the threads. Beyond 16 different indices
// some share a neighbour's table, so that the cost is bounded.
AlbedoTables albedo_tables(std::span<const float> iors, bool anisotropic);

} // namespace snell

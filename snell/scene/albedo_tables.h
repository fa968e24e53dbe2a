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

// The tables that every scene needs, and those for rough solid glass of each of `iors` (indices inside over outside;
// repetitions cost nothing, what is no index below glass has no table). Always the same numbers for the same indices.
// What was computed is kept by the process: about 15 ms on one core the first time, and 25 ms for each new index, both
// shared among the threads. Beyond 16 different indices some share a neighbour's table, so the cost is bounded.
AlbedoTables albedo_tables(std::span<const float> iors);

} // namespace snell

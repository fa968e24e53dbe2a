// The accelerator over the 8-wide tree.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// Batches are traced with several rays in flight, or in packets of 16 if they are coherent; the answers are
// the same.
std::unique_ptr<Accel> make_bvh8(const PackedScene& scene, const AccelOptions& options);

// The same tree, one ray after the other.
std::unique_ptr<Accel> make_bvh8_single(const PackedScene& scene, const AccelOptions& options);

} // namespace snell

// The reference: every ray against every primitive.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// Loops the kernel functions over everything, in no clever way; what all other structures are compared with.
std::unique_ptr<Accel> make_brute(const PackedScene& scene, const AccelOptions& options);

} // namespace snell

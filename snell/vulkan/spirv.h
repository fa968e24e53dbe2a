// What happens to compiled shaders before drivers see them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace snell {

// The same SPIR-V module with NoContraction on every float operation: drivers may then neither fuse nor reorder them
// (without it, lavapipe turns (a + b) - a into b).
std::vector<std::uint32_t> with_no_contraction(const std::vector<std::uint32_t>& module);

// The same with every loop marked to be left as it is: unrolled texture filters double the time that lavapipe takes to
// compile a vertex.
std::vector<std::uint32_t> without_unrolling(const std::vector<std::uint32_t>& module);

// The same with values for its specialisation constants 0, 1, ..., and without what these leave no use for: Mesa takes a
// second to look through all that shading can be, and a third of that for what a scene has of it. Empty where that cannot
// be done: in a build without libSPIRV-Tools-opt.
std::vector<std::uint32_t> specialised(const std::vector<std::uint32_t>& module,
                                       std::span<const std::uint32_t> constants);

} // namespace snell

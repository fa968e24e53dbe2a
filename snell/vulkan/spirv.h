// Makes compiled shaders round as they are written.
#pragma once

#include <cstdint>
#include <vector>

namespace snell {

// The same SPIR-V module with NoContraction on every float operation: drivers may then neither fuse nor reorder them
// (without it, lavapipe turns (a + b) - a into b).
std::vector<std::uint32_t> with_no_contraction(const std::vector<std::uint32_t>& module);

// The same with every loop marked to be left as it is: unrolled texture filters double the time that lavapipe takes to
// compile a vertex.
std::vector<std::uint32_t> without_unrolling(const std::vector<std::uint32_t>& module);

} // namespace snell

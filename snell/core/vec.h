// Vectors and the functions on them that GLSL has too, brought from glm into namespace snell.
#pragma once

#define GLM_FORCE_XYZW_ONLY // one name a component, as in the kernel dialect; also easier on the optimiser
#define GLM_FORCE_INLINE
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/integer.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace snell {
using uint = std::uint32_t;

using glm::ivec2;
using glm::ivec3;
using glm::mat3;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

using glm::acos;
using glm::asin;
using glm::atan;
using glm::bitfieldReverse;
using glm::ceil;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::exp2;
using glm::floatBitsToInt;
using glm::floatBitsToUint;
using glm::floor;
using glm::fract;
using glm::intBitsToFloat;
using glm::length;
using glm::log;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::reflect;
using glm::sign;
using glm::sin;
using glm::sqrt;
using glm::tan;
using glm::transpose;
using glm::uintBitsToFloat;

// glm's compares with 0 and branches, which no processor can predict; these clear the sign bit.
inline float abs(float x)
{
    return __builtin_fabsf(x);
}
inline vec2 abs(vec2 v)
{
    return {abs(v.x), abs(v.y)};
}
inline vec3 abs(vec3 v)
{
    return {abs(v.x), abs(v.y), abs(v.z)};
}
} // namespace snell

// The kernel dialect: what both compilers, C++ and GLSL, read. This is the only file that knows which one it is.
//
// Everything in snell/kernel/ is written as free functions on plain structs in the language that both share. The rules
// (no templates, methods, pointers, swizzles, recursion; every float literal with an f; uint for flags) are listed in
// docs/kernel.md. Each header is compiled by both compilers on every test run and their results are compared.
#ifndef SNELL_KERNEL_LANG_H
#define SNELL_KERNEL_LANG_H

#ifdef __cplusplus

#include "snell/core/vec.h"

#define SNELL_BEGIN namespace snell {
#define SNELL_END }
// A kernel function; forced inline, because the stage loops are made of them. Not under sanitizers: with their checks
// inside, such loops take more than half a minute to compile.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SNELL_FN inline
#else
#define SNELL_FN [[gnu::always_inline]] inline
#endif
// For the few that are big and seldom called from the middle of a loop.
#define SNELL_FN_COLD inline
// A parameter that is read only; a reference where the language has them.
#define SNELL_IN(T) const T&
#define SNELL_INOUT(T) T&
#define SNELL_CONST inline constexpr
// A variable whose computation must be done to the letter: no fusing, no reordering.
#define SNELL_PRECISE
// An array in memory, read as `name.at[i]`; 8 bytes on both sides.
#define SNELL_ARRAY(Name, T)                                                                                           \
    struct Name                                                                                                        \
    {                                                                                                                  \
        const T* at;                                                                                                   \
    };
// One that is nowhere, and must not be read.
#define SNELL_NO_ARRAY(Name) (Name{nullptr})
// Size in bytes of a struct that crosses to the GPU.
#define SNELL_LAYOUT(T, bytes) static_assert(sizeof(T) == (bytes), "layout of " #T " differs from the GPU's");

#else // GLSL: the entry point names its #version and includes a kernel header before it declares anything

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#define SNELL_BEGIN
#define SNELL_END
#define SNELL_FN
#define SNELL_FN_COLD
#define SNELL_IN(T) in T
#define SNELL_INOUT(T) inout T
#define SNELL_CONST const
#define SNELL_PRECISE precise
#define SNELL_ARRAY(Name, T)                                                                                           \
    layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Name                                  \
    {                                                                                                                  \
        T at[];                                                                                                        \
    };
#define SNELL_NO_ARRAY(Name) Name(uvec2(0u, 0u))
#define SNELL_LAYOUT(T, bytes)

#endif

SNELL_BEGIN

SNELL_CONST float pi = 3.14159265358979323846f;
SNELL_CONST float inv_pi = 0.31830988618379067154f;
SNELL_CONST uint none = 0xffffffffu; // "no such index"

SNELL_FN float infinity()
{
    return uintBitsToFloat(0x7f800000u);
}
SNELL_FN bool is_finite(float x)
{
    return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u;
}
SNELL_FN bool is_finite3(vec3 v)
{
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}
SNELL_FN float sqr(float x)
{
    return x * x;
}
SNELL_FN float max3(vec3 v)
{
    return max(v.x, max(v.y, v.z));
}
SNELL_FN bool is_black(vec3 v)
{
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

// Luminance of linear Rec.709.
SNELL_FN float luminance(vec3 c)
{
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

// sqrt that takes the rounding error of an argument that should be >= 0.
SNELL_FN float safe_sqrt(float x)
{
    return sqrt(max(x, 0.0f));
}

SNELL_END
#endif

#version 460
// Fused multiply-adds, as many as there can be: what bench/gpu holds other kernels' arithmetic against. `rounds` times
// 128 of them an invocation.
#include "snell/vulkan/shaders/job.h"

layout(local_size_x = 64) in; // group_size
layout(push_constant, scalar) uniform Parameters
{
    WordBuffer result;
    uint rounds;
};

// Written out, for loops are left as they are.
#define SIXTEEN                                                                                                        \
    a = fma(a, scale, shift);                                                                                          \
    b = fma(b, scale, shift);                                                                                          \
    c = fma(c, scale, shift);                                                                                          \
    d = fma(d, scale, shift);

void main()
{
    float x = float(gl_LocalInvocationIndex) * 0.01f;
    vec4 a = vec4(x);
    vec4 b = vec4(x + 0.1f);
    vec4 c = vec4(x + 0.2f);
    vec4 d = vec4(x + 0.3f);
    vec4 scale = vec4(0.999f);
    vec4 shift = vec4(0.001f);
    for (uint i = 0u; i < rounds; ++i) {
        SIXTEEN SIXTEEN SIXTEEN SIXTEEN SIXTEEN SIXTEEN SIXTEEN SIXTEEN
    }
    vec4 sum = a + b + c + d;
    if (sum.x + sum.y + sum.z + sum.w == -1.0f) result.at[0] = 1u; // never, but no compiler knows
}

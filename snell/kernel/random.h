// Random numbers without state: each is a function of (pixel, sample index, dimension, seed), so a picture does not
// depend on threads, tiles or on where a render was interrupted.
#ifndef SNELL_KERNEL_RANDOM_H
#define SNELL_KERNEL_RANDOM_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Samplers by number.
SNELL_CONST uint sampler_independent = 0u; // PCG hashes
SNELL_CONST uint sampler_sobol = 1u;       // Owen-scrambled Sobol points, padded in pairs of dimensions

// Which random number of which sample: made once a sample by make_sample_key.
struct SampleKey
{
    uint kind;           // sampler_*
    uint pixel;          // hash of the pixel and the seed
    uint reversed_index; // number of the sample in its pixel, from 0, with its bits reversed
};
SNELL_LAYOUT(SampleKey, 12)

// A good 32-bit hash (the two-round xorshift-multiply family with low bias found by Wellons and Ettinger).
SNELL_FN uint hash_uint(uint x)
{
    uint h = x ^ (x >> 16);
    h *= 0x21f0aaadu;
    h ^= h >> 15;
    h *= 0xd35a2d97u;
    return h ^ (h >> 15);
}

// Jarzynski and Olano 2020, Hash Functions for GPU Rendering: three uints in, three well mixed ones out.
SNELL_FN uvec3 pcg3d(uvec3 v)
{
    uint x = v.x * 1664525u + 1013904223u;
    uint y = v.y * 1664525u + 1013904223u;
    uint z = v.z * 1664525u + 1013904223u;
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x += y * z;
    y += z * x;
    z += x * y;
    return uvec3(x, y, z);
}

// The 24 upper bits as a float in [0, 1).
SNELL_FN float unit_float(uint x)
{
    return float(x >> 8) * 5.9604644775390625e-8f;
}

SNELL_FN uint reverse_bits(uint x)
{
    uint r = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    r = ((r >> 2) & 0x33333333u) | ((r & 0x33333333u) << 2);
    r = ((r >> 4) & 0x0f0f0f0fu) | ((r & 0x0f0f0f0fu) << 4);
    r = ((r >> 8) & 0x00ff00ffu) | ((r & 0x00ff00ffu) << 8);
    return (r >> 16) | (r << 16);
}

// Owen scrambling of a number whose bits are reversed (most significant digit in bit 0): a hash in which each bit
// depends only on the lower ones. Laine and Karras 2011, with Vegdahl's 2021 constants.
SNELL_FN uint owen_scramble_reversed(uint x, uint seed)
{
    uint h = x ^ (x * 0x3d20adeau);
    h += seed;
    h *= (seed >> 16) | 1u;
    h ^= h * 0x05526c56u;
    return h ^ (h * 0x53a22864u);
}

// The second Sobol dimension with its bits reversed. Its generator is Pascal's triangle modulo 2, whose product with a
// bit vector is a sum over supersets of bit positions: five steps instead of 32.
SNELL_FN uint sobol_1_reversed(uint index)
{
    uint x = index;
    x ^= (x >> 1) & 0x55555555u;
    x ^= (x >> 2) & 0x33333333u;
    x ^= (x >> 4) & 0x0f0f0f0fu;
    x ^= (x >> 8) & 0x00ff00ffu;
    return x ^ ((x >> 16) & 0x0000ffffu);
}

// A point of the two-dimensional Sobol sequence, shuffled and Owen-scrambled by a hash (Burley 2020, Practical
// Hash-based Owen Scrambling), as 0.32 fixed point. The first dimension of Sobol is the reversed index.
// Takes the index with its bits reversed: that is done once a sample, not once a number.
SNELL_FN uvec2 scrambled_sobol(uint reversed_index, uint hash)
{
    uint shuffled = reverse_bits(owen_scramble_reversed(reversed_index, hash));
    uint x = owen_scramble_reversed(shuffled, hash_uint(hash ^ 0x9e3779b9u));
    uint y = owen_scramble_reversed(sobol_1_reversed(shuffled), hash_uint(hash ^ 0x7f4a7c15u));
    return uvec2(reverse_bits(x), reverse_bits(y));
}

SNELL_FN SampleKey make_sample_key(uint kind, uint pixel, uint index, uint seed)
{
    SampleKey key;
    key.kind = kind;
    key.pixel = hash_uint(pixel + hash_uint(seed));
    key.reversed_index = reverse_bits(index);
    return key;
}

// Two numbers in [0, 1) for the given pair of dimensions; different dimensions are independent of each other.
SNELL_FN vec2 random_2d(SampleKey key, uint dimension)
{
    if (key.kind == sampler_sobol) {
        uvec2 s = scrambled_sobol(key.reversed_index, hash_uint(key.pixel + dimension * 0x9e3779b9u));
        return vec2(unit_float(s.x), unit_float(s.y));
    }
    // the index itself: this hash mixes upwards, and would leave numbers that differ in their upper bits alike
    uvec3 r = pcg3d(uvec3(key.pixel, reverse_bits(key.reversed_index), dimension));
    return vec2(unit_float(r.x), unit_float(r.y));
}

// One number in [0, 1): the first of the pair.
SNELL_FN float random_1d(SampleKey key, uint dimension)
{
    return random_2d(key, dimension).x;
}

SNELL_END
#endif

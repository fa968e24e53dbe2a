// Random numbers: integers, so equal to the bit.
#ifndef TWIN_CASES
#include "snell/kernel/random.h"
#else

TWIN(hash_uint, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    give(hash_uint(x));
}
TWIN(pcg3d, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    uint y = word();
    uint z = word();
    give(pcg3d(uvec3(x, y, z)));
}
TWIN(unit_float, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    give(unit_float(x));
}
TWIN(reverse_bits, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    give(reverse_bits(x));
}
TWIN(owen_scramble_reversed, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    uint seed = word();
    give(owen_scramble_reversed(x, seed));
}
TWIN(sobol_1_reversed, 0.0f, 0.0f, 0.0f)
{
    uint index = word();
    give(sobol_1_reversed(index));
}
TWIN(scrambled_sobol, 0.0f, 0.0f, 0.0f)
{
    uint reversed_index = word();
    uint hash = word();
    give(scrambled_sobol(reversed_index, hash));
}
TWIN(random_2d, 0.0f, 0.0f, 0.0f)
{
    uint kind = index_below(2u);
    uint pixel = word();
    uint index = word();
    uint seed = word();
    uint dimension = index_below(100u);
    SampleKey key = make_sample_key(kind, pixel, index, seed);
    give(key.kind);
    give(key.pixel);
    give(key.reversed_index);
    give(random_2d(key, dimension));
    give(random_1d(key, dimension));
}

#endif

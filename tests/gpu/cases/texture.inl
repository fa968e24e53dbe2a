// Texture lookup.
#ifndef TWIN_CASES
#include "snell/kernel/texture.h"
#include "tests/gpu/scene_sizes.h"
#else

TWIN(wrap_texel, 0.0f, 0.0f, 0.0f)
{
    int i = int(index_below(2001u)) - 1000;
    int size = 1 + int(index_below(64u));
    uint mode = index_below(3u);
    give(wrap_texel(i, size, mode));
}
TWIN(fetch_texel, 1e-7f, 0.0f, 0.0f)
{
    uint index = index_below(scene_textures);
    int x = int(index_below(201u)) - 100;
    int y = int(index_below(201u)) - 100;
    give(fetch_texel(scene, scene.textures.at[index], x, y));
}
TWIN(sample_texture, 1e-5f, 1e-4f, 0.0f) // the fraction between texels of a coordinate around 4
{
    uint index = index_below(scene_textures);
    vec2 uv = point2(4.0f);
    give(sample_texture(scene, index, uv));
}
TWIN(sample_texture_far, 1e-5f, 1e-4f, 0.0f) // coordinates that are huge, infinite or NaN
{
    uint index = index_below(scene_textures);
    uint x = word();
    uint y = word();
    float fx = uintBitsToFloat(x);
    float fy = uintBitsToFloat(y);
    // floor() of what is next to an integer may land on either side of it if it is not exact
    give(sample_texture(scene, index, vec2(abs(fx) < 1e-3f ? 0.25f : fx, abs(fy) < 1e-3f ? 0.25f : fy)));
}

#endif

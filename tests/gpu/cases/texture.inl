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
    uint slot = index_below(scene_slots);
    int x = int(index_below(201u)) - 100;
    int y = int(index_below(201u)) - 100;
    give(fetch_texel(scene, scene.textures.at[index], scene.slots.at[slot], x, y));
}
TWIN(near_coordinate, 0.0f, 0.0f, 0.0f)
{
    uint x = word();
    uint mode = index_below(3u);
    float coordinate = uintBitsToFloat(x);
    if (is_finite(coordinate)) give(near_coordinate(coordinate, mode));
    if (!is_finite(coordinate)) give(mode);
}
TWIN(filter_texture, 1e-5f, 1e-4f, 0.001f) // where the nearest texel changes
{
    TextureSlot slot = scene.slots.at[index_below(scene_slots)];
    slot.filter_mode = index_below(2u);
    vec2 uv = point2(4.0f);
    give(filter_texture(scene, slot, uv));
}
TWIN(sample_texture, 1e-5f, 1e-4f, 0.002f) // the same
{
    uint slot = index_below(scene_slots);
    vec2 uv_0 = point2(4.0f);
    vec2 uv_1 = point2(4.0f);
    give(sample_texture(scene, slot, uv_0, uv_1));
}
TWIN(sample_texture_far, 1e-5f, 1e-4f, 0.002f) // coordinates that are huge, infinite or NaN
{
    TextureSlot slot = scene.slots.at[index_below(scene_slots)];
    slot.filter_mode = filter_bilinear;
    uint x = word();
    uint y = word();
    float fx = uintBitsToFloat(x);
    float fy = uintBitsToFloat(y);
    // floor() of what is next to an integer may land on either side of it if it is not exact
    give(filter_texture(scene, slot, vec2(abs(fx) < 1e-3f ? 0.25f : fx, abs(fy) < 1e-3f ? 0.25f : fy)));
}

#endif

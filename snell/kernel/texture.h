// Texture lookup: bilinear, from flat buffers, so that CPU and GPU see the same texels.
#ifndef SNELL_KERNEL_TEXTURE_H
#define SNELL_KERNEL_TEXTURE_H
#include "snell/kernel/scene_view.h"
SNELL_BEGIN

// The texel index in [0, size) that an index outside falls on.
SNELL_FN int wrap_texel(int i, int size, uint mode)
{
    if (mode == wrap_clamp) return clamp(i, 0, size - 1);
    int period = mode == wrap_mirror ? 2 * size : size;
    int r = i % period;
    if (r < 0) r += period;
    return r < size ? r : period - 1 - r;
}

// Linear RGBA of one texel; x and y count from the upper left.
SNELL_FN vec4 fetch_texel(SNELL_IN(SceneView) scene, Texture texture, int x, int y)
{
    uint i = uint(wrap_texel(y, int(texture.height), texture.wrap)) * texture.width +
             uint(wrap_texel(x, int(texture.width), texture.wrap));
    if (texture.format == texels_rgba32f) {
        uint o = texture.offset + 4u * i;
        return vec4(uintBitsToFloat(scene.texels.at[o]), uintBitsToFloat(scene.texels.at[o + 1u]),
                    uintBitsToFloat(scene.texels.at[o + 2u]), uintBitsToFloat(scene.texels.at[o + 3u]));
    }
    uint word = scene.texels.at[texture.offset + i];
    uint r = word & 0xffu;
    uint g = (word >> 8) & 0xffu;
    uint b = (word >> 16) & 0xffu;
    float a = float(word >> 24) * (1.0f / 255.0f);
    if (texture.format == texels_rgba8_srgb) return vec4(scene.srgb.at[r], scene.srgb.at[g], scene.srgb.at[b], a);
    return vec4(float(r) * (1.0f / 255.0f), float(g) * (1.0f / 255.0f), float(b) * (1.0f / 255.0f), a);
}

// Linear RGBA at texture coordinates uv; v = 1 is the upper edge. Texel centres lie at half-integers.
SNELL_FN_COLD vec4 sample_texture(SNELL_IN(SceneView) scene, uint index, vec2 uv)
{
    Texture texture = scene.textures.at[index];
    if (!is_finite(uv.x) || !is_finite(uv.y))
        return fetch_texel(scene, texture, 0, 0); // before GLSL's clamp sees a NaN
    // bring far coordinates near first: beyond 2^24 the integer part would swallow the fraction
    float u = texture.wrap == wrap_clamp ? clamp(uv.x, 0.0f, 1.0f) : uv.x - 2.0f * floor(0.5f * uv.x);
    float v = texture.wrap == wrap_clamp ? clamp(uv.y, 0.0f, 1.0f) : uv.y - 2.0f * floor(0.5f * uv.y);
    float x = u * float(texture.width) - 0.5f;
    float y = (1.0f - v) * float(texture.height) - 0.5f;
    float x0 = floor(x);
    float y0 = floor(y);
    int ix = int(x0);
    int iy = int(y0);
    vec4 top = mix(fetch_texel(scene, texture, ix, iy), fetch_texel(scene, texture, ix + 1, iy), x - x0);
    vec4 bottom = mix(fetch_texel(scene, texture, ix, iy + 1), fetch_texel(scene, texture, ix + 1, iy + 1), x - x0);
    return mix(top, bottom, y - y0);
}

SNELL_END
#endif

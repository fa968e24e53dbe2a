// Texture lookup from flat buffers, so that CPU and GPU see the same texels.
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
SNELL_FN vec4 fetch_texel(SNELL_IN(SceneView) scene, Texture texture, TextureSlot slot, int x, int y)
{
    uint i = uint(wrap_texel(y, int(texture.height), slot.wrap_v)) * texture.width +
             uint(wrap_texel(x, int(texture.width), slot.wrap_u));
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
    float scale = 1.0f / 255.0f;
    return vec4(float(r) * scale, float(g) * scale, float(b) * scale, a);
}

// Brings a far coordinate near, where wrapping sees no difference: beyond 2^24 the integer part would swallow the
// fraction.
SNELL_FN float near_coordinate(float x, uint mode)
{
    return mode == wrap_clamp ? clamp(x, 0.0f, 1.0f) : x - 2.0f * floor(0.5f * x);
}

// Linear RGBA at a coordinate of the slot's texture; u = 0 is the left edge, v = 0 the lower one. As a loop: drivers
// expand every call of it in place.
SNELL_FN_COLD vec4 filter_texture(SNELL_IN(SceneView) scene, TextureSlot slot, vec2 uv)
{
    Texture texture = scene.textures.at[slot.texture];
    float x = 0.0f;
    float y = 0.0f;
    if (is_finite(uv.x) && is_finite(uv.y)) { // before GLSL's clamp sees a NaN
        float centers = slot.filter_mode == filter_nearest ? 0.0f : 0.5f;
        x = near_coordinate(uv.x, slot.wrap_u) * float(texture.width) - centers;
        y = (1.0f - near_coordinate(uv.y, slot.wrap_v)) * float(texture.height) - centers;
    }
    float x0 = floor(x);
    float y0 = floor(y);
    float fx = slot.filter_mode == filter_nearest ? 0.0f : x - x0;
    float fy = slot.filter_mode == filter_nearest ? 0.0f : y - y0;
    vec4 sum = vec4(0.0f);
    for (int i = 0; i < 4; ++i) {
        int right = i & 1;
        int lower = i / 2;
        float weight = (right == 1 ? fx : 1.0f - fx) * (lower == 1 ? fy : 1.0f - fy);
        if (weight > 0.0f) sum += weight * fetch_texel(scene, texture, slot, int(x0) + right, int(y0) + lower);
    }
    return sum;
}

// Linear RGBA that a slot (not none) gives a point with these texture coordinates.
SNELL_FN_COLD vec4 sample_texture(SNELL_IN(SceneView) scene, uint slot_index, vec2 uv_0, vec2 uv_1)
{
    TextureSlot slot = scene.slots.at[slot_index];
    vec2 uv = slot.uv_set == 0u ? uv_0 : uv_1;
    vec2 at = vec2(slot.row_u.x * uv.x + slot.row_u.y * uv.y + slot.row_u.z,
                   slot.row_v.x * uv.x + slot.row_v.y * uv.y + slot.row_v.z);
    return filter_texture(scene, slot, at);
}

SNELL_END
#endif

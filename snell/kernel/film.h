// What a film keeps of a pixel, and how samples are added to it: the finalize stage.
#ifndef SNELL_KERNEL_FILM_H
#define SNELL_KERNEL_FILM_H
#include "snell/kernel/views.h"
SNELL_BEGIN

// The radiance of one sample, split by layer.
struct SampleSlot
{
    vec3 layers[layer_count];
    uint sees_through; // 1: the camera ray met nothing, and no environment to be seen
};
SNELL_LAYOUT(SampleSlot, 40)

struct PixelSums
{
    vec3 sum;         // of radiance
    float square_sum; // of squared luminance
    vec4 excess;      // what rounding has added to sum (xyz) and square_sum (w) beyond their due
    uint sample_count;
    uint seen_through; // samples that see through the picture
};
SNELL_LAYOUT(PixelSums, 40)

// Sums of the radiance by layer.
struct PixelLight
{
    vec3 emission, direct, indirect;
};
SNELL_LAYOUT(PixelLight, 36)

// Sums of what the first hits were; ids are those of the first one, and mean nothing before.
struct PixelHits
{
    vec3 albedo, normal, geometric_normal, position;
    vec2 uv;
    float depth, steps;
    uint object, material;
    uint hit_count, sample_count;
};
SNELL_LAYOUT(PixelHits, 80)

SNELL_FN vec3 sample_radiance(SNELL_IN(SampleSlot) slot)
{
    return slot.layers[layer_emission] + slot.layers[layer_direct] + slot.layers[layer_indirect];
}

// Adds one finite sample. Summed with Kahan's compensation (1965): a million samples are as exact as one, where plain
// floats would have stopped growing.
SNELL_FN void add_radiance(SNELL_INOUT(PixelSums) pixel, vec3 radiance)
{
    vec4 before = vec4(pixel.sum.x, pixel.sum.y, pixel.sum.z, pixel.square_sum);
    vec4 value = vec4(radiance.x, radiance.y, radiance.z, sqr(luminance(radiance)));
    SNELL_PRECISE vec4 term = value - pixel.excess;
    SNELL_PRECISE vec4 after = before + term;
    SNELL_PRECISE vec4 excess = (after - before) - term;
    pixel.sum = vec3(after.x, after.y, after.z);
    pixel.square_sum = after.w;
    pixel.excess = excess;
    pixel.sample_count += 1u;
}

SNELL_FN void add_light(SNELL_INOUT(PixelLight) pixel, SNELL_IN(SampleSlot) slot)
{
    pixel.emission += slot.layers[layer_emission];
    pixel.direct += slot.layers[layer_direct];
    pixel.indirect += slot.layers[layer_indirect];
}

// Adds what one sample has met first, but for albedo and normal. has_hit 0: nothing, and `hit` means nothing.
SNELL_FN void add_hit(SNELL_INOUT(PixelHits) pixel, uint has_hit, SNELL_IN(FirstHit) hit, uint steps)
{
    pixel.sample_count += 1u;
    pixel.steps += float(steps);
    if (has_hit == 0u) return;
    if (pixel.hit_count == 0u) {
        pixel.object = hit.object;
        pixel.material = hit.material;
    }
    pixel.hit_count += 1u;
    pixel.geometric_normal += hit.geometric_normal;
    pixel.position += hit.position;
    pixel.uv += hit.uv;
    pixel.depth += hit.depth;
}

// Adds albedo and normal of one sample, of what is seen in mirrors and through glass; 0 if nothing is.
SNELL_FN void add_seen(SNELL_INOUT(PixelHits) pixel, vec3 albedo, vec3 normal)
{
    pixel.albedo += albedo;
    pixel.normal += normal;
}

SNELL_END
#endif

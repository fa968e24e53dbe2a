// Samples are added to a pixel, to the bit the same on both sides: pictures do not tell where they were added up.
#ifndef TWIN_CASES
#include "snell/kernel/film.h"
#include "tests/gpu/draw.h"
SNELL_BEGIN
SNELL_FN_COLD SampleSlot draw_slot()
{
    SampleSlot slot;
    slot.layers[0] = color();
    slot.layers[1] = color();
    float size = magnitude(1e-6f, 1e6f);
    slot.layers[2] = size * color();
    slot.sees_through = index_below(2u);
    return slot;
}
SNELL_FN_COLD PixelSums draw_pixel_sums()
{
    PixelSums p;
    p.sum = color();
    p.square_sum = unit();
    float size = magnitude(1e-9f, 1e-7f);
    vec3 excess = size * direction();
    p.excess = vec4(excess.x, excess.y, excess.z, 0.0f);
    p.sample_count = index_below(1000u);
    p.seen_through = 7u;
    return p;
}
SNELL_FN_COLD PixelHits draw_pixel_hits()
{
    PixelHits p;
    p.albedo = color();
    p.normal = direction();
    p.geometric_normal = direction();
    p.position = point(4.0f);
    p.uv = point2(4.0f);
    p.depth = magnitude(1e-2f, 1e3f);
    p.steps = magnitude(1.0f, 1e4f);
    p.object = index_below(100u);
    p.material = index_below(100u);
    p.hit_count = index_below(2u);
    p.sample_count = index_below(100u);
    return p;
}
SNELL_END
#else

TWIN(sample_radiance, 0.0f, 0.0f, 0.0f)
{
    SampleSlot slot = draw_slot();
    give(sample_radiance(slot));
}
TWIN(add_radiance, 0.0f, 0.0f, 0.0f)
{
    PixelSums p = draw_pixel_sums();
    SampleSlot slot = draw_slot();
    add_radiance(p, slot.layers[0]);
    add_radiance(p, slot.layers[2]);
    give(p.sum);
    give(vec3(p.excess.x, p.excess.y, p.excess.z));
    give(p.sample_count);
    give(p.seen_through);
}
TWIN(add_radiance_squares, 1e-6f, 0.0f, 0.0f) // the luminance is computed with fused operations, or without
{
    PixelSums p = draw_pixel_sums();
    SampleSlot slot = draw_slot();
    add_radiance(p, slot.layers[0]);
    give(p.square_sum);
}
TWIN(add_light, 0.0f, 0.0f, 0.0f)
{
    PixelLight p;
    p.emission = color();
    p.direct = color();
    p.indirect = color();
    SampleSlot slot = draw_slot();
    add_light(p, slot);
    give(p.emission);
    give(p.direct);
    give(p.indirect);
}
TWIN(add_hit, 0.0f, 0.0f, 0.0f)
{
    PixelHits p = draw_pixel_hits();
    FirstHit hit;
    hit.albedo = color();
    hit.normal = direction();
    hit.geometric_normal = direction();
    hit.position = point(4.0f);
    hit.uv = point2(1.0f);
    hit.depth = magnitude(1e-2f, 1e3f);
    hit.object = index_below(100u);
    hit.material = index_below(100u);
    uint has_hit = index_below(2u);
    uint steps = index_below(1000u);
    add_hit(p, has_hit, hit, steps);
    add_seen(p, hit.albedo, hit.normal);
    give(p.albedo);
    give(p.normal);
    give(p.geometric_normal);
    give(p.position);
    give(p.uv);
    give(p.depth);
    give(p.steps);
    give(p.object);
    give(p.material);
    give(p.hit_count);
    give(p.sample_count);
}

#endif

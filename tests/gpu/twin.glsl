// The GLSL half of the twin test: see twin.h for what the functions mean. Inputs are read instead of drawn.
#include "snell/kernel/ray.h"
#include "snell/kernel/scene_view.h"

layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TwinWords
{
    uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TwinScene
{
    SceneView view;
};
layout(push_constant, scalar) uniform TwinPush
{
    TwinWords inputs;  // word w of item i is at [w * count + i]
    TwinWords outputs; // the same; words not written keep what they were
    TwinWords given;   // number of words that item i gave
    TwinWords raw;
    TwinScene scene;
    uint count;
    uint input_words;
    uint output_words;
}
twin;

// The case to run, from 1. A constant of the pipeline, so that drivers compile this case alone: the time they take grows
// faster than the length of what they are given.
layout(constant_id = 0) const uint twin_which = 0u;

uint twin_item, twin_read, twin_written;

uint word()
{
    uint w = twin_read++;
    return w < twin.input_words ? twin.inputs.at[w * twin.count + twin_item] : 0u;
}
uint index_below(uint n) { return word(); }
float unit() { return uintBitsToFloat(word()); }
float range(float low, float high) { return unit(); }
float magnitude(float low, float high) { return unit(); }
vec2 unit2()
{
    float x = unit();
    float y = unit();
    return vec2(x, y);
}
vec3 direction()
{
    float x = unit();
    float y = unit();
    float z = unit();
    return vec3(x, y, z);
}
vec3 point(float size) { return direction(); }
vec2 point2(float size) { return unit2(); }
vec3 color() { return direction(); }
vec3 upper_direction() { return direction(); }

void give(uint x)
{
    uint w = twin_written++;
    if (w < twin.output_words) twin.outputs.at[w * twin.count + twin_item] = x;
}
void give(int x) { give(uint(x)); }
void give(bool x) { give(x ? 1u : 0u); }
void give(float x) { give(floatBitsToUint(x)); }
void give(vec2 v)
{
    give(v.x);
    give(v.y);
}
void give(vec3 v)
{
    give(v.x);
    give(v.y);
    give(v.z);
}
void give(vec4 v)
{
    give(v.x);
    give(v.y);
    give(v.z);
    give(v.w);
}
void give(uvec2 v)
{
    give(v.x);
    give(v.y);
}
void give(uvec3 v)
{
    give(v.x);
    give(v.y);
    give(v.z);
}
void give(Hit h)
{
    give(h.t);
    give(h.u);
    give(h.v);
    give(h.primitive);
    give(h.instance);
}
void give(Ray r)
{
    give(r.origin);
    give(r.t_min);
    give(r.direction);
    give(r.t_max);
}

#define RAW(Array) Array(twin.raw)

#define TWIN(name, relative, absolute, outliers)                                                                       \
    twin_entered++;                                                                                                    \
    if (twin_which == twin_entered)
#define TWIN_BUILTIN(name, relative, absolute, outliers) TWIN(name, relative, absolute, outliers)

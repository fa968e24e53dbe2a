// Light from infinitely far away: constant or a picture, looked up by direction and drawn by importance.
//
// The picture is drawn in cells of equal size on it, at most as many as it has texels. environment_cdf holds the
// cumulative distribution of the rows (rows + 1 numbers from 0 to 1) and then, for each row, that of its columns
// (columns + 1 numbers). Inverting it keeps well spread random numbers well spread.
#ifndef SNELL_KERNEL_ENVIRONMENT_H
#define SNELL_KERNEL_ENVIRONMENT_H
#include "snell/kernel/light.h"
SNELL_BEGIN

// A direction of an octahedral map's point in [0, 1]^2 (Clarberg 2008, Fast Equal-Area Mapping of the (Hemi)Sphere
// using SIMD): equal areas of the square are equal solid angles. The middle is +Z, the corners are -Z.
SNELL_FN vec3 octahedral_direction(vec2 p)
{
    float u = 2.0f * p.x - 1.0f;
    float v = 2.0f * p.y - 1.0f;
    float d = 1.0f - (abs(u) + abs(v)); // signed distance from the diagonal, where z is 0
    float r = 1.0f - abs(d);
    float turn = 0.125f * (r == 0.0f ? 1.0f : (abs(v) - abs(u)) / r + 1.0f); // of the first quadrant, up to 1/4
    vec2 circle = unit_circle(turn);
    float z = 1.0f - r * r;
    float radius = r * safe_sqrt(2.0f - r * r);
    return vec3((u < 0.0f ? -radius : radius) * abs(circle.x), (v < 0.0f ? -radius : radius) * abs(circle.y),
                d < 0.0f ? -z : z);
}

// The inverse; w has unit length.
SNELL_FN vec2 octahedral_point(vec3 w)
{
    float r = sqrt((w.x * w.x + w.y * w.y) / (1.0f + abs(w.z))); // 1 - |z|, with all digits near the poles
    float turn = w.x == 0.0f && w.y == 0.0f ? 0.0f : atan(abs(w.y), abs(w.x)) * (2.0f * inv_pi); // of the quadrant
    float v = turn * r;
    float u = r - v;
    if (w.z < 0.0f) { // fold the lower half outwards
        float t = u;
        u = 1.0f - v;
        v = 1.0f - t;
    }
    return vec2(0.5f * (1.0f + (w.x < 0.0f ? -u : u)), 0.5f * (1.0f + (w.y < 0.0f ? -v : v)));
}

// A world direction as a point of the environment's picture: (0, 0) is the upper left corner, (1, 1) the lower right.
SNELL_FN vec2 environment_point(SNELL_IN(Environment) environment, vec3 direction)
{
    vec3 w =
        vec3(dot(environment.row_x, direction), dot(environment.row_y, direction), dot(environment.row_z, direction));
    if (environment.mapping == environment_octahedral) return octahedral_point(w);
    return vec2(0.5f + longitude(w.x, -w.z) * (0.5f * inv_pi), 0.5f - atan(w.y, sqrt(w.x * w.x + w.z * w.z)) * inv_pi);
}

// The inverse. The world-to-environment map is orthogonal: its transpose leads back.
SNELL_FN vec3 environment_direction(SNELL_IN(Environment) environment, vec2 p)
{
    vec3 w;
    if (environment.mapping == environment_octahedral) {
        w = octahedral_direction(p);
    } else {
        vec2 longitude = unit_circle(p.x); // its angle is counted from -1 in the middle of the picture
        vec2 colatitude = unit_circle(0.5f * p.y);
        w = vec3(-longitude.y * colatitude.y, colatitude.x, longitude.x * colatitude.y);
    }
    return w.x * environment.row_x + w.y * environment.row_y + w.z * environment.row_z;
}

// Steradians per unit of the picture's area there.
SNELL_FN float environment_solid_angle(SNELL_IN(Environment) environment, vec2 p)
{
    if (environment.mapping == environment_octahedral) return 4.0f * pi;
    return 19.7392088f * unit_circle(0.5f * p.y).y; // 2 pi^2
}

// Radiance that arrives from a direction of unit length.
SNELL_FN_COLD vec3 environment_radiance(SNELL_IN(SceneView) scene, vec3 direction)
{
    if (!may_have(feature_environment_texture) || scene.environment.texture == none) return scene.environment.radiance;
    vec2 p = environment_point(scene.environment, direction);
    TextureSlot slot;
    slot.texture = scene.environment.texture;
    slot.wrap_u = scene.environment.mapping == environment_octahedral ? wrap_clamp : wrap_repeat;
    slot.wrap_v = wrap_clamp;
    slot.filter_mode = filter_bilinear;
    vec4 texel = filter_texture(scene, slot, vec2(p.x, 1.0f - p.y));
    return scene.environment.radiance * vec3(texel.x, texel.y, texel.z);
}

// Density per steradian with which sample_environment draws a direction.
SNELL_FN_COLD float pdf_environment(SNELL_IN(SceneView) scene, vec3 direction)
{
    uint columns = scene.environment.columns;
    uint rows = scene.environment.rows;
    if (!may_have(feature_environment_cells) || columns == 0u) return pdf_uniform_sphere();
    vec2 p = environment_point(scene.environment, direction);
    float solid_angle = environment_solid_angle(scene.environment, p);
    if (!(solid_angle > 0.0f)) return 0.0f;
    uint x = min(uint(max(p.x, 0.0f) * float(columns)), columns - 1u);
    uint y = min(uint(max(p.y, 0.0f) * float(rows)), rows - 1u);
    uint row = rows + 1u + y * (columns + 1u);
    float probability = (scene.environment_cdf.at[y + 1u] - scene.environment_cdf.at[y]) *
                        (scene.environment_cdf.at[row + x + 1u] - scene.environment_cdf.at[row + x]);
    return probability * float(columns) * float(rows) / solid_angle;
}

// The last of `count` cells whose cumulative probability, from `first` on, is <= u: never one without probability.
SNELL_FN uint find_cell(SNELL_IN(SceneView) scene, uint first, uint count, float u)
{
    uint low = 0u;
    uint high = count;
    while (low + 1u < high) {
        uint middle = (low + high) / 2u;
        if (scene.environment_cdf.at[first + middle] <= u)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Where u falls in the cell, from 0 to 1.
SNELL_FN float place_in_cell(SNELL_IN(SceneView) scene, uint cell, float u)
{
    float lower = scene.environment_cdf.at[cell];
    float width = scene.environment_cdf.at[cell + 1u] - lower;
    return width > 0.0f ? clamp((u - lower) / width, 0.0f, 0.99999994f) : 0.5f;
}

// Draws a direction: by the picture's brightness, or uniformly if the environment is constant.
SNELL_FN_COLD LightSample sample_environment(SNELL_IN(SceneView) scene, vec2 u)
{
    LightSample s = no_light_sample();
    s.is_infinite = 1u;
    uint columns = scene.environment.columns;
    uint rows = scene.environment.rows;
    if (!may_have(feature_environment_cells) || columns == 0u) {
        s.direction = sample_uniform_sphere(u);
        s.pdf = pdf_uniform_sphere();
        s.radiance = environment_radiance(scene, s.direction);
        return s;
    }
    uint y = find_cell(scene, 0u, rows, u.y);
    uint row = rows + 1u + y * (columns + 1u);
    uint x = find_cell(scene, row, columns, u.x);
    vec2 p = vec2((float(x) + place_in_cell(scene, row + x, u.x)) / float(columns),
                  (float(y) + place_in_cell(scene, y, u.y)) / float(rows));
    s.direction = environment_direction(scene.environment, p);
    // of the direction as it is, so that looking it up finds the same cell and density
    s.pdf = pdf_environment(scene, s.direction);
    s.radiance = environment_radiance(scene, s.direction);
    return s;
}

SNELL_END
#endif

// Textures of textures, computed into one picture.
#pragma once

#include "snell/io/pbrt/loader.h"

namespace snell::pbrt {

// The texture over (u, v) in [0, 1], which repeats beyond. A checkerboard of constants is exact: 2 x 2 texels; others
// have as many texels as their finest picture, between 64 and 1024 a side. Where too much has been computed already:
// the mean, with a note.
TextureValue bake(Loader& loader, uint texture);

// The value at one point.
vec3 evaluate(Loader& loader, uint texture, vec2 uv);

// The texel at a point of an image (bilinear or nearest, as `ref` says), linear. The image is loaded.
vec4 look_up(const Image& image, const TextureRef& ref, vec2 uv);

} // namespace snell::pbrt

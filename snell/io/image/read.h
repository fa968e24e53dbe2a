// Reading pictures and textures.
#pragma once

#include "snell/io/image/image.h"
#include "snell/scene/scene.h"

namespace snell {

// .exr .hdr .pfm as they are (linear), .png .jpg .tga .bmp decoded from sRGB to linear. Throws Error.
Picture read_picture(const std::filesystem::path& file);

// For materials: 8-bit files stay bytes (texels_rgba8_srgb if is_color, else texels_rgba8_linear), 16-bit and float
// files become texels_rgba32f, linear. Grey, palette and missing alpha are expanded. Throws Error.
Image read_texture(const std::filesystem::path& file, bool is_color);

} // namespace snell

// Reading pictures and textures.
#pragma once

#include "snell/io/image/image.h"
#include "snell/scene/scene.h"

#include <string_view>

namespace snell {

// .exr .hdr .pfm as they are (linear), .png .jpg .webp .tga .bmp decoded from sRGB to linear (a PNG's gAMA chunk is
// ignored, as most programs do). The kind is known by content; only .tga by ending. NaN and infinity are kept, alpha is
// dropped. EXR: channels R G B, or Y with or without chroma, or the only layer of colour, of the first part that has
// any; the picture is the display window; other primaries are converted to Rec.709. HDR: divided by EXPOSURE. PFM:
// multiplied by the scale. Throws Error if the file is missing, cut off, not a picture, or larger than 65536 a side or
// 2^28 pixels. A damaged JPEG whose structure is whole cannot be told from a good one.
Picture read_picture(const std::filesystem::path& file);

// For materials: 8-bit files stay bytes (texels_rgba8_srgb if is_color, else texels_rgba8_linear), 16-bit and float
// files become texels_rgba32f, linear. Grey, palette and missing alpha are expanded. Non-finite values become 0. Values
// that are no colour (is_color false) are neither decoded from sRGB nor converted between primaries. Throws Error.
Image read_texture(const std::filesystem::path& file, bool is_color);

// The same for a file that is in memory already. `file` is its name: for messages, and its ending for .tga.
Image read_texture(std::string_view bytes, const std::filesystem::path& file, bool is_color);

} // namespace snell

// How much two pictures differ.
#pragma once

#include "snell/io/image/image.h"

#include <cstdint>

namespace snell {

// All on scene-linear values, over the pixels that are finite in both pictures.
struct PictureError
{
    double mse = 0;           // mean over pixels and channels of (x - r)^2
    double relmse = 0;        // mean over pixels of (x - r)^2 / (r^2 + 0.01) on luminance, as in Rousselle et al. 2011
    double psnr = 0;          // 10 log10(1 / mse) in dB, for a peak value of 1; infinite if mse is 0
    std::uint64_t pixels = 0; // compared
    std::uint64_t bad_pixels = 0, bad_reference_pixels = 0; // with a NaN or an infinity, left out
};

// Throws Error if the sizes differ or the pictures are empty. With no pixel to compare, mse and relmse are NaN.
PictureError compare_pictures(const Picture& picture, const Picture& reference);

// |x - r| a channel; not finite where one of them is not. Throws Error if the sizes differ.
Picture difference_picture(const Picture& picture, const Picture& reference);

} // namespace snell

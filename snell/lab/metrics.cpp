#include "snell/lab/metrics.h"

#include "snell/core/error.h"

#include <cmath>
#include <limits>

namespace snell {

static void check_sizes(const Picture& picture, const Picture& reference)
{
    if (picture.width != reference.width || picture.height != reference.height)
        throw Error(fmt::format("the pictures differ in size: {}x{} against {}x{}", picture.width, picture.height,
                                reference.width, reference.height),
                    "render both with the same --size");
    if (picture.pixels.empty()) throw Error("the pictures are empty");
}

static bool finite(const vec3& c)
{
    return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

static double luminance_of(const vec3& c)
{
    return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
}

PictureError compare_pictures(const Picture& picture, const Picture& reference)
{
    check_sizes(picture, reference);
    PictureError error;
    double square_sum = 0, relative_sum = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const vec3 x = picture.pixels[i], r = reference.pixels[i];
        const bool good = finite(x), good_reference = finite(r);
        error.bad_pixels += !good;
        error.bad_reference_pixels += !good_reference;
        if (!good || !good_reference) continue;
        ++error.pixels;
        for (int c = 0; c < 3; ++c) {
            const double d = static_cast<double>(x[c]) - static_cast<double>(r[c]);
            square_sum += d * d;
        }
        const double lr = luminance_of(r), d = luminance_of(x) - lr;
        relative_sum += d * d / (lr * lr + 0.01);
    }
    const auto count = static_cast<double>(error.pixels);
    error.mse = square_sum / (3.0 * count); // NaN if there was no pixel
    error.relmse = relative_sum / count;
    error.psnr = error.mse == 0.0 ? std::numeric_limits<double>::infinity() : -10.0 * std::log10(error.mse);
    return error;
}

Picture difference_picture(const Picture& picture, const Picture& reference)
{
    check_sizes(picture, reference);
    Picture difference = picture;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        difference.pixels[i] = abs(picture.pixels[i] - reference.pixels[i]);
    return difference;
}

} // namespace snell

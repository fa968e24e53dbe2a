#include "snell/lab/difference.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/views.h"

namespace snell {

static vec3 shown(vec3 x, vec3 r, Difference kind, float gain)
{
    if (!is_finite3(x) || !is_finite3(r)) return vec3(1.0f, 0.0f, 1.0f);
    const float d = luminance(x) - luminance(r);
    switch (kind) {
    case Difference::signed_difference:
        return vec3(0.5f) + 0.5f * gain * (x - r);
    case Difference::absolute:
        return gain * abs(x - r);
    case Difference::relative:
        return heat_color(gain * abs(d) / (abs(luminance(r)) + 0.01f));
    case Difference::squared:
        return heat_color(sqr(gain * d));
    }
    return vec3(0.0f);
}

Picture picture_of_difference(const Picture& picture, const Picture& reference, Difference kind, float gain)
{
    if (picture.width != reference.width || picture.height != reference.height)
        throw Error(fmt::format("the pictures differ in size: {}x{} against {}x{}", picture.width, picture.height,
                                reference.width, reference.height),
                    "only pictures of the same size can be compared pixel by pixel");
    Picture result{picture.width, picture.height, std::vector<vec3>(picture.pixels.size())};
    parallel_ranges(result.pixels.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            result.pixels[i] = shown(picture.pixels[i], reference.pixels[i], kind, gain);
    });
    return result;
}

} // namespace snell

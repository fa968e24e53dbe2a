// Where samples are summed up.
#pragma once

#include "snell/io/image/image.h"
#include "snell/render/settings.h"

#include <cstdint>
#include <vector>

namespace snell {

struct PixelSums; // snell/kernel/film.h
struct PixelLight;
struct PixelHits;

// What the first hit of the camera rays saw, averaged over the samples recorded; ids are of the first sample.
struct FilmLayers
{
    std::vector<vec3> albedo, normal, geometric_normal, position, direct, indirect, emission; // sums
    std::vector<vec2> uv;                                                                     // sums
    std::vector<float> depth, steps;                                                          // sums
    std::vector<uint> object, material;                                                       // none: nothing was hit
    std::vector<uint> hit_count;    // first-hit samples that hit something: divisor of the first-hit sums
    std::vector<uint> sample_count; // first-hit samples: divisor of `steps`

    // What one pixel has, as kernels know it.
    PixelLight light(std::size_t pixel) const;
    void set(std::size_t pixel, const PixelLight& light);
    PixelHits hits(std::size_t pixel) const;
    void set(std::size_t pixel, const PixelHits& hits);
};

struct Film
{
    int width = 0, height = 0;
    std::vector<vec3> sum;              // of radiance
    std::vector<float> square_sum;      // of squared luminance, for the variance
    std::vector<vec4> excess;           // what rounding has added to sum (xyz) and square_sum (w) beyond their due
    std::vector<uint> sample_count;     // of each pixel
    std::vector<uint> seen_through;     // samples of each pixel that met nothing, where a hidden environment lets one
                                        // see through the picture; empty: everything is opaque
    std::vector<float> seconds;         // of a thread's time, spent on each pixel: that of its tile, shared alike
    FilmLayers layers;                  // vectors are empty unless RenderSettings::layers
    std::vector<std::uint64_t> dropped; // (y * width + x) of the first 16 pixels with non-finite samples
    std::uint64_t dropped_samples = 0;

    Film() = default;
    Film(int width, int height, bool with_layers);

    // Adds one finite sample, as add_radiance() of snell/kernel/film.h does.
    void add_sample(std::size_t pixel, vec3 radiance);
    // What one pixel has, as kernels know it. Where everything is opaque, nothing is seen through.
    PixelSums sums(std::size_t pixel) const;
    void set(std::size_t pixel, const PixelSums& sums);

    // Variance of a pixel's mean, on luminance, estimated without bias; 0 with fewer than two samples.
    double mean_variance(std::size_t pixel) const;
    // Means; pixels without samples are black.
    Picture picture() const;
    // The part of each pixel that something covers: premultiplied into picture(). 0 without samples; empty if all
    // are 1.
    std::vector<float> alpha() const;
    // The relMSE (mean of variance / (mean^2 + 0.01), on luminance) that the spread of the samples lets expect. Too
    // high for the Sobol sampler, whose samples are better than independent ones. Infinite before the second sample.
    double estimated_relmse(const Region& region) const;
    // The layers as EXR channels: docs/exr.md.
    std::vector<Channel> channels() const;
};

} // namespace snell

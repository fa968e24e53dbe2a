#include "snell/render/film.h"

#include "snell/kernel/film.h"

#include <limits>

namespace snell {

Film::Film(int w, int h, bool with_layers) : width(w), height(h)
{
    const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    sum.assign(n, vec3(0.0f));
    square_sum.assign(n, 0.0f);
    excess.assign(n, vec4(0.0f));
    sample_count.assign(n, 0);
    seconds.assign(n, 0.0f);
    if (!with_layers) return;
    for (std::vector<vec3>* layer : {&layers.albedo, &layers.normal, &layers.geometric_normal, &layers.position,
                                     &layers.direct, &layers.indirect, &layers.emission})
        layer->assign(n, vec3(0.0f));
    layers.uv.assign(n, vec2(0.0f));
    layers.depth.assign(n, 0.0f);
    layers.steps.assign(n, 0.0f);
    layers.object.assign(n, none);
    layers.material.assign(n, none);
    layers.hit_count.assign(n, 0);
    layers.sample_count.assign(n, 0);
}

void Film::add_sample(std::size_t pixel, vec3 radiance)
{
    PixelSums p = sums(pixel);
    add_radiance(p, radiance);
    set(pixel, p);
}

PixelSums Film::sums(std::size_t pixel) const
{
    return {sum[pixel], square_sum[pixel], excess[pixel], sample_count[pixel],
            seen_through.empty() ? 0u : seen_through[pixel]};
}

void Film::set(std::size_t pixel, const PixelSums& sums)
{
    sum[pixel] = sums.sum;
    square_sum[pixel] = sums.square_sum;
    excess[pixel] = sums.excess;
    sample_count[pixel] = sums.sample_count;
    if (!seen_through.empty()) seen_through[pixel] = sums.seen_through;
}

PixelLight FilmLayers::light(std::size_t pixel) const
{
    return {emission[pixel], direct[pixel], indirect[pixel]};
}

void FilmLayers::set(std::size_t pixel, const PixelLight& light)
{
    emission[pixel] = light.emission;
    direct[pixel] = light.direct;
    indirect[pixel] = light.indirect;
}

// Ids that nothing has: `none` in the layers, and 0 in a pixel of zeros, which is what an empty one is for kernels.
PixelHits FilmLayers::hits(std::size_t pixel) const
{
    const bool any = hit_count[pixel] > 0;
    return {albedo[pixel],
            normal[pixel],
            geometric_normal[pixel],
            position[pixel],
            uv[pixel],
            depth[pixel],
            steps[pixel],
            any ? object[pixel] : 0u,
            any ? material[pixel] : 0u,
            hit_count[pixel],
            sample_count[pixel]};
}

void FilmLayers::set(std::size_t pixel, const PixelHits& hits)
{
    albedo[pixel] = hits.albedo;
    normal[pixel] = hits.normal;
    geometric_normal[pixel] = hits.geometric_normal;
    position[pixel] = hits.position;
    uv[pixel] = hits.uv;
    depth[pixel] = hits.depth;
    steps[pixel] = hits.steps;
    object[pixel] = hits.hit_count > 0 ? hits.object : none;
    material[pixel] = hits.hit_count > 0 ? hits.material : none;
    hit_count[pixel] = hits.hit_count;
    sample_count[pixel] = hits.sample_count;
}

// 1 / count; 0 where nothing was counted.
static float share(uint count)
{
    return count > 0 ? 1.0f / static_cast<float>(count) : 0.0f;
}

double Film::mean_variance(std::size_t pixel) const
{
    const double n = sample_count[pixel];
    if (n < 2) return 0;
    const double mean = static_cast<double>(luminance(sum[pixel])) / n;
    const double spread = static_cast<double>(square_sum[pixel]) / n - mean * mean;
    return spread > 0 ? spread / (n - 1) : 0;
}

double Film::estimated_relmse(const Region& region) const
{
    double total = 0;
    std::uint64_t pixels = 0;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x, ++pixels) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            if (sample_count[i] < 2) return std::numeric_limits<double>::infinity();
            const double mean = static_cast<double>(luminance(sum[i])) / sample_count[i];
            total += mean_variance(i) / (mean * mean + 0.01);
        }
    return total / static_cast<double>(pixels);
}

Picture Film::picture() const
{
    Picture picture{width, height, std::vector<vec3>(sum.size())};
    for (std::size_t i = 0; i < sum.size(); ++i) picture.pixels[i] = sum[i] * share(sample_count[i]);
    return picture;
}

std::vector<float> Film::alpha() const
{
    std::vector<float> alpha(sum.size(), 1.0f);
    bool opaque = true;
    for (std::size_t i = 0; i < alpha.size(); ++i) {
        const uint escaped = seen_through.empty() ? 0u : seen_through[i];
        if (sample_count[i] > 0 && escaped == 0) continue;
        alpha[i] = static_cast<float>(sample_count[i] - escaped) * share(sample_count[i]);
        opaque = false;
    }
    if (opaque) alpha.clear();
    return alpha;
}

template <class T>
static void add_channels(std::vector<Channel>& channels, const std::string& layer, const std::string& components,
                         const std::vector<T>& sums, const std::vector<uint>& counts)
{
    for (int c = 0; c < static_cast<int>(components.size()); ++c) {
        Channel channel{layer.empty() ? components.substr(static_cast<std::size_t>(c), 1)
                                      : layer + "." + components[static_cast<std::size_t>(c)],
                        std::vector<float>(sums.size()),
                        {}};
        for (std::size_t i = 0; i < sums.size(); ++i) {
            float value;
            if constexpr (std::is_same_v<T, float>)
                value = sums[i];
            else
                value = sums[i][c];
            channel.floats[i] = value * share(counts[i]);
        }
        channels.push_back(std::move(channel));
    }
}

std::vector<Channel> Film::channels() const
{
    std::vector<Channel> channels;
    Channel variance{"Variance.Y", std::vector<float>(sum.size()), {}};
    Channel count{"SampleCount.Y", std::vector<float>(sum.size()), {}};
    for (std::size_t i = 0; i < sum.size(); ++i) {
        count.floats[i] = static_cast<float>(sample_count[i]);
        variance.floats[i] = static_cast<float>(mean_variance(i));
    }
    channels.push_back(std::move(variance));
    channels.push_back(std::move(count));
    channels.push_back({"Time.Y", seconds, {}});
    if (layers.hit_count.empty()) return channels;

    add_channels(channels, "", "Z", layers.depth, layers.hit_count);
    // Sky has no albedo; an edge pixel has a part of it. So these two are means over all samples, as the colour is.
    add_channels(channels, "Albedo", "RGB", layers.albedo, layers.sample_count);
    add_channels(channels, "N", "XYZ", layers.normal, layers.sample_count);
    add_channels(channels, "Ng", "XYZ", layers.geometric_normal, layers.hit_count);
    add_channels(channels, "P", "XYZ", layers.position, layers.hit_count);
    add_channels(channels, "UV", "UV", layers.uv, layers.hit_count);
    add_channels(channels, "Steps", "Y", layers.steps, layers.sample_count);
    add_channels(channels, "Direct", "RGB", layers.direct, sample_count);
    add_channels(channels, "Indirect", "RGB", layers.indirect, sample_count);
    add_channels(channels, "Emission", "RGB", layers.emission, sample_count);
    channels.push_back({"ObjectID.I", {}, layers.object});
    channels.push_back({"MaterialID.I", {}, layers.material});
    return channels;
}

} // namespace snell

// Pictures that textures name: found when they are named, decoded when they are needed.
#include "snell/core/parallel.h"
#include "snell/io/image/read.h"
#include "snell/io/pbrt/bake.h"
#include "snell/io/pbrt/loader.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

// Stands in for a picture that is missing: loud as a colour, harmless as a number.
void stand_in(Image& image, bool is_number)
{
    image.width = image.height = is_number ? 1 : 2;
    image.format = texels_rgba8_srgb;
    image.bytes = {255, 0, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 0, 255, 255};
    if (is_number) image.bytes = {255, 255, 255, 255};
}

void decode_gamma(Image& image, float gamma)
{
    image.floats.resize(image.bytes.size());
    for (std::size_t i = 0; i < image.bytes.size(); ++i) {
        const float value = static_cast<float>(image.bytes[i]) / 255.0f;
        image.floats[i] = i % 4 == 3 ? value : std::pow(value, gamma);
    }
    image.bytes.clear();
    image.format = texels_rgba32f;
}

void invert(Image& image)
{
    for (std::size_t i = 0; i < image.bytes.size(); ++i)
        if (i % 4 != 3) image.bytes[i] = static_cast<std::uint8_t>(255 - image.bytes[i]);
    for (std::size_t i = 0; i < image.floats.size(); ++i)
        if (i % 4 != 3) image.floats[i] = 1.0f - image.floats[i];
}

// Three channels become their mean, as pbrt has it; grey pictures stay as they are.
void make_grey(Image& image)
{
    bool is_grey = true;
    for (std::size_t i = 0; i + 3 < image.bytes.size() && is_grey; i += 4)
        is_grey = image.bytes[i] == image.bytes[i + 1] && image.bytes[i] == image.bytes[i + 2];
    for (std::size_t i = 0; i + 3 < image.floats.size() && is_grey; i += 4)
        is_grey = image.floats[i] == image.floats[i + 1] && image.floats[i] == image.floats[i + 2];
    if (is_grey) return;
    if (!image.bytes.empty()) decode_gamma(image, image.format == texels_rgba8_srgb ? 2.2f : 1.0f);
    for (std::size_t i = 0; i + 3 < image.floats.size(); i += 4)
        image.floats[i] = image.floats[i + 1] = image.floats[i + 2] =
            (image.floats[i] + image.floats[i + 1] + image.floats[i + 2]) / 3.0f;
}

// From several threads at once, for different images.
void decode(Image& image, PendingImage& pending)
{
    if (pending.is_loaded) return;
    pending.is_loaded = true;
    const std::string name = image.name;
    try {
        image = read_texture(pending.path, pending.is_color);
        image.name = name;
        if (pending.is_inverted) invert(image);
        if (pending.gamma > 0.0f && !image.bytes.empty()) decode_gamma(image, pending.gamma);
        if (pending.is_number) make_grey(image);
    } catch (const Error& error) {
        pending.trouble = error.what();
        stand_in(image, pending.is_number);
    }
}

void report(Loader& loader, PendingImage& pending)
{
    if (pending.trouble.empty()) return;
    loader.warn(pending.spot, "picture " + pending.trouble,
                fmt::format("{}; {} stands in for it", pending.trouble,
                            pending.is_number ? "a constant 1" : "a magenta checkerboard"));
    pending.trouble.clear();
}

} // namespace

Index<Image> add_image(Loader& loader, PendingImage image, const std::string& name)
{
    const auto key = std::tuple(image.path.string(), image.is_color, image.is_number, image.is_inverted, image.gamma);
    Index<Image>& known = loader.known_images[key];
    if (known.valid()) return known;
    Image empty;
    empty.name = name;
    known = add(loader.scene, std::move(empty));
    image.is_loaded = false;
    loader.images.resize(loader.scene.images.size());
    loader.images.back() = std::move(image);
    return known;
}

void load_image(Loader& loader, Index<Image> image)
{
    decode(loader.scene.images[image.value], loader.images[image.value]);
    report(loader, loader.images[image.value]);
}

void load_all_images(Loader& loader)
{
    parallel_for(loader.images.size(), [&](std::size_t i) { decode(loader.scene.images[i], loader.images[i]); });
    for (PendingImage& image : loader.images) report(loader, image);
}

vec3 mean_of(Loader& loader, const TextureValue& value)
{
    if (value.is_constant()) return value.factor;
    load_image(loader, value.ref.image);
    const Image& image = loader.scene.images[value.ref.image.value];
    TextureRef plain;
    plain.filter = filter_nearest;
    // A grid of at most 64 x 64 texels is enough for a mean.
    const uint nx = std::min(image.width, 64u), ny = std::min(image.height, 64u);
    vec3 sum(0.0f);
    for (uint y = 0; y < ny; ++y)
        for (uint x = 0; x < nx; ++x) {
            const vec4 t = look_up(image, plain,
                                   {(static_cast<float>(x) + 0.5f) / static_cast<float>(nx),
                                    (static_cast<float>(y) + 0.5f) / static_cast<float>(ny)});
            sum += vec3(t.x, t.y, t.z);
        }
    return value.factor * sum / static_cast<float>(nx * ny);
}

} // namespace snell::pbrt

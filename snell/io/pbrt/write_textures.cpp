// Pictures into files, and textures that look them up.
#include "snell/io/file.h"
#include "snell/io/image/write.h"
#include "snell/io/pbrt/write_parts.h"

#include <png.h>

namespace snell::pbrt {
namespace {

void write_bytes(const std::filesystem::path& file, const Image& image)
{
    const std::size_t count = std::size_t{image.width} * image.height;
    bool is_opaque = true;
    for (std::size_t i = 0; i < count && is_opaque; ++i) is_opaque = image.bytes[4 * i + 3] == 255;
    std::vector<std::uint8_t> rgb;
    if (is_opaque) {
        rgb.reserve(3 * count);
        for (std::size_t i = 0; i < 4 * count; ++i)
            if (i % 4 != 3) rgb.push_back(image.bytes[i]);
    }
    write_atomically(file, [&](const std::filesystem::path& temporary) {
        png_image png = {};
        png.version = PNG_IMAGE_VERSION;
        png.width = image.width, png.height = image.height;
        png.flags = PNG_IMAGE_FLAG_FAST;
        png.format = is_opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
        const void* bytes = is_opaque ? rgb.data() : image.bytes.data();
        if (!png_image_write_to_file(&png, temporary.c_str(), 0, bytes, 0, nullptr))
            throw Error({file.string()}, fmt::format("writing the PNG file failed: {}", png.message),
                        "check the disk's free space");
    });
}

float texel_value(const Image& image, std::size_t i)
{
    return image.format == texels_rgba32f ? image.floats[i] : static_cast<float>(image.bytes[i]) / 255.0f;
}

void write_floats(const std::filesystem::path& file, const Image& image)
{
    Picture picture;
    picture.width = static_cast<int>(image.width), picture.height = static_cast<int>(image.height);
    const std::size_t count = std::size_t{image.width} * image.height;
    picture.pixels.reserve(count);
    Layers layers;
    layers.alpha.reserve(count);
    for (std::size_t i = 0; i < 4 * count; i += 4) {
        picture.pixels.emplace_back(texel_value(image, i), texel_value(image, i + 1), texel_value(image, i + 2));
        layers.alpha.push_back(texel_value(image, i + 3));
    }
    write_picture(file, picture, layers);
}

const char* wrap_name(uint wrap)
{
    return wrap == wrap_clamp ? "clamp" : wrap == wrap_mirror ? "mirror" : "repeat";
}

bool is_plus_zero(float x)
{
    return floatBitsToUint(x) == 0u;
}

std::string mapping_of(const TextureRef& ref)
{
    const vec3 u = ref.row_u, v = ref.row_v;
    if (!is_plus_zero(u.y) || !is_plus_zero(v.x)) // turned: ours
        return fmt::format(" \"float row_u\" [ {} ] \"float row_v\" [ {} ]", show(u), show(v));
    std::string text;
    if (u.x != 1.0f) text += fmt::format(" \"float uscale\" {}", u.x);
    if (v.y != 1.0f) text += fmt::format(" \"float vscale\" {}", v.y);
    if (!is_plus_zero(u.z)) text += fmt::format(" \"float udelta\" {}", u.z);
    if (!is_plus_zero(v.z)) text += fmt::format(" \"float vdelta\" {}", v.z);
    return text;
}

// Writes the directive unless there is such a texture already. what: all that is behind the name.
std::string name_texture(Writer& w, const std::string& what, const std::string& picture_name)
{
    const auto [known, is_new] = w.texture_names.emplace(what, fmt::format("texture {}", w.texture_names.size()));
    if (is_new) {
        if (!picture_name.empty())
            w.line("AttributeBegin\n  Attribute \"texture\" \"string name\" {}", in_quotes(picture_name));
        w.line("{}Texture \"{}\" {}", picture_name.empty() ? "" : "  ", known->second, what);
        if (!picture_name.empty()) w.line("AttributeEnd");
    }
    return known->second;
}

} // namespace

std::string write_picture_file(Writer& w, Index<Image> index, bool as_light)
{
    const Image& image = w.scene.images[index.value];
    std::string reference;
    std::string& known = as_light ? reference : w.pictures[index.value]; // an environment is written for itself
    if (!known.empty()) return known;
    // 8-bit pictures of light are decoded from sRGB whatever the file says.
    const bool is_bytes = image.format == texels_rgba8_srgb || (image.format == texels_rgba8_linear && !as_light);
    const SideFolder::Slot slot = w.textures.next(is_bytes ? ".png" : ".exr");
    w.files.emplace_back(
        [path = slot.path, &image, is_bytes] { is_bytes ? write_bytes(path, image) : write_floats(path, image); });
    return known = slot.reference;
}

std::string write_texture(Writer& w, const TextureRef& ref, bool is_number, vec3 factor)
{
    const Image& image = w.scene.images[ref.image.value];
    const std::string type = is_number ? "\"float\"" : "\"spectrum\"";
    const bool is_even = factor.x == factor.y && factor.y == factor.z;
    std::string what =
        fmt::format("{} \"imagemap\" \"string filename\" {}", type, in_quotes(write_picture_file(w, ref.image, false)));
    if (image.format != texels_rgba8_srgb) what += " \"string encoding\" \"linear\"";
    if (ref.wrap_u == ref.wrap_v && ref.wrap_u != wrap_repeat)
        what += fmt::format(" \"string wrap\" \"{}\"", wrap_name(ref.wrap_u));
    if (ref.wrap_u != ref.wrap_v)
        what += fmt::format(" \"string wrap_u\" \"{}\" \"string wrap_v\" \"{}\"", wrap_name(ref.wrap_u),
                            wrap_name(ref.wrap_v));
    if (ref.filter == filter_nearest) what += " \"string filter\" \"point\"";
    what += mapping_of(ref);
    if (ref.uv_set != 0) what += " \"integer uvset\" 1";
    // Without it, a number is the mean of three channels.
    if (is_number || ref.channel != 0) what += fmt::format(" \"string channel\" \"{}\"", "rgba"[ref.channel]);
    if (is_even && factor.x != 1.0f) what += fmt::format(" \"float scale\" {}", factor.x);
    const std::string name = name_texture(w, what, image.name);
    if (is_even) return name;
    return name_texture(
        w, fmt::format("{} \"scale\" \"texture tex1\" \"{}\" \"rgb tex2\" [ {} ]", type, name, show(factor)), "");
}

} // namespace snell::pbrt

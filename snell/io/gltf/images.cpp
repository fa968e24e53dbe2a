#include "snell/io/gltf/images.h"

#include "snell/core/parallel.h"
#include "snell/io/file.h"
#include "snell/io/gltf/uri.h"
#include "snell/io/image/read.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace fs = std::filesystem;

namespace snell::gltf {
namespace {

constexpr const char* is_ktx2 = "is KTX2 with Basis compression, which cannot be read; export it as PNG, JPEG or WebP";

bool is_color(Content content)
{
    return content == Content::color || content == Content::alpha;
}

Image stand_in(Content content, const std::string& name)
{
    Image image;
    image.name = name;
    image.format = is_color(content) ? texels_rgba8_srgb : texels_rgba8_linear;
    image.width = image.height = content == Content::color ? 8 : 1;
    switch (content) {
    case Content::color:
        for (uint y = 0; y < 8; ++y)
            for (uint x = 0; x < 8; ++x) {
                const std::uint8_t on = (x + y) % 2 == 0 ? 255 : 0;
                image.bytes.insert(image.bytes.end(), {on, 0, on, 255});
            }
        break;
    case Content::alpha:
    case Content::data:
        image.bytes = {255, 255, 255, 255};
        break;
    case Content::normal:
        image.bytes = {128, 128, 255, 255};
        break;
    case Content::anisotropy:
        image.bytes = {255, 128, 255, 255};
        break;
    }
    return image;
}

// Alpha, which no format encodes, becomes roughness.
void to_roughness(Image& image, float factor)
{
    const auto roughness = [&](float alpha) { return std::clamp(1.0f - factor * alpha, 0.0f, 1.0f); };
    for (std::size_t i = 3; i < image.bytes.size(); i += 4) {
        const float value = roughness(static_cast<float>(image.bytes[i]) / 255.0f);
        image.bytes[i - 2] = static_cast<std::uint8_t>(std::lround(value * 255.0f));
        image.bytes[i] = 255;
    }
    for (std::size_t i = 3; i < image.floats.size(); i += 4) {
        image.floats[i - 2] = roughness(image.floats[i]);
        image.floats[i] = 1.0f;
    }
}

bool has_full_alpha(const Image& image)
{
    for (std::size_t i = 3; i < image.bytes.size(); i += 4)
        if (image.bytes[i] != 255) return false;
    for (std::size_t i = 3; i < image.floats.size(); i += 4)
        if (!(image.floats[i] >= 1.0f)) return false;
    return true;
}

} // namespace

Images::Images(const Document& document, const Buffers& buffers, References& references, Budget& budget)
    : document_(document), buffers_(buffers), references_(references), budget_(budget)
{
}

Index<Image> Images::of_texture(int texture, Content content, const std::string& who)
{
    return want(texture, content, std::nullopt, who);
}

Index<Image> Images::roughness_of_texture(int texture, float factor, const std::string& who)
{
    return want(texture, Content::data, factor, who);
}

Index<Image> Images::want(int texture, Content content, std::optional<float> glossiness, const std::string& who)
{
    const tinygltf::Texture& description = checked(document_.model.textures, texture, "texture", who);
    int source = Fields(description.extensions, "EXT_texture_webp").integer("source", -1);
    if (source < 0) source = description.source;
    const int basis = Fields(description.extensions, "KHR_texture_basisu").integer("source", -1);
    const bool is_basis = source < 0 && basis >= 0;
    if (is_basis) source = basis;
    if (source >= 0)
        checked(document_.images, source, "image", label("texture", static_cast<std::size_t>(texture), ""));

    const std::tuple key(source >= 0 ? source : -2 - texture, is_color(content), glossiness.value_or(-1.0f));
    const auto [entry, is_new] = known_.try_emplace(key, Index<Image>{static_cast<uint>(wanted_.size())});
    if (!is_new) return entry->second;
    Wanted wanted{source, content, glossiness, {}, {}, {}};
    if (is_basis) wanted.missing = is_ktx2;
    if (source < 0) wanted.missing = "names no picture";
    locate(wanted, texture);
    wanted_.push_back(std::move(wanted));
    return entry->second;
}

// Gives the picture its name and its file.
void Images::locate(Wanted& wanted, int texture)
{
    if (wanted.source < 0) {
        const std::size_t number = static_cast<std::size_t>(texture);
        wanted.name = label("texture", number, document_.model.textures[number].name);
        return;
    }
    const ImageSource& source = document_.images[static_cast<std::size_t>(wanted.source)];
    const bool is_external = !source.uri.empty() && !is_data_uri(source.uri);
    wanted.name = source.name;
    if (is_external) wanted.name = fs::path(decode_percent(source.uri)).filename().string();
    if (wanted.name.empty()) wanted.name = fmt::format("image {}", wanted.source);
    if (!wanted.missing.empty() || !is_external) return;
    if (has_scheme(source.uri)) {
        wanted.missing = fmt::format("is at '{}', and nothing is fetched from a network; put the file beside the scene",
                                     source.uri.substr(0, 100));
        return;
    }
    fs::path& file = files_[wanted.source]; // found, and noted, once
    if (file.empty())
        file = find_file(source.uri, label("image", static_cast<std::size_t>(wanted.source), "") + ": ", references_);
    wanted.file = file;
}

// Throws Error with a clear message for what only few programs can read.
Image Images::decode_bytes(const Wanted& wanted, std::string_view bytes, const fs::path& name) const
{
    if (bytes.starts_with("\xabKTX 20\xbb")) throw Error(fmt::format("the texture '{}' {}", wanted.name, is_ktx2));
    return read_texture(bytes, name, is_color(wanted.content));
}

Image Images::load(const Wanted& wanted)
{
    const ImageSource& source = document_.images[static_cast<std::size_t>(wanted.source)];
    const std::string who = label("image", static_cast<std::size_t>(wanted.source), source.name);
    if (!wanted.file.empty()) {
        const std::string bytes = read_file(wanted.file);
        budget_.allow(bytes.size());
        return decode_bytes(wanted, bytes, wanted.file);
    }
    if (!source.uri.empty()) return decode_bytes(wanted, decode_data_uri(source.uri, ""), who);
    return decode_bytes(wanted, buffers_.view(source.view, who), who);
}

void Images::decode(Scene& scene, Remarks& remarks, const std::function<void(double)>& progress)
{
    scene.images.resize(wanted_.size());
    std::vector<std::string> failures(wanted_.size());
    std::mutex mutex;
    std::size_t done = 0;
    parallel_for(wanted_.size(), [&](std::size_t i) {
        Wanted& wanted = wanted_[i];
        Image& image = scene.images[i];
        try {
            if (!wanted.missing.empty()) throw Error(fmt::format("the texture '{}' {}", wanted.name, wanted.missing));
            image = load(wanted);
            budget_.charge(image.bytes.size() + 4 * image.floats.size(), 1, wanted.name + ": ");
            image.name = wanted.name;
            if (wanted.glossiness) to_roughness(image, *wanted.glossiness);
        } catch (const Error& error) {
            failures[i] = error.what();
            image = stand_in(wanted.content, wanted.name);
        }
        wanted.is_opaque = has_full_alpha(image);
        const std::lock_guard lock(mutex);
        progress(static_cast<double>(++done) / static_cast<double>(wanted_.size()));
    });
    for (std::size_t i = 0; i < failures.size(); ++i) {
        if (failures[i].empty()) continue;
        // Each missing picture is told, under its own name.
        const bool is_seen = wanted_[i].content == Content::color;
        remarks.warn(
            "image " + std::to_string(i),
            fmt::format("{}; {}", failures[i], is_seen ? "a magenta checkerboard stands in for it" : "it is left out"));
    }
}

} // namespace snell::gltf

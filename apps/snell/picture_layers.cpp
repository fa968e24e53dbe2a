#include "picture_layers.h"

#include "snell/core/error.h"
#include "snell/core/version.h"
#include "snell/render/params.h"

#include <fmt/format.h>

namespace snell::app {

// EXR's matrices are for row vectors, p' = p M, with the translation in the last row. Camera space is left-handed
// (RenderMan's): x right, y up, z along the view.
static void add_matrices(Layers& layers, const Camera& camera)
{
    const vec3 right = normalize(camera.right), up = normalize(camera.up), forward = camera.forward;
    const vec3 axes[3] = {right, up, forward};
    float to_camera[4][4] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}};
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) to_camera[row][column] = axes[column][row];
        to_camera[3][column] = -dot(axes[column], camera.origin);
    }

    // Normalised device coordinates: (0, 0) is the upper left corner of the picture and (1, 1) the lower right one,
    // after division by w, which is the depth. z is depth too, so that the matrix can be inverted.
    const float half_width = length(camera.right), half_height = length(camera.up);
    float to_ndc[4][4];
    for (int row = 0; row < 4; ++row) {
        const float x = to_camera[row][0], y = to_camera[row][1], z = to_camera[row][2];
        to_ndc[row][0] = 0.5f * (x / half_width + z);
        to_ndc[row][1] = 0.5f * (z - y / half_height);
        to_ndc[row][2] = z - to_camera[row][3];
        to_ndc[row][3] = z;
    }
    layers.world_to_camera.assign(&to_camera[0][0], &to_camera[0][0] + 16);
    layers.world_to_ndc.assign(&to_ndc[0][0], &to_ndc[0][0] + 16);
}

Layers picture_layers(const RenderReport& report, const CameraDesc& desc)
{
    const RenderSettings& settings = report.job.settings;
    const Film& film = report.result.film;
    Layers layers;
    if (settings.layers) layers.channels = film.channels();
    layers.attributes = {{"version", fmt::format("snell {} ({})", version(), commit())},
                         {"commandLine", report.job.command_line},
                         {"integrator", settings.integrator},
                         {"sampler", settings.sampler},
                         {"seed", std::to_string(settings.seed)}};
    layers.numbers = {{"spp", report.spp_done}, {"seconds", report.result.stats.render_seconds}};
    if (const auto& frame = report.job.frame) {
        layers.numbers["frame"] = static_cast<double>(*frame);
        layers.numbers["time"] = report.job.frames->seconds(*frame);
    } else if (report.job.scene.time) {
        layers.numbers["time"] = *report.job.scene.time;
    }
    layers.alpha = film.alpha(); // what was not rendered is transparent, not black
    add_matrices(layers, make_camera(desc, settings.width, settings.height));
    if (desc.model.kind != camera_pinhole) layers.world_to_ndc.clear(); // no matrix makes the pictures of the others
    return layers;
}

// "Albedo.R" becomes "Albedo.right.R", and "R" "right.R".
static std::string with_view(const std::string& channel, const std::string& view)
{
    const std::size_t dot = channel.rfind('.');
    return dot == std::string::npos ? fmt::format("{}.{}", view, channel)
                                    : fmt::format("{}.{}.{}", channel.substr(0, dot), view, channel.substr(dot + 1));
}

Layers stereo_layers(Layers left, const Picture& right_picture, Layers right)
{
    left.views = {"left", "right"};
    left.world_to_camera.clear(), left.world_to_ndc.clear(); // one eye's alone would be taken for both
    for (Channel& channel : left.channels)
        if (channel.name.find('.') != std::string::npos) channel.name = with_view(channel.name, "left");
    for (Channel& channel : right.channels) {
        channel.name = with_view(channel.name, "right");
        left.channels.push_back(std::move(channel));
    }
    const char* const names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        Channel& channel = left.channels.emplace_back(Channel{with_view(names[c], "right"), {}, {}});
        for (const vec3& pixel : right_picture.pixels) channel.floats.push_back(pixel[c]);
    }
    if (right.alpha.empty()) right.alpha.assign(right_picture.pixels.size(), 1.0f);
    left.channels.push_back({with_view("A", "right"), std::move(right.alpha), {}});
    return left;
}

template <class T>
static std::vector<T> joined(const std::vector<T>& left, const std::vector<T>& right, std::size_t width)
{
    std::vector<T> both;
    both.reserve(left.size() + right.size());
    for (std::size_t at = 0; at < left.size(); at += width)
        for (const std::vector<T>* half : {&left, &right})
            both.insert(both.end(), half->begin() + static_cast<std::ptrdiff_t>(at),
                        half->begin() + static_cast<std::ptrdiff_t>(at + width));
    return both;
}

Picture side_by_side(const Picture& left, const Picture& right)
{
    SNELL_CHECK_EQ(left.width, right.width);
    SNELL_CHECK_EQ(left.height, right.height);
    return {2 * left.width, left.height, joined(left.pixels, right.pixels, static_cast<std::size_t>(left.width))};
}

std::vector<float> side_by_side(const std::vector<float>& left, const std::vector<float>& right, int width)
{
    if (left.empty() && right.empty()) return {};
    SNELL_CHECK_EQ(left.size(), right.size());
    return joined(left, right, static_cast<std::size_t>(width));
}

} // namespace snell::app

#include "snell/render/params.h"

#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/core/text.h"
#include "snell/render/gpu_options.h"

#include <charconv>
#include <cmath>
#include <numbers>

namespace snell {

// Bounces after which even an "unlimited" path ends: a mirror box without roulette has no other end.
constexpr uint unlimited_depth = 1000;

static double parse_number(const std::string& key, const std::string& text)
{
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || value < 0)
        throw Error(fmt::format("-D {}={} is not a number >= 0", key, text));
    return value;
}

static double parse_whole_number(const std::string& key, const std::string& text)
{
    const double value = parse_number(key, text);
    if (value != std::floor(value))
        throw Error(fmt::format("-D {}={} is not a whole number", key, text),
                    fmt::format("give one, such as {}=5", key));
    return value;
}

static bool parse_switch(const std::string& key, const std::string& text)
{
    if (text != "0" && text != "1")
        throw Error(fmt::format("-D {}={} is neither 0 nor 1", key, text),
                    fmt::format("{0}=1 switches it on, {0}=0 off", key));
    return text == "1";
}

static void check_keys(const RenderSettings& settings, const IntegratorInfo& integrator)
{
    std::vector<std::string> known;
    for (const std::string& line : integrator.parameters) known.push_back(line.substr(0, line.find('=')));
    for (const auto& [key, value] : settings.parameters) {
        if (is_accel_parameter(key) || is_gpu_parameter(key) || std::find(known.begin(), known.end(), key) != known.end()) continue;
        const std::string near = nearest(key, known);
        throw Error(fmt::format("integrator '{}' has no parameter '{}'", integrator.name, key),
                    !near.empty()   ? fmt::format("did you mean '{}'?", near)
                    : known.empty() ? "it has none"
                                    : fmt::format("it has {}", fmt::join(known, ", ")));
    }
}

ReadyParams make_render_params(const RenderSettings& settings, const IntegratorInfo& integrator,
                               const CameraDesc& camera, float scene_radius)
{
    check_keys(settings, integrator);
    read_gpu_options(settings.parameters); // on every device: what is wrong is wrong anywhere
    const auto value = [&](const std::string& key, auto otherwise, auto parse) {
        const auto found = settings.parameters.find(key);
        return found == settings.parameters.end() ? otherwise : parse(key, found->second);
    };

    ReadyParams params{};
    params.width = static_cast<uint>(settings.width);
    params.height = static_cast<uint>(settings.height);
    params.seed = settings.seed;
    if (settings.sampler == "sobol")
        params.sampler_kind = sampler_sobol;
    else if (settings.sampler == "independent")
        params.sampler_kind = sampler_independent;
    else
        throw Error(fmt::format("there is no sampler '{}'", settings.sampler), "there are sobol, independent");

    const double depth = value("max_depth", integrator.name == "whitted" ? 12.0 : 0.0, parse_whole_number);
    params.max_depth =
        depth == 0 && integrator.name != "whitted" ? unlimited_depth : static_cast<uint>(std::min(depth, 1000.0));
    if (integrator.name == "direct") params.max_depth = 1;
    if (value("nee", true, parse_switch)) params.flags |= render_nee;
    if (value("mis", true, parse_switch)) params.flags |= render_mis;
    if (value("rr", true, parse_switch)) params.flags |= render_roulette;
    if (settings.pixel_jitter) params.flags |= render_jitter;
    if (integrator.name == "furnace") {
        // the environment is all there is; BSDF sampling finds it
        params.flags |= render_furnace;
        params.flags &= ~render_nee;
    }
    params.distance = static_cast<float>(value("distance", 0.25 * static_cast<double>(scene_radius), parse_number));
    params.max_steps = static_cast<float>(std::max(value("max_steps", 100.0, parse_number), 1.0));

    const vec3 view = camera.target - camera.eye;
    if (!(length(view) > 0) || !(length(cross(view, camera.up)) > 1e-6f * length(view) * length(camera.up)))
        throw Error("the camera has no direction: eye and target coincide, or up is parallel to the view",
                    "give other values with --eye, --target or --up");
    if (const std::string fault = camera_fault(camera); !fault.empty()) throw Error("the camera has " + fault);
    const ReadyCamera ready = make_camera(camera, settings.width, settings.height);
    params.camera = ready;
    params.glass = ready.glass;
    return params;
}

} // namespace snell

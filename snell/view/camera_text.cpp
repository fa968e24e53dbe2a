#include "snell/view/camera_text.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/lens_file.h"
#include "snell/io/pbrt/write.h"
#include "snell/scene/camera_models.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

namespace snell::view {

static std::string numbers(vec3 v, char separator)
{
    return fmt::format("{}{}{}{}{}", v.x, separator, v.y, separator, v.z); // the fewest digits that bring it back
}

namespace {

// Options of the model that are one number.
struct NumberOption
{
    std::string_view name;
    float CameraModel::*member;
};
constexpr std::array number_options = {
    NumberOption{"--lens-radius", &CameraModel::lens_radius},
    NumberOption{"--focus-distance", &CameraModel::focus_distance},
    NumberOption{"--blade-rotation", &CameraModel::blade_rotation_degrees},
    NumberOption{"--ipd", &CameraModel::eye_distance},
    NumberOption{"--film", &CameraModel::film_diagonal},
    NumberOption{"--stop", &CameraModel::stop_diameter},
    NumberOption{"--lens-unit", &CameraModel::millimetre},
};

// What differs from usual_model(), each after a blank.
std::string model_options(const CameraModel& m)
{
    const CameraModel usual = usual_model(m.kind);
    std::string text;
    if (m.kind == camera_lens)
        text += fmt::format(" --lens {}", m.lens.name);
    else if (m.kind != camera_pinhole)
        text += fmt::format(" --camera-model {}", camera_models()[m.kind].name);
    for (const auto& [name, member] : number_options)
        if (m.*member != usual.*member) text += fmt::format(" {} {}", name, m.*member);
    if (m.half_side != usual.half_side) text += fmt::format(" --view-size {}", 2.0f * m.half_side);
    if (m.blades != usual.blades) text += fmt::format(" --blades {}", m.blades);
    if (m.k != usual.k) text += fmt::format(" --distortion {}", fmt::join(distortion_of(m), ","));
    return text;
}

} // namespace

std::string camera_options(const CameraDesc& camera)
{
    std::string text = fmt::format("--eye {} --target {} --up {}", numbers(camera.eye, ','),
                                   numbers(camera.target, ','), numbers(camera.up, ','));
    if (camera.model.kind != camera_lens) text += fmt::format(" --fov {}", camera.fov_degrees);
    return text + model_options(camera.model);
}

std::string camera_pbrt(const CameraDesc& camera)
{
    if (camera.model != CameraModel{}) return pbrt_text(camera);
    return fmt::format("LookAt {}  {}  {}\nCamera \"perspective\" \"float fov\" [ {} ]", numbers(camera.eye, ' '),
                       numbers(camera.target, ' '), numbers(camera.up, ' '), camera.fov_degrees);
}

static float parse_float(std::string_view text, const Place& place, const std::string& option)
{
    float value = 0.0f;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        throw Error(place, fmt::format("{}: '{}' is not a number", option, text), "write it as in --fov 40");
    return value;
}

static vec3 parse_triple(const std::string& text, const Place& place, const std::string& option)
{
    vec3 v{0.0f};
    std::size_t begin = 0;
    for (int i = 0; i < 3; ++i) {
        const std::size_t end = i < 2 ? text.find(',', begin) : text.size();
        if (end == std::string::npos)
            throw Error(place, fmt::format("{}: '{}' is not three numbers with commas between them", option, text),
                        "write it as in --eye 0,1.5,-4");
        v[i] = parse_float(std::string_view(text).substr(begin, end - begin), place, option);
        begin = end + 1;
    }
    return v;
}

static std::vector<float> parse_list(const std::string& text, const Place& place, const std::string& option)
{
    std::vector<float> numbers;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        numbers.push_back(parse_float(std::string_view(text).substr(begin, end - begin), place, option));
        begin = end + 1;
    }
    return numbers;
}

// An option of the model. False: it is none.
static bool parse_model(CameraDesc& camera, const std::string& option, const std::string& value, const Place& place)
{
    CameraModel& m = camera.model;
    const auto become = [&](uint kind) {
        if (m.kind != kind) m = usual_model(kind);
    };
    if (option == "--camera-model") {
        const CameraModelInfo* info = find_camera_model(value);
        if (info == nullptr)
            throw Error(place, fmt::format("there is no camera model '{}'", value), "`snell list` names them");
        become(info->kind);
        return true;
    }
    if (option == "--lens") {
        const LensPrescription* known = find_lens(value);
        become(camera_lens);
        m.lens = known != nullptr ? *known : load_lens(value);
        return true;
    }
    if (option == "--distortion") {
        if (!set_distortion(m, parse_list(value, place, option)))
            throw Error(place, "--distortion: these are not the numbers that the camera model has");
        return true;
    }
    if (option == "--view-size") return m.half_side = 0.5f * parse_float(value, place, option), true;
    if (option == "--blades")
        return m.blades = static_cast<uint>(std::clamp(parse_float(value, place, option), 0.0f, 100.0f)), true;
    for (const auto& [name, member] : number_options)
        if (name == option) return m.*member = parse_float(value, place, option), true;
    return false;
}

CameraDesc parse_camera(const std::string& text, CameraDesc base, const std::string& file, int line)
{
    const Place place{file, line, 0};
    std::istringstream words(text);
    std::string option, value;
    while (words >> option) {
        if (!(words >> value)) throw Error(place, fmt::format("{} has no value", option), "write it as in --fov 40");
        if (option == "--eye")
            base.eye = parse_triple(value, place, option);
        else if (option == "--target")
            base.target = parse_triple(value, place, option);
        else if (option == "--up")
            base.up = parse_triple(value, place, option);
        else if (option == "--fov")
            base.fov_degrees = parse_float(value, place, option);
        else if (!parse_model(base, option, value, place))
            throw Error(place, fmt::format("there is no option '{}' of a view", option),
                        "there are: --eye, --target, --up, --fov, and those of camera models");
    }
    if (!(length(base.target - base.eye) > 0.0f)) throw Error(place, "eye and target are the same point", "move one");
    if (const std::string fault = camera_fault(base); !fault.empty()) throw Error(place, "the camera has " + fault);
    if (!(length(base.up) > 0.0f)) throw Error(place, "up is zero", "give a direction");
    base.node = {};
    return base;
}

std::vector<CameraDesc> read_views(const std::filesystem::path& file)
{
    std::istringstream lines(read_file(file));
    std::vector<CameraDesc> views;
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        views.push_back(parse_camera(line, views.empty() ? CameraDesc{} : views.back(), file.string(), number));
    }
    if (views.empty())
        throw Error({file.string(), 0, 0}, "there is no view in the file",
                    "one a line, as the viewer's key C copies it");
    return views;
}

void write_views(const std::filesystem::path& file, std::span<const CameraDesc> views)
{
    std::string text = "# views of snell: one a line\n";
    // A line keeps what the one before it said.
    const bool all_plain =
        std::all_of(views.begin(), views.end(), [](const CameraDesc& camera) { return camera.model == CameraModel{}; });
    for (const CameraDesc& camera : views) {
        text += camera_options(camera);
        if (!all_plain && camera.model.kind == camera_pinhole)
            text += " --camera-model pinhole --lens-radius " + fmt::format("{}", camera.model.lens_radius);
        text += "\n";
    }
    write_atomically(file, text);
}

} // namespace snell::view

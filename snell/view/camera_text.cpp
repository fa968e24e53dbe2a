#include "snell/view/camera_text.h"

#include "snell/core/error.h"
#include "snell/io/file.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace snell::view {

static std::string numbers(vec3 v, char separator)
{
    return fmt::format("{}{}{}{}{}", v.x, separator, v.y, separator, v.z); // the fewest digits that bring it back
}

std::string camera_options(const CameraDesc& camera)
{
    return fmt::format("--eye {} --target {} --up {} --fov {}", numbers(camera.eye, ','), numbers(camera.target, ','),
                       numbers(camera.up, ','), camera.fov_degrees);
}

std::string camera_pbrt(const CameraDesc& camera)
{
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
        else
            throw Error(place, fmt::format("there is no option '{}' of a view", option),
                        "there are: --eye, --target, --up, --fov");
    }
    if (!(length(base.target - base.eye) > 0.0f)) throw Error(place, "eye and target are the same point", "move one");
    if (!(base.fov_degrees > 0.0f && base.fov_degrees < 180.0f))
        throw Error(place, fmt::format("a field of view of {} degrees", base.fov_degrees), "take one from 0 to 180");
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
    for (const CameraDesc& camera : views) text += camera_options(camera) + "\n";
    write_atomically(file, text);
}

} // namespace snell::view

#include "snell/io/lens_file.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/read_number.h"

#include <array>
#include <cmath>
#include <string_view>

namespace snell {

static constexpr std::size_t most_surfaces = 200;

// The numbers of a line, without its comment. Throws Error for what is no number.
static std::vector<float> numbers_of(std::string_view line, const Place& place)
{
    line = line.substr(0, line.find('#'));
    std::vector<float> numbers;
    const char* p = line.data();
    const char* const end = p + line.size();
    const auto is_gap = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; };
    while (true) {
        while (p < end && is_gap(*p)) ++p;
        if (p == end) return numbers;
        float value = 0;
        const bool is_number = read_float(p, end, value) && (p == end || is_gap(*p));
        if (!is_number || !std::isfinite(value) || numbers.size() == 4)
            throw Error(place, "this is no surface of a lens",
                        "write four numbers: radius, thickness, index behind it and diameter");
        numbers.push_back(value);
    }
}

static LensSurface surface_of(const std::vector<float>& n, const Place& place)
{
    if (n.size() != 4)
        throw Error(place, fmt::format("a surface with {} number{}", n.size(), n.size() == 1 ? "" : "s"),
                    "write four: radius, thickness, index behind it and diameter");
    const LensSurface s{n[0], n[1], n[2] == 0.0f ? 1.0f : n[2], n[3]};
    if (!(s.eta >= 1.0f && s.eta <= 4.0f))
        throw Error(place, fmt::format("an index of refraction of {:g}", s.eta), "give one between 1 and 4");
    if (!(s.diameter > 0.0f && s.diameter < 1e4f))
        throw Error(place, fmt::format("a diameter of {:g}", s.diameter), "give millimetres above 0");
    if (!(std::abs(s.thickness) < 1e4f && std::abs(s.radius) < 1e6f))
        throw Error(place, "a radius or thickness beyond all lenses", "give millimetres");
    if (s.radius != 0.0f && s.diameter > 2.0f * std::abs(s.radius) * 1.0001f)
        throw Error(place, fmt::format("a diameter of {:g} on a sphere of radius {:g}", s.diameter, s.radius),
                    "give at most twice the radius");
    return s;
}

LensPrescription load_lens(const std::filesystem::path& file)
{
    LensPrescription lens;
    lens.name = file.stem().string();
    const std::string text = read_file(file);
    int line = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const Place place{file.string(), ++line, 0};
        const auto numbers = numbers_of(std::string_view(text).substr(begin, end - begin), place);
        begin = end + 1;
        if (numbers.empty()) continue;
        if (lens.surfaces.size() == most_surfaces)
            throw Error(place, fmt::format("more than {} surfaces", most_surfaces), "give a lens");
        lens.surfaces.push_back(surface_of(numbers, place));
    }
    if (lens.surfaces.empty())
        throw Error({file.string(), 0, 0}, "there is no surface in this file",
                    "write radius, thickness, index and diameter of one a line");
    const Cardinal c = cardinal(lens);
    if (!(c.focal_length > 0.0) || !std::isfinite(c.focal_length))
        throw Error({file.string(), 0, 0}, "this lens does not gather light",
                    "check the signs of the radii: convex towards the scene is positive");
    return lens;
}

void write_lens(const LensPrescription& lens, const std::filesystem::path& file)
{
    std::string text = "# ";
    for (const char c : lens.name) text += c == '\n' || c == '\r' ? ' ' : c;
    text += "\n# radius [mm]  thickness [mm]  index behind  diameter [mm]\n";
    for (const LensSurface& s : lens.surfaces)
        text += fmt::format("{}  {}  {}  {}\n", s.radius, s.thickness, s.eta, s.diameter);
    write_atomically(file, text);
}

} // namespace snell

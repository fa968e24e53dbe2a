#include "snell/io/obj/mtl.h"

#include "snell/io/text_cursor.h"

#include <algorithm>

namespace snell::obj {
namespace {

std::string_view take_word(std::string_view& text)
{
    text = trim(text);
    std::size_t length = 0;
    while (length < text.size() && !is_space(text[length])) ++length;
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length);
    return word;
}

// Takes finite numbers off the text, at most as many as there is room for; returns how many.
std::size_t take_numbers(std::string_view& text, float* numbers, std::size_t most)
{
    std::size_t count = 0;
    for (; count < most; ++count) {
        std::string_view rest = text;
        const std::string_view word = take_word(rest);
        const char* p = word.data();
        float value = 0;
        if (!read_float(p, word.data() + word.size(), value) || p != word.data() + word.size() || !std::isfinite(value))
            break;
        numbers[count] = value;
        text = rest;
    }
    return count;
}

// The options may stand before the name, which may have spaces; some writers put them behind it, which is forgiven only
// if the name is in quotes.
std::string read_map(std::string_view rest, MtlMap& map)
{
    for (;;) {
        rest = trim(rest);
        if (!rest.starts_with('-') || rest.size() < 2) break;
        std::string_view behind = rest;
        const std::string_view option = take_word(behind);
        float n[3] = {};
        if (option == "-s" || option == "-o" || option == "-t") {
            const std::size_t count = take_numbers(behind, n, 3);
            if (count == 0) return fmt::format("{} wants numbers", option);
            vec3& to = option == "-s" ? map.scale : map.offset;
            for (std::size_t i = 0; i < count && option != "-t"; ++i) to[static_cast<int>(i)] = n[i];
            if (option == "-t") map.ignored = "-t";
        } else if (option == "-mm") {
            if (take_numbers(behind, n, 2) != 2) return "-mm wants two numbers";
            if (n[0] != 0 || n[1] != 1) map.ignored = "-mm";
        } else if (option == "-bm" || option == "-boost" || option == "-texres") {
            if (take_numbers(behind, n, 1) != 1) return fmt::format("{} wants a number", option);
            if (option == "-bm") map.strength = n[0];
            if (option == "-boost") map.ignored = "-boost";
        } else if (option == "-clamp" || option == "-blendu" || option == "-blendv" || option == "-cc") {
            const std::string_view value = take_word(behind);
            if (value != "on" && value != "off") return fmt::format("{} wants on or off", option);
            if (option == "-clamp") map.clamps = value == "on";
            if (option == "-cc" && value == "on") map.ignored = "-cc";
        } else if (option == "-imfchan") {
            const std::string_view channel = take_word(behind);
            if (channel.size() == 1) map.channel = channel[0];
        } else if (option == "-type") {
            map.ignored = fmt::format("-type {}", show_word(take_word(behind)));
        } else {
            break; // a name that begins so
        }
        rest = behind;
    }
    if (rest.size() >= 2 && rest.front() == '"' && rest.find('"', 1) != std::string_view::npos)
        rest = rest.substr(1, rest.find('"', 1) - 1);
    if (rest.empty()) return "no file is named";
    map.file = rest;
    return {};
}

bool is_map(std::string_view keyword)
{
    return keyword.starts_with("map_") || keyword == "bump" || keyword == "norm" || keyword == "disp" ||
           keyword == "refl" || keyword == "decal";
}

} // namespace

vec3 MtlMaterial::color(std::string_view keyword) const
{
    const auto found = numbers.find(keyword);
    return found == numbers.end() ? vec3(0.0f) : found->second;
}

float MtlMaterial::number(std::string_view keyword, float otherwise) const
{
    const auto found = numbers.find(keyword);
    return found == numbers.end() ? otherwise : found->second.x;
}

const MtlMap* MtlMaterial::map(std::string_view keyword) const
{
    const auto found = maps.find(keyword);
    return found == maps.end() ? nullptr : &found->second;
}

std::string read_statement(std::string_view statement, int line, MtlMaterial& to)
{
    std::string_view rest = statement;
    const std::string_view keyword = take_word(rest);
    rest = trim(rest);
    if (keyword.empty() || keyword.front() == '#') return {};
    if (is_map(keyword)) {
        std::string name(keyword);
        if (name == "bump" || name == "map_Bump") name = "map_bump";
        if (name == "map_Norm" || name == "map_norm" || name == "map_Kn") name = "norm";
        MtlMap map;
        map.line = line;
        std::string wrong = read_map(rest, map);
        if (!wrong.empty()) return fmt::format("'{}': {}; the line is ignored", keyword, wrong);
        if (map.file != ".") to.maps[name] = std::move(map);
        return {};
    }
    std::size_t wanted = 0;
    for (const std::string_view color : {"Ka", "Kd", "Ks", "Ke", "Kt", "Tf"})
        if (keyword == color) wanted = 3;
    for (const std::string_view scalar :
         {"Ns", "Ni", "d", "Tr", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor", "illum"})
        if (keyword == scalar) wanted = 1;
    if (wanted == 0) {
        to.others.emplace(keyword.substr(0, 40));
        return {};
    }
    if (rest.starts_with("-halo")) rest.remove_prefix(5);
    float n[3] = {};
    std::string_view behind = rest;
    const std::size_t count = take_numbers(behind, n, wanted);
    const bool is_grey = wanted == 3 && count == 1 && trim(behind).empty();
    if (count < wanted && !is_grey)
        return fmt::format("'{}' wants {} number{}, but there is {}; the line is ignored", keyword, wanted,
                           wanted == 1 ? "" : "s", show_word(rest));
    to.numbers[std::string(keyword)] = count == 3 ? vec3(n[0], n[1], n[2]) : vec3(n[0]);
    return {};
}

} // namespace snell::obj

#include "usage.h"

#include "snell/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace snell::app {

// The whole text as a T; from_chars, because it knows nothing of locales.
template <class T>
static std::optional<T> whole(std::string_view text)
{
    if (text.starts_with('+')) text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

static std::vector<std::string_view> split(std::string_view text, char separator)
{
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end - begin));
        if (end == std::string_view::npos) return parts;
        begin = end + 1;
    }
}

std::int64_t parse_integer(std::string_view option, std::string_view text, std::int64_t least, std::int64_t most)
{
    const auto value = whole<std::int64_t>(text);
    if (!value) throw UsageError(fmt::format("{}: '{}' is not a whole number", option, text));
    if (*value < least || *value > most)
        throw UsageError(fmt::format("{}: {} is out of range; it must be from {} to {}", option, text, least, most));
    return *value;
}

double parse_number(std::string_view option, std::string_view text, double least, double most)
{
    const auto value = whole<double>(text);
    if (!value || !std::isfinite(*value)) throw UsageError(fmt::format("{}: '{}' is not a number", option, text));
    if (*value < least || *value > most) {
        const std::string range = most < std::numeric_limits<double>::max() ? fmt::format("from {} to {}", least, most)
                                                                            : fmt::format("{} or more", least);
        throw UsageError(fmt::format("{}: {} is out of range; it must be {}", option, text, range));
    }
    return *value;
}

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count,
                                  std::string_view example)
{
    std::vector<double> values;
    for (std::string_view part : split(text, ','))
        if (const auto value = whole<double>(part); value && std::isfinite(*value)) values.push_back(*value);
    if (values.size() != count || split(text, ',').size() != count)
        throw UsageError(fmt::format("{}: '{}' is not {} numbers with commas between them, such as {}", option, text,
                                     count, example));
    return values;
}

vec3 parse_vec3(std::string_view option, std::string_view text)
{
    constexpr double most = 1e18; // squares of what is beyond leave the range of a float
    const std::vector<double> v = parse_numbers(option, text, 3, "0,1.5,-4");
    for (const double number : v)
        if (std::abs(number) > most)
            throw UsageError(
                fmt::format("{}: {:g} is out of range; it must be from {:g} to {:g}", option, number, -most, most));
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::pair<int, int> parse_size(std::string_view option, std::string_view text)
{
    const std::vector<std::string_view> parts = split(text, 'x');
    if (parts.size() != 2 || !whole<std::int64_t>(parts[0]) || !whole<std::int64_t>(parts[1]))
        throw UsageError(fmt::format("{}: '{}' is not WIDTHxHEIGHT, such as 1280x720", option, text));
    return {static_cast<int>(parse_integer(option, parts[0], 1, 65536)),
            static_cast<int>(parse_integer(option, parts[1], 1, 65536))};
}

std::pair<std::uint32_t, std::uint32_t> parse_range(std::string_view option, std::string_view text,
                                                    std::string_view example)
{
    const std::vector<std::string_view> parts = split(text, ':');
    const auto begin = whole<std::uint32_t>(parts[0]);
    const auto end = whole<std::uint32_t>(parts.back());
    if (parts.size() != 2 || !begin || !end || *begin >= *end)
        throw UsageError(fmt::format("{}: '{}' is not FIRST:END, such as {}", option, text, example));
    return {*begin, *end};
}

std::pair<std::string, std::string> parse_key_value(std::string_view option, std::string_view text)
{
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || equals == 0)
        throw UsageError(fmt::format("{}: '{}' is not KEY=VALUE, such as max_depth=5", option, text));
    return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known)
{
    const std::string guess = nearest(word, known);
    return guess.empty() ? "" : fmt::format(" (did you mean '{}'?)", guess);
}

void check_name(std::string_view what, std::string_view name, std::span<const std::string> known)
{
    for (const std::string& candidate : known)
        if (candidate == name) return;
    if (known.empty()) throw UsageError(fmt::format("there is no {} '{}', nor any other", what, name));
    throw UsageError(fmt::format("there is no {} '{}'{}; there are: {}", what, name, did_you_mean(name, known),
                                 fmt::join(known, ", ")));
}

std::size_t find_name_or_index(std::string_view option, std::string_view what, std::span<const std::string> names,
                               std::string_view text)
{
    if (const auto found = std::find(names.begin(), names.end(), text); found != names.end())
        return static_cast<std::size_t>(found - names.begin());
    if (!names.empty() && whole<std::int64_t>(text))
        return static_cast<std::size_t>(parse_integer(option, text, 0, static_cast<std::int64_t>(names.size()) - 1));
    check_name(what, text, names);
    return 0;
}

} // namespace snell::app

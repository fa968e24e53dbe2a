// Values as people type them.
#pragma once

#include "snell/core/vec.h"

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace snell::app {

// The command line makes no sense: one line that says why and what to type instead. Exit code 2.
class UsageError : public std::runtime_error
{
  public:
    using std::runtime_error::runtime_error;
};

// Each throws UsageError, naming the option and giving an example, unless the whole text is such a value.
std::int64_t parse_integer(std::string_view option, std::string_view text, std::int64_t least, std::int64_t most);
double parse_number(std::string_view option, std::string_view text, double least, double most);
// Coordinates from -1e18 to 1e18.
vec3 parse_vec3(std::string_view option, std::string_view text);
std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count,
                                  std::string_view example);
std::pair<int, int> parse_size(std::string_view option, std::string_view text); // 1920x1080
// a:b with a < b, as in [a, b).
std::pair<std::uint32_t, std::uint32_t> parse_range(std::string_view option, std::string_view text,
                                                    std::string_view example);
std::pair<std::string, std::string> parse_key_value(std::string_view option, std::string_view text);

// Throws UsageError, naming the nearest one and all there are, unless name is among them.
void check_name(std::string_view what, std::string_view name, std::span<const std::string> known);

// Which of the names `text` is; or, if none, the index that it is. Throws UsageError.
std::size_t find_name_or_index(std::string_view option, std::string_view what, std::span<const std::string> names,
                               std::string_view text);

// " (did you mean 'b'?)", or "" if nothing is near.
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

} // namespace snell::app

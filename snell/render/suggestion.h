// The remedy for a name that does not exist.
#pragma once

#include "snell/core/text.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace snell {

// The nearest name, or all of them. infos: a range of structs with a `name`.
template <class Infos>
std::string suggestion(const std::string& name, const Infos& infos)
{
    std::vector<std::string> names;
    for (const auto& info : infos) names.emplace_back(info.name);
    const std::string near = nearest(name, names);
    return near.empty() ? fmt::format("there are {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near);
}

} // namespace snell

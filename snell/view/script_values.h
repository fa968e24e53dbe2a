// What scripts can set and ask for, by name.
#pragma once

#include <optional>
#include <string>

namespace snell::view {

class App;

// The whole text as a finite number.
std::optional<double> read_value(const std::string& text);

// Throws Error if there is no such name, or the value makes no sense for it.
void set_value(App& app, const std::string& name, const std::string& value);
std::string get_value(App& app, const std::string& name);

} // namespace snell::view

// What scripts can set and ask for, by name.
#pragma once

#include <optional>
#include <string>

namespace snell::view {

class App;
struct ViewState;

// The whole text as a finite number.
std::optional<double> read_value(const std::string& text);
// Takes a pane's number, counted from 1, and the colon behind it off a text such as "2:path"; returns the pane's index.
// Throws Error if there is no such pane.
std::size_t take_pane(const ViewState& state, std::string& value);

// Throws Error if there is no such name, or the value makes no sense for it.
void set_value(App& app, const std::string& name, const std::string& value);
std::string get_value(App& app, const std::string& name);

} // namespace snell::view

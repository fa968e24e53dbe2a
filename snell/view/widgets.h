// Controls as all panels have them: the label on the left, a tooltip, and a name by which scripts press them.
#pragma once

#include "snell/core/vec.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace snell::view {

// Shows text while the mouse rests on the control before it: what it does, and the term a textbook uses.
void tip(std::string_view text);

// Each draws "label  [control]" and returns whether the user has changed the value. Numbers can be typed: Ctrl+click,
// or Enter when the keyboard has the focus. Values that are typed are held to the range as well.
bool slider(const char* label, float& value, float least, float most, const char* help, const char* format = "%.2f",
            bool is_logarithmic = false);
bool slider(const char* label, int& value, int least, int most, const char* help, const char* format = "%d",
            bool is_logarithmic = false);
// Without ends to slide to, as coordinates are: it changes by `step` for each pixel that it is dragged.
bool number(const char* label, float& value, float step, float least, float most, const char* help,
            const char* format = "%.3g");
bool vector(const char* label, vec3& value, float step, const char* help);
bool color(const char* label, vec3& value, const char* help); // linear Rec.709; may be above 1
bool text(const char* label, std::string& value, const char* help, const char* hint = "");
bool checkbox(const char* label, bool& value, const char* help);
bool button(const char* label, const char* help);

// A choice of one from a list by name. summaries: of each, shown as tooltips in the list; may be empty.
bool choose(const char* label, std::string& value, std::span<const std::string> names, const char* help,
            std::span<const std::string> summaries = {});
bool choose(const char* label, uint& value, std::span<const char* const> names, const char* help);

// "name   value" in grey and white, in the columns of the controls.
void fact(const char* label, std::string_view value, const char* help = nullptr);
// A paragraph that wraps.
void paragraph(std::string_view text);
// The same, in the colour of what went wrong.
void warning(std::string_view text);

// For controls made with ImGui itself: call it behind one to make it known under that name.
void name_item(std::string_view name);

// Where the control of that label was drawn in the last frame, in ImGui's units (its middle); nothing if it was not.
std::optional<vec2> find_item(std::string_view label);
// Until another one is sought: a control of that label is scrolled to where it can be seen.
void seek_item(std::string_view label);
// Once before each frame.
void begin_items();

} // namespace snell::view

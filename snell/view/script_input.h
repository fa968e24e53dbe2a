// A script's input: events in SDL's queue, as if they came from hands. Each returns true.
#pragma once

#include "snell/view/keys.h"

#include <random>
#include <string>

namespace snell::view {

class App;

bool push_move(App& app, float x, float y);                                         // in ImGui's units
bool push_button(App& app, float x, float y, const std::string& how, bool is_down); // left, right, middle, alt, ctrl
bool push_key(App& app, const KeyName& key, bool is_down);
bool push_text(App& app, const std::string& text);
bool push_wheel(App& app, int notches);
bool push_drop(App& app, const std::string& file);
// One of all the others, anywhere.
bool push_random(App& app, std::mt19937& random);
bool release_all(App& app);

} // namespace snell::view

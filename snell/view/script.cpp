#include "snell/view/script.h"

#include "snell/view/app.h"

namespace snell::view {
Script::Script(std::filesystem::path file) : file_(std::move(file)) {}
void Script::step(App&) {}
} // namespace snell::view

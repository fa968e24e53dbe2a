// Pictures that are dropped onto the window: light from afar, and textures.
#include "snell/view/app.h"

namespace snell::view {

void App::drop_environment(const std::string& file)
{
    state_.document.load_environment(state_, file);
}

void App::drop_texture(const std::string& file, uint material)
{
    state_.document.load_texture(state_, file, true, {material});
}

} // namespace snell::view

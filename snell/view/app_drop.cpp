// Pictures that are dropped onto the window: light from afar, and textures.
#include "snell/view/app.h"

#include "snell/core/error.h"
#include "snell/io/environment.h"
#include "snell/io/image/read.h"
#include "snell/scene/outline.h"

namespace snell::view {

void App::drop_environment(const std::string& file)
{
    session_->edit([file](Scene& scene) -> uint {
        set_environment(scene, file);
        return change_environment | change_images;
    });
    state_.say("lit by " + std::filesystem::path(file).filename().string());
}

void App::drop_texture(const std::string& file, uint material)
{
    session_->edit([file, material](Scene& scene) -> uint {
        Image image = read_texture(file, true);
        if (material >= scene.materials.size()) return change_none;
        TextureRef& ref = scene.materials[material].base_texture;
        ref = TextureRef{};
        ref.image = add(scene, std::move(image));
        return change_materials | change_images;
    });
    state_.say(std::filesystem::path(file).filename().string() + " is the picked surface's colour");
}

} // namespace snell::view

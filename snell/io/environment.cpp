#include "snell/io/environment.h"

#include "snell/core/error.h"
#include "snell/io/image/read.h"
#include "snell/scene/validate_material.h"

#include <cmath>

namespace snell {

void set_environment(Scene& scene, const std::filesystem::path& file, float degrees, float scale)
{
    if (!std::isfinite(degrees))
        throw Error(fmt::format("an environment cannot be turned by {} degrees", degrees), "give a finite number");
    if (!(std::isfinite(scale) && scale >= 0.0f))
        throw Error(fmt::format("an environment cannot be scaled by {}", scale), "give a finite number of at least 0");
    Image image = read_texture(file, true);
    const bool is_square = image.width == image.height;
    if (!is_square && image.width != 2 * image.height)
        throw Error({file.string()},
                    fmt::format("an environment of {} x {} is neither a latitude-longitude map (twice as wide as high) "
                                "nor an octahedral one (square)",
                                image.width, image.height),
                    "crop or scale the picture, or convert it to one of these");

    EnvironmentDesc environment;
    environment.radiance = vec3(scale);
    environment.mapping = is_square ? environment_octahedral : environment_equirectangular;
    const Transform upright = is_square ? rotation(vec3(1, 0, 0), -90.0f) : identity_transform(); // +Z becomes +Y
    environment.to_world = compose(rotation(vec3(0, 1, 0), -degrees), upright);
    environment.visible = scene.environment.visible;
    note(scene, Note::Kind::info,
         fmt::format("environment {}: {} x {}, taken for {}", file.filename().string(), image.width, image.height,
                     is_square ? "an equal-area octahedral map" : "a latitude-longitude map"));
    environment.image = add(scene, std::move(image));
    scene.environment = environment;
    validate_environment(scene);
}

} // namespace snell

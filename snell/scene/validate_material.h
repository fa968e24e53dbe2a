// The parts of validate() that look at images, materials and the environment.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// Mends one material that refers to the scene's images; number: its own, for messages. Returns what was mended, in
// words. Throws Error as validate() does.
std::string mend_material(const Scene& scene, MaterialDesc& material, std::size_t number);

// The same for an environment, but for the picture's texels.
std::string mend_environment(const Scene& scene, EnvironmentDesc& environment);

// Throws Error if the image has not the texels that it says.
void check_image(const Image& image, std::size_t number);

// Moves the numbers of a float picture into [0, 1e9], as radiances must be; returns how many.
std::size_t mend_radiances(Image& image);

// Images, then materials and their references to images.
void validate_materials(Scene& scene);

// The environment and its image.
void validate_environment(Scene& scene);

} // namespace snell

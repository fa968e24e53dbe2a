// The light of a photographer's studio, for models that come without any.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// A latitude-longitude map of a grey room with three softboxes, all neutral white, for a camera that looks along -Z: a
// big key light behind its left shoulder, a weaker fill from the right, a strip from above and behind the subject. A
// diffuse grey of 0.5 comes out between 0.09 on the shadow side and 0.45 towards the key light.
Image make_studio_image();

// Lights the scene with that picture, turned so that the key light is over the left shoulder of its first camera. Says
// nothing; the scene must have a camera.
void add_studio(Scene& scene);

} // namespace snell

// The parts of validate() that look at one thing, for those who change one thing.
#pragma once

#include "snell/scene/scene.h"

#include <string>

namespace snell {

// number: which of the scene's lights, ... it is, for messages. What returns words says what was mended; all throw
// Error on what has no meaning, as validate() does.
std::string mend_light(LightDesc& light, std::size_t number);
std::string mend_camera(CameraDesc& camera, std::size_t number);
void check_plane(const PlaneDesc& plane, std::size_t number);          // but for its material
void check_instance(const InstanceDesc& instance, std::size_t number); // its transform

// Whether a sphere has a positive radius and a place.
bool is_sphere(const SphereDesc& sphere);

} // namespace snell

// Infinite lights.
#pragma once

#include "snell/io/pbrt/loader.h"

namespace snell::pbrt {

// LightSource "infinite": constant or a picture; several add up where they can.
void add_environment(Loader& loader, const ParameterList& parameters);
void finish_environment(Loader& loader); // when all has been read

} // namespace snell::pbrt

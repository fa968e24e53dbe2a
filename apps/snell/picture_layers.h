// What goes into an EXR beside the colours.
#pragma once

#include "report.h"

#include "snell/scene/scene.h"

namespace snell::app {

Layers picture_layers(const RenderReport& report, const CameraDesc& camera);

} // namespace snell::app

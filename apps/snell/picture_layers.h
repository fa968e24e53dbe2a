// What goes into an EXR beside the colours.
#pragma once

#include "report.h"

#include "snell/scene/scene.h"

namespace snell::app {

Layers picture_layers(const RenderReport& report, const CameraDesc& camera);

// Of the views left and right: to be written with the left picture.
Layers stereo_layers(Layers left, const Picture& right_picture, Layers right);

// The left picture beside the right one, of equal size.
Picture side_by_side(const Picture& left, const Picture& right);
std::vector<float> side_by_side(const std::vector<float>& left, const std::vector<float>& right, int width);

} // namespace snell::app

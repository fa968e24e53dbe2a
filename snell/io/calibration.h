// Camera calibrations as OpenCV's FileStorage writes them.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <optional>

namespace snell {

// Reads YAML, XML or JSON: image_width, image_height; camera_matrix (or cameraMatrix, K); distortion_coefficients (or
// distCoeffs, D), with 4, 5 or 8 numbers. Four are Kannala-Brandt's if the file says so (fisheye_model: 1, or ROS's
// distortion_model: equidistant), or if kind does. kind: camera_kannala_brandt or camera_brown_conrady, or what the
// file says. Throws Error (file, line, what to do) for what is missing or no calibration.
CameraModel load_calibration(const std::filesystem::path& file, std::optional<uint> kind = {});

} // namespace snell

// The camera models by name, and what they ask of a description.
#pragma once

#include "snell/scene/scene.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace snell {

struct CameraModelInfo
{
    uint kind; // camera_*
    std::string_view name;
    std::string_view summary; // one line for `snell list`
    float usual_fov;          // degrees; where nothing else is said
    float largest_fov;        // degrees, excluded unless it is 360
};

std::span<const CameraModelInfo> camera_models();                // by kind
const CameraModelInfo* find_camera_model(std::string_view name); // "rectilinear" is pinhole's other name

// What a camera of that kind has before anything else is said about it; a traced lens is the double Gauss.
CameraModel usual_model(uint kind);

// One eye's camera of a stereo pair, 0 left and 1 right: moved sideways by half of model.eye_distance, looking the same
// way, so that what is infinitely far away is in the same place of both pictures.
CameraDesc stereo_eye(const CameraDesc& camera, uint eye);

// What is wrong with the description's numbers or its lens, with the remedy behind "; "; empty: nothing. Eye, target
// and up are not looked at.
std::string camera_fault(const CameraDesc& camera);

// Fills k from coefficients in the order that people write them: Kannala-Brandt k1 to k4; Brown-Conrady as OpenCV does,
// k1 k2 p1 p2 [k3 [k4 k5 k6]]; HMD k1 to k3 for all colours, or for red, green and blue. False: not so many, or the
// model has none.
bool set_distortion(CameraModel& model, std::span<const float> coefficients);
// The inverse: as many as set_distortion() takes; empty if the model has none.
std::vector<float> distortion_of(const CameraModel& model);

// A camera for kernels, and what it points to: copies of the Camera alone are good as long as one of these lives.
struct ReadyCamera : Camera
{
    std::shared_ptr<const FocusedLens> glass; // of a traced lens; else null
};

// The camera of a picture of that size, in pixels. camera_fault() must be empty.
ReadyCamera make_camera(const CameraDesc& desc, int width, int height);

} // namespace snell

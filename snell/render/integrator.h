// Integrators by name: the built-in ones run as batched stages; one of your own is one function.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/core/vec.h"
#include "snell/kernel/random.h"
#include "snell/kernel/ray.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace snell {

// What a custom integrator gets to see: the scene's arrays and rays one at a time.
class RayScene
{
  public:
    RayScene(const SceneView& arrays, const Accel& accel) : view(arrays), accel_(accel) {}

    const SceneView& view;
    Hit intersect(const Ray& ray) const;
    bool occluded(const Ray& ray) const;

  private:
    const Accel& accel_;
};

// The random numbers of one sample of one pixel, in [0, 1), each call a new one.
class SampleStream
{
  public:
    explicit SampleStream(SampleKey key) : key_(key) {}
    float next_1d() { return random_1d(key_, dimension_++); }
    vec2 next_2d() { return random_2d(key_, dimension_++); }

  private:
    SampleKey key_;
    uint dimension_ = 2; // the camera has taken the first
};

// The radiance that arrives along `ray` at its origin.
using RadianceFunction = std::function<vec3(const RayScene& scene, const Ray& ray, SampleStream& sampler)>;

struct IntegratorInfo
{
    std::string name;
    std::string summary;                 // one line for `snell list`
    std::vector<std::string> parameters; // -D keys it knows, each "name=default  what it does"
    RadianceFunction radiance;           // custom ones only
    bool is_view = false;                // its values are data, not light: exposure and tone curve would falsify them
    uint view = none;                    // of a view: its view_* of snell/kernel/views.h
};

// Adds a custom integrator; from then on `--integrator name` finds it. Throws Error if the name is taken.
void register_integrator(std::string name, std::string summary, RadianceFunction radiance);

std::span<const IntegratorInfo> integrators();
const IntegratorInfo* find_integrator(std::string_view name);

// Whether it is the path tracer, under whatever name; what sets them apart is in their parameters.
bool traces_paths(const IntegratorInfo& integrator);

} // namespace snell

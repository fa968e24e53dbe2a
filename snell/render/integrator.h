// Integrators by name: the built-in ones run as batched stages; one of your own is one function.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/core/vec.h"
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

// The random numbers of one sample of one pixel: next_1d() and next_2d() in [0, 1).
class SampleStream
{
  public:
    SampleStream(uint sampler_kind, uint pixel, uint sample_index, uint seed)
        : kind_(sampler_kind), pixel_(pixel), sample_index_(sample_index), seed_(seed)
    {
    }
    float next_1d();
    vec2 next_2d();

  private:
    uint kind_, pixel_, sample_index_, seed_, dimension_ = 2;
};

// The radiance that arrives along `ray` at its origin.
using RadianceFunction = std::function<vec3(const RayScene& scene, const Ray& ray, SampleStream& sampler)>;

struct IntegratorInfo
{
    std::string name;
    std::string summary;                 // one line for `snell list`
    std::vector<std::string> parameters; // -D keys it knows, each "name=default  what it does"
    RadianceFunction radiance;           // custom ones only
};

// Adds a custom integrator; from then on `--integrator name` finds it. Throws Error if the name is taken.
void register_integrator(std::string name, std::string summary, RadianceFunction radiance);

std::span<const IntegratorInfo> integrators();
const IntegratorInfo* find_integrator(std::string_view name);

} // namespace snell

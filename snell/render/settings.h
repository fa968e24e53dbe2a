// What a render is asked for, beside the scene.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/scene/scene.h"

#include <map>
#include <optional>
#include <string>

namespace snell {

// Pixels [x0, x1) x [y0, y1).
struct Region
{
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    bool operator==(const Region&) const = default;
};

struct RenderSettings
{
    int width = 512, height = 512;
    std::optional<Region> region; // only these pixels; the rest of the film stays empty
    uint first_sample = 0;        // sample numbers [first_sample, first_sample + spp)
    uint spp = 64;
    uint seed = 0;
    std::string sampler = "sobol"; // "sobol" (Owen-scrambled) or "independent"
    std::string integrator = "path";
    std::map<std::string, std::string> parameters; // -D key=value: max_depth, nee, mis, rr, ...; builder, ...; unknown keys: Error
    std::string accel;                             // empty: the default one of the device
    AccelOptions accel_options;                    // where parameters do not say otherwise
    std::string device = "cpu"; // or a GPU's: as choose_device() names it
    int threads = 0;            // 0: all
    int tile_size = 0;          // pixels a side; 0: chosen. The picture does not depend on it
    double timeout_seconds = 0; // stop after that long; 0: never
    double target_error = 0;    // stop when Film::estimated_relmse is down to this; 0: never
    bool pixel_jitter = true;   // false: every sample through the pixel's centre
    bool force_diffuse = false; // every material becomes Lambert
    bool image_textures = true;
    bool strict = false; // a non-finite sample is an Error instead of being dropped and counted
    bool layers = false; // also record first-hit pictures and direct, indirect, emission apart
    bool keep_motion = false; // what animations move is packed and built apart, for Prepared::update()

    bool operator==(const RenderSettings&) const = default;
};

} // namespace snell

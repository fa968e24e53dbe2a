// One picture while it is being rendered: what render() does at a stretch and a Session in parts.
#pragma once

#include "snell/render/backend.h"
#include "snell/render/params.h"
#include "snell/render/render.h"

#include <functional>
#include <memory>

namespace snell {

class Rendering
{
  public:
    // Refers to `prepared`, which must not change as long as this lives. Throws Error for settings that make no sense
    // and for a camera that sees nothing.
    Rendering(const Prepared& prepared, const RenderSettings& settings, const CameraDesc& camera);

    // Adds samples [first, first + count) of the pixels of `part`, which lies in region(). Samples are numbered from
    // 0, which is RenderSettings::first_sample. Each part must get its samples in ascending order; then the film does
    // not depend on how it was divided, bit for bit. See Backend::render_samples() for keep_going.
    void add_samples(const Region& part, uint first, uint count, const std::function<bool()>& keep_going);

    const RenderSettings& settings() const { return settings_; }
    const Region& region() const { return region_; } // pixels that are asked for
    double samples_in_all() const;                   // of all pixels
    RenderStats stats() const;                       // rays, samples and stage times so far

    Film film;
    const IntegratorInfo& integrator;

  private:
    const RenderSettings settings_;
    const Region region_;
    const ReadyParams params_;
    std::unique_ptr<Backend> backend_;
};

} // namespace snell

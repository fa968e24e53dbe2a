#include "snell/render/rendering.h"

#include "snell/core/error.h"
#include "snell/render/suggestion.h"

#include <algorithm>

namespace snell {

static const IntegratorInfo& known_integrator(const std::string& name)
{
    const IntegratorInfo* integrator = find_integrator(name);
    if (integrator == nullptr)
        throw Error(fmt::format("there is no integrator '{}'", name), suggestion(name, integrators()));
    return *integrator;
}

static Region checked_region(const RenderSettings& settings)
{
    if (settings.width < 1 || settings.height < 1 || settings.width > 65536 || settings.height > 65536)
        throw Error(fmt::format("a picture of {}x{} pixels", settings.width, settings.height),
                    "each side must have 1 to 65536 pixels");
    if (settings.spp < 1) throw Error("0 samples a pixel", "give --spp a number of at least 1");
    const Region whole{0, 0, settings.width, settings.height};
    if (!settings.region) return whole;
    const Region r{std::max(settings.region->x0, 0), std::max(settings.region->y0, 0),
                   std::min(settings.region->x1, whole.x1), std::min(settings.region->y1, whole.y1)};
    if (r.x0 >= r.x1 || r.y0 >= r.y1) throw Error("the region to render has no pixel inside the picture");
    return r;
}

Rendering::Rendering(const Prepared& prepared, const RenderSettings& settings, const CameraDesc& camera)
    : integrator(known_integrator(settings.integrator)), settings_(settings), region_(checked_region(settings)),
      params_(make_render_params(settings, integrator, camera, prepared.packed.radius))
{
    film = Film(settings.width, settings.height, settings.layers);
    if (prepared.packed.environment.is_visible == 0u || camera.model.kind != camera_pinhole)
        film.seen_through.assign(film.sample_count.size(), 0u);
    const BackendJob job = {prepared.packed, *prepared.accel, params_, settings_, integrator};
    backend_ = prepared.device ? prepared.device->make_backend(job) : make_cpu_backend(job);
}

void Rendering::add_samples(const Region& part, uint first, uint count, const std::function<bool()>& keep_going)
{
    backend_->render_samples(part, settings_.first_sample + first, count, film, keep_going);
}

double Rendering::samples_in_all() const
{
    return static_cast<double>(region_.x1 - region_.x0) * (region_.y1 - region_.y0) * settings_.spp;
}

RenderStats Rendering::stats() const
{
    return backend_->stats();
}

} // namespace snell

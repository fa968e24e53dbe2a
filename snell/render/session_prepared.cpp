#include "snell/render/session_prepared.h"

#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/scene/change.h"

#include <algorithm>

namespace snell {

static std::map<std::string, std::string> accel_part(const std::map<std::string, std::string>& parameters)
{
    std::map<std::string, std::string> part;
    for (const auto& [key, value] : parameters)
        if (is_accel_parameter(key)) part.emplace(key, value);
    return part;
}

bool same_preparation(const RenderSettings& a, const RenderSettings& b)
{
    return a.device == b.device && a.accel == b.accel && a.accel_options == b.accel_options &&
           a.force_diffuse == b.force_diffuse && a.image_textures == b.image_textures &&
           accel_part(a.parameters) == accel_part(b.parameters);
}

const Prepared* PreparedSet::find(const RenderSettings& settings) const
{
    for (const Entry& entry : entries_)
        if (same_preparation(entry.settings, settings)) return entry.prepared.get();
    return nullptr;
}

const Prepared* PreparedSet::get(const Scene& scene, const RenderSettings& settings)
{
    if (const Prepared* prepared = find(settings)) return prepared;
    const Timer timer;
    RenderSettings moving = settings;
    moving.keep_motion = true; // transforms can follow
    entries_.push_back({settings, prepare(scene, moving)});
    prepare_seconds = timer.seconds();
    return entries_.back().prepared.get();
}

void PreparedSet::follow(const Scene& scene, uint changes)
{
    if ((changes & ~uint{change_camera}) == 0) return;
    const Timer timer;
    std::erase_if(entries_, [&](Entry& entry) {
        try {
            entry.prepared->update(scene, changes);
            return false;
        } catch (const Error&) {
            return true;
        }
    });
    update_seconds = timer.seconds();
}

void PreparedSet::keep_for(const std::vector<RenderSettings>& settings)
{
    std::erase_if(entries_, [&](const Entry& entry) {
        return std::none_of(settings.begin(), settings.end(),
                            [&](const RenderSettings& s) { return same_preparation(entry.settings, s); });
    });
}

} // namespace snell

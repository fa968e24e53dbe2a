#include "snell/lab/rates.h"

#include "snell/render/render_stats.h"

#include <numeric>

namespace snell {

void RateMeter::add(double time, const RenderStats& total)
{
    if (!entries_.empty() && (total.samples < entries_.back().total.samples || time < entries_.back().time))
        entries_.clear();
    entries_.push_back({time, total});
    // One that is older than the window stays, so that the window is covered.
    while (entries_.size() > 2 && entries_[1].time <= time - window_) entries_.pop_front();
}

RenderRates RateMeter::rates() const
{
    RenderRates rates;
    if (entries_.size() < 2) return rates;
    const double seconds = entries_.back().time - entries_.front().time;
    if (!(seconds > 0)) return rates;
    const RenderStats d = difference(entries_.back().total, entries_.front().total);
    rates.camera_rays = static_cast<double>(d.camera_rays) / seconds;
    rates.extension_rays = static_cast<double>(d.extension_rays) / seconds;
    rates.shadow_rays = static_cast<double>(d.shadow_rays) / seconds;
    rates.samples = static_cast<double>(d.samples) / seconds;
    rates.stages = {d.generate_seconds, d.extend_seconds, d.shade_seconds, d.connect_seconds, d.finalize_seconds};
    const double all = std::accumulate(rates.stages.begin(), rates.stages.end(), 0.0);
    for (double& stage : rates.stages) stage = all > 0 ? stage / all : 0.0;
    return rates;
}

} // namespace snell

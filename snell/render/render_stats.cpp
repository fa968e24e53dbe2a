#include "snell/render/render_stats.h"

namespace snell {

constexpr std::uint64_t RenderStats::*const counts[] = {&RenderStats::camera_rays, &RenderStats::extension_rays,
                                                        &RenderStats::shadow_rays, &RenderStats::samples};
constexpr double RenderStats::*const times[] = {&RenderStats::render_seconds,  &RenderStats::generate_seconds,
                                                &RenderStats::extend_seconds,  &RenderStats::shade_seconds,
                                                &RenderStats::connect_seconds, &RenderStats::finalize_seconds};

void add(RenderStats& sum, const RenderStats& more)
{
    for (const auto count : counts) sum.*count += more.*count;
    for (const auto time : times) sum.*time += more.*time;
}

RenderStats difference(const RenderStats& later, const RenderStats& earlier)
{
    RenderStats result;
    for (const auto count : counts) result.*count = later.*count - earlier.*count;
    for (const auto time : times) result.*time = later.*time - earlier.*time;
    return result;
}

} // namespace snell

#include "bench_path.h"

#include "bench_lane.h"

#include "snell/core/timer.h"
#include "snell/lab/accel_figures.h"
#include "snell/render/params.h"

#ifdef SNELL_HAS_EMBREE
#include "bench/embree_path.h"
#endif

#include <fmt/format.h>

#include <algorithm>

namespace snell::app {

static std::vector<PathContender> contenders_of(const Prepared& prepared, const RenderSettings& settings,
                                                const RenderParams& params)
{
    std::vector<PathContender> list(1);
    list[0].name = fmt::format("snell ({})", settings.accel.empty() ? accels().front().name : settings.accel);
    list[0].build_seconds = prepared.build_seconds;
    list[0].render = [&](Film& film) {
        RenderResult result = render(prepared, settings);
        film = std::move(result.film);
        return result.stats.rays();
    };
#ifdef SNELL_HAS_EMBREE
    for (const auto& [name, quality] : {std::pair{"Embree, default", bench::EmbreeQuality::standard},
                                        std::pair{"Embree, HIGH", bench::EmbreeQuality::high}}) {
        auto tracer = std::make_shared<bench::EmbreePathTracer>(prepared.packed, quality);
        PathContender& one = list.emplace_back();
        one.name = name;
        one.build_seconds = tracer->build_seconds();
        one.render = [tracer, params, spp = settings.spp](Film& film) { return tracer->render(params, spp, film); };
    }
#else
    (void)params;
#endif
    return list;
}

PathFigures measure_paths(const Prepared& prepared, const RenderSettings& settings, int runs)
{
    const ReadyParams params =
        make_render_params(settings, *find_integrator("path"), prepared.camera, prepared.packed.radius);
    PathFigures figures;
    figures.contenders = contenders_of(prepared, settings, params);
    figures.max_depth = params.max_depth;
    figures.samples = static_cast<double>(settings.width) * settings.height * settings.spp;
    for (int run = -1; run < runs; ++run) { // the first one warms up
        for (PathContender& one : figures.contenders) {
            Film film(settings.width, settings.height, false);
            const Timer timer;
            const double cpu = process_cpu_seconds();
            one.rays = one.render(film);
            if (run < 0) {
                one.picture = film.picture();
                continue;
            }
            one.rates.push_back(figures.samples / (process_cpu_seconds() - cpu));
            one.wall_rates.push_back(figures.samples / timer.seconds());
        }
    }
    double best = 0;
    for (std::size_t i = 1; i < figures.contenders.size(); ++i)
        best = std::max(best, spread_of(figures.contenders[i].rates).median);
    if (best > 0) figures.ratio = spread_of(figures.contenders[0].rates).median / best;
    return figures;
}

} // namespace snell::app

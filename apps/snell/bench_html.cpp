// The figures as a page with charts.
#include "bench_results.h"

#include "snell/core/version.h"
#include "snell/lab/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace snell::app {

static std::string processor_name()
{
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
    return "unknown processor";
}

static std::string shown(double value, const char* form = "{:.2f}")
{
    return value > 0 ? fmt::format(fmt::runtime(form), value) : "";
}

static std::string shown(const std::optional<double>& value)
{
    return value ? fmt::format("{:.2f}", *value) : "";
}

static void add_summary(HtmlReport& report, const AccelResults& results)
{
    report.heading("Ratios to Embree");
    report.paragraph("Above 1 snell is ahead. Geometric means over the scenes; against the better of Embree's default "
                     "and HIGH quality, for camera and any-hit rays also of its packets of 8 and 16 rays.");
    std::vector<std::vector<std::string>> rows;
    const auto add_row = [&](const std::string& name, const AccelRatios& r) {
        rows.push_back({name, shown(r.incoherent), shown(r.any_hit), shown(r.camera), shown(r.build), shown(r.refit),
                        shown(r.bytes), shown(r.path)});
    };
    add_row("all scenes, one thread", results.summary());
    add_row("all scenes, all threads", results.summary(true));
    for (const AccelScene& scene : results.scenes) {
        AccelRatios one = ratios_of(scene, scene.rows[0]);
        for (const PathResult& path : results.paths)
            if (path.scene == scene.name) one.path = path.ratio;
        add_row(scene.name, one);
    }
    report.table({"", "incoherent", "any hit", "camera", "build", "refit", "bytes", "path"}, rows);
}

static void add_table(HtmlReport& report, const AccelScene& scene)
{
    std::vector<std::string> header = {"", "build ms", "bytes/primitive", "SAH"};
    for (const auto& [set, rays] : scene.sets) {
        header.push_back(set);
        header.push_back("all threads");
    }
    std::vector<std::vector<std::string>> rows;
    const double primitives = static_cast<double>(std::max<std::size_t>(scene.triangles + scene.spheres, 1));
    for (const AccelRow& row : scene.rows) {
        std::vector<std::string> cells = {row.name, shown(1e3 * row.build.median, "{:.1f}"),
                                          shown(static_cast<double>(row.bytes) / primitives, "{:.1f}"),
                                          shown(row.sah_cost)};
        for (const auto& [set, rays] : scene.sets) {
            const auto found = row.traces.find(set);
            const TraceFigure figure = found == row.traces.end() ? TraceFigure() : found->second;
            cells.push_back(figure.one.median > 0 ? fmt::format("{:.2f} ({:.2f} to {:.2f})", figure.one.median,
                                                                figure.one.low, figure.one.high)
                                                  : "");
            cells.push_back(shown(figure.all.median));
        }
        rows.push_back(std::move(cells));
    }
    report.table(header, rows);
}

// Of ours those of the first one's builder, of Embree's single rays and packets of 16: lest there be more bars than
// eyes can follow.
static bool is_charted(const AccelScene& scene, const AccelRow& row)
{
    return row.is_ours() ? row.builder == scene.rows[0].builder : row.packet != 8;
}

static void add_bars(HtmlReport& report, const AccelScene& scene)
{
    BarChart chart;
    chart.title = "Mrays per second of CPU time, one thread";
    for (const auto& [set, rays] : scene.sets) chart.groups.push_back(set);
    int color = 0;
    for (const AccelRow& row : scene.rows) {
        if (!is_charted(scene, row)) continue;
        BarChart::Series series{row.name, {}, color++};
        for (const auto& [set, rays] : scene.sets) {
            const auto found = row.traces.find(set);
            series.values.push_back(found == row.traces.end() ? 0 : found->second.one.median);
        }
        chart.series.push_back(std::move(series));
    }
    report.chart(chart);
}

// Build time against trace speed: up and to the left is better.
static void add_front(HtmlReport& report, const AccelScene& scene)
{
    PointChart chart;
    chart.title = "Build time against speed: up and left is better";
    chart.x_title = "build time, all threads, milliseconds";
    chart.y_title = "incoherent rays, Mrays/s, one thread";
    chart.x_log = true;
    ChartSeries ours{"snell", {}, {}, false, 0}, theirs{"Embree, single rays", {}, {}, false, 1};
    for (const AccelRow& row : scene.rows) {
        const std::optional<double> speed = incoherent_speed(row);
        if (!speed || (!row.is_ours() && row.packet != 1)) continue;
        // Of the structures that differ in traversal only, one says it all.
        if (row.is_ours() && &row != &scene.rows[0] && row.traversal != "auto") continue;
        ChartSeries& series = row.is_ours() ? ours : theirs;
        series.points.emplace_back(1e3 * row.build.median, *speed);
        series.labels.push_back(row.name);
    }
    chart.series = {std::move(ours), std::move(theirs)};
    report.chart(chart);
}

static void add_growth(HtmlReport& report, const std::vector<AccelScene>& growth)
{
    if (growth.empty()) return;
    report.heading("Growth");
    report.paragraph("The same field of boulders with ever more triangles. On this logarithmic axis a cost that grows "
                     "with the logarithm of their number is a straight line.");
    PointChart chart;
    chart.title = "Cost of a ray against the number of triangles";
    chart.x_title = "triangles";
    chart.y_title = "nanoseconds a ray, one thread";
    chart.x_log = true;
    int color = 0;
    for (const char* set : {"camera", "shadow", "bounce2"}) {
        for (std::size_t i = 0; i < growth[0].rows.size(); ++i) {
            ChartSeries series{fmt::format("{}: {}", growth[0].rows[i].name, set), {}, {}, true, color++};
            for (const AccelScene& scene : growth)
                series.points.emplace_back(static_cast<double>(scene.triangles), nanoseconds_a_ray(scene.rows[i], set));
            chart.series.push_back(std::move(series));
        }
    }
    report.chart(chart);
}

static void add_refit_and_path(HtmlReport& report, const AccelResults& results)
{
    if (results.refit) {
        const RefitFigures& refit = *results.refit;
        report.heading("Refit");
        report.table({"", "triangles", "snell ms", "from nothing ms", "Embree ms", "ratio"},
                     {{refit.scene, std::to_string(refit.triangles), shown(1e3 * refit.ours.median, "{:.1f}"),
                       shown(1e3 * refit.rebuild_seconds, "{:.1f}"), shown(1e3 * refit.embree.median, "{:.1f}"),
                       shown(refit.ratio)}});
    }
    if (results.paths.empty()) return;
    report.heading("The whole renderer");
    report.paragraph("Msamples per second of CPU time, paths of up to 8 bounces, beside a plain path tracer that calls "
                     "Embree for one ray at a time and shades with the same code.");
    std::vector<std::string> header = {""};
    for (const auto& [name, rate] : results.paths[0].rates) header.push_back(name);
    header.push_back("ratio");
    std::vector<std::vector<std::string>> rows;
    for (const PathResult& path : results.paths) {
        std::vector<std::string> cells = {path.scene};
        for (const auto& [name, rate] : path.rates) cells.push_back(shown(rate.median, "{:.3f}"));
        cells.push_back(shown(path.ratio));
        rows.push_back(std::move(cells));
    }
    report.table(header, rows);
}

std::string results_html(const AccelResults& results)
{
    HtmlReport report("snell bench accel");
    report.paragraph(fmt::format("snell {} (commit {}), {}, {} threads on {}; medians of {} interleaved runs{}. Rates "
                                 "are millions of rays per second of CPU time; in brackets the slowest and the fastest "
                                 "run.",
                                 version(), commit(), compiler(), results.threads, processor_name(), results.runs,
                                 results.quick ? ", quick" : ""));
    if (!results.failures.empty()) {
        report.heading("Disagreements");
        for (const std::string& failure : results.failures) report.paragraph(failure);
    }
    add_summary(report, results);
    for (const AccelScene& scene : results.scenes) {
        report.heading(fmt::format("{}: {} triangles", scene.name, scene.triangles));
        add_bars(report, scene);
        add_front(report, scene);
        add_table(report, scene);
    }
    add_growth(report, results.growth);
    add_refit_and_path(report, results);
    return report.page();
}

} // namespace snell::app

#include "snell/lab/accel_figures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell {

static constexpr std::array bounces = {"bounce1", "bounce2", "bounce3"};

Spread spread_of(std::vector<double> values)
{
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    const double median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
    return {median, values.front(), values.back()};
}

static std::optional<double> geometric_mean(std::span<const std::optional<double>> values)
{
    double sum = 0;
    int count = 0;
    for (const std::optional<double>& value : values)
        if (value && *value > 0) sum += std::log(*value), ++count;
    if (count == 0) return std::nullopt;
    return std::exp(sum / count);
}

static std::optional<double> speed(const AccelRow& row, std::string_view set, bool all_threads)
{
    const auto found = row.traces.find(set);
    if (found == row.traces.end()) return std::nullopt;
    const double value = all_threads ? found->second.all.median : found->second.one.median;
    return value > 0 ? std::optional(value) : std::nullopt;
}

std::optional<double> set_ratio(const AccelScene& scene, const AccelRow& ours, std::string_view set, bool all_threads)
{
    const bool single_only = set.starts_with("bounce");
    double best = 0;
    for (const AccelRow& row : scene.rows) {
        if (row.quality != YardstickQuality::medium && row.quality != YardstickQuality::high) continue;
        if (single_only && row.packet != 1) continue;
        best = std::max(best, speed(row, set, all_threads).value_or(0));
    }
    const std::optional<double> mine = speed(ours, set, all_threads);
    if (!mine || best <= 0) return std::nullopt;
    return *mine / best;
}

std::optional<double> incoherent_speed(const AccelRow& row)
{
    std::vector<std::optional<double>> speeds;
    for (const char* set : bounces) speeds.push_back(speed(row, set, false));
    return geometric_mean(speeds);
}

std::optional<double> build_ratio(const AccelScene& scene)
{
    std::vector<std::optional<double>> ratios;
    for (const AccelRow& theirs : scene.rows) {
        if (theirs.is_ours() || theirs.packet != 1) continue;
        const std::optional<double> wanted = incoherent_speed(theirs);
        if (!wanted || !(theirs.build.median > 0)) continue;
        std::optional<double> best;
        for (const AccelRow& ours : scene.rows) {
            const std::optional<double> reached = ours.is_ours() ? incoherent_speed(ours) : std::nullopt;
            if (!reached || !(ours.build.median > 0)) continue;
            double ratio = theirs.build.median / ours.build.median;
            if (*reached < *wanted) ratio = std::min(ratio, *reached / *wanted);
            best = std::max(best.value_or(0), ratio);
        }
        ratios.push_back(best);
    }
    return geometric_mean(ratios);
}

bool is_on_front(const AccelScene& scene, const AccelRow& ours)
{
    const double mine = incoherent_speed(ours).value_or(0);
    return std::none_of(scene.rows.begin(), scene.rows.end(), [&](const AccelRow& row) {
        return !row.is_ours() && row.packet == 1 && row.build.median > 0 && row.build.median < ours.build.median &&
               incoherent_speed(row).value_or(0) > mine;
    });
}

AccelRatios ratios_of(const AccelScene& scene, const AccelRow& ours, bool all_threads)
{
    const auto mean_of = [&](std::span<const char* const> sets) {
        std::vector<std::optional<double>> ratios;
        for (const char* set : sets) ratios.push_back(set_ratio(scene, ours, set, all_threads));
        return geometric_mean(ratios);
    };
    AccelRatios ratios;
    ratios.camera = set_ratio(scene, ours, "camera", all_threads);
    ratios.any_hit = mean_of(std::array{"shadow", "ao"});
    ratios.incoherent = mean_of(bounces);
    ratios.build = build_ratio(scene);
    for (const AccelRow& row : scene.rows)
        if (row.quality == YardstickQuality::medium && row.bytes > 0 && ours.bytes > 0)
            ratios.bytes = static_cast<double>(row.bytes) / static_cast<double>(ours.bytes);
    return ratios;
}

AccelRatios mean_ratios(std::span<const AccelRatios> all)
{
    AccelRatios mean;
    for (const auto member : {&AccelRatios::camera, &AccelRatios::any_hit, &AccelRatios::incoherent,
                              &AccelRatios::build, &AccelRatios::bytes, &AccelRatios::refit, &AccelRatios::path}) {
        std::vector<std::optional<double>> values;
        for (const AccelRatios& one : all) values.push_back(one.*member);
        mean.*member = geometric_mean(values);
    }
    return mean;
}

} // namespace snell

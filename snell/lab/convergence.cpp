#include "snell/lab/convergence.h"

#include "snell/core/parallel.h"
#include "snell/lab/csv.h"

#include <cmath>
#include <mutex>

namespace snell {

double PowerLaw::operator()(double x) const
{
    return factor * std::pow(x, exponent);
}

static bool counts(double x)
{
    return x > 0 && std::isfinite(x);
}

std::optional<PowerLaw> fit_power_law(std::span<const double> x, std::span<const double> y)
{
    std::vector<double> u, v;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
        if (counts(x[i]) && counts(y[i])) u.push_back(std::log(x[i])), v.push_back(std::log(y[i]));
    if (u.size() < 3) return std::nullopt;
    const auto n = static_cast<double>(u.size());
    double mean_u = 0, mean_v = 0;
    for (std::size_t i = 0; i < u.size(); ++i) mean_u += u[i] / n, mean_v += v[i] / n;
    double uu = 0, uv = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
        uu += (u[i] - mean_u) * (u[i] - mean_u);
        uv += (u[i] - mean_u) * (v[i] - mean_v);
    }
    if (!(uu > 1e-12)) return std::nullopt;
    const double exponent = uv / uu;
    return PowerLaw{exponent, std::exp(mean_v - exponent * mean_u)};
}

std::optional<PowerLaw> fit_time(const ConvergenceCurve& curve, double part)
{
    std::vector<double> x, y;
    for (const ConvergencePoint& p : curve.points)
        if (counts(p.seconds) && counts(p.rmse)) x.push_back(p.seconds), y.push_back(p.rmse);
    if (x.empty()) return std::nullopt;
    const double first = std::log(x.front()), last = std::log(x.back());
    std::size_t skip = 0;
    while (skip < x.size() && std::log(x[skip]) < last - part * (last - first)) ++skip;
    return fit_power_law(std::span(x).subspan(skip), std::span(y).subspan(skip));
}

namespace {
// Summed over pixels in parallel; the same whatever the threads do, because chunks are added in their order.
struct Sum
{
    double value = 0;
    std::uint64_t pixels = 0;
};
} // namespace

template <class Term>
static Sum sum_over_pixels(std::size_t count, const Term& term)
{
    constexpr std::size_t chunk = 1 << 14;
    std::vector<Sum> sums((count + chunk - 1) / chunk);
    parallel_for(sums.size(), [&](std::size_t c) {
        for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) {
            const double value = term(i);
            if (!std::isfinite(value)) continue;
            sums[c].value += value;
            sums[c].pixels += 1;
        }
    });
    Sum all;
    for (const Sum& s : sums) all.value += s.value, all.pixels += s.pixels;
    return all;
}

static std::optional<double> root_of_mean(const Sum& sum)
{
    if (sum.pixels == 0) return std::nullopt;
    return std::sqrt(sum.value / static_cast<double>(sum.pixels));
}

std::optional<double> expected_rmse(const Film& film)
{
    for (const uint count : film.sample_count)
        if (count < 2) return std::nullopt;
    return root_of_mean(sum_over_pixels(film.sum.size(), [&](std::size_t i) { return film.mean_variance(i); }));
}

std::optional<double> rmse_against(const Film& film, const Picture& reference)
{
    if (film.width != reference.width || film.height != reference.height) return std::nullopt;
    return root_of_mean(sum_over_pixels(film.sum.size(), [&](std::size_t i) {
        const uint n = film.sample_count[i];
        const double value = n == 0 ? 0.0 : static_cast<double>(luminance(film.sum[i])) / n;
        const double difference = value - static_cast<double>(luminance(reference.pixels[i]));
        return difference * difference;
    }));
}

std::string convergence_csv(std::span<const ConvergenceCurve> curves)
{
    CsvTable table({"name", "seconds", "spp", "rmse"});
    for (const ConvergenceCurve& curve : curves)
        for (const ConvergencePoint& p : curve.points) table.row({curve.name, p.seconds, p.spp, p.rmse});
    return table.text();
}

} // namespace snell

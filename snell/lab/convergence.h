// How the error of a picture falls while it is being rendered.
#pragma once

#include "snell/io/image/image.h"
#include "snell/render/film.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snell {

struct ConvergencePoint
{
    double seconds = 0; // of rendering
    double spp = 0;
    double rmse = 0; // root of the mean squared error
};

struct ConvergenceCurve
{
    std::string name;
    std::vector<ConvergencePoint> points; // in the order of time
};

// y = factor * x^exponent.
struct PowerLaw
{
    double exponent = 0, factor = 0;
    double operator()(double x) const;
};

// The law that fits best: least squares of log y against log x. Points with a coordinate that is not above 0 or not
// finite do not count. Nothing with fewer than three points, or where x is always the same.
std::optional<PowerLaw> fit_power_law(std::span<const double> x, std::span<const double> y);

// Of the errors against time, over the last `part` of the curve on the logarithmic axis: its beginning has too few
// samples to follow a law. The error of independent samples falls with the power -1/2 (the central limit theorem).
std::optional<PowerLaw> fit_time(const ConvergenceCurve& curve, double part = 0.75);

// The error that the spread of the samples lets expect: the root of the mean over pixels of Film::mean_variance(), on
// luminance. For independent samples it is that of the picture against the true one; for better samplers it is an upper
// bound. Nothing as long as a pixel has fewer than two samples.
std::optional<double> expected_rmse(const Film& film);

// The error against a reference, on luminance, over the pixels that are finite in both. Nothing if the sizes differ or
// there is no such pixel.
std::optional<double> rmse_against(const Film& film, const Picture& reference);

// As CSV: a line of names, then name,seconds,spp,rmse of each point. Names are quoted where they must be.
std::string convergence_csv(std::span<const ConvergenceCurve> curves);

} // namespace snell

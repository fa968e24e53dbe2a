// Charts drawn into panels.
#pragma once

#include <imgui.h>

#include <span>
#include <string>
#include <vector>

namespace snell::view {

struct PlotSeries
{
    std::string name;
    std::vector<double> x, y;
    ImU32 color = 0;
    bool is_dashed = false; // a law or a guide; without points
};

// The colours of curves, in turn; readable on both styles.
ImU32 curve_color(std::size_t number);

// Lines over two logarithmic axes with their decades, as wide as the panel; what is not above 0 is left out. While the
// mouse is over it, shows the values there. x_name, y_name: with their units.
void plot_log_log(const char* id, std::span<const PlotSeries> series, const char* x_name, const char* y_name,
                  float height);

// The same over two even axes, of all numbers that are finite.
void plot_lines(const char* id, std::span<const PlotSeries> series, const char* x_name, const char* y_name,
                float height);

} // namespace snell::view

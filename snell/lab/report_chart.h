// Charts as SVG text that stands inside an HTML page: no scripts, no fonts or styles from elsewhere.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace snell {

struct ChartSeries
{
    std::string name;
    std::vector<std::pair<double, double>> points; // x, y
    std::vector<std::string> labels;               // of the points, or none
    bool line = false;                             // joins the points in their order
    int color = 0;                                 // any number: the palette repeats
};

// Points and lines over two axes, each of which may be logarithmic (then values that are not positive are left out).
struct PointChart
{
    std::string title, x_title, y_title;
    bool x_log = false, y_log = false;
    std::vector<ChartSeries> series;
};

// Horizontal bars in groups: one group a name, one bar a series.
struct BarChart
{
    std::string title, unit;
    std::vector<std::string> groups;
    struct Series
    {
        std::string name;
        std::vector<double> values; // by group; 0: no bar
        int color = 0;
    };
    std::vector<Series> series;
};

std::string svg(const PointChart& chart);
std::string svg(const BarChart& chart);

// As text of HTML and SVG, and inside quoted attributes: & < > " ' replaced, control characters dropped.
std::string escape_html(const std::string& text);

} // namespace snell

#include "snell/lab/report_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace snell {

namespace {

// Colours that stay apart for eyes that mix up red and green (after Okabe and Ito).
constexpr std::array palette = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555", "#8a6d00"};

const char* color_of(int number)
{
    return palette[static_cast<std::size_t>(number) % palette.size()];
}

// A range of values along one side of the chart.
struct Axis
{
    bool logarithmic = false;
    double low = 0, high = 1; // in the values' own unit
    double pixel_low = 0, pixel_high = 1;

    double at(double value) const
    {
        const double part = logarithmic ? (std::log(value) - std::log(low)) / (std::log(high) - std::log(low))
                                        : (value - low) / (high - low);
        return pixel_low + part * (pixel_high - pixel_low);
    }
};

bool can_show(double value, bool logarithmic)
{
    return std::isfinite(value) && (!logarithmic || value > 0);
}

// 1, 2 or 5 times a power of ten, so that about five of them fit.
double tick_step(double span)
{
    const double raw = span / 5, power = std::pow(10.0, std::floor(std::log10(raw)));
    const double factor = raw / power;
    return power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
}

// Makes room around the values, and ends at round numbers.
Axis fit_axis(const std::vector<double>& values, bool logarithmic)
{
    Axis axis;
    axis.logarithmic = logarithmic;
    if (values.empty()) {
        axis.low = logarithmic ? 1 : 0;
        axis.high = logarithmic ? 10 : 1;
        return axis;
    }
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (logarithmic) {
        axis.low = *low / 1.3;
        axis.high = *high * 1.3;
        return axis;
    }
    const double top = std::max(*high, 0.0), bottom = std::min(*low, 0.0);
    const double step = tick_step(std::max(top - bottom, 1e-12));
    axis.low = std::floor(bottom / step) * step;
    axis.high = std::ceil(1.02 * top / step) * step;
    if (!(axis.high > axis.low)) axis.high = axis.low + step;
    return axis;
}

std::vector<double> ticks_of(const Axis& axis)
{
    std::vector<double> ticks;
    if (axis.logarithmic) {
        const double decades = std::log10(axis.high) - std::log10(axis.low);
        const double step = std::max(1.0, std::ceil(decades / 10));
        for (double power = std::floor(std::log10(axis.low)); power <= std::log10(axis.high); power += step)
            for (const double factor : {1.0, 2.0, 5.0}) {
                if (factor != 1.0 && decades > 2.5) continue;
                const double tick = factor * std::pow(10.0, power);
                if (tick >= axis.low && tick <= axis.high) ticks.push_back(tick);
            }
    } else {
        const double step = tick_step(axis.high - axis.low);
        const int count = static_cast<int>(std::round((axis.high - axis.low) / step));
        for (int i = 0; i <= std::min(count, 50); ++i) ticks.push_back(axis.low + i * step);
    }
    return ticks;
}

std::string tick_text(double value)
{
    if (value >= 1e6) return fmt::format("{:g} M", value * 1e-6);
    if (value >= 1e4) return fmt::format("{:g} k", value * 1e-3);
    return fmt::format("{:.4g}", value);
}

std::string text_at(double x, double y, const std::string& text, const char* more = "")
{
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, more, escape_html(text));
}

std::string open_svg(double width, double height, const std::string& title)
{
    return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" "
                       "font-family=\"sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"{}\">\n",
                       width, height, width, escape_html(title)) +
           text_at(8, 18, title, "font-size=\"14\" font-weight=\"bold\"");
}

} // namespace

std::string escape_html(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '"')
            result += "&quot;";
        else if (c == '\'')
            result += "&#39;";
        else if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f)
            result += c;
    }
    return result;
}

std::string svg(const PointChart& chart)
{
    constexpr double width = 760, height = 420, left = 70, right = 210, top = 34, bottom = 52;
    std::vector<double> xs, ys;
    for (const ChartSeries& series : chart.series)
        for (const auto& [x, y] : series.points)
            if (can_show(x, chart.x_log) && can_show(y, chart.y_log)) xs.push_back(x), ys.push_back(y);
    Axis x_axis = fit_axis(xs, chart.x_log), y_axis = fit_axis(ys, chart.y_log);
    x_axis.pixel_low = left, x_axis.pixel_high = width - right;
    y_axis.pixel_low = height - bottom, y_axis.pixel_high = top;

    std::string out = open_svg(width, height, chart.title);
    for (const double tick : ticks_of(x_axis)) {
        const double x = x_axis.at(tick);
        out += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#ddd\"/>\n", x, top,
                           height - bottom);
        out += text_at(x, height - bottom + 16, tick_text(tick), "text-anchor=\"middle\"");
    }
    for (const double tick : ticks_of(y_axis)) {
        const double y = y_axis.at(tick);
        out += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n", left,
                           width - right, y, y);
        out += text_at(left - 6, y + 4, tick_text(tick), "text-anchor=\"end\"");
    }
    out += text_at(0.5 * (left + width - right), height - 14, chart.x_title, "text-anchor=\"middle\"");
    out += fmt::format("<text transform=\"translate(16 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                       0.5 * (top + height - bottom), escape_html(chart.y_title));

    double legend = top + 8;
    for (const ChartSeries& series : chart.series) {
        const char* color = color_of(series.color);
        std::string path;
        for (std::size_t i = 0; i < series.points.size(); ++i) {
            const auto& [vx, vy] = series.points[i];
            if (!can_show(vx, chart.x_log) || !can_show(vy, chart.y_log)) continue;
            const double x = x_axis.at(vx), y = y_axis.at(vy);
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x, y);
            out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n", x, y, color);
            if (i >= series.labels.size()) continue;
            const bool at_right = x > 0.7 * (width - right); // the legend is there
            out += text_at(at_right ? x - 6 : x + 6, y - 5, series.labels[i],
                           at_right ? "font-size=\"11\" text-anchor=\"end\"" : "font-size=\"11\"");
        }
        if (series.line && !path.empty())
            out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path, color);
        out += fmt::format("<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"4\" fill=\"{}\"/>\n", width - right + 18,
                           legend - 4, color);
        out += text_at(width - right + 28, legend, series.name);
        legend += 17;
    }
    return out + "</svg>\n";
}

std::string svg(const BarChart& chart)
{
    constexpr double width = 760, left = 190, right = 70, top = 30, bar = 11, gap = 9;
    const double group_height = bar * static_cast<double>(chart.series.size()) + gap;
    const double bars_end = top + group_height * static_cast<double>(chart.groups.size());
    const double height = bars_end + 22 + 17 * static_cast<double>((chart.series.size() + 2) / 3);
    double most = 0;
    for (const BarChart::Series& series : chart.series)
        for (const double value : series.values)
            if (std::isfinite(value)) most = std::max(most, value);
    const double scale = most > 0 ? (width - left - right) / most : 0;

    std::string out = open_svg(width, height, chart.title);
    for (std::size_t g = 0; g < chart.groups.size(); ++g) {
        const double y = top + group_height * static_cast<double>(g) + 0.5 * gap;
        out += text_at(left - 8, y + 0.5 * (group_height - gap) + 4, chart.groups[g], "text-anchor=\"end\"");
        for (std::size_t s = 0; s < chart.series.size(); ++s) {
            const BarChart::Series& series = chart.series[s];
            const double value = g < series.values.size() ? series.values[g] : 0;
            if (!(value > 0) || !std::isfinite(value)) continue;
            const double line = y + bar * static_cast<double>(s);
            out += fmt::format("<rect x=\"{}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\" fill=\"{}\"/>\n", left, line,
                               value * scale, bar - 1, color_of(series.color));
            out += text_at(left + value * scale + 4, line + bar - 2, fmt::format("{:.2f}", value), "font-size=\"10\"");
        }
    }
    for (std::size_t s = 0; s < chart.series.size(); ++s) {
        const double x = left + 190 * static_cast<double>(s % 3), y = bars_end + 18 + 17 * static_cast<double>(s / 3);
        out += fmt::format("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n", x, y - 9,
                           color_of(chart.series[s].color));
        out += text_at(x + 14, y, chart.series[s].name, "font-size=\"11\"");
    }
    out += text_at(8, bars_end + 18, chart.unit, "font-size=\"11\"");
    return out + "</svg>\n";
}

} // namespace snell

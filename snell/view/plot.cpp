#include "snell/view/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace snell::view {

ImU32 curve_color(std::size_t number)
{
    constexpr ImU32 colors[] = {IM_COL32(86, 156, 240, 255),  IM_COL32(240, 140, 60, 255),
                                IM_COL32(90, 190, 110, 255),  IM_COL32(225, 90, 110, 255),
                                IM_COL32(165, 120, 220, 255), IM_COL32(150, 150, 150, 255)};
    return colors[number % std::size(colors)];
}

namespace {
// What is shown along an axis: numbers, or their logarithms to base 10.
struct Range
{
    bool is_log = true;
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

    bool has(double value) const { return std::isfinite(value) && (!is_log || value > 0); }
    double place(double value) const { return is_log ? std::log10(value) : value; }
    double value(double part) const
    {
        const double at = low + part * (high - low);
        return is_log ? std::pow(10.0, at) : at;
    }
    void extend(double value)
    {
        low = std::min(low, place(value));
        high = std::max(high, place(value));
    }
    bool is_empty() const { return !(low <= high); }
    // A tenth of a decade of air at least.
    void widen()
    {
        const double least = is_log ? 0.05 : (high > low ? 0.0 : std::max(0.5 * std::abs(high), 1e-6));
        const double air = std::max(least, 0.04 * (high - low));
        low -= air, high += air;
    }
    double part(double value) const { return (place(value) - low) / (high - low); }
};

class Plot
{
  public:
    Plot(ImVec2 corner, ImVec2 size, Range x_range, Range y_range)
        : low(corner.x, corner.y), high(corner.x + size.x, corner.y + size.y), x(x_range), y(y_range),
          list(*ImGui::GetWindowDrawList())
    {
    }

    ImVec2 at(double u, double v) const
    {
        return {low.x + static_cast<float>(x.part(u)) * (high.x - low.x),
                high.y - static_cast<float>(y.part(v)) * (high.y - low.y)};
    }

    void grid() const
    {
        const ImU32 fine = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.15f);
        const ImU32 decade = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.5f);
        const ImU32 text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
        list.AddRect(low, high, decade);
        for_lines(x, [&](double value, bool is_decade, bool has_number) {
            const float px = low.x + static_cast<float>(x.part(value)) * (high.x - low.x);
            list.AddLine({px, low.y}, {px, high.y}, is_decade ? decade : fine);
            if (has_number) list.AddText({px + 2, high.y + 1}, text, fmt::format("{:g}", value).c_str());
        });
        for_lines(y, [&](double value, bool is_decade, bool has_number) {
            const float py = high.y - static_cast<float>(y.part(value)) * (high.y - low.y);
            list.AddLine({low.x, py}, {high.x, py}, is_decade ? decade : fine);
            if (has_number) list.AddText({low.x + 3, py}, text, fmt::format("{:g}", value).c_str());
        });
    }

    void line(const PlotSeries& series) const
    {
        const float scale = ImGui::GetFontSize() / 13.0f;
        bool has_last = false;
        ImVec2 last;
        for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
            if (!x.has(series.x[i]) || !y.has(series.y[i])) continue;
            const ImVec2 p = at(series.x[i], series.y[i]);
            if (has_last && series.is_dashed)
                dashes(last, p, series.color, scale);
            else if (has_last)
                list.AddLine(last, p, series.color, 1.5f * scale);
            if (!series.is_dashed) list.AddCircleFilled(p, 2.0f * scale, series.color);
            last = p, has_last = true;
        }
    }

    const ImVec2 low, high;

  private:
    template <class Draw>
    static void for_lines(const Range& range, const Draw& draw)
    {
        if (!range.is_log) {
            const double raw = (range.high - range.low) / 4, power = std::pow(10.0, std::floor(std::log10(raw)));
            const double step = power * (raw < 2 * power ? 1 : raw < 5 * power ? 2 : 5);
            for (double i = std::ceil(range.low / step); i * step < range.high; ++i)
                draw(i * step + 0.0, i == 0.0, i * step > range.low + 0.02 * (range.high - range.low));
            return;
        }
        const int first = static_cast<int>(std::floor(range.low)), last = static_cast<int>(std::ceil(range.high));
        if (last - first > 40) return;
        const bool is_short = range.high - range.low < 1.5;
        for (int decade = first; decade <= last; ++decade)
            for (int i = 1; i < 10; ++i) {
                const double value = i * std::pow(10.0, decade);
                if (std::log10(value) > range.low && std::log10(value) < range.high)
                    draw(value, i == 1, i == 1 || (is_short && (i == 2 || i == 5)));
            }
    }

    void dashes(ImVec2 a, ImVec2 b, ImU32 color, float scale) const
    {
        const float span = std::hypot(b.x - a.x, b.y - a.y), dash = 5.0f * scale;
        for (float s = 0; s < span; s += 2 * dash) {
            const float u = s / span, v = std::min(s + dash, span) / span;
            list.AddLine({a.x + u * (b.x - a.x), a.y + u * (b.y - a.y)}, {a.x + v * (b.x - a.x), a.y + v * (b.y - a.y)},
                         color, scale);
        }
    }

    const Range x, y;
    ImDrawList& list;
};
} // namespace

static void plot(const char* id, std::span<const PlotSeries> series, const char* x_name, const char* y_name,
                 float height, bool is_log)
{
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size(std::max(ImGui::GetContentRegionAvail().x, 4 * line), height);
    ImGui::InvisibleButton(id, ImVec2(size.x, size.y + 2 * line));
    Range x, y;
    x.is_log = y.is_log = is_log;
    for (const PlotSeries& s : series)
        for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
            if (x.has(s.x[i]) && y.has(s.y[i])) x.extend(s.x[i]), y.extend(s.y[i]);
    if (x.is_empty() || y.is_empty()) return;
    x.widen(), y.widen();
    const Plot plot({corner.x, corner.y + line}, {size.x, size.y - line}, x, y);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddText(corner, ImGui::GetColorU32(ImGuiCol_TextDisabled), y_name);
    const ImVec2 width = ImGui::CalcTextSize(x_name);
    list.AddText({plot.high.x - width.x, plot.high.y + line}, ImGui::GetColorU32(ImGuiCol_TextDisabled), x_name);
    list.PushClipRect(corner, {corner.x + size.x, corner.y + size.y + 2 * line}, true);
    plot.grid();
    for (const PlotSeries& s : series) plot.line(s);
    list.PopClipRect();
    if (!ImGui::IsItemHovered()) return;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const double u = static_cast<double>((mouse.x - plot.low.x) / (plot.high.x - plot.low.x));
    const double v = static_cast<double>((plot.high.y - mouse.y) / (plot.high.y - plot.low.y));
    ImGui::SetTooltip("%s", fmt::format("{}: {:.3g}\n{}: {:.3g}", x_name, x.value(u), y_name, y.value(v)).c_str());
}

void plot_log_log(const char* id, std::span<const PlotSeries> series, const char* x_name, const char* y_name,
                  float height)
{
    plot(id, series, x_name, y_name, height, true);
}

void plot_lines(const char* id, std::span<const PlotSeries> series, const char* x_name, const char* y_name,
                float height)
{
    plot(id, series, x_name, y_name, height, false);
}

} // namespace snell::view

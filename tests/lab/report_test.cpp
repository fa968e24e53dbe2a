// HTML reports: whole, and sufficient unto themselves.
#include "snell/lab/report.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>

namespace snell {
namespace {

// Every tag that is opened is closed, in order. Returns what is wrong.
std::string unbalanced(const std::string& page)
{
    std::vector<std::string> open;
    for (std::size_t at = 0; (at = page.find('<', at)) != std::string::npos; ++at) {
        const std::size_t end = page.find('>', at);
        if (end == std::string::npos) return "a tag without end";
        const std::string tag = page.substr(at + 1, end - at - 1);
        if (tag.starts_with("!") || tag.starts_with("meta") || tag.ends_with("/")) continue;
        std::string name;
        for (const char c : tag) {
            if (c == '/' && name.empty()) continue;
            if (!std::isalnum(static_cast<unsigned char>(c))) break;
            name += c;
        }
        if (!tag.starts_with("/")) {
            open.push_back(name);
            continue;
        }
        if (open.empty() || open.back() != name) return "</" + name + "> closes " + (open.empty() ? "" : open.back());
        open.pop_back();
    }
    return open.empty() ? "" : open.back() + " stays open";
}

void expect_self_contained(const std::string& page)
{
    for (const char* word :
         {"http:", "https:", "//", "src=", "href=", "<script", "<link", "@import", "url(", "<iframe"})
        EXPECT_EQ(page.find(word), std::string::npos) << word;
    EXPECT_EQ(unbalanced(page), "");
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_EQ(page.find("inf"), std::string::npos);
}

std::size_t count_of(const std::string& text, const std::string& word)
{
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++count;
    return count;
}

TEST(Report, IsOneWholePage)
{
    HtmlReport report("title & <more>");
    report.heading("heading");
    report.paragraph("a < b");
    report.table({"", "x"}, {{"row", "1"}, {"<script>alert('x')</script>", "\"2\""}});
    BarChart bars;
    bars.groups = {"one", "two"};
    bars.series = {{"s", {1, 0}, 0}, {"t", {2, 3}, 1}};
    report.chart(bars);
    PointChart points;
    points.x_log = true;
    points.series = {{"s", {{1, 2}, {10, 3}, {100, 5}}, {"<a>"}, true, 0}};
    report.chart(points);
    const std::string page = report.page();
    expect_self_contained(page);
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_NE(page.find("title &amp; &lt;more&gt;"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;alert(&#39;x&#39;)"), std::string::npos);
    EXPECT_EQ(count_of(page, "<svg "), 2u);
    EXPECT_EQ(count_of(page, "<rect "), 3u + 2u) << "three bars, two keys";
    EXPECT_EQ(count_of(page, "<circle "), 3u + 1u) << "three points, one key";
    EXPECT_EQ(count_of(page, "<path "), 1u);
}

TEST(Report, ChartsOfOddValues)
{
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    for (const bool logarithmic : {false, true}) {
        PointChart chart;
        chart.x_log = chart.y_log = logarithmic;
        expect_self_contained(svg(chart));
        chart.series = {{"s", {{nan, 1}, {1, inf}, {0, 0}, {-1, -1}, {5, 5}}, {}, true, -3}};
        const std::string text = svg(chart);
        expect_self_contained(text);
        EXPECT_EQ(count_of(text, "<circle "), logarithmic ? 2u : 4u);
        chart.series = {{"s", {{7, 7}}, {}, true, 3}};
        expect_self_contained(svg(chart));
        chart.series = {{"s", {{1e-300, 1e300}, {1e300, 1e-300}}, {}, true, 3}};
        expect_self_contained(svg(chart));
    }
    BarChart bars;
    expect_self_contained(svg(bars));
    bars.groups = {"a", "b", "c"};
    bars.series = {{"s", {nan, inf}, 99}};
    expect_self_contained(svg(bars));
    EXPECT_EQ(escape_html(std::string("a\x1b\n\x7f") + "b"), "ab");
}

} // namespace
} // namespace snell

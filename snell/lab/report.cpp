#include "snell/lab/report.h"

#include <fmt/format.h>

namespace snell {

static constexpr const char* style =
    "body { font-family: sans-serif; max-width: 1150px; margin: 2em auto; padding: 0 1em; color: #222; }\n"
    "table { border-collapse: collapse; font-size: 13px; margin: 1em 0; }\n"
    "th, td { padding: 3px 9px; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }\n"
    "th:first-child, td:first-child { text-align: left; }\n"
    "th { border-bottom: 2px solid #888; }\n"
    "svg { display: block; margin: 1em 0; max-width: 100%; height: auto; }\n"
    "p { max-width: 55em; line-height: 1.4; }\n";

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::heading(const std::string& text)
{
    body_ += fmt::format("<h2>{}</h2>\n", escape_html(text));
}

void HtmlReport::paragraph(const std::string& text)
{
    body_ += fmt::format("<p>{}</p>\n", escape_html(text));
}

void HtmlReport::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows)
{
    body_ += "<table>\n<tr>";
    for (const std::string& cell : header) body_ += fmt::format("<th>{}</th>", escape_html(cell));
    body_ += "</tr>\n";
    for (const std::vector<std::string>& row : rows) {
        body_ += "<tr>";
        for (const std::string& cell : row) body_ += fmt::format("<td>{}</td>", escape_html(cell));
        body_ += "</tr>\n";
    }
    body_ += "</table>\n";
}

void HtmlReport::chart(const PointChart& chart)
{
    body_ += svg(chart);
}

void HtmlReport::chart(const BarChart& chart)
{
    body_ += svg(chart);
}

std::string HtmlReport::page() const
{
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n"
                       "<style>\n{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n</html>\n",
                       escape_html(title_), style, body_);
}

} // namespace snell

// Reports: one HTML file each that needs nothing else, neither scripts nor anything from elsewhere.
#pragma once

#include "snell/lab/report_chart.h"

#include <string>
#include <vector>

namespace snell {

// Takes its parts in the order in which they are to appear. All text is escaped.
class HtmlReport
{
  public:
    explicit HtmlReport(std::string title);

    void heading(const std::string& text);
    void paragraph(const std::string& text);
    // The first column is text, the others are numbers and stand on the right. Rows may be shorter than the header.
    void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
    void chart(const PointChart& chart);
    void chart(const BarChart& chart);

    std::string page() const; // the whole file

  private:
    std::string title_, body_;
};

} // namespace snell

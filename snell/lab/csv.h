// Tables as comma-separated values (RFC 4180).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace snell {

class CsvTable
{
  public:
    using Cell = std::variant<std::string, double>;

    explicit CsvTable(std::vector<std::string> columns);
    // As many cells as there are columns: else a failed check. Numbers are written so that reading them gives the same
    // double; what is not finite becomes an empty cell.
    void row(const std::vector<Cell>& cells);
    std::size_t rows() const { return rows_; }
    const std::string& text() const { return text_; } // lines end with \n

  private:
    std::size_t columns_, rows_ = 0;
    std::string text_;
};

} // namespace snell

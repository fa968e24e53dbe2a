#include "snell/lab/csv.h"

#include "snell/core/error.h"

#include <cmath>

namespace snell {

static std::string quoted(std::string_view text)
{
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

CsvTable::CsvTable(std::vector<std::string> columns) : columns_(columns.size())
{
    std::vector<Cell> names;
    for (std::string& name : columns) names.emplace_back(std::move(name));
    row(names);
    rows_ = 0;
}

void CsvTable::row(const std::vector<Cell>& cells)
{
    SNELL_CHECK_EQ(cells.size(), columns_);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (i > 0) text_ += ',';
        if (const auto* text = std::get_if<std::string>(&cells[i]))
            text_ += quoted(*text);
        else if (const double value = std::get<double>(cells[i]); std::isfinite(value))
            text_ += fmt::format("{}", value);
    }
    text_ += '\n';
    rows_ += 1;
}

} // namespace snell

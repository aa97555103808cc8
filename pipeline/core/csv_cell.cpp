#include "core/csv_cell.h"

namespace runcert {
namespace {

/// The characters that make a spreadsheet take a cell for a formula.
constexpr std::string_view formula_begins = "=+-@\t\r";

}  // namespace

std::string csv_cell(std::string_view text) {
    std::string cell;
    if (!text.empty() && formula_begins.find(text.front()) != std::string_view::npos) cell = "'";
    cell += text;
    if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
    std::string quoted = "\"";
    for (const char c : cell)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace runcert

#include "core/text.h"
#include "files/ecsv.h"
#include "stages/export/export.h"

namespace runcert {
namespace {

/// The characters that make a spreadsheet take a cell for a formula (OWASP, "CSV Injection").
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

std::string csv_text(std::string_view table, const std::string& where) {
    EcsvReader reader(table, where);
    const std::vector<EcsvColumn>& columns = reader.columns();
    std::string csv;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (i > 0) csv += ',';
        csv += csv_cell(columns[i].name);
    }
    csv += '\n';
    while (reader.next_row()) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (i > 0) csv += ',';
            if (reader.is_missing(i)) continue;
            const std::string& text = reader.text(i);
            csv += columns[i].type == CellType::text ? csv_cell(text) : text;
        }
        csv += '\n';
    }
    return csv;
}

}  // namespace runcert

#include "core/text.h"
#include "files/ecsv.h"
#include "reports/export/export.h"

namespace runcert {

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

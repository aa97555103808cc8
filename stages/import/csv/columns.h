#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/import/csv/layout.h"
#include "stages/import/recording.h"

namespace runcert::csv {

/// A table that no format recognises: its head, and the first of its rows.
struct SeenTable {
    Head head;
    std::vector<std::vector<Cell>> rows;  ///< one at least
    bool has_names = true;                ///< else the head's names are those of the first row

    /// The text of a column, counted from 0, in the first row that has any.
    std::string_view first(std::size_t column) const;
};

/// Finds a header line with rows under it, or rows alone. Nothing for a text that is no table.
std::optional<SeenTable> find_table(const RecordingBytes& recording);

/// Which column may hold what, by the names of the header line, where what the column holds can be
/// that; without names by what the columns hold. Of coordinates one kind: geodetic, else
/// Earth-centred, else of a plane. What is `given` counts before that. Failure for a name or number
/// that the table does not have.
Layout find_columns(const SeenTable& table, const CsvColumns& given = {});

/// The frame of those coordinates; for a plane utm where they are as large as those of a UTM grid.
CoordinateFrame frame_of(const SeenTable& table, const Layout& layout);

/// Whether a number of the table's rows is written with a decimal comma.
bool has_decimal_commas(const SeenTable& table, std::size_t column);

}  // namespace runcert::csv

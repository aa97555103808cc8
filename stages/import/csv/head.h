#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"

namespace runcert::csv {

/// What may stand between the fields of a table, and its word in an attempt.
struct Delimiter {
    char character;
    std::string_view word;
};

/// In the order in which they are looked for.
std::span<const Delimiter> delimiters();

/// The delimiter of a line of a table: the first one of which any stands outside quotation marks; a
/// comma where none does.
char find_delimiter(std::string_view line);

/// Splits a line. Blanks around a field are not part of it. A field may stand in quotation marks,
/// and then hold the delimiter; "" inside stays as it is. Failure on a quotation mark that is not
/// closed, or that something follows; but what RaceCapture has there behind |, unit and range, is
/// passed over.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording, char delimiter);

/// The lines of a table above its first row.
struct Head {
    char delimiter = ',';
    std::vector<Cell> names;  ///< of the header line; the first row's cells where there is none
    std::int64_t line = 0;    ///< theirs
    /// Between header and first row: units, sources.
    std::vector<std::vector<Cell>> under;
    std::int64_t first_row = 0;    ///< its line, or one that no row stands before
    std::int64_t passed_over = 0;  ///< lines above, but for comments and empty ones
    /// Columns, counted from 0, whose angles stand in three fields: degrees, minutes, seconds.
    std::vector<std::size_t> in_three;

    /// The cells of a row, one to each name: three fields of an angle are one.
    std::vector<Cell> row(const SourceLine& line, const RecordingBytes& recording) const;
};

/// Finds the columns that stand in three fields: of a table by blanks whose rows have four more
/// than it has names, latitude and longitude. `cells`: those of a row.
void find_in_three(Head& head, std::span<const Cell> cells);

/// Whether a line (# begins a comment) is no part of a table.
bool is_skipped(const SourceLine& line);

/// Whether a line, or the text of a comment, is what is looked for.
using IsHead = std::function<bool(std::span<const Cell> cells, bool comment)>;

/// The first line, among so many as a head may have, whose cells `is_it` holds for, with nothing
/// under it yet. Nothing where there is none.
std::optional<Head> find_head(const RecordingBytes& recording, std::optional<char> delimiter,
                              const IsHead& is_it);

/// Takes what stands under the header and is no row: at most four lines that hold no number in any
/// of these columns, the first of them that of the time. Counted from 0.
void take_lines_under(Head& head, const RecordingBytes& recording,
                      std::span<const std::size_t> columns);

/// Gives the cells of each row to `look`, until it returns true. Rows whose quotation marks do not
/// pair are passed over.
void visit_rows(const Head& head, const RecordingBytes& recording,
                const std::function<bool(std::span<const Cell> cells)>& look);

/// The text of a column, counted from 0, in the first row; empty where there is none.
std::string_view in_first_row(const Head& head, std::size_t column,
                              const RecordingBytes& recording);

}  // namespace runcert::csv

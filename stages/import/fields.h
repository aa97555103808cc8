#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"

// Rows of tables whose header says which column is what.

namespace runcert {

/// The fields of a line, with what blanks they have, between each two of which one separator
/// stands.
std::vector<Cell> split_at(const SourceLine& line, const RecordingBytes& recording, char separator);

/// Splits a text of a line at blanks, and at most one separator between each two fields; NUL where
/// only blanks stand between them. Two separators in a row fail: a field is missing there.
std::vector<Cell> split_words(const SourceLine& line, std::string_view text,
                              const RecordingBytes& recording, char separator = '\0',
                              std::string_view blanks = " \t");

/// Failure for a row that has another number of fields than its header: "the line has 3 fields; its
/// header names 4", where `header_has` is "its header names". `last`: a short one is cut off,
/// because nothing follows it.
void require_count(std::size_t count, std::size_t expected, const SourceLine& line,
                   const RecordingBytes& recording, bool last, std::string_view header_has,
                   const std::string& remedy);

/// Where in a row the columns stand, counted in fields from 0. The last of `Column` is `count`.
template <class Column>
struct ColumnPlaces {
    std::size_t fields = 0;  ///< in a row
    std::array<std::optional<std::size_t>, static_cast<std::size_t>(Column::count)> place;

    const std::optional<std::size_t>& operator[](Column column) const {
        return place[static_cast<std::size_t>(column)];
    }
    std::optional<std::size_t>& operator[](Column column) {
        return place[static_cast<std::size_t>(column)];
    }
};

/// The fields of one row, as many as its header has, by column. Both must outlive this.
template <class Column>
class RowCells {
  public:
    RowCells(std::span<const Cell> cells, const ColumnPlaces<Column>& places)
        : cells_(cells), places_(places) {}

    bool has(Column column) const { return places_[column].has_value(); }
    /// The field of a column that is there, or one behind it.
    const Cell& cell(Column column, std::size_t behind = 0) const {
        return cells_[*places_[column] + behind];
    }
    /// Empty where there is no such column.
    std::string_view text(Column column) const { return has(column) ? cell(column).text : ""; }
    double real(Column column, std::string_view meaning) const {
        return read_real(cell(column), meaning);
    }

  private:
    std::span<const Cell> cells_;
    const ColumnPlaces<Column>& places_;
};

}  // namespace runcert

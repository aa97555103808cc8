#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

// Rows of tables whose header says which column is what.
namespace runcert {

/// A piece of a recording's text, and where it stands.
struct Cell {
    std::string_view text;
    const RecordingBytes* recording = nullptr;
    std::int64_t line = 0;
    std::size_t column = 1;  ///< byte in the line, counted from 1

    /// "file:line:column".
    std::string place() const;
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;
};

/// "file:line:column" of a recording.
std::string place_in(const RecordingBytes& recording, std::int64_t line, std::size_t column);

/// The number of exactly `size` digits, at most nine, at `at`; nothing where they are not there.
std::optional<int> digits_at(std::string_view text, std::size_t at, std::size_t size);

// Each of these takes the whole text for its value, and fails at the cell otherwise; `meaning`
// ("height") says in the message what was looked for.

/// A finite decimal number. A decimal comma, nan and inf are refused in words of their own.
double read_real(const Cell& cell, std::string_view meaning);

/// A whole number from `least` to `most`, which may be printed as "7.0000000".
std::int64_t read_whole(const Cell& cell, std::string_view meaning, std::int64_t least,
                        std::int64_t most);

/// A standard deviation, in metres or metres a second; 0 where the recording writes 0, which means
/// that it is unknown. A negative one, or one above 1e9, fails.
double read_deviation(const Cell& cell, std::string_view meaning);

/// Seconds with at most nine decimals, as an exact count of nanoseconds; milliseconds where `shift`
/// is 3: that many more digits are decimals.
std::int64_t read_nanoseconds(const Cell& cell, std::string_view meaning, int shift = 0);

/// The fix type of RTKLIB's number Q, 0 to 7, which may be printed as "1.0000000".
/// Failure at the cell for any other text.
FixType read_rtklib_quality(const Cell& cell);

/// A count of satellites, 0 to 1000. Failure at the cell for anything else.
std::int16_t read_satellites(const Cell& cell);

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

#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/yaml_node.h"

// ECSV 1.0 (Astropy Proposal for Enhancement 6), a strict subset: delimiter comma, the types
// bool, int64, float64 and string, ASCII, every header line "# " and one line of one YAML
// document. Missing cells are empty. Lines may end in CR LF. Everything else is a Failure with
// line and column.

namespace runcert {

enum class CellType { boolean, integer, real, text };

/// The ECSV name of a type ("bool", "int64", "float64", "string").
std::string_view ecsv_name(CellType type);

struct EcsvColumn {
    std::string name;
    CellType type = CellType::real;
    std::string unit;         ///< astropy's spelling; empty for none
    int decimals = 0;         ///< digits after the point of a real column
    std::string description;  ///< one line
};

/// Writes one table, cell by cell in column order.
class EcsvWriter {
  public:
    /// Takes the table's text, piece by piece in order.
    using Sink = std::function<void(std::string_view piece)>;

    /// `meta` becomes the header's `meta`; null for none. Text that is not ASCII is written with
    /// YAML escapes. Into memory, for take(), where there is no `sink`.
    EcsvWriter(std::vector<EcsvColumn> columns, const nlohmann::ordered_json& meta, Sink sink = {});

    void boolean(bool value);
    void integer(std::int64_t value);
    /// Fixed decimals as the column says, the same in every locale. Not finite: Failure.
    void real(double value);
    /// A count of nanoseconds, written exactly as seconds with nine decimals.
    void seconds(std::int64_t nanoseconds);
    /// Printable ASCII, not empty (an empty cell means missing), no blank at either end (astropy
    /// takes it off, quoted or not); else Failure.
    void text(std::string_view value);
    void missing();

    /// Gives the sink what it has not yet. Every row must be complete.
    void finish();
    /// The whole file, where there is no sink. Every row must be complete.
    std::string take() &&;

  private:
    const EcsvColumn& begin_cell();
    void put(std::string_view text);
    void scaled(std::int64_t value, int decimals);
    void flush();

    std::vector<EcsvColumn> columns_;
    Sink sink_;
    std::string whole_;         ///< where there is no sink
    std::vector<char> buffer_;  ///< what the sink or `whole_` has not yet
    std::size_t used_ = 0;
    std::size_t column_ = 0;
};

/// Reads one table from memory, row by row.
class EcsvReader {
  public:
    /// Parses the header. `text` must outlive the reader; `where` is the file's name for messages.
    EcsvReader(std::string_view text, std::string where);

    const std::vector<EcsvColumn>& columns() const { return columns_; }
    const YamlNode& meta() const { return meta_; }
    const std::string& where() const { return where_; }

    /// Steps to the next row and splits it; false at the end of the file.
    bool next_row();
    /// How many bytes of the text were read: up to the end of the current row.
    std::size_t offset() const { return offset_; }
    /// The line, counted from 1, of the current row.
    std::size_t line() const { return line_; }

    bool is_missing(std::size_t column) const { return cells_[column].text.empty(); }
    /// The value of a cell. A missing cell, or text that is not of that type, is a Failure that
    /// names line, column of text and name of the column.
    bool boolean(std::size_t column) const;
    std::int64_t integer(std::size_t column) const;
    double real(std::size_t column) const;
    /// Seconds with at most nine decimals, as an exact count of nanoseconds.
    std::int64_t seconds(std::size_t column) const;
    std::string text(std::size_t column) const { return std::string(word(column)); }
    /// The same, which holds until the next row.
    std::string_view word(std::size_t column) const { return present(column).text; }
    [[noreturn]] void fail(std::size_t column, const std::string& what,
                           const std::string& remedy) const;

  private:
    struct Cell {
        std::string_view text;
        std::size_t position = 1;  ///< column of its first character, from 1
    };
    void read_header();
    void read_column(const YamlNode& node, std::size_t index);
    void check_names(std::string_view line);
    std::optional<std::string_view> next_line();
    bool split_plain_row();
    bool split_any_row();
    void split(std::string_view line);
    std::size_t split_quoted(std::string_view line, std::size_t at, std::string& text);
    const Cell& present(std::size_t column) const;
    template <class Parse>
    auto parsed(std::size_t column, Parse parse, std::string_view meaning) const;
    [[noreturn]] void fail_at(std::size_t line, std::size_t position, const std::string& what,
                              const std::string& remedy) const;

    std::string_view text_;
    std::string where_;
    std::vector<EcsvColumn> columns_;
    YamlNode meta_;
    std::vector<Cell> cells_;
    std::deque<std::string> unquoted_;  ///< of the current row: what its quoted cells hold
    std::size_t cell_count_ = 0;
    std::size_t offset_ = 0;
    std::size_t line_ = 0;
};

}  // namespace runcert

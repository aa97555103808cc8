#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/failure.h"
#include "core/optional_number.h"
#include "core/satellite.h"
#include "schemas/common/document.h"
#include "schemas/common/header.h"
#include "store/ecsv.h"

namespace runcert {

/// Seconds from the recording's first epoch, exact.
struct ElapsedTime {
    std::int64_t nanoseconds = 0;
    double seconds() const { return static_cast<double>(nanoseconds) * 1e-9; }
    friend auto operator<=>(const ElapsedTime&, const ElapsedTime&) = default;
};

/// The field table of a tabular product: its columns, and the fields of its `meta`.
class TableSchema {
  public:
    /// Reads a parsed field table (compiled into the program).
    static TableSchema read(const YamlNode& table, const std::string& where);

    const DocumentSchema& meta() const { return meta_; }
    const std::vector<EcsvColumn>& columns() const { return columns_; }

    /// Checks a table's header against this schema. Returns, for each column of the schema, its
    /// index in the table. Failure for a column that is missing, unknown, or of another type or
    /// unit.
    std::vector<std::size_t> match(const EcsvReader& reader) const;

    /// Starts a table with this header. Sets its `schema` and rounds its numbers.
    EcsvWriter begin(OpaqueJson meta, EcsvWriter::Sink sink) const;

  private:
    DocumentSchema meta_;
    std::vector<EcsvColumn> columns_;
};

namespace cell {

inline void write(EcsvWriter& out, double value) {
    out.real(value);
}
template <std::signed_integral Integer>
void write(EcsvWriter& out, Integer value) {
    out.integer(value);
}
inline void write(EcsvWriter& out, bool value) {
    out.boolean(value);
}
inline void write(EcsvWriter& out, ElapsedTime value) {
    out.seconds(value.nanoseconds);
}
/// A satellite ("G02") or a signal ("1C").
template <class Code>
requires requires(Code code) {
    letters_of(code);
}
void write(EcsvWriter& out, Code value) {
    const auto letters = letters_of(value);
    out.text({letters.data(), letters.size()});
}
template <class Enum>
requires std::is_enum_v<Enum>
void write(EcsvWriter& out, Enum value) {
    out.text(to_text(value));
}
/// What may be missing: std::optional, OptionalNumber.
template <template <class> class Maybe, class T>
void write(EcsvWriter& out, const Maybe<T>& value) {
    if (value)
        write(out, *value);
    else
        out.missing();
}

inline void read(const EcsvReader& in, std::size_t column, double& value) {
    value = in.real(column);
}
inline void read(const EcsvReader& in, std::size_t column, std::int64_t& value) {
    value = in.integer(column);
}
template <std::signed_integral Integer>
void read(const EcsvReader& in, std::size_t column, Integer& value) {
    const std::int64_t whole = in.integer(column);
    if (whole <= std::numeric_limits<Integer>::lowest() ||
        whole > std::numeric_limits<Integer>::max())
        in.fail(column, "the whole number is too large", take_the_original);
    value = static_cast<Integer>(whole);
}
inline void read(const EcsvReader& in, std::size_t column, bool& value) {
    value = in.boolean(column);
}
inline void read(const EcsvReader& in, std::size_t column, ElapsedTime& value) {
    value.nanoseconds = in.seconds(column);
}
template <class Word>
requires requires(Word word) {
    from_text(std::string_view(), word);
}
void read(const EcsvReader& in, std::size_t column, Word& value) {
    if (!from_text(in.word(column), value))
        in.fail(column, "\"" + in.text(column) + "\" is not one of the known words",
                take_the_original);
}
template <template <class> class Maybe, class T>
void read(const EcsvReader& in, std::size_t column, Maybe<T>& value) {
    value.reset();
    if (in.is_missing(column)) return;
    T present{};
    read(in, column, present);
    value = present;
}

}  // namespace cell

/// Binds a column to a member of a row. An enumeration needs `to_text(Enum)` and
/// `bool from_text(std::string_view, Enum&)`.
template <class Row>
struct ColumnBinding {
    std::string name;
    void (*write)(EcsvWriter&, const Row&);
    void (*read)(const EcsvReader&, std::size_t, Row&);
};

/// `Path` leads to a member of the row, or through one that is a struct to a member of that.
template <class Row, auto... Path>
ColumnBinding<Row> column(std::string name) {
    return {std::move(name),
            [](EcsvWriter& out, const Row& row) { cell::write(out, (row.*....*Path)); },
            [](const EcsvReader& in, std::size_t index, Row& row) {
                cell::read(in, index, (row.*....*Path));
            }};
}

template <class Row>
class TableFormat;

/// Reads a table row by row, in constant memory.
template <class Row>
class RowReader {
  public:
    /// Reads and checks the header. `format` and `text` must outlive the reader; `where` names the
    /// file in messages.
    RowReader(const TableFormat<Row>& format, std::string_view text, const std::string& where)
        : reader_(text, where) {
        const std::vector<std::size_t> index = format.schema().match(reader_);
        for (std::size_t i = 0; i < index.size(); ++i)
            cells_.push_back({format.bindings()[i].read, index[i]});
    }

    YamlValue meta() const { return YamlValue(reader_.meta(), reader_.where()); }

    /// Reads the next row into `row`. At the end it returns false and leaves `row` unchanged.
    bool next(Row& row) {
        if (!reader_.next_row()) return false;
        for (const Cell& each : cells_)
            each.read(reader_, each.column, row);
        return true;
    }

    /// Number of bytes of the text read so far.
    std::size_t offset() const { return reader_.offset(); }

  private:
    struct Cell {
        void (*read)(const EcsvReader&, std::size_t, Row&);
        std::size_t column;
    };
    EcsvReader reader_;
    std::vector<Cell> cells_;
};

/// A table read row by row: everything but the rows, and their reader.
template <class Table>
struct OpenTable {
    using Row = typename decltype(Table::rows)::value_type;
    Table head;
    RowReader<Row> rows;
};

/// A schema with the struct of its rows.
template <class Row>
class TableFormat {
  public:
    /// The bindings must name every column of the schema, in its order. Failure
    /// otherwise.
    TableFormat(const YamlNode& table, const std::string& where,
                std::vector<ColumnBinding<Row>> bindings)
        : schema_(TableSchema::read(table, where)), bindings_(std::move(bindings)) {
        bool equal = bindings_.size() == schema_.columns().size();
        for (std::size_t i = 0; equal && i < bindings_.size(); ++i)
            equal = bindings_[i].name == schema_.columns()[i].name;
        if (!equal)
            throw Failure(where, "the struct of the rows does not follow the field table",
                          "This is a fault of the program; please report it");
    }

    const TableSchema& schema() const { return schema_; }

    const std::vector<ColumnBinding<Row>>& bindings() const { return bindings_; }

    /// The table's text. Sets `schema` in the meta and rounds its numbers.
    std::string write(OpaqueJson meta, std::span<const Row> rows) const {
        EcsvWriter out = begin(std::move(meta));
        for (const Row& row : rows)
            write_row(out, row);
        return std::move(out).take();
    }

    /// Starts a table to be written row by row. The header goes to the sink.
    EcsvWriter begin(OpaqueJson meta, EcsvWriter::Sink sink = {}) const {
        return schema_.begin(std::move(meta), std::move(sink));
    }
    void write_row(EcsvWriter& out, const Row& row) const {
        for (const ColumnBinding<Row>& binding : bindings_)
            binding.write(out, row);
    }

    /// A table that was read: its `meta` and its rows. In `read`, `where` names the file in
    /// messages.
    struct Contents {
        YamlValue meta;
        std::vector<Row> rows;
    };
    Contents read(std::string_view text, const std::string& where) const {
        RowReader<Row> reader(*this, text, where);
        Contents contents{reader.meta(), {}};
        // Reserves room for all rows at once, because growing would hold them twice. A row has one
        // line, and at least as many bytes as columns.
        const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
        contents.rows.reserve(std::min(lines, text.size() / schema_.columns().size()));
        while (reader.next(contents.rows.emplace_back())) {
        }
        contents.rows.pop_back();
        return contents;
    }

  private:
    TableSchema schema_;
    std::vector<ColumnBinding<Row>> bindings_;
};

/// Writes a table row by row, in constant memory.
template <class Row>
class TableWriter {
  public:
    TableWriter(const TableFormat<Row>& format, EcsvWriter out)
        : format_(&format), out_(std::move(out)) {}
    void write(const Row& row) { format_->write_row(out_, row); }
    /// Passes the remaining text to the sink.
    void finish() { out_.finish(); }

  private:
    const TableFormat<Row>* format_;
    EcsvWriter out_;
};

}  // namespace runcert

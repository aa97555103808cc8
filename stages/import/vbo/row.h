#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "stages/import/cell.h"
#include "stages/import/finish.h"
#include "stages/import/vbo/header.h"

namespace runcert::vbo {

/// The fields of a row of data that are read, by column.
class RowFields {
  public:
    RowFields(const SourceLine& line, const RecordingBytes& recording, const Layout& layout);

    /// Fields in the line.
    std::size_t count() const { return count_; }
    /// Empty where the row has no such column.
    std::string_view text(Column column) const { return texts_[static_cast<std::size_t>(column)]; }
    Cell cell(Column column) const;
    double real(Column column, std::string_view meaning) const {
        return read_real(cell(column), meaning);
    }

  private:
    const SourceLine& line_;
    const RecordingBytes& recording_;
    std::array<std::string_view, column_count> texts_;
    std::size_t count_ = 0;
};

/// Nanoseconds since midnight of a time of day, "062345.04", with or without its leading zeros, or
/// "06:23:45.04"; nothing for any other text. Second 60 at the end of the day only.
std::optional<std::int64_t> time_of_day_ns(std::string_view text);

/// What a row says, but its time. `east_positive`: which way longitudes count. Failure at the
/// field that cannot be read. `last`: no line follows.
TimedRow read_row(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                  const RowFields& fields, bool east_positive, bool last);

}  // namespace runcert::vbo

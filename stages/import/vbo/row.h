#pragma once

#include <optional>
#include <string_view>

#include "stages/import/row_collector.h"
#include "stages/import/vbo/header.h"

namespace runcert::vbo {

using Row = RowCells<Column>;

/// Nanoseconds since midnight of a time of day, "062345.04", with or without its leading zeros, or
/// "06:23:45.04"; nothing for any other text. Second 60 at the end of the day only.
std::optional<std::int64_t> time_of_day_ns(std::string_view text);

/// What a row says, but its time. `east_positive`: which way longitudes count. Failure at the
/// field that cannot be read.
TimedRow read_row(const Row& fields, const Layout& layout, bool east_positive);

}  // namespace runcert::vbo

#pragma once

#include <cstddef>

#include "stages/import/fields.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert::flysight {

/// The columns that are read. All but gpsFix are in every file.
enum class Column {
    time,
    latitude,
    longitude,
    height,
    velocity_north,
    velocity_east,
    velocity_down,
    horizontal_accuracy,
    vertical_accuracy,
    speed_accuracy,
    satellites,
    fix,
    count
};

using Layout = ColumnPlaces<Column>;

/// The layout that a header line names, whose first `skipped` fields are no columns ("$COL,GNSS").
/// `skipped_in_rows` fields stand before the columns in a row. Columns of other names are passed
/// over. Failure where one that must be there is missing or stands twice.
Layout read_columns(const SourceLine& line, const RecordingBytes& recording, std::size_t skipped,
                    std::size_t skipped_in_rows);

/// Failure where the line of units, its first `skipped` fields left out, gives a column another
/// unit than FlySight does.
void require_units(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                   std::size_t skipped, std::size_t skipped_in_rows);

/// The row of a line. Failure at the field that cannot be read. `last`: no line follows.
TimedRow read_row(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                  bool last);

}  // namespace runcert::flysight

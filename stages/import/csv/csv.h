#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/csv/layout.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

/// Tables of delimited text, whose columns the attempt names (`columns`, `frame`, `time_format`).
namespace runcert::csv {

/// Whether the text looks like a table of delimited values; which column is what, no content
/// says.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Failure with line and
/// column on everything that is not understood, and at the receiver's place in the attempt where
/// the description does not fit.
///
/// UTM: `sigma_east`, `sigma_north` are taken along the grid's axes and in grid metres; they are
/// divided by the point scale and turned by the meridian convergence. Velocities are taken towards
/// true east and north, in metres a second on the ground, as receivers give them.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

using TakeCells = std::function<void(const SourceLine& line, std::span<const Cell> cells)>;

/// Gives the cells of each row to `take`, as many as the header has. A Failure of it, or another
/// number of cells, counts as a bad record.
void for_each_row(const Layout& layout, const RecordingBytes& recording, RowCollector& timed,
                  const TakeCells& take);

/// A table's rows as observations in the format of that name, with the notes of description and
/// layout; the header is left for the caller.
Observations observations_of_table(const Receiver& receiver, const Description& description,
                                   const Layout& layout, RowCollector timed,
                                   const RecordingBytes& recording, std::string_view format);

/// Whether the row holds a new fix; false where the column for that says 0. Failure at any other
/// text.
bool is_new_fix(std::span<const Cell> fields, const Layout& layout);

/// Whether the row's own column says that its position was made up (a telephone's mock location).
bool is_mock(std::span<const Cell> fields, const Layout& layout);

/// Whether the row holds other sensors' values alone, in a table where most rows do.
bool is_other_sensors(std::span<const Cell> fields, const Layout& layout);

/// Reads the fields of a row, as many as the layout says. A row with an empty coordinate has no
/// position.
TimedRow read_row(std::span<const Cell> fields, const Layout& layout,
                  const Description& description, const Receiver& receiver);

/// Reads the velocity, position and accuracy of a row into one whose time, fix type and satellites
/// are known. A row with an empty coordinate has no position.
void read_solution(std::span<const Cell> fields, const Layout& layout,
                   const Description& description, const Receiver& receiver, TimedRow& row);

/// A row of a table, and where it stands.
struct PlacedRow {
    TimedRow row;
    RecordPlace place;
};

/// Takes out the rows that a program put between fixes, on the straight line between them in
/// latitude, longitude, height and speed, to the last decimal that is written: they were not
/// measured. A row that lies so by chance and whole intervals of the fixes from the one before
/// stays. The rows' order is that of the recording.
///
/// Returns how many were taken out.
std::size_t remove_interpolated(std::vector<PlacedRow>& rows);

}  // namespace runcert::csv

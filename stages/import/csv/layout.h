#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/csv/head.h"
#include "stages/import/fields/angle.h"
#include "stages/import/fields/column.h"
#include "stages/import/fields/date_time.h"

namespace runcert::csv {

/// The three columns of a position in a frame, the one of heights last.
std::span<const Column> position_columns(CoordinateFrame frame);

enum class TimeFormat { seconds, seconds_of_week, unix, iso, time_of_day };

/// What the attempt says of a table, checked: every column it names is of use, and none that is
/// needed is missing.
struct Description {
    CoordinateFrame frame = CoordinateFrame::geodetic;
    TimeFormat time_format = TimeFormat::seconds;
    Clock clock = Clock::gps;
    std::optional<char> delimiter;            ///< empty: to be found
    std::optional<double> constant_height_m;  ///< where geodetic coordinates have no heights
    bool has_up = false;                      ///< a height or third plane coordinate is recorded
    std::optional<Unit> speed_unit;           ///< of speeds and velocities, where it is stated
    bool between_fixes = false;  ///< rows between fixes are interpolated, satellite counts too
    /// Of counts of time: so many more digits are decimals (3: milliseconds).
    int time_shift = 0;
    std::optional<DateOrder> date_order;  ///< of dates and times that are not ISO 8601
    std::optional<DayCountKind> days;     ///< where times are counts of days
    /// Of times of day that no column has a date for: the UTC date of the first row.
    std::string start_date;
};

/// Failure at the receiver's place in the attempt.
Description describe(const Receiver& receiver);

/// Where in a table the columns are, and what their numbers are in.
struct Layout : ColumnPlaces<Column> {
    Layout() { factor.fill(1.0); }

    Head head;
    /// Of each column's numbers, in metres or metres a second.
    std::array<double, static_cast<std::size_t>(Column::count)> factor{};
    /// Standard deviations so large, as they are written, say that a receiver has no idea.
    double unknown_from = std::numeric_limits<double>::infinity();
    bool both_in_one = false;  ///< one column holds latitude, then longitude
    AngleForm angles = AngleForm::degrees;
    /// Most rows hold other sensors' values and no position: they are no epochs.
    bool between_sensors = false;
    std::vector<std::string> notes;  ///< on what was passed over, and on units
};

/// Finds the header line and reads it: the first line that has all the names that the attempt gives
/// to columns. Where it gives numbers alone, the table begins with the first line whose time is a
/// number or begins with a digit. Failure on a name that is not there or there twice, on a number
/// beyond the last column, and on a unit that contradicts the attempt or is not read.
Layout read_layout(const Receiver& receiver, const Description& description,
                   const RecordingBytes& recording);

/// The columns' units, by the header's names, by a line of units under it, and by the attempt.
void set_units(Layout& layout, const Description& description, const Receiver& receiver);

/// The unit of that quantity that header and lines under it give a column; nothing where they do
/// not. `by_last_words`: also the last words of its name ("speed_kmh").
std::optional<Unit> unit_of_column(const Head& head, std::size_t column, Quantity quantity,
                                   bool by_last_words = true);

using Rows = std::vector<std::vector<Cell>>;

/// What the first rows show beside the columns that are named: hemispheres and milliseconds in
/// columns of their own, how angles are written, rows of other sensors.
void find_beside(Layout& layout, const Description& description, const Rows& rows);

/// The same of the first rows of a recording; notes what was found. Failure where latitude is named
/// for longitude.
void find_beside(Layout& layout, const Description& description, const RecordingBytes& recording);

/// Finds how the rows write their times: the unit of counts, and the order of dates that are not
/// ISO 8601. Failure where that order shows neither in the dates nor in the attempt's start_date.
void settle_times(Layout& layout, Description& description, const Receiver& receiver,
                  const RecordingBytes& recording);

/// The dates that the first row's may be, as the attempt writes them, where its order shows neither
/// in the dates nor elsewhere; none where it does. Failures as of describe and read_layout.
std::vector<std::string> dates_in_doubt(const Receiver& receiver, const RecordingBytes& recording);

/// Notes what of the head was passed over.
void note_head(Layout& layout);

}  // namespace runcert::csv

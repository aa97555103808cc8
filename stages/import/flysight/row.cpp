#include "stages/import/flysight/row.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/fix.h"

namespace runcert::flysight {
namespace {

constexpr auto column_count = static_cast<std::size_t>(Column::count);

struct ColumnName {
    std::string_view name;
    std::string_view unit;
};

/// In the order of Column.
constexpr std::array<ColumnName, column_count> column_names{{{"time", ""},
                                                             {"lat", "deg"},
                                                             {"lon", "deg"},
                                                             {"hMSL", "m"},
                                                             {"velN", "m/s"},
                                                             {"velE", "m/s"},
                                                             {"velD", "m/s"},
                                                             {"hAcc", "m"},
                                                             {"vAcc", "m"},
                                                             {"sAcc", "m/s"},
                                                             {"numSV", ""},
                                                             {"gpsFix", ""}}};

constexpr std::int64_t ns_per_ms = 1'000'000;

/// What a receiver writes where it has no idea: the largest count of millimetres.
constexpr double saturated = 4'294'967.0;

/// How loggers that write FlySight's columns (Deep and Steep Insight) label a speed's accuracy.
bool is_speed_in_metres(std::size_t column, std::string_view unit) {
    return static_cast<Column>(column) == Column::speed_accuracy && unit == "m";
}

/// The whole second and the signed milliseconds of a FlySight 2's time "2026-03-06T00:49:20.-002Z";
/// nothing for any other time. The instant is their sum, before the second.
struct SignedTime {
    Cell second;
    std::int64_t milliseconds = 0;  ///< as the firmware prints them: "-02" and "-002" are two
};
std::optional<SignedTime> signed_time(const Cell& time) {
    const std::size_t point = time.text.find(".-");
    if (point == std::string_view::npos || !time.text.ends_with('Z')) return std::nullopt;
    const std::string_view digits = time.text.substr(point + 2, time.text.size() - point - 3);
    const auto count = digits_at(digits, 0, digits.size());
    if (digits.empty() || digits.size() > 3 || !count) return std::nullopt;
    Cell second = time;
    second.text = time.text.substr(0, point);
    return SignedTime{second, *count};
}

std::string_view name_of(Column column) {
    return column_names[static_cast<std::size_t>(column)].name;
}

/// Which of the columns has a name; column_count for none.
std::size_t find_column(std::string_view name) {
    const auto found = std::ranges::find(column_names, name, &ColumnName::name);
    return static_cast<std::size_t>(found - column_names.begin());
}

void require_all(const Layout& layout, const SourceLine& line, const RecordingBytes& recording) {
    for (std::size_t i = 0; i < column_count; ++i) {
        if (layout.place[i] || static_cast<Column>(i) == Column::fix) continue;
        const Cell start{line.text, &recording, line.number, 1};
        start.fail(fmt::format("the header names no column \"{}\": \"{}\"", column_names[i].name,
                               escape_for_message(line.text, 80)),
                   "A FlySight writes time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,...,numSV; "
                   "take the recording as it wrote it");
    }
}

FixType read_fix(const Cell& cell) {
    // As u-blox counts them.
    switch (read_whole(cell, "gpsFix", 0, 5)) {
        case 1:
        case 4:
            return FixType::dead_reckoning;
        case 2:
        case 3:
            return FixType::single;
        default:
            return FixType::none;
    }
}

/// The fields of one row, by column.
class Row : public RowCells<Column> {
  public:
    using RowCells::RowCells;

    double real(Column column) const { return RowCells::real(column, name_of(column)); }
    /// A standard deviation; 0 where it is unknown.
    double deviation(Column column) const {
        const double value = read_deviation(cell(column), name_of(column));
        return value >= saturated ? 0.0 : value;
    }
};

void read_solution(const Row& cells, TimedRow& row) {
    Observation& observation = row.observation;
    const Geodetic position{.latitude = Angle::from_degrees(cells.real(Column::latitude)),
                            .longitude = Angle::from_degrees(cells.real(Column::longitude)),
                            .height_m = cells.real(Column::height)};
    set_position(observation,
                 checked_geodetic(position, cells.cell(Column::latitude),
                                  cells.cell(Column::longitude), cells.cell(Column::height)));
    row.written.unit = CoordinateUnit::degree;
    row.written.coordinates = {cells.cell(Column::latitude).text,
                               cells.cell(Column::longitude).text};
    set_velocity(observation, cells.real(Column::velocity_east),
                 cells.real(Column::velocity_north));
    observation.recorded_velocity_up_m_s = -cells.real(Column::velocity_down);
    set_radial_accuracy(observation, cells.deviation(Column::horizontal_accuracy));
    if (const double sigma_m = cells.deviation(Column::vertical_accuracy); sigma_m > 0.0)
        observation.sigma_up_m = sigma_m;
    set_velocity_accuracy(observation, cells.deviation(Column::speed_accuracy), 3);
}

}  // namespace

Layout read_columns(const SourceLine& line, const RecordingBytes& recording, std::size_t skipped,
                    std::size_t skipped_in_rows) {
    Layout layout;
    const std::vector<Cell> cells = split_at(line, recording, ',');
    for (std::size_t i = skipped; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        const std::size_t column = find_column(cell.text);
        layout.fields = i - skipped + skipped_in_rows + 1;
        if (column == column_count) continue;
        if (layout.place[column])
            cell.fail(fmt::format("the column \"{}\" stands twice", cell.text),
                      "Take the recording as the FlySight wrote it");
        layout.place[column] = layout.fields - 1;
    }
    require_all(layout, line, recording);
    return layout;
}

void require_units(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                   std::size_t skipped, std::size_t skipped_in_rows) {
    const std::vector<Cell> cells = split_at(line, recording, ',');
    for (std::size_t i = skipped; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        std::string_view unit = cell.text;
        if (unit.starts_with('(') && unit.ends_with(')')) unit = unit.substr(1, unit.size() - 2);
        for (std::size_t column = 0; column < column_count; ++column)
            if (layout.place[column] == i - skipped + skipped_in_rows &&
                unit != column_names[column].unit && !is_speed_in_metres(column, unit))
                cell.fail(fmt::format("the column \"{}\" is in \"{}\"; FlySight has it in \"{}\"",
                                      column_names[column].name, escape_for_message(unit),
                                      column_names[column].unit),
                          "Take the recording as the FlySight wrote it");
    }
}

TimedRow read_row(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                  bool last) {
    const std::vector<Cell> fields = split_at(line, recording, ',');
    require_count(fields.size(), layout.fields, line, recording, last, "its header names",
                  "Take the recording as the FlySight wrote it");
    const Row cells(fields, layout);
    TimedRow row;
    const Cell& time = cells.cell(Column::time);
    row.written.time = time.text;
    if (const auto before = signed_time(time)) {
        row.instant = read_iso(before->second, Clock::utc)
                          .plus_nanoseconds(-ns_per_ms * before->milliseconds);
        row.written.time = "0.000";
    } else {
        row.instant = read_iso(time, Clock::utc);
    }
    row.observation.satellites = read_satellites(cells.cell(Column::satellites));
    if (cells.has(Column::fix))
        row.observation.fix = read_fix(cells.cell(Column::fix));
    else if (*row.observation.satellites == 0)
        row.observation.fix = FixType::none;
    if (row.observation.fix != FixType::none) read_solution(cells, row);
    return row;
}

}  // namespace runcert::flysight

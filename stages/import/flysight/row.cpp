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

/// What a receiver writes where it has no idea: the largest count of millimetres.
constexpr double saturated = 4'294'967.0;

/// Gives the fields of a line, one after the other.
class Fields {
  public:
    Fields(const SourceLine& line, const RecordingBytes& recording)
        : recording_(recording), line_(line), rest_(line.text) {}

    bool more() const { return more_; }

    Cell next() {
        const std::size_t comma = rest_.find(',');
        const Cell cell{rest_.substr(0, comma), &recording_, line_.number,
                        line_.text.size() - rest_.size() + 1};
        more_ = comma != std::string_view::npos;
        rest_.remove_prefix(more_ ? comma + 1 : rest_.size());
        return cell;
    }

  private:
    const RecordingBytes& recording_;
    const SourceLine& line_;
    std::string_view rest_;
    bool more_ = true;
};

/// Which of the columns has a name; column_count for none.
std::size_t find_column(std::string_view name) {
    const auto found = std::find_if(column_names.begin(), column_names.end(),
                                    [&](const ColumnName& column) { return column.name == name; });
    return static_cast<std::size_t>(found - column_names.begin());
}

void require_all(const Layout& layout, const SourceLine& line, const RecordingBytes& recording) {
    for (std::size_t i = 0; i < column_count; ++i) {
        if (layout.field_of[i] || static_cast<Column>(i) == Column::fix) continue;
        const Cell start{line.text, &recording, line.number, 1};
        start.fail(fmt::format("the header names no column \"{}\": \"{}\"", column_names[i].name,
                               escape_for_message(line.text, 80)),
                   "A FlySight writes time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,...,numSV; "
                   "take the recording as it wrote it");
    }
}

FixKind read_fix(const Cell& cell) {
    // As u-blox counts them.
    switch (read_whole(cell, "gpsFix", 0, 5)) {
        case 1:
        case 4:
            return FixKind::dead_reckoning;
        case 2:
        case 3:
            return FixKind::single;
        default:
            return FixKind::none;
    }
}

/// The fields of one row, by column.
class Row {
  public:
    /// Failure where the line has another number of fields than the layout.
    Row(const SourceLine& line, const RecordingBytes& recording, const Layout& layout, bool last)
        : layout_(layout) {
        Fields fields(line, recording);
        std::size_t count = 0;
        for (; fields.more(); ++count) {
            const Cell cell = fields.next();
            for (std::size_t i = 0; i < column_count; ++i)
                if (layout.field_of[i] == count) cells_[i] = cell;
        }
        if (count == layout.fields) return;
        const Cell start{line.text, &recording, line.number, 1};
        if (count < layout.fields && last)
            start.fail(fmt::format("the last line is cut off: it has {} fields of {}", count,
                                   layout.fields),
                       "Take the whole recording, or take that line out");
        start.fail(fmt::format("the line has {} fields; its header names {}", count, layout.fields),
                   "Take the recording as the FlySight wrote it");
    }

    const Cell& operator[](Column column) const { return cells_[static_cast<std::size_t>(column)]; }
    bool has(Column column) const {
        return layout_.field_of[static_cast<std::size_t>(column)].has_value();
    }
    double real(Column column) const {
        return read_real((*this)[column], column_names[static_cast<std::size_t>(column)].name);
    }
    /// A standard deviation; 0 where it is unknown.
    double deviation(Column column) const {
        const double value =
            read_deviation((*this)[column], column_names[static_cast<std::size_t>(column)].name);
        return value >= saturated ? 0.0 : value;
    }

  private:
    const Layout& layout_;
    std::array<Cell, column_count> cells_;
};

void read_solution(const Row& cells, TimedRow& row) {
    Observation& observation = row.observation;
    const Geodetic position{.latitude = Angle::from_degrees(cells.real(Column::latitude)),
                            .longitude = Angle::from_degrees(cells.real(Column::longitude)),
                            .height_m = cells.real(Column::height)};
    set_position(observation, checked_geodetic(position, cells[Column::latitude],
                                               cells[Column::longitude], cells[Column::height]));
    row.written.unit = CoordinateUnit::degree;
    row.written.coordinates = {cells[Column::latitude].text, cells[Column::longitude].text};
    set_velocity(observation, cells.real(Column::velocity_east),
                 cells.real(Column::velocity_north));
    observation.recorded_velocity_up_mps = -cells.real(Column::velocity_down);
    set_radial_accuracy(observation, cells.deviation(Column::horizontal_accuracy));
    if (const double sigma_m = cells.deviation(Column::vertical_accuracy); sigma_m > 0.0)
        observation.sigma_up_m = sigma_m;
    set_velocity_accuracy(observation, cells.deviation(Column::speed_accuracy), 3);
}

}  // namespace

Layout read_columns(const SourceLine& line, const RecordingBytes& recording, std::size_t skipped,
                    std::size_t skipped_in_rows) {
    Layout layout;
    Fields fields(line, recording);
    for (std::size_t i = 0; fields.more(); ++i) {
        const Cell cell = fields.next();
        if (i < skipped) continue;
        const std::size_t column = find_column(cell.text);
        layout.fields = i - skipped + skipped_in_rows + 1;
        if (column == column_count) continue;
        if (layout.field_of[column])
            cell.fail(fmt::format("the column \"{}\" stands twice", cell.text),
                      "Take the recording as the FlySight wrote it");
        layout.field_of[column] = layout.fields - 1;
    }
    require_all(layout, line, recording);
    return layout;
}

void require_units(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                   std::size_t skipped, std::size_t skipped_in_rows) {
    Fields fields(line, recording);
    for (std::size_t i = 0; fields.more(); ++i) {
        const Cell cell = fields.next();
        if (i < skipped) continue;
        std::string_view unit = cell.text;
        if (unit.starts_with('(') && unit.ends_with(')')) unit = unit.substr(1, unit.size() - 2);
        for (std::size_t column = 0; column < column_count; ++column)
            if (layout.field_of[column] == i - skipped + skipped_in_rows &&
                unit != column_names[column].unit)
                cell.fail(fmt::format("the column \"{}\" is in \"{}\"; FlySight has it in \"{}\"",
                                      column_names[column].name, escape_for_message(unit),
                                      column_names[column].unit),
                          "Take the recording as the FlySight wrote it");
    }
}

TimedRow read_row(const SourceLine& line, const RecordingBytes& recording, const Layout& layout,
                  bool last) {
    const Row cells(line, recording, layout, last);
    TimedRow row;
    row.instant = read_iso(cells[Column::time], Clock::utc);
    row.written.time = cells[Column::time].text;
    row.observation.satellites = read_satellites(cells[Column::satellites]);
    if (cells.has(Column::fix))
        row.observation.fix = read_fix(cells[Column::fix]);
    else if (*row.observation.satellites == 0)
        row.observation.fix = FixKind::none;
    if (row.observation.fix != FixKind::none) read_solution(cells, row);
    return row;
}

}  // namespace runcert::flysight

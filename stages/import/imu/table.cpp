#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/csv/head.h"
#include "stages/import/fields/date_time.h"
#include "stages/import/imu/raw.h"
#include "stages/import/row_collector.h"

namespace runcert::imu {
namespace {

enum class ImuColumn : std::size_t {
    time,
    week,
    gyro_x,
    gyro_y,
    gyro_z,
    accelerometer_x,
    accelerometer_y,
    accelerometer_z,
    count
};
constexpr std::array<std::string_view, 8> column_names{
    "time",           "week", "gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y",
    "accelerometer_z"};

using Places = ColumnPlaces<ImuColumn>;

std::optional<std::int64_t> number_of(const std::string& source) {
    const auto number = parse_integer(source);
    return number && *number >= 1 ? number : std::nullopt;
}

bool all_numbered(const ImuColumns& columns) {
    return std::ranges::all_of(
        columns, [](const auto& column) { return number_of(column.second).has_value(); });
}

/// Whether a line is a row of a table whose columns are given by number: a number where gyro_x is,
/// and with `whole` a cell for every column.
bool is_numbered_row(const ImuColumns& columns, std::span<const Cell> cells, bool whole) {
    const auto is_there = [&](const auto& column) {
        return static_cast<std::uint64_t>(*number_of(column.second)) <= cells.size();
    };
    if (whole ? !std::ranges::all_of(columns, is_there) : !is_there(*columns.find("gyro_x")))
        return false;
    const auto at = static_cast<std::size_t>(*number_of(columns.at("gyro_x")) - 1);
    return parse_double(cells[at].text).has_value();
}

/// The first line with all the names; of a table whose columns are numbered, the first whose gyro's
/// cell is a number.
csv::Head head_of(const ImuColumns& columns, const RecordingBytes& file) {
    const bool numbered = all_numbered(columns);
    std::size_t most = 0;
    std::int64_t nearest_line = 1;
    bool whole = true;  // a file may begin within a line
    const auto is_it = [&](std::span<const Cell> cells, bool comment) {
        if (numbered) return !comment && is_numbered_row(columns, cells, whole);
        const auto named =
            static_cast<std::size_t>(std::ranges::count_if(columns, [&](const auto& column) {
                return number_of(column.second) ||
                       std::ranges::any_of(cells, [&](const Cell& cell) {
                           return cell.text == trim(column.second);
                       });
            }));
        if (named > most) {
            most = named;
            nearest_line = cells.front().line;
        }
        return named == columns.size();
    };
    auto head = csv::find_head(file, std::nullopt, is_it);
    if (!head && numbered) {
        whole = false;
        head = csv::find_head(file, std::nullopt, is_it);
    }
    if (!head)
        throw Failure(place_in(file, nearest_line, 1),
                      numbered ? "no line has a number where the attempt says that gyro_x is"
                               : "no line has all the column names that the attempt gives",
                      numbered ? "Columns are counted from 1: correct the numbers in imu: columns"
                               : "Write the names of the header line in imu: columns, or numbers "
                                 "counted from 1; runcert inspect proposes them");
    if (numbered) head->first_row = head->line;
    return *std::move(head);
}

std::size_t place_of(const std::string& source, std::string_view meaning, const csv::Head& head,
                     bool numbered) {
    const auto is_it = [&](const Cell& cell) { return cell.text == trim(source); };
    const auto found = std::ranges::find_if(head.names, is_it);
    if (!numbered && found != head.names.end()) {
        if (std::ranges::count_if(head.names, is_it) > 1)
            found->fail(fmt::format("two columns have the name \"{}\" (for {})",
                                    escape_for_message(source), meaning),
                        "Give that column by its number, counted from 1");
        return static_cast<std::size_t>(found - head.names.begin());
    }
    const std::int64_t number = *number_of(source);
    if (static_cast<std::uint64_t>(number) > head.names.size())
        head.names.front().fail(fmt::format("there is no column {} (for {}): the line has {}",
                                            number, meaning, head.names.size()),
                                "Columns are counted from 1: correct the numbers in imu: columns");
    return static_cast<std::size_t>(number - 1);
}

/// Digits by which a unit's count must be shifted to be seconds.
int shift_of(const std::string& unit) {
    return unit == "ms" ? 3 : unit == "us" ? 6 : unit == "ns" ? 9 : 0;
}

/// How the time column is read: decided by its first cell.
struct TimeReader {
    Stamps stamps = Stamps::count;
    int shift = 0;
    Clock clock = Clock::gps;

    std::int64_t read(const RowCells<ImuColumn>& cells) const {
        const Cell& time = cells.cell(ImuColumn::time);
        if (cells.has(ImuColumn::week))
            return read_week_time(cells.cell(ImuColumn::week), time, Clock::gps).nanoseconds();
        if (stamps == Stamps::gps) return read_iso(time, clock).nanoseconds();
        return read_nanoseconds(time, "time", shift);
    }
};

TimeReader time_reader(const Places& places, const csv::Head& head, const Imu& imu, bool utc,
                       const RecordingBytes& file) {
    TimeReader reader{.stamps = Stamps::none, .shift = shift_of(imu.time_unit)};
    if (!places[ImuColumn::time]) return reader;
    const std::string_view first = csv::in_first_row(head, *places[ImuColumn::time], file);
    const bool is_date = first.find(':') != std::string_view::npos;
    reader.stamps = places[ImuColumn::week] || is_date ? Stamps::gps : Stamps::count;
    if (utc || first.ends_with('Z')) reader.clock = Clock::utc;
    return reader;
}

RawSample read_sample(std::span<const Cell> row, const Places& places, const TimeReader& times,
                      double gyro_unit_rad_s, double accelerometer_unit_m_s2) {
    const RowCells<ImuColumn> cells(row, places);
    const auto vector = [&](ImuColumn first) {
        Eigen::Vector3d value;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto column = static_cast<ImuColumn>(static_cast<std::size_t>(first) + i);
            value[static_cast<Eigen::Index>(i)] =
                cells.real(column, column_names[static_cast<std::size_t>(column)]);
        }
        return value;
    };
    RawSample sample;
    if (times.stamps != Stamps::none) sample.time_ns = times.read(cells);
    sample.gyro = gyro_unit_rad_s * vector(ImuColumn::gyro_x);
    sample.accelerometer = accelerometer_unit_m_s2 * vector(ImuColumn::accelerometer_x);
    return sample;
}

}  // namespace

RawFile read_table(const Receiver& receiver, const RecordingBytes& file, bool utc) {
    require_text(file);
    const Imu& imu = *receiver.imu;
    const csv::Head head = head_of(imu.columns, file);
    Places places;
    places.fields = head.names.size();
    for (std::size_t i = 0; i < column_names.size(); ++i)
        if (const auto found = imu.columns.find(std::string(column_names[i]));
            found != imu.columns.end())
            places.place[i] =
                place_of(found->second, column_names[i], head, all_numbered(imu.columns));
    const TimeReader times = time_reader(places, head, imu, utc, file);
    RawFile raw;
    raw.format = "csv";
    raw.stamps = times.stamps;
    raw.increments = imu.readings == ImuReadings::increments;
    if (head.passed_over > 0)
        raw.notes.push_back(
            fmt::format("Lines above the table that are no part of it: {}.", head.passed_over));
    read_lines(
        file,
        [&](const SourceLine& line, bool cut_off) -> std::optional<RawSample> {
            if (line.number < head.first_row || csv::is_skipped(line)) return std::nullopt;
            std::vector<Cell> cells = csv::split(line, file, head.delimiter);
            if (cells.size() == places.fields + 1 && cells.back().text.empty()) cells.pop_back();
            require_count(cells.size(), places.fields, line, file, cut_off,
                          "the first line of the table has",
                          "Hand in the table as the logger wrote it, or another export");
            const RawSample sample =
                read_sample(cells, places, times, gyro_unit(imu), accelerometer_unit(imu));
            require_possible(sample, cells.front());
            return sample;
        },
        raw);
    return raw;
}

}  // namespace runcert::imu

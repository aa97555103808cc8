#include "files/measured_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/decimal_time.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr double largest_m_s = 150.0;
using Names = std::vector<std::string_view>;

Names columns_of(SeriesKind kind) {
    Names names{"time", "time_gps", "time_s"};
    if (kind == SeriesKind::gates)
        names.push_back("distance_m");
    else
        names.insert(names.end(), {"speed_m_s", "speed_kn", "speed_km_h"});
    if (kind == SeriesKind::flow) names.push_back("direction_deg");
    return names;
}

/// A header line of such a series.
std::string example_of(SeriesKind kind) {
    return kind == SeriesKind::flow    ? "time,speed_m_s,direction_deg"
           : kind == SeriesKind::wheel ? "time,speed_m_s"
                                       : "time,distance_m";
}

/// A piece of the text, and where it stands.
struct SeriesCell {
    std::string_view text;
    const std::string* where = nullptr;
    std::size_t line = 1;
    std::size_t column = 1;  ///< byte in the line, from 1

    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Failure(fmt::format("{}:{}:{}", *where, line, column), what, remedy);
    }
    std::string quoted() const { return fmt::format("\"{}\"", escape_for_message(text)); }
};

/// The lines that are neither empty nor begin with #, whole, without blanks at the end.
std::vector<SeriesCell> lines_of(std::string_view text, const std::string& where) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    std::vector<SeriesCell> lines;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view content = trim(line);
        if (content.empty() || content.front() == '#') continue;
        lines.push_back({line, &where, number, 1});
    }
    return lines;
}

std::vector<SeriesCell> split(const SeriesCell& line) {
    std::vector<SeriesCell> cells;
    for (std::size_t from = 0;;) {
        const std::size_t to = std::min(line.text.find(',', from), line.text.size());
        SeriesCell cell = line;
        cell.text = trim(line.text.substr(from, to - from));
        cell.column = cell.text.empty()
                          ? from + 1
                          : static_cast<std::size_t>(cell.text.data() - line.text.data()) + 1;
        cells.push_back(cell);
        if (to == line.text.size()) return cells;
        from = to + 1;
    }
}

/// Which columns hold what.
struct SeriesColumns {
    std::size_t count = 0;
    std::size_t time = 0, value = 0;
    std::optional<std::size_t> direction;
    std::string_view time_name;
    double mps_per_unit = 1.0;
};

/// The one column whose name begins so.
std::size_t find_column(const std::vector<SeriesCell>& header, std::string_view prefix,
                        const std::string& choices, SeriesKind kind) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (!header[i].text.starts_with(prefix)) continue;
        if (found)
            header[i].fail(fmt::format("{} is a second column of what {} gives", header[i].quoted(),
                                       header[*found].quoted()),
                           "Keep one of the two");
        found = i;
    }
    if (!found)
        header.front().fail(fmt::format("the header line names no {}", choices),
                            "Name the columns in the first line, as " + example_of(kind));
    return *found;
}

SeriesColumns read_header(const SeriesCell& line, SeriesKind kind) {
    const Names known_columns = columns_of(kind);
    const std::vector<SeriesCell> header = split(line);
    for (const SeriesCell& cell : header)
        if (std::ranges::find(known_columns, cell.text) == known_columns.end())
            cell.fail(
                fmt::format("the column {} is not known", cell.quoted()),
                fmt::format("Did you mean {}? Columns are {}, with commas between them; take "
                            "others out",
                            nearest(cell.text, known_columns), fmt::join(known_columns, ", ")));
    SeriesColumns columns;
    columns.count = header.size();
    columns.time = find_column(header, "time", "time, time_gps or time_s", kind);
    columns.value = kind == SeriesKind::gates
                        ? find_column(header, "distance", "distance_m", kind)
                        : find_column(header, "speed", "speed_m_s, speed_kn or speed_km_h", kind);
    if (kind == SeriesKind::flow)
        columns.direction = find_column(header, "direction", "direction_deg", kind);
    columns.time_name = header[columns.time].text;
    const std::string_view unit = header[columns.value].text;
    if (unit == "speed_kn") columns.mps_per_unit = 1852.0 / 3600.0;
    if (unit == "speed_km_h") columns.mps_per_unit = 1.0 / 3.6;
    return columns;
}

GpsTime read_utc(std::string_view text) {
    if (!text.ends_with('Z'))
        throw Failure("time", "UTC ends in Z",
                      "Write 2022-12-11T01:02:03.5Z, or name the column time_gps");
    std::string shown(text.substr(0, text.size() - 1));
    constexpr std::size_t second_at = 17;
    const bool is_leap_second =
        shown.size() >= second_at + 2 && shown.compare(second_at, 2, "60") == 0;
    if (is_leap_second) shown.replace(second_at, 2, "59");
    CalendarTime utc = parse_gps_iso(shown).calendar();
    if (is_leap_second) utc.second = 60;
    return gps_from_utc(utc);
}

double read_time_s(const SeriesCell& cell, std::string_view column,
                   const std::optional<GpsTime>& first_epoch) {
    if (column == "time_s") {
        const auto nanoseconds = parse_decimal_nanoseconds(cell.text);
        if (!nanoseconds)
            cell.fail(fmt::format("{} is not a number of seconds", cell.quoted()),
                      "Write seconds from the recording's first epoch, as 12.5");
        return static_cast<double>(*nanoseconds) * 1e-9;
    }
    try {
        const GpsTime time = column == "time" ? read_utc(cell.text) : parse_gps_iso(cell.text);
        return time.seconds_since(first_epoch.value());
    } catch (const Failure& failure) {
        cell.fail(fmt::format("{} is not a time: {}", cell.quoted(), failure.problem()),
                  column == "time" ? "Write UTC as 2022-12-11T01:02:03.5Z" : failure.remedy());
    }
}

double read_number(const SeriesCell& cell, std::string_view meaning) {
    const auto number = parse_double(cell.text);
    if (!number)
        cell.fail(fmt::format("{} is not a {}", cell.quoted(), meaning),
                  "Write a decimal number, or take the line out where nothing was measured");
    return *number;
}

double read_speed_m_s(const SeriesCell& cell, double mps_per_unit) {
    const double speed_m_s = read_number(cell, "speed") * mps_per_unit;
    if (speed_m_s < 0.0)
        cell.fail(fmt::format("the speed {} is negative", cell.quoted()),
                  "A speed is 0 or more, whichever way it is");
    if (speed_m_s > largest_m_s)
        cell.fail(fmt::format("the speed {} is above {} m/s", cell.quoted(), largest_m_s),
                  "Correct it, or the unit in the column's name");
    return speed_m_s;
}

double read_value(const SeriesCell& cell, const SeriesColumns& columns, SeriesKind kind) {
    return kind == SeriesKind::gates ? read_number(cell, "distance")
                                     : read_speed_m_s(cell, columns.mps_per_unit);
}

double read_direction_deg(const SeriesCell& cell) {
    const double direction_deg = read_number(cell, "direction");
    if (direction_deg < 0.0 || direction_deg > 360.0)
        cell.fail(fmt::format("the direction {} is not within 0 to 360 degrees", cell.quoted()),
                  "Write degrees from north over east");
    return direction_deg;
}

}  // namespace

MeasuredSeries read_series(std::string_view text, const std::string& where,
                           const std::optional<GpsTime>& first_epoch, SeriesKind kind) {
    const std::vector<SeriesCell> lines = lines_of(text, where);
    if (lines.empty())
        throw Failure(where, "the file is empty",
                      "Give a header line, as " + example_of(kind) + ", and samples below it");
    const SeriesColumns columns = read_header(lines.front(), kind);
    if (columns.time_name != "time_s" && !first_epoch)
        lines.front().fail("it gives instants, but the recording's times are relative",
                           "Give the receiver's start_gps in the attempt, or the column time_s, "
                           "seconds from the recording's first epoch");
    MeasuredSeries series{.where = where, .samples = {}};
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::vector<SeriesCell> cells = split(lines[i]);
        if (cells.size() != columns.count)
            lines[i].fail(fmt::format("the line has {} fields; the header line has {}",
                                      cells.size(), columns.count),
                          "Correct the line, or take it out");
        const SeriesCell& time = cells[columns.time];
        const SeriesSample sample{
            .time_s = read_time_s(time, columns.time_name, first_epoch),
            .value = read_value(cells[columns.value], columns, kind),
            .direction_deg =
                columns.direction ? read_direction_deg(cells[*columns.direction]) : 0.0};
        if (!series.samples.empty() && sample.time_s <= series.samples.back().time_s)
            time.fail(
                fmt::format("the time {} is not after that of the line before", time.quoted()),
                "Put the lines in order of time, each time once");
        if (kind == SeriesKind::gates && !series.samples.empty() &&
            sample.value <= series.samples.back().value)
            cells[columns.value].fail(
                fmt::format("the distance {} is not beyond that of the gate before",
                            cells[columns.value].quoted()),
                "Put the gates in their order along the course, each with its distance from the "
                "first");
        series.samples.push_back(sample);
    }
    if (series.samples.empty())
        throw Failure(where, "there is no sample below the header line",
                      "Give at least one sample before the window and one after it");
    if (kind == SeriesKind::gates && series.samples.size() < 2)
        throw Failure(where, "there is only one gate", "Give two gates or more");
    return series;
}

std::vector<TimedValue> timed_values(const MeasuredSeries& series) {
    std::vector<TimedValue> values;
    values.reserve(series.samples.size());
    for (const SeriesSample& sample : series.samples)
        values.push_back({.time_s = sample.time_s, .value = sample.value});
    return values;
}

}  // namespace runcert

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

    std::string place() const { return fmt::format("{}:{}:{}", *where, line, column); }
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Failure(place(), what, remedy);
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
        cell.fail(
            fmt::format("{} is not a {}", cell.quoted(), meaning),
            "Each line holds a measured number with a decimal point: export the series again");
    return *number;
}

double read_speed_m_s(const SeriesCell& cell, double mps_per_unit) {
    const double speed_m_s = read_number(cell, "speed") * mps_per_unit;
    if (speed_m_s < 0.0)
        cell.fail(fmt::format("the speed {} is negative", cell.quoted()),
                  "A speed is 0 or more, whichever way it is");
    if (speed_m_s > largest_m_s)
        cell.fail(fmt::format("the speed {} is above {} m/s", cell.quoted(), largest_m_s),
                  "The unit is that of the column's name (speed_km_h): export the series again");
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

/// One line in so many may be left out.
constexpr std::size_t lines_to_one_left_out = 20;

/// A line below the header, and what it says.
struct SeriesLine {
    SeriesCell line;
    SeriesSample sample;
};

SeriesSample read_sample(const SeriesCell& line, const SeriesColumns& columns,
                         const std::optional<GpsTime>& first_epoch, SeriesKind kind) {
    const std::vector<SeriesCell> cells = split(line);
    if (cells.size() != columns.count)
        line.fail(fmt::format("the line has {} fields; the header line has {}", cells.size(),
                              columns.count),
                  "Each line has a field for each name of the header: export the series again");
    return {
        .time_s = read_time_s(cells[columns.time], columns.time_name, first_epoch),
        .value = read_value(cells[columns.value], columns, kind),
        .direction_deg = columns.direction ? read_direction_deg(cells[*columns.direction]) : 0.0};
}

/// Which of the lines are of the most whose times increase.
std::vector<bool> longest_in_order(const std::vector<SeriesLine>& lines) {
    std::vector<std::size_t> ends;  // of the best sequence of each length, the line it ends with
    std::vector<std::size_t> before(lines.size());
    const auto time_of = [&](std::size_t line) { return lines[line].sample.time_s; };
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto place = std::ranges::lower_bound(ends, time_of(i), {}, time_of);
        before[i] = place == ends.begin() ? i : *std::prev(place);
        if (place == ends.end())
            ends.push_back(i);
        else
            *place = i;
    }
    std::vector<bool> in_order(lines.size(), false);
    if (ends.empty()) return in_order;
    for (std::size_t i = ends.back();; i = before[i]) {
        in_order[i] = true;
        if (before[i] == i) return in_order;
    }
}

/// Failure at the first line whose time is not after that of the line before.
[[noreturn]] void refuse_order(const std::vector<SeriesLine>& lines, const SeriesColumns& columns) {
    std::size_t i = 1;
    while (lines[i].sample.time_s > lines[i - 1].sample.time_s)
        ++i;
    const SeriesCell time = split(lines[i].line)[columns.time];
    time.fail(fmt::format("the time {} is not after that of the line before", time.quoted()),
              "Hand in the file as the instrument wrote it, its lines in the order of time");
}

void require_gates_in_order(const std::vector<SeriesLine>& gates, const SeriesColumns& columns) {
    for (std::size_t i = 1; i < gates.size(); ++i) {
        if (gates[i].sample.value > gates[i - 1].sample.value) continue;
        const SeriesCell cell = split(gates[i].line)[columns.value];
        cell.fail(
            fmt::format("the distance {} is not beyond that of the gate before", cell.quoted()),
            "Put the gates in their order along the course, each with its distance from the "
            "first");
    }
}

}  // namespace

bool from_text(std::string_view word, SeriesKind& kind) {
    if (word != "flow" && word != "wheel" && word != "gates") return false;
    kind = word == "flow"    ? SeriesKind::flow
           : word == "wheel" ? SeriesKind::wheel
                             : SeriesKind::gates;
    return true;
}

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
    MeasuredSeries series{.where = where, .samples = {}, .left_out = {}};
    // Gates are few, and each of them counts.
    const std::size_t lost_at_most =
        kind == SeriesKind::gates ? 0 : (lines.size() - 1) / lines_to_one_left_out;
    std::vector<SeriesLine> read;
    std::vector<Failure> lost;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        try {
            read.push_back({lines[i], read_sample(lines[i], columns, first_epoch, kind)});
        } catch (const Failure& failure) {
            if (lost.size() >= lost_at_most) throw;
            lost.push_back(failure);
        }
    }
    const std::vector<bool> in_order = longest_in_order(read);
    for (std::size_t i = 0; i < read.size(); ++i) {
        if (in_order[i])
            series.samples.push_back(read[i].sample);
        else if (lost.size() >= lost_at_most)
            refuse_order(read, columns);
        else
            lost.emplace_back(read[i].line.place(), "its time leaves the order of the others", "");
    }
    if (kind == SeriesKind::gates) require_gates_in_order(read, columns);
    if (!lost.empty())
        series.left_out = fmt::format(
            "{}: {} of {} lines were left out, the first because {} ({}).", where, lost.size(),
            lines.size() - 1, lost.front().problem(), lost.front().where());
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

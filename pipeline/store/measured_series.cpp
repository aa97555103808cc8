#include "store/measured_series.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "store/yaml_node.h"

namespace runcert {
namespace {

/// A column that gives a quantity, and its unit in that of the sample.
struct UnitColumn {
    std::string_view name;
    double unit = 1.0;
};

/// What a series may give at each time.
struct Quantity {
    std::string_view word;  ///< also in messages: "is not a speed"
    std::vector<UnitColumn> columns;
    double SeriesSample::*member;
    double least = 0.0, most = 0.0;           ///< in the unit of the sample
    std::string_view below = {}, above = {};  ///< what is wrong with a number out of range
    std::string_view what_it_is = {};         ///< the remedy of one below
    bool each_line_counts = false;
};

constexpr std::string_view other_unit =
    "The unit is that of the column's name: export the series again";

const std::vector<Quantity>& known_quantities() {
    constexpr double endless = std::numeric_limits<double>::infinity();
    static const std::vector<Quantity> all{
        {.word = "speed",
         .columns = {{"speed_m_s"}, {"speed_kn", knot_in_m_s}, {"speed_km_h", km_h_in_m_s}},
         .member = &SeriesSample::value,
         .least = 0.0,
         .most = 150.0,
         .below = "is negative",
         .above = "is above 150 m/s",
         .what_it_is = "A speed is 0 or more, whichever way it is"},
        {.word = "direction",
         .columns = {{"direction_deg"}},
         .member = &SeriesSample::direction_deg,
         .least = 0.0,
         .most = 360.0,
         .below = "is not within 0 to 360 degrees",
         .above = "is not within 0 to 360 degrees",
         .what_it_is = "Write degrees from north over east"},
        {.word = "distance",
         .columns = {{"distance_m"}},
         .member = &SeriesSample::value,
         .least = -endless,
         .most = endless,
         .each_line_counts = true},
        {.word = "uncertainty",
         .columns = {{"expanded_uncertainty_m_s"},
                     {"expanded_uncertainty_kn", knot_in_m_s},
                     {"expanded_uncertainty_km_h", km_h_in_m_s}},
         .member = &SeriesSample::expanded_uncertainty_m_s,
         .least = 0.005,
         .most = 50.0,
         .below = "is below 0.005 m/s",
         .above = "is above 50 m/s",
         .what_it_is = "Write what the speed is uncertain by at k = 2, as the certificate of the "
                       "instrument states it",
         .each_line_counts = true},
        {.word = "length",
         .columns = {{"length_m"}},
         .member = &SeriesSample::length_m,
         .least = 0.0,
         .most = 10000.0,
         .below = "is negative",
         .above = "is above 10000 m",
         .what_it_is = "Write the metres over which the speed was measured, 0 for an instant"}};
    return all;
}

/// Those of a series, in the order of its declaration.
using Quantities = std::vector<const Quantity*>;
Quantities quantities_named(const SeriesQuantities& words) {
    Quantities found;
    for (const std::string& word : words) {
        const auto one = std::ranges::find(known_quantities(), word, &Quantity::word);
        assert(one != known_quantities().end());
        found.push_back(&*one);
    }
    return found;
}

using Names = std::vector<std::string_view>;
const Names time_columns{"time", "time_gps", "time_s"};

Names names_of(const Quantity& quantity) {
    Names names;
    for (const UnitColumn& column : quantity.columns)
        names.push_back(column.name);
    return names;
}

/// A header line of such a series.
std::string example_of(const Quantities& quantities) {
    std::string example = "time";
    for (const Quantity* const one : quantities)
        example.append(",").append(one->columns.front().name);
    return example;
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
    if (text.starts_with(utf8_mark)) text.remove_prefix(utf8_mark.size());
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

/// A column of the file that gives a quantity.
struct SeriesColumn {
    const Quantity* quantity = nullptr;
    std::size_t at = 0;
    double unit = 1.0;
};

/// Which columns hold what.
struct SeriesColumns {
    std::size_t count = 0;
    std::size_t time = 0;
    std::string_view time_name = {};
    std::vector<SeriesColumn> quantities = {};
};

/// "speed_m_s, speed_kn or speed_km_h"
std::string choice_of(const Names& names) {
    if (names.size() == 1) return std::string(names.front());
    return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

/// The one column that has one of these names.
std::size_t find_column(const std::vector<SeriesCell>& header, const Names& names,
                        const Quantities& quantities) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (std::ranges::find(names, header[i].text) == names.end()) continue;
        if (found)
            header[i].fail(fmt::format("{} is a second column of what {} gives", header[i].quoted(),
                                       header[*found].quoted()),
                           "Keep one of the two");
        found = i;
    }
    if (!found)
        header.front().fail(fmt::format("the header line names no {}", choice_of(names)),
                            "Name the columns in the first line, as " + example_of(quantities));
    return *found;
}

void require_known(const std::vector<SeriesCell>& header, const Quantities& quantities) {
    Names known = time_columns;
    for (const Quantity* const one : quantities)
        std::ranges::copy(names_of(*one), std::back_inserter(known));
    for (const SeriesCell& cell : header)
        if (std::ranges::find(known, cell.text) == known.end())
            cell.fail(fmt::format("the column {} is not known", cell.quoted()),
                      fmt::format("Did you mean {}? Columns are {}, with commas between them; take "
                                  "others out",
                                  nearest(cell.text, known), fmt::join(known, ", ")));
}

SeriesColumns read_header(const SeriesCell& line, const Quantities& quantities) {
    const std::vector<SeriesCell> header = split(line);
    require_known(header, quantities);
    SeriesColumns columns{.count = header.size(),
                          .time = find_column(header, time_columns, quantities)};
    columns.time_name = header[columns.time].text;
    for (const Quantity* const one : quantities) {
        const std::size_t at = find_column(header, names_of(*one), quantities);
        const auto named = std::ranges::find(one->columns, header[at].text, &UnitColumn::name);
        columns.quantities.push_back({.quantity = one, .at = at, .unit = named->unit});
    }
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

double read_quantity(const SeriesCell& cell, const SeriesColumn& column) {
    const Quantity& quantity = *column.quantity;
    const double value = read_number(cell, quantity.word) * column.unit;
    if (value < quantity.least)
        cell.fail(fmt::format("the {} {} {}", quantity.word, cell.quoted(), quantity.below),
                  std::string(quantity.what_it_is));
    if (value > quantity.most)
        cell.fail(fmt::format("the {} {} {}", quantity.word, cell.quoted(), quantity.above),
                  std::string(quantity.columns.size() > 1 ? other_unit : quantity.what_it_is));
    return value;
}

/// One line in so many may be left out.
constexpr std::size_t lines_to_one_left_out = 20;

/// A line below the header, and what it says.
struct SeriesLine {
    SeriesCell line;
    SeriesSample sample;
};

SeriesSample read_sample(const SeriesCell& line, const SeriesColumns& columns,
                         const std::optional<GpsTime>& first_epoch) {
    const std::vector<SeriesCell> cells = split(line);
    if (cells.size() != columns.count)
        line.fail(fmt::format("the line has {} fields; the header line has {}", cells.size(),
                              columns.count),
                  "Each line has a field for each name of the header: export the series again");
    SeriesSample sample;
    sample.time_s = read_time_s(cells[columns.time], columns.time_name, first_epoch);
    for (const SeriesColumn& column : columns.quantities)
        sample.*column.quantity->member = read_quantity(cells[column.at], column);
    return sample;
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

/// Distances are those of gates from the first.
void require_gates(const std::vector<SeriesLine>& gates, const SeriesColumns& columns,
                   const std::string& where) {
    const SeriesColumn& distance = columns.quantities.front();
    if (distance.quantity->word != "distance") return;
    for (std::size_t i = 1; i < gates.size(); ++i) {
        if (gates[i].sample.value > gates[i - 1].sample.value) continue;
        const SeriesCell cell = split(gates[i].line)[distance.at];
        cell.fail(
            fmt::format("the distance {} is not beyond that of the gate before", cell.quoted()),
            "Put the gates in their order along the course, each with its distance from the "
            "first");
    }
    if (gates.size() == 1) throw Failure(where, "there is only one gate", "Give two gates or more");
}

}  // namespace

MeasuredSeries read_series(std::string_view text, const std::string& where,
                           const std::optional<GpsTime>& first_epoch,
                           const SeriesQuantities& words) {
    const Quantities quantities = quantities_named(words);
    const std::vector<SeriesCell> lines = lines_of(text, where);
    if (lines.empty())
        throw Failure(
            where, "the file is empty",
            "Give a header line, as " + example_of(quantities) + ", and samples below it");
    const SeriesColumns columns = read_header(lines.front(), quantities);
    if (columns.time_name != "time_s" && !first_epoch)
        lines.front().fail("it gives instants, but the recording's times are relative",
                           "Give the receiver's start_gps in the attempt, or the column time_s, "
                           "seconds from the recording's first epoch");
    MeasuredSeries series{.where = where, .samples = {}, .left_out = {}};
    const std::size_t lost_at_most =
        std::ranges::any_of(quantities, [](const Quantity* one) { return one->each_line_counts; })
            ? 0
            : (lines.size() - 1) / lines_to_one_left_out;
    std::vector<SeriesLine> read;
    std::vector<Failure> lost;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        try {
            read.push_back({lines[i], read_sample(lines[i], columns, first_epoch)});
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
    if (!lost.empty())
        series.left_out = fmt::format(
            "{}: {} of {} lines were left out, the first because {} ({}).", where, lost.size(),
            lines.size() - 1, lost.front().problem(), lost.front().where());
    if (series.samples.empty())
        throw Failure(where, "there is no sample below the header line",
                      "Give at least one sample before the window and one after it");
    require_gates(read, columns, where);
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

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "core/written_unit.h"
#include "stages/import/clock.h"
#include "stages/import/fields/column.h"
#include "stages/import/vbo/vbo.h"

namespace runcert::vbo {
namespace {

constexpr std::size_t most_channels = 10'000;
constexpr std::size_t comments_kept = 100;
constexpr std::string_view created_on = "file created on";

/// The names of each column, in the order of Column: Racelogic's, then those of other writers. Of
/// several columns for one meaning, the one whose name comes first here counts.
constexpr std::array<std::string_view, static_cast<std::size_t>(Column::count)> names{
    "satellites sats satcount numsats numsv nsat",
    "time utctime gpstime utc",
    "latitude lat gpslatitude gpslat",
    "longitude long lon lng gpslongitude gpslong gpslon gpslng",
    "velocity gpsspeed groundspeed speed vel",
    "heading gpsheading course bearing",
    "height altitude gpsaltitude elevation alt",
    "verticalvelocity verticalvel vertvel",
    "solutiontype"};

/// The letters and digits of a name, in lower case: "vert-vel" and "Vert Vel" are one.
std::string letters(std::string_view name) {
    std::string text = lower_case(name);
    std::erase_if(text, [](char c) { return !((c >= 'a' && c <= 'z') || is_digit(c)); });
    return text;
}

/// The unit that a text says behind one of a column's names, "kmh" of "velocity km/h"; nothing for
/// another name, as "velocity quality".
std::optional<std::string> unit_behind(std::string_view name, Column column,
                                       const std::string& text) {
    if (!text.starts_with(name)) return std::nullopt;
    std::string unit = text.substr(name.size());
    const bool is_speed = column == Column::velocity || column == Column::vertical_velocity;
    if (unit.empty() || unit == "utc" ||
        (is_speed ? find_unit(unit, Quantity::speed) : find_unit(unit)))
        return unit;
    return std::nullopt;
}

/// The unit of a column: of its own name, else of its name in [header], else in [channel units]
/// where that has a line for every column. Empty where there is none, or no such column.
std::string unit_of(Column column, const Layout& layout, const Header& header,
                    const std::vector<Cell>& named) {
    if (!layout[column]) return {};
    std::vector<Cell> texts = header.channels;
    texts.insert(texts.begin(), named[*layout[column]]);
    for (const Cell& text : texts)
        for (const std::string_view name : csv::words_of(names[static_cast<std::size_t>(column)]))
            if (const auto unit = unit_behind(name, column, letters(text.text)).value_or("");
                !unit.empty())
                return unit;
    if (header.units.size() != named.size()) return {};
    return letters(header.units[*layout[column]].text);
}

constexpr int first_year = 1990;
constexpr double largest_offset_h = 14.0;

/// The numbers of "01/08/2025 @ 14:00:12", "07/12/2014 09:02:23" or "15/04/2004 at 08:21", -1 where
/// there is none: anything may stand between those of the date, colons alone between those of the
/// time.
std::array<int, 6> numbers_of(std::string_view text) {
    constexpr std::string_view digits = "0123456789";
    std::array<int, 6> numbers{-1, -1, -1, -1, -1, -1};
    for (std::size_t i = 0; i < 6 && !text.empty() && is_digit(text.front()); ++i) {
        const std::size_t size =
            std::min({text.find_first_not_of(digits), text.size(), std::size_t{4}});
        numbers[i] = *digits_at(text, 0, size);
        text.remove_prefix(size);
        if (i < 3)
            text.remove_prefix(std::min(text.find_first_of(digits), text.size()));
        else if (text.starts_with(':'))
            text.remove_prefix(1);
    }
    return numbers;
}

/// "5 h behind", "10 h 30 min ahead of" UTC, to the quarter of an hour.
std::string offset_text(double offset_h) {
    const auto quarters = std::lround(std::abs(offset_h) * 4.0);
    if (quarters == 0) return "equal to";
    return fmt::format("about {} h{} {}", quarters / 4,
                       quarters % 4 == 0 ? "" : fmt::format(" {} min", quarters % 4 * 15),
                       offset_h < 0.0 ? "behind" : "ahead of");
}

/// By the header's local date and time at which the recording began: of the dates by which it
/// differs from the first epoch by at most 14 h, that whose difference is nearest to `expected_h`.
/// Nothing where the header has no date.
std::optional<FirstDay> day_by_header(const Header& header, std::int64_t first_ns,
                                      double expected_h) {
    const auto [day, month, year, hour, minute, second] = numbers_of(header.created);
    const auto date = year < first_year ? std::nullopt : day_number(year, month, day);
    if (!date) return std::nullopt;
    const std::string written = escape_for_message(header.created);
    if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || second > 59)
        return FirstDay{date, fmt::format("The recording gives times of day in UTC; its date is "
                                          "that of its header (\"{}\").",
                                          written)};
    const std::int64_t local_ns =
        ((hour * 60 + minute) * 60 + std::max(second, 0)) * GpsTime::nanoseconds_per_second;
    std::int64_t utc_day = 0;
    double best_h = std::numeric_limits<double>::infinity();
    for (const int shift : {0, -1, 1}) {
        const double offset_h = static_cast<double>(local_ns - first_ns) / 3600e9 - 24.0 * shift;
        if (std::abs(offset_h) > largest_offset_h ||
            std::abs(offset_h - expected_h) >= std::abs(best_h - expected_h))
            continue;
        best_h = offset_h;
        utc_day = *date + shift;
    }
    const GpsTime midnight = GpsTime::from_nanoseconds(utc_day * GpsTime::nanoseconds_per_day);
    return FirstDay{
        utc_day,
        fmt::format("The recording gives times of day in UTC, and in its header the local "
                    "date and time at which it was begun (\"{}\"): its first epoch is taken "
                    "to be on {}, UTC, local time being {} UTC.",
                    written, to_iso(midnight).substr(0, 10), offset_text(best_h))};
}

}  // namespace

std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording) {
    return split_words(line, line.text, recording, '\0', " \t\r");
}

std::string Header::names_place(const RecordingBytes& recording) const {
    const std::vector<Cell>& first = columns.empty() ? channels : columns;
    return place_in(recording, first.empty() ? 1 : first.front().line, 1);
}

Header read_header(LineReader& lines, const RecordingBytes& recording) {
    Header header;
    std::string section;
    while (const auto line = lines.next()) {
        const Cell whole{trim(line->text), &recording, line->number};
        const std::string_view text = whole.text;
        if (text.starts_with('[') && text.ends_with(']')) {
            section = lower_case(trim(text.substr(1, text.size() - 2)));
            if (section == "data") return header;
        } else if (section.empty() && lower_case(text.substr(0, created_on.size())) == created_on) {
            header.created = trim(text.substr(created_on.size()));
        } else if (text.empty()) {
            continue;
        } else if (section == "header") {
            header.channels.push_back(whole);
        } else if (section == "channel units") {
            header.units.push_back(whole);
        } else if (section == "column names") {
            const std::vector<Cell> words = split(*line, recording);
            header.columns.insert(header.columns.end(), words.begin(), words.end());
        } else if (section == "comments" && header.comments.size() < comments_kept) {
            header.comments.push_back(whole);
        }
        if (std::max({header.channels.size(), header.units.size(), header.columns.size()}) >
            most_channels)
            throw Failure(place_in(recording, *line),
                          fmt::format("the header names more than {} channels", most_channels),
                          as_written);
    }
    throw Failure(place_in(recording, 1, 1), "the VBO file has no section [data]",
                  "It holds a header at most; take the whole recording");
}

Layout find_layout(const Header& header, std::size_t fields, const RecordingBytes& recording) {
    const bool by_header = header.columns.size() != fields && header.channels.size() == fields;
    const std::vector<Cell>& named =
        by_header || header.columns.empty() ? header.channels : header.columns;
    Layout layout;
    layout.fields = fields > 0 ? fields : named.size();
    layout.named = layout.unnamed_at = named.size();
    for (std::size_t i = 0; i < names.size(); ++i)
        for (const std::string_view name : csv::words_of(names[i]))
            for (std::size_t field = 0; field < std::min(layout.named, layout.fields); ++field)
                if (!layout.place[i] && unit_behind(name, Column{i}, letters(named[field].text)))
                    layout.place[i] = field;
    const auto speed = find_unit(unit_of(Column::velocity, layout, header, named), Quantity::speed);
    if (layout[Column::velocity]) layout.velocity_m_s = speed ? speed->factor : km_h_in_m_s;
    if (const auto vertical =
            find_unit(unit_of(Column::vertical_velocity, layout, header, named), Quantity::speed))
        layout.vertical_velocity_m_s = vertical->factor;
    if (unit_of(Column::longitude, layout, header, named).starts_with("deg"))
        layout.coordinates = Coordinates::degrees;
    for (const auto& [column, name] :
         {std::pair{Column::time, "time"}, {Column::latitude, "lat"}, {Column::longitude, "long"}})
        if (!layout[column])
            throw Failure(
                header.names_place(recording),
                fmt::format("no column is named \"{}\", or as other writers call it, among {} "
                            "names for {} fields in a row",
                            name, named.size(), layout.fields),
                "Export the recording again with time, latitude and longitude, or as CSV "
                "with columns: in the receiver");
    return layout;
}

void set_device(Observations& observations, const Header& header) {
    Instrument said;
    std::string device;
    for (const Cell& comment : header.comments) {
        const std::size_t colon = comment.text.find(':');
        const bool is_named = colon != std::string_view::npos;
        const std::string name = is_named ? letters(comment.text.substr(0, colon)) : "";
        std::string* const part = name == "type"                               ? &said.model
                                  : name == "firmware"                         ? &said.firmware
                                  : name == "serial" || name == "serialnumber" ? &said.serial
                                                                               : nullptr;
        if (part && part->empty()) *part = instrument_part(comment.text.substr(colon + 1));
        if (!is_named && device.empty() && comment.text.find_first_of("(<") != 0)
            device = instrument_part(comment.text);
    }
    if (!said.model.empty()) device = said.model;
    for (const auto& [what, text] :
         {std::pair{"serial number", said.serial}, {"firmware", said.firmware}})
        if (!text.empty()) device += fmt::format("{}{} {}", device.empty() ? "" : ", ", what, text);
    observations.device = device;
    set_instrument(observations, said);
}

FirstDay find_first_day(const Receiver& receiver, const Header& header, const Survey& surveyed) {
    if (const auto start = attempted_day(receiver))
        return {start, "The date of the first epoch is the attempt's start_date."};
    const std::int64_t first_ns = surveyed.first_time_ns.value_or(0);
    const double sun_h = surveyed.first_longitude_deg.value_or(0.0) / 15.0;
    if (const auto day = day_by_header(header, first_ns, receiver.utc_offset_h.value_or(sun_h)))
        return *day;
    const std::string no_date = fmt::format(
        "The recording gives times of day{}",
        header.created.empty()
            ? " and no date"
            : fmt::format(
                  ", and the date in its header (\"{}\") is not written as 31/12/2023 12:30:00",
                  escape_for_message(header.created)));
    if (!receiver.start_gps)
        return {std::nullopt, no_date +
                                  ": its time is relative until start_date in the receiver says "
                                  "the UTC date of the first epoch."};
    // Leap seconds do not matter to the nearest day.
    const double start_ns = static_cast<double>(receiver.start_gps->nanoseconds());
    return {std::llround((start_ns - static_cast<double>(first_ns)) / GpsTime::nanoseconds_per_day),
            no_date + "; the date is that of the attempt's start_gps.", true};
}

}  // namespace runcert::vbo

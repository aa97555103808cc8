#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/csv/csv.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"

/// FlySight 1 and 2 track files (CSV). Layouts: "File format" of the FlySight wiki for the first,
/// the files' own $COL and $UNIT lines for the second.
namespace runcert::flysight {
namespace {

using enum csv::Column;

/// A column that is read. All but gpsFix are in every file.
struct Field {
    csv::Column meaning;
    std::string_view name, unit;
};
constexpr Field fields[] = {
    {time, "time", ""},           {latitude, "lat", "deg"},        {longitude, "lon", "deg"},
    {height, "hMSL", "m"},        {velocity_north, "velN", "m/s"}, {velocity_east, "velE", "m/s"},
    {velocity_up, "velD", "m/s"}, {quality_2d, "hAcc", "m"},       {quality_height, "vAcc", "m"},
    {sigma_speed, "sAcc", "m/s"}, {satellites, "numSV", ""},       {fix, "gpsFix", ""}};

/// Geodetic coordinates with heights; of an attempt nothing is needed to read them.
csv::Description with_heights() {
    csv::Description description;
    description.has_up = true;
    return description;
}
const csv::Description description = with_heights();
const Receiver no_receiver;

constexpr const char* as_written = "Take the recording as the FlySight wrote it";

/// Whether a column is in that unit. Loggers that write FlySight's columns (Deep and Steep Insight)
/// label a speed's accuracy "m".
bool is_in(const Field& field, std::string_view unit) {
    return unit == field.unit || (field.meaning == sigma_speed && unit == "m");
}

/// The instant of a FlySight 2's time "2026-03-06T00:49:20.-002Z": so many milliseconds before the
/// whole second, as the firmware prints them ("-02" and "-002" are two). Nothing for another time.
std::optional<GpsTime> read_signed_time(const Cell& time) {
    const std::size_t point = time.text.find(".-");
    if (point == std::string_view::npos || !time.text.ends_with('Z')) return std::nullopt;
    const std::string_view digits = time.text.substr(point + 2, time.text.size() - point - 3);
    const auto count = digits_at(digits, 0, digits.size());
    if (digits.empty() || digits.size() > 3 || !count) return std::nullopt;
    Cell second = time;
    second.text = time.text.substr(0, point);
    return read_iso(second, Clock::utc).plus_nanoseconds(std::int64_t{-1'000'000} * *count);
}

/// The layout that a header line names, whose first `skipped` fields are no columns ("$COL,GNSS").
/// `skipped_in_rows` fields stand before the columns in a row. Columns of other names are passed
/// over. Failure where one that must be there is missing or stands twice.
csv::Layout read_columns(const SourceLine& line, const RecordingBytes& recording,
                         std::size_t skipped, std::size_t skipped_in_rows) {
    csv::Layout layout;
    // The largest count of millimetres.
    layout.unknown_from = 4'294'967.0;
    layout.factor[static_cast<std::size_t>(velocity_up)] = -1.0;
    // The accuracy of a speed in three dimensions, of which each component is given its share.
    layout.factor[static_cast<std::size_t>(sigma_speed)] = 1.0 / std::numbers::sqrt3;
    const std::vector<Cell> cells = split_at(line, recording, ',');
    for (std::size_t i = skipped; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        layout.fields = i - skipped + skipped_in_rows + 1;
        const Field* field = std::ranges::find(fields, cell.text, &Field::name);
        if (field == std::end(fields)) continue;
        if (layout[field->meaning])
            cell.fail(fmt::format("the column \"{}\" stands twice", cell.text), as_written);
        layout[field->meaning] = layout.fields - 1;
    }
    for (const Field& field : fields)
        if (!layout[field.meaning] && field.meaning != fix)
            Cell{line.text, &recording, line.number, 1}.fail(
                fmt::format("the header names no column \"{}\": \"{}\"", field.name,
                            escape_for_message(line.text, 80)),
                "A FlySight writes time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,...,numSV; take "
                "the recording as it wrote it");
    return layout;
}

/// Failure where the line of units, its first `skipped` fields left out, gives a column another
/// unit than FlySight does.
void require_units(const SourceLine& line, const RecordingBytes& recording,
                   const csv::Layout& layout, std::size_t skipped, std::size_t skipped_in_rows) {
    const std::vector<Cell> cells = split_at(line, recording, ',');
    for (std::size_t i = skipped; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        std::string_view unit = cell.text;
        if (unit.starts_with('(') && unit.ends_with(')')) unit = unit.substr(1, unit.size() - 2);
        for (const Field& field : fields)
            if (layout[field.meaning] == i - skipped + skipped_in_rows && !is_in(field, unit))
                cell.fail(fmt::format("the column \"{}\" is in \"{}\"; FlySight has it in \"{}\"",
                                      field.name, escape_for_message(unit), field.unit),
                          as_written);
    }
}

/// The row of a line. Failure at the field that cannot be read. `last`: no line follows.
TimedRow read_row(const SourceLine& line, const RecordingBytes& recording,
                  const csv::Layout& layout, bool last) {
    const std::vector<Cell> cells = split_at(line, recording, ',');
    require_count(cells.size(), layout.fields, line, recording, last, "its header names",
                  as_written);
    const RowCells row_cells(std::span<const Cell>(cells), layout);
    TimedRow row;
    const Cell& written = row_cells.cell(time);
    const auto signed_time = read_signed_time(written);
    row.written.time = signed_time ? "0.000" : written.text;
    row.instant = signed_time ? *signed_time : read_iso(written, Clock::utc);
    row.observation.satellites = read_satellites(row_cells.cell(satellites));
    if (row_cells.has(fix))
        row.observation.fix =
            fix_of_ublox(static_cast<unsigned>(read_whole(row_cells.cell(fix), "gpsFix", 0, 5)));
    else if (*row.observation.satellites == 0)
        row.observation.fix = FixType::none;
    if (row.observation.fix == FixType::none) return row;
    // A FlySight leaves no field empty, and writes no unit behind a number.
    for (const Field& field : fields) {
        const std::string_view text = row_cells.text(field.meaning);
        if (field.unit.empty()) continue;
        if (text.empty() || !is_digit(text.back())) (void)row_cells.real(field.meaning, field.name);
        if (text.starts_with('-') && field.name.ends_with("Acc"))
            (void)read_deviation(row_cells.cell(field.meaning), field.name);
    }
    csv::read_solution(cells, layout, description, no_receiver, row);
    return row;
}

constexpr std::string_view marks_of_workings[] = {"slots used in $GNSS", "slots used in GNSS",
                                                  "active mode initialization\""};
constexpr const char* remedy_for_no_positions =
    "Take TRACK.CSV, which the FlySight writes into the same folder";

/// The line without carriage returns that a conversion has left before its end.
std::string_view without_returns(std::string_view text) {
    while (text.ends_with('\r'))
        text.remove_suffix(1);
    return text;
}

/// Whether it is the log that a FlySight 2 keeps of its own workings: `29276.099,"..."`.
bool is_log_of_workings(std::string_view bytes) {
    const auto first = LineReader(bytes).next();
    if (!first) return false;
    const std::string_view text = without_returns(first->text);
    const std::size_t comma = text.find(',');
    return comma != std::string_view::npos && parse_double(text.substr(0, comma)) &&
           text.substr(comma + 1).starts_with('"') &&
           std::ranges::any_of(marks_of_workings, [&](std::string_view mark) {
               return bytes.find(mark) != std::string_view::npos;
           });
}

/// Reads a recording line by line; either version is known by its header.
class FlySightReader {
  public:
    explicit FlySightReader(const RecordingBytes& recording)
        : recording_(recording), lines_(recording), timed_(recording) {}

    Observations read() {
        while (auto line = lines_.next()) {
            const std::string_view text = without_returns(line->text);
            if (text.size() != line->text.size()) doubled_returns_ = true;
            line->text = text;
            if (text.empty()) continue;
            if (text.starts_with('$'))
                read_second(*line);
            else
                read_first(*line);
        }
        if (!layout_) refuse_without_header();
        if (doubled_returns_)
            observations_.notes.push_back(
                "Lines end in two carriage returns: the file was converted after it was recorded.");
        observations_.device = device();
        if (!observations_.device.empty())
            set_instrument(observations_, {.model = "FlySight 2",
                                           .serial = instrument_part(device_),
                                           .firmware = instrument_part(firmware_)});
        set_rows(observations_, std::move(timed_));
        return std::move(observations_);
    }

  private:
    /// Fields before the columns: in a line of names or units of a FlySight 2, and in its rows.
    static constexpr std::size_t named_after = 2, rows_after = 1;

    void read_first(const SourceLine& line) {
        if (!layout_ || line.text.starts_with("time,lat,lon")) {
            layout_ = read_columns(line, recording_, 0, 0);
            observations_.variant = "FlySight 1";
        } else if (line.text.starts_with(",(deg),(deg)")) {
            require_units(line, recording_, *layout_, 0, 0);
        } else if (second_) {
            count_unknown(line);
        } else {
            add_row(line);
        }
    }

    void read_second(const SourceLine& line) {
        const std::string_view text = line.text;
        if (text.starts_with("$GNSS,") && layout_) {
            add_row(line);
        } else if (text.starts_with("$COL,GNSS,")) {
            layout_ = read_columns(line, recording_, named_after, rows_after);
            second_ = true;
            observations_.variant = "FlySight 2";
        } else if (text.starts_with("$UNIT,GNSS,") && layout_) {
            require_units(line, recording_, *layout_, named_after, rows_after);
        } else if (text.starts_with("$COL,")) {
            sensors_.push_back(field(text, 1));
        } else if (text == "$DATA") {
            in_data_ = true;
        } else if (!in_data_) {
            read_variable(text);
        } else if (std::find(sensors_.begin(), sensors_.end(), field(text, 0).substr(1)) ==
                   sensors_.end()) {
            count_unknown(line);
        }
    }

    void add_row(const SourceLine& line) {
        timed_.add_record(line,
                          [&] { return read_row(line, recording_, *layout_, lines_.at_end()); });
    }

    void count_unknown(const SourceLine& line) {
        timed_.count_bad(line,
                         Failure(place_in(recording_, line),
                                 fmt::format("the line begins \"{}\", which no $COL line names",
                                             escape_for_message(field(line.text, 0))),
                                 as_written));
    }

    /// A field of a line, counted from 0; empty where it has fewer.
    static std::string_view field(std::string_view text, int index) {
        for (; index > 0; --index) {
            const std::size_t comma = text.find(',');
            if (comma == std::string_view::npos) return {};
            text.remove_prefix(comma + 1);
        }
        return text.substr(0, text.find(','));
    }

    void read_variable(std::string_view text) {
        constexpr std::string_view firmware = "$VAR,FIRMWARE_VER,", device = "$VAR,DEVICE_ID,";
        if (text.starts_with(firmware)) firmware_ = text.substr(firmware.size());
        if (text.starts_with(device)) device_ = text.substr(device.size());
    }

    std::string device() const {
        if (firmware_.empty() && device_.empty()) return {};
        std::string text = "FlySight 2";
        if (!firmware_.empty()) text += ", firmware " + escape_for_message(firmware_);
        if (!device_.empty()) text += ", device " + escape_for_message(device_);
        return text;
    }

    [[noreturn]] void refuse_without_header() const {
        const std::string where = place_in(recording_, 1, 1);
        if (!sensors_.empty())
            throw Failure(where,
                          "the recording holds a FlySight's sensor readings and no positions",
                          remedy_for_no_positions);
        throw Failure(where,
                      "no line names the columns (\"time,lat,lon,...\" or \"$COL,GNSS,...\")",
                      as_written);
    }

    const RecordingBytes& recording_;
    LineReader lines_;
    std::optional<csv::Layout> layout_;
    bool second_ = false;   ///< a FlySight 2
    bool in_data_ = false;  ///< past the line $DATA
    std::vector<std::string_view> sensors_;
    bool doubled_returns_ = false;
    std::string_view firmware_, device_;
    Observations observations_ = empty_observations("flysight", "geodetic", "utc");
    RowCollector timed_;
};

/// Also those with a damaged header line, and those files of a FlySight 2 that hold no positions,
/// to say so.
bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    for (auto line = lines.next(); line && line->number <= 3; line = lines.next())
        if (line->text.starts_with("$FLYS,") || line->text.starts_with("$COL,GNSS,") ||
            line->text.starts_with("time,lat,lon,hMSL") || line->text.starts_with(",(deg),(deg)"))
            return true;
    return is_log_of_workings(bytes);
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    if (is_log_of_workings(recording.bytes.substr(0, recognised_by)))
        throw Failure(
            place_in(recording, 1, 1),
            "the recording is a FlySight's log of its own workings and holds no positions",
            remedy_for_no_positions);
    Observations observations = FlySightReader(recording).read();
    observations.notes.emplace_back(note_heights_above_sea_level);
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "flysight",
    .what = "FlySight",
    .place = 70,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::flysight

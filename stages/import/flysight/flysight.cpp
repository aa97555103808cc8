#include "stages/import/flysight/flysight.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/flysight/row.h"
#include "stages/import/format.h"
#include "stages/import/row_collector.h"

namespace runcert::flysight {
namespace {

constexpr std::string_view first_header = "time,lat,lon";
constexpr std::string_view first_units = ",(deg),(deg)";
constexpr std::string_view second_mark = "$FLYS,";
constexpr std::string_view second_columns = "$COL,";
constexpr std::string_view second_positions = "$COL,GNSS,";
constexpr std::string_view second_units = "$UNIT,GNSS,";
constexpr std::string_view second_data = "$DATA";
constexpr std::string_view second_row = "$GNSS,";
constexpr const char* remedy_for_no_positions =
    "Take TRACK.CSV, which the FlySight writes into the same folder";

/// The line without carriage returns that a conversion has left before its end.
std::string_view without_returns(std::string_view text) {
    while (text.ends_with('\r'))
        text.remove_suffix(1);
    return text;
}

/// Whether a line is one of what a FlySight 2 logs of its own workings: `29276.099,"..."`.
bool is_working_line(std::string_view text) {
    const std::size_t comma = text.find(',');
    return comma != std::string_view::npos && parse_double(text.substr(0, comma)) &&
           text.substr(comma + 1).starts_with('"');
}

bool is_log_of_workings(std::string_view bytes) {
    LineReader lines(bytes);
    const auto first = lines.next();
    if (!first || !is_working_line(without_returns(first->text))) return false;
    return bytes.find("slots used in $GNSS") != std::string_view::npos ||
           bytes.find("slots used in GNSS") != std::string_view::npos ||
           bytes.find("active mode initialization\"") != std::string_view::npos;
}

/// Reads a recording line by line; either version is known by its header.
class Reader {
  public:
    explicit Reader(const RecordingBytes& recording)
        : recording_(recording), lines_(recording), timed_(recording) {
        observations_.format = "flysight";
        observations_.frame = "geodetic";
        observations_.time_scale = "utc";
    }

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
        set_rows(observations_, std::move(timed_));
        return std::move(observations_);
    }

  private:
    /// Fields before the columns: in a line of names or units of a FlySight 2, and in its rows.
    static constexpr std::size_t named_after = 2, rows_after = 1;

    void read_first(const SourceLine& line) {
        if (!layout_ || line.text.starts_with(first_header)) {
            layout_ = read_columns(line, recording_, 0, 0);
            observations_.variant = "FlySight 1";
        } else if (line.text.starts_with(first_units)) {
            require_units(line, recording_, *layout_, 0, 0);
        } else if (second_) {
            count_unknown(line);
        } else {
            add_row(line);
        }
    }

    void read_second(const SourceLine& line) {
        const std::string_view text = line.text;
        if (text.starts_with(second_row) && layout_) {
            add_row(line);
        } else if (text.starts_with(second_positions)) {
            layout_ = read_columns(line, recording_, named_after, rows_after);
            second_ = true;
            observations_.variant = "FlySight 2";
        } else if (text.starts_with(second_units) && layout_) {
            require_units(line, recording_, *layout_, named_after, rows_after);
        } else if (text.starts_with(second_columns)) {
            sensors_.push_back(field(text, 1));
        } else if (text == second_data) {
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
                                 "Take the recording as the FlySight wrote it"));
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
                      "Take the recording as the FlySight wrote it");
    }

    const RecordingBytes& recording_;
    LineReader lines_;
    std::optional<Layout> layout_;
    bool second_ = false;   ///< a FlySight 2
    bool in_data_ = false;  ///< past the line $DATA
    std::vector<std::string_view> sensors_;
    bool doubled_returns_ = false;
    std::string_view firmware_, device_;
    Observations observations_;
    RowCollector timed_;
};

}  // namespace

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    for (auto line = lines.next(); line && line->number <= 3; line = lines.next())
        if (line->text.starts_with(second_mark) || line->text.starts_with(second_positions) ||
            line->text.starts_with("time,lat,lon,hMSL") || line->text.starts_with(first_units))
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
    Observations observations = Reader(recording).read();
    observations.notes.emplace_back(note_heights_above_sea_level);
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

extern const Format format{
    .name = "flysight",
    .what = "FlySight",
    .place = 70,
    .of_satellites = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::flysight

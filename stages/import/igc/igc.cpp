#include "stages/import/igc/igc.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/finish.h"
#include "stages/import/format.h"
#include "stages/import/igc/header.h"
#include "stages/import/igc/row.h"

namespace runcert::igc {
namespace {

constexpr std::int64_t lines_to_recognise = 400;

/// The date that the attempt states for recordings without one ("2023-07-11").
std::optional<Date> attempted_date(const Receiver& receiver) {
    const std::string& text = receiver.start_date;
    if (text.size() != 10) return std::nullopt;
    const auto part = [&](std::size_t at, std::size_t size) {
        return static_cast<int>(parse_integer(std::string_view(text).substr(at, size)).value_or(0));
    };
    return Date{.year = part(0, 4), .month = part(5, 2), .day = part(8, 2)};
}

/// Gives B records their dates: the header's, and the next day where the time of day starts again.
class Calendar {
  public:
    void set(const Date& date) {
        date_ = date;
        days_later_ = 0;
        last_ns_ = before_last_ns_ = 0;
    }
    bool has_date() const { return date_.has_value(); }

    /// The UTC of a time of day, in the order of the recording. Failure after ten years.
    CalendarTime utc(std::int64_t of_day_ns) {
        if (of_day_ns < last_ns_ - half_day_ns && !returns(of_day_ns)) ++days_later_;
        before_last_ns_ = last_ns_;
        last_ns_ = of_day_ns;
        CalendarTime day{.year = date_->year, .month = date_->month, .day = date_->day};
        if (days_later_ > most_days)
            throw Failure("time", "midnight passes more than 3653 times",
                          "The times of day are garbled");
        if (days_later_ > 0)
            day = GpsTime::from_calendar(day)
                      .plus_nanoseconds(days_later_ * GpsTime::nanoseconds_per_day)
                      .calendar();
        const std::int64_t seconds = of_day_ns / GpsTime::nanoseconds_per_second;
        const bool leap = seconds >= 86'400;
        day.hour = leap ? 23 : static_cast<int>(seconds / 3600);
        day.minute = leap ? 59 : static_cast<int>(seconds / 60 % 60);
        day.second = leap ? 60 : static_cast<int>(seconds % 60);
        day.nanosecond = of_day_ns % GpsTime::nanoseconds_per_second;
        return day;
    }

  private:
    static constexpr std::int64_t half_day_ns = GpsTime::nanoseconds_per_day / 2;
    static constexpr std::int64_t most_days = 3653;

    /// Whether the record before was one wrong time, half a day ahead, and this one goes on from
    /// where the one before that was.
    bool returns(std::int64_t of_day_ns) const {
        return last_ns_ - before_last_ns_ > half_day_ns && before_last_ns_ > 0 &&
               of_day_ns >= before_last_ns_;
    }

    std::optional<Date> date_;
    std::int64_t days_later_ = 0;
    std::int64_t last_ns_ = 0;
    std::int64_t before_last_ns_ = 0;
};

/// What the recorder says of itself in its header.
struct Identity {
    std::string manufacturer;  ///< of record A, with the serial number
    std::string type;          ///< HFFTY
    std::string firmware;      ///< HFRFW

    std::string text() const {
        std::string all;
        for (const std::string* part : {&type, &manufacturer, &firmware}) {
            if (part->empty()) continue;
            if (!all.empty()) all += ", ";
            all += part == &firmware ? "firmware " + *part : *part;
        }
        return all;
    }
};

/// Free text of a header as it may be shown.
std::string shown(std::string_view text) {
    return escape_for_message(trim(text), 60);
}

/// Reads a flight log line by line.
class Reader {
  public:
    Reader(const Receiver& receiver, const RecordingBytes& recording)
        : recording_(recording), timed_(recording) {
        if (const auto date = attempted_date(receiver)) calendar_.set(*date);
    }

    Observations read() {
        LineReader lines(recording_);
        while (const auto line = lines.next())
            if (!line->text.empty()) read_line(*line);
        Observations observations;
        observations.device = identity_.text();
        set_rows(observations, std::move(timed_));
        note_content(observations);
        return observations;
    }

  private:
    void read_line(const SourceLine& line) {
        const Cell cell{line.text, &recording_, line.number, 1};
        switch (line.text[0]) {
            case 'B':
                timed_.add_record(line, [&] { return read_b(cell, line); });
                break;
            case 'A':
                if (identity_.manufacturer.empty())
                    identity_.manufacturer = shown(line.text.substr(1));
                break;
            case 'G':
                ++signature_lines_;
                break;
            case 'H':
            case 'I':
                read_header(cell, line);
                break;
            default:
                // Records C to F and J to Z: task, events, satellites, comments, slower data.
                if (line.text[0] < 'A' || line.text[0] > 'Z') {
                    if (trim(line.text).empty()) break;
                    timed_.count_bad(line, Failure(cell.place(), "the line is no IGC record",
                                                   "Take the recording as the flight recorder "
                                                   "wrote it"));
                }
        }
    }

    TimedRow read_b(const Cell& cell, const SourceLine& line) {
        const bool cut_off = !line.ended && line.text.size() < layout_.record_bytes;
        if (cut_off || !is_fix(cell.text))
            cell.fail(fmt::format("the B record \"{}\" is cut off or garbled",
                                  escape_for_message(cell.text)),
                      "Take the recording as the flight recorder wrote it");
        if (!calendar_.has_date())
            cell.fail("no record HFDTE before this one says which day it is",
                      "Write start_date in the receiver, the UTC date of the first record");
        const std::int64_t of_day_ns = read_time_of_day(cell, layout_);
        TimedRow row = read_fix(cell, layout_, reference_);
        row.instant = instant_of_utc(calendar_.utc(of_day_ns), recording_, line);
        if (row.observation.fix == FixKind::unknown) ++without_height_;
        return row;
    }

    void read_header(const Cell& cell, const SourceLine& line) {
        try {
            if (cell.text[0] == 'I') {
                layout_ = read_extensions(cell);
            } else if (const auto date = read_date(cell)) {
                GpsTime::from_calendar(
                    {.year = date->year, .month = date->month, .day = date->day});
                calendar_.set(*date);
            } else {
                read_h(cell.text);
            }
        } catch (const Failure& failure) {
            timed_.count_bad(line, failure);
        }
    }

    void read_h(std::string_view text) {
        const std::string_view code = header_code(text);
        if (code == "FTY") identity_.type = shown(header_text(text));
        if (code == "RFW") identity_.firmware = shown(header_text(text));
        if (code == "ALG") reference_ = read_altitude_reference(text);
        if (code == "FXA") ++general_accuracies_;
        if (code == "DTM" && text.find("100") == std::string_view::npos &&
            text.find("84") == std::string_view::npos)
            other_datum_ = shown(text);
    }

    void note_heights(Observations& observations) const {
        std::vector<std::string>& notes = observations.notes;
        switch (reference_) {
            case AltitudeReference::ellipsoid:
            case AltitudeReference::none:
                break;
            case AltitudeReference::geoid:
                notes.push_back(
                    "Heights are recorded above the geoid, and were taken as they are: they differ "
                    "from heights above the ellipsoid by the height of the geoid.");
                break;
            case AltitudeReference::not_stated:
                notes.push_back(
                    "The recording does not say whether its GNSS altitudes are above the "
                    "ellipsoid, "
                    "as of approved flight recorders, or the geoid; they were taken as above the "
                    "ellipsoid.");
        }
        if (without_height_ > 0)
            notes.push_back(fmt::format(
                "{} records are marked V, a fix in the plane or none: their altitude is not used.",
                without_height_));
    }

    void note_content(Observations& observations) const {
        std::vector<std::string>& notes = observations.notes;
        note_heights(observations);
        if (!other_datum_.empty())
            notes.push_back(
                fmt::format("The record \"{}\" names another datum than WGS 84, in "
                            "which positions are off by up to hundreds of metres.",
                            other_datum_));
        if (general_accuracies_ > 0 && layout_.of(Extension::fix_accuracy).size == 0)
            notes.push_back(
                "The recording states one accuracy for all fixes (HFFXA), which says nothing of "
                "the single fix and is not used.");
        if (signature_lines_ > 0)
            notes.push_back(fmt::format(
                "The G record (the recorder's own signature, {} line{}) was not checked.",
                signature_lines_, signature_lines_ == 1 ? "" : "s"));
        else
            notes.push_back("The recording has no G record, the recorder's own signature.");
    }

    const RecordingBytes& recording_;
    TimedRows timed_;
    Calendar calendar_;
    Layout layout_;
    AltitudeReference reference_ = AltitudeReference::not_stated;
    Identity identity_;
    std::string other_datum_;
    std::size_t signature_lines_ = 0;
    std::size_t general_accuracies_ = 0;
    std::size_t without_height_ = 0;
};

}  // namespace

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    while (const auto line = lines.next()) {
        if (line->number > lines_to_recognise) break;
        if (is_fix(line->text)) return true;
        if (header_code(line->text) == "DTE" && line->text.size() >= 11 &&
            std::string_view("FOP").find(line->text[1]) != std::string_view::npos)
            return true;
    }
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Observations observations = Reader(receiver, recording).read();
    observations.format = "igc";
    observations.frame = "geodetic";
    observations.time_scale = "utc";
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

extern const Format format{
    .name = "igc",
    .what = "IGC",
    .place = 90,
    .of_satellites = true,
    .time_origin = "UTC of the flight recorder's satellite positions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::igc

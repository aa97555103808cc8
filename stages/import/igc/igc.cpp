#include <fmt/format.h>

#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/format.h"
#include "stages/import/igc/record.h"

/// IGC flight logs: FAI/IGC, Technical Specification for GNSS Flight Recorders, second edition with
/// amendments, appendix A.
namespace runcert::igc {
namespace {

constexpr std::int64_t lines_to_recognise = 400;

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

    /// Record A: the maker's code of three letters, the serial number, and "FLIGHT:1" or the like
    /// behind it. HFFTY: maker and model, with a comma between.
    Instrument instrument() const {
        constexpr std::size_t code_size = 3, least_serial = 3;
        Instrument found{.firmware = firmware};
        const std::size_t comma = type.find(',');
        if (comma != std::string::npos && type.find(',', comma + 1) == std::string::npos) {
            found.make = trim(std::string_view(type).substr(0, comma));
            found.model = trim(std::string_view(type).substr(comma + 1));
        } else {
            found.model = type;
        }
        if (manufacturer.size() < code_size) return found;
        if (found.make.empty()) found.make = manufacturer.substr(0, code_size);
        std::string_view behind = std::string_view(manufacturer).substr(code_size);
        behind = behind.substr(0, behind.find("FLIGHT:"));
        behind = behind.substr(0, behind.find_first_of(" :,;-"));
        if (behind.size() >= least_serial) found.serial = behind;
        return found;
    }
};

/// Free text of a header as it may be shown.
std::string shown(std::string_view text) {
    return escape_for_message(trim(text), 60);
}

/// Reads a flight log line by line.
class IgcReader {
  public:
    IgcReader(const Receiver& receiver, const RecordingBytes& recording)
        : recording_(recording), timed_(recording) {
        if (const auto day = attempted_day(receiver)) clock_.emplace(day);
    }

    Observations read() {
        LineReader lines(recording_);
        while (const auto line = lines.next())
            if (!line->text.empty()) read_line(*line);
        Observations observations;
        observations.time_scale = "utc";  // set_rows asks for it
        observations.device = identity_.text();
        set_instrument(observations, identity_.instrument());
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
                    timed_.count_bad(
                        line, Failure(cell.place(), "the line is no IGC record", take_whole));
                }
        }
    }

    TimedRow read_b(const Cell& cell, const SourceLine& line) {
        const bool cut_off = !line.ended && line.text.size() < layout_.record_bytes;
        if (cut_off || !is_fix(cell.text))
            cell.fail(fmt::format("the B record \"{}\" is cut off or garbled",
                                  escape_for_message(cell.text)),
                      take_whole);
        if (!clock_)
            cell.fail("no record HFDTE before this one says which day it is",
                      "Write start_date in the receiver, the UTC date of the first record");
        const std::int64_t of_day_ns = read_time_of_day(cell, layout_);
        TimedRow row = read_fix(cell, layout_, reference_);
        row.instant = instant_of_record(
            recording_, line, [&] { return clock_->next(of_day_ns, std::exchange(dated_, {})); });
        if (row.observation.fix == FixType::unknown) ++without_height_;
        return row;
    }

    void read_header(const Cell& cell, const SourceLine& line) {
        try {
            if (cell.text[0] == 'I') {
                layout_ = read_extensions(cell);
            } else if (const auto day = read_date(cell)) {
                dated_ = day;
                if (!clock_) clock_.emplace(day);
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
                    "from ellipsoidal heights by the height of the geoid.");
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
    RowCollector timed_;
    std::optional<DayClock> clock_;      ///< once the date is known
    std::optional<std::int64_t> dated_;  ///< by a record HFDTE since the last fix
    Layout layout_;
    AltitudeReference reference_ = AltitudeReference::not_stated;
    Identity identity_;
    std::string other_datum_;
    std::size_t signature_lines_ = 0;
    std::size_t general_accuracies_ = 0;
    std::size_t without_height_ = 0;
};

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

/// Each B record is an epoch.
///
/// The accuracy is that of the B records' extensions FXA and VXA, which give a probability of
/// 95.45 % ("2-sigma"): FXA as a radius, of a circular normal error. A recorder that writes one
/// figure for all fixes in its header (HFFXA) states none of the single fix, and so none here.
Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Observations observations = IgcReader(receiver, recording).read();
    observations.format = "igc";
    observations.frame = "geodetic";
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "igc",
    .what = "IGC",
    .place = 90,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the flight recorder's satellite positions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::igc

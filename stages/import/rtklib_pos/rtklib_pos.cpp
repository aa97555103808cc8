#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/format.h"
#include "stages/import/rtklib_pos/header.h"

/// RTKLIB solution files (.pos), RTKLIB 2.4.3 manual, appendix B.1, and what programs near it
/// write: all coordinates, time and separator variants, read by the names in the header line.
namespace runcert::rtklib_pos {
namespace {

constexpr std::int64_t lines_to_recognise = 200;

std::string_view frame_word(Coordinates coordinates) {
    switch (coordinates) {
        case Coordinates::degrees:
        case Coordinates::degrees_minutes_seconds:
            return "geodetic";
        case Coordinates::earth_centred:
        case Coordinates::baseline:
            break;
    }
    return "ecef";
}

/// Whether a line begins as a row: a date and a time of day, or a week and its seconds, and
/// enough after them.
bool looks_like_row(std::string_view line) {
    const SourceLine source{.text = line};
    const RecordingBytes nameless;
    const auto fields = split_words(source, line, nameless);
    if (fields.size() < 14) return false;
    const auto number = [](const Cell& cell) { return parse_double(cell.text).has_value(); };
    const std::string_view date = fields[0].text;
    const bool calendar = date.size() == 10 && date[4] == '/' && date[7] == '/' &&
                          fields[1].text.find(':') != std::string_view::npos;
    const bool week = date.size() == 4 && number(fields[0]) && number(fields[1]);
    return (calendar || week) && std::all_of(fields.begin() + 2, fields.end(), number);
}

/// Whether a header line names the mode of a solution that an inertial unit takes part in, as GINav
/// writes it: "% mode      : PPK/INS TC".
bool is_inertial(std::string_view line) {
    const std::size_t colon = line.find(':');
    return colon != std::string_view::npos && trim(line.substr(1, colon - 1)) == "mode" &&
           line.find("INS", colon) != std::string_view::npos;
}

/// The columns of an Emlid Reach's .LLH, which has no header line (Emlid documentation, "Solution
/// formats": times are GPST).
constexpr std::string_view llh_columns =
    "% GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) "
    "sdun(m) age(s) ratio";

/// By the file's name: its rows do not say themselves in what time they are.
bool is_llh(const RecordingBytes& recording) {
    if (!lower_case(recording.name).ends_with(".llh")) return false;
    const auto first = LineReader(recording.bytes).next();
    return first && !first->text.starts_with('%');
}

/// Reads a recording line by line, header lines wherever they stand.
class Reader {
  public:
    /// Holds the rows, or gives them to `take` where there is one.
    explicit Reader(const RecordingBytes& recording, TakeRow take = {})
        : recording_(recording), lines_(recording), timed_(recording, std::move(take)) {}

    /// Of what read() read.
    const RowSummary& summary() const { return summary_; }

    Observations read() {
        if (is_llh(recording_)) read_columns({.text = llh_columns, .number = 1});
        while (const auto line = lines_.next()) {
            if (line->text.starts_with('%'))
                read_header_line(*line);
            else if (!trim(line->text).empty())
                read_row_line(*line);
        }
        if (!layout_)
            throw Failure(place_in(recording_, 1, 1), missing_header, remedy_for_missing_header);
        if (other_headers_ > 0)
            observations_.notes.push_back(fmt::format(
                "The file holds {} solutions, one after the other.", other_headers_ + 1));
        if (inertial_)
            observations_.notes.push_back(
                "The header's mode names an inertial unit: positions are estimates of both, and "
                "between solutions predicted.");
        summary_ = timed_.summary();
        set_rows(observations_, std::move(timed_));
        return std::move(observations_);
    }

  private:
    static constexpr const char* missing_header =
        "the .pos has no header line that names the columns (\"%  GPST  latitude(deg) ...\")";
    static constexpr const char* remedy_for_missing_header =
        "Export the solution again with its header (RTKLIB: out-outhead = on)";

    void read_header_line(const SourceLine& line) {
        require_datum(line, recording_);
        if (!layout_) read_processing(line.text, observations_.processing);
        if (const auto base = read_reference_position(line, recording_)) {
            base_.emplace(*base);
            base_line_ = line.number;
        }
        if (is_inertial(line.text)) inertial_ = true;
        if (is_column_line(line.text)) read_columns(line);
    }

    void read_columns(const SourceLine& line) {
        const Layout layout = read_column_line(line, recording_);
        const Cell start{line.text, &recording_, line.number, 1};
        if (layout_ &&
            (layout_->clock != layout.clock || layout_->coordinates != layout.coordinates))
            start.fail(
                "a second header has another time system or other coordinates than the first",
                "Give each solution to the program as a recording of its own");
        if (layout.coordinates == Coordinates::baseline && !base_)
            start.fail("the positions are a baseline, and no line \"% ref pos\" says from where",
                       "Export the solution as latitude/longitude/height, or with RTKLIB's "
                       "processing options in its header");
        if (layout_) {
            layout_ = layout;
            ++other_headers_;
            return;
        }
        layout_ = layout;
        observations_.format = "rtklib-pos";
        observations_.frame = frame_word(layout.coordinates);
        observations_.time_scale = layout.clock == Clock::gps ? "gps" : "utc";
        if (layout.clock == Clock::jst)
            observations_.notes.push_back(
                "Times are recorded in Japan Standard Time; 9 h were taken off for UTC.");
        if (!layout.passed_over.empty())
            observations_.notes.push_back(
                fmt::format("Columns that are not used: {}.", fmt::join(layout.passed_over, ", ")));
        if (layout.coordinates == Coordinates::baseline)
            observations_.notes.push_back(fmt::format(
                "Positions are recorded as a baseline from the base station of line {}, and were "
                "added to its position.",
                base_line_));
    }

    void read_row_line(const SourceLine& line) {
        const Cell start{line.text, &recording_, line.number, 1};
        if (!layout_) start.fail(missing_header, remedy_for_missing_header);
        timed_.add_record(line, [&] {
            const std::vector<Cell> fields =
                split_words(line, line.text, recording_, layout_->separator);
            require_count(fields.size(), layout_->fields, line, recording_, lines_.at_end(),
                          "its header names",
                          "Hand in the solution as the program wrote it, or solve it again");
            const bool baseline = layout_->coordinates == Coordinates::baseline;
            return read_row(fields, *layout_, baseline ? base_ : std::nullopt);
        });
    }

    const RecordingBytes& recording_;
    LineReader lines_;
    std::optional<Layout> layout_;
    std::optional<LocalFrame> base_;
    std::int64_t base_line_ = 0;
    std::size_t other_headers_ = 0;
    bool inertial_ = false;
    Observations observations_;
    RowCollector timed_;
    RowSummary summary_;
};

/// Whether the bytes hold an RTKLIB column header line, or rows that look as if one were missing.
bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    bool header_lines_only = true;
    while (const auto line = lines.next()) {
        if (line->number > lines_to_recognise) break;
        if (is_column_line(line->text)) return true;
        if (line->text.starts_with('%') || trim(line->text).empty()) continue;
        if (header_lines_only && looks_like_row(line->text)) return true;
        header_lines_only = false;
    }
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Observations observations = Reader(recording).read();
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

/// The same without holding its rows: the recording is read once for what they show as a whole, and
/// again when they are asked for.
StreamedRecording read_streamed(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Reader first_pass(recording, [](const Observation&) {});
    StreamedRecording result{
        .head = first_pass.read(), .rows = first_pass.summary().rows, .give = {}};
    const RowChanges changes = apply_attempt(result.head, first_pass.summary(), receiver);
    note_text(result.head, recording);
    result.give = [recording, changes, first = first_pass.summary().first](const TakeRow& take) {
        Reader(recording, [&](Observation& row) {
            row.time.nanoseconds -= first.nanoseconds();
            changes.apply(row);
            take(row);
        }).read();
    };
    return result;
}

}  // namespace

extern const Format format{
    .name = "rtklib-pos",
    .what = "RTKLIB solution, .pos, and Emlid's .LLH",
    .place = 10,
    .of_satellites = true,
    .time_origin = "GPS time of the receiver's measurements, as RTKLIB solved it",
    .recognises = recognises,
    .read = read,
    .read_streamed = read_streamed,
};

}  // namespace runcert::rtklib_pos

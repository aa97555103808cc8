#include "stages/import/csv/csv.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/layout.h"
#include "stages/import/csv/row.h"
#include "stages/import/csv/split.h"
#include "stages/import/format.h"
#include "stages/import/row_collector.h"

namespace runcert::csv {
namespace {

bool is_skipped(const SourceLine& line) {
    return line.text.starts_with('#') || trim(line.text).empty();
}

RowCollector read_rows(const Receiver& receiver, const Description& description,
                       const RecordingBytes& recording) {
    LineReader lines(recording);
    std::optional<SourceLine> line = lines.next();
    while (line && is_skipped(*line))
        line = lines.next();
    RowCollector timed(recording);
    if (!line) return timed;
    const Layout layout = read_layout(receiver, description, *line, recording);
    if (layout.has_header_line) line = lines.next();
    for (; line; line = lines.next()) {
        if (trim(line->text).empty()) continue;
        timed.add_record(*line, [&] {
            const std::vector<Cell> cells = split(*line, recording, layout.delimiter);
            require_count(cells.size(), layout.fields, *line, recording,
                          lines.at_end() && !line->ended, "the first line of the table has",
                          cells.size() > layout.fields && layout.delimiter == ','
                              ? "If numbers have a decimal comma (\"1,5\"), write 1.5"
                              : "Correct the line, or take it out");
            return read_row(cells, layout, description, receiver);
        });
    }
    return timed;
}

std::string time_scale_word(const Receiver& receiver, const Description& description) {
    if (description.time_format == TimeFormat::seconds)
        return receiver.start_gps ? "gps" : "relative";
    return !description.clock.is_gps || description.time_format == TimeFormat::unix ? "utc" : "gps";
}

void note_description(Observations& observations, const Receiver& receiver,
                      const Description& description) {
    if (description.constant_height_m)
        observations.notes.push_back(
            fmt::format("Heights are not recorded; every position is put at the attempt's {} m.",
                        *description.constant_height_m));
    if (receiver.columns.contains("quality_2d"))
        observations.notes.push_back(
            "The recorded horizontal accuracy is a two-dimensional coordinate quality; each "
            "coordinate is given 1/sqrt(2) of it.");
    if (receiver.time_scale == "local")
        observations.notes.push_back(fmt::format(
            "Times are recorded in local time; the attempt's {} h were taken off for UTC.",
            *receiver.utc_offset_h));
    if (description.frame == CoordinateFrame::utm && receiver.columns.contains("sigma_east"))
        observations.notes.push_back(
            "The recorded accuracies are along the UTM grid, and were turned to true east and "
            "north.");
    if (receiver.height_m && !description.constant_height_m)
        observations.notes.push_back("The attempt's height_m is not used.");
}

}  // namespace

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    std::optional<SourceLine> line = lines.next();
    while (line && is_skipped(*line))
        line = lines.next();
    if (!line) return false;
    const char delimiter = find_delimiter(line->text);
    if (line->text.find(delimiter) == std::string_view::npos) return false;
    const RecordingBytes nameless;
    try {
        const std::size_t fields = split(*line, nameless, delimiter).size();
        const auto second = lines.next();
        return fields > 2 && second && split(*second, nameless, delimiter).size() == fields;
    } catch (const Failure&) {
        return false;  // unbalanced quotation marks: no table
    }
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    const Description description = describe(receiver);
    require_text(recording);
    Observations observations;
    observations.facts.georeferenced = description.frame != CoordinateFrame::local_plane;
    observations.facts.vertical_measured =
        description.has_up || description.frame == CoordinateFrame::ecef;
    observations.format = "csv";
    observations.frame = to_text(description.frame);
    observations.time_scale = time_scale_word(receiver, description);
    set_rows(observations, read_rows(receiver, description, recording));
    note_description(observations, receiver, description);
    apply_attempt(observations, receiver, description.time_format == TimeFormat::seconds);
    note_text(observations, recording);
    return observations;
}

extern const Format format{
    .name = "csv",
    .what = "tables whose columns the attempt names",
    .place = 120,
    .time_origin = "the table's time column, whose clock the table does not say",
    .read = read,
};

}  // namespace runcert::csv

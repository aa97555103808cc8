#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/import.h"
#include "stages/import/row_collector.h"

namespace runcert {
namespace {

struct Span {
    GpsTime first, last;
};

Span span_of(const Observations& part) {
    const auto [first, last] = std::minmax_element(
        part.rows.begin(), part.rows.end(),
        [](const Observation& a, const Observation& b) { return a.time < b.time; });
    return {part.facts.first_epoch->plus_nanoseconds(first->time.nanoseconds),
            part.facts.first_epoch->plus_nanoseconds(last->time.nanoseconds)};
}

void require_alike(const Observations& first, const Observations& part,
                   const RecordingBytes& recording) {
    const auto refuse = [&](std::string_view what, std::string_view a, std::string_view b) {
        if (a == b) return;
        throw Failure(
            place_in(recording, 1, 1),
            fmt::format("the {} of this file is {}, that of the first one {}", what, b, a),
            "Give recordings of different kinds as receivers of their own");
    };
    refuse("format", first.format, part.format);
    refuse("coordinate frame", first.frame, part.frame);
    refuse("time scale", first.time_scale, part.time_scale);
    if (part.time_scale == "relative")
        throw Failure(place_in(recording, 1, 1),
                      "the file's times are relative, so nobody can tell how it follows another",
                      "Give one file, or recordings with dates and times");
}

/// The epochs of a file that is given twice would count as two measurements each.
void require_different(const std::vector<RecordingBytes>& recordings) {
    for (std::size_t i = 0; i < recordings.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (recordings[i].bytes == recordings[j].bytes)
                throw Failure(place_in(recordings[i], 1, 1),
                              fmt::format("files {} and {} are the same: the recording is given "
                                          "twice",
                                          j + 1, i + 1),
                              "List each file of the recording once");
}

/// How a file follows the one before it.
std::string seam_text(std::size_t number, const Span& before, const Span& after,
                      double nominal_interval_s) {
    const double step_s = after.first.seconds_since(before.last);
    if (after.last < before.first)
        return fmt::format("File {} lies before file {} in time.", number, number - 1);
    if (step_s <= 0.0)
        return fmt::format("File {} overlaps file {} by {} s.", number, number - 1,
                           format_fixed(-step_s, 3));
    if (step_s > 1.5 * nominal_interval_s)
        return fmt::format("Between files {} and {} {} s are missing.", number - 1, number,
                           format_fixed(step_s, 3));
    return fmt::format("File {} follows file {} without a gap.", number, number - 1);
}

void append_records(RecordCount& all, const RecordCount& part, std::int64_t epochs_before,
                    std::int32_t file) {
    all.total += part.total;
    all.bad += part.bad;
    for (BadRecord bad : part.bad_records) {
        if (all.bad_records.size() >= bad_records_listed_at_most) return;
        bad.epoch += epochs_before;
        bad.file = file;
        all.bad_records.push_back(std::move(bad));
    }
}

std::optional<double> coarser(std::optional<double> a, std::optional<double> b) {
    return a && b ? std::optional(std::max(*a, *b)) : std::nullopt;
}

void append(Observations& all, const Observations& part, std::int8_t file) {
    append_records(all.records, part.records, std::ssize(all.rows), file);
    const std::int64_t offset_ns =
        part.facts.first_epoch->nanoseconds_since(*all.facts.first_epoch);
    all.rows.reserve(all.rows.size() + part.rows.size());
    for (Observation row : part.rows) {
        row.epoch = std::ssize(all.rows) + 1;
        row.time.nanoseconds += offset_ns;
        row.source_file = file;
        all.rows.push_back(row);
    }
    for (const std::string& note : part.notes)
        all.notes.push_back(fmt::format("File {}: {}", file, note));
}

/// Failure where a recording cannot be of these files, whatever they hold: more than 127, or one
/// that is given twice. For before they are read.
void require_joinable(const std::vector<RecordingBytes>& recordings) {
    if (recordings.size() > std::numeric_limits<std::int8_t>::max())
        throw Failure(recordings.front().name,
                      fmt::format("the recording consists of {} files", recordings.size()),
                      "List at most 127; put files of one receiver together before");
    require_different(recordings);
}

/// What the files that say anything of a part of the instrument say alike.
std::optional<Instrument> joined_instrument(const std::vector<Observations>& parts) {
    Instrument all;
    for (std::string Instrument::*part :
         {&Instrument::make, &Instrument::model, &Instrument::serial, &Instrument::firmware,
          &Instrument::antenna}) {
        bool alike = true;
        for (const Observations& each : parts) {
            const std::string said = each.instrument ? (*each.instrument).*part : "";
            if ((all.*part).empty()) all.*part = said;
            alike &= said.empty() || said == all.*part;
        }
        if (!alike) (all.*part).clear();
    }
    return all.empty() ? std::nullopt : std::optional(all);
}

/// The parts of a recording, read from files that follow one another, as one. `parts` and
/// `recordings` go together, at least one; a single part is returned as it is.
Observations join(std::vector<Observations> parts, const std::vector<RecordingBytes>& recordings) {
    if (parts.size() == 1) return std::move(parts.front());
    for (std::size_t i = 0; i < parts.size(); ++i)
        require_alike(parts.front(), parts[i], recordings[i]);
    const Observations& first = parts.front();
    Header header;
    header.programs = first.header.programs;
    Observations all{.header = std::move(header),
                     .facts = first.facts,
                     .format = first.format,
                     .variant = first.variant,
                     .device = first.device,
                     .instrument = joined_instrument(parts),
                     .processing = first.processing,
                     .frame = first.frame,
                     .time_scale = first.time_scale,
                     .accuracy_source = first.accuracy_source,
                     .time_origin = first.time_origin,
                     .solution_source = first.solution_source,
                     .records = {},
                     .notes = {},
                     .rows = {}};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Observations& part = parts[i];
        if (i > 0)
            all.notes.push_back(seam_text(i + 1, span_of(parts[i - 1]), span_of(part),
                                          all.facts.nominal_interval_s));
        all.simulated |= part.simulated;
        all.signed_navigation.insert(all.signed_navigation.end(), part.signed_navigation.begin(),
                                     part.signed_navigation.end());
        all.written_by.insert(all.written_by.end(), part.written_by.begin(), part.written_by.end());
        if (i > 0 && part.processing && all.processing)
            all.processing->files.insert(all.processing->files.end(),
                                         part.processing->files.begin(),
                                         part.processing->files.end());
        all.facts.vertical_measured &= part.facts.vertical_measured;
        all.facts.position_resolution_m =
            coarser(all.facts.position_resolution_m, part.facts.position_resolution_m);
        all.facts.time_resolution_s =
            coarser(all.facts.time_resolution_s, part.facts.time_resolution_s);
        if (part.solution_source != all.solution_source)
            // What one file has by the attempt's word alone stays a claim.
            all.solution_source = part.solution_source == SolutionSource::attempt ||
                                          all.solution_source == SolutionSource::attempt
                                      ? SolutionSource::attempt
                                      : SolutionSource::partly;
        if (part.accuracy_source == "none" || all.accuracy_source == "none")
            all.accuracy_source = "none";
        append(all, part, static_cast<std::int8_t>(i + 1));
    }
    all.facts.nominal_interval_s = median_step_s(all.rows);
    return all;
}

}  // namespace

Observations import_recordings(const Receiver& receiver,
                               const std::vector<RecordingBytes>& recordings,
                               const std::function<ReadRecording>& read_one) {
    require_joinable(recordings);
    std::vector<Observations> parts;
    for (const RecordingBytes& recording : recordings)
        parts.push_back(read_one(receiver, recording));
    return join(std::move(parts), recordings);
}

}  // namespace runcert

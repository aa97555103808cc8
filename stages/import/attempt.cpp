#include "stages/import/attempt.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/claimed_text.h"
#include "stages/import/geoid.h"
#include "stages/import/gpsbabel/gpsbabel.h"
#include "stages/import/import.h"
#include "stages/import/imu/imu.h"
#include "stages/import/phase_table.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/surface/surface.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

/// A receiver's files, opened.
struct OpenFiles {
    std::vector<AttemptFile> files;
    std::vector<FileView> views;

    std::vector<RecordingBytes> of(std::string_view role) const {
        std::vector<RecordingBytes> chosen;
        for (std::size_t i = 0; i < files.size(); ++i)
            if (files[i].role == role)
                chosen.push_back(
                    {.name = files[i].original,
                     .bytes = views[i].bytes(),
                     .passed = [&view = views[i]](std::size_t bytes) { view.release(bytes); }});
        return chosen;
    }
};

OpenFiles open_files(const Receiver& receiver, const AttemptSource& source) {
    OpenFiles open{.files = files_of_receiver(receiver), .views = {}};
    for (const AttemptFile& file : open.files)
        open.views.push_back(open_attempt_file(file, receiver, source));
    return open;
}

/// Solves a RINEX recording, and keeps what the solution consists of.
Observations import_rinex(StageRun& run, const Receiver& receiver, const OpenFiles& open) {
    const auto base = open.of("base");
    const auto rover = open.of("recording");
    const auto navigation = open.of("navigation");
    if (base.empty() || navigation.empty() || rover.size() != 1)
        throw Failure(receiver.place,
                      "a RINEX recording needs one file of the rover, and base: and navigation:",
                      "Name the base station's observations and the navigation file; put several "
                      "files of the rover together before");
    const rinex::Solution solution = rinex::solve(receiver, rover[0], base[0], navigation);
    const std::vector<AttemptFile> names = solution_files(receiver);
    const bool forward = receiver.solution_pass == "forward";
    Observations observations =
        rinex::read(receiver, solution, forward ? names[1].name : names[2].name);
    note_origins(receiver, observations);
    const std::string* texts[] = {&solution.configuration, &solution.forward, &solution.backward};
    for (std::size_t i = 0; i < names.size(); ++i) {
        run.note_input(names[i].role, names[i].name, *texts[i]);
        run.write(names[i].name, *texts[i]);
    }
    return observations;
}

/// What was read whole, as if it came row by row.
StreamedRecording held(Observations observations) {
    StreamedRecording result{.head = {}, .rows = std::ssize(observations.rows), .give = {}};
    auto rows = std::make_shared<std::vector<Observation>>(std::move(observations.rows));
    result.head = std::move(observations);
    result.give = [rows](const TakeRow& take) {
        for (Observation& row : *rows)
            take(row);
    };
    return result;
}

/// Reads a receiver's recording, through another program where it needs one.
StreamedRecording read_receiver(StageRun& run, const Receiver& receiver, const OpenFiles& open,
                                const std::vector<RecordingBytes>& recordings) {
    for (const RecordingBytes& recording : recordings)
        require_readable(recording);
    if (rinex::is_chosen(receiver, recordings.front()))
        return held(import_rinex(run, receiver, open));
    if (!receiver.base.empty() || (!receiver.navigation.empty() && receiver.phase.empty()))
        throw Failure(
            receiver.place, "base and navigation are of use with RINEX alone",
            "Remove these keys, or name the rover's RINEX file as the recording, or as phase");
    if (recordings.size() == 1)
        if (auto by_row = import_streamed(receiver, recordings.front())) {
            note_origins_of_head(receiver, by_row->head);
            return *std::move(by_row);
        }
    Observations observations = import_recordings(receiver, recordings, read_recording);
    if (const std::string bursts = bursts_in(observations.rows); !bursts.empty())
        throw Failure(
            recordings.front().name,
            fmt::format("the time stamps come in bursts ({}): they are those of a computer "
                        "that read a buffer, and not the satellites'",
                        bursts),
            "Record the receiver's own time beside each position (UTC of NMEA, time of "
            "week of UBX); by these stamps no speed can be certified");
    return held(std::move(observations));
}

/// Writes a product's table row by row, as `begin` begins it.
template <class Streamed, class Begin>
void write_table(const StageRun& run, const std::string& name, const Streamed& product,
                 Begin begin) {
    AtomicFile file(run.run_dir() / name);
    auto table = begin(product.head, [&file](std::string_view piece) { file.write(piece); });
    product.give([&table](const auto& row) { table.write(row); });
    table.finish();
    file.commit();
}

/// Positions, and those of them that state their accuracy.
struct StatedAccuracies {
    std::int64_t positions = 0, horizontal = 0, vertical = 0;

    void count(const Observation& row) {
        positions += has_position(row) ? 1 : 0;
        horizontal += row.sigma_east_m ? 1 : 0;
        vertical += row.sigma_up_m ? 1 : 0;
    }
};

/// Refuses a judged receiver's recording none of whose positions could be used by any rule.
void require_accuracy(const Receiver& receiver, const StatedAccuracies& stated, bool with_heights) {
    const bool heights_alone = stated.horizontal > 0;
    if (stated.positions == 0 || (heights_alone && (stated.vertical > 0 || !with_heights))) return;
    throw Failure(receiver.place,
                  fmt::format("the recording states no accuracy of its {} that can be used, nor "
                              "does the attempt: no rule can be decided",
                              heights_alone ? "heights" : "positions"),
                  fmt::format("Write in the receiver what the device's manual says (a watch 2 to 5 "
                              "m, a logger 1 to 2 m, RTK 0.02 m): accuracy: {{{}}}",
                              heights_alone ? "vertical_m: 5"
                                            : "horizontal_m: 3, vertical_m: 5, velocity_mps: 0.3"));
}

/// Returns the time of the latest row, from the first.
ElapsedTime write_rows(const StageRun& run, const Receiver& receiver,
                       const StreamedRecording& observations) {
    AtomicFile file(run.run_dir() / run.file_of(products::observations, receiver));
    TableWriter<Observation> table = begin_observations(
        observations.head, [&file](std::string_view piece) { file.write(piece); });
    ElapsedTime latest;
    StatedAccuracies stated;
    observations.give([&](const Observation& row) {
        table.write(row);
        latest = std::max(latest, row.time);
        stated.count(row);
    });
    table.finish();
    if (receiver.id == run.attempt().receivers.front().id)
        require_accuracy(receiver, stated, observations.head.facts.vertical_measured);
    file.commit();
    return latest;
}

/// Writes the raw phases that a receiver's own file, or else its RINEX recording, holds; and says
/// which they are.
std::string write_phases(const StageRun& run, const Receiver& receiver, const OpenFiles& open) {
    const RecordingBytes raw = open.of(receiver.phase.empty() ? "recording" : "phase").front();
    StreamedPhases phases = import_phases(receiver, raw, open.of("navigation"));
    phases.head.header = run.header();
    write_table(run, run.file_of(products::phase, receiver), phases, begin_phase);
    return fmt::format("{} phases at {} epochs from {} ({})", phases.rows, phases.head.epochs,
                       receiver.phase.empty() ? recording_names(receiver) : receiver.phase,
                       phases.head.format);
}

/// What the recording's own count of time shows at its first epoch, where its times are counts.
std::optional<std::int64_t> count_at_first(const Receiver& receiver, const Observations& head,
                                           const RecordingBytes& recording) {
    if (head.format != "csv" || receiver.time_format != "seconds") return std::nullopt;
    if (head.facts.first_epoch && receiver.start_gps)
        return head.facts.first_epoch->nanoseconds_since(*receiver.start_gps);
    // Counted from the GPS epoch the first epoch is that count.
    Receiver counted = receiver;
    counted.start_gps = GpsTime();
    return read_recording(counted, recording).facts.first_epoch->nanoseconds();
}

/// Writes what the IMU beside a receiver measured, and says how much that is.
std::string write_imu_samples(StageRun run, const Receiver& receiver, const OpenFiles& open,
                              const imu::RecordingSpan& recording) {
    imu::StreamedImu samples = imu::import_imu(receiver, open.of("imu").front(), recording);
    run.use_parameters(reading_of(run.attempt().written(receiver.id), "imu"));
    samples.head.header = run.header();
    write_table(run, run.file_of(products::imu, receiver), samples, begin_imu);
    return fmt::format("{} IMU samples from {} ({})", samples.rows,
                       std::filesystem::path(receiver.imu->file).filename().string(),
                       samples.head.format);
}

/// Writes the surface that a receiver's craft runs on, and says how much that is.
std::string write_ground(StageRun run, const Receiver& receiver, const OpenFiles& open,
                         bool georeferenced) {
    const auto triangles = open.of("triangles");
    surface::StreamedSurface ground = surface::import_surface(
        receiver,
        {.file = open.of("surface").front(),
         .triangles = triangles.empty() ? std::nullopt : std::optional(triangles.front())});
    std::vector<std::string> recordings;
    for (const InputFile& input : run.inputs())
        if (input.role == "recording") recordings.push_back(input.sha256);
    surface::require_of_another_run(receiver, ground.head, recordings, georeferenced);
    run.use_parameters(reading_of(run.attempt().written(receiver.id), "surface"));
    ground.head.header = run.header();
    write_table(run, run.file_of(products::surface, receiver), ground, begin_surface);
    return fmt::format("{} triangles of the surface from {} ({})", ground.head.found.triangles,
                       std::filesystem::path(receiver.surface->file).filename().string(),
                       ground.head.format);
}

void import_receiver(StageRun& run, const Receiver& receiver, const AttemptSource& source) {
    StageRun one = run;
    const OpenFiles open = open_files(receiver, source);
    // Not the attempt as a whole: a claim that changes elsewhere leaves the positions as they are.
    one.use_parameters(reading_of(run.attempt().written(receiver.id)));
    const std::vector<RecordingBytes> recordings = open.of("recording");
    StreamedRecording observations = read_receiver(one, receiver, open, recordings);
    raise_heights(observations, receiver);
    std::vector<RecordingBytes> files = recordings;
    for (const char* role : {"phase", "base", "navigation"})
        for (RecordingBytes& file : open.of(role))
            files.push_back(std::move(file));
    note_writers(files, observations.head);
    for (std::size_t i = 0; i < open.files.size(); ++i) {
        const AttemptFile& file = open.files[i];
        one.note_input(file.role, file.name, open.views[i],
                       std::filesystem::path(file.original).filename().string());
        one.write(file.name, open.views[i]);
    }
    std::vector<CalledProgram> programs = std::move(observations.head.header.programs);
    observations.head.header = one.header();
    observations.head.header.programs = std::move(programs);
    const ElapsedTime latest = write_rows(one, receiver, observations);
    run.say(fmt::format("{} epochs from {} ({})", observations.rows,
                        claimed_value(recording_names(receiver)), observations.head.format));
    if (has_phases(receiver)) run.say(write_phases(one, receiver, open));
    if (has_surface(receiver))
        run.say(write_ground(one, receiver, open, observations.head.facts.georeferenced));
    if (!has_imu(receiver)) return;
    const imu::RecordingSpan span{
        .first_epoch = observations.head.facts.first_epoch,
        .span_s = static_cast<double>(latest.nanoseconds) * 1e-9,
        .count_ns = count_at_first(receiver, observations.head, recordings.front()),
        .utc = observations.head.time_scale == "utc"};
    run.say(write_imu_samples(one, receiver, open, span));
}

}  // namespace

Observations read_recording(const Receiver& receiver, const RecordingBytes& recording) {
    const bool asked = receiver.format == "gpsbabel";
    const bool known_to_it = !is_read_by_itself(receiver, recording) &&
                             gpsbabel::recognises(recording.bytes.substr(0, recognised_by));
    const auto converted = [&] {
        const std::string type = gpsbabel::type_of(receiver, recording);
        return gpsbabel::read_converted(receiver, recording, type,
                                        gpsbabel::convert(type, recording));
    };
    Observations observations =
        asked || known_to_it ? converted() : import_recording(receiver, recording);
    note_origins(receiver, observations);
    return observations;
}

void note_writers(const std::vector<RecordingBytes>& files, Observations& head) {
    if (!head.device.empty()) head.written_by.insert(head.written_by.begin(), head.device);
    for (const RecordingBytes& file : files)
        note_written_by(file, files.size() > 1, head);
}

void import_attempt(StageRun& run, const AttemptSource& source) {
    bring_in_claim(read_attempt(run.attempt_text(), run.attempt_path().string()),
                   run.attempt_text(), source, run.run_dir());
    for (const Receiver& receiver : run.attempt().receivers)
        import_receiver(run, receiver, source);
}

}  // namespace runcert

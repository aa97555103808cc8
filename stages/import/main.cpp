#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/claimed_text.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "schemas/common/document.h"
#include "stages/import/gpsbabel/gpsbabel.h"
#include "stages/import/import.h"
#include "stages/import/imu/imu.h"
#include "stages/import/imu/propose.h"
#include "stages/import/inspect.h"
#include "stages/import/phase_table.h"
#include "stages/import/raw_track.h"
#include "stages/import/recognise.h"
#include "stages/import/recording.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/surface/surface.h"
#include "store/atomic_file.h"
#include "store/yaml_output.h"

using namespace runcert;

namespace {

/// By the clock of this computer, to a second or a few.
GpsTime gps_now() {
    constexpr std::chrono::sys_days gps_epoch{std::chrono::year{1980} / 1 / 6};
    const auto since = std::chrono::system_clock::now() - gps_epoch;
    return gps_from_utc(GpsTime::from_nanoseconds(
                            std::chrono::duration_cast<std::chrono::nanoseconds>(since).count())
                            .calendar());
}

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

/// Reads one recording, through gpsbabel where it is of a format that only gpsbabel knows.
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

/// What a receiver's files say of who wrote them, behind what the recording's format knows of it.
void note_writers(const std::vector<RecordingBytes>& files, Observations& head) {
    if (!head.device.empty()) head.written_by.insert(head.written_by.begin(), head.device);
    for (const RecordingBytes& file : files)
        note_written_by(file, files.size() > 1, head);
}

/// Returns the time of the latest row, from the first.
ElapsedTime write_rows(const StageRun& run, const std::string& file_name,
                       const StreamedRecording& observations) {
    AtomicFile file(run.run_dir() / file_name);
    TableWriter<Observation> table = begin_observations(
        observations.head, [&file](std::string_view piece) { file.write(piece); });
    ElapsedTime latest;
    observations.give([&](const Observation& row) {
        table.write(row);
        latest = std::max(latest, row.time);
    });
    table.finish();
    file.commit();
    return latest;
}

/// Writes the raw phases that a receiver's own file, or else its RINEX recording, holds; and says
/// which they are.
std::string write_phases(const StageRun& run, const Receiver& receiver, const OpenFiles& open) {
    const RecordingBytes raw = open.of(receiver.phase.empty() ? "recording" : "phase").front();
    StreamedPhases phases = import_phases(receiver, raw, open.of("navigation"));
    phases.head.header = run.header();
    AtomicFile file(run.run_dir() / run.file_of(products::phase, receiver));
    TableWriter<PhaseRow> table =
        begin_phase(phases.head, [&file](std::string_view piece) { file.write(piece); });
    phases.give([&table](const PhaseRow& row) { table.write(row); });
    table.finish();
    file.commit();
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
    nlohmann::ordered_json parameters = *run.attempt().stated.at(receiver.id);
    parameters["imu"] = *run.attempt().stated_imus.at(receiver.id);
    run.use_parameters(parameters);
    samples.head.header = run.header();
    AtomicFile file(run.run_dir() / run.file_of(products::imu, receiver));
    TableWriter<ImuRow> table =
        begin_imu(samples.head, [&file](std::string_view piece) { file.write(piece); });
    samples.give([&table](const ImuRow& row) { table.write(row); });
    table.finish();
    file.commit();
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
    nlohmann::ordered_json parameters = *run.attempt().stated.at(receiver.id);
    parameters["surface"] = *run.attempt().stated_surfaces.at(receiver.id);
    run.use_parameters(parameters);
    ground.head.header = run.header();
    AtomicFile file(run.run_dir() / run.file_of(products::surface, receiver));
    TableWriter<SurfaceRow> table =
        begin_surface(ground.head, [&file](std::string_view piece) { file.write(piece); });
    ground.give([&table](const SurfaceRow& row) { table.write(row); });
    table.finish();
    file.commit();
    return fmt::format("{} triangles of the surface from {} ({})", ground.head.found.triangles,
                       std::filesystem::path(receiver.surface->file).filename().string(),
                       ground.head.format);
}

void import_receiver(StageRun& run, const Receiver& receiver, const AttemptSource& source) {
    StageRun one = run;
    const OpenFiles open = open_files(receiver, source);
    // Not the attempt as a whole: a claim that changes elsewhere leaves the positions as they are.
    one.use_parameters(run.attempt().stated.at(receiver.id));
    const std::vector<RecordingBytes> recordings = open.of("recording");
    StreamedRecording observations = read_receiver(one, receiver, open, recordings);
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
    const ElapsedTime latest =
        write_rows(one, one.file_of(products::observations, receiver), observations);
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

/// Brings everything from outside into the run folder: after this stage nothing else is read.
void import_attempt(StageRun& run, const AttemptSource& source) {
    bring_in_claim(read_attempt(run.attempt_text(), run.attempt_path().string()),
                   run.attempt_text(), source, run.run_dir());
    for (const Receiver& receiver : run.attempt().receivers)
        import_receiver(run, receiver, source);
}

/// The navigation file that stands beside raw measurements under the same name, where there is one.
std::optional<std::string> navigation_beside(const std::filesystem::path& path) {
    for (const char* extension : {".nav", ".NAV", ".rnx"}) {
        std::filesystem::path beside = path;
        beside.replace_extension(extension);
        if (beside != path && std::filesystem::exists(beside)) return beside.string();
    }
    return std::nullopt;
}

Section inspect_phases(const Receiver& receiver, const RecordingBytes& raw,
                       std::optional<std::string> navigation) {
    if (!navigation) navigation = navigation_beside(raw.name);
    std::optional<FileView> view;
    std::vector<RecordingBytes> navigations;
    if (navigation) {
        view.emplace(*navigation);
        navigations.push_back({.name = *navigation, .bytes = view->bytes()});
    }
    Observations said;
    note_writers({raw}, said);
    return phases_section(import_phases(receiver, raw, navigations), navigation.value_or(""), said);
}

/// What a recording's positions are; of a table that no format recognises, what they may be.
std::vector<Section> inspect_positions(const Receiver& receiver, const RecordingBytes& recording) {
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    if (rinex::recognises(head)) return {};
    const std::string utf8 = is_utf16(recording.bytes) ? utf8_of_utf16(recording) : std::string();
    const RecordingBytes readable{.name = recording.name,
                                  .bytes = utf8.empty() ? recording.bytes : utf8};
    if (!is_read_by_itself(receiver, readable) && !gpsbabel::recognises(head)) {
        if (auto ground = surface::describe(readable)) return {*std::move(ground)};
        if (const auto imu = imu::propose(readable)) return {imu::section_of(*imu)};
        refuse_not_read(readable, false);
        require_text(readable);
        if (std::vector<Section> table = table_sections(readable); !table.empty()) return table;
    }
    Observations observations = read_recording(receiver, recording);
    note_writers({recording}, observations);
    std::vector<Section> sections{positions_section(inspect(observations), gps_now())};
    if (imu::is_rawimu(head))
        if (const auto imu = imu::propose(recording)) sections.push_back(imu::section_of(*imu));
    return sections;
}

/// With no character in any text that a reader of the JSON could stumble over.
nlohmann::ordered_json plain(nlohmann::ordered_json json) {
    if (json.is_string()) return plain_text(json.get<std::string>());
    if (json.is_structured())
        for (auto& each : json)
            each = plain(std::move(each));
    return json;
}

Receiver inspected_receiver(const std::string& path) {
    Receiver receiver;
    receiver.id = "inspected";
    receiver.recordings = {path};
    receiver.format = "auto";
    receiver.place = path;
    return receiver;
}

/// Prints a recording as it is, to be drawn: JSON, a list for each member of `RawTrack`.
int track_of_file(const std::string& path) {
    const FileView file(path);
    const RawTrack track =
        raw_track(read_recording(inspected_receiver(path), {.name = path, .bytes = file.bytes()}));
    nlohmann::ordered_json json;
    json["time_s"] = track.time_s;
    const auto add = [&](const char* name, const std::vector<std::optional<double>>& values) {
        auto& list = json[name] = nlohmann::ordered_json::array();
        for (const auto& value : values)
            list.push_back(value ? nlohmann::ordered_json(*value) : nullptr);
    };
    add("east_m", track.east_m);
    add("north_m", track.north_m);
    add("height_m", track.height_m);
    add("recorded_speed_m_s", track.recorded_speed_m_s);
    add("position_speed_m_s", track.position_speed_m_s);
    add("sigma_horizontal_m", track.sigma_horizontal_m);
    json["gaps"] = track.gaps;
    fmt::print("{}\n", json.dump());
    return 0;
}

/// Prints what a recording is, as the JSON of a document. Where raw measurements cannot be read,
/// what the positions are stands there all the same.
int inspect_file(const std::string& path, std::optional<std::string> navigation) {
    const FileView file(path);
    const Receiver receiver = inspected_receiver(path);
    const RecordingBytes recording{.name = path, .bytes = file.bytes()};
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    Document document{.title = path, .sections = inspect_positions(receiver, recording)};
    const auto print = [&] { fmt::print("{}\n", plain(members_json(document)).dump()); };
    try {
        if (document.sections.empty() || has_phases(head))
            document.sections.push_back(inspect_phases(receiver, recording, std::move(navigation)));
    } catch (const Failure&) {
        if (!document.sections.empty()) print();
        throw;
    }
    print();
    return 0;
}

/// The receiver that these keys, a map as an attempt writes one, describe.
Receiver receiver_of(const std::string& path, const std::string& keys) {
    const std::string where = "the receiver of " + path;
    nlohmann::ordered_json receiver = json_from_yaml(YamlValue(parse_yaml(keys, where), where));
    receiver["id"] = "recognised";
    receiver["recording"] = path;
    const nlohmann::ordered_json attempt{
        {"schema", attempt_schema().name() + "/" + attempt_schema().version()},
        {"id", "recognised"},
        {"craft", {{"name", "any"}, {"class", "other"}}},
        {"receivers", nlohmann::ordered_json::array({receiver})},
        {"profiles", nlohmann::ordered_json::array({"nalsa"})}};
    return read_attempt(to_yaml_text(attempt), where).receivers.front();
}

/// Reads what a format recognises. A key that it cannot be read without is stated by a value that
/// it can be read with, and said to be needed.
Observations read_somehow(Receiver& receiver, const RecordingBytes& recording,
                          std::vector<NeededKey>& needed) {
    try {
        return read_recording(receiver, recording);
    } catch (const Failure& failure) {
        Receiver by_utc = receiver, by_date = receiver;
        by_utc.time_scale = "utc";
        by_date.start_date = "2000-01-01";
        const auto try_with = [&](Receiver& stated, NeededKey key) -> std::optional<Observations> {
            try {
                Observations read = read_recording(stated, recording);
                needed.push_back(std::move(key));
                receiver = stated;
                return read;
            } catch (const Failure&) {
                return std::nullopt;
            }
        };
        if (receiver.time_scale.empty())
            if (auto read = try_with(by_utc, {.key = "time_scale",
                                              .reason = "Nothing in the recording says whether its "
                                                        "times are UTC or local time.",
                                              .values = {"utc", "local"},
                                              .required = true}))
                return *std::move(read);
        if (receiver.start_date.empty())
            if (auto read = try_with(by_date, {.key = "start_date",
                                               .reason = "The recording has times of day and no "
                                                         "date.",
                                               .values = {},
                                               .required = true}))
                return *std::move(read);
        throw failure;
    }
}

Recognition recognised_positions(Receiver receiver, const RecordingBytes& recording) {
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    const std::string utf8 = is_utf16(recording.bytes) ? utf8_of_utf16(recording) : std::string();
    const RecordingBytes readable{.name = recording.name,
                                  .bytes = utf8.empty() ? recording.bytes : utf8};
    if (!receiver.columns.empty() && !receiver.frame)
        return recognition_of_table(readable, receiver.columns);
    if (receiver.columns.empty() && !is_read_by_itself(receiver, readable) &&
        !gpsbabel::recognises(head)) {
        if (auto ground = surface::recognise(readable)) return *std::move(ground);
        if (const auto imu = imu::propose(readable)) return imu::recognition_of(*imu);
        refuse_not_read(readable, false);
        require_text(readable);
        Recognition series{.kind = RecordingKind::series, .series = series_in(readable)};
        return series.series.empty() ? recognition_of_table(readable) : series;
    }
    std::vector<NeededKey> needed;
    const Observations observations = read_somehow(receiver, recording, needed);
    Recognition is = recognition_of(observations, receiver);
    is.needed.insert(is.needed.begin(), needed.begin(), needed.end());
    try {
        is.raw_signals = is.format == "ubx" && has_phases(head) &&
                         import_phases(receiver, recording, {}).rows > 0;
    } catch (const Failure&) {
        // Without orbits of its own: its positions alone are used.
    }
    return is;
}

/// Prints what a file is to a program that writes an attempt, as JSON; `keys` are those that the
/// receiver is to be read by.
int recognise_file(const std::string& path, const std::string& keys) {
    const FileView file(path);
    const RecordingBytes recording{.name = path, .bytes = file.bytes()};
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    require_readable(recording);
    Recognition is;
    if (is_navigation(head) || rinex::recognises(head)) {
        is.kind = is_navigation(head) ? RecordingKind::orbits : RecordingKind::signals;
        is.format = "rinex";
    } else {
        is = recognised_positions(receiver_of(path, keys), recording);
    }
    fmt::print("{}\n", plain(members_json(is)).dump());
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if ((argc == 3 || argc == 4) && std::string_view(argv[1]) == "--inspect")
        return guarded_main([&] {
            return inspect_file(argv[2],
                                argc == 4 ? std::optional<std::string>(argv[3]) : std::nullopt);
        });
    if (argc == 3 && std::string_view(argv[1]) == "--track")
        return guarded_main([&] { return track_of_file(argv[2]); });
    if ((argc == 3 || argc == 4) && std::string_view(argv[1]) == "--recognise")
        return guarded_main([&] { return recognise_file(argv[2], argc == 4 ? argv[3] : "{}"); });
    std::string folder;
    std::string earlier_run;
    return stage_main(
        argc, argv, "import",
        "Any supported recording to one table of WGS 84 positions in GPS time",
        [&](StageRun& run) {
            AttemptSource source{.file = run.attempt_path()};
            if (!folder.empty()) source.folder = folder;
            if (!earlier_run.empty()) source.earlier_run = earlier_run;
            import_attempt(run, source);
        },
        [&](CommandLine& line) {
            line.text("--folder", folder,
                      "folder that what the attempt names is relative to and must be inside "
                      "of (default: the attempt's)");
            line.text("--earlier-run", earlier_run,
                      "take recordings and profiles from this run folder's copies instead of "
                      "where the attempt says");
        });
}

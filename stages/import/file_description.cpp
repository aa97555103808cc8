#include "stages/import/file_description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "stages/import/attempt.h"
#include "stages/import/gpsbabel/gpsbabel.h"
#include "stages/import/import.h"
#include "stages/import/imu/imu.h"
#include "stages/import/imu/propose.h"
#include "stages/import/inspect.h"
#include "stages/import/phase_table.h"
#include "stages/import/raw_track.h"
#include "stages/import/recognise.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/surface/surface.h"
#include "store/yaml_output.h"

namespace runcert {
namespace {

/// By the clock of this computer, to a second or a few.
GpsTime gps_now() {
    constexpr std::chrono::sys_days gps_epoch{std::chrono::year{1980} / 1 / 6};
    const auto since = std::chrono::system_clock::now() - gps_epoch;
    return gps_from_utc(GpsTime::from_nanoseconds(
                            std::chrono::duration_cast<std::chrono::nanoseconds>(since).count())
                            .calendar());
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

/// Adds what raw measurements hold, with the orbits of that file, or of one beside them. Where it
/// cannot be read for want of orbits that nobody named, that is said.
void describe_phases(const Receiver& receiver, const RecordingBytes& raw,
                     const std::string& named_navigation, Recognition& is) {
    const std::string navigation =
        !named_navigation.empty() ? named_navigation : navigation_beside(raw.name).value_or("");
    std::optional<FileView> view;
    std::vector<RecordingBytes> navigations;
    if (!navigation.empty()) {
        view.emplace(navigation);
        navigations.push_back({.name = navigation, .bytes = view->bytes()});
    }
    Observations said;
    note_writers({raw}, said);
    try {
        const StreamedPhases phases = import_phases(receiver, raw, navigations);
        is.raw_signals = is.format == "ubx" && navigations.empty() && phases.rows > 0;
        add_phases(phases, navigation, said, is);
    } catch (const Failure& failure) {
        if (!navigation.empty()) throw;
        is.concerns.push_back(
            {.code = ConcernCode::reading,
             .says = fmt::format("Its raw measurements cannot be read: {} {}",
                                 sentence(failure.problem()), sentence(failure.remedy()))});
    }
}

/// With no character in any text that a reader of the JSON could stumble over.
nlohmann::ordered_json plain(nlohmann::ordered_json json) {
    if (json.is_string()) return plain_text(json.get<std::string>());
    if (json.is_structured())
        for (auto& each : json)
            each = plain(std::move(each));
    return json;
}

/// The receiver that these keys, a map as an attempt writes one, describe.
Receiver receiver_of(const std::string& path, const std::string& keys) {
    const std::string where = "the receiver of " + path;
    nlohmann::ordered_json receiver = json_from_yaml(YamlValue(parse_yaml(keys, where), where));
    receiver["id"] = "described";
    receiver["recording"] = "recording";  // its name may hold what no attempt can
    const nlohmann::ordered_json attempt{
        {"schema", attempt_schema().name() + "/" + attempt_schema().version()},
        {"id", "described"},
        {"craft", {{"name", "any"}, {"class", "other"}}},
        {"receivers", nlohmann::ordered_json::array({receiver})},
        {"profiles", nlohmann::ordered_json::array({"nalsa"})}};
    Receiver read = read_attempt(to_yaml_text(attempt), where).receivers.front();
    read.recordings = {path};
    return read;
}

/// Reads a recording of a recognised format. A required key that the attempt would have to state is
/// given a value that the recording can be read with, and listed as needed.
Observations read_with_needed_keys(Receiver& receiver, const RecordingBytes& recording,
                                   std::vector<NeededKey>& needed) {
    try {
        return read_recording(receiver, recording);
    } catch (const Failure& failure) {
        Receiver by_utc = receiver, by_date = receiver;
        by_utc.time_scale = "utc";
        by_date.start_date = "2000-01-01";
        const auto try_with = [&](const Receiver& stated,
                                  const char* key) -> std::optional<Observations> {
            try {
                Observations read = read_recording(stated, recording);
                needed.push_back(needed_key(key, true));
                receiver = stated;
                return read;
            } catch (const Failure&) {
                return std::nullopt;
            }
        };
        if (receiver.time_scale.empty())
            if (auto read = try_with(by_utc, "time_scale")) {
                needed.back().values = {"utc", "local"};  // the first reads it
                return *std::move(read);
            }
        if (receiver.start_date.empty())
            if (auto read = try_with(by_date, "start_date")) return *std::move(read);
        throw failure;
    }
}

Recognition of_series(std::vector<std::string> keys) {
    Recognition is{.kind = RecordingKind::series, .series = std::move(keys)};
    FactGroup group{.title = "Series"};
    add_fact(group, "Of the key", fmt::format("{}", fmt::join(is.series, " or ")));
    is.said.push_back(std::move(group));
    return is;
}

/// What no format recognises: a surface, an IMU's samples, a series, or a table of positions.
Recognition describe_unrecognised(const RecordingBytes& file) {
    if (auto ground = surface::recognise(file)) return *std::move(ground);
    if (const auto imu = imu::propose(file)) return imu::recognition_of(*imu);
    refuse_not_read(file, false);
    require_text(file);
    if (auto keys = series_in(file); !keys.empty()) return of_series(std::move(keys));
    return recognition_of_table(file, {}, gps_now());
}

/// Whether the log holds phases and orbits of its own.
bool has_raw_signals(const Receiver& receiver, const RecordingBytes& recording) {
    try {
        return import_phases(receiver, recording, {}).rows > 0;
    } catch (const Failure&) {
        return false;  // its positions alone are used
    }
}

/// What a file is that is no RINEX.
Recognition describe_recording(Receiver receiver, const RecordingBytes& recording) {
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    const std::string utf8 = is_utf16(recording.bytes) ? utf8_of_utf16(recording) : std::string();
    const RecordingBytes readable{.name = recording.name,
                                  .bytes = utf8.empty() ? recording.bytes : utf8};
    if (!receiver.columns.empty() && !receiver.frame)
        return recognition_of_table(readable, receiver.columns, gps_now());
    if (receiver.columns.empty() && !is_read_by_itself(receiver, readable) &&
        !gpsbabel::recognises(head))
        return describe_unrecognised(readable);
    std::vector<NeededKey> needed;
    Observations observations = read_with_needed_keys(receiver, recording, needed);
    note_writers({recording}, observations);
    Recognition is = recognition_of(observations, receiver, gps_now());
    is.needed.insert(is.needed.begin(), needed.begin(), needed.end());
    is.raw_signals = is.format == "ubx" && has_phases(head) && has_raw_signals(receiver, recording);
    if (imu::is_rawimu(head))
        if (const auto imu = imu::propose(recording))
            for (FactGroup& group : imu::recognition_of(*imu).said)
                is.said.push_back(std::move(group));
    return is;
}

/// Fills in what a file is. Where it fails, what was found until then is there.
void describe(const std::string& path, const std::string& keys,
              const std::optional<std::string>& navigation, Recognition& is) {
    const FileView file(path);
    const RecordingBytes recording{.name = path, .bytes = file.bytes()};
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    const Receiver receiver = receiver_of(path, keys);
    require_readable(recording);
    const bool orbits = is_navigation(head), signals = !orbits && rinex::recognises(head);
    if (orbits || signals) {
        is.kind = orbits ? RecordingKind::orbits : RecordingKind::signals;
        is.format = "rinex";
        FactGroup group{.title = orbits ? "Orbits" : "Raw signals"};
        add_fact(group, "Format", orbits ? "RINEX navigation" : "RINEX observations");
        is.said.push_back(std::move(group));
    } else {
        is = describe_recording(receiver, recording);
    }
    if (orbits || !(signals || has_phases(head))) return;
    if (navigation)
        describe_phases(receiver, recording, *navigation, is);
    else
        is.raw_signals = is.format == "ubx" && has_raw_signals(receiver, recording);
}

/// Prints a recording as it is, to be drawn: JSON, a list for each member of `RawTrack`.
int track_of_file(const std::string& path) {
    const FileView file(path);
    const RawTrack track =
        raw_track(read_recording(receiver_of(path, "{}"), {.name = path, .bytes = file.bytes()}));
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

}  // namespace

int describe_main(const std::vector<std::string>& words) {
    if (words.size() < 2)
        throw Failure(words.front(), "no file is named", "Name the file behind it");
    if (words.front() == "--track") return track_of_file(words[1]);
    Recognition is;
    const auto print = [&] { fmt::print("{}\n", plain(members_json(is)).dump()); };
    try {
        describe(words[1], words.size() > 2 ? words[2] : "{}",
                 words.size() > 3 ? std::optional(words[3]) : std::nullopt, is);
    } catch (const Failure&) {
        if (!is.said.empty()) print();
        throw;
    }
    print();
    return 0;
}

}  // namespace runcert

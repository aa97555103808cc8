#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text.h"
#include "draft/draft.h"
#include "draft/fitting_rules.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"

// What an attempt may say that no recording answers.

namespace runcert {

using Json = nlohmann::ordered_json;

/// Finds what is not answered.
class DraftGaps {
  public:
    explicit DraftGaps(const Draft& draft) : draft_(draft) {}

    std::vector<Gap> found() {
        add_craft();
        add_rules();
        add_people();
        add_record();
        for (const ArrangedReceiver& receiver : draft_.arrangement_.receivers)
            add_receiver(receiver);
        for (const auto& [key, file] : draft_.arrangement_.series)
            add_series(key, draft_.files_[file].path);
        add_of_rules();
        return std::move(gaps_);
    }

  private:
    bool has(std::string_view key) const { return draft_.keys_.contains(key); }
    std::string craft(const char* key) const {
        return has("craft") ? draft_.keys_["craft"].value(key, "") : "";
    }
    void add(Gap gap) { gaps_.push_back(std::move(gap)); }

    std::optional<GpsTime> when() const {
        for (const HandedIn& file : draft_.files_)
            if (file.is.first) return file.is.first;
        return std::nullopt;
    }

    void add_craft() {
        if (craft("name").empty())
            add({.key = "craft.name",
                 .question = "Name of the craft",
                 .why = "The certificate names what was sailed, driven or flown.",
                 .required = true,
                 .example = "\"...\""});
        if (!craft("class").empty()) return;
        Gap gap{.key = "craft.class",
                .question = "Kind of craft",
                .why = "It sets what motions are possible and which fix types may be used.",
                .required = true,
                .values = attempt_schema().find("craft.class")->values,
                .example = "..."};
        if (std::ranges::any_of(draft_.files_, [](const HandedIn& file) {
                return file.is.falls || file.is.format == "flysight";
            }))
            gap.proposal = "skydiver";
        add(std::move(gap));
    }

    void add_rules() {
        if (has("profiles")) return;
        Gap gap{.key = "profiles",
                .question = "Rule or rules",
                .why = "A rule says which speed counts, and what must be met.",
                .required = true,
                .example = "[...]"};
        const std::string of_class = craft("class");
        gap.values = fitting_rules(of_class, when());
        if (!gap.values.empty())
            gap.proposal = gap.values.front();
        else if (!of_class.empty())
            gap.why += fmt::format(
                " None that comes with the program is for the class {}. Any may be claimed, as "
                "nalsa (3 s) or fisly (2 s), or a rule file of your own.",
                of_class);
        add(std::move(gap));
    }

    void add_people() {
        if (!has("pilot"))
            add({.key = "pilot",
                 .question = "Pilot",
                 .why = "The certificate names who sailed, drove or flew.",
                 .example = "\"...\""});
        if (!has("place"))
            add({.key = "place",
                 .question = "Place",
                 .why = "The certificate names where it was.",
                 .example = "\"...\""});
        if (!has("officials"))
            add({.key = "officials",
                 .question = "Officials, each by role and name (measurer Ann Lee)",
                 .why = "They answer for what no recording shows, and sign.",
                 .example = "[{role: measurer, name: \"...\"}, {role: judge, name: \"...\"}]"});
    }

    void add_record() {
        const std::vector<std::string> rules = draft_.profiles();
        if (rules.size() > 1 && !has("record")) {
            for (const std::string& rule : rules)
                add_record_under(rule, rule == rules.front());
            return;
        }
        const bool speed = has("record") && draft_.keys_["record"].contains("speed");
        if (!speed && !has("records"))
            add({.key = "record.speed",
                 .question = "Record to beat, with its unit (202.9 km/h)",
                 .why = "Without one the speed is measured, and compared with nothing.",
                 .example = "{speed: ..., unit: km/h, source: \"...\"}"});
        if (speed && !draft_.keys_["record"].contains("source"))
            add({.key = "record.source",
                 .question = "Where that record is published",
                 .why = "Who reads the certificate must be able to look it up.",
                 .required = true,
                 .example = "\"...\""});
    }

    /// Under one of several rules.
    void add_record_under(const std::string& rule, bool first) {
        const Json* record = nullptr;
        if (has("records"))
            for (const Json& one : draft_.keys_["records"])
                if (one["profile"] == rule) record = &one;
        if (!record)
            add({.key = "records." + rule,
                 .question =
                     fmt::format("Record to beat under {}, with its unit (202.9 km/h)", rule),
                 .why = first ? "Without one the speed is measured, and compared with nothing."
                              : "As under the rule before.",
                 .example = fmt::format("{{profile: {}, speed: ..., unit: km/h, source: \"...\"}}",
                                        rule)});
        else if (!record->contains("source"))
            add({.key = "records." + rule + ".source",
                 .question = fmt::format("Where the record under {} is published", rule),
                 .why = "Who reads the certificate must be able to look it up.",
                 .required = true,
                 .example = "\"...\""});
    }

    /// What its recordings need, of several what the first does; of a day's what any does.
    std::vector<NeededKey> needed_of(const ArrangedReceiver& receiver) const {
        std::vector<NeededKey> needed;
        for (const std::size_t i : receiver.recordings)
            for (const NeededKey& one : draft_.files_[i].is.needed)
                if (std::ranges::find(needed, one.key, &NeededKey::key) == needed.end())
                    needed.push_back(one);
        if (draft_.of_day_)
            for (const HandedIn& file : draft_.files_)
                for (const NeededKey& one : file.is.needed)
                    if (std::ranges::find(needed, one.key, &NeededKey::key) == needed.end())
                        needed.push_back(one);
        return needed;
    }

    void add_receiver(const ArrangedReceiver& arranged) {
        Json receiver;
        for (const Json& one : draft_.keys_["receivers"])
            if (one["id"] == arranged.id) receiver = one;
        const std::string before = "receivers." + arranged.id + ".";
        const std::string of = draft_.arrangement_.receivers.size() > 1
                                   ? fmt::format(" (of the {} receiver)", arranged.id)
                                   : "";
        const auto is_said = [&](const std::string& key) {
            const std::size_t point = key.find('.');
            if (point == std::string::npos) return receiver.contains(key);
            const std::string map = key.substr(0, point);
            return receiver.contains(map) && receiver[map].contains(key.substr(point + 1));
        };
        if (draft_.files_[arranged.recordings.front()].is.kind == RecordingKind::signals)
            add_of_signals(receiver, before);
        for (const NeededKey& needed : needed_of(arranged)) {
            if (is_said(needed.key)) continue;
            // A GPS time is asked for as one that the first row's date and time give.
            add({.key = before + needed.key,
                 .question = question_of(needed.key) + of,
                 .why = needed.reason,
                 .required = needed.required,
                 .values = needed.values,
                 .proposal = needed.key == "time_scale" ? needed.values.front() : "",
                 .example = example_of(needed)});
        }
        if (receiver.value("time_scale", "") == "local" && !receiver.contains("utc_offset_h"))
            add({.key = before + "utc_offset_h",
                 .question = "Hours by which local time is ahead of UTC" + of,
                 .why = "The recording's times are local.",
                 .required = true,
                 .example = "..."});
        add_fix_types(receiver, arranged);
        if (arranged.imu) add_imu(receiver["imu"], before + "imu.", arranged);
        if (arranged.surface) add_surface(receiver, before, arranged);
        const std::string of_class = craft("class");
        const bool on_ground = of_class != "skydiver" && of_class != "board";
        const bool over_surface = arranged.surface.has_value();
        if (arranged.id == "primary" && (on_ground || over_surface) &&
            !receiver.contains("antenna_height_m"))
            add({.key = before + "antenna_height_m",
                 .question = "Height of the antenna above the ground, in metres" + of,
                 .why = over_surface ? "Heights of positions are compared with the surface by it."
                                     : "The report states it: an antenna up a mast moves when the "
                                       "craft heels.",
                 .required = over_surface,
                 .example = "..."});
    }

    /// What the file of a surface does not say.
    void add_surface(const Json& receiver, const std::string& before,
                     const ArrangedReceiver& arranged) {
        const Json& surface = receiver["surface"];
        const std::string name = draft_.files_[*arranged.surface].path;
        const bool on_plane = surface.value("frame", Json()) == "local_plane";
        bool heights_asked = false;
        const auto ask = [&](const NeededKey& needed, const std::string& question) {
            const std::string key = needed.key.substr(needed.key.find('.') + 1);
            if (surface.contains(key)) return;
            add({.key = before + needed.key,
                 .question = fmt::format("{}: {}", name, question),
                 .why = needed.reason,
                 .required = needed.required,
                 .values = needed.values,
                 .example = example_of(needed)});
        };
        for (const NeededKey& needed : draft_.files_[*arranged.surface].is.needed) {
            heights_asked = heights_asked || needed.key == "surface.heights";
            if (needed.key != "surface.heights" || !on_plane) ask(needed, question_of(needed.key));
        }
        if (surface.contains("frame") && !on_plane && !heights_asked)
            ask({.key = "surface.heights",
                 .reason = "Receivers measure ellipsoidal heights.",
                 .values = {"ellipsoid", "geoid"},
                 .required = true},
                question_of("surface.heights"));
        if (surface.value("heights", "") == "geoid")
            ask({.key = "surface.undulation_m",
                 .reason = "It makes the surface's heights ellipsoidal, as a receiver's are.",
                 .required = true},
                "height of the geoid above the ellipsoid at the course, in metres");
        if (on_plane && receiver.value("frame", Json()) != "local_plane" && !has("origin"))
            add({.key = "origin",
                 .question = "Place of the surface's origin: latitude and longitude in degrees, "
                             "height in metres (-31.6 136.0 110)",
                 .why = "A surface in an engineering CRS is counted from it.",
                 .required = true,
                 .example = "{latitude_deg: ..., longitude_deg: ..., height_m: ...}"});
    }

    /// What an IMU's times can be beside the recording's.
    enum class ImuTimes { told, counted_from_first, unknown };
    static ImuTimes times_of(const Recognition& imu, const Recognition& recording) {
        // A date, or the recording's own count.
        if (imu.first || !imu.count_s || !recording.first) return ImuTimes::told;
        const auto shares = [&](double first_s) {
            const double begin_s = *imu.count_s, end_s = begin_s + imu.span_s;
            return first_s < end_s && begin_s < first_s + recording.span_s;
        };
        constexpr double unix_at_gps_epoch_s = 315'964'800.0;
        const double since_epoch_s = recording.first->seconds_since(GpsTime());
        if (shares(static_cast<double>(recording.first->nanoseconds_of_week()) * 1e-9) ||
            shares(since_epoch_s + unix_at_gps_epoch_s))
            return ImuTimes::told;
        return shares(0.0) ? ImuTimes::counted_from_first : ImuTimes::unknown;
    }

    void add_imu(const Json& imu, const std::string& before, const ArrangedReceiver& arranged) {
        const Recognition& is = draft_.files_[*arranged.imu].is;
        const std::string name = draft_.files_[*arranged.imu].path;
        if (!imu.contains("antenna_m"))
            add({.key = before + "antenna_m",
                 .question =
                     fmt::format("{}: from the IMU to the antenna, in metres forward, right and "
                                 "down (0 0 -5)",
                                 name),
                 .why = "A craft that turns moves its antenna; the IMU shows how.",
                 .required = true,
                 .example = "{forward: ..., right: ..., down: ...}"});
        const ImuTimes times = times_of(is, draft_.files_[arranged.recordings.front()].is);
        if (!imu.contains("start_gps") && times != ImuTimes::told)
            add({.key = before + "start_gps",
                 .question = fmt::format("{}: GPS time of its first sample "
                                         "(2026-03-14T10:00:18.000)",
                                         name),
                 .why = times == ImuTimes::unknown
                            ? "Its times have no date, and are not the recording's."
                            : "Its times have no date. Without it they count from the "
                              "recording's first epoch.",
                 .required = times == ImuTimes::unknown,
                 .example = "..."});
        if (is.format == "novatel")
            for (const char* key : {"gyro_scale", "accelerometer_scale"})
                if (!imu.contains(key))
                    add({.key = before + key,
                         .question = fmt::format("{}: {}, what a count is", name, key),
                         .why = "RAWIMU logs hold counts, and do not say what one is.",
                         .required = true,
                         .example = "..."});
        if (!imu.contains("grade"))
            add({.key = before + "grade",
                 .question = fmt::format("{}: tactical, mems or consumer", name),
                 .why = "Without it the IMU counts as one of the least grade, consumer.",
                 .values = {"tactical", "mems", "consumer"},
                 .example = "..."});
    }

    void add_of_signals(const Json& receiver, const std::string& before) {
        if (!receiver.contains("base"))
            add({.key = before + "base",
                 .question = "File of the base station's observations",
                 .why = "Raw signals become positions by those of a base station.",
                 .required = true,
                 .example = "..."});
        if (!receiver.contains("navigation"))
            add({.key = before + "navigation",
                 .question = "File of the satellites' orbits (navigation)",
                 .why = "Raw signals become positions by the satellites' orbits.",
                 .required = true,
                 .example = "..."});
    }

    /// Where the class uses none of the fix types that there are.
    void add_fix_types(const Json& receiver, const ArrangedReceiver& arranged) {
        const std::string of_class = craft("class");
        const Recognition& is = draft_.files_[arranged.recordings.front()].is;
        if (of_class.empty() || is.fixes.empty() || arranged.id != "primary") return;
        if (has("parameters") && draft_.keys_["parameters"].contains("screen") &&
            draft_.keys_["parameters"]["screen"].contains("allowed_fixes"))
            return;
        std::vector<std::string> allowed;
        const YamlValue usual =
            attempt_schema().find("parameters.screen.allowed_fixes")->default_value[of_class];
        for (const YamlValue& one : usual.list())
            allowed.push_back(one.text());
        std::vector<std::string> there;
        for (const FixCount& count : is.fixes) {
            if (count.fix == "none") continue;
            const std::string claimed = receiver.value("solution", "");
            const std::string fix = count.fix != "unknown" ? count.fix
                                    : claimed.empty()      ? "single"
                                                           : claimed;
            if (std::ranges::count(allowed, fix) > 0) return;
            if (std::ranges::count(there, fix) == 0) there.push_back(fix);
        }
        if (there.empty()) return;
        add({.key = "parameters.screen.allowed_fixes",
             .question = "Fix types to allow in place of those of the class",
             .why = fmt::format("Of the class {} only {} positions are used, and these are {}: "
                                "without it nothing is certified.",
                                of_class, fmt::join(allowed, ", "), fmt::join(there, ", ")),
             .values = there,
             .example = "[...]"});
    }

    void add_series(const std::string& key, const std::string& path) {
        for (const FieldRule& rule : attempt_schema().fields()) {
            if (!rule.path.starts_with(key + ".") || !rule.required) continue;
            const std::string name = rule.path.substr(key.size() + 1);
            if (draft_.keys_[key].contains(name)) continue;
            add({.key = rule.path,
                 .question = fmt::format("{}: {}{}", path, rule.description,
                                         rule.unit.empty() ? "" : ", in " + rule.unit),
                 .why = name == "source" ? "The report says where the series is from."
                                         : "The series counts with this uncertainty.",
                 .required = true,
                 .example = name == "source" ? "\"...\"" : "..."});
        }
    }

    /// What the chosen rules ask for.
    void add_of_rules() {
        if (!has("profiles")) return;
        bool course = false, ground = false;
        for (const Json& one : draft_.keys_["profiles"]) {
            const std::string_view text = builtin_profile(one.get<std::string>());
            if (text.empty()) continue;
            const Profile profile = read_profile(text, one.get<std::string>());
            course = course || profile.window_kind == WindowKind::course;
            for (const Clause& clause : profile.clauses)
                ground = ground || clause.decided_by == Computation::start_height ||
                         clause.decided_by == Computation::counted_part;
        }
        if (course && !has("course"))
            add({.key = "course",
                 .question = "The surveyed course",
                 .why = "The rule measures between two surveyed lines.",
                 .required = true,
                 .example =
                     "{length_m: ..., length_expanded_uncertainty_m: ..., start: {left: "
                     "{latitude_deg: ..., longitude_deg: ...}, right: {latitude_deg: ..., "
                     "longitude_deg: ...}}, finish: {left: {latitude_deg: ..., longitude_deg: "
                     "...}, right: {latitude_deg: ..., longitude_deg: ...}}}",
                 .at_prompt = false});
        if (ground && !has("ground_height_m"))
            add({.key = "ground_height_m",
                 .question = "Height of the ground below, as the recording counts heights (m)",
                 .why = "The rule counts heights above it.",
                 .example = "..."});
    }

    static std::string question_of(const std::string& key) {
        if (key == "accuracy.horizontal_m")
            return "Standard deviation of east and of north, each, in metres (a watch 2 to 5, a "
                   "logger 1 to 2, RTK 0.02)";
        if (key == "accuracy.vertical_m")
            return "Standard deviation of heights, in metres (about twice the horizontal one)";
        if (key == "accuracy.velocity_mps") return "Standard deviation of the speeds, in m/s";
        if (key == "height_m") return "Height of the course above the ellipsoid, in metres";
        if (key == "solution") return "How the positions were solved";
        if (key == "time_source") return "Whose time the stamps are";
        if (key == "time_scale") return "What the times are";
        if (key == "start_date") return "UTC date of the first row (2026-03-14)";
        if (key == "start_gps")
            return "GPS time at which the times begin (2026-03-14T10:00:18.000)";
        if (key == "speed_unit") return "Unit of the speeds";
        if (key == "frame") return "UTM zone and hemisphere (55 south)";
        if (key == "surface.frame")
            return "its coordinates: geodetic, local_plane, or UTM zone and hemisphere (55 south)";
        if (key == "surface.unit") return "unit of its lengths";
        if (key == "surface.heights") return "what its heights are counted from";
        if (key == "surface.vertical_sd_m") return "standard deviation of its heights, in metres";
        if (key == "surface.source") return "who surveyed it, how and when";
        return key;
    }

    /// Nothing that could stand as it is: what is uncovered and not completed is refused.
    static std::string example_of(const NeededKey& needed) {
        return needed.key == "frame" ? "{utm: {zone: ..., hemisphere: ...}}" : "...";
    }

    const Draft& draft_;
    std::vector<Gap> gaps_;
};

std::vector<Gap> Draft::gaps() const {
    return DraftGaps(*this).found();
}

}  // namespace runcert

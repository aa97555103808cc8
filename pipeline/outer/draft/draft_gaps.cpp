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
        add_always(draft_.keys_, "", "");
        add_record();
        for (const ArrangedReceiver& receiver : draft_.arrangement_.receivers)
            add_receiver(receiver);
        for (const auto& [key, file] : draft_.arrangement_.series)
            add_series(key, draft_.files_[file].path);
        add_of_rules();
        return std::move(gaps_);
    }

  private:
    /// Whether a map has a key, or that of a map in it ("accuracy.vertical_m").
    static bool says(const Json& map, std::string key) {
        replace_all(key, ".", "/");
        return map.contains(Json::json_pointer("/" + key));
    }
    bool has(const std::string& key) const { return says(draft_.keys_, key); }
    std::string craft(const char* key) const {
        return has("craft") ? draft_.keys_["craft"].value(key, "") : "";
    }

    /// Adds a key as the attempt's table of fields asks for it.
    Gap& ask(const std::string& key, bool required = false) {
        std::string path = key;
        if (constexpr std::string_view receivers = "receivers."; path.starts_with(receivers))
            path = "receivers[]" + path.substr(path.find('.', receivers.size()));
        const FieldRule& rule = *attempt_schema().find(path);
        return gaps_.emplace_back(Gap{.key = key,
                                      .question = rule.question,
                                      .why = rule.why,
                                      .required = required,
                                      .values = rule.values,
                                      .example = rule.example});
    }

    /// The same where a recording says why.
    void ask(const std::string& before, const NeededKey& needed, const std::string& of,
             const std::string& file) {
        Gap& gap = ask(before + needed.key, needed.required);
        gap.question = (file.empty() ? "" : file + ": ") + gap.question + of;
        gap.why = needed.reason;
        gap.values = needed.values;
        // What the recording was read with.
        if (needed.key == "time_scale") gap.proposal = needed.values.front();
    }

    std::optional<GpsTime> when() const {
        for (const HandedIn& file : draft_.files_)
            if (file.is.first) return file.is.first;
        return std::nullopt;
    }

    void add_craft() {
        if (craft("name").empty()) ask("craft.name", true);
        if (!craft("class").empty()) return;
        Gap& gap = ask("craft.class", true);
        if (std::ranges::any_of(draft_.files_, [](const HandedIn& file) {
                return file.is.falls || file.is.format == "flysight";
            }))
            gap.proposal = "skydiver";
    }

    void add_rules() {
        if (has("profiles")) return;
        Gap& gap = ask("profiles", true);
        const std::string of_class = craft("class");
        gap.values = fitting_rules(of_class, when());
        if (!gap.values.empty())
            gap.proposal = gap.values.front();
        else if (!of_class.empty())
            gap.why += fmt::format(
                " None that comes with the program is for the class {}. Any may be claimed, as "
                "nalsa (3 s) or fisly (2 s), or a rule file of your own.",
                of_class);
    }

    /// What is asked whatever the recordings are, of the attempt or of a receiver.
    void add_always(const Json& keys, const std::string& prefix, const std::string& before) {
        for (const FieldRule& rule : attempt_schema().fields()) {
            if (!rule.always_asked || !rule.path.starts_with(prefix)) continue;
            const std::string key = rule.path.substr(prefix.size());
            if (key.find("[]") == std::string::npos && !says(keys, key)) ask(before + key);
        }
    }

    void add_record() {
        const std::vector<std::string> rules = draft_.profiles();
        if (rules.size() > 1 && !has("record")) {
            for (const std::string& rule : rules)
                add_record_under(rule, rule == rules.front());
            return;
        }
        const bool speed = has("record.speed");
        if (!speed && !has("records")) ask("record.speed");
        if (speed && !has("record.source")) ask("record.source", true);
    }

    /// Under one of several rules.
    void add_record_under(const std::string& rule, bool first) {
        const Json* record = nullptr;
        if (has("records"))
            for (const Json& one : draft_.keys_["records"])
                if (one["profile"] == rule) record = &one;
        if (record && record->contains("source")) return;
        Gap& gap = ask(record ? "record.source" : "record.speed", record != nullptr);
        gap.key = fmt::format("records.{}{}", rule, record ? ".source" : "");
        gap.question =
            record ? fmt::format("Where the record under {} is published", rule)
                   : fmt::format("Record to beat under {}, with its unit (202.9 km/h)", rule);
        if (record) return;
        if (!first) gap.why = "As under the rule before.";
        gap.example = fmt::format("{{profile: {}, speed: ..., unit: km/h, source: \"...\"}}", rule);
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
        if (draft_.files_[arranged.recordings.front()].is.kind == RecordingKind::signals)
            add_of_signals(receiver, before);
        for (const NeededKey& needed : needed_of(arranged))
            if (!says(receiver, needed.key)) ask(before, needed, of, "");
        if (receiver.value("time_scale", "") == "local" && !receiver.contains("utc_offset_h"))
            ask(before + "utc_offset_h", true).question += of;
        add_fix_types(receiver, arranged);
        if (arranged.imu) add_imu(receiver, before, arranged);
        if (arranged.surface) add_surface(receiver, before, arranged);
        if (arranged.id == "primary") add_always(receiver, "receivers[].", before);
        const std::string of_class = craft("class");
        const bool on_ground = of_class != "skydiver" && of_class != "board";
        const bool over_surface = arranged.surface.has_value();
        if (arranged.id != "primary" || !(on_ground || over_surface) ||
            receiver.contains("antenna_height_m"))
            return;
        Gap& gap = ask(before + "antenna_height_m", over_surface);
        gap.question += of;
        if (over_surface) gap.why = "Heights of positions are compared with the surface by it.";
    }

    /// What the file of a surface does not say.
    void add_surface(const Json& receiver, const std::string& before,
                     const ArrangedReceiver& arranged) {
        const Json& surface = receiver["surface"];
        const HandedIn& file = draft_.files_[*arranged.surface];
        const bool on_plane = surface.value("frame", Json()) == "local_plane";
        bool heights_asked = false;
        const auto ask_of = [&](const std::string& key, bool required, const std::string& why) {
            if (says(receiver, key)) return;
            Gap& gap = ask(before + key, required);
            gap.question = file.path + ": " + gap.question;
            if (!why.empty()) gap.why = why;
        };
        for (const NeededKey& needed : file.is.needed) {
            heights_asked = heights_asked || needed.key == "surface.heights";
            if (needed.key != "surface.heights" || !on_plane)
                ask_of(needed.key, needed.required, needed.reason);
        }
        if (surface.contains("frame") && !on_plane && !heights_asked)
            ask_of("surface.heights", true, "Receivers measure ellipsoidal heights.");
        if (surface.value("heights", "") == "geoid") ask_of("surface.undulation_m", true, "");
        if (on_plane && receiver.value("frame", Json()) != "local_plane" && !has("origin"))
            ask("origin", true);
    }

    /// What an IMU's times can be beside the recording's.
    enum class ImuTimes { known, counted_from_first, unknown };
    static ImuTimes times_of(const Recognition& imu, const Recognition& recording) {
        // A date, or the recording's own count.
        if (imu.first || !imu.count_s || !recording.first) return ImuTimes::known;
        const auto shares = [&](double first_s) {
            const double begin_s = *imu.count_s, end_s = begin_s + imu.span_s;
            return first_s < end_s && begin_s < first_s + recording.span_s;
        };
        constexpr double unix_at_gps_epoch_s = 315'964'800.0;
        const double since_epoch_s = recording.first->seconds_since(GpsTime());
        if (shares(static_cast<double>(recording.first->nanoseconds_of_week()) * 1e-9) ||
            shares(since_epoch_s + unix_at_gps_epoch_s))
            return ImuTimes::known;
        return shares(0.0) ? ImuTimes::counted_from_first : ImuTimes::unknown;
    }

    void add_imu(const Json& receiver, const std::string& before,
                 const ArrangedReceiver& arranged) {
        const HandedIn& file = draft_.files_[*arranged.imu];
        const ImuTimes times = times_of(file.is, draft_.files_[arranged.recordings.front()].is);
        for (NeededKey needed : file.is.needed) {
            const bool of_time = needed.key == "imu.start_gps";
            if (says(receiver, needed.key) || (of_time && times == ImuTimes::known)) continue;
            if (of_time && times == ImuTimes::unknown) {
                needed.required = true;
                needed.reason = "Its times have no date, and are not the recording's.";
            }
            ask(before, needed, "", file.path);
        }
    }

    void add_of_signals(const Json& receiver, const std::string& before) {
        for (const char* key : {"base", "navigation"})
            if (!receiver.contains(key)) ask(before + key, true);
    }

    /// Where the class uses none of the fix types that there are.
    void add_fix_types(const Json& receiver, const ArrangedReceiver& arranged) {
        const std::string of_class = craft("class");
        const Recognition& is = draft_.files_[arranged.recordings.front()].is;
        if (of_class.empty() || is.fixes.empty() || arranged.id != "primary") return;
        if (has("parameters.screen.allowed_fixes")) return;
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
        Gap& gap = ask("parameters.screen.allowed_fixes");
        gap.why = fmt::format(
            "Of the class {} only {} positions are used, and these are {}: "
            "without it nothing is certified.",
            of_class, fmt::join(allowed, ", "), fmt::join(there, ", "));
        gap.values = there;
    }

    void add_series(const std::string& key, const std::string& path) {
        for (const FieldRule& rule : attempt_schema().fields()) {
            if (!rule.path.starts_with(key + ".") || !rule.required) continue;
            const std::string name = rule.path.substr(key.size() + 1);
            if (draft_.keys_[key].contains(name)) continue;
            Gap& gap = ask(rule.path, true);
            gap.question = fmt::format("{}: {}{}", path, rule.description,
                                       rule.unit.empty() ? "" : ", in " + rule.unit);
            gap.why = name == "source" ? "The report says where the series is from."
                                       : "The series counts with this uncertainty.";
            if (name == "source") gap.example = "\"...\"";
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
        if (course && !has("course")) ask("course", true).at_prompt = false;
        if (ground && !has("ground_height_m")) ask("ground_height_m");
    }

    const Draft& draft_;
    std::vector<Gap> gaps_;
};

std::vector<Gap> Draft::gaps() const {
    return DraftGaps(*this).found();
}

}  // namespace runcert

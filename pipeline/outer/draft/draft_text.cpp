#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/prose.h"
#include "core/text.h"
#include "draft/draft.h"
#include "schemas/attempt/attempt.h"
#include "store/yaml_output.h"

// An attempt's or a day's file as a person goes on writing it.

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

std::string indented(const std::string& text, std::size_t blanks) {
    std::string result;
    for (const std::string& line : lines_of(text))
        result += (line.empty() ? "" : std::string(blanks, ' ')) + line + "\n";
    return result;
}

/// A line that is left out: what it would say, and what for.
std::string left_out(const std::string& says, const std::string& why) {
    return fmt::format("# {}  # {}\n", plain_text(says), plain_text(why));
}

/// What it is for, and what it may be.
std::string why_of(const Gap& gap) {
    if (gap.values.empty()) return gap.why;
    return fmt::format("{} One of {}.", gap.why, fmt::join(gap.values, ", "));
}

}  // namespace

class DraftText {
  public:
    explicit DraftText(const Draft& draft) : draft_(draft), gaps_(draft.gaps()) {}

    std::string of_attempt() const {
        std::string text = heading("an attempt");
        text += fmt::format("schema: {}/{}\n", attempt_schema().name(), attempt_schema().version());
        return text + to_yaml_text({{"id", draft_.keys_["id"]}}) + body();
    }

    std::string of_day(const std::string& id) const {
        std::string text = heading("a day");
        text += "schema: day/1.0\n" + to_yaml_text({{"id", id}});
        text += "defaults:  # what every attempt below has\n" + indented(body(), 2);
        Json attempts = Json::array();
        std::set<std::string> ids;
        for (const HandedIn& file : draft_.files_) {
            const Draft one({file},
                            {.receivers = {{.id = "primary", .recordings = {0}}}, .said = {}});
            Json entry = one.keys()["receivers"][0];
            entry["id"] = id_of(file.path, std::nullopt);
            const std::string stem = entry["id"];
            for (int again = 2; !ids.insert(entry["id"]).second; ++again)
                entry["id"] = fmt::format("{}-{}", stem, again);
            attempts.push_back(std::move(entry));
        }
        return text + to_yaml_text({{"attempts", attempts}});
    }

  private:
    std::string heading(std::string_view what) const {
        std::vector<std::string> names;
        for (const HandedIn& file : draft_.files_)
            names.push_back(file.path);
        constexpr std::size_t most = 4;
        if (names.size() > most) names = {counted(std::ssize(names), "recording")};
        std::string text = fmt::format(
            "# Written by runcert new, {} from {}.\n"
            "# Lines that begin with # are left out: complete and uncover those that apply.\n",
            what, plain_text(listed(names)));
        for (const std::string& taken : draft_.taken_)
            text += fmt::format("# Taken without an answer: {}\n", plain_text(taken));
        return text;
    }

    /// All keys but schema and id, in the order of the field table.
    std::string body() const {
        std::string text;
        for (const FieldRule& rule : attempt_schema().fields()) {
            if (rule.path.find_first_of(".[") != std::string::npos || rule.path == "id" ||
                rule.path == "schema")
                continue;
            if (rule.path == "receivers")
                text += receivers();
            else
                text += part(rule.path);
        }
        return text;
    }

    /// A key with all below it, and what is left out of it.
    std::string part(const std::string& key) const {
        std::vector<Gap> below;
        for (const Gap& gap : gaps_)
            if (gap.key == key || gap.key.starts_with(key + ".")) below.push_back(gap);
        const bool there = draft_.keys_.contains(key);
        std::string text = there ? to_yaml_text({{key, draft_.keys_[key]}}) : "";
        if (key == "date" && !there)
            return left_out("date: \"YYYY-MM-DD\"",
                            "The day by the officials' own notes: the recording's is compared with "
                            "it.");
        if (key == "date")
            text.insert(text.size() - 1,
                        "  # the recording's, which the rule asks for: compare it with the "
                        "officials' own notes");
        for (const Gap& gap : below) {
            const std::string rest =
                gap.key.size() > key.size() ? gap.key.substr(key.size() + 1) : "";
            if (key == "records")
                text += (!there && &gap == &below.front() ? "# records:\n" : "") +
                        left_out("  - " + gap.example, why_of(gap));
            else if (there)
                text += "  " + left_out(rest + ": " + gap.example, why_of(gap));
            else if (rest.empty() || key == "record")
                text += left_out(key + ": " + gap.example, why_of(gap));
            else if (below.size() == 1)
                text += left_out(key + ": " + nested(rest, gap.example), why_of(gap));
            else
                text += (&gap == &below.front() ? "# " + key + ":\n" : "") +
                        left_out("  " + rest + ": " + gap.example, why_of(gap));
        }
        return text;
    }

    /// "{screen: {allowed_fixes: [single]}}" of "screen.allowed_fixes".
    static std::string nested(const std::string& path, const std::string& value) {
        const std::size_t point = path.find('.');
        if (point == std::string::npos) return fmt::format("{{{}: {}}}", path, value);
        return fmt::format("{{{}: {}}}", path.substr(0, point),
                           nested(path.substr(point + 1), value));
    }

    std::string receivers() const {
        std::string text;
        for (const Json& one : draft_.keys_["receivers"]) {
            if (draft_.of_day_) {
                // Beside the keys of the attempt, as the entries have them.
                Json receiver = one;
                receiver.erase("id");
                receiver.erase("recording");
                return (receiver.empty() ? "" : to_yaml_text(receiver)) + receiver_gaps(one, "");
            }
            const std::string block = to_yaml_text({{"receivers", Json::array({one})}});
            text += reasons(one["id"]) + block.substr(block.find('\n') + 1) +
                    receiver_gaps(one, "    ");
        }
        return "receivers:\n" + text;
    }

    /// Why a table is read as it is.
    std::string reasons(const std::string& id) const {
        std::string text;
        for (const ArrangedReceiver& arranged : draft_.arrangement_.receivers)
            if (arranged.id == id)
                for (const std::size_t file :
                     {arranged.recordings.front(), arranged.imu.value_or(arranged.recordings[0])}) {
                    for (const ProposedKey& one : draft_.files_[file].is.proposed)
                        if (!one.reason.empty())
                            text += fmt::format("  # {}: {}\n", one.key, plain_text(one.reason));
                    if (!arranged.imu) break;
                }
        return text;
    }

    /// What is left out of a receiver; keys of one map stand together.
    std::string receiver_gaps(const Json& receiver, const std::string& blanks) const {
        const std::string before = fmt::format("receivers.{}.", receiver["id"].get<std::string>());
        std::string text;
        std::set<std::string> maps;
        for (const Gap& gap : gaps_) {
            if (!gap.key.starts_with(before)) continue;
            const std::string key = gap.key.substr(before.size());
            const std::size_t point = key.find('.');
            if (point == std::string::npos) {
                text += blanks + left_out(key + ": " + gap.example, why_of(gap));
                continue;
            }
            const std::string map = key.substr(0, point);
            if (!maps.insert(map).second) continue;
            std::vector<std::string> pairs;
            for (const Gap& other : gaps_)
                if (other.key.starts_with(before + map + "."))
                    pairs.push_back(fmt::format(
                        "{}: {}", other.key.substr(before.size() + map.size() + 1), other.example));
            const bool there = receiver.contains(map);
            text +=
                blanks + left_out(there ? fmt::format("in {}: {}", map, fmt::join(pairs, ", "))
                                        : fmt::format("{}: {{{}}}", map, fmt::join(pairs, ", ")),
                                  gap.why);
        }
        return text;
    }

    const Draft& draft_;
    std::vector<Gap> gaps_;
};

std::string Draft::text() const {
    return of_day_ ? DraftText(*this).of_day(keys_["id"]) : DraftText(*this).of_attempt();
}

}  // namespace runcert

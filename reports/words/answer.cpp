#include "reports/words/answer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

constexpr std::size_t label_columns = 8;
constexpr std::string_view not_met = "Not met: ";

/// The clause that the reason of what cannot be certified is about; empty for another reason.
std::string deciding_clause(const ProfileVerdict& verdict) {
    for (const Requirement& requirement : verdict.requirements)
        if (verdict.reason.starts_with(fmt::format("{}{}: ", not_met, requirement.clause)))
            return requirement.clause;
    return {};
}

/// "58.70 ± 0.19 km/h, required 55.67".
std::string speeds_text(const ProfileVerdict& verdict) {
    const ShownFigures shown = shown_of(verdict, "km/h");
    return fmt::format("{} ± {} {}{}", shown.speed, shown.expanded_uncertainty, shown.unit,
                       shown.required_speed.empty() ? "" : ", required " + shown.required_speed);
}

/// "Not yet beaten: 9 answers and 1 signature are due."; empty where nothing is.
std::string due_text(std::int64_t answers, std::int64_t signatures) {
    std::vector<std::string> due;
    if (answers > 0) due.push_back(counted(answers, "answer"));
    if (signatures > 0) due.push_back(counted(signatures, "signature"));
    if (due.empty()) return {};
    return fmt::format(" Not yet beaten: {} {} due.", listed(due),
                       answers + signatures == 1 ? "is" : "are");
}

std::string window_text(const WindowSpan& span) {
    return fmt::format("{} from {}{}", seconds_text(span.duration), seconds_text(span.start),
                       span.start_gps ? " (" + to_utc_iso(*span.start_gps, 3) + ")" : "");
}

std::vector<AnswerLine> details_of(const ProfileVerdict& rule) {
    std::vector<AnswerLine> lines;
    const auto add = [&](const char* label, std::string says) {
        lines.push_back({label, std::move(says)});
    };
    // What a reader must know: of the recording, such as that it was simulated, or of the
    // measurement. What the body is asked stands in the report.
    const auto add_notes = [&](bool of_recording) {
        for (const std::string& note : rule.notes)
            if (!note.starts_with("Question for the body:") &&
                note.starts_with("The recording of receiver") == of_recording)
                add("note", note);
    };
    if (rule.window) add("window", window_text(*rule.window));
    std::vector<std::string> speeds;
    if (rule.speed_m_s)
        speeds.push_back(measured_speed_text(shown_of(rule, "km/h"), rule.coverage_factor));
    if (const std::string& own = rule.own_arithmetic.shown; !own.empty())
        speeds.push_back(own + " by the rule's own arithmetic");
    if (!speeds.empty()) add("speed", fmt::format("{}", fmt::join(speeds, "; ")));
    add_notes(true);
    for (const std::string& witness : rule.witnesses)
        add("witness", witness);
    if (rule.unseen_drift_m_s)
        add("witness", (rule.witnesses.empty() ? "none. " : "none that confirms. ") +
                           positions_alone_text(rule));
    if (const auto& refused = rule.indicated)
        add("refused", fmt::format("{} in {}: {}",
                                   speed_beside(rule, refused->speed_m_s,
                                                rule.shown ? rule.shown->unit : "km/h"),
                                   window_text(refused->span), fmt::join(refused->refusals, "; ")));
    add_notes(false);
    return lines;
}

std::string short_outcome(const ProfileVerdict& verdict) {
    if (verdict.outcome == Outcome::beaten)
        return slower_craft(verdict) == nullptr ? "exceeds the record" : "craft too slow";
    if (verdict.outcome == Outcome::not_proven)
        return verdict.record ? "not proven" : "measured, no record named";
    return verdict.outcome == Outcome::not_beaten ? "not beaten" : "not certifiable";
}

/// A row for each rule, their columns as wide as the widest.
std::vector<AnswerLine> table_of(const std::vector<ProfileVerdict>& rules) {
    const auto speeds_of = [](const ProfileVerdict& rule) {
        return rule.speed_m_s ? speeds_text(rule) : "no speed";
    };
    std::size_t name = 0, speed = 0;
    for (const ProfileVerdict& rule : rules) {
        name = std::max(name, characters_in(rule.profile));
        speed = std::max(speed, characters_in(speeds_of(rule)));
    }
    std::vector<AnswerLine> lines;
    for (const ProfileVerdict& rule : rules)
        lines.push_back({"rule",
                         fmt::format("{:<{}}  {:<{}}  {}", rule.profile, name, speeds_of(rule),
                                     speed, short_outcome(rule)),
                         true});
    return lines;
}

/// What is said of rules, each once, with the rules that it is said of; of some rules nothing.
using SaidOfRules = std::vector<std::pair<std::string, std::vector<std::string>>>;

SaidOfRules said_of(const Verdict& verdict, std::string (*words)(const ProfileVerdict&)) {
    SaidOfRules said;
    for (const ProfileVerdict& rule : verdict.profiles) {
        const std::string what = words(rule);
        if (what.empty()) continue;
        auto known = std::ranges::find(said, what, [](const auto& one) { return one.first; });
        if (known == said.end()) known = said.insert(known, {what, {}});
        known->second.push_back(rule.profile);
    }
    return said;
}

/// Why what cannot be certified cannot.
SaidOfRules refusals_of(const Verdict& verdict) {
    return said_of(verdict, [](const ProfileVerdict& rule) {
        return rule.outcome == Outcome::not_certifiable ? refusal_text(rule) : "";
    });
}

/// The reason that all rules share, which stands in the result; empty where they do not.
std::string shared_refusal(const Verdict& verdict) {
    const SaidOfRules reasons = refusals_of(verdict);
    if (reasons.size() != 1) return {};
    const auto& [reason, rules] = reasons.front();
    return rules.size() == verdict.profiles.size() ? reason : "";
}

/// The verdict that NEXT speaks of: the first that exceeds, else the first that is refused, else
/// the first.
const ProfileVerdict& leading(const Verdict& verdict) {
    for (const Outcome outcome : {Outcome::beaten, Outcome::not_certifiable}) {
        const auto found = std::ranges::find(verdict.profiles, outcome, &ProfileVerdict::outcome);
        if (found != verdict.profiles.end()) return *found;
    }
    return verdict.profiles.front();
}

}  // namespace

std::string refusal_text(const ProfileVerdict& verdict) {
    const std::string clause = deciding_clause(verdict);
    const std::string why =
        clause.empty() ? verdict.reason : verdict.reason.substr(not_met.size() + clause.size() + 2);
    // The first sentences that fit in so many characters, one at least.
    constexpr std::size_t most = 240;
    std::size_t end = 0;
    while (end < why.size()) {
        const std::size_t next = std::min(why.find(". ", end + 1), why.size());
        if (end > 0 && next > most) break;
        end = next;
    }
    return end < why.size() ? why.substr(0, end + 1) : why;
}

std::string result_text(const ProfileVerdict& verdict) {
    const std::string altered = altered_text(state_of(verdict));
    if (verdict.outcome == Outcome::not_certifiable)
        return fmt::format("Not certifiable{}. {}", altered, capitalised(refusal_text(verdict)));
    if (verdict.outcome == Outcome::not_beaten)
        return fmt::format("{}: below the required speed{}. Record not beaten.",
                           speeds_text(verdict), altered);
    if (verdict.outcome == Outcome::not_proven)
        return speeds_text(verdict) +
               (verdict.record
                    ? fmt::format(": not proven{}, the required speed is within the uncertainty.",
                                  altered)
                    : ": measured. The attempt names no record.");
    if (const Figure* const craft = slower_craft(verdict)) {
        const ShownFigures shown = shown_of(verdict, "km/h");
        return fmt::format(
            "The craft was too slow{}: {}, required {}. Its antenna did {} ± {}. The rule does not "
            "say whose speed counts: the body must.",
            altered, craft->shown, shown.required_speed, shown.speed, shown.expanded_uncertainty);
    }
    return fmt::format("{}: exceeds the record{}.{}", speeds_text(verdict), altered,
                       due_text(verdict.standing.attestations, verdict.standing.signatures));
}

std::vector<AnswerLine> answer_details(const Verdict& verdict) {
    const bool one = verdict.profiles.size() == 1;
    std::vector<AnswerLine> lines =
        one ? details_of(verdict.profiles.front()) : table_of(verdict.profiles);
    if (!one && shared_refusal(verdict).empty())
        for (const auto& [why, rules] : refusals_of(verdict))
            lines.push_back({"why", fmt::format("{}: {}", listed(rules), why)});
    if (!verdict.georeferenced)
        lines.push_back({"note",
                         "not georeferenced: engineering coordinates, whose scale on the ground is "
                         "not stated"});
    return lines;
}

AnswerLine answer_result(const Verdict& verdict) {
    if (verdict.profiles.size() == 1) {
        const ProfileVerdict& rule = verdict.profiles.front();
        return {"RESULT", fmt::format("{}: {}", rule.profile, result_text(rule))};
    }
    const SaidOfRules ways = said_of(verdict, short_outcome);
    std::int64_t answers = 0, signatures = 0;
    for (const ProfileVerdict& rule : verdict.profiles) {
        if (rule.outcome != Outcome::beaten) continue;
        answers += rule.standing.attestations;
        signatures = std::max(signatures, rule.standing.signatures);
    }
    const std::string due = due_text(answers, signatures);
    const std::size_t rules = verdict.profiles.size();
    const std::string why = shared_refusal(verdict);
    if (ways.size() == 1)
        return {"RESULT",
                fmt::format("{}: {}.{}{}",
                            rules == 2 ? "both rules" : fmt::format("all {} rules", rules),
                            ways.front().first, due, why.empty() ? "" : " " + capitalised(why))};
    std::vector<std::string> said;
    for (const auto& [way, of] : ways)
        said.push_back(fmt::format("{} ({})", way, listed(of)));
    return {"RESULT", fmt::format("{} rules: {}.{}", rules, fmt::join(said, "; "), due)};
}

AnswerLine answer_next(const Verdict& verdict, const std::string& run_folder,
                       const std::string& page) {
    const ProfileVerdict& rule = leading(verdict);
    const std::string run = shell_word(run_folder);
    if (rule.outcome == Outcome::beaten)
        return {"NEXT", fmt::format("read {}; what is due and from whom: runcert attest {}",
                                    shell_word(page), run)};
    const std::string clause = deciding_clause(rule);
    return {
        "NEXT",
        fmt::format("read {}; why, and what helps: runcert explain {} {}", shell_word(page), run,
                    clause.empty() ? "decision --profile " + shell_word(plain_text(rule.profile))
                                   : shell_word(plain_text(rule.profile + "/" + clause)))};
}

std::string answer_text(const std::vector<AnswerLine>& lines, std::size_t columns) {
    std::string text;
    for (const AnswerLine& line : lines) {
        text += fmt::format("{:<{}}", line.label, label_columns);
        text += line.is_row ? plain_text(line.says) + "\n"
                            : wrapped(line.says, label_columns, label_columns, columns);
    }
    return text;
}

std::string answer_text(const std::vector<AnswerLine>& lines, std::size_t columns,
                        std::size_t most_lines, const std::string& run_folder) {
    const std::string text = answer_text(lines, columns);
    std::size_t end = 0;
    for (std::size_t line = 0; end < text.size() && line < most_lines; ++line)
        end = text.find('\n', end) + 1;
    if (end == text.size()) return text;
    end = text.rfind('\n', end - 2) + 1;  // one line less, for where the rest is
    return text.substr(0, end) +
           answer_text({{"...", "more: runcert explain " + shell_word(run_folder)}}, columns);
}

}  // namespace runcert

#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/statistics.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"
#include "reports/words/decision.h"
#include "reports/words/outcome.h"

namespace runcert {
namespace {

/// Quantities with their uncertainties, each with its text as shown.
Json quantities_json(const std::vector<Figure>& figures) {
    Json list = Json::array();
    for (const Figure& figure : figures) {
        list.push_back(members_json(figure));
        list.back()["quantity_text"] = figure_value_text(figure);
    }
    return list;
}

std::string began_words(RunEdge began) {
    const char* preposition = began == RunEdge::recording  ? "with"
                              : began == RunEdge::standing ? "from"
                                                           : "after";
    return fmt::format("{} {}", preposition, words_of(began));
}

std::string ended_words(RunEdge ended) {
    return fmt::format("{} {}", ended == RunEdge::recording ? "with" : "at", words_of(ended));
}

bool holds(const WindowSpan& run, const std::optional<WindowSpan>& window) {
    const auto end_ns = [](const WindowSpan& span) {
        return span.start.nanoseconds + span.duration.nanoseconds;
    };
    return window && run.start.nanoseconds <= window->start.nanoseconds &&
           end_ns(*window) <= end_ns(run);
}

Json run_json(const RunSummary& run, std::size_t number, const ProfileVerdict& verdict,
              const SpeedUnit& unit) {
    Json json{{"run", number}};
    json.update(members_json(run));
    set_end(json, run.span);
    json["holds_window"] = holds(run.span, verdict.window);
    json["run_start"] = seconds_text(run.span.start);
    json["run_time"] = seconds_text(run.span.duration);
    json["run_length"] = format_fixed(run.length_m, 1) + " m";
    json["run_speed"] =
        fmt::format("{} {}", speed_text(run.top_speed_m_s, std::nullopt, unit), unit.name);
    json["run_heading"] = format_fixed(run.heading_deg, 1) + "°";
    json["run_words"] =
        fmt::format("begins {}, ends {}", began_words(run.began), ended_words(run.ended));
    return json;
}

/// Sets course and craft, and the runs of the craft. Nothing where the verdict says nothing.
void set_course(Json& json, const ProfileVerdict& verdict, const Profile& profile) {
    if (!verdict.course.empty()) json["course"] = quantities_json(verdict.course);
    for (std::size_t i = 0; i < verdict.runs.size(); ++i)
        json["runs"].push_back(run_json(verdict.runs[i], i + 1, verdict, rule_unit(profile)));
}

/// The figures of the decision as they are to be read.
Json headline_json(const ProfileVerdict& verdict, const ShownFigures& shown) {
    Json json{{"headline_speed", shown.speed},
              {"headline_unit", shown.unit},
              {"headline_uncertainty", shown.expanded_uncertainty},
              {"headline_coverage", coverage_text(verdict.coverage_factor)},
              {"headline_note", "Speed rounded down, uncertainty rounded up."}};
    if (shown.required_speed.empty()) return json;
    json["headline_required_speed"] = shown.required_speed;
    if (!shown.acceptance_limit.empty()) json["headline_acceptance_limit"] = shown.acceptance_limit;
    json["headline_note"] =
        "Speed rounded down; uncertainty, required speed and acceptance limit rounded up.";
    return json;
}

void set_results(Json& json, const ProfileVerdict& verdict, const Profile& profile) {
    const auto& uncertainty = verdict.expanded_uncertainty_m_s;
    std::optional<double> standard, lower, acceptance;
    if (uncertainty) standard = *uncertainty / verdict.coverage_factor;
    if (verdict.speed_m_s && uncertainty) lower = *verdict.speed_m_s - *uncertainty;
    if (verdict.decision) acceptance = verdict.decision->acceptance_limit_m_s;
    set_speeds(json, "speed", verdict.speed_m_s);
    set_speeds(json, "standard_uncertainty", standard);
    set_speeds(json, "expanded_uncertainty", uncertainty);
    set_speeds(json, "lower_limit", lower);
    set_speeds(json, "required_speed", verdict.required_speed_m_s);
    json["speed_table"] = speed_table(
        {{"Measured speed", verdict.speed_m_s},
         {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
          uncertainty, SpeedRow::uncertainty},
         {"Measured speed less expanded uncertainty", lower},
         {"Acceptance limit", acceptance, SpeedRow::limit},
         {"Guard band w", guard_band_m_s(verdict), SpeedRow::uncertainty},
         {"Required speed", verdict.required_speed_m_s, SpeedRow::limit},
         {"Standing record",
          verdict.record ? std::optional(verdict.record->speed_m_s) : std::nullopt,
          SpeedRow::stated}},
        profile, uncertainty);
    if (verdict.speed_m_s)
        json["headline"] = headline_json(verdict, shown_of(verdict, rule_unit(profile).name));
}

Json requirement_json(const Requirement& requirement) {
    Json json = members_json(requirement);
    json["status_words"] = words_of(requirement.status);
    json["certainty_words"] = words_of(requirement.certainty);
    json["source_words"] = source_text(requirement);
    json["figures"] = quantities_json(requirement.figures);
    return json;
}

/// The same rule by each receiver, where there are two.
Json by_receiver_json(const ReportInputs& inputs, const Profile& profile) {
    Json list = Json::array();
    if (inputs.receivers.size() < 2) return list;
    for (const ReceiverResults& results : inputs.receivers) {
        Json entry{{"receiver", results.windows.receiver}};
        const ProfileWindows* windows = windows_of(results.windows, profile.id);
        if (const auto figure = windows == nullptr ? std::nullopt : figure_of(*windows)) {
            const double u = expanded_uncertainty_by_rule_m_s(*figure, profile.coverage_factor);
            const SpeedUnit& unit = rule_unit(profile);
            set_speeds(entry, "speed", figure->speed_m_s);
            set_speeds(entry, "expanded_uncertainty", u);
            entry["by_receiver_words"] =
                fmt::format("{}, {} after its first epoch",
                            speed_with_uncertainty_text(figure->speed_m_s, u, unit),
                            seconds_text(windows->best->span.start));
        } else {
            entry["by_receiver_words"] = "no certifiable window";
        }
        list.push_back(std::move(entry));
    }
    return list;
}

/// "11 requirements in all: 6 met, 0 not met, 5 to be attested (listed below)."
std::string requirement_counts(const ProfileVerdict& verdict) {
    const auto count = [&](RequirementStatus status) {
        return std::ranges::count(verdict.requirements, status, &Requirement::status);
    };
    return fmt::format("{} in all: {} met, {} not met, {} to be attested (listed below).",
                       counted(std::ssize(verdict.requirements), "requirement"),
                       count(RequirementStatus::met), count(RequirementStatus::not_met),
                       count(RequirementStatus::attest));
}

}  // namespace

Json profile_json(const ReportInputs& inputs, std::size_t index) {
    const ProfileVerdict& verdict = inputs.verdict.profiles[index];
    const Profile& profile = inputs.profiles[index];
    const OutcomeWords words = outcome_words(state_of(verdict));
    Json json{{"profile", verdict.profile},
              {"body", verdict.body},
              {"title", verdict.title},
              {"rule_identity", members_json(verdict.rule)},
              {"rule_identity_words", rule_identity_text(verdict)},
              {"outcome", to_text(verdict.outcome)},
              {"outcome_title", words.title},
              {"outcome_mark", words.mark},
              {"tone", words.tone},
              {"standing", members_json(verdict.standing)},
              {"standing_words", standing_text(verdict.standing)},
              {"reason", verdict.reason},
              {"definition", to_text(verdict.definition)},
              {"coverage_factor", verdict.coverage_factor},
              {"qualification", requirement_counts(verdict)}};
    json["rule_words"] = rule_words(profile);
    set_rule(json, profile);
    set_decision(json, inputs, index);
    set_reservations(json, verdict);
    set_results(json, verdict, profile);
    const ProfileWindows* windows = windows_of(inputs.receivers.front().windows, verdict.profile);
    if (windows != nullptr && !windows->missing.empty())
        json["missing_words"] = fmt::format("What is missing: {}.", windows->missing);
    if (verdict.window) json["window"] = window_json(verdict, windows, profile);
    set_course(json, verdict, profile);
    if (verdict.indicated) json["indicated"] = indicated_json(verdict, profile);
    json["by_receiver"] = by_receiver_json(inputs, profile);
    json["requirements"] = Json::array();
    for (const Requirement& requirement : verdict.requirements)
        json["requirements"].push_back(requirement_json(requirement));
    return json;
}

}  // namespace runcert

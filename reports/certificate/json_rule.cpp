#include <fmt/format.h>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "reports/words/outcome.h"

namespace runcert {
namespace {

/// km/h, m/s, kn, mph, the rule's own in front.
std::vector<const SpeedUnit*> units_in_order(const Profile& profile) {
    std::vector<const SpeedUnit*> units{&rule_unit(profile)};
    for (const SpeedUnit& unit : speed_units())
        if (&unit != units.front()) units.push_back(&unit);
    return units;
}

/// The decimals that the rule gives speeds in its own unit.
std::optional<int> rule_decimals(const Profile& profile, const SpeedUnit& unit) {
    const auto& rule = profile.result ? profile.result : profile.rounding;
    if (!rule || &unit != &rule_unit(profile)) return std::nullopt;
    return rule->decimals;
}

std::string speed_cell(const SpeedRow& row, const Profile& profile,
                       const std::optional<double>& uncertainty_m_s, const SpeedUnit& unit) {
    const double speed = *row.speed_m_s * unit.per_m_s;
    if (row.kind == SpeedRow::uncertainty) return uncertainty_rounded_up(speed);
    if (row.kind == SpeedRow::stated || !uncertainty_m_s)
        return speed_text(*row.speed_m_s, std::nullopt, unit);
    return shown_figure(speed,
                        decimals_of(*uncertainty_m_s * unit.per_m_s, rule_decimals(profile, unit)),
                        row.kind == SpeedRow::limit ? SafeSide::up : SafeSide::down);
}

std::string dimension_words(const Profile& profile) {
    if (profile.dimension == Dimension::horizontal) return "Speed";
    return capitalised(words_of(profile.dimension));
}

/// How many windows make the figure.
std::string count_words(const Profile& profile) {
    if (profile.opposite_runs_within_s)
        return fmt::format(", the mean of two runs in opposite directions within {:g} s",
                           *profile.opposite_runs_within_s);
    if (profile.windows == 1) return "";
    return fmt::format(", the mean of the {} fastest windows that do not overlap", profile.windows);
}

std::string ends_words(const Profile& profile) {
    if (profile.window_kind == WindowKind::course || profile.speed_source == SpeedSource::velocity)
        return "";
    if (profile.ends == WindowEnds::any) return " A window may begin and end at any instant.";
    return profile.exact_duration ? " A window's ends are measured epochs exactly that far apart."
                                  : "";
}

std::string decision_rule(const ProfileVerdict& verdict, const Profile& profile) {
    const double level = verdict.decision ? verdict.decision->level : profile.decision_probability;
    const std::string silent = silent_rule_text(profile);
    return fmt::format(
               "Decision rule: it goes by the conformance probability, that the true speed reaches "
               "the required speed. At least {} counts as beaten, at most {} as not beaten, and "
               "anything between as not proven (guarded acceptance and rejection, JCGM 106).",
               level_text(level), level_text(1.0 - level)) +
           (silent.empty() ? "" : " " + silent);
}

std::string record_words(const RecordToBeat& record) {
    const std::string own =
        record.expanded_uncertainty && *record.expanded_uncertainty > 0.0
            ? fmt::format(" ± {} {} (k = 2)", number_text(*record.expanded_uncertainty),
                          record.unit)
            : "";
    return fmt::format("{} {}{}: {}", number_text(record.speed), record.unit, own, record.source);
}

std::string decision_words(const ProfileVerdict& verdict, const SpeedUnit& unit) {
    const Decision& decision = *verdict.decision;
    std::string words = verdict.outcome == Outcome::not_certifiable
                            ? "The speed cannot be certified, so that no comparison counts. "
                            : "";
    words += fmt::format("Conformance probability: {} (at least {} required).",
                         probability_text(decision.probability), level_text(decision.level));
    if (decision.required_speed_standard_uncertainty_m_s > 0.0)
        words += fmt::format(
            " It includes the standard uncertainty of the record itself, {} {} of the required "
            "speed.",
            uncertainty_text(decision.required_speed_standard_uncertainty_m_s * unit.per_m_s),
            unit.name);
    if (decision.attempts_made > 1)
        words += fmt::format(" As the best of {} attempts it needs {}.", decision.attempts_made,
                             level_text(decision.level));
    for (const std::string& more : decision_sentences(verdict, unit))
        words += " " + more;
    return words;
}

Json decision_json(const ProfileVerdict& verdict, const SpeedUnit& unit) {
    Json json = members_json(*verdict.decision);
    if (const auto guard_m_s = guard_band_m_s(verdict))
        json["guard_band_m_s"] = rounded(*guard_m_s, 6);
    json["decision_words"] = decision_words(verdict, unit);
    return json;
}

Json override_json(const Override& figure) {
    const std::string unit = figure.unit.empty() ? "" : " " + figure.unit;
    Json json = members_json(figure);
    json["rule_text"] = number_text(figure.rule) + unit;
    json["used_text"] = number_text(figure.used) + unit;
    if (figure.reason.empty()) json["reason"] = "none given";
    return json;
}

}  // namespace

void add_fact(Json& facts, std::string_view label, std::string value) {
    facts.push_back({{"label", label}, {"value", std::move(value)}});
}

void set_speeds(Json& json, const std::string& name, const std::optional<double>& speed_m_s) {
    if (!speed_m_s) return;
    for (const SpeedUnit& unit : speed_units())
        json[fmt::format("{}_{}", name, unit.key)] =
            rounded(*speed_m_s * unit.per_m_s, unit.decimals_kept);
}

void set_end(Json& json, const WindowSpan& span) {
    if (!span.start_gps) return;
    const GpsTime end = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
    json["end_gps"] = to_iso(end, 3);
    json["end_utc"] = to_utc_iso(end, 3);
}

const SpeedUnit& rule_unit(const Profile& profile) {
    return speed_unit(rule_unit_name(profile));
}

Json speed_table(const std::vector<SpeedRow>& rows, const Profile& profile,
                 std::optional<double> uncertainty_m_s) {
    Json table{{"units", Json::array()}, {"rows", Json::array()}};
    const auto units = units_in_order(profile);
    for (const SpeedUnit* unit : units)
        table["units"].push_back(unit->name);
    for (const SpeedRow& row : rows) {
        if (!row.speed_m_s) continue;
        Json entry{{"label", row.label}, {"cells", Json::array()}};
        for (const SpeedUnit* unit : units)
            entry["cells"].push_back(speed_cell(row, profile, uncertainty_m_s, *unit));
        table["rows"].push_back(std::move(entry));
    }
    return table;
}

Json record_json(const RecordToBeat& record) {
    Json json{{"speed", record.speed}, {"unit", record.unit}, {"source", record.source}};
    set_speeds(json, "speed", record.speed_m_s);
    if (record.expanded_uncertainty) json["expanded_uncertainty"] = *record.expanded_uncertainty;
    json["record_words"] = record_words(record);
    return json;
}

std::string rule_words(const Profile& profile) {
    const bool recorded = profile.speed_source == SpeedSource::velocity;
    return fmt::format(
        "{} over {}{}, by the definition: {}{}.{}{}", dimension_words(profile),
        window_words(profile), count_words(profile), capitalised(words_of(profile.definition)),
        recorded ? ", from the velocities that the recording states" : "", ends_words(profile),
        profile.current == CurrentUse::subtracted
            ? " The current's component along the course is subtracted."
            : "");
}

void set_rule(Json& json, const Profile& profile) {
    if (profile.window_kind == WindowKind::time) {
        json["rule_duration_s"] = profile.duration_s;
    } else {
        json["rule_kind"] = to_text(profile.window_kind);
        json["rule_distance_m"] = profile.distance_m;
    }
    if (profile.dimension != Dimension::horizontal)
        json["rule_dimension"] = to_text(profile.dimension);
    if (profile.speed_source != SpeedSource::position)
        json["rule_source"] = to_text(profile.speed_source);
    if (profile.windows != 1) json["rule_windows"] = profile.windows;
}

void set_decision(Json& json, const ReportInputs& inputs, std::size_t index) {
    const ProfileVerdict& verdict = inputs.verdict.profiles[index];
    const Profile& profile = inputs.profiles[index];
    json["decision_rule"] = decision_rule(verdict, profile);
    json["decision_rule_agreed"] =
        agreement_text(inputs.attempt.decision_rule_agreed, verdict.window);
    if (verdict.record) json["record"] = record_json(*verdict.record);
    if (verdict.decision) json["decision"] = decision_json(verdict, rule_unit(profile));
    if (verdict.own_arithmetic) {
        if (verdict.own_arithmetic->speed_m_s)
            set_speeds(json, "own_arithmetic", verdict.own_arithmetic->speed_m_s);
        json["own_arithmetic_words"] = own_arithmetic_text(*verdict.own_arithmetic);
    }
    if (!verdict.current_subtracted_m_s) return;
    const SpeedUnit& unit = rule_unit(profile);
    set_speeds(json, "current_subtracted", verdict.current_subtracted_m_s);
    json["current_words"] =
        fmt::format("The current's component along the course, {} {}, is subtracted.",
                    speed_text(*verdict.current_subtracted_m_s, std::nullopt, unit), unit.name);
}

void set_reservations(Json& json, const ProfileVerdict& verdict) {
    json["witnesses"] = verdict.witnesses;
    if (!verdict.witnesses.empty())
        json["witnesses_words"] =
            fmt::format("Beside the positions, {}.", fmt::join(verdict.witnesses, "; "));
    if (verdict.unseen_drift_m_s)
        json["witnesses_words"] = positions_alone_text(*verdict.unseen_drift_m_s);
    if (!verdict.notes.empty()) json["notes"] = verdict.notes;
    for (const Override& figure : verdict.overrides)
        json["overrides"].push_back(override_json(figure));
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.certainty == Certainty::unconfirmed)
            json["unconfirmed"].push_back(fmt::format("{}: {} Source: {}.", requirement.clause,
                                                      requirement.text, requirement.source));
}

}  // namespace runcert

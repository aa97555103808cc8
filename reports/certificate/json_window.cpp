#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"
#include "reports/words/screening.h"

namespace runcert {
namespace {

/// When a window was, on the clock.
Json time_facts(const WindowSpan& span) {
    Json facts = Json::array();
    if (span.start_gps) {
        const GpsTime end = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
        add_fact(facts, "UTC", fmt::format("{} to {}", utc_text(*span.start_gps), utc_text(end)));
        add_fact(facts, "GPS time",
                 fmt::format("{} to {}", gps_text(*span.start_gps), gps_text(end)));
    } else {
        add_fact(facts, "UTC", "not known: the recording's time is relative");
    }
    add_fact(facts, "Length", seconds_text(span.duration));
    return facts;
}

/// Where a window is in the recording.
Json place_facts(const WindowSpan& span) {
    Json facts = Json::array();
    const ElapsedTime end{span.start.nanoseconds + span.duration.nanoseconds};
    add_fact(facts, "From the first epoch",
             fmt::format("{} to {}", seconds_text(span.start), seconds_text(end)));
    add_fact(facts, "Epochs", fmt::format("{} to {}", span.first_epoch, span.last_epoch));
    return facts;
}

/// The rule's speed where it is none of the four definitions; empty where it is one.
std::string other_definition(const Profile& profile) {
    if (profile.window_kind == WindowKind::course) return "Over the course";
    if (profile.speed_source == SpeedSource::velocity)
        return fmt::format("Recorded velocities, {}", words_of(profile.definition));
    return {};
}

/// To which speeds beside the measured one are rounded.
double shown_uncertainty(const CertifiableWindow& window, const Profile& profile) {
    return expanded_uncertainty_m_s(window, profile.coverage_factor);
}

std::string definition_note(const CertifiableWindow& best, const Profile& profile) {
    if (profile.window_kind == WindowKind::course)
        return "None of the four definitions is the rule's: its speed is over the course, the "
               "surveyed length over the time between the lines. They are of the smoothed "
               "trajectory.";
    if (profile.speed_source == SpeedSource::velocity)
        return "None of the four definitions is the rule's: its speed is of the velocities that "
               "the recording states. They are of the smoothed trajectory.";
    if (best.estimates && best.selection &&
        best.selection->treatment == SelectionTreatment::subtracted)
        return "These figures are of the smoothed trajectory. The measured speed is the rule's, "
               "less what choosing the fastest window makes it look higher by.";
    return {};
}

void set_definitions(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const SpeedDefinitions& all = best.definitions;
    const double u = shown_uncertainty(best, profile);
    std::vector<SpeedRow> rows;
    json["definitions"] = Json::array();
    const std::string other = other_definition(profile);
    if (!other.empty()) rows.push_back({other + " – the rule's", best.speed_m_s});
    for (const SpeedDefinition name : {SpeedDefinition::displacement, SpeedDefinition::path_length,
                                       SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
        const bool counts = other.empty() && name == profile.definition;
        Json entry{{"definition", to_text(name)}, {"counts", counts}};
        set_speeds(entry, "speed", speed_by(all, name));
        json["definitions"].push_back(std::move(entry));
        rows.push_back(
            {capitalised(words_of(name)) + (counts ? " – the rule's" : ""), speed_by(all, name)});
    }
    const std::string note = definition_note(best, profile);
    if (!note.empty()) json["definition_note"] = note;
    if (!best.fitted)
        rows.push_back(
            {"Standard uncertainty", best.standard_uncertainty_m_s, SpeedRow::uncertainty});
    json["definition_table"] = speed_table(rows, profile, u);
}

std::string window_label(const WindowSpan& span) {
    return fmt::format("{} from {}", seconds_text(span.duration), seconds_text(span.start));
}

/// The windows that make the figure together with the best one.
void set_further(Json& json, const ProfileWindows& windows, const Profile& profile) {
    if (windows.further.empty()) return;
    const double u = shown_uncertainty(*windows.best, profile);
    std::vector<SpeedRow> rows{{window_label(windows.best->span), windows.best->speed_m_s}};
    for (const FurtherWindow& further : windows.further) {
        Json entry = members_json(further.span);
        set_end(entry, further.span);
        entry["arc"] = further.arc;
        set_speeds(entry, "speed", further.speed_m_s);
        set_speeds(entry, "standard_uncertainty", further.standard_uncertainty_m_s);
        json["further"].push_back(std::move(entry));
        rows.push_back({window_label(further.span), further.speed_m_s});
    }
    if (const auto figure = figure_of(windows))
        rows.push_back({fmt::format("Mean of the {}", rows.size()), figure->speed_m_s});
    json["further_table"] = speed_table(rows, profile, u);
}

void set_methods(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const std::vector<std::pair<std::string, SpeedRow>> methods{
        {"smoothed", {"Smoother, forward and backward", best.methods.smoothed_m_s}},
        {"batch", {"Batch least squares", best.methods.batch_m_s}},
        {"v1", {"Method v1 of [DHD22]: central difference", best.methods.v1_m_s}},
        {"v2", {"Method v2 of [DHD22]: path length", best.methods.v2_m_s}},
        {"kalman", {"Forward filter of [DHD22]", best.methods.kalman_m_s}}};
    json["methods"] = Json::array();
    std::vector<SpeedRow> rows;
    for (const auto& [name, row] : methods) {
        rows.push_back(row);
        if (!row.speed_m_s) continue;
        Json entry{{"method", name}};
        set_speeds(entry, "speed", row.speed_m_s);
        json["methods"].push_back(std::move(entry));
    }
    json["method_table"] = speed_table(rows, profile, shown_uncertainty(best, profile));
}

/// What of an error that nothing found is in the interval, and what is not.
std::string drift_words(const CertifiableWindow& window, const SpeedUnit& unit,
                        const WitnessedSpeed* heard, double coverage_factor) {
    if (!window.evidence || window.evidence->fault_probability == 0.0) return {};
    const SpeedEvidence& evidence = *window.evidence;
    const auto expanded = [&](double standard_m_s) {
        return shown_in({.expanded_uncertainty_m_s =
                             coverage_factor * standard_m_s + window.bias_limit_m_s},
                        unit)
            .expanded_uncertainty;
    };
    const std::string taken = fmt::format(
        "In one window of {:.0f} the positions are taken to err unseen, by up to {} {}. The "
        "interval carries that risk on average (row d), and would not hold the speed of such a "
        "window. Taken a fifth as often, the expanded uncertainty would be {} {}; five times as "
        "often, {} {}.",
        1.0 / evidence.fault_probability, significant_text(evidence.fault_m_s * unit.per_m_s, 3),
        unit.name, expanded(evidence.at_a_fifth_m_s), unit.name,
        expanded(evidence.at_five_times_m_s), unit.name);
    if (heard == nullptr) return taken;
    return fmt::format(
        "{} Beside the {} an error of more than {} {} would have been found with a probability of "
        "80 %.",
        taken, words_of(heard->kind), significant_text(heard->undetected_m_s * unit.per_m_s, 3),
        unit.name);
}

Json error_json(const UndetectedError& error, const SpeedUnit& unit) {
    Json json = members_json(error);
    const bool nothing = is_harmless(error);
    const bool unlimited = is_unlimited(error);
    json["kind_text"] = tested_error_text(error.hypothesis);
    json["where_text"] = nothing ? "–" : where_text(error);
    json["size_text"] = nothing ? "–" : unlimited ? "any" : size_text(error);
    json["change_text"] = nothing     ? "0"
                          : unlimited ? "no limit"
                                      : significant_text(error.speed_m_s * unit.per_m_s, 3);
    return json;
}

/// The largest that is not a drift, and what all of them together are taken to do.
Json shown_json(const CertifiableWindow& window, const UncertaintyScale& scale) {
    const SpeedUnit& unit = scale.unit;
    const auto& errors = window.reliability;
    const auto worst = std::ranges::find_if(
        errors, [](const UndetectedError& error) { return error.hypothesis != Hypothesis::ramp; });
    const auto heard = std::ranges::max_element(window.witnesses, {}, &WitnessedSpeed::share);
    const bool shared = heard != window.witnesses.end() && heard->share > 0.0;
    Json json = Json::object();
    if (worst != errors.end())
        json["reliability_words"] =
            capitalised(undetected_error_text(*worst, *window.detection_power, unit)) + ".";
    if (std::string words =
            drift_words(window, unit, shared ? &*heard : nullptr, scale.coverage_factor);
        !words.empty())
        json["drift_words"] = std::move(words);
    json["reliability_unit"] = unit.name;
    return json;
}

/// Sets what errors that screening finds with less than its stated power could have changed the
/// speed by: `repaired_steps`, `detection_power`, `reliability`, and `reliability_shown`, the same
/// in words. Nothing where the window's file does not say it.
void set_reliability(Json& json, const CertifiableWindow& window, const UncertaintyScale& scale) {
    if (!window.detection_power) return;
    json["repaired_steps"] = window.repaired_steps;
    json["detection_power"] = rounded(*window.detection_power, 6);
    json["reliability"] = Json::array();
    for (const UndetectedError& error : window.reliability)
        json["reliability"].push_back(error_json(error, scale.unit));
    if (!window.reliability.empty()) json["reliability_shown"] = shown_json(window, scale);
}

}  // namespace

Json window_json(const ProfileVerdict& verdict, const ProfileWindows* windows,
                 const Profile& profile) {
    Json json = members_json(*verdict.window);
    set_end(json, *verdict.window);
    Json facts = place_facts(*verdict.window);
    if (windows != nullptr && windows->best) {
        const CertifiableWindow& best = *windows->best;
        json["arc"] = best.arc;
        json["candidates"] = windows->candidates;
        json["displacement_m"] = rounded(best.displacement_m, 6);
        add_fact(facts, "Distance between its ends", format_fixed(best.displacement_m, 3) + " m");
        json["position_r95_m"] = rounded(best.position_r95_m, 6);
        add_fact(facts, "Position at its ends, 95 % radius",
                 format_fixed(best.position_r95_m, 3) + " m");
        add_fact(facts, "Windows compared", Json(windows->candidates).dump());
        if (best.length_m) {
            json["length_m"] = rounded(*best.length_m, 6);
            add_fact(facts, "Length that the speed is of", format_fixed(*best.length_m, 3) + " m");
        }
        set_definitions(json, best, profile);
        set_further(json, *windows, profile);
        set_methods(json, best, profile);
        json["uncertainty"] = uncertainty_json(verdict, *windows, profile);
        set_reliability(json, best, {rule_unit(profile), verdict.coverage_factor});
        if (best.repaired_steps > 0)
            add_fact(facts, "Steps inside it, bridged with their offsets as unknowns",
                     Json(best.repaired_steps).dump());
    }
    json["window_time"] = time_facts(*verdict.window);
    json["window_facts"] = std::move(facts);
    return json;
}

Json indicated_json(const ProfileVerdict& verdict, const Profile& profile) {
    const RefusedWindow& indicated = *verdict.indicated;
    Json json = members_json(indicated);
    set_end(json, indicated.span);
    json["indicated_speed"] = speed_beside(verdict, indicated.speed_m_s, rule_unit(profile).name);
    Json facts = time_facts(indicated.span);
    for (const Json& place : place_facts(indicated.span))
        facts.push_back(place);
    json["indicated_facts"] = std::move(facts);
    return json;
}

}  // namespace runcert

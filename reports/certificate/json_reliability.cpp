#include "reports/certificate/json_reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/words/screening.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

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

}  // namespace

void set_reliability(Json& json, const CertifiableWindow& window, const UncertaintyScale& scale) {
    if (!window.detection_power) return;
    json["repaired_steps"] = window.repaired_steps;
    json["detection_power"] = rounded(*window.detection_power, 6);
    json["reliability"] = Json::array();
    for (const UndetectedError& error : window.reliability)
        json["reliability"].push_back(error_json(error, scale.unit));
    if (!window.reliability.empty()) json["reliability_shown"] = shown_json(window, scale);
}

}  // namespace runcert

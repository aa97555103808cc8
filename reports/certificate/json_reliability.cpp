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

bool is(const UndetectedError& error, Hypothesis hypothesis) {
    return error.hypothesis == hypothesis;
}

std::string speed_words(const UndetectedError& error, const SpeedUnit& unit) {
    return fmt::format("{} {}", significant_text(error.speed_m_s * unit.per_m_s, 3), unit.name);
}

/// A drift is a time-correlated error, whose bound is a row of the budget. The positions of one
/// receiver do not separate a steady drift from motion, so the tests find only one far beyond it.
std::string drift_words(const UndetectedError& drift, const SpeedUnit& unit,
                        const WitnessedSpeed* heard) {
    if (heard != nullptr)
        return fmt::format(
            "The {} test for every error, drifts included: together with screening they find any "
            "that changes the speed by more than {} {}. Row d of the budget is for that.",
            words_of(heard->kind), significant_text(heard->undetected_m_s * unit.per_m_s, 3),
            unit.name);
    const std::string covered =
        "A drift of the positions is covered as a time-correlated error up to the bound of row b, "
        "and not added again. ";
    if (is_harmless(drift)) return covered + "No undetected one beyond it could change the speed.";
    if (is_unlimited(drift)) return covered + "Beyond it the tests find none, whatever its rate.";
    return fmt::format(
        "{}The tests would find one, with that probability, from a rate of {} ({}), which changes "
        "the speed by {}. A drift between the two is not in the uncertainty.",
        covered, size_text(drift), where_text(drift), speed_words(drift, unit));
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

bool has_row(const CertifiableWindow& window, std::string_view symbol) {
    return std::any_of(window.budget.begin(), window.budget.end(),
                       [&](const BudgetRow& row) { return row.symbol == symbol; });
}

/// The largest that is not a drift is what the budget takes in.
Json shown_json(const CertifiableWindow& window, const SpeedUnit& unit) {
    const auto& errors = window.reliability;
    const auto worst =
        std::find_if_not(errors.begin(), errors.end(),
                         [](const UndetectedError& error) { return is(error, Hypothesis::ramp); });
    const auto drift = std::find_if(errors.begin(), errors.end(), [](const UndetectedError& error) {
        return is(error, Hypothesis::ramp);
    });
    const auto heard = std::ranges::find_if(
        window.witnesses, [](const WitnessedSpeed& one) { return one.share > 0.0; });
    const WitnessedSpeed* const witness = heard == window.witnesses.end() ? nullptr : &*heard;
    Json json = Json::object();
    if (worst != errors.end())
        json["reliability_words"] =
            capitalised(undetected_error_text(*worst, *window.detection_power, unit)) + "." +
            (has_row(window, "d") && !witness ? " Row d of the budget is for it." : "");
    if (drift != errors.end()) json["drift_words"] = drift_words(*drift, unit, witness);
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
    if (!window.reliability.empty()) json["reliability_shown"] = shown_json(window, scale.unit);
}

}  // namespace runcert

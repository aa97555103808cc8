#include "reports/certificate/json_reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/rounding.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// A size that stands in the file for one without limit.
constexpr double without_limit = 1e6;

bool is(const UndetectedError& error, Hypothesis hypothesis) {
    return error.hypothesis == hypothesis;
}

bool is_unlimited(const UndetectedError& error) {
    return error.size >= without_limit || error.speed_m_s >= without_limit;
}

/// The stretch's tests see no such error, or the speed does not depend on it.
bool is_nothing(const UndetectedError& error) {
    return !(error.speed_m_s > 0.0);
}

std::string kind_words(const UndetectedError& error) {
    if (is(error, Hypothesis::outlier)) return "outlier of one epoch";
    if (is(error, Hypothesis::burst)) return "outliers of several epochs";
    if (is(error, Hypothesis::step)) return "step of the positions";
    if (is(error, Hypothesis::ramp)) return "drift of the positions";
    if (is(error, Hypothesis::time_shift)) return "jump of the time stamps";
    return std::string(to_text(error.hypothesis));
}

/// "before epoch 812", "at epochs 812 to 815", "from epoch 812 on".
std::string where_text(const UndetectedError& error) {
    if (error.epoch != error.last_epoch)
        return fmt::format("at epochs {} to {}", error.epoch, error.last_epoch);
    if (is(error, Hypothesis::outlier) || is(error, Hypothesis::burst))
        return fmt::format("at epoch {}", error.epoch);
    if (is(error, Hypothesis::ramp)) return fmt::format("from epoch {} on", error.epoch);
    return fmt::format("before epoch {}", error.epoch);
}

std::string size_text(const UndetectedError& error) {
    return fmt::format("{} {}", significant_text(error.size, 2),
                       error.unit == "m / s" ? "m/s" : error.unit);
}

std::string speed_words(const UndetectedError& error, const SpeedUnit& unit) {
    return fmt::format("{} {}", significant_text(error.speed_m_s * unit.per_m_s, 3), unit.name);
}

/// "step of 0.10 m (before epoch 812)".
std::string error_words(const UndetectedError& error) {
    const std::string size = size_text(error);
    const std::string where = where_text(error);
    if (is(error, Hypothesis::outlier))
        return fmt::format("error of one position by {} ({})", size, where);
    if (is(error, Hypothesis::burst))
        return fmt::format("error of several positions by {} ({})", size, where);
    if (is(error, Hypothesis::step)) return fmt::format("step of {} ({})", size, where);
    return fmt::format("{} of {} ({})", kind_words(error), size, where);
}

std::string worst_words(const UndetectedError& error, double power, const SpeedUnit& unit) {
    if (is_nothing(error))
        return "No undetected error of a position, and no step, could have changed the speed.";
    if (is_unlimited(error))
        return fmt::format(
            "A {} ({}) could not be detected whatever its size: what it could have done to the "
            "speed has no limit.",
            kind_words(error), where_text(error));
    return fmt::format(
        "An undetected {} could have changed the speed by at most {}; larger ones are found with a "
        "probability of more than {:g}.",
        error_words(error), speed_words(error, unit), power);
}

/// A drift is a time-correlated error, whose bound is a row of the budget; but the positions of one receiver
/// cannot tell a steady drift from motion, so that the tests find only one far beyond that bound.
std::string drift_words(const UndetectedError& drift, const SpeedUnit& unit) {
    const std::string covered =
        "A drift of the positions is covered as a time-correlated error, as far as the bound of row b goes, "
        "and not added again";
    if (is_nothing(drift))
        return covered + "; no undetected one beyond it could have changed the speed.";
    if (is_unlimited(drift)) return covered + ". Beyond it the tests find none, whatever its rate.";
    return fmt::format(
        "{}. Beyond it the tests would find one, with that probability, from a rate of {} ({}), "
        "which changes the speed by {}: one between the two is not in the uncertainty.",
        covered, size_text(drift), where_text(drift), speed_words(drift, unit));
}

Json error_json(const UndetectedError& error, const SpeedUnit& unit) {
    Json json = members_json(error);
    const bool nothing = is_nothing(error);
    const bool unlimited = is_unlimited(error);
    json["kind_text"] = kind_words(error);
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
    Json json = Json::object();
    if (worst != errors.end())
        json["reliability_words"] = worst_words(*worst, *window.detection_power, unit) +
                                    (has_row(window, "d") ? " Row d of the budget is for it." : "");
    if (drift != errors.end()) json["drift_words"] = drift_words(*drift, unit);
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

#include "reports/words/decision.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/prose.h"

namespace runcert {

std::string guard_band_figure(const ProfileVerdict& verdict, const SpeedUnit& unit) {
    if (!verdict.decision || !verdict.required_speed_m_s) return {};
    const double required_m_s = *verdict.required_speed_m_s;
    const double guard_m_s = std::max(0.0, verdict.decision->acceptance_limit_m_s - required_m_s);
    if (!verdict.speed_m_s) return uncertainty_rounded_up(guard_m_s * unit.per_m_s);
    const ShownFigures shown = shown_of(verdict, unit.name);
    return shown_difference(shown_speed(SpeedKind::limit, required_m_s + guard_m_s, shown, unit),
                            shown_speed(SpeedKind::required, required_m_s, shown, unit));
}

std::string guard_band_text(const ProfileVerdict& verdict, const SpeedUnit& unit) {
    const std::string guard = guard_band_figure(verdict, unit);
    if (guard.empty()) return {};
    return fmt::format("w = {} {} (acceptance limit less required speed).", guard, unit.name);
}

std::string risk_text(const ProfileVerdict& verdict) {
    // Where nothing is proven no outcome is claimed that could be wrong.
    if (!verdict.decision || !verdict.decision->risk ||
        verdict.outcome == Outcome::not_certifiable || verdict.outcome == Outcome::not_proven)
        return {};
    const std::string risk = probability_text(*verdict.decision->risk);
    if (verdict.outcome == Outcome::beaten)
        return fmt::format(
            "of false acceptance: {} (that the true speed is below the required speed).", risk);
    return fmt::format("of false rejection: {} (that the true speed reaches the required speed).{}",
                       risk,
                       risk == probability_text(verdict.decision->probability)
                           ? ""
                           : " It counts errors that nothing found for the craft; the conformance "
                             "probability counts them against it.");
}

std::string record_text(const RecordToBeat& record) {
    return fmt::format(
        "{}{}: {}", number_text(record.speed, record.unit),
        record.expanded_uncertainty.value_or(0.0) > 0.0
            ? fmt::format(" ± {} (k = 2)", number_text(*record.expanded_uncertainty, record.unit))
            : "",
        claimed(record.source));
}

std::string decision_rule_text(const Profile& profile, const ProfileVerdict& verdict) {
    const double level = verdict.decision ? verdict.decision->level : profile.decision_probability;
    const std::string silent = silent_rule_text(profile);
    const std::int64_t made = verdict.decision ? verdict.decision->attempts_made : 1;
    return fmt::format(
        "It goes by the conformance probability, that the true speed reaches the required speed. "
        "{}At least {} counts as beaten, at most {} as not beaten, and anything between as not "
        "proven (guarded acceptance and rejection, JCGM 106).{}{}",
        made > 1
            ? fmt::format("As the best of {} attempts it may take one share of the risk. ", made)
            : "",
        level_text(level), level_text(1.0 - level), silent.empty() ? "" : " ", silent);
}

std::string silent_rule_text(const Profile& profile) {
    if (profile.written["decision"].exists() || profile.margin_above == MarginBase::upper_limit)
        return {};
    return fmt::format(
        "{}The rule does not say how uncertainty counts in the decision. Read literally, that is "
        "simple acceptance, with w = 0: this program asks for more.",
        profile.accuracy_limit_m_s
            ? "The rule's limit of the expanded uncertainty is no guard band. "
            : "");
}

}  // namespace runcert

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/prose.h"
#include "reports/words/figures.h"
#include "reports/words/screening.h"
#include "stages/check/context.h"

namespace runcert {
namespace {

/// "; the recorded velocities show 23.20 kn at 10:03:43.0 UTC": what a refused window shows is
/// named.
std::string shown_speed(const ClauseContext& context) {
    if (!context.windows.indicated) return {};
    return "; the recorded velocities show " + indicated_text(context);
}

/// What the positions say of the windows that the speed is made of: the one that agrees least.
std::optional<WitnessedSpeed> least_agreeing(const ProfileWindows& windows) {
    std::optional<WitnessedSpeed> least;
    const auto hear = [&](const std::vector<WitnessedSpeed>& witnesses) {
        for (const WitnessedSpeed& one : witnesses)
            if (one.kind == WitnessKind::positions &&
                (!least || one.normalised_error > least->normalised_error))
                least = one;
    };
    hear(windows.best->witnesses);
    for (const FurtherWindow& further : windows.further)
        hear(further.witnesses);
    return least;
}

/// By how much the speeds are behind the positions all over the stretch that holds the window, in
/// words; empty where nothing tells it.
std::string delay_there(const ClauseContext& context) {
    const auto& velocity = context.input.judged.tests.velocity;
    if (!velocity) return {};
    if (velocity->origin == VelocityOrigin::positions)
        return "the recorded velocities were computed from the positions";
    const WindowSpan& span = context.windows.best->span;
    const auto holds = [&](const VelocityDelay& one) {
        return !one.beyond && one.first_epoch <= span.first_epoch &&
               one.last_epoch >= span.last_epoch;
    };
    const auto there = std::ranges::find_if(velocity->delays, holds);
    if (there == velocity->delays.end()) return {};
    return fmt::format("by the changes of both from epoch {} to {} they are {} the positions",
                       there->first_epoch, there->last_epoch, delay_words(there->delay_s));
}

/// Why the velocities are no source of any speed; empty where they are.
std::string unfit(const ClauseContext& context) {
    const auto& velocity = context.input.judged.tests.velocity;
    if (!velocity || !velocity->unfit) return {};
    const std::string others = other_moments_text(*velocity);
    return fmt::format(
        "the recorded velocities are not those of these positions: {}{}, more than {:g} % "
        "(screen.velocity_share_max){}",
        others.empty() ? "" : others + "; ", unfit_text(*velocity),
        100.0 * context.input.attempt.parameters.screen.velocity_share_max, shown_speed(context));
}

}  // namespace

Finding computation::recorded_speeds(const Clause&, const ClauseContext& context) {
    if (std::string why = unfit(context); !why.empty())
        return {RequirementStatus::not_met, std::move(why)};
    if (!context.windows.best)
        return {RequirementStatus::not_met, "there is no certifiable window"};
    const auto one = least_agreeing(context.windows);
    if (!one) return {RequirementStatus::attest, "the positions say nothing of the window"};
    const std::vector<Figure> figures{
        {.name = "normalised error of the positions' speed", .value = one->normalised_error}};
    std::string evidence = witness_text(*one);
    if (one->normalised_error > 1.0)
        return {RequirementStatus::not_met,
                fmt::format("{}: one of the two is wrong{}", evidence, shown_speed(context)),
                figures};
    // Positions that may be half as fast, or half as fast again, agree with anything.
    constexpr double says_nothing = 0.5;
    const double expanded_m_s = 2.0 * one->standard_uncertainty_m_s;
    if (expanded_m_s > says_nothing * (one->speed_m_s + one->difference_m_s))
        return {RequirementStatus::not_met,
                fmt::format("{}; {}, or to contradict, any speed{}", evidence,
                            too_uncertain_text(expanded_m_s), shown_speed(context)),
                figures};
    const std::string delay = delay_there(context);
    if (!delay.empty()) evidence += "; " + delay;
    if (confirms(*one, context) || !delay.empty())
        return {RequirementStatus::met, std::move(evidence), figures};
    return {RequirementStatus::attest,
            evidence + "; " + too_uncertain_text(expanded_m_s) +
                ", and no change of speed tells whether they are of the same moments",
            figures};
}

}  // namespace runcert

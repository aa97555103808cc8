#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/failure.h"
#include "core/prose.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/statistics.h"
#include "core/uncertainty.h"
#include "schemas/screened/witness_text.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"

namespace runcert {
namespace {

/// Sets the other speed from times at the lines, or the reason why there is none.
void set_from_times(const WindowSpan& window, const SecondaryMethod::LineTimes& times,
                    const Course* course, DeclaredAgreement& agreement) {
    constexpr double same_crossing_s = 2.0;
    if (!course) {
        agreement.missing = "times at the lines of a course say nothing of this rule's window";
        return;
    }
    if (!window.start_gps) {
        agreement.missing = "its times cannot be compared: the recording's time is relative";
        return;
    }
    const GpsTime end = window.start_gps->plus_nanoseconds(window.duration.nanoseconds);
    const double start_s = times.start.seconds_since(*window.start_gps);
    const double finish_s = times.finish.seconds_since(end);
    if (std::abs(start_s) > same_crossing_s || std::abs(finish_s) > same_crossing_s) {
        agreement.missing = fmt::format(
            "its times are {:+.3f} s and {:+.3f} s off those of the window: they are of another "
            "run, or of another clock",
            start_s, finish_s);
        return;
    }
    const double elapsed_s = times.finish.seconds_since(times.start);
    agreement.other_m_s = course_speed_m_s(course->length_m, elapsed_s, 0.0);
    agreement.other_expanded_uncertainty_m_s =
        std::hypot(std::numbers::sqrt2 * times.expanded_uncertainty_s * agreement.other_m_s,
                   course->length_expanded_uncertainty_m) /
        elapsed_s;
}

/// Why the second receiver says nothing about the window.
std::string_view silence_of_receiver(const CheckInput& input) {
    const auto& baseline = input.judged.tests.baseline;
    if (baseline && baseline->same_errors)
        return "has the errors of the first one's positions: one recording was made from the other";
    if (!input.judged.facts.first_epoch || !input.secondary->facts.first_epoch)
        return "cannot be compared: the time of a recording is relative (give its start_gps)";
    if (input.judged.origin.has_value() != input.secondary->origin.has_value())
        return "cannot be compared: only one of the two has a place on the Earth";
    return "has no estimate over the whole of that time without a break or a step";
}

Figure normalised_error(const std::string& of, double value) {
    return at_most(plain("normalised error " + of, value), 1.0);
}

std::string doubt(double expanded_uncertainty_m_s, const ClauseContext& context) {
    return could_have_failed(expanded_uncertainty_m_s, context)
               ? std::string()
               : "; " + too_uncertain_text(expanded_uncertainty_m_s, context);
}

/// Decides by the normalised error of a second measurement. Agreement meets the clause only where
/// it could have failed.
Finding by_agreement(const std::string& of, double error, double expanded_uncertainty_m_s,
                     const std::string& evidence, const ClauseContext& context) {
    Finding finding = error > 1.0 ? not_met("{}", evidence)
                      : could_have_failed(expanded_uncertainty_m_s, context)
                          ? met("{}", evidence)
                          : to_attest("{}", evidence);
    finding.evidence += doubt(expanded_uncertainty_m_s, context);
    return std::move(finding).by({normalised_error(of, error)});
}

/// The second receiver's finding.
Finding by_receiver(const ClauseContext& context) {
    const std::string& receiver = context.input.secondary->receiver;
    if (!context.windows.best) return not_met("{} to compare", no_window);
    const auto& witnesses = context.windows.best->witnesses;
    const auto one = std::ranges::find(witnesses, receiver, &WitnessedSpeed::receiver);
    if (one == witnesses.end())
        return not_met("receiver \"{}\" {}", receiver, silence_of_receiver(context.input));
    const double expanded_m_s = 2.0 * one->standard_uncertainty_m_s;
    const ComparedSpeeds shown = compared_speeds(context, one->speed_m_s, expanded_m_s,
                                                 one->speed_m_s + one->difference_m_s);
    return by_agreement(
        "of receiver " + receiver, one->normalised_error, expanded_m_s,
        fmt::format(
            "receiver \"{}\" gives {} over the same {:.3f} s, {} against the primary one's {}; "
            "normalised error {:.2f}, at most 1, with what the two do not share: noise, each "
            "receiver's own time-correlated error, antenna. They share base station, satellites, "
            "atmosphere, frame and time scale",
            receiver, shown.other, context.windows.best->span.duration.seconds(), shown.difference,
            shown.judged, one->normalised_error),
        context);
}

/// What a second method is compared with, and what lies between that and the measured speed: "the
/// positions' 54.40 kn before the current is taken off".
std::string judged_text(const ComparedSpeeds& shown, const ClauseContext& context) {
    return fmt::format("the positions' {}{}{}", shown.judged,
                       context.windows.further.empty() ? "" : " over the best window",
                       subtracted_current(context) ? " before the current is taken off" : "");
}

/// The second method's speed beside the positions', from its first figure on.
std::string declared_text(const ClauseContext& context) {
    const DeclaredAgreement& second = *context.declared;
    const ComparedSpeeds shown = compared_speeds(
        context, second.other_m_s, second.other_expanded_uncertainty_m_s, second.judged_m_s);
    return fmt::format("gives {}, {} against {}", shown.other, shown.difference,
                       judged_text(shown, context));
}

/// The finding of the method that the attempt declares.
Finding by_declaration(const ClauseContext& context) {
    if (!context.declared) return not_met("{} to compare", no_window);
    const DeclaredAgreement& second = *context.declared;
    if (!second.missing.empty()) return not_met("{}: {}", second.method, second.missing);
    return by_agreement("of the second method", second.normalised_error,
                        second.other_expanded_uncertainty_m_s,
                        fmt::format("{} {}; normalised error {:.2f}, at most 1", second.method,
                                    declared_text(context), second.normalised_error),
                        context);
}

/// The finding of witnesses of the same receiver, which meet the clause where it accepts them.
Finding by_own_witnesses(const Clause& clause, const ClauseContext& context) {
    Finding finding{RequirementStatus::attest, {}};
    if (context.windows.best)
        for (const WitnessedSpeed& one : context.windows.best->witnesses) {
            finding.figures.push_back(normalised_error(fmt::format("of the {}", words_of(one.kind)),
                                                       one.normalised_error));
            finding.evidence += fmt::format("{}{}", finding.evidence.empty() ? "" : "; ",
                                            witness_text(one, context));
            finding.evidence += doubt(2.0 * one.standard_uncertainty_m_s, context);
            const bool accepted =
                std::ranges::find(clause.accepts, to_text(one.kind)) != clause.accepts.end();
            if (accepted && confirms(one, context)) finding.status = RequirementStatus::met;
        }
    if (finding.evidence.empty())
        finding.evidence = "the attempt has one receiver; another method is not part of it";
    else if (finding.status == RequirementStatus::attest)
        finding.evidence += "; whether that counts as a second method the rule does not say";
    return finding;
}

/// What a refused window shows: "; the recorded velocities show 23.20 kn at 10:03:43.0 UTC".
std::string shown_speed(const ClauseContext& context) {
    if (!context.windows.indicated) return {};
    return "; the recorded velocities show " + indicated_text(context);
}

/// The positions' result for the windows of the speed: the one that agrees least. Null if none.
const WitnessedSpeed* least_agreeing(const std::vector<FurtherWindow>& windows) {
    const WitnessedSpeed* least = nullptr;
    for (const FurtherWindow& window : windows)
        for (const WitnessedSpeed& one : window.witnesses)
            if (one.kind == WitnessKind::positions &&
                (!least || one.normalised_error > least->normalised_error))
                least = &one;
    return least;
}

/// In words, the delay of the speeds relative to the positions over the stretch with the window, or
/// that they were computed from the positions. Empty if neither is known.
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

/// Why the velocities cannot be used for any speed. Empty if they can.
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

double course_speed_m_s(double distance_m, double elapsed_s, double current_m_s) {
    if (!(distance_m > 0.0 && elapsed_s > 0.0 && std::isfinite(distance_m) &&
          std::isfinite(elapsed_s) && std::isfinite(current_m_s)))
        throw Failure("course",
                      fmt::format("{} m in {} s with a current of {} m/s", distance_m, elapsed_s,
                                  current_m_s),
                      "Give a distance and a time above 0 and a finite current");
    return distance_m / elapsed_s - current_m_s;
}

std::string second_method_text(const ClauseContext& context) {
    const DeclaredAgreement& second = *context.declared;
    std::string text =
        fmt::format("the second method ({}) {} (normalised error {:.2f}, at most 1).",
                    second.method, declared_text(context), second.normalised_error);
    if (const auto between = subtracted_current(context);
        between && context.windows.further.empty())
        text += fmt::format(" The measured {} {} is {} over the ground less the current of {}.",
                            context.shown->speed, context.shown->unit, between->over_ground,
                            between->current);
    return text;
}

std::optional<DeclaredAgreement> compare_declared(const CertifiableWindow& best,
                                                  const Profile& profile, const Attempt& attempt) {
    if (!attempt.secondary_method) return std::nullopt;
    const SecondaryMethod& method = *attempt.secondary_method;
    DeclaredAgreement agreement{.method = method.method, .judged_m_s = best.speed_m_s};
    const bool over_course = profile.window_kind == WindowKind::course && attempt.course;
    if (method.times)
        set_from_times(best.span, *method.times, over_course ? &*attempt.course : nullptr,
                       agreement);
    else {
        agreement.other_m_s = method.speed->speed_m_s;
        agreement.other_expanded_uncertainty_m_s = method.speed->expanded_uncertainty_m_s;
    }
    if (!agreement.missing.empty()) return agreement;
    const double difference_m_s = std::abs(agreement.other_m_s - agreement.judged_m_s);
    const double allowed_m_s =
        std::hypot(usual_coverage_factor *
                       best.own_standard_uncertainty_m_s.value_or(best.standard_uncertainty_m_s),
                   agreement.other_expanded_uncertainty_m_s);
    agreement.normalised_error = difference_m_s == 0.0 ? 0.0 : difference_m_s / allowed_m_s;
    return agreement;
}

Finding computation::secondary_method(const Clause& clause, const ClauseContext& context) {
    const bool declared = context.input.attempt.secondary_method.has_value();
    if (!context.input.secondary)
        return declared ? by_declaration(context) : by_own_witnesses(clause, context);
    Finding other = by_receiver(context);
    if (!context.files_attested && other.status == RequirementStatus::met) {
        other.status = RequirementStatus::attest;
        other.evidence += "; this counts once an official has answered for its file";
    }
    if (!declared) return other;
    Finding finding = by_declaration(context);
    finding.observed = other.status == RequirementStatus::met;
    if (finding.status != RequirementStatus::not_met) finding.status = other.status;
    finding.evidence += "; " + other.evidence;
    finding.figures.insert(finding.figures.end(), other.figures.begin(), other.figures.end());
    return finding;
}

Finding computation::recorded_speeds(const Clause&, const ClauseContext& context) {
    if (const std::string why = unfit(context); !why.empty()) return not_met("{}", why);
    if (!context.windows.best) return not_met(no_window);
    const WitnessedSpeed* const one = least_agreeing(context.counted);
    if (!one) return to_attest("the positions say nothing of the window");
    const std::vector<Figure> figures{
        normalised_error("of the positions' speed", one->normalised_error)};
    std::string evidence = witness_text(*one, context);
    if (one->normalised_error > 1.0)
        return not_met("{}: one of the two is wrong{}", evidence, shown_speed(context)).by(figures);
    // Positions that allow half the speed, or half as much again, agree with anything.
    constexpr double says_nothing = 0.5;
    const double expanded_m_s = 2.0 * one->standard_uncertainty_m_s;
    const std::string uncertain = too_uncertain_text(expanded_m_s, context);
    if (expanded_m_s > says_nothing * (one->speed_m_s + one->difference_m_s))
        return not_met("{}; {}, or to contradict, any speed{}", evidence, uncertain,
                       shown_speed(context))
            .by(figures);
    const std::string delay = delay_there(context);
    if (!delay.empty()) evidence += "; " + delay;
    // Met by a test that would find, in four cases of five, 1 % or 2 U. Receivers are off by 0.3 %.
    const auto finds_error = [&](double sigma_m_s) {
        return (2.0 + normal_quantile(0.8)) * sigma_m_s <=
               std::max(0.01 * one->speed_m_s,
                        2.0 * context.expanded_uncertainty_m_s.value_or(0.0));
    };
    const auto& velocity = context.input.judged.tests.velocity;
    const bool compared = velocity && velocity->ratio;
    const double ratio = compared ? *velocity->ratio : 1.0;
    const double sigma = compared ? std::hypot(*velocity->sigma_ratio, 0.003) : 1.0;
    const bool of_one_scale = std::abs(ratio - 1.0) <= 2.0 * sigma;
    if (of_one_scale && confirms(*one, context) &&
        finds_error(
            std::hypot(one->standard_uncertainty_m_s, one->position_standard_uncertainty_m_s)))
        return met("{}", evidence).by(figures);
    if (delay.empty())
        return to_attest(
                   "{}; {}, and no change of speed tells whether they are of the same moments",
                   evidence, uncertain)
            .by(figures);
    const std::string words = fmt::format(
        "{}; {} alone; over the recording the speeds are {:.4f} ± {:.4f} times the positions'",
        evidence, uncertain, ratio, 2.0 * sigma);
    return (of_one_scale && finds_error(sigma * one->speed_m_s)
                ? met("{}", words)
                : to_attest("{}: they may err by 1 % or more", words))
        .by(figures);
}

}  // namespace runcert

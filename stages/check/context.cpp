#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/uncertainty.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"
#include "witness/evidence.h"

namespace runcert {
namespace {

Threshold required_speed_over(const Profile& profile, const Record& record) {
    const double unit = metres_per_second(record.unit);
    MarginRule rule{.kind = profile.margin_kind,
                    .value = profile.margin,
                    .distance_m = profile.distance_m,
                    .above_upper_limit = profile.margin_above == MarginBase::upper_limit};
    if (const auto& rounding = profile.rounding)
        rule.rounding = DecimalRounding{.mode = direction_of(*rounding),
                                        .unit_m_s = metres_per_second(rounding->unit),
                                        .decimals = static_cast<int>(rounding->decimals)};
    return threshold_of(rule, {.speed_m_s = record.speed * unit,
                               .expanded_uncertainty_m_s = record.expanded_uncertainty * unit});
}

/// The row of an epoch. Empty if the trajectory is missing or has no such row.
std::optional<std::size_t> row_of(const std::vector<TrajectoryEpoch>& rows, std::int64_t epoch) {
    const auto row = std::ranges::find(rows, epoch, &TrajectoryEpoch::epoch);
    if (row == rows.end() || !row->arc) return std::nullopt;
    return static_cast<std::size_t>(row - rows.begin());
}

/// Time-correlated errors that may differ between places of a run. They are bounded as in the
/// window; for heights, the stated or estimated error is used if it is larger.
CourseErrors errors_of(const ReceiverFindings& judged, const CertifiableWindow& best) {
    CourseErrors errors;
    errors.tangent_plane = judged.facts.georeferenced;
    if (best.bound) errors.slow_horizontal_m = errors.slow_vertical_m = best.bound->sigma_m;
    if (const auto& vertical = judged.estimation.vertical) {
        const NoiseSummary& noise = vertical->noise;
        errors.slow_vertical_m =
            std::max({errors.slow_vertical_m, noise.white_scale * noise.stated_sigma_m,
                      noise.correlated_error_detected ? noise.error_sigma_m->value : 0.0});
    }
    return errors;
}

CourseFindings course_of(const ReceiverFindings& judged, const Profile& profile,
                         const CertifiableWindow& best) {
    const auto first = row_of(judged.trajectory, best.span.first_epoch);
    const auto last = row_of(judged.trajectory, best.span.last_epoch);
    if (!first || !last) return {.missing = "the trajectory does not hold the window"};
    for (const CraftRun& run : runs_under(profile, judged))
        if (run.first_row <= *first && *last <= run.last_row)
            return {.facts = course_facts(judged.trajectory, run, *first, *last,
                                          errors_of(judged, best)),
                    .run = run,
                    .missing = {},
                    .ground = judged.ground ? ground_facts(judged.trajectory, run, *first, *last,
                                                           *judged.ground, judged.origin)
                                            : std::nullopt};
    return {.missing =
                "the window is not within one run of the craft, as the profile's thresholds "
                "cut them"};
}

std::optional<FlowInWindow> flow_of(const MeasuredSeries* series, FlowKind kind,
                                    const CertifiableWindow& best, const CourseFindings& course) {
    if (series == nullptr) return std::nullopt;
    const double start_s = best.span.start.seconds();
    return flow_in_window(*series, kind, start_s, start_s + best.span.duration.seconds(),
                          course.facts ? course.facts->heading_deg.value : 0.0);
}

/// The speed that counts, with its uncertainty; nothing if a current to subtract is not known.
void set_speed(ClauseContext& context) {
    std::optional<SpeedPosterior> speed = figure_of(context.windows);
    if (!speed) return;
    if (context.profile.current == CurrentUse::subtracted) {
        if (!context.current || !context.current->missing.empty() || !context.course.facts) return;
        speed->speed_m_s -= context.current->along_m_s;
        const double of_current_m_s = 0.5 * context.input.attempt.current->expanded_uncertainty_m_s;
        const auto widen = [&](double& u_m_s) { u_m_s = std::hypot(u_m_s, of_current_m_s); };
        widen(speed->standard_uncertainty_m_s);
        if (speed->evidence) widen(speed->evidence->shared_standard_uncertainty_m_s);
    }
    context.coverage_factor = equivalent_coverage_factor(context.profile.coverage_factor,
                                                         speed->effective_degrees_of_freedom);
    context.expanded_uncertainty_m_s = expanded_uncertainty_m_s(*speed, context.coverage_factor);
    context.speed = speed;
}

/// Sets the drift that the decision survives, and the drift that screening detects in the window.
/// Speeds that the receiver measures do not drift with the positions.
void set_drift(ClauseContext& context) {
    if (context.profile.speed_source == SpeedSource::velocity) return;
    const double above_m_s = context.speed->speed_m_s - context.speed->bias_limit_m_s -
                             context.required_speed->speed_m_s;
    if (above_m_s > 0.0)
        context.decision->drift_survived_m =
            above_m_s * context.windows.best->span.duration.seconds();
    double found_m_s = 0.0;
    for (const ScreenedEpoch& row : context.epochs())
        found_m_s = std::max(found_m_s, row.detectable.ramp_m_s.value_or(0.0));
    if (found_m_s > 0.0) context.decision->drift_found_m_s = found_m_s;
}

/// Risk of the one-sided limit of the true speed that is printed beside the decision.
constexpr double tail_risk = 1e-4;

void set_decision(ClauseContext& context) {
    context.record = context.input.attempt.record_for(context.profile.id);
    if (context.record == nullptr) return;
    context.required_speed = required_speed_over(context.profile, *context.record);
    if (!context.speed) return;
    // Of several attempts the luckiest is submitted. Each is judged so that all together are
    // incorrect no more often than a single one (Bonferroni).
    const std::int64_t attempts = context.input.attempt.attempts_made;
    const double level =
        1.0 - (1.0 - context.profile.decision_probability) / static_cast<double>(attempts);
    const Conformance found = conformance(*context.speed, *context.required_speed);
    context.decision = Decision{
        .probability = found.smaller(),
        .by_uncertainty = found.by_uncertainty,
        .by_faults = found.by_faults,
        .level = level,
        .required_speed_standard_uncertainty_m_s = context.required_speed->standard_uncertainty_m_s,
        .acceptance_limit_m_s = acceptance_limit(*context.speed, *context.required_speed, level),
        .attempts_made = attempts,
        .bias_limit_m_s = context.speed->bias_limit_m_s};
    if (context.speed->evidence) {
        context.decision->tail_risk = tail_risk;
        context.decision->tail_speed_m_s =
            mixture_of(*context.speed->evidence, context.speed->speed_m_s, WitnessSet::observed)
                .quantile(tail_risk) -
            context.speed->bias_limit_m_s;
    }
    set_drift(context);
}

/// Sets the figures of the decision as shown, in the rule's unit.
void set_shown(ClauseContext& context) {
    if (!context.speed) return;
    const auto& rule = context.profile.result ? context.profile.result : context.profile.rounding;
    SpeedsToShow speeds{.speed_m_s = context.speed->speed_m_s,
                        .expanded_uncertainty_m_s = *context.expanded_uncertainty_m_s};
    if (context.required_speed) speeds.required_speed_m_s = context.required_speed->speed_m_s;
    if (context.decision) speeds.acceptance_limit_m_s = context.decision->acceptance_limit_m_s;
    context.shown = shown_in(speeds, context.unit(),
                             rule ? std::optional(static_cast<int>(rule->decimals)) : std::nullopt);
}

/// Whether the witness is recorded velocities that contradict too many positions. Those confirm
/// nothing.
bool is_unfit(const WitnessedSpeed& one, const ClauseContext& context) {
    const auto& velocity = context.input.judged.tests.velocity;
    return one.kind == WitnessKind::velocities && velocity && velocity->unfit;
}

/// Whether the witness comes from a receiver's recording, not from a separate file.
bool is_observed(const WitnessedSpeed& one) {
    return origin_of(one.kind).front() == to_text(InputOrigin::observed);
}

/// Sets the evidence for the window other than the positions. The attempt's statements do not
/// count.
void set_witnesses(ClauseContext& context) {
    for (const WitnessedSpeed& one : context.windows.best->witnesses) {
        if (contradicts(one) || is_unfit(one, context) || one.compared_over_s || one.unanswered)
            continue;
        const bool sure = confirms(one, context);
        (sure ? context.witnesses : context.unsure_witnesses).push_back(witness_text(one, context));
        context.observed = context.observed || (sure && is_observed(one));
    }
}

}  // namespace

StepRounding direction_of(const DecimalRule& rule) {
    return rule.mode == DecimalMode::truncate ? StepRounding::down : StepRounding::nearest;
}

std::string speed_of_rule(const ClauseContext& context, double speed_m_s, SpeedKind kind) {
    const SpeedUnit& unit = context.unit();
    return fmt::format("{} {}",
                       context.shown ? shown_speed(kind, speed_m_s, *context.shown, unit)
                                     : shown_speed(kind, speed_m_s, unit.decimals, unit),
                       unit.name);
}

ComparedSpeeds compared_speeds(const ClauseContext& context, double other_m_s,
                               double other_expanded_uncertainty_m_s, double judged_m_s) {
    const SpeedUnit& unit = context.unit();
    const ShownFigures page =
        context.shown ? *context.shown
                      : shown_in({.speed_m_s = judged_m_s,
                                  .expanded_uncertainty_m_s = other_expanded_uncertainty_m_s},
                                 unit);
    return compared_in(
        unit, {.speed_m_s = other_m_s, .expanded_uncertainty_m_s = other_expanded_uncertainty_m_s},
        judged_m_s, page);
}

std::optional<SubtractedCurrent> subtracted_current(const ClauseContext& context) {
    if (context.profile.current != CurrentUse::subtracted || !context.shown) return std::nullopt;
    const ShownFigures& shown = *context.shown;
    const std::string over_ground = in_decimals_of(
        shown, context.speed->speed_m_s + context.current->along_m_s, SafeSide::down);
    return SubtractedCurrent{
        .over_ground = fmt::format("{} {}", over_ground, shown.unit),
        .current = fmt::format("{} {}", signed_difference(over_ground, shown.speed), shown.unit)};
}

bool could_have_failed(double expanded_uncertainty_m_s, const ClauseContext& context) {
    constexpr double times = 3.0;
    const CertifiableWindow& best = *context.windows.best;
    double compared_m_s =
        2.0 * best.own_standard_uncertainty_m_s.value_or(best.standard_uncertainty_m_s);
    if (context.record != nullptr)
        compared_m_s = std::max(
            compared_m_s, context.required_speed->speed_m_s -
                              context.record->speed * metres_per_second(context.record->unit));
    return expanded_uncertainty_m_s <= times * compared_m_s;
}

bool confirms(const WitnessedSpeed& one, const ClauseContext& context) {
    return one.confirms && !contradicts(one) && !is_unfit(one, context) &&
           could_have_failed(2.0 * one.standard_uncertainty_m_s, context);
}

std::string too_uncertain_text(double expanded_uncertainty_m_s, const ClauseContext& context) {
    const SpeedUnit& unit = context.unit();
    return fmt::format("at ± {} {} it is too uncertain to confirm",
                       uncertainty_rounded_up(expanded_uncertainty_m_s * unit.per_m_s), unit.name);
}

std::string span_of(const WitnessedSpeed& one) {
    return one.compared_over_s ? fmt::format("{:.1f} s around the window", *one.compared_over_s)
                               : "the window";
}

std::string_view compared_with(WitnessKind kind) {
    return kind == WitnessKind::positions ? "the recorded velocities" : "the positions";
}

std::string witness_name(const WitnessedSpeed& one) {
    return one.kind == WitnessKind::receiver
               ? fmt::format("the positions of receiver \"{}\"", one.receiver)
               : fmt::format("the {}", words_of(one.kind));
}

std::string witness_text(const WitnessedSpeed& one, const ClauseContext& context) {
    const ComparedSpeeds shown =
        compared_speeds(context, one.speed_m_s, 2.0 * one.standard_uncertainty_m_s,
                        one.speed_m_s + one.difference_m_s);
    const char* const agreement =
        contradicts(one) ? "the two contradict one another" : "the two agree";
    if (one.kind == WitnessKind::phases)
        return fmt::format(
            "a second computation, from the raw signals handed in, gives {}; {} (normalised error "
            "{:.2f}, at most 1); that the receiver wrote them is to be attested",
            shown.other, agreement, one.normalised_error);
    const std::string_view positions =
        one.kind != WitnessKind::positions && context.profile.speed_of == SpeedOf::reference_point
            ? "the antenna by the positions"
            : compared_with(one.kind);
    return fmt::format(
        "{} give {} over {}, {} against the {} of {} (normalised error {:.2f}, at most 1)",
        witness_name(one) + (is_observed(one) ? "" : ", handed in by the claimant,"), shown.other,
        span_of(one), shown.difference, shown.judged, positions, one.normalised_error);
}

std::string indicated_text(const ClauseContext& context) {
    const IndicatedWindow& indicated = *context.windows.indicated;
    return fmt::format("{} {}",
                       speed_of_rule(context, indicated.mean_m_s.value_or(indicated.speed_m_s)),
                       beginning_text(indicated.span));
}

const ProfileWindows& windows_of(const Windows& windows, const Profile& profile, bool with_files) {
    const bool has_both = !windows.with_files.empty();
    for (const ProfileWindows& entry :
         (with_files && has_both) ? windows.with_files : windows.profiles)
        if (entry.profile == profile.id && entry.rule == rule_of(profile)) return entry;
    throw Failure("5-windows of receiver " + windows.receiver,
                  "the windows were not searched for the profile " + profile.id + " as it is now",
                  "Run runcert-window again");
}

std::vector<CraftRun> runs_under(const Profile& profile, const ReceiverFindings& judged) {
    return runs_in(judged.trajectory, {.start_m_s = profile.runs.start_m_s,
                                       .stop_m_s = profile.runs.stop_m_s,
                                       .stop_s = profile.runs.stop_s,
                                       .turn_deg = profile.runs.turn_deg});
}

ClauseContext gather_context(const CheckInput& input, const Profile& profile,
                             const ProfileWindows& windows, bool files_attested) {
    ClauseContext context{.input = input,
                          .profile = profile,
                          .windows = windows,
                          .coverage_factor = profile.coverage_factor,
                          .files_attested = files_attested};
    if (const auto& best = windows.best) {
        context.counted = windows.further;
        context.counted.insert(context.counted.begin(), {.span = best->span,
                                                         .speed_m_s = best->speed_m_s,
                                                         .robust = best->robust,
                                                         .evidence = best->evidence,
                                                         .witnesses = best->witnesses});
        context.course = course_of(input.judged, profile, *best);
        context.wind = flow_of(input.wind, FlowKind::wind, *best, context.course);
        context.current = flow_of(input.current, FlowKind::current, *best, context.course);
    } else {
        context.course.missing = no_window;
    }
    set_speed(context);
    set_decision(context);
    set_shown(context);
    if (windows.best) {
        context.declared = compare_declared(*windows.best, profile, input.attempt);
        set_witnesses(context);
    }
    return context;
}

}  // namespace runcert

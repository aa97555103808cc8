#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/statistics.h"
#include "schemas/screened/witness_text.h"
#include "stages/check/notes.h"

namespace runcert {
namespace {

/// Names of the parameters that a fit left at a limit of its range.
std::vector<std::string> at_bounds(const NoiseSummary& noise) {
    std::vector<std::string> names;
    const auto look = [&](const NoiseParameter* parameter, const char* name) {
        if (parameter && parameter->at_bound) names.emplace_back(name);
    };
    const auto found = [](const auto& parameter) { return parameter ? &*parameter : nullptr; };
    look(&noise.jerk_density, "jerk density");
    look(&noise.measurement_scale, "scale of the stated standard deviations");
    look(found(noise.acceleration_time_s), "correlation time of the acceleration");
    look(found(noise.error_diffusion), "size of the time-correlated error");
    look(found(noise.error_tau_s), "correlation time of the time-correlated error");
    return names;
}

/// Why nothing was fitted, and what is used instead.
void add_not_fitted(const NoiseSummary& noise, const char* axes, Sentences& say) {
    const std::string why =
        noise.status == NoiseBasis::too_few_epochs
            ? fmt::format(
                  "could not be estimated from the recording, which has {} usable epochs where {} "
                  "are required",
                  noise.epochs, noise.epochs_needed)
        : noise.status == NoiseBasis::constant_positions
            ? "could not be estimated from the recording, whose positions are all the same"
            : "was not estimated from the recording, as the attempt asks";
    say("The {} noise {}: the stated standard deviations times {:.2f} and a jerk density of {:.3g} "
        "m s^-2.5 were used.",
        axes, why, noise.measurement_scale.value, noise.jerk_density.value);
}

/// What the noise of these axes is, and how it was found.
void add_fit(const NoiseSummary& noise, const char* axes, Sentences& say) {
    if (noise.status != NoiseBasis::fitted) return add_not_fitted(noise, axes, say);
    say("The {} noise was estimated from {} epochs: {:.2f} times the stated standard deviations "
        "(root mean square {:.1f} mm), jerk density {:.3g} m s^-2.5{} as one for all of it. The "
        "trajectory takes the larger of that and what the motion shows there.",
        axes, noise.epochs, noise.measurement_scale.value, noise.stated_sigma_m * 1e3,
        noise.jerk_density.value,
        noise.acceleration_time_s ? fmt::format(", correlation time of the acceleration {:.2g} s",
                                                noise.acceleration_time_s->value)
                                  : "");
    if (!noise.correlated_error_detected)
        say("A time-correlated error of the {} positions could not be separated from their white "
            "noise and the motion: its bound decides.",
            axes);
    else if (!noise.error_tau_s->relative_uncertainty)
        say("The {} positions have a time-correlated error that wanders by {:.1f} mm in the first "
            "second; its size and its correlation time cannot be separated with these data.",
            axes, noise.error_diffusion->value * 1e3);
    else
        say("The {} positions have a time-correlated error of {:.1f} mm with a correlation time of "
            "{:.1f} s.",
            axes, noise.error_sigma_m->value * 1e3, noise.error_tau_s->value);
    if (const auto names = at_bounds(noise); !names.empty())
        say("In estimating the {} noise the search ended at a limit of its range for: {}.", axes,
            fmt::join(names, ", "));
    if (!noise.converged)
        say("In estimating the {} noise the search was stopped before it converged.", axes);
}

/// How the noise of these axes was found, and how the filter did with it.
void add_axes(const AxesEstimation& found, const char* axes, Sentences& say) {
    add_fit(found.noise, axes, say);
    const FilterHealth& health = found.health;
    if (!health.white)
        say("The {} innovations stay correlated (lag 1: {:+.2f}, with noise as stated {:+.2f}): "
            "the positions look as if the device had filtered them, {}.",
            axes, health.autocorrelation, health.autocorrelation_stated,
            health.autocorrelation > 0.0
                ? "which hides how they err"
                : "or their errors change along the recording more than their stated standard "
                  "deviations say");
    if (!health.consistent)
        say("The size of the {} innovations changes along the recording more than the stated "
            "standard deviations say: {} of {} spans are outside their limits, where chance allows "
            "{}.",
            axes, health.spans_outside, health.spans, health.spans_allowed);
}

/// What of the recording was read, and what it states of its errors.
void add_reading(const ReceiverFindings& judged, Sentences& say) {
    const RecordCount& records = judged.records;
    if (records.bad > 0)
        say("{} of {} records of the recording could not be read; none of them is used, and "
            "1-observations lists {}.",
            records.bad, records.total,
            records.bad > std::ssize(records.bad_records)
                ? fmt::format("the first {}", records.bad_records.size())
                : "them");
    if (judged.accuracy_source == "none")
        return say(
            "Neither the recording nor the attempt states an accuracy: nothing can be certified "
            "without one.");
    say("Stated standard deviations come from the {}.", judged.accuracy_source);
    const NoiseSummary& noise = judged.estimation.horizontal.noise;
    if (noise.stated_all_equal && noise.epochs > 1)
        say("They are equal at all epochs ({:.1f} mm), so better epochs cannot be told from worse "
            "ones.",
            noise.stated_sigma_m * 1e3);
}

/// Adds rules under which [GUM] and [GUM-S1] disagree, or [GUM-S1] did not converge.
void add_propagation(const ReceiverFindings& judged, Sentences& say) {
    for (const ProfileWindows& windows : judged.windows.profiles) {
        if (!windows.best || !windows.best->monte_carlo) continue;
        const MonteCarloCheck& check = *windows.best->monte_carlo;
        const LinearisationJudgement linear = judge_linearisation(*windows.best);
        if (!check.converged)
            say("The check of linearisation under {} did not converge in {} trials.",
                windows.profile, check.trials);
        else if (!linear.uncertainty_agrees)
            say("Under {} the check of linearisation gives a standard uncertainty of {:.4f} m/s "
                "where the law of propagation gives {:.4f} m/s.",
                windows.profile, check.standard_uncertainty_m_s,
                windows.best->standard_uncertainty_m_s);
        else if (!linear.interval_agrees && !linear.interval_holds)
            say("Under {} the check of linearisation gives a 95 % coverage interval of {:.4f} m/s "
                "to {:.4f} m/s. The law of propagation gives {:.4f} m/s to {:.4f} m/s.",
                windows.profile, check.lower_m_s, check.upper_m_s, linear.lower_m_s,
                linear.upper_m_s);
    }
}

void add_recording(const RecordingFacts& facts, Sentences& say) {
    if (!facts.georeferenced)
        say("Not georeferenced: the coordinates are those of an engineering CRS, whose place, "
            "orientation and scale on the Earth are not stated.");
    if (!facts.vertical_measured) say("Heights were not measured: the estimate is in the plane.");
    if (!facts.first_epoch)
        say("The recording's time is relative: the run has no date in it.");
    else if (!utc_from_gps(*facts.first_epoch).leap_seconds_known)
        say("UTC is given with the leap seconds known to the program, whose table does not reach "
            "the date of the recording.");
}

void add_time(const TimeStampSummary& time, Sentences& say) {
    if (time.sessions > 1)
        say("The recording holds {} sessions, which were not joined.", time.sessions);
    if (time.moved > 0)
        say("The recording is not in the order of time: {} epochs were put in their place among "
            "those of later times that were recorded before them.",
            time.moved);
    if (time.left_out > 0)
        say("{} epochs were left out for their times, for which the others leave no place.",
            time.left_out);
    for (const TimeFault& fault : time.faults)
        if (fault.kind == TimeFaultKind::whole_second_shift)
            say("At epoch {} the clock jumped by {:+.0f} s while the craft went on: times before "
                "and after it are not of one scale.",
                fault.epoch, fault.size_s);
    constexpr double drift_worth_saying = 1e-4;
    if (std::abs(time.rate_deviation) > drift_worth_saying)
        say("The time stamps run {:+.1e} of their nominal rate: the clock that made them may not "
            "be the satellites'.",
            time.rate_deviation);
}

void add_velocity(const VelocityComparison& velocity, Sentences& say) {
    if (velocity.origin == VelocityOrigin::positions)
        return say(
            "The recorded velocities were computed from the positions: they witness nothing, and "
            "were not used.");
    if (const std::string others = other_moments_text(velocity); !others.empty())
        say("The recorded velocities are not of the moments of their positions: {}. That delay is "
            "longer than screen.velocity_delay_max_s; the velocities there were not used.",
            others);
    if (velocity.unfit)
        say("Of the recorded velocities: {}. They are no source of a speed, and confirm none.",
            unfit_text(velocity));
    if (velocity.compared == 0 && !velocity.unfit)
        say("The recorded velocities could not be compared with the positions.");
    if (velocity.compared == 0) return;
    if (is_another_speed(velocity)) say("{}", another_speed_text(velocity));
    say("The recorded velocities of {} epochs agree with the motion to {:.3f} m/s per axis, {}; {} "
        "epochs contradicted them and were left out.",
        velocity.compared, velocity.scale_m_s,
        velocity.delay_s
            ? fmt::format("a delay of {:.3f} s behind the positions taken off", *velocity.delay_s)
            : "their delay behind the positions not determined by the motion",
        velocity.rejected);
}

/// Tests for slow drifts other than those by positions, in words. Empty if there are none.
std::string slow_drift_tests(const ScreeningBasis& tests) {
    std::vector<std::string> names;
    if (tests.velocity && tests.velocity->compared > 0)
        names.push_back(fmt::format("recorded velocities, which agree to {:.3f} m/s per axis,",
                                    tests.velocity->scale_m_s));
    for (const DisplacementComparison& one : tests.displacements)
        if (!one.spreads.empty()) names.emplace_back(words_of(one.kind));
    return listed(names);
}

/// Adds the other receiver's finding on this one's positions.
void add_baseline(const BaselineComparison& baseline, Sentences& say) {
    if (baseline.compared == 0)
        return say(
            "The positions of receiver \"{}\" could not be compared with this one's: no epochs at "
            "the same time.",
            baseline.receiver);
    if (baseline.same_errors)
        say("The positions of receiver \"{}\" have the errors of this one's: one recording was "
            "made from the other. It is no second measurement, and was not heard.",
            baseline.receiver);
    constexpr double scatter_worth_saying_m = 0.2;
    say("Receiver \"{}\" was {:.3f} m away, with a standard deviation of {:.3f} m over {} epochs{}",
        baseline.receiver, baseline.length_m, baseline.sd_m, baseline.compared,
        baseline.sd_m > scatter_worth_saying_m
            ? ": more than receivers on one craft should show; their clocks or one of the two may "
              "be off."
            : ".");
}

/// Positions alone cannot distinguish a slow drift from motion. This states what else checks for
/// it.
void add_drift(const ReceiverFindings& judged, Sentences& say) {
    const std::string others = slow_drift_tests(judged.tests);
    for (const ProfileWindows& windows : judged.windows.profiles) {
        if (!windows.best) continue;
        for (const UndetectedError& error : windows.best->reliability)
            if (error.hypothesis == Hypothesis::ramp)
                say("Under {}, screening by positions alone finds a drift beside the window with a "
                    "probability of {:.0f} % only from {:.2f} m/s on. {}.",
                    windows.profile, 100.0 * windows.best->detection_power.value_or(0.0),
                    error.size,
                    others.empty()
                        ? "No velocities were recorded to check for slower ones: from the fix "
                          "type, the budget assumes no drift beyond its time-correlated error"
                        : fmt::format("The {} check for slower ones", others));
    }
}

/// The row of undetected errors makes the interval valid over all runs. For a run with the largest
/// such error it is a different question, which this answers.
void add_undetected(const CheckInput& input, Sentences& say) {
    for (const ProfileWindows& windows : input.judged.windows.profiles) {
        const auto profile = std::ranges::find(input.profiles, windows.profile, &Profile::id);
        if (!windows.best || profile == input.profiles.end()) continue;
        const CertifiableWindow& best = *windows.best;
        const auto row = std::ranges::find(best.budget, "d", &BudgetRow::symbol);
        if (row == best.budget.end() || !(row->contribution_m_s > 0.0)) continue;
        const double error_m_s = std::sqrt(3.0) * row->contribution_m_s;
        const double expanded_m_s =
            expanded_uncertainty_by_rule_m_s(best, profile->coverage_factor);
        const double other_m_s =
            std::sqrt(std::max(best.standard_uncertainty_m_s * best.standard_uncertainty_m_s -
                                   row->contribution_m_s * row->contribution_m_s,
                               1e-18));
        const double held = normal_cdf((expanded_m_s - error_m_s) / other_m_s) -
                            normal_cdf((-expanded_m_s - error_m_s) / other_m_s);
        say("Under {}, an undetected error changes the speed by at most {:.4f} m/s. The budget "
            "takes every size up to that as equally likely, so the coverage probability is an "
            "average over runs. In a run with the largest such error, the interval holds the true "
            "speed with a probability of {:.0f} %.",
            windows.profile, error_m_s, std::floor(100.0 * held));
    }
}

void add_screening(const ReceiverFindings& judged, Sentences& say) {
    const ScreeningBasis& tests = judged.tests;
    say("Every epoch was tested for outliers, bursts, steps, drifts, shifts of its time stamp and "
        "sudden changes of acceleration: {} tests, which together mark anything in a recording "
        "without an outlier with a probability of at most {:g}.",
        tests.tests, tests.family_false_alarm_rate);
    for (const ScreeningModel& model : tests.models)
        if (model.noise != NoiseBasis::fitted)
            say("The {} tests rest on the stated standard deviations times {:.2f}, not on noise "
                "estimated from the recording.",
                to_text(model.axes), model.measurement_scale);
    for (const FixTypeErrors& kind : tests.fix_types)
        if (kind.judgement == AccuracyJudgement::optimistic ||
            kind.judgement == AccuracyJudgement::pessimistic)
            say("The {} accuracies stated for {} solutions are {}: the errors that the epochs show "
                "against one another are {:.2f} times as large.",
                to_text(kind.axes), to_text(kind.fix), to_text(kind.judgement),
                std::sqrt(kind.variance_factor));
    add_time(tests.time, say);
    // Of the other receiver, the vector between the antennas has its own statement.
    for (const DisplacementComparison& one : tests.displacements)
        if (one.kind != WitnessKind::receiver || one.rejected != 0)
            say("{}.", displacement_comparison_text(one));
    if (tests.velocity) add_velocity(*tests.velocity, say);
    if (tests.baseline) add_baseline(*tests.baseline, say);
    add_drift(judged, say);
}

}  // namespace

bool is_another_speed(const VelocityComparison& velocity) {
    constexpr double worth_saying = 0.02;
    constexpr double times = 4.0;
    return velocity.ratio && std::abs(*velocity.ratio - 1.0) >
                                 worth_saying + times * velocity.sigma_ratio.value_or(0.0);
}

std::string another_speed_text(const VelocityComparison& velocity) {
    return fmt::format(
        "The recorded velocities are {:.3f} times what the positions show, where the craft moves "
        "fast: one of the two is wrong.",
        velocity.ratio.value_or(1.0));
}

std::vector<std::string> statements_of(const CheckInput& input) {
    const ReceiverFindings& judged = input.judged;
    Sentences say;
    say("The uncertainty is the combination of the sources in the budget, one row each. "
        "Time-correlated position errors are covered up to the size and for the correlation times "
        "that the budget names. An undetected outlier, step or shift of time stamps is covered "
        "too.");
    add_reading(judged, say);
    add_screening(judged, say);
    add_undetected(input, say);
    for (const std::string& note : judged.windows.witness_notes)
        say("{}", note);
    for (const MeasuredSeries* const series : {input.wind, input.current})
        if (series != nullptr && !series->left_out.empty()) say("{}", series->left_out);
    const EstimationSummary& estimation = judged.estimation;
    if (estimation.arcs > 0) add_axes(estimation.horizontal, "horizontal", say);
    if (estimation.vertical && estimation.arcs > 0) add_axes(*estimation.vertical, "vertical", say);
    add_propagation(judged, say);
    add_recording(judged.facts, say);
    return say.said;
}

}  // namespace runcert

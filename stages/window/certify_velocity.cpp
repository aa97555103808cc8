#include "stages/window/certify_velocity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "core/statistics.h"
#include "core/uncertainty.h"
#include "stages/window/budget.h"
#include "stages/window/sample_series.h"
#include "stages/window/selection.h"
#include "stages/window/velocity_moment.h"
#include "stages/window/velocity_selection.h"
#include "witness/copies.h"

namespace runcert {
namespace {

/// Number of samples' errors that are averaged in a window.
double samples_of(const FoundWindow& found) {
    return static_cast<double>(found.last - found.first);
}

/// The mean of the standard deviations stated for a window's speeds, as for one error if all err
/// alike, and who states them.
StatedSpeedAccuracy stated_accuracy(const VelocityEstimate& estimate, const Profile& profile,
                                    const FoundWindow& found) {
    StatedSpeedAccuracy stated{.claimed = estimate.config.velocity_accuracy_claimed};
    if (const auto& velocity = estimate.screened.basis.velocity)
        stated.scatter_m_s = velocity->scale_m_s;
    std::vector<double> sigmas;
    for (std::size_t k = found.first; k <= found.last; ++k) {
        const ScreenedEpoch& row = estimate.screened.rows[estimate.rows[found.series].rows[k]];
        const auto speed = recorded_speed(row, profile.dimension);
        if (!speed || !speed->standard_uncertainty_m_s)
            throw Failure(fmt::format("epoch {}", row.epoch),
                          "the recording does not state how accurate its velocity is",
                          "Use a profile whose speed is from positions");
        sigmas.push_back(*speed->standard_uncertainty_m_s);
    }
    constexpr double much_worse = 3.0;
    const double usual_m_s = median(sigmas);
    stated.sigma_m_s = mean(sigmas);
    for (const double sigma : sigmas)
        if (sigma > much_worse * usual_m_s)
            stated.of_worse_m_s = std::hypot(stated.of_worse_m_s, sigma / samples_of(found));
    return stated;
}

SpeedNoise noise_of(const VelocityEstimate& estimate, Dimension dimension,
                    const FoundWindow& found) {
    return speed_noise(estimate.compared, estimate.screened, dimension, found.start.seconds(),
                       found.duration_s(), samples_of(found));
}

/// The window by its positions as a witness, so that no velocities are certified that the positions
/// do not confirm. The uncertainty assumed for the velocities is at most what receivers of all
/// types have been seen to err by.
WitnessedSpeed by_positions(const SpeedEstimate& track, double speed_m_s, double duration_s,
                            double error_m_s) {
    constexpr double largest_of_velocities_m_s = 0.5;
    WitnessedSpeed witnessed;
    witnessed.kind = WitnessKind::positions;
    witnessed.origin = origin_of(witnessed.kind).front();
    witnessed.speed_m_s = track.speed_m_s;
    witnessed.standard_uncertainty_m_s = track.standard_uncertainty_m_s;
    witnessed.position_standard_uncertainty_m_s = std::min(error_m_s, largest_of_velocities_m_s);
    witnessed.difference_m_s = speed_m_s - witnessed.speed_m_s;
    witnessed.normalised_error = std::abs(witnessed.difference_m_s) /
                                 (2.0 * std::hypot(witnessed.standard_uncertainty_m_s,
                                                   witnessed.position_standard_uncertainty_m_s));
    witnessed.apart_m = std::abs(witnessed.difference_m_s) * duration_s;
    return witnessed;
}

/// What a window's speed differs by from its positions beyond twice what is usual in the recording:
/// an error of this window that no other has to share.
double beyond_usual_m_s(const SpeedNoise& noise, double difference_m_s) {
    const auto& usual = noise.over_window ? noise.over_window : noise.over_ten;
    if (!usual || noise.in_common) return 0.0;
    return std::sqrt(std::max(0.0, std::pow(difference_m_s, 2) - std::pow(2.0 * usual->sd_m_s, 2)));
}

std::string slow_note(const SpeedErrors& errors, const SpeedNoise& noise,
                      const StatedSpeedAccuracy& stated) {
    const auto shown = [&] {
        return fmt::format(
            "over 10 s mean speeds and positions differ by {:.3f} m/s (root mean square of {:.0f} "
            "spans)",
            noise.over_ten->sd_m_s, noise.over_ten->independent);
    };
    const std::string said = fmt::format(
        "{} states {:.3f} m/s", stated.claimed ? "the attempt" : "the recording", stated.sigma_m_s);
    switch (errors.slow) {
        case SlowError::floor:
            return fmt::format("{}; never less than {:g} m/s", shown(), least_slow_error_m_s);
        case SlowError::shown:
            return shown();
        case SlowError::stated:
            break;
    }
    if (noise.in_common)
        return said + ", which counts whole: the positions are not independent of the velocities";
    if (!noise.white || !noise.over_ten)
        return said + ", which counts whole: too little of the recording can be compared";
    return noise.over_ten ? said + "; " + shown() : said;
}

/// Adds the rows of the recorded speeds' own errors to a window that has its witness.
void add_error_rows(const SpeedErrors& errors, const SpeedNoise& noise,
                    const StatedSpeedAccuracy& stated, const FoundWindow& found,
                    CertifiableWindow& window) {
    std::vector<BudgetRow>& rows = window.budget;
    BudgetRow white = speed_row(
        "w", "white noise of the recorded speeds", "A", errors.mean_white_m_s, RowScope::source,
        fmt::format("{:.3f} m/s of one speed, by steps of their difference from the smoothed "
                    "motion; {}",
                    errors.white_m_s,
                    stated.claimed && errors.white_m_s > stated.sigma_m_s
                        ? std::string("not averaged, because the attempt states less")
                        : fmt::format("{:.0f} of them are averaged", samples_of(found))));
    if (noise.white) white.degrees_of_freedom = noise.white->independent;
    rows.push_back(std::move(white));
    BudgetRow brief = speed_row(
        "b", "errors of the recorded speeds shorter than 10 s", "A", errors.brief_m_s,
        RowScope::source,
        noise.over_window
            ? fmt::format(
                  "over the length of the window mean speeds and positions differ by "
                  "{:.3f} m/s (root mean square of {:.0f} spans); beyond the other two rows",
                  noise.over_window->sd_m_s, noise.over_window->independent)
            : std::string("of a window this long they are part of the next row"));
    if (const double apart_m_s = window.witnesses.front().difference_m_s;
        beyond_usual_m_s(noise, apart_m_s) > 0.0)
        brief.note += fmt::format(
            "; in this window they differ by {:+.3f} m/s, which counts beyond "
            "twice what is usual",
            apart_m_s);
    if (noise.over_window) brief.degrees_of_freedom = noise.over_window->independent;
    rows.push_back(std::move(brief));
    const bool shown = errors.slow == SlowError::shown;
    BudgetRow slow =
        speed_row("u", "lasting errors of the recorded speeds", shown ? "A" : "B", errors.slow_m_s,
                  RowScope::source,
                  "taken as one error throughout the window; " + slow_note(errors, noise, stated));
    if (shown) slow.degrees_of_freedom = noise.over_ten->independent;
    rows.push_back(std::move(slow));
}

/// Row p: what all recorded speeds have in common. The estimate is taken off.
BudgetRow scale_row(const std::optional<SpeedScale>& found, double speed_m_s) {
    const SpeedScale scale = found.value_or(SpeedScale{});
    BudgetRow row = speed_row(
        "p", "scale of the recorded speeds", "A", scale.uncertainty * speed_m_s, RowScope::source,
        found
            ? fmt::format("beside the positions, over straight fast spans of 10 s, they are "
                          "{:+.3f} % too high, with a standard uncertainty of {:.3f} %; weighed "
                          "against what receivers are off by, {:+.3f} % are taken off",
                          100.0 * scale.shown, 100.0 * scale.shown_uncertainty, 100.0 * scale.value)
            : std::string("the positions tell nothing of it: it is part of the stated value, "
                          "which counts whole"));
    row.estimate = scale.value;
    row.unit = "1";
    row.standard_uncertainty = scale.uncertainty;
    row.sensitivity = -speed_m_s;
    return row;
}

/// Row d: the largest error of the mean that the tests of the recorded speeds leave with the power
/// stated for them, in a burst of any length that they look for; at most what the positions of the
/// window leave. One window in 200 is taken to have one, which is judgement.
BudgetRow undetected_row(const ScreenedTable& screened, const Profile& profile, double samples,
                         SlowError slow, const WitnessedSpeed& positions) {
    constexpr double burst_probability = 1.0 / 200.0;
    const TestedAxes axes =
        profile.dimension == Dimension::vertical ? TestedAxes::vertical : TestedAxes::horizontal;
    const auto& all = screened.basis.speeds;
    const auto tested = std::ranges::find(all, axes, &SpeedScreening::axes);
    double largest_m_s = 0.0;
    if (tested != all.end() && slow != SlowError::stated)
        for (const DetectableSpeed& one : tested->detectable)
            largest_m_s =
                std::max(largest_m_s,
                         one.size_m_s * std::min(1.0, static_cast<double>(one.samples) / samples));
    largest_m_s = std::min(largest_m_s, largest_error_beside(positions));
    return speed_row(
        "d", "undetected error of single samples", "B",
        std::sqrt(burst_probability) * rectangular_uncertainty(largest_m_s), RowScope::fault,
        slow == SlowError::stated
            ? std::string("part of the stated value of one sample, which counts whole for the mean")
        : tested == all.end()
            ? std::string("not quantified: too few speeds were recorded to test them")
            : fmt::format("up to {:.2f} m/s of the mean: what the tests of the speeds against one "
                          "another leave with a probability of {:.0f} % or more, or the positions "
                          "of the window; taken to happen in one window of {:.0f}, as mean square",
                          largest_m_s, 100.0 * (1.0 - screened.basis.power),
                          1.0 / burst_probability));
}

double resolution_m_s(const std::vector<ComparedSpeed>& compared) {
    std::vector<TimedValue> speeds;
    for (const ComparedSpeed& one : compared)
        speeds.push_back({one.time_s, one.recorded_m_s});
    return resolution_m_s(speeds);
}

/// Adds the rows of time and rounding. If a window begins slightly later, the mean of recorded
/// speeds changes by the difference of the speeds at both ends. This matters only where positions
/// determine where it begins.
void add_other_rows(const VelocityEstimate& estimate, const Profile& profile,
                    const FoundWindow& found, std::vector<BudgetRow>& rows) {
    const ArcRows& arc = estimate.rows[found.series];
    const PositionNoise speed{.speed = {.speed_m_s = found.speed_m_s}};
    const ErrorBound none;
    const SelectionBias no_selection;
    const BudgetInput input{
        .trajectory = estimate.trajectory,
        .config = estimate.config,
        .noise = speed,
        .bound = none,
        .selection = no_selection,
        .first_row = arc.rows[found.first],
        .last_row = arc.rows[found.last],
        .duration_s = found.duration_s(),
        .mean_interval_s = estimate.screened.basis.time.interval_s.value_or(0.0)};
    const bool by_places = profile.window_kind == WindowKind::alpha;
    const auto recorded = [&](std::size_t k) {
        return recorded_speed(estimate.screened.rows[arc.rows[k]], profile.dimension)->speed_m_s;
    };
    const double changes_m_s2 =
        by_places ? (recorded(found.last) - recorded(found.first)) / found.duration_s() : 0.0;
    BudgetRow stamps = time_row(input);
    stamps.sensitivity = changes_m_s2;
    stamps.contribution_m_s = stamps.standard_uncertainty * std::abs(changes_m_s2);
    rows.push_back(std::move(stamps));
    BudgetRow delay =
        speed_row("l", "delay of the recorded speeds behind the positions", "B",
                  sigma_of_delay(estimate.screened), RowScope::source,
                  by_places ? "it moves both ends of the window"
                            : "the window is of the moments of the speeds, whichever "
                              "they are: only a window whose ends are places changes");
    delay.estimate = delay_of_velocities(estimate.screened);
    delay.unit = "s";
    delay.sensitivity = changes_m_s2;
    delay.contribution_m_s = delay.standard_uncertainty * std::abs(changes_m_s2);
    rows.push_back(std::move(delay));
    rows.push_back(clock_row(input));
    const double step_m_s = resolution_m_s(estimate.compared);
    rows.push_back(bounded_row("r", "resolution of the recorded speeds", 0.5 * step_m_s, "m / s",
                               1.0, RowScope::source,
                               fmt::format("speeds in steps of {:.2g} m/s", step_m_s)));
    if (auto calibration = calibration_row(estimate.config))
        rows.push_back(*std::move(calibration));
}

/// Subtracts the bias of the choice from the speed, and adds its row.
void set_choice(const VelocityEstimate& estimate, const Profile& profile, const FoundWindow& found,
                const std::vector<FoundWindow>& all, const SpeedErrors& errors,
                CertifiableWindow& window) {
    std::vector<std::vector<ElapsedTime>> times;
    for (const ArcRows& arc : estimate.rows) {
        std::vector<ElapsedTime>& of_arc = times.emplace_back();
        for (const std::size_t row : arc.rows)
            of_arc.push_back(estimate.trajectory.rows[row].time);
    }
    const SelectionBias bias = speed_choice_bias(
        times, legs_of(all, found, found.assured_m_s() - selection_width * errors.combined()),
        profile.definition,
        {.white_m_s = errors.white_m_s, .brief_m_s = errors.brief_m_s, .slow_m_s = errors.slow_m_s},
        estimate.config.selection_samples, estimate.config.seed);
    const bool subtracted = profile.uncertainty.selection_bias == SelectionTreatment::subtracted;
    // A range wider than the speed is uncertain tells nothing of where in it the bias is: what is
    // certain is taken off, and the rest is allowed for.
    const bool middle = bias.bias_half_range_m_s <= errors.combined();
    const double taken_off_m_s = middle ? bias.bias_m_s : bias.fitted_bias_m_s;
    window.bias_limit_m_s = bias.bounded_bias_m_s - (subtracted ? taken_off_m_s : 0.0);
    if (subtracted) window.speed_m_s = less_bias(window.speed_m_s, taken_off_m_s);
    window.budget.push_back(
        choice_row(fmt::format("{:.4f} m/s, by white noise alone, and {:.4f} m/s, by all errors "
                               "that differ between windows;",
                               bias.fitted_bias_m_s, bias.bounded_bias_m_s),
                   bias.bias_uncertainty_m_s, bias.candidates,
                   subtracted ? std::optional(taken_off_m_s) : std::nullopt, middle));
}

}  // namespace

bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found) {
    for (std::size_t k = found.first; k <= found.last; ++k) {
        const auto speed = recorded_speed(screened.rows[arc.rows[k]], profile.dimension);
        if (!speed || !speed->standard_uncertainty_m_s) return false;
    }
    return true;
}

CertifiableWindow certified_by_velocity(const VelocityEstimate& estimate, const Profile& profile,
                                        const FoundWindow& found,
                                        const std::vector<FoundWindow>& all,
                                        CertificateExtent extent) {
    const TrajectoryTable& trajectory = estimate.trajectory;
    const ArcRows& arc = estimate.rows[found.series];
    CertifiableWindow window;
    const TrajectoryEpoch& first = trajectory.rows[arc.rows[found.first]];
    const TrajectoryEpoch& last = trajectory.rows[arc.rows[found.last]];
    window.span = window_span(trajectory.facts, first.epoch, last.epoch, found.start, found.end);
    window.arc = arc.number;
    window.speed_m_s = found.speed_m_s;
    window.length_m = found.length_m;
    window.definitions = definitions_of(SmoothedTrack(trajectory, arc, profile.dimension),
                                        {found.first, found.last}, found.duration_s());
    window.displacement_m =
        std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
    window.position_r95_m = 2.45 * std::max({*first.sigma_east_m, *first.sigma_north_m,
                                             *last.sigma_east_m, *last.sigma_north_m});

    const StatedSpeedAccuracy stated = stated_accuracy(estimate, profile, found);
    const SpeedNoise noise = noise_of(estimate, profile.dimension, found);
    SpeedErrors errors = speed_errors(noise, stated, found.duration_s(), samples_of(found));
    if (noise.scale) window.speed_m_s *= 1.0 - noise.scale->value;
    window.witnesses.push_back(
        by_positions(track_speed(estimate.screened, trajectory, arc, profile, found),
                     window.speed_m_s, found.duration_s(), errors.combined()));
    errors.brief_m_s = std::hypot(errors.brief_m_s,
                                  beyond_usual_m_s(noise, window.witnesses.front().difference_m_s));
    add_error_rows(errors, noise, stated, found, window);
    window.budget.push_back(scale_row(noise.scale, found.speed_m_s));
    add_other_rows(estimate, profile, found, window.budget);
    window.budget.push_back(undetected_row(estimate.screened, profile, samples_of(found),
                                           errors.slow, window.witnesses.front()));
    if (extent == CertificateExtent::whole)
        set_choice(estimate, profile, found, all, errors, window);
    const CombinedUncertainty combined = combine(window.budget);
    window.standard_uncertainty_m_s = combined.standard_uncertainty;
    window.effective_degrees_of_freedom = combined.effective_degrees_of_freedom;
    return window;
}

}  // namespace runcert

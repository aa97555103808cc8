#include "stages/window/certify_velocity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

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

/// The compared speeds of a window, which holds no epoch that is left out.
std::span<const ComparedSpeed> compared_in(const VelocityEstimate& estimate,
                                           const FoundWindow& found) {
    const auto time_s = [&](std::size_t k) { return estimate.times[found.series][k].seconds(); };
    const auto first = std::ranges::lower_bound(estimate.compared, time_s(found.first), {},
                                                &ComparedSpeed::time_s);
    const auto past =
        std::ranges::upper_bound(estimate.compared, time_s(found.last), {}, &ComparedSpeed::time_s);
    assert(past - first == static_cast<std::ptrdiff_t>(found.last - found.first + 1));
    return {first, past};
}

/// The mean of the standard deviations stated for a window's speeds, as for one error if all err
/// alike, and who states them.
StatedSpeedAccuracy stated_accuracy(const VelocityEstimate& estimate,
                                    std::span<const ComparedSpeed> window) {
    StatedSpeedAccuracy stated{.claimed = estimate.config.velocity_accuracy_claimed};
    if (const auto& velocity = estimate.screened.basis.velocity)
        stated.scatter_m_s = velocity->scale_m_s;
    std::vector<double> sigmas;
    for (const ComparedSpeed& one : window)
        sigmas.push_back(one.stated_m_s.value());
    constexpr double much_worse = 3.0;
    const double usual_m_s = median(sigmas);
    stated.sigma_m_s = mean(sigmas);
    for (const double sigma : sigmas)
        if (sigma > much_worse * usual_m_s)
            stated.of_worse_m_s =
                std::hypot(stated.of_worse_m_s, sigma / static_cast<double>(window.size() - 1));
    return stated;
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
    return said + "; " + shown();
}

/// The rows of the recorded speeds' own errors, but for their scale. `apart_m_s` is how far this
/// window is from its positions.
std::vector<BudgetRow> error_rows(const SpeedErrors& errors, const SpeedNoise& noise,
                                  const StatedSpeedAccuracy& stated, const FoundWindow& found,
                                  double apart_m_s) {
    std::vector<BudgetRow> rows;
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
    if (beyond_usual_m_s(noise, apart_m_s) > 0.0)
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
    return rows;
}

/// Row p: what all recorded speeds have in common. The estimate is taken off.
BudgetRow scale_row(const std::optional<SpeedScale>& found, double speed_m_s) {
    const SpeedScale scale = found.value_or(SpeedScale{});
    BudgetRow row = quantity_row(
        "p", "scale of the recorded speeds", "A", scale.uncertainty, "1", -speed_m_s,
        RowScope::source,
        found
            ? fmt::format("beside the positions, over straight fast spans of 10 s, they are "
                          "{:+.3f} % too high, with a standard uncertainty of {:.3f} %; weighed "
                          "against what receivers are off by, {:+.3f} % are taken off",
                          100.0 * scale.shown, 100.0 * scale.shown_uncertainty, 100.0 * scale.value)
            : std::string("the positions tell nothing of it: it is part of the stated value, "
                          "which counts whole"));
    row.estimate = scale.value;
    return row;
}

/// The largest error of the mean (m/s) that the tests of the recorded speeds leave with the power
/// stated for them, in a burst of any length that they look for; at most what the positions of the
/// window leave. Empty where the speeds were not tested.
std::optional<double> largest_undetected(const ScreenedTable& screened, Dimension dimension,
                                         double samples, const WitnessedSpeed& positions) {
    const TestedAxes axes =
        dimension == Dimension::vertical ? TestedAxes::vertical : TestedAxes::horizontal;
    const auto& all = screened.basis.speeds;
    const auto tested = std::ranges::find(all, axes, &SpeedScreening::axes);
    if (tested == all.end()) return std::nullopt;
    double largest_m_s = 0.0;
    for (const DetectableSpeed& one : tested->detectable)
        largest_m_s = std::max(
            largest_m_s, one.size_m_s * std::min(1.0, static_cast<double>(one.samples) / samples));
    return std::min(largest_m_s, largest_error_given(positions));
}

SelectionBias selection_of(const VelocityEstimate& estimate, const WindowChoice& choice,
                           const SpeedErrors& errors) {
    const double least_m_s = choice.found.assured_m_s() - selection_width * errors.combined();
    SelectionBias selection;
    if (choice.extent == CertificateExtent::whole)
        selection = speed_choice_bias(estimate.times, legs_of(choice.all, choice.found, least_m_s),
                                      choice.profile.definition,
                                      {.white_m_s = errors.white_m_s,
                                       .brief_m_s = errors.brief_m_s,
                                       .slow_m_s = errors.slow_m_s,
                                       .combined_m_s = errors.combined()},
                                      estimate.config.selection_samples, estimate.config.seed);
    selection.treatment = choice.profile.uncertainty.selection_bias;
    return selection;
}

/// One window in 200 is taken to have an undetected error, which is judgement.
constexpr double undetected_probability = 1.0 / 200.0;

std::string undetected_text(SlowError slow, const std::optional<double>& largest_m_s,
                            double power) {
    if (slow == SlowError::stated)
        return "part of the stated value of one sample, which counts whole for the mean";
    if (!largest_m_s) return "not quantified: too few speeds were recorded to test them";
    return fmt::format(
        "up to {:.2f} m/s of the mean: what the tests of the speeds against one another leave with "
        "a probability of {:.0f} % or more, or the positions of the window; taken to happen in one "
        "window of {:.0f}, as mean square",
        *largest_m_s, 100.0 * (1.0 - power), 1.0 / undetected_probability);
}

/// What the budget takes from the recorded speeds, with the rows of their errors.
RecordedSource source_of(const VelocityEstimate& estimate, const WindowChoice& choice,
                         std::span<const ComparedSpeed> window, std::vector<BudgetRow> rows) {
    std::vector<TimedValue> speeds;
    for (const ComparedSpeed& one : estimate.compared)
        speeds.push_back({one.time_s, one.recorded_m_s});
    RecordedSource source{.rows = std::move(rows),
                          .resolution_m_s = resolution_m_s(speeds),
                          .delay_s = delay_of_velocities(estimate.screened),
                          .sigma_delay_s = sigma_of_delay(estimate.screened),
                          .undetected = {}};
    if (choice.profile.window_kind == WindowKind::alpha)
        source.changes_m_s2 =
            (window.back().recorded_m_s - window.front().recorded_m_s) / choice.found.duration_s();
    return source;
}

/// The window with what its positions tell beside the speed.
CertifiableWindow described(const VelocityEstimate& estimate, const WindowChoice& choice) {
    const FoundWindow& found = choice.found;
    const ArcRows& arc = estimate.rows[found.series];
    CertifiableWindow window = window_at(estimate.trajectory, arc, found);
    const TrajectoryEpoch& first = estimate.trajectory.rows[arc.rows[found.first]];
    const TrajectoryEpoch& last = estimate.trajectory.rows[arc.rows[found.last]];
    window.length_m = found.length_m;
    window.definitions =
        definitions_of(SmoothedTrack(estimate.trajectory, arc, choice.profile.dimension),
                       {found.first, found.last}, found.duration_s());
    window.displacement_m =
        std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
    window.position_r95_m = 2.45 * std::max({*first.sigma_east_m, *first.sigma_north_m,
                                             *last.sigma_east_m, *last.sigma_north_m});
    return window;
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

CertifiableWindow certify_by_velocities(const VelocityEstimate& estimate,
                                        const WindowChoice& choice) {
    const FoundWindow& found = choice.found;
    const TrajectoryTable& trajectory = estimate.trajectory;
    const ArcRows& arc = estimate.rows[found.series];
    const Dimension dimension = choice.profile.dimension;
    CertifiableWindow window = described(estimate, choice);
    const std::span<const ComparedSpeed> compared = compared_in(estimate, found);
    const StatedSpeedAccuracy stated = stated_accuracy(estimate, compared);
    const SpeedNoise noise =
        speed_noise(estimate.compared, estimate.screened, dimension, found.start.seconds(),
                    found.duration_s(), samples_of(found));
    SpeedErrors errors = speed_errors(noise, stated, found.duration_s(), samples_of(found));
    const double measured_m_s =
        noise.scale ? found.speed_m_s * (1.0 - noise.scale->value) : found.speed_m_s;
    const WitnessedSpeed positions = by_positions(
        track_speed(estimate.screened, trajectory, arc, choice.profile, found, compared),
        measured_m_s, found.duration_s(), errors.combined());
    window.witnesses.push_back(positions);
    errors.brief_m_s =
        std::hypot(errors.brief_m_s, beyond_usual_m_s(noise, positions.difference_m_s));

    std::vector<BudgetRow> rows =
        error_rows(errors, noise, stated, found, positions.difference_m_s);
    rows.push_back(scale_row(noise.scale, found.speed_m_s));
    RecordedSource source = source_of(estimate, choice, compared, std::move(rows));
    const auto largest_m_s =
        errors.slow == SlowError::stated
            ? std::nullopt
            : largest_undetected(estimate.screened, dimension, samples_of(found), positions);
    source.undetected = undetected_text(errors.slow, largest_m_s, estimate.screened.basis.power);
    const SelectionBias selection = selection_of(estimate, choice, errors);
    const PositionSpeed speed{.speed = {.speed_m_s = found.speed_m_s}};
    const ErrorBound no_bound;
    const BudgetInput input{
        .trajectory = trajectory,
        .config = estimate.config,
        .measured = speed,
        .bound = no_bound,
        .selection = selection,
        .first_row = arc.rows[found.first],
        .last_row = arc.rows[found.last],
        .duration_s = found.duration_s(),
        .mean_interval_s = estimate.screened.basis.time.interval_s.value_or(0.0),
        .fault = {.prior = {.probability = undetected_probability,
                            .largest_m_s = largest_m_s.value_or(0.0)}},
        .recorded = std::move(source)};
    window.budget = budget_of(input);
    set_speed(measured_m_s, selection, selection.bias_m_s, 1.0, window);
    set_uncertainty(window);
    return window;
}

}  // namespace runcert

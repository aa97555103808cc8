#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/figures.h"
#include "core/speed_unit.h"
#include "core/statistics.h"
#include "core/text.h"
#include "stages/check/requirements.h"

// What a rule limits by a figure: of course and craft, of wind and current, and of every sample of
// its windows.

namespace runcert {
namespace {

/// The size of a figure of the course.
Quantity of_course(std::string name, const CourseFigure& figure) {
    return {.name = std::move(name),
            .value = std::abs(figure.value),
            .expanded_uncertainty = figure.expanded_uncertainty};
}

/// A surface that heights of the recording contradict does not decide by itself: the ground may
/// have been where they were.
std::optional<Finding> doubt_of_surface(const ReceiverFindings& judged) {
    const auto& surface = judged.tests.surface;
    if (!surface || surface->rejected == 0) return std::nullopt;
    return to_attest(
        "; {} of {} heights of the recording contradict the surface and were left out, so that "
        "the heights of the ground are to be attested",
        surface->rejected, surface->compared);
}

/// Heights that do not scatter as stated are typed, smoothed or of a formula. What follows from
/// them was not measured.
std::optional<Finding> doubt_of_heights(const ReceiverFindings& judged) {
    constexpr double too_smooth = 0.3;
    const auto& models = judged.tests.models;
    const auto model = std::ranges::find(models, TestedAxes::vertical, &ScreeningModel::axes);
    if (model == models.end() ||
        (model->noise == NoiseBasis::fitted && model->white_scale >= too_smooth))
        return std::nullopt;
    return to_attest(
        "; but the heights were not shown to scatter as stated (noise: {}, {:.2g} times as stated)",
        to_text(model->noise), model->white_scale);
}

/// A figure of heights: of the ground by the surface that was handed in, with the track's beside
/// it, else of the track.
struct HeightFigure {
    const char* of_ground;
    CourseFigure GroundFacts::*by_surface;
    const char* of_track;
    std::optional<CourseFigure> CourseFacts::*by_track;
    const char* missing;  ///< why the track has none
};

Finding of_heights(const HeightFigure& figure, const Clause& clause, const ClauseContext& context) {
    const CourseFindings& course = context.course;
    if (!course.facts) return unknown("{}", course.missing);
    const std::optional<CourseFigure>& track = *course.facts.*figure.by_track;
    if (!course.ground && !track) return unknown("{}", figure.missing);
    Quantity quantity = course.ground
                            ? of_course(figure.of_ground, *course.ground.*figure.by_surface)
                            : of_course(figure.of_track, *track);
    if (course.ground && track)
        quantity.note =
            fmt::format("{} {} by the heights of the track",
                        format_fixed(std::abs(in_unit(track->value, clause.unit)), 2), clause.unit);
    quantity.if_met = course.ground ? doubt_of_surface(context.input.judged)
                                    : doubt_of_heights(context.input.judged);
    return against_limit(quantity, clause);
}

/// Whether the recording shows the craft at its slowest before the run. If the craft was always
/// faster, by more than the uncertainty, after the first available second, it may have been slower
/// before.
bool start_was_seen(const CraftRun& run, const CourseFigure& slowest,
                    const ClauseContext& context) {
    constexpr double beginning_s = 1.0;
    const auto& rows = context.input.judged.trajectory;
    const std::size_t from = run.stood_from_row.value_or(run.first_row);
    for (std::size_t i = 0; i < from; ++i)
        if (rows[i].arc) return true;
    const double least_m_s = slowest.value + slowest.expanded_uncertainty.value_or(0.0);
    for (std::size_t i = from; i <= run.first_row; ++i)
        if (rows[i].arc && rows[i].time.seconds() - rows[from].time.seconds() > beginning_s &&
            std::hypot(*rows[i].velocity_east_m_s, *rows[i].velocity_north_m_s) <= least_m_s)
            return true;
    return false;
}

/// The mean or the strongest of a flow in the window, by the attempt's series. Where its
/// uncertainty is not stated, the number of samples is said beside it.
Finding of_flow(const char* what, const std::optional<FlowInWindow>& flow,
                double FlowInWindow::*speed_m_s, std::optional<double> expanded_uncertainty_m_s,
                const Clause& clause) {
    if (!flow) return unknown("the attempt gives no series of the {}", what);
    if (!flow->missing.empty()) return not_met("{}", flow->missing);
    return against_limit(
        {.name = fmt::format("{} {} in the window",
                             speed_m_s == &FlowInWindow::mean_m_s ? "mean" : "strongest", what),
         .value = *flow.*speed_m_s,
         .expanded_uncertainty = expanded_uncertainty_m_s,
         .note = expanded_uncertainty_m_s ? ""
                                          : fmt::format("{} {} in the window", flow->samples,
                                                        flow->samples == 1 ? "sample" : "samples")},
        clause);
}

/// Standard uncertainty of the recorded velocity, all axes together. NaN if not stated.
double velocity_accuracy(const ScreenedEpoch& row) {
    double sum = 0.0;
    for (const OptionalReal& sigma :
         {row.sigma_recorded_velocity_east_m_s, row.sigma_recorded_velocity_north_m_s,
          row.sigma_recorded_velocity_up_m_s})
        sum += sigma ? *sigma * *sigma : std::nan("");
    return std::sqrt(sum);
}

/// Stated standard uncertainty of the height, or of both horizontal coordinates together.
double position_accuracy(const ScreenedEpoch& row, bool vertical) {
    const auto stated = [](const auto& sigma) { return sigma ? *sigma : std::nan(""); };
    return vertical ? stated(row.sigma_up_m)
                    : std::hypot(stated(row.sigma_east_m), stated(row.sigma_north_m));
}

/// The recorded horizontal speed; NaN if the recording has none.
double recorded_speed_m_s(const ScreenedEpoch& row) {
    if (row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s)
        return std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s);
    return row.recorded_speed_m_s ? *row.recorded_speed_m_s : std::nan("");
}

/// The stated standard deviation of the recorded horizontal speed; infinite where none is stated.
double stated_sigma_m_s(const ScreenedEpoch& row) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (!row.recorded_velocity_east_m_s) return row.sigma_recorded_speed_m_s.value_or(none);
    return std::max(row.sigma_recorded_velocity_east_m_s.value_or(none),
                    row.sigma_recorded_velocity_north_m_s.value_or(none));
}

constexpr const char* no_speed_recorded = "an epoch of the window has no recorded speed";

using Samples = std::vector<std::vector<ScreenedEpoch>>;

bool has_window(const Samples& windows) {
    return windows.front().size() >= 2;
}

/// The samples after the first of each window, whose speeds make its distance: all of it, and what
/// was made below a speed.
struct Distances {
    double all = 0.0;
    double slow = 0.0;
    double least_m_s = std::numeric_limits<double>::infinity();
};

Distances distances_of(const Samples& windows, double limit_m_s) {
    Distances found;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (std::size_t i = 0; i < window.size(); ++i) {
            const double speed_m_s = recorded_speed_m_s(window[i]);
            found.least_m_s = std::min(found.least_m_s, speed_m_s);
            if (std::isnan(speed_m_s)) found.least_m_s = speed_m_s;
            if (std::isnan(found.least_m_s)) return found;
            if (i == 0) continue;
            const double length_m =
                speed_m_s * (window[i].time.seconds() - window[i - 1].time.seconds());
            found.all += length_m;
            if (speed_m_s < limit_m_s) found.slow += length_m;
        }
    return found;
}

/// The largest change of the recorded speed between samples: one that is surely too large, if any.
struct Change {
    bool surely = false;  ///< beyond what is possible by more than chance
    double found_m_s2 = 0.0;
    double by_chance_m_s2 = 0.0;
    std::int64_t epoch = 0;
};

Change largest_change(const Samples& windows, double possible_m_s2) {
    std::size_t samples = 0;
    for (const std::vector<ScreenedEpoch>& window : windows)
        samples += window.size();
    // All changes together exceed that by chance once in a thousand times.
    const double by_chance = -normal_quantile(0.0005 / static_cast<double>(samples));
    Change largest;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (std::size_t i = 1; i < window.size(); ++i) {
            const ScreenedEpoch &before = window[i - 1], &after = window[i];
            const double time_s = after.time.seconds() - before.time.seconds();
            Change change{
                .found_m_s2 =
                    std::abs(recorded_speed_m_s(after) - recorded_speed_m_s(before)) / time_s,
                .by_chance_m_s2 = by_chance *
                                  std::hypot(stated_sigma_m_s(before), stated_sigma_m_s(after)) /
                                  time_s,
                .epoch = after.epoch};
            if (std::isnan(change.found_m_s2)) return change;
            change.surely = change.found_m_s2 - change.by_chance_m_s2 > possible_m_s2;
            if (std::pair(change.surely, change.found_m_s2) >
                std::pair(largest.surely, largest.found_m_s2))
                largest = change;
        }
    return largest;
}

}  // namespace

Finding computation::flatness(const Clause& clause, const ClauseContext& context) {
    return of_heights({.of_ground = "highest less lowest ground under the run, by the surface",
                       .by_surface = &GroundFacts::height_difference_m,
                       .of_track = "highest less lowest height of the run",
                       .by_track = &CourseFacts::height_difference_m,
                       .missing = "not every epoch of the run has a height"},
                      clause, context);
}

Finding computation::slope(const Clause& clause, const ClauseContext& context) {
    return of_heights(
        {.of_ground = "slope of the ground under the window, without sign, by the surface",
         .by_surface = &GroundFacts::slope,
         .of_track = "slope of the window, without sign",
         .by_track = &CourseFacts::slope,
         .missing = "the window's ends have no heights"},
        clause, context);
}

Finding computation::straightness(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit(
        of_course("largest distance of the track from its chord", facts->straightness_m), clause);
}

Finding computation::turning(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit(
        of_course("change of direction in the window, without sign", facts->turning_deg), clause);
}

Finding computation::standing_start(const Clause&, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    const CourseFigure& speed = facts->speed_before_m_s;
    const CraftRun& run = *context.course.run;
    Figure slowest = plain("smallest speed of the run before the window", speed.value, "m/s");
    slowest.expanded_uncertainty = speed.expanded_uncertainty;
    const std::string words = fmt::format(
        "{} {}", slowest.name, quantity_text(speed.value, speed.expanded_uncertainty, "m/s"));
    if (facts->standing_start &&
        speed.value + speed.expanded_uncertainty.value_or(1.0) > CourseErrors{}.moving_above_m_s)
        return to_attest("{}, too uncertain to tell standing from moving", words).by({slowest});
    if (facts->standing_start)
        return met("{}, which is standing still; what moved it first is not decidable from the "
                   "recording",
                   words)
            .by({slowest});
    if (context.profile.speed_of == SpeedOf::reference_point)
        return to_attest("{}, of the antenna, which may swing while the craft stands", words)
            .by({slowest});
    if (run.began == RunEdge::standing && start_was_seen(run, speed, context))
        return not_met("{}: it was moving when the run began", words).by({slowest});
    return to_attest("{}: {}, so the start was not seen", words,
                     run.began == RunEdge::turn  ? "the run begins with a turn"
                     : run.began == RunEdge::gap ? "the run begins after a gap"
                     : run.began == RunEdge::standing
                         ? "the recording begins with the craft moving, if slowly"
                         : "the recording begins with the craft moving")
        .by({slowest});
}

Finding computation::run_up(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit({.name = "run-up",
                          .value = facts->run_up_m,
                          .note = fmt::format("in {:.1f} s", facts->run_up_s)},
                         clause);
}

Finding computation::wind_mean(const Clause& clause, const ClauseContext& context) {
    return of_flow("wind", context.wind, &FlowInWindow::mean_m_s, std::nullopt, clause);
}

Finding computation::wind_gust(const Clause& clause, const ClauseContext& context) {
    return of_flow("wind", context.wind, &FlowInWindow::gust_m_s, std::nullopt, clause);
}

Finding computation::current(const Clause& clause, const ClauseContext& context) {
    const auto& series = context.input.attempt.current;
    return of_flow("current", context.current, &FlowInWindow::gust_m_s,
                   series ? series->expanded_uncertainty_m_s : 0.0, clause);
}

/// Decides by the largest time between neighbouring epochs of the window.
Finding computation::sampling_rate(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.epochs();
    if (rows.size() < 2) return unknown(no_window);
    double longest_s = 0.0;
    double before_s = rows.front().time.seconds();
    for (const ScreenedEpoch& row : rows) {
        if (is_out_of_time(row)) continue;
        longest_s = std::max(longest_s, row.time.seconds() - before_s);
        before_s = row.time.seconds();
    }
    // Stamps are decimals of a second, so a difference of 0.2 s is not exact.
    return against_limit(
        {.name = "lowest rate of epochs in the window", .value = 1.0 / (longest_s - 1e-9)}, clause);
}

/// Decides by two accuracies, of which the worst over the window counts. One is that of a speed
/// over the window from two positions with an epoch's stated standard deviations, the other that of
/// its recorded velocity, if stated.
Finding computation::sample_accuracy(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.epochs();
    if (rows.size() < 2) return unknown(no_window);
    const double of_two = std::numbers::sqrt2 / context.windows.best->span.duration.seconds();
    const bool vertical = context.profile.dimension == Dimension::vertical;
    double of_positions = 0.0;
    double of_velocities = 0.0;
    for (const ScreenedEpoch& row : rows) {
        const double position_m = position_accuracy(row, vertical);
        if (std::isnan(position_m)) return unknown("an epoch's accuracy is not stated");
        of_positions = std::max(of_positions, of_two * position_m);
        const double velocity = velocity_accuracy(row);
        of_velocities = velocity > of_velocities || std::isnan(velocity) ? velocity : of_velocities;
    }
    const auto text = [&](double speed_m_s) {
        return fmt::format("{} {}", significant_text(in_unit(speed_m_s, clause.unit), 3),
                           clause.unit);
    };
    const bool stated = !std::isnan(of_velocities);
    return against_limit(
        {.name = "worst accuracy of a sample in the window",
         .value = stated ? std::max(of_positions, of_velocities) : of_positions,
         .note = fmt::format("of two positions over the window {}; of the recorded velocity {}",
                             text(of_positions),
                             stated ? text(of_velocities) : "not stated throughout")},
        clause);
}

std::vector<std::vector<ScreenedEpoch>> samples_of(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    Samples windows{context.epochs()};
    if (const auto others = judged.further_epochs.find(context.key());
        others != judged.further_epochs.end())
        windows.insert(windows.end(), others->second.begin(), others->second.end());
    for (std::vector<ScreenedEpoch>& window : windows)
        std::erase_if(window, is_out_of_time);
    return windows;
}

Finding computation::acceleration(const Clause& clause, const ClauseContext& context) {
    const Samples windows = samples_of(context);
    if (!has_window(windows)) return unknown(no_window);
    // A nod of the head makes more than the limit, but no more than a craft of the class.
    const double possible_m_s2 =
        std::max(*clause.limit, context.input.judged.tests.limits.acceleration_max_m_s2);
    const Change change = largest_change(windows, possible_m_s2);
    if (std::isnan(change.found_m_s2)) return unknown(no_speed_recorded);
    std::string chance;
    if (std::isfinite(change.by_chance_m_s2))
        chance = fmt::format(
            "; a craft of the class makes {} m/s2, and chance {} m/s2 by what the samples state",
            significant_text(possible_m_s2, 2), significant_text(change.by_chance_m_s2, 2));
    return against_limit(
        {.name = "largest change of the recorded speed between samples",
         .value = change.found_m_s2,
         .note = change.epoch > 0 ? fmt::format("up to epoch {}", change.epoch) : "",
         .if_not_met =
             change.surely
                 ? not_met("{}", chance)
                 : to_attest("{}: whether such samples count is for an official", chance)},
        clause);
}

Finding computation::satellites(const Clause& clause, const ClauseContext& context) {
    const Samples windows = samples_of(context);
    if (!has_window(windows)) return unknown(no_window);
    double fewest = 1e9;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (const ScreenedEpoch& row : window) {
            if (!row.satellites)
                return unknown(
                    "the recording does not say at epoch {} how many satellites were used",
                    row.epoch);
            fewest = std::min(fewest, static_cast<double>(*row.satellites));
        }
    return against_limit({.name = "fewest satellites of a sample", .value = fewest}, clause);
}

Finding computation::least_speed(const Clause& clause, const ClauseContext& context) {
    const Samples windows = samples_of(context);
    if (!has_window(windows) || !context.shown) return unknown(no_window);
    const Distances found = distances_of(windows, *clause.limit * metres_per_second(clause.unit));
    if (std::isnan(found.least_m_s)) return unknown(no_speed_recorded);
    const double left = found.all > 0.0 ? 1.0 - found.slow / found.all : 0.0;
    return against_limit(
        {.name = "smallest recorded speed of a sample",
         .value = found.least_m_s,
         .if_not_met = to_attest(
             ": whether the slower samples count is for an official; without their distance the "
             "speed is {}",
             speed_of_rule(context, left * context.speed->speed_m_s))},
        clause);
}

}  // namespace runcert

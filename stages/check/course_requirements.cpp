#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"

namespace runcert {
namespace {

Compared compared(std::string name, const CourseFigure& figure, double factor = 1.0,
                  bool magnitude = false) {
    Compared result{.name = std::move(name),
                    .value = factor * figure.value,
                    .expanded_uncertainty = figure.expanded_uncertainty};
    if (magnitude) result.value = std::abs(result.value);
    if (result.expanded_uncertainty) *result.expanded_uncertainty *= factor;
    return result;
}

/// A figure of the ground, with the track's own said beside it.
Compared beside_the_track(Compared ground, const std::optional<CourseFigure>& track, double factor,
                          const std::string& unit) {
    if (track)
        ground.note = fmt::format("{} {} by the heights of the track",
                                  format_fixed(std::abs(factor * track->value), 2), unit);
    return ground;
}

/// A surface that heights of the recording contradict does not decide by itself: the ground may
/// have been where they were.
Finding by_the_ground(Finding finding, const ClauseContext& context) {
    const auto& surface = context.input.judged.tests.surface;
    if (!surface || surface->rejected == 0 || finding.status != RequirementStatus::met)
        return finding;
    finding.status = RequirementStatus::attest;
    finding.evidence += fmt::format(
        "; {} of {} heights of the recording contradict the surface and were left out, so that "
        "the heights of the ground are to be attested",
        surface->rejected, surface->compared);
    return finding;
}

/// Heights that do not scatter as stated are typed, smoothed or of a formula. What follows from
/// them was not measured.
Finding by_the_heights(const Compared& figure, const Clause& clause, const ClauseContext& context) {
    Finding finding = against_limit(figure, clause);
    constexpr double too_smooth = 0.3;
    const auto& models = context.input.judged.tests.models;
    const auto model = std::ranges::find(models, TestedAxes::vertical, &ScreeningModel::axes);
    if (finding.status != RequirementStatus::met || model == models.end()) return finding;
    if (model->noise == NoiseBasis::fitted && model->white_scale >= too_smooth) return finding;
    finding.status = RequirementStatus::attest;
    finding.evidence += fmt::format(
        "; but the heights were not shown to scatter as stated (noise: {}, {:.2g} times as stated)",
        to_text(model->noise), model->white_scale);
    return finding;
}

/// The finding from the facts about the course, or that there are none.
template <class Find>
Finding with_facts(const ClauseContext& context, Find&& find) {
    if (!context.course.facts) return unknown(context.course.missing);
    return find(*context.course.facts);
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

Finding wind(const Clause& clause, const ClauseContext& context, bool gust) {
    if (!context.wind) return unknown("the attempt gives no series of the wind");
    if (!context.wind->missing.empty()) return {RequirementStatus::not_met, context.wind->missing};
    return against_limit({.name = gust ? "strongest wind in the window" : "mean wind in the window",
                          .value = (gust ? context.wind->gust_m_s : context.wind->mean_m_s) /
                                   metres_per_second(clause.unit),
                          .note = fmt::format("{} {} in the window", context.wind->samples,
                                              context.wind->samples == 1 ? "sample" : "samples")},
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

}  // namespace

Finding computation::flatness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (const auto& ground = context.course.ground)
            return by_the_ground(
                against_limit(
                    beside_the_track(
                        compared("highest less lowest ground under the run, by the surface",
                                 ground->height_difference_m),
                        facts.height_difference_m, 1.0, clause.unit),
                    clause),
                context);
        if (!facts.height_difference_m) return unknown("not every epoch of the run has a height");
        return by_the_heights(
            compared("highest less lowest height of the run", *facts.height_difference_m), clause,
            context);
    });
}

Finding computation::slope(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (const auto& ground = context.course.ground)
            return by_the_ground(
                against_limit(
                    beside_the_track(compared("slope of the ground under the window, without "
                                              "sign, by the surface",
                                              ground->slope, 100.0, true),
                                     facts.slope, 100.0, clause.unit),
                    clause),
                context);
        if (!facts.slope) return unknown("the window's ends have no heights");
        return by_the_heights(
            compared("slope of the window, without sign", *facts.slope, 100.0, true), clause,
            context);
    });
}

Finding computation::straightness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(
            compared("largest distance of the track from its chord", facts.straightness_m), clause);
    });
}

Finding computation::turning(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(compared("change of direction in the window, without sign",
                                      facts.turning_deg, 1.0, true),
                             clause);
    });
}

Finding computation::standing_start(const Clause&, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) -> Finding {
        const CourseFigure& speed = facts.speed_before_m_s;
        const std::string words =
            fmt::format("smallest speed of the run before the window {}",
                        quantity_text(speed.value, speed.expanded_uncertainty, "m/s"));
        std::vector<Figure> figures{{.name = "smallest speed of the run before the window",
                                     .value = speed.value,
                                     .unit = "m/s",
                                     .expanded_uncertainty = speed.expanded_uncertainty}};
        if (facts.standing_start && speed.value + speed.expanded_uncertainty.value_or(1.0) >
                                        CourseErrors{}.moving_above_m_s)
            return {RequirementStatus::attest,
                    words + ", too uncertain to tell standing from moving", std::move(figures)};
        if (facts.standing_start)
            return {RequirementStatus::met,
                    words +
                        ", which is standing still; what moved it first is not decidable from the "
                        "recording",
                    std::move(figures)};
        const CraftRun& run = *context.course.run;
        const RunEdge began = run.began;
        if (context.profile.speed_of == SpeedOf::reference_point)
            return {RequirementStatus::attest,
                    words + ", of the antenna, which may swing while the craft stands",
                    std::move(figures)};
        if (began == RunEdge::standing && start_was_seen(run, speed, context))
            return {RequirementStatus::not_met, words + ": it was moving when the run began",
                    std::move(figures)};
        return {RequirementStatus::attest,
                fmt::format("{}: {}, so the start was not seen", words,
                            began == RunEdge::turn  ? "the run begins with a turn"
                            : began == RunEdge::gap ? "the run begins after a gap"
                            : began == RunEdge::standing
                                ? "the recording begins with the craft moving, if slowly"
                                : "the recording begins with the craft moving"),
                std::move(figures)};
    });
}

Finding computation::run_up(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit({.name = "run-up",
                              .value = facts.run_up_m,
                              .note = fmt::format("in {:.1f} s", facts.run_up_s)},
                             clause);
    });
}

Finding computation::wind_mean(const Clause& clause, const ClauseContext& context) {
    return wind(clause, context, false);
}

Finding computation::wind_gust(const Clause& clause, const ClauseContext& context) {
    return wind(clause, context, true);
}

Finding computation::current(const Clause& clause, const ClauseContext& context) {
    if (!context.current) return unknown("the attempt gives no series of the current");
    if (!context.current->missing.empty())
        return {RequirementStatus::not_met, context.current->missing};
    const double unit = metres_per_second(clause.unit);
    return against_limit(
        {.name = "strongest current in the window",
         .value = context.current->gust_m_s / unit,
         .expanded_uncertainty = context.input.attempt.current->expanded_uncertainty_m_s / unit},
        clause);
}

/// Decides by the largest time between neighbouring epochs of the window.
Finding computation::sampling_rate(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.epochs();
    if (rows.size() < 2) return unknown("there is no certifiable window");
    double longest_s = 0.0;
    double before_s = rows.front().time.seconds();
    for (const ScreenedEpoch& row : rows) {
        if (is_out_of_time(row)) continue;
        longest_s = std::max(longest_s, row.time.seconds() - before_s);
        before_s = row.time.seconds();
    }
    // Stamps are decimals of a second, so a difference of 0.2 s is not exact.
    const double rate_hz = 1.0 / (longest_s - 1e-9);
    return against_limit({.name = "lowest rate of epochs in the window", .value = rate_hz}, clause);
}

/// Decides by two accuracies, of which the worst over the window counts. One is that of a speed
/// over the window from two positions with an epoch's stated standard deviations, the other that of
/// its recorded velocity, if stated.
Finding computation::sample_accuracy(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.epochs();
    if (rows.size() < 2) return unknown("there is no certifiable window");
    const double of_two = std::numbers::sqrt2 / context.windows.best->span.duration.seconds();
    double of_positions = 0.0;
    double of_velocities = 0.0;
    for (const ScreenedEpoch& row : rows) {
        const bool vertical = context.profile.dimension == Dimension::vertical;
        const double position_m = position_accuracy(row, vertical);
        if (std::isnan(position_m)) return unknown("an epoch's accuracy is not stated");
        of_positions = std::max(of_positions, of_two * position_m);
        const double velocity = velocity_accuracy(row);
        of_velocities = velocity > of_velocities || std::isnan(velocity) ? velocity : of_velocities;
    }
    const double unit = metres_per_second(clause.unit);
    const bool stated = !std::isnan(of_velocities);
    return against_limit(
        {.name = "worst accuracy of a sample in the window",
         .value = (stated ? std::max(of_positions, of_velocities) : of_positions) / unit,
         .note = fmt::format(
             "of two positions over the window {} {}; of the recorded velocity {}",
             significant_text(of_positions / unit, 3), clause.unit,
             stated ? fmt::format("{} {}", significant_text(of_velocities / unit, 3), clause.unit)
                    : std::string("not stated throughout"))},
        clause);
}

}  // namespace runcert

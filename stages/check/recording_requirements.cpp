#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reports/words/figures.h"
#include "stages/check/against_limit.h"

namespace runcert {
namespace {

Finding wind(const Clause& clause, const ClauseContext& context, bool gust) {
    if (!context.wind) return unknown("the attempt gives no series of the wind");
    if (!context.wind->missing.empty()) return {RequirementStatus::not_met, context.wind->missing};
    return against_limit({.name = gust ? "strongest wind in the window" : "mean wind in the window",
                          .value = (gust ? context.wind->gust_m_s : context.wind->mean_m_s) /
                                   metres_per_second(clause.unit),
                          .expanded_uncertainty = std::nullopt,
                          .note = fmt::format("{} {} in the window", context.wind->samples,
                                              context.wind->samples == 1 ? "sample" : "samples")},
                         clause);
}

/// Standard uncertainty of the recorded velocity, all axes together; NaN where it is not stated.
double velocity_accuracy(const ScreenedEpoch& row) {
    double sum = 0.0;
    for (const OptionalReal& sigma :
         {row.sigma_recorded_velocity_east_m_s, row.sigma_recorded_velocity_north_m_s,
          row.sigma_recorded_velocity_up_m_s})
        sum += sigma ? *sigma * *sigma : std::nan("");
    return std::sqrt(sum);
}

/// Stated standard uncertainty of the height, or horizontally of both coordinates together.
double position_accuracy(const ScreenedEpoch& row, bool vertical) {
    const auto stated = [](const auto& sigma) { return sigma ? *sigma : std::nan(""); };
    return vertical ? stated(row.sigma_up_m)
                    : std::hypot(stated(row.sigma_east_m), stated(row.sigma_north_m));
}

}  // namespace

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

/// Largest time between neighbouring epochs of the window.
Finding computation::sampling_rate(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.input.judged.epochs_of(context.profile.id);
    if (rows.size() < 2) return unknown("there is no certifiable window");
    double longest_s = 0.0;
    double before_s = rows.front().time.seconds();
    for (const ScreenedEpoch& row : rows) {
        if (is_out_of_time(row)) continue;
        longest_s = std::max(longest_s, row.time.seconds() - before_s);
        before_s = row.time.seconds();
    }
    // Stamps are written in decimals of a second: 0.2 s apart, as a difference, is not exactly so.
    const double rate_hz = 1.0 / (longest_s - 1e-9);
    return against_limit({.name = "lowest rate of epochs in the window",
                          .value = rate_hz,
                          .expanded_uncertainty = std::nullopt},
                         clause);
}

/// The accuracy of a speed over the window from two positions as accurate as an epoch's is stated
/// to be; and that of its recorded velocity, where one is stated. The worst of all counts.
Finding computation::sample_accuracy(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.input.judged.epochs_of(context.profile.id);
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
         .expanded_uncertainty = std::nullopt,
         .note = fmt::format(
             "of two positions over the window {} {}; of the recorded velocity {}",
             significant_text(of_positions / unit, 3), clause.unit,
             stated ? fmt::format("{} {}", significant_text(of_velocities / unit, 3), clause.unit)
                    : std::string("not stated throughout"))},
        clause);
}

Finding computation::opposite_runs(const Clause&, const ClauseContext& context) {
    if (!context.windows.best || context.windows.further.empty())
        return {RequirementStatus::not_met, context.windows.missing.empty()
                                                ? "there are no two certifiable windows"
                                                : context.windows.missing};
    const WindowSpan& one = context.windows.best->span;
    const WindowSpan& other = context.windows.further.front().span;
    const double from_s = std::min(one.start, other.start).seconds();
    const double to_s = std::max(one.start.seconds() + one.duration.seconds(),
                                 other.start.seconds() + other.duration.seconds());
    return {RequirementStatus::met,
            fmt::format("two runs in opposite directions, {:.3f} km/h and {:.3f} km/h, within "
                        "{:.1f} s, at most {:g} s",
                        context.windows.best->speed_m_s * 3.6,
                        context.windows.further.front().speed_m_s * 3.6, to_s - from_s,
                        *context.profile.opposite_runs_within_s),
            {{.name = "speed of the one", .value = context.windows.best->speed_m_s, .unit = "m/s"},
             {.name = "speed of the other",
              .value = context.windows.further.front().speed_m_s,
              .unit = "m/s"},
             {.name = "time that holds both", .value = to_s - from_s, .unit = "s"}}};
}

/// Whether what the recording shows to be fastest is what was certified.
Finding computation::fastest_certifiable(const Clause&, const ClauseContext& context) {
    const auto& best = context.windows.best;
    if (!best) return {RequirementStatus::not_met, "there is no certifiable window"};
    const auto& indicated = context.windows.indicated;
    if (!indicated || indicated->refusals.empty())
        return {RequirementStatus::met,
                "the fastest window that the recording shows could be certified"};
    const double least_m_s = best->speed_m_s + 2.0 * best->standard_uncertainty_m_s;
    const std::string words =
        fmt::format("the recording{} {:.3f} km/h {} in a window that cannot be certified ({})",
                    indicated->source == SpeedSource::velocity ? "'s velocities show" : " shows",
                    indicated->speed_m_s * 3.6, beginning_text(indicated->span),
                    fmt::join(indicated->refusals, ", "));
    std::vector<Figure> figures{
        {.name = "fastest as recorded", .value = indicated->speed_m_s, .unit = "m/s"}};
    // What its own epochs state makes so much of it worthless.
    if (indicated->speed_m_s - indicated->stated_expanded_uncertainty_m_s <= least_m_s)
        return {RequirementStatus::met, words + ", which shows no more than the certified one",
                std::move(figures)};
    return {RequirementStatus::not_met, words + ": what the score would be is not known",
            std::move(figures)};
}

}  // namespace runcert

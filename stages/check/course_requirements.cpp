#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "stages/check/requirements.h"

namespace runcert {
namespace {

/// A figure that is compared with a clause's limit, in the limit's unit.
struct Compared {
    std::string name;
    double value = 0.0;
    std::optional<double> expanded_uncertainty;
    std::string note = {};
};

std::string words_of(const Compared& figure, const std::string& unit) {
    const auto number = [](double value) { return fmt::format("{:.4g}", value); };
    return fmt::format("{} {} {}{}", figure.name, number(figure.value), unit,
                       figure.expanded_uncertainty
                           ? fmt::format(" +/- {:.2g} {}", *figure.expanded_uncertainty, unit)
                           : std::string());
}

enum class Bound { at_most, at_least };

/// Met or not met where the whole interval is on one side of the limit.
Finding against_limit(const Compared& figure, const Clause& clause, Bound bound) {
    const double limit = clause.limit.value();
    const double reach = figure.expanded_uncertainty.value_or(0.0);
    const double sign = bound == Bound::at_most ? 1.0 : -1.0;
    const double worst = sign * figure.value + reach;
    const double best = sign * figure.value - reach;
    const char* const status =
        worst <= sign * limit ? "met" : (best > sign * limit ? "not_met" : "attest");
    std::string evidence =
        fmt::format("{}, {} {:.4g} {}{}", words_of(figure, clause.unit),
                    bound == Bound::at_most ? "at most" : "at least", limit, clause.unit,
                    std::string_view(status) == "attest"
                        ? ": the limit lies within the uncertainty, the data cannot tell"
                        : "");
    if (!figure.note.empty()) evidence += "; " + figure.note;
    return {status,
            std::move(evidence),
            {{.name = figure.name,
              .value = figure.value,
              .unit = clause.unit,
              .expanded_uncertainty = figure.expanded_uncertainty,
              .note = figure.note}}};
}

Compared compared(std::string name, const CourseFigure& figure, double factor = 1.0,
                  bool magnitude = false) {
    Compared result{.name = std::move(name),
                    .value = factor * figure.value,
                    .expanded_uncertainty = figure.expanded_uncertainty};
    if (magnitude) result.value = std::abs(result.value);
    if (result.expanded_uncertainty) *result.expanded_uncertainty *= factor;
    return result;
}

Finding unknown(std::string why) {
    return {"attest", "the data do not tell: " + std::move(why)};
}

/// The finding of what the trajectory says of the course, or that it says nothing.
template <class Find>
Finding with_facts(const ClauseContext& context, Find&& find) {
    if (!context.course.facts) return unknown(context.course.missing);
    return find(*context.course.facts);
}

Finding flatness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (!facts.height_difference_m) return unknown("not every epoch of the run has a height");
        return against_limit(
            compared("highest less lowest height of the run", *facts.height_difference_m), clause,
            Bound::at_most);
    });
}

Finding slope(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (!facts.slope) return unknown("the window's ends have no heights");
        return against_limit(
            compared("slope of the window, without sign", *facts.slope, 100.0, true), clause,
            Bound::at_most);
    });
}

Finding straightness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(
            compared("largest distance of the track from its chord", facts.straightness_m), clause,
            Bound::at_most);
    });
}

Finding turning(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(compared("change of direction in the window, without sign",
                                      facts.turning_deg, 1.0, true),
                             clause, Bound::at_most);
    });
}

/// Whether the recording holds the craft at its slowest before the run: not where it was faster, by
/// more than the uncertainty, ever after the first second of what there is. It may have been slower
/// before.
bool start_was_seen(const CraftRun& run, const CourseFigure& slowest,
                    const ClauseContext& context) {
    constexpr double beginning_s = 1.0;
    const auto& rows = context.input.judged.trajectory;
    const std::size_t from = run.stood_from_row.value_or(run.first_row);
    for (std::size_t i = 0; i < from; ++i)
        if (rows[i].arc) return true;
    const double least_mps = slowest.value + slowest.expanded_uncertainty.value_or(0.0);
    for (std::size_t i = from; i <= run.first_row; ++i)
        if (rows[i].arc && rows[i].time.seconds() - rows[from].time.seconds() > beginning_s &&
            std::hypot(*rows[i].velocity_east_mps, *rows[i].velocity_north_mps) <= least_mps)
            return true;
    return false;
}

Finding standing_start(const Clause&, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) -> Finding {
        const CourseFigure& speed = facts.speed_before_mps;
        const std::string words = fmt::format(
            "smallest speed of the run before the window {:.3f} m/s{}", speed.value,
            speed.expanded_uncertainty ? fmt::format(" +/- {:.3f} m/s", *speed.expanded_uncertainty)
                                       : "");
        std::vector<Figure> figures{{.name = "smallest speed of the run before the window",
                                     .value = speed.value,
                                     .unit = "m/s",
                                     .expanded_uncertainty = speed.expanded_uncertainty}};
        if (facts.standing_start)
            return {"met",
                    words +
                        ", which is standing still; what moved it first, the data do "
                        "not tell",
                    std::move(figures)};
        const CraftRun& run = *context.course.run;
        const std::string& began = run.began;
        if (began == "standing" && start_was_seen(run, speed, context))
            return {"not_met", words + ": it was moving when the run began", std::move(figures)};
        return {"attest",
                fmt::format("{}: {}, so the start was not seen", words,
                            began == "turn"  ? "the run begins with a turn"
                            : began == "gap" ? "the run begins after a gap"
                            : began == "standing"
                                ? "the recording begins with the craft moving, if slowly"
                                : "the recording begins with the craft moving"),
                std::move(figures)};
    });
}

Finding run_up(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit({.name = "run-up",
                              .value = facts.run_up_m,
                              .expanded_uncertainty = std::nullopt,
                              .note = fmt::format("in {:.1f} s", facts.run_up_s)},
                             clause, Bound::at_least);
    });
}

Finding wind(const Clause& clause, const ClauseContext& context, bool gust) {
    if (!context.wind) return unknown("the attempt gives no series of the wind");
    if (!context.wind->missing.empty()) return {"not_met", context.wind->missing};
    return against_limit({.name = gust ? "strongest wind in the window" : "mean wind in the window",
                          .value = (gust ? context.wind->gust_mps : context.wind->mean_mps) /
                                   metres_per_second(clause.unit),
                          .expanded_uncertainty = std::nullopt,
                          .note = fmt::format("{} {} in the window", context.wind->samples,
                                              context.wind->samples == 1 ? "sample" : "samples")},
                         clause, Bound::at_most);
}

Finding wind_mean(const Clause& clause, const ClauseContext& context) {
    return wind(clause, context, false);
}

Finding wind_gust(const Clause& clause, const ClauseContext& context) {
    return wind(clause, context, true);
}

Finding current(const Clause& clause, const ClauseContext& context) {
    if (!context.current) return unknown("the attempt gives no series of the current");
    if (!context.current->missing.empty()) return {"not_met", context.current->missing};
    const double unit = metres_per_second(clause.unit);
    return against_limit(
        {.name = "strongest current in the window",
         .value = context.current->gust_mps / unit,
         .expanded_uncertainty = context.input.attempt.current->expanded_uncertainty_mps / unit},
        clause, Bound::at_most);
}

/// Largest time between neighbouring epochs of the window.
Finding sampling_rate(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.input.judged.epochs_of(context.profile.id);
    if (rows.size() < 2) return unknown("there is no certifiable window");
    double longest_s = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i)
        longest_s = std::max(longest_s, rows[i].time.seconds() - rows[i - 1].time.seconds());
    // Stamps are written in decimals of a second: 0.2 s apart, as a difference, is not exactly so.
    const double rate_hz = 1.0 / (longest_s - 1e-9);
    return against_limit({.name = "lowest rate of epochs in the window",
                          .value = rate_hz,
                          .expanded_uncertainty = std::nullopt},
                         clause, Bound::at_least);
}

/// Standard uncertainty of the recorded velocity, all axes together; NaN where it is not stated.
double velocity_accuracy(const ScreenedEpoch& row) {
    double sum = 0.0;
    for (const OptionalReal& sigma :
         {row.sigma_recorded_velocity_east_mps, row.sigma_recorded_velocity_north_mps,
          row.sigma_recorded_velocity_up_mps})
        sum += sigma ? *sigma * *sigma : std::nan("");
    return std::sqrt(sum);
}

/// Stated standard uncertainty of the height, or horizontally of both coordinates together.
double position_accuracy(const ScreenedEpoch& row, bool vertical) {
    const auto stated = [](const auto& sigma) { return sigma ? *sigma : std::nan(""); };
    return vertical ? stated(row.sigma_up_m)
                    : std::hypot(stated(row.sigma_east_m), stated(row.sigma_north_m));
}

/// The accuracy of a speed over the window from two positions as accurate as an epoch's is stated
/// to be; and that of its recorded velocity, where one is stated. The worst of all counts.
Finding sample_accuracy(const Clause& clause, const ClauseContext& context) {
    const auto& rows = context.input.judged.epochs_of(context.profile.id);
    if (rows.size() < 2) return unknown("there is no certifiable window");
    const double of_two = std::numbers::sqrt2 / context.windows.best->span.duration.seconds();
    double of_positions = 0.0;
    double of_velocities = 0.0;
    for (const ScreenedEpoch& row : rows) {
        const bool vertical = context.profile.dimension == "vertical";
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
         .note =
             fmt::format("of two positions over the window {:.3g} {}; of the recorded velocity {}",
                         of_positions / unit, clause.unit,
                         stated ? fmt::format("{:.3g} {}", of_velocities / unit, clause.unit)
                                : std::string("not stated throughout"))},
        clause, Bound::at_most);
}

Finding opposite_runs(const Clause&, const ClauseContext& context) {
    if (!context.windows.best || context.windows.further.empty())
        return {"not_met", context.windows.missing.empty() ? "there are no two certifiable windows"
                                                           : context.windows.missing};
    const WindowSpan& one = context.windows.best->span;
    const WindowSpan& other = context.windows.further.front().span;
    const double from_s = std::min(one.start, other.start).seconds();
    const double to_s = std::max(one.start.seconds() + one.duration.seconds(),
                                 other.start.seconds() + other.duration.seconds());
    return {"met",
            fmt::format("two runs in opposite directions, {:.3f} km/h and {:.3f} km/h, within "
                        "{:.1f} s, at most {:g} s",
                        context.windows.best->speed_mps * 3.6,
                        context.windows.further.front().speed_mps * 3.6, to_s - from_s,
                        *context.profile.opposite_runs_within_s),
            {{.name = "speed of the one", .value = context.windows.best->speed_mps, .unit = "m/s"},
             {.name = "speed of the other",
              .value = context.windows.further.front().speed_mps,
              .unit = "m/s"},
             {.name = "time that holds both", .value = to_s - from_s, .unit = "s"}}};
}

/// Whether what the recording shows to be fastest is what was certified.
Finding fastest_certifiable(const Clause&, const ClauseContext& context) {
    const auto& best = context.windows.best;
    if (!best) return {"not_met", "there is no certifiable window"};
    const auto& indicated = context.windows.indicated;
    if (!indicated || indicated->refusals.empty())
        return {"met", "the fastest window that the recording shows could be certified"};
    const double least_mps = best->speed_mps + 2.0 * best->standard_uncertainty_mps;
    const std::string words =
        fmt::format("the recording shows {:.3f} km/h in a window that cannot be certified ({})",
                    indicated->speed_mps * 3.6, fmt::join(indicated->refusals, ", "));
    std::vector<Figure> figures{
        {.name = "fastest as recorded", .value = indicated->speed_mps, .unit = "m/s"}};
    if (indicated->speed_mps <= least_mps)
        return {"met", words + ", which is no faster than the certified one", std::move(figures)};
    return {"not_met", words + ": what the score would be is not known", std::move(figures)};
}

}  // namespace

std::optional<Finding> course_finding(const Clause& clause, const ClauseContext& context) {
    static const std::map<std::string, std::function<Finding(const Clause&, const ClauseContext&)>>
        computations{{"flatness", flatness},
                     {"slope", slope},
                     {"straightness", straightness},
                     {"turning", turning},
                     {"standing_start", standing_start},
                     {"run_up", run_up},
                     {"wind_mean", wind_mean},
                     {"wind_gust", wind_gust},
                     {"current", current},
                     {"sampling_rate", sampling_rate},
                     {"sample_accuracy", sample_accuracy},
                     {"opposite_runs", opposite_runs},
                     {"fastest_certifiable", fastest_certifiable}};
    const auto computation = computations.find(clause.decided_by);
    if (computation == computations.end()) return std::nullopt;
    return computation->second(clause, context);
}

}  // namespace runcert

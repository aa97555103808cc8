#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/figures.h"
#include "core/speed_unit.h"
#include "core/statistics.h"
#include "stages/check/requirements.h"

// What a rule limits of every sample of its windows.

namespace runcert {
namespace {

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
    double least_m_s = std::numeric_limits<double>::infinity();  ///< NaN where one has no speed
};

Distances distances_of(const Samples& windows, double limit_m_s) {
    Distances found;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (std::size_t i = 0; i < window.size(); ++i) {
            const double speed_m_s = recorded_speed_m_s(window[i]);
            if (std::isnan(speed_m_s)) return {.least_m_s = speed_m_s};
            found.least_m_s = std::min(found.least_m_s, speed_m_s);
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
    bool surely = false;      ///< beyond what is possible by more than chance
    double found_m_s2 = 0.0;  ///< NaN where a sample has no speed
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
            const double found_m_s2 =
                std::abs(recorded_speed_m_s(after) - recorded_speed_m_s(before)) / time_s;
            if (std::isnan(found_m_s2)) return {.found_m_s2 = found_m_s2};
            const double made_m_s2 =
                by_chance * std::hypot(stated_sigma_m_s(before), stated_sigma_m_s(after)) / time_s;
            const bool surely = found_m_s2 - made_m_s2 > possible_m_s2;
            if (std::pair(surely, found_m_s2) > std::pair(largest.surely, largest.found_m_s2))
                largest = {surely, found_m_s2, made_m_s2, after.epoch};
        }
    return largest;
}

}  // namespace

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

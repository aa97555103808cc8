#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/speed_unit.h"
#include "core/statistics.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"

// What a rule asks of every sample of its windows, and of the device that recorded them.

namespace runcert {
namespace {

/// The recorded horizontal speed; NaN if the recording has none.
double recorded_speed_m_s(const ScreenedEpoch& row) {
    if (row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s)
        return std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s);
    return row.recorded_speed_m_s ? *row.recorded_speed_m_s : std::nan("");
}

constexpr const char* no_window_at_all = "there is no certifiable window";
constexpr const char* no_speed_recorded = "an epoch of the window has no recorded speed";

bool has_window(const std::vector<std::vector<ScreenedEpoch>>& windows) {
    return windows.front().size() >= 2;
}

/// The samples after the first of each window, whose speeds make its distance: all of it, and what
/// was made below a speed.
struct Distances {
    double all = 0.0;
    double slow = 0.0;
    double least_m_s = std::numeric_limits<double>::infinity();
};

Distances distances_of(const std::vector<std::vector<ScreenedEpoch>>& windows, double limit_m_s) {
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

/// The stated standard deviation of the recorded horizontal speed; infinite where none is stated.
double stated_sigma_m_s(const ScreenedEpoch& row) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (!row.recorded_velocity_east_m_s) return row.sigma_recorded_speed_m_s.value_or(none);
    return std::max(row.sigma_recorded_velocity_east_m_s.value_or(none),
                    row.sigma_recorded_velocity_north_m_s.value_or(none));
}

}  // namespace

std::vector<std::vector<ScreenedEpoch>> samples_of(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    std::vector<std::vector<ScreenedEpoch>> windows{context.epochs()};
    if (const auto others = judged.further_epochs.find(context.key());
        others != judged.further_epochs.end())
        windows.insert(windows.end(), others->second.begin(), others->second.end());
    for (std::vector<ScreenedEpoch>& window : windows)
        std::erase_if(window, is_out_of_time);
    return windows;
}

Finding computation::acceleration(const Clause& clause, const ClauseContext& context) {
    const auto windows = samples_of(context);
    if (!has_window(windows)) return unknown(no_window_at_all);
    std::size_t samples = 0;
    for (const std::vector<ScreenedEpoch>& window : windows)
        samples += window.size();
    // All changes together exceed that by chance once in a thousand times.
    const double by_chance = -normal_quantile(0.0005 / static_cast<double>(samples));
    // A nod of the head makes more than the limit, but no more than a craft of the class.
    const double possible_m_s2 =
        std::max(*clause.limit, context.input.judged.tests.limits.acceleration_max_m_s2);
    bool surely = false;  // beyond that by more than chance
    double largest_m_s2 = 0.0, chance_m_s2 = 0.0;
    std::int64_t epoch = 0;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (std::size_t i = 1; i < window.size(); ++i) {
            const ScreenedEpoch &before = window[i - 1], &after = window[i];
            const double time_s = after.time.seconds() - before.time.seconds();
            const double found_m_s2 =
                std::abs(recorded_speed_m_s(after) - recorded_speed_m_s(before)) / time_s;
            if (std::isnan(found_m_s2)) return unknown(no_speed_recorded);
            const double made_m_s2 =
                by_chance * std::hypot(stated_sigma_m_s(before), stated_sigma_m_s(after)) / time_s;
            const bool sure = found_m_s2 - made_m_s2 > possible_m_s2;
            if (std::pair(sure, found_m_s2) <= std::pair(surely, largest_m_s2)) continue;
            surely = sure;
            largest_m_s2 = found_m_s2;
            chance_m_s2 = made_m_s2;
            epoch = after.epoch;
        }
    Finding finding = against_limit({.name = "largest change of the recorded speed between samples",
                                     .value = largest_m_s2,
                                     .note = epoch > 0 ? fmt::format("up to epoch {}", epoch) : ""},
                                    clause);
    if (finding.status != RequirementStatus::not_met) return finding;
    if (std::isfinite(chance_m_s2))
        finding.evidence += fmt::format(
            "; a craft of the class makes {} m/s2, and chance {} m/s2 by what the "
            "samples state",
            significant_text(possible_m_s2, 2), significant_text(chance_m_s2, 2));
    if (surely) return finding;
    finding.status = RequirementStatus::attest;
    finding.evidence += ": whether such samples count is for an official";
    return finding;
}

Finding computation::satellites(const Clause& clause, const ClauseContext& context) {
    const auto windows = samples_of(context);
    if (!has_window(windows)) return unknown(no_window_at_all);
    std::optional<double> fewest;
    for (const std::vector<ScreenedEpoch>& window : windows)
        for (const ScreenedEpoch& row : window) {
            if (!row.satellites)
                return unknown(fmt::format(
                    "the recording does not say at epoch {} how many satellites were used",
                    row.epoch));
            fewest = std::min(fewest.value_or(1e9), static_cast<double>(*row.satellites));
        }
    return against_limit({.name = "fewest satellites of a sample", .value = *fewest}, clause);
}

Finding computation::least_speed(const Clause& clause, const ClauseContext& context) {
    const auto windows = samples_of(context);
    if (!has_window(windows) || !context.shown) return unknown(no_window_at_all);
    const double unit_m_s = metres_per_second(clause.unit);
    const Distances found = distances_of(windows, *clause.limit * unit_m_s);
    if (std::isnan(found.least_m_s)) return unknown(no_speed_recorded);
    Finding finding = against_limit(
        {.name = "smallest recorded speed of a sample", .value = found.least_m_s / unit_m_s},
        clause);
    if (finding.status == RequirementStatus::met) return finding;
    const double left = found.all > 0.0 ? 1.0 - found.slow / found.all : 0.0;
    finding.status = RequirementStatus::attest;
    finding.evidence += fmt::format(
        ": whether the slower samples count is for an official; without their distance the "
        "speed is {}",
        speed_of_rule(context, left * context.speed->speed_m_s));
    return finding;
}

Finding computation::device_deduction(const Clause&, const ClauseContext& context) {
    const auto& receivers = context.input.attempt.receivers;
    const auto receiver =
        std::ranges::find(receivers, context.input.judged.receiver, &Receiver::id);
    if (receiver == receivers.end() || !receiver->device_deduction)
        return {RequirementStatus::attest,
                "the attempt states no deduction for the device (receivers[].device_deduction)"};
    const DeviceDeduction& taken = *receiver->device_deduction;
    std::string evidence = fmt::format("the attempt states a deduction of {} {} for the device",
                                       number_text(taken.speed), taken.unit);
    std::vector<Figure> figures{
        {.name = "deduction for the device", .value = taken.speed, .unit = taken.unit}};
    if (!context.speed) return {RequirementStatus::attest, evidence, std::move(figures)};
    const double left_m_s = context.speed->speed_m_s - taken.speed * metres_per_second(taken.unit);
    evidence +=
        fmt::format("; it leaves {} of the measured speed", speed_of_rule(context, left_m_s));
    if (context.required_speed)
        evidence += fmt::format(
            ", which {} the required {} {}",
            left_m_s >= context.required_speed->speed_m_s ? "reaches" : "does not reach",
            context.shown->required_speed, context.shown->unit);
    figures.push_back({.name = "measured speed less the deduction",
                       .value = left_m_s / metres_per_second(context.shown->unit),
                       .unit = context.shown->unit,
                       .shown = speed_of_rule(context, left_m_s)});
    return {RequirementStatus::attest, std::move(evidence), std::move(figures)};
}

Finding computation::sail_area(const Clause&, const ClauseContext& context) {
    const auto& area_m2 = context.input.attempt.craft.sail_area_m2;
    if (!area_m2)
        return {RequirementStatus::attest,
                "the attempt states no sail area (craft: {sail_area_m2: ...})"};
    return {RequirementStatus::attest,
            fmt::format("the attempt states a sail area of {}", number_text(*area_m2, "m²")),
            {{.name = "sail area", .value = *area_m2, .unit = "m²"}}};
}

}  // namespace runcert

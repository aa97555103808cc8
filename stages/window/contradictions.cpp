#include "stages/window/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "witness/roster.h"

namespace runcert {
namespace {

bool is_by(const Contradiction& one, const auto& witness) {
    return one.kind == witness.kind && one.receiver == witness.receiver;
}

/// Whether chance makes so large a difference of any of `count` witnesses in fewer than five of a
/// hundred windows.
bool doubts(const WitnessedSpeed& one, std::size_t count) {
    constexpr double test_size = 0.05;
    return std::abs(one.difference_m_s) >
           -normal_quantile(0.5 * test_size / static_cast<double>(count)) *
               sigma_of_difference(one);
}

/// Whether a witness agrees with the positions, and would have found such a drift of a window of
/// this length with a probability of 0.8. Its 95 % are not enough: of many spans beside a drift the
/// search takes the one that barely agrees, which holds some of the drift.
bool shows_sound(const WitnessedSpeed& one, double drift_m_s, double window_s) {
    constexpr double tested = 1.96, finds = 0.84, agrees = 1.0;
    static const double agrees_in_chance =
        std::sqrt(chi_squared_upper_quantile(0.05, 2) / chi_squared_upper_quantile(1e-3, 2));
    const double sigma_m_s = sigma_of_difference(one);
    const double diluted = one.compared_over_s ? window_s / *one.compared_over_s : 1.0;
    return !contradicts(one) && std::abs(one.difference_m_s) <= agrees * sigma_m_s &&
           one.chance_error.value_or(0.0) <= agrees_in_chance &&
           (tested + finds) * sigma_m_s <= diluted * drift_m_s;
}

}  // namespace

double sigma_of_difference(const WitnessedSpeed& one) {
    return std::hypot(one.standard_uncertainty_m_s, one.position_standard_uncertainty_m_s);
}

template <int Axes>
std::vector<Contradiction> contradictions_in(const AxesEstimate<Axes>& estimate,
                                             const FoundWindow& found,
                                             const CertifiableWindow& window) {
    constexpr double longer = 1.2, steps = 5.0;
    constexpr double never = std::numeric_limits<double>::infinity();
    const SpeedEvidence& evidence = window.evidence.value();
    const ArcMotion<Axes> motion(estimate.trajectory, estimate.rows[found.series]);
    const TimeSpan at{window.span.start.seconds(),
                      window.span.start.seconds() + window.span.duration.seconds()};
    const PositionFigures<Axes> figures{
        .start_s = at.first_s,
        .end_s = at.last_s,
        .standard_uncertainty_m_s = evidence.position_standard_uncertainty_m_s,
        .correlated_m_s = evidence.slow_standard_uncertainty_m_s,
        .fault = {.probability = evidence.fault_probability, .largest_m_s = evidence.fault_m_s}};
    std::vector<Contradiction> contradictions;
    for (const WitnessedSpeed& one : window.witnesses) {
        // What only the suspicion makes a contradiction is no new one.
        const bool is_new =
            evidence.fault_probability < as_likely_as_not || one.chance_error.value_or(0.0) > 1.0;
        if (!doubts(one, window.witnesses.size()) && !(contradicts(one) && is_new)) continue;
        const double window_s = at.last_s - at.first_s;
        Contradiction& found_here = contradictions.emplace_back(
            Contradiction{.series = found.series,
                          .window = at,
                          .kind = one.kind,
                          .receiver = one.receiver,
                          .drift_m_s = one.apart_m / one.compared_over_s.value_or(window_s),
                          .sound_until_s = -never,
                          .sound_from_s = never,
                          .sound_over_s = longer * window_s});
        const auto witness = std::ranges::find_if(
            estimate.witnesses, [&](const auto& each) { return is_by(found_here, each); });
        if (witness == estimate.witnesses.end()) continue;
        const auto sound_over = [&](double from_s) -> std::optional<TimeSpan> {
            const auto compared = compared_over(*witness, figures, motion,
                                                {from_s, from_s + found_here.sound_over_s});
            return compared && shows_sound(compared->speed, found_here.drift_m_s, window_s)
                       ? std::optional(compared->span)
                       : std::nullopt;
        };
        const double step_s = window_s / steps;
        for (double from_s = at.last_s; from_s < motion.covered().last_s; from_s += step_s)
            if (const auto sound = sound_over(from_s); sound && sound->first_s >= at.last_s) {
                found_here.sound_from_s = sound->last_s;
                break;
            }
        for (double to_s = at.first_s; to_s > motion.covered().first_s; to_s -= step_s)
            if (const auto sound = sound_over(to_s - found_here.sound_over_s);
                sound && sound->last_s <= at.first_s) {
                found_here.sound_until_s = sound->first_s;
                break;
            }
    }
    return contradictions;
}

const Contradiction* suspected_by(std::span<const Contradiction> contradictions,
                                  const FoundWindow& window,
                                  std::span<const WitnessedSpeed> heard) {
    const TimeSpan at{window.start.seconds(), window.end.seconds()};
    const double window_s = at.last_s - at.first_s;
    for (const Contradiction& one : contradictions) {
        const bool is_beyond = window_s <= one.sound_over_s &&
                               (at.last_s >= one.sound_from_s || at.first_s <= one.sound_until_s);
        if (window.series != one.series || is_beyond ||
            std::ranges::any_of(heard, [&](const WitnessedSpeed& each) {
                return is_by(one, each) && shows_sound(each, one.drift_m_s, window_s);
            }))
            continue;
        return &one;
    }
    return nullptr;
}

bool suspect_if_doubted(std::span<const WitnessedSpeed> heard, WindowFault& fault) {
    const auto one = std::ranges::find_if(
        heard, [&](const WitnessedSpeed& each) { return doubts(each, heard.size()); });
    if (one == heard.end() || std::ranges::any_of(heard, &contradicts)) return false;
    fault.raise(as_likely_as_not, std::abs(one->difference_m_s),
                fmt::format("the {} differ from the positions by {:.2f} m/s in this window, more "
                            "than the uncertainties of both make in 95 of 100",
                            words_of(one->kind), std::abs(one->difference_m_s)));
    return true;
}

void suspect(const Contradiction& by, WindowFault& fault) {
    fault.raise(as_likely_as_not, by.drift_m_s,
                fmt::format("the {} contradict the positions by {:.2f} m/s from {:.1f} s to {:.1f} "
                            "s, and have not shown them sound again up to this window",
                            words_of(by.kind), by.drift_m_s, by.window.first_s, by.window.last_s));
}

template std::vector<Contradiction> contradictions_in(const AxesEstimate<1>&, const FoundWindow&,
                                                      const CertifiableWindow&);
template std::vector<Contradiction> contradictions_in(const AxesEstimate<2>&, const FoundWindow&,
                                                      const CertifiableWindow&);

}  // namespace runcert

#include "stages/window/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.h"
#include "witness/evidence.h"
#include "witness/roster.h"

namespace runcert {
namespace {

constexpr double test_size = 0.05;  // of k = 2

/// Whether chance makes so large a difference of any of `count` witnesses in fewer than five of a
/// hundred windows.
bool doubts(const WitnessedSpeed& one, std::size_t count) {
    return std::abs(one.difference_m_s) >
           -normal_quantile(0.5 * test_size / static_cast<double>(count)) *
               sigma_of_difference(one);
}

/// Whether a witness agrees with the positions, and would have found such a drift of a window of
/// this length with a probability of 0.8. Its 95 % are not enough: of many spans beside a drift the
/// search takes the one that barely agrees, which holds some of the drift.
bool shows_sound(const WitnessedSpeed& one, double drift_m_s, double window_s) {
    static const double agrees_in_chance = over_chance(chi_squared_upper_quantile(test_size, 2), 2);
    const double sigma_m_s = sigma_of_difference(one);
    const double diluted = one.compared_over_s ? window_s / *one.compared_over_s : 1.0;
    return !contradicts(one) && std::abs(one.difference_m_s) <= sigma_m_s &&
           one.chance_error.value_or(0.0) <= agrees_in_chance &&
           found_in_units * sigma_m_s <= diluted * drift_m_s;
}

/// The nearest span after a window, or before it, that `is_sound`: of so many seconds, or longer
/// where the witness knows only other instants.
template <class IsSound>
std::optional<TimeSpan> nearest_sound(const TimeSpan& window, const TimeSpan& covered,
                                      double length_s, bool after, const IsSound& is_sound) {
    const double step_s = (window.last_s - window.first_s) / 5.0;
    for (double apart_s = 0.0;; apart_s += step_s) {
        const double from_s = after ? window.last_s + apart_s : window.first_s - apart_s - length_s;
        if (after ? from_s >= covered.last_s : from_s + length_s <= covered.first_s)
            return std::nullopt;
        const std::optional<TimeSpan> sound = is_sound(TimeSpan{from_s, from_s + length_s});
        if (sound && (after ? sound->first_s >= window.last_s : sound->last_s <= window.first_s))
            return sound;
    }
}

}  // namespace

template <int Axes>
std::vector<Contradiction> contradictions_in(const AxesEstimate<Axes>& estimate,
                                             const FoundWindow& found,
                                             const CertifiableWindow& window) {
    constexpr double longer = 1.2;  // so that no end of the drift fills a span of its own
    const SpeedEvidence& evidence = window.evidence.value();
    const ArcMotion<Axes> motion(estimate.trajectory, estimate.rows[found.series]);
    const TimeSpan at{window.span.start.seconds(),
                      window.span.start.seconds() + window.span.duration.seconds()};
    const double window_s = at.last_s - at.first_s;
    PositionFigures<Axes> figures{.start_s = at.first_s, .end_s = at.last_s};
    figures.speed = speeds_of(evidence, 0.0).front();
    figures.speed.fault.probability = evidence.fault_probability;
    std::vector<Contradiction> contradictions;
    for (const WitnessedSpeed& one : window.witnesses) {
        // What only the suspicion makes a contradiction is no new one.
        const bool is_new =
            evidence.fault_probability < as_likely_as_not || one.chance_error.value_or(0.0) > 1.0;
        if (!doubts(one, window.witnesses.size()) && !(contradicts(one) && is_new)) continue;
        Contradiction& found_here = contradictions.emplace_back(
            Contradiction{.series = found.series,
                          .window = at,
                          .kind = one.kind,
                          .receiver = one.receiver,
                          .drift_m_s = one.apart_m / one.compared_over_s.value_or(window_s),
                          .sound_over_s = longer * window_s});
        const auto witness = std::ranges::find_if(estimate.witnesses, [&](const auto& each) {
            return is_same_witness(found_here, each);
        });
        if (witness == estimate.witnesses.end()) continue;
        const auto nearest = [&](bool after) {
            return nearest_sound(
                at, motion.covered(), found_here.sound_over_s, after,
                [&](const TimeSpan& span) -> std::optional<TimeSpan> {
                    const auto compared = compared_over(*witness, figures, motion, span);
                    if (!compared || !shows_sound(compared->speed, found_here.drift_m_s, window_s))
                        return std::nullopt;
                    return compared->span;
                });
        };
        if (const auto sound = nearest(true)) found_here.sound_from_s = sound->last_s;
        if (const auto sound = nearest(false)) found_here.sound_until_s = sound->first_s;
    }
    return contradictions;
}

const Contradiction* suspected_by(std::span<const Contradiction> contradictions,
                                  const FoundWindow& window,
                                  std::span<const WitnessedSpeed> witnesses) {
    const TimeSpan at{window.start.seconds(), window.end.seconds()};
    const double window_s = at.last_s - at.first_s;
    for (const Contradiction& one : contradictions) {
        const bool is_beyond = window_s <= one.sound_over_s &&
                               (at.last_s >= one.sound_from_s || at.first_s <= one.sound_until_s);
        if (window.series != one.series || is_beyond ||
            std::ranges::any_of(witnesses, [&](const WitnessedSpeed& each) {
                return is_same_witness(one, each) && shows_sound(each, one.drift_m_s, window_s);
            }))
            continue;
        return &one;
    }
    return nullptr;
}

bool suspect(std::span<const Contradiction> contradictions, const FoundWindow& window,
             std::span<const WitnessedSpeed> witnesses, WindowFault& fault) {
    if (const Contradiction* const by = suspected_by(contradictions, window, witnesses))
        fault.raise(
            as_likely_as_not, by->drift_m_s,
            fmt::format("the {} contradict the positions by {:.2f} m/s from {:.1f} s to "
                        "{:.1f} s, and have not shown them sound again up to this window",
                        words_of(by->kind), by->drift_m_s, by->window.first_s, by->window.last_s));
    else if (const auto one = std::ranges::find_if(
                 witnesses,
                 [&](const WitnessedSpeed& each) { return doubts(each, witnesses.size()); });
             one != witnesses.end() && std::ranges::none_of(witnesses, &contradicts))
        fault.raise(as_likely_as_not, std::abs(one->difference_m_s),
                    fmt::format("the {} differ from the positions by {:.2f} m/s in this window, "
                                "more than the uncertainties of both make in 95 of 100",
                                words_of(one->kind), std::abs(one->difference_m_s)));
    else
        return false;
    return true;
}

template std::vector<Contradiction> contradictions_in(const AxesEstimate<1>&, const FoundWindow&,
                                                      const CertifiableWindow&);
template std::vector<Contradiction> contradictions_in(const AxesEstimate<2>&, const FoundWindow&,
                                                      const CertifiableWindow&);

}  // namespace runcert

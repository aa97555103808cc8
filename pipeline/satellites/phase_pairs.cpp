#include "satellites/phase_pairs.h"

#include <utility>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
/// With fewer phases, the median is not that of the clock.
constexpr std::size_t fewest_for_median = 5;

bool same_band(std::size_t one, std::size_t other) {
    return one / 32 == other / 32;
}

template <class Counts>
std::size_t most_of_lowest_band(const Counts& counts) {
    std::size_t most = code_slots;
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0 &&
            (most == code_slots || (same_band(i, most) && counts[i] > counts[most])))
            most = i;
    return most;
}

template <class Counts>
std::size_t most_of_other_bands(const Counts& counts, std::size_t first) {
    std::size_t most = code_slots;
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0 && !same_band(i, first) &&
            (most == code_slots || counts[i] > counts[most]))
            most = i;
    return most;
}

}  // namespace

SignalChoice::SignalChoice(const PhaseRecord& record) {
    using Counts = std::array<std::int64_t, code_slots>;
    std::array<Counts, 7> of_system{};
    std::vector<Counts> of_satellite(satellite_slots);
    for (const PhaseSatellite& satellite : record.satellites)
        for (const PhaseSignal& signal : record.of(satellite)) {
            if (!(signal.phase_cycles == signal.phase_cycles) || signal.half_cycle) continue;
            ++of_system[static_cast<std::size_t>(satellite.id.system)][slot_of(signal.code)];
            ++of_satellite[slot_of(satellite.id)][slot_of(signal.code)];
        }
    for (std::size_t i = 0; i < of_system.size(); ++i)
        first_[i] = most_of_lowest_band(of_system[i]);
    for (std::size_t i = 0; i < satellite_slots; ++i)
        second_.push_back(most_of_other_bands(of_satellite[i], first_[i / 100]));
}

ChosenSignals PhasePairs::chosen_of(const PhaseSatellite& satellite) const {
    ChosenSignals chosen;
    for (std::size_t i = 0; i < satellite.signals; ++i) {
        const std::size_t number = satellite.first_signal + i;
        if (findings_[number].use != PhaseUse::used) continue;
        const SignalCode code = record_.signals[number].code;
        if (choice_.is_first(satellite.id, code)) chosen.first = number;
        if (choice_.is_second(satellite.id, code)) chosen.second = number;
    }
    return chosen;
}

std::vector<PhasePair> PhasePairs::at(std::size_t epoch) const {
    std::vector<PhasePair> pairs;
    const auto before = record_.of(record_.epochs[epoch - 1]);
    auto earlier = before.begin();
    for (const PhaseSatellite& now : record_.of(record_.epochs[epoch])) {
        while (earlier != before.end() && earlier->id < now.id)
            ++earlier;
        if (earlier == before.end()) break;
        if (earlier->id != now.id || earlier->issue != now.issue) continue;
        PhasePair pair;
        pair.before = &*earlier;
        pair.now = &now;
        pair.signals_before = chosen_of(*earlier);
        pair.signals_now = chosen_of(now);
        if (pair.signals_before.first == ChosenSignals::none ||
            pair.signals_now.first == ChosenSignals::none)
            continue;
        const PhaseSignal& signal = record_.signals[pair.signals_now.first];
        if (signal.loss_of_lock) continue;
        pair.wavelength_m = wavelength_m(now.id, signal.code);
        pairs.push_back(pair);
    }
    return pairs;
}

double PhasePairs::geometry_free_m(const PhaseSatellite& satellite,
                                   const ChosenSignals& chosen) const {
    if (chosen.first == ChosenSignals::none || chosen.second == ChosenSignals::none)
        return not_known;
    const PhaseSignal& first = record_.signals[chosen.first];
    const PhaseSignal& second = record_.signals[chosen.second];
    return wavelength_m(satellite.id, first.code) * first.phase_cycles -
           wavelength_m(satellite.id, second.code) * second.phase_cycles;
}

double PhasePairs::wide_lane_cycles(const PhaseSatellite& satellite,
                                    const ChosenSignals& chosen) const {
    if (chosen.first == ChosenSignals::none || chosen.second == ChosenSignals::none)
        return not_known;
    const PhaseSignal& first = record_.signals[chosen.first];
    const PhaseSignal& second = record_.signals[chosen.second];
    const double one_m = wavelength_m(satellite.id, first.code);
    const double two_m = wavelength_m(satellite.id, second.code);
    // Frequencies are proportional to inverse wavelengths.
    return first.phase_cycles - second.phase_cycles -
           (two_m - one_m) / (two_m + one_m) *
               (first.pseudorange_m / one_m + second.pseudorange_m / two_m);
}

double PhasePairs::geometry_free_change_m(const PhasePair& pair) const {
    const std::size_t second = pair.signals_now.second;
    if (second == ChosenSignals::none || record_.signals[second].loss_of_lock) return not_known;
    return geometry_free_m(*pair.now, pair.signals_now) -
           geometry_free_m(*pair.before, pair.signals_before);
}

std::vector<std::optional<double>> PhasePairs::beyond_doppler_cycles(
    const std::vector<PhasePair>& pairs, double step_s) const {
    std::vector<std::optional<double>> changes(pairs.size());
    std::vector<double> known_m;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const PhaseSignal& before = record_.signals[pairs[i].signals_before.first];
        const PhaseSignal& now = record_.signals[pairs[i].signals_now.first];
        const double change = now.phase_cycles - before.phase_cycles +
                              0.5 * step_s * (double{before.doppler_hz} + double{now.doppler_hz});
        if (!(change == change)) continue;
        changes[i] = change;
        known_m.push_back(change * pairs[i].wavelength_m);
    }
    if (known_m.size() < fewest_for_median) return std::vector<std::optional<double>>(pairs.size());
    const double common_m = median(std::move(known_m));
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (changes[i]) *changes[i] -= common_m / pairs[i].wavelength_m;
    return changes;
}

std::optional<PhaseDisplacement> PhasePairs::displacement(std::size_t epoch,
                                                          const std::vector<PhasePair>& pairs,
                                                          const PhaseNoise& noise) const {
    std::vector<PhaseChange> changes;
    for (const PhasePair& pair : pairs)
        changes.push_back({.satellite_m = {pair.before->position_m, pair.now->position_m},
                           .clock_m = {pair.before->clock_m, pair.now->clock_m},
                           .phase_m = pair.wavelength_m *
                                      (record_.signals[pair.signals_now.first].phase_cycles -
                                       record_.signals[pair.signals_before.first].phase_cycles)});
    return phase_displacement(changes, receiver_position(record_.epochs[epoch - 1].receiver_m),
                              step_s(epoch), noise);
}

}  // namespace runcert

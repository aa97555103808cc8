#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/random.h"
#include "satellites/phase_record.h"
#include "satellites/phase_screening.h"

namespace runcert::import_test {

/// The record with the first signal of each satellite alone.
inline PhaseRecord single_frequency(const PhaseRecord& record) {
    PhaseRecord single;
    for (PhaseEpoch epoch : record.epochs) {
        const std::size_t first = single.satellites.size();
        for (PhaseSatellite satellite : record.of(epoch)) {
            const PhaseSignal signal = record.of(satellite)[0];
            if (signal.code.band != 1) continue;
            satellite.first_signal = static_cast<std::uint32_t>(single.signals.size());
            satellite.signals = 1;
            single.signals.push_back(signal);
            single.satellites.push_back(satellite);
        }
        epoch.first_satellite = static_cast<std::uint32_t>(first);
        epoch.satellites = static_cast<std::uint16_t>(single.satellites.size() - first);
        single.epochs.push_back(epoch);
    }
    return single;
}

struct Trials {
    int count = 0;
    int found = 0;  ///< the slipped satellites, and no other
    int refused = 0;
    int wrong = 0;  ///< others, or nothing
    int repaired = 0, wrongly_repaired = 0;
};

/// Slips of so many satellites, `least` to `most` cycles each, are put into the phases at random
/// epochs that were clean, some epochs apart.
inline Trials inject(const PhaseRecord& clean, std::size_t satellites, int least, int most,
                     int trials, std::uint64_t seed) {
    const PhaseScreening before = screen_phases(clean, {});
    std::vector<bool> is_clean(clean.epochs.size(), true);
    for (const PhaseSlip& slip : before.slips)
        is_clean[slip.epoch] = false;
    for (const PhaseRefusal& refusal : before.refusals)
        is_clean[refusal.epoch] = false;
    for (const DisturbedPair& disturbed : before.disturbed)
        is_clean[disturbed.epoch] = false;
    RandomGenerator random(seed);
    const auto below = [&](std::size_t bound) {
        return std::min(bound - 1,
                        static_cast<std::size_t>(random.uniform() * static_cast<double>(bound)));
    };
    Trials result;
    PhaseScreeningConfig repairing;
    repairing.repair = true;
    while (result.count < trials) {
        PhaseRecord record = clean;
        struct Injected {
            std::size_t epoch;
            std::map<std::size_t, int> cycles;  ///< by signal at the epoch
        };
        std::vector<Injected> all;
        for (std::size_t epoch = 2 + below(8); epoch < clean.epochs.size(); epoch += 4 + below(8)) {
            if (!is_clean[epoch]) continue;
            // Signals whose arcs continue at this epoch.
            std::vector<std::size_t> going;
            for (const PhaseSatellite& satellite : clean.of(clean.epochs[epoch]))
                for (std::size_t i = 0; i < satellite.signals; ++i) {
                    const PhaseFinding& finding = before.findings[satellite.first_signal + i];
                    if (finding.arc > 0 && finding.begins == PhaseBreak::none && !finding.supports)
                        going.push_back(satellite.first_signal + i);
                }
            if (going.size() < satellites + 5) continue;
            Injected injected{.epoch = epoch, .cycles = {}};
            while (injected.cycles.size() < satellites) {
                const int size =
                    least + static_cast<int>(below(static_cast<std::size_t>(most - least + 1)));
                injected.cycles[going[below(going.size())]] = random.uniform() < 0.5 ? -size : size;
            }
            for (const auto& [signal, cycles] : injected.cycles) {
                // From here on, in all that follows of the satellite.
                Satellite id;
                for (const PhaseSatellite& satellite : clean.of(clean.epochs[epoch]))
                    if (satellite.first_signal == signal) id = satellite.id;
                for (std::size_t i = epoch; i < record.epochs.size(); ++i)
                    for (const PhaseSatellite& satellite : record.of(record.epochs[i]))
                        if (satellite.id == id)
                            record.signals[satellite.first_signal].phase_cycles += cycles;
            }
            all.push_back(std::move(injected));
        }
        const PhaseScreening after = screen_phases(record, {});
        const PhaseScreening repaired = screen_phases(record, repairing);
        for (const Injected& injected : all) {
            ++result.count;
            std::size_t right = 0, other = 0;
            for (const PhaseSlip& slip : after.slips)
                if (slip.epoch == injected.epoch)
                    ++(injected.cycles.contains(slip.signal) ? right : other);
            const bool refused = std::ranges::any_of(
                after.refusals, [&](const auto& each) { return each.epoch == injected.epoch; });
            if (refused)
                ++result.refused;
            else if (right == satellites && other == 0)
                ++result.found;
            else
                ++result.wrong;
            for (const PhaseSlip& slip : repaired.slips) {
                if (slip.epoch != injected.epoch || !slip.is_repaired) continue;
                ++result.repaired;
                const auto mine = injected.cycles.find(slip.signal);
                if (mine == injected.cycles.end() || std::lround(*slip.cycles) != mine->second)
                    ++result.wrongly_repaired;
            }
        }
    }
    return result;
}

}  // namespace runcert::import_test

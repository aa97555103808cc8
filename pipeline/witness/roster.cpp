#include "witness/roster.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace runcert {

const WitnessEntry& witness_entry(WitnessKind kind) {
    const auto found = std::ranges::find(witness_roster(), kind, &WitnessEntry::kind);
    assert(found != witness_roster().end());
    return *found;
}

std::optional<AssessedWitness<2>> handed_in_witness(const WitnessEntry& entry,
                                                    const HandedIn& given,
                                                    std::span<const TimedPosition<2>> positions,
                                                    const Track& track, double jerk_density,
                                                    std::span<const WitnessSource> sources,
                                                    const AntennaSwing& swing) {
    const auto series = given.series.find(std::string(to_text(entry.kind)));
    if (entry.make == nullptr || series == given.series.end()) return std::nullopt;
    const auto made = [&](std::span<const TimedPosition<2>> of_craft, const Track& track_of_it) {
        return entry.make({.series = series->second,
                           .attempt = given.attempt,
                           .positions = positions,
                           .of_craft = of_craft,
                           .track = track_of_it,
                           .jerk_density = jerk_density,
                           .sources = sources});
    };
    if (!swing.is_known()) return made(positions, track);
    auto witness = made(positions_of_craft(positions, swing), track_of_craft(track, swing));
    if (!witness || witness->is_copy) return witness;
    witness->motion = std::make_shared<const WitnessOfCraft>(std::move(witness->motion), swing);
    if (!witness->note.empty()) witness->note += ' ';
    witness->note += swing_text(words_of(entry.kind), swing);
    return witness;
}

}  // namespace runcert

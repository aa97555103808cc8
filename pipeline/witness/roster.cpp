#include "witness/roster.h"

#include <algorithm>
#include <cassert>

namespace runcert {

const WitnessEntry& witness_entry(WitnessKind kind) {
    const auto found = std::ranges::find(witness_roster(), kind, &WitnessEntry::kind);
    assert(found != witness_roster().end());
    return *found;
}

std::optional<HeardWitness<2>> handed_in_witness(const WitnessEntry& entry, const HandedIn& given,
                                                 std::span<const TimedPosition<2>> positions,
                                                 const Track& track, double jerk_density,
                                                 std::span<const WitnessSource> sources) {
    const auto series = given.series.find(std::string(to_text(entry.kind)));
    if (entry.make == nullptr || series == given.series.end()) return std::nullopt;
    return entry.make({.series = series->second,
                       .attempt = given.attempt,
                       .positions = positions,
                       .track = track,
                       .jerk_density = jerk_density,
                       .sources = sources});
}

}  // namespace runcert

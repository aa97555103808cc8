#include "witness/roster.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace runcert {

// What makes each of a series, in the file of its kind.
std::optional<HeardWitness<2>> heard_wheel(const HandedInSeries& given);
std::optional<HeardWitness<2>> heard_gates(const HandedInSeries& given);
std::optional<HeardWitness<2>> heard_speed_trap(const HandedInSeries& given);

namespace {

FaultPrior of_speeds(const FaultPrior& /*positions*/) {
    return {.probability = 0.01, .largest_m_s = 1.0};
}
FaultPrior of_phases(const FaultPrior& /*positions*/) {
    return {.probability = 0.001, .largest_m_s = 0.1};
}
FaultPrior of_survey(const FaultPrior& positions) {
    return {.probability = 0.001, .largest_m_s = positions.largest_m_s};
}
FaultPrior of_positions(const FaultPrior& positions) {
    return positions;
}

constexpr std::array all{
    WitnessEntry{
        .kind = WitnessKind::velocities,
        .fault = of_speeds,
        .silent = "nothing bounds their errors",
        .screening = ScreeningTest{.reason = Reason::velocity, .hypothesis = Hypothesis::velocity}},
    WitnessEntry{
        .kind = WitnessKind::phases,
        .fault = of_phases,
        .silent = "the positions have no times or no place on the Earth to compare them with",
        .screening = ScreeningTest{.reason = Reason::phase, .hypothesis = Hypothesis::phase}},
    WitnessEntry{.kind = WitnessKind::receiver,
                 .fault = of_positions,
                 .silent = "the two recordings have no common time or frame, or it has no estimate",
                 .screening = ScreeningTest{.reason = Reason::baseline,
                                            .hypothesis = Hypothesis::baseline,
                                            .only_fast = true}},
    WitnessEntry{.kind = WitnessKind::wheel,
                 .fault = of_speeds,
                 .silent =
                     "too few of them are at times at which the craft's motion was estimated, "
                     "or nothing bounds their errors",
                 .screening = ScreeningTest{.reason = Reason::wheel,
                                            .hypothesis = Hypothesis::wheel,
                                            .single_epochs = false,
                                            .only_fast = true},
                 .make = heard_wheel},
    WitnessEntry{.kind = WitnessKind::gates,
                 .fault = of_survey,
                 .silent = "fewer than two were passed while the craft's motion was estimated",
                 .make = heard_gates},
    WitnessEntry{.kind = WitnessKind::speed_trap,
                 .fault = of_speeds,
                 .silent = "none of them was measured while the craft's motion was estimated",
                 .make = heard_speed_trap}};

}  // namespace

std::span<const WitnessEntry> witness_roster() {
    return all;
}

const WitnessEntry& witness_entry(WitnessKind kind) {
    const auto found = std::ranges::find(all, kind, &WitnessEntry::kind);
    assert(found != all.end());
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

#include <cmath>
#include <memory>

#include "witness/kinds/gates.h"
#include "witness/roster.h"

// Speeds by a radar gun or a speed trap. Each is the mean over a stretch whose middle is passed at
// the given time. For a radar gun the stretch has zero length.

namespace runcert {
namespace {

/// Between measurements at most this far apart (s), the speed is interpolated linearly.
constexpr double longest_gap_s = 1.0;

/// The beginning and end of each measured stretch, as passages of gates. Their errors last: an
/// instrument that aims from the side, or is set up wrongly, errs by the same amount all the time.
std::vector<GatePassage> ends_of_stretches(const MeasuredSeries& series, const Track& track) {
    std::vector<GatePassage> ends;
    const SeriesSample* before = nullptr;
    for (const SeriesSample& one : series.samples) {
        if (!(one.value > 0.0)) continue;
        const double half_s = 0.5 * one.length_m / one.value;
        const auto first = passage_at(track, one.time_s - half_s);
        const auto last = passage_at(track, one.time_s + half_s);
        if (!first || !last) continue;
        GatePassage begin = *first;
        if (before != nullptr) {
            const GatePassage& end = ends.back();
            const double gap_s = begin.time_s - end.time_s;
            const double mean_m_s = 0.5 * (before->value + one.value);
            const double sigma_m_s =
                0.25 * (before->expanded_uncertainty_m_s + one.expanded_uncertainty_m_s);
            begin.stretch = end.stretch + (gap_s > longest_gap_s ? 1 : 0);
            begin.distance_m = end.distance_m + gap_s * mean_m_s;
            begin.lasting_sigma_m = end.lasting_sigma_m + std::abs(gap_s) * sigma_m_s;
            begin.variance_m2 =
                end.variance_m2 + std::pow(sigma_jerk_m_s3 * gap_s * gap_s * gap_s / 12.0, 2);
        }
        ends.push_back(begin);
        before = &one;
        if (!(half_s > 0.0)) continue;
        GatePassage end = *last;
        end.stretch = begin.stretch;
        end.distance_m = begin.distance_m + one.length_m;
        end.lasting_sigma_m = begin.lasting_sigma_m + half_s * one.expanded_uncertainty_m_s;
        end.variance_m2 = begin.variance_m2;
        ends.push_back(end);
    }
    return ends;
}

}  // namespace

namespace witnesses {
namespace {

std::optional<AssessedWitness<2>> make_speed_trap(const HandedInSeries& given) {
    std::vector<GatePassage> ends = ends_of_stretches(given.series, given.track);
    if (ends.empty()) return std::nullopt;
    const std::vector<Way> ways = ways_between(ends);
    const std::vector<TimedValue> speeds_m_s = timed_values(given.series);
    const bool made = made_from(ways, given.positions) ||
                      made_from(speeds_m_s, given.positions) == VelocityOrigin::positions;
    auto original = source_of(ways, given.sources);
    if (!original) original = source_of(speeds_m_s, given.sources, 0.0);
    return AssessedWitness<2>{
        .kind = WitnessKind::speed_trap,
        .motion = std::make_shared<const GateWitness>(std::move(ends), GateErrors{}),
        .note = made       ? "The speeds of the radar gun or speed trap keep to the positions more "
                             "closely than measured ones do: they were made from them, and were not "
                             "heard."
                : original ? copy_text("speeds of the radar gun or speed trap", *original)
                           : "",
        .is_copy = made || original};
}

FaultPrior fault_of_speed_trap(const FaultPrior& /*positions*/) {
    return faults_of_speeds;
}

}  // namespace

extern const WitnessEntry speed_trap{
    .kind = WitnessKind::speed_trap,
    .fault = fault_of_speed_trap,
    .silent = "none of them was measured while the craft's motion was estimated",
    .remedy = "Check the instrument's calibration, its angle to the course, and its clock.",
    .make = make_speed_trap};

}  // namespace witnesses
}  // namespace runcert

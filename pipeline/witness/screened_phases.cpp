#include "witness/screened_phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/statistics.h"
#include "witness/phase_witness.h"

namespace runcert {
namespace {

/// Positions further apart in time are not interpolated.
constexpr std::int64_t interpolated_ns = 3'000'000'000;
/// Pseudoranges place a receiver to some metres. If they differ by more than this, it was another
/// one.
constexpr double same_receiver_m = 100.0;
constexpr std::size_t positions_compared = 20;

[[noreturn]] void fail_out_of_step(const std::string& what) {
    throw Failure("3-phase.ecsv", what, "Run runcert-screen again");
}

/// What begins an arc, in estimation and in the table.
constexpr std::array<std::pair<PhaseBreak, ArcStart>, 8> arc_starts{
    {{PhaseBreak::start, ArcStart::start},
     {PhaseBreak::gap, ArcStart::gap},
     {PhaseBreak::lost_lock, ArcStart::lost_lock},
     {PhaseBreak::ephemeris, ArcStart::ephemeris},
     {PhaseBreak::geometry_free, ArcStart::geometry_free},
     {PhaseBreak::displacement, ArcStart::displacement},
     {PhaseBreak::uncontrolled, ArcStart::uncontrolled},
     {PhaseBreak::refused, ArcStart::refused}}};

PhaseBreak break_of(ArcStart start) {
    for (const auto& [own, word] : arc_starts)
        if (word == start) return own;
    return PhaseBreak::none;
}

}  // namespace

std::optional<ArcStart> start_of(PhaseBreak begins) {
    for (const auto& [own, word] : arc_starts)
        if (own == begins) return word;
    return std::nullopt;
}

void ReceiverTrack::add(const PlaceFrames& frames, const GpsTime& first_epoch,
                        const EnuEpoch& row) {
    if (!row.east_m || !row.north_m || !row.up_m) return;
    const std::int64_t time_ns = first_epoch.nanoseconds() + row.time.nanoseconds;
    positions_m_.emplace_back(time_ns,
                              frames.ecef(row.time, {*row.east_m, *row.north_m, *row.up_m}).m);
}

void ReceiverTrack::put_in_order() {
    const auto time_of = [](const auto& position) { return position.first; };
    std::ranges::stable_sort(positions_m_, {}, time_of);
    const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
    positions_m_.erase(std::unique(positions_m_.begin(), positions_m_.end(), same),
                       positions_m_.end());
}

std::optional<Eigen::Vector3d> ReceiverTrack::at(std::int64_t time_ns) const {
    const auto time_of = [](const auto& position) { return position.first; };
    const auto after = std::ranges::lower_bound(positions_m_, time_ns, {}, time_of);
    if (after == positions_m_.end()) return std::nullopt;
    if (after->first == time_ns) return after->second;
    if (after == positions_m_.begin()) return std::nullopt;
    const auto& [before_ns, before_m] = *std::prev(after);
    if (after->first - before_ns > interpolated_ns) return std::nullopt;
    const double share =
        static_cast<double>(time_ns - before_ns) / static_cast<double>(after->first - before_ns);
    return before_m + share * (after->second - before_m);
}

PhasePositions set_receiver_positions(PhaseRecord& record, std::int64_t first_ns,
                                      const ReceiverTrack& positions) {
    std::vector<double> apart_m;
    const std::size_t stride = std::max<std::size_t>(1, record.epochs.size() / positions_compared);
    for (std::size_t i = 0; i < record.epochs.size(); i += stride) {
        const auto place_m = positions.at(first_ns + record.epochs[i].time_ns);
        if (!place_m) continue;
        if (const auto solved_m = position_by_pseudoranges(record, record.epochs[i], *place_m))
            apart_m.push_back((*solved_m - *place_m).norm());
    }
    PhasePositions result;
    if (!apart_m.empty()) result.apart_m = median(std::move(apart_m));
    result.by_positions = result.apart_m.value_or(0.0) <= same_receiver_m;
    if (result.by_positions)
        for (PhaseEpoch& epoch : record.epochs)
            if (const auto place_m = positions.at(first_ns + epoch.time_ns))
                epoch.receiver_m = *place_m;
    locate_by_pseudoranges(record);
    return result;
}

PhaseScreeningBuilder::PhaseScreeningBuilder(const PhaseRecord& record,
                                             const ScreenedPhaseTable& head, double mask_deg)
    : record_(record), choice_(record) {
    screening_.findings.resize(record.signals.size());
    screening_.clock_m = receiver_clocks_m(record, mask_deg);
    screening_.noise.white_m = head.noise.white_m;
    screening_.noise.pairs = head.noise.pairs;
    screening_.pairs = head.pairs;
}

void PhaseScreeningBuilder::step_to_next() {
    ++signal_;
    const PhaseSatellite& satellite = record_.satellites[satellite_];
    if (signal_ < satellite.first_signal + satellite.signals) return;
    ++satellite_;
    const PhaseEpoch& epoch = record_.epochs[epoch_];
    if (satellite_ == epoch.first_satellite + epoch.satellites) ++epoch_;
}

void PhaseScreeningBuilder::add(const ScreenedPhase& row) {
    if (signal_ >= record_.signals.size()) fail_out_of_step("it has more rows than 1-phase.ecsv");
    const PhaseSatellite& satellite = record_.satellites[satellite_];
    const PhaseEpoch& epoch = record_.epochs[epoch_];
    if (row.epoch != epoch.number || row.satellite != satellite.id ||
        row.signal != record_.signals[signal_].code)
        fail_out_of_step(fmt::format("its row {} is not of the signal of that row of 1-phase.ecsv",
                                     signal_ + 1));
    PhaseFinding& finding = screening_.findings[signal_];
    finding.supports = !choice_.is_first(satellite.id, row.signal);
    if (row.standing == PhaseStanding::used) finding.use = PhaseUse::used;
    finding.arc = static_cast<std::int32_t>(row.arc.value_or(0));
    finding.correction = static_cast<std::int32_t>(row.correction.value_or(0));
    if (row.begins) finding.begins = break_of(*row.begins);
    if (row.statistic)
        screening_.slips.push_back({.signal = signal_,
                                    .epoch = epoch_,
                                    .test = finding.begins,
                                    .statistic = *row.statistic,
                                    .threshold = row.threshold.value_or(0.0)});
    if (finding.begins == PhaseBreak::refused &&
        (screening_.refusals.empty() || screening_.refusals.back().epoch != epoch_))
        screening_.refusals.push_back({.epoch = epoch_});
    step_to_next();
}

PhaseScreening PhaseScreeningBuilder::take() && {
    if (signal_ != record_.signals.size()) fail_out_of_step("it has fewer rows than 1-phase.ecsv");
    return std::move(screening_);
}

}  // namespace runcert

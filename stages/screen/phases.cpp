#include "stages/screen/phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/geodesy.h"
#include "core/statistics.h"
#include "core/text.h"
#include "estimation/phase_witness.h"
#include "satellites/line_of_sight.h"

namespace runcert {
namespace {

constexpr std::size_t listed_at_most = 1000;
/// Positions further apart in time than this are not interpolated between.
constexpr std::int64_t interpolated_ns = 3'000'000'000;
/// Windows and places that are compared, spread over the recording.
constexpr std::size_t compared = 500;
constexpr std::int64_t window_ns = 3'000'000'000;
constexpr std::size_t least_compared = 10;
/// Pseudoranges place a receiver to some metres; further apart it was another.
constexpr double same_place_m = 100.0;
/// A motion is another where the median window differs by so much (m), and by this share of it.
constexpr double other_motion_m = 0.5;
constexpr double other_motion_share = 0.1;

constexpr std::array standings{PhaseStanding::used,     PhaseStanding::no_phase,
                               PhaseStanding::no_orbit, PhaseStanding::unhealthy,
                               PhaseStanding::low,      PhaseStanding::half_cycle};
constexpr std::array starts{ArcStart::start,        ArcStart::gap,           ArcStart::lost_lock,
                            ArcStart::ephemeris,    ArcStart::geometry_free, ArcStart::displacement,
                            ArcStart::uncontrolled, ArcStart::refused};
constexpr std::array refusals{RefusalWord::few_satellites, RefusalWord::no_single_set,
                              RefusalWord::no_place};

/// Where the recorded positions put the receiver, by GPS time.
class Positions {
  public:
    explicit Positions(const EnuTable& table) {
        if (!table.origin || !table.facts.first_epoch) return;
        const Geodetic& origin = table.origin->position;
        const Eigen::Vector3d origin_m = ecef_from_geodetic(origin).m;
        const Eigen::Matrix3d ecef_from_enu =
            rotation_enu_from_ecef(origin.latitude, origin.longitude).transpose();
        for (const EnuEpoch& row : table.rows) {
            if (!row.east_m || !row.north_m || !row.up_m) continue;
            const std::int64_t time_ns =
                table.facts.first_epoch->nanoseconds() + row.time.nanoseconds;
            if (!times_ns_.empty() && time_ns <= times_ns_.back()) continue;
            times_ns_.push_back(time_ns);
            places_m_.push_back(
                origin_m + ecef_from_enu * Eigen::Vector3d(*row.east_m, *row.north_m, *row.up_m));
        }
    }

    bool empty() const { return times_ns_.empty(); }

    /// Interpolated between neighbours; nothing outside of them.
    std::optional<Eigen::Vector3d> at(std::int64_t time_ns) const {
        const auto after = std::ranges::lower_bound(times_ns_, time_ns);
        if (after == times_ns_.end()) return std::nullopt;
        const auto i = static_cast<std::size_t>(after - times_ns_.begin());
        if (*after == time_ns) return places_m_[i];
        if (i == 0 || *after - times_ns_[i - 1] > interpolated_ns) return std::nullopt;
        const double share = static_cast<double>(time_ns - times_ns_[i - 1]) /
                             static_cast<double>(*after - times_ns_[i - 1]);
        return places_m_[i - 1] + share * (places_m_[i] - places_m_[i - 1]);
    }

  private:
    std::vector<std::int64_t> times_ns_;
    std::vector<Eigen::Vector3d> places_m_;
};

std::string metres(double value_m) {
    return value_m >= 10'000.0 ? format_fixed(value_m / 1000.0, 0) + " km"
                               : format_fixed(value_m, value_m >= 100.0 ? 0 : 2) + " m";
}

/// Puts the receiver where its positions say, unless its pseudoranges say somewhere else.
void set_places(PhaseRecord& record, std::int64_t first_ns, const Positions& positions,
                std::vector<std::string>& notes) {
    std::vector<double> apart_m;
    const std::size_t stride = std::max<std::size_t>(1, record.epochs.size() / 20);
    for (std::size_t i = 0; i < record.epochs.size(); i += stride) {
        const auto place_m = positions.at(first_ns + record.epochs[i].time_ns);
        if (!place_m) continue;
        if (const auto solved_m = place_by_pseudoranges(record, record.epochs[i], *place_m))
            apart_m.push_back((*solved_m - *place_m).norm());
    }
    const double typical_m = apart_m.empty() ? 0.0 : median(apart_m);
    if (typical_m > same_place_m)
        notes.push_back(
            fmt::format("By the raw measurements the receiver was {} away from its recorded "
                        "positions: they are "
                        "another receiver's, or another time's.",
                        metres(typical_m)));
    else
        for (PhaseEpoch& epoch : record.epochs)
            if (const auto place_m = positions.at(first_ns + epoch.time_ns))
                epoch.receiver_m = *place_m;
    locate_by_pseudoranges(record);
}

/// The motion by phases beside that of the positions.
MotionComparison compare_motion(const PhaseRecord& record, const PhaseScreening& screening,
                                std::int64_t first_ns, const Positions& positions) {
    MotionComparison result;
    result.length_s = static_cast<double>(window_ns) * 1e-9;
    std::vector<double> differences_m, displacements_m;
    const std::size_t stride = std::max<std::size_t>(1, record.epochs.size() / compared);
    for (std::size_t a = 0; a < record.epochs.size(); a += stride) {
        const auto b = epoch_after(record, a, window_ns);
        if (!b) continue;
        const auto from_m = positions.at(first_ns + record.epochs[a].time_ns);
        const auto to_m = positions.at(first_ns + record.epochs[*b].time_ns);
        if (!from_m || !to_m) continue;
        const auto moved = displacement_between(record, screening, a, *b);
        if (!moved) continue;
        const Eigen::Vector3d by_positions_m =
            receiver_place(*from_m).enu_from_ecef * (*to_m - *from_m);
        differences_m.push_back((moved->enu_m - by_positions_m).head<2>().norm());
        displacements_m.push_back(by_positions_m.head<2>().norm());
    }
    result.windows = std::ssize(differences_m);
    if (differences_m.empty()) return result;
    result.median_difference_m = median(std::move(differences_m));
    result.median_displacement_m = median(std::move(displacements_m));
    if (result.windows < static_cast<std::int64_t>(least_compared)) return result;
    const bool other = *result.median_difference_m >
                       std::max(other_motion_m, other_motion_share * *result.median_displacement_m);
    result.outcome = other ? PhaseMotion::contradicts : PhaseMotion::agrees;
    return result;
}

void note_motion(const MotionComparison& motion, bool any_position,
                 std::vector<std::string>& notes) {
    switch (motion.outcome) {
        case PhaseMotion::agrees:
            return;
        case PhaseMotion::contradicts:
            notes.push_back(fmt::format(
                "The phases show another motion than the positions: over {} s they differ by {} "
                "(median of {} windows). They are of another receiver or another time, or a clock "
                "is off by seconds.",
                format_fixed(motion.length_s, 0), metres(*motion.median_difference_m),
                motion.windows));
            return;
        case PhaseMotion::not_enough:
            notes.push_back(
                any_position
                    ? fmt::format("Only {} windows of {} s have both positions and unbroken "
                                  "phases: not enough to judge the motion by.",
                                  motion.windows, format_fixed(motion.length_s, 0))
                    : std::string("The positions have no times or no place on the Earth that the "
                                  "phases could be compared with."));
            return;
    }
}

double seconds_of(const PhaseRecord& record, std::size_t epoch) {
    return static_cast<double>(record.epochs[epoch].time_ns) * 1e-9;
}

void list_findings(const PhaseRecord& record, const PhaseScreening& screening,
                   ScreenedPhaseTable& head) {
    head.pairs = screening.pairs;
    head.noise = {.pairs = screening.noise.pairs,
                  .white_m = screening.noise.white_m,
                  .geometry_free_m = screening.noise.geometry_free_m,
                  .wide_lane_cycles = screening.noise.wide_lane_cycles,
                  .doppler_cycles = screening.noise.doppler_cycles};
    head.slips = std::ssize(screening.slips);
    head.repaired = std::ranges::count_if(screening.slips, &PhaseSlip::is_repaired);
    head.disturbed = std::ssize(screening.disturbed);
    head.refusals = std::ssize(screening.refusals);
    for (const PhaseRefusal& refusal : screening.refusals) {
        if (head.refused_pairs.size() >= listed_at_most) break;
        head.refused_pairs.push_back({.epoch = record.epochs[refusal.epoch].number,
                                      .time_s = seconds_of(record, refusal.epoch),
                                      .reason = refusals[static_cast<std::size_t>(refusal.reason)],
                                      .satellites = static_cast<std::int64_t>(refusal.satellites),
                                      .statistic = refusal.statistic,
                                      .threshold = refusal.threshold});
    }
    for (const ClockJump& jump : screening.jumps) {
        if (head.clock_jumps.size() >= listed_at_most) break;
        head.clock_jumps.push_back({.epoch = record.epochs[jump.epoch].number,
                                    .time_s = seconds_of(record, jump.epoch),
                                    .milliseconds = jump.milliseconds});
    }
}

}  // namespace

PhaseScreeningConfig phase_screening_config(const Attempt& attempt) {
    const nlohmann::ordered_json& parameters = attempt.parameters.at("screen");
    PhaseScreeningConfig config;
    config.mask_deg = parameters.at("phase_mask_deg");
    config.repair = parameters.at("phase_slips") == "repair";
    return config;
}

ScreenedPhases screen_receiver_phases(const PhaseTable& head, PhaseRecord record,
                                      const EnuTable& table, const PhaseScreeningConfig& config) {
    ScreenedPhases result;
    result.record = std::move(record);
    result.head.receiver = head.receiver;
    result.head.first_epoch = head.first_epoch;
    result.head.epochs = std::ssize(result.record.epochs);
    const Positions positions(table);
    const std::int64_t first_ns = head.first_epoch.nanoseconds();
    set_places(result.record, first_ns, positions, result.head.notes);
    result.screening = screen_phases(result.record, config);
    list_findings(result.record, result.screening, result.head);
    result.head.motion = compare_motion(result.record, result.screening, first_ns, positions);
    note_motion(result.head.motion, !positions.empty(), result.head.notes);
    return result;
}

void give_screened_rows(const ScreenedPhases& screened,
                        const std::function<void(const ScreenedPhase& row)>& take) {
    const PhaseRecord& record = screened.record;
    auto slip = screened.screening.slips.begin();
    ScreenedPhase row;
    for (const PhaseEpoch& epoch : record.epochs)
        for (const PhaseSatellite& satellite : record.of(epoch))
            for (std::size_t i = 0; i < satellite.signals; ++i) {
                const std::size_t number = satellite.first_signal + i;
                const PhaseFinding& finding = screened.screening.findings[number];
                row = {};
                row.epoch = epoch.number;
                row.time.nanoseconds = epoch.time_ns;
                row.satellite = satellite.id;
                row.signal = record.signals[number].code;
                row.standing = standings[static_cast<std::size_t>(finding.use)];
                if (finding.arc > 0) row.arc = finding.arc;
                if (finding.begins != PhaseBreak::none)
                    row.begins = starts[static_cast<std::size_t>(finding.begins) - 1];
                if (finding.correction != 0) row.correction = finding.correction;
                if (slip != screened.screening.slips.end() && slip->signal == number) {
                    row.statistic = slip->statistic;
                    row.threshold = slip->threshold;
                    row.cycles = slip->cycles;
                    row.sigma_cycles = slip->sigma_cycles;
                    row.wide_lane_cycles = slip->wide_lane_cycles;
                    row.beyond_doppler_cycles = slip->beyond_doppler_cycles;
                    ++slip;
                }
                take(row);
            }
}

}  // namespace runcert

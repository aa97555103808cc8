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
#include "schemas/enu/measured_position.h"
#include "stages/screen/time_order.h"
#include "witness/phase_witness.h"
#include "witness/screened_phases.h"
#include "witness/witnessed_spans.h"

namespace runcert {
namespace {

constexpr std::size_t listed_at_most = 1000;
/// Length of the windows compared.
constexpr double window_s = 3.0;
constexpr std::int64_t least_compared = 10;

constexpr std::array standings{PhaseStanding::used,     PhaseStanding::no_phase,
                               PhaseStanding::no_orbit, PhaseStanding::unhealthy,
                               PhaseStanding::low,      PhaseStanding::half_cycle};
constexpr std::array refusals{RefusalWord::few_satellites, RefusalWord::no_single_set,
                              RefusalWord::no_place};

std::string metres(double value_m) {
    return value_m >= 10'000.0 ? format_fixed(value_m / 1000.0, 0) + " km"
                               : format_fixed(value_m, value_m >= 100.0 ? 0 : 2) + " m";
}

void note_receiver(const PhasePositions& places, std::vector<std::string>& notes) {
    if (places.by_positions || !places.apart_m) return;
    notes.push_back(
        fmt::format("By the raw measurements the receiver was {} away from its recorded "
                    "positions: they are another receiver's, or another time's.",
                    metres(*places.apart_m)));
}

/// Positions of a recording unchanged, in order of time.
std::vector<TimedPosition<2>> recorded_positions(const EnuTable& table) {
    const TimeOrder order =
        order_by_time(table.rows, {.interval_s = table.facts.nominal_interval_s});
    std::vector<TimedPosition<2>> positions;
    for (const std::size_t k : order.rows) {
        const EnuEpoch& row = table.rows[k];
        if (!row.east_m || !row.north_m || order.standing[k] != TimeStanding::in_order) continue;
        positions.push_back({.time_s = row.time.seconds(),
                             .position = measured_position<2>(row),
                             .sigma_m = 0.0,
                             .stretch = 0});
    }
    return positions;
}

/// The motion by phases compared with that by positions.
MotionComparison compare_with(const EnuTable& table, const std::optional<PhaseWitness<2>>& phases) {
    MotionComparison result;
    result.length_s = window_s;
    if (!phases) return result;
    const WitnessedMotionComparison found =
        compare_motion(recorded_positions(table), *phases, window_s);
    result.windows = found.spans;
    if (found.spans == 0) return result;
    result.median_difference_m = found.median_difference_m;
    result.median_displacement_m = found.median_displacement_m;
    if (found.spans < least_compared) return result;
    result.outcome = found.contradicts ? PhaseMotion::contradicts : PhaseMotion::agrees;
    if (found.positions_ahead_s)
        result.positions_ahead_s = static_cast<double>(*found.positions_ahead_s);
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
                "(median of {} windows). {}",
                format_fixed(motion.length_s, 0), metres(*motion.median_difference_m),
                motion.windows,
                motion.positions_ahead_s
                    ? fmt::format(
                          "The clock of the positions is {} s {} that of the phases: shifted "
                          "by this the two agree.",
                          std::lround(std::abs(*motion.positions_ahead_s)),
                          *motion.positions_ahead_s > 0 ? "ahead of" : "behind")
                    : std::string("They are of another receiver or another time.")));
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
    const ScreenParameters& parameters = attempt.parameters.screen;
    PhaseScreeningConfig config;
    config.mask_deg = parameters.phase_mask_deg;
    config.repair = parameters.phase_slips == SlipTreatment::repair;
    return config;
}

ScreenedPhases screen_receiver_phases(const PhaseTable& head, PhaseRecord record,
                                      const EnuTable& table, const PhaseScreeningConfig& config) {
    ScreenedPhases result;
    result.head.receiver = head.receiver;
    result.head.first_epoch = head.first_epoch;
    result.head.epochs = std::ssize(record.epochs);
    const ReceiverTrack positions(table.origin, table.facts.first_epoch, table.rows);
    const std::int64_t first_ns = head.first_epoch.nanoseconds();
    note_receiver(set_receiver_positions(record, first_ns, positions), result.head.notes);
    PhaseScreening screening = screen_phases(record, config);
    list_findings(record, screening, result.head);
    result.phases = std::make_shared<const JudgedPhases>(
        JudgedPhases{.record = std::move(record), .screening = std::move(screening)});
    result.head.motion = compare_with(table, result.witness<2>(table, 0.0));
    note_motion(result.head.motion, !positions.empty(), result.head.notes);
    return result;
}

void give_screened_rows(const ScreenedPhases& screened,
                        const std::function<void(const ScreenedPhase& row)>& take) {
    const auto& [record, screening] = *screened.phases;
    auto slip = screening.slips.begin();
    ScreenedPhase row;
    for (const PhaseEpoch& epoch : record.epochs)
        for (const PhaseSatellite& satellite : record.of(epoch))
            for (std::size_t i = 0; i < satellite.signals; ++i) {
                const std::size_t number = satellite.first_signal + i;
                const PhaseFinding& finding = screening.findings[number];
                row = {};
                row.epoch = epoch.number;
                row.time.nanoseconds = epoch.time_ns;
                row.satellite = satellite.id;
                row.signal = record.signals[number].code;
                row.standing = standings[static_cast<std::size_t>(finding.use)];
                if (finding.arc > 0) row.arc = finding.arc;
                row.begins = start_of(finding.begins);
                if (finding.correction != 0) row.correction = finding.correction;
                if (slip != screening.slips.end() && slip->signal == number) {
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

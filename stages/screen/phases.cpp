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
#include "estimation/tables/screened_phases.h"
#include "satellites/line_of_sight.h"

namespace runcert {
namespace {

constexpr std::size_t listed_at_most = 1000;
/// Windows and places that are compared, spread over the recording.
constexpr std::size_t compared = 500;
constexpr std::int64_t window_ns = 3'000'000'000;
constexpr std::size_t least_compared = 10;
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

std::string metres(double value_m) {
    return value_m >= 10'000.0 ? format_fixed(value_m / 1000.0, 0) + " km"
                               : format_fixed(value_m, value_m >= 100.0 ? 0 : 2) + " m";
}

void note_place(const PlacesSet& places, std::vector<std::string>& notes) {
    if (places.by_positions || !places.apart_m) return;
    notes.push_back(
        fmt::format("By the raw measurements the receiver was {} away from its recorded "
                    "positions: they are another receiver's, or another time's.",
                    metres(*places.apart_m)));
}

/// A window's horizontal displacement by phases, and its ends by GPS time.
struct PhaseWindow {
    std::int64_t from_ns = 0, to_ns = 0;
    Eigen::Vector2d moved_m = Eigen::Vector2d::Zero();
};

std::vector<PhaseWindow> windows_of(const JudgedPhases& phases, std::int64_t first_ns) {
    std::vector<PhaseWindow> windows;
    const auto& epochs = phases.record.epochs;
    const std::size_t stride = std::max<std::size_t>(1, epochs.size() / compared);
    for (std::size_t a = 0; a < epochs.size(); a += stride) {
        const auto b = epoch_after(phases.record, a, window_ns);
        if (!b) continue;
        if (const auto moved = displacement_between(phases.record, phases.screening, a, *b))
            windows.push_back({.from_ns = first_ns + epochs[a].time_ns,
                               .to_ns = first_ns + epochs[*b].time_ns,
                               .moved_m = moved->enu_m.head<2>()});
    }
    return windows;
}

/// The displacements of the windows beside those of the positions so much later.
MotionComparison compare_windows(const std::vector<PhaseWindow>& windows,
                                 const ReceiverPlaces& positions, std::int64_t later_ns) {
    MotionComparison result;
    result.length_s = static_cast<double>(window_ns) * 1e-9;
    std::vector<double> differences_m, displacements_m;
    for (const PhaseWindow& window : windows) {
        const auto from_m = positions.at(window.from_ns + later_ns);
        const auto to_m = positions.at(window.to_ns + later_ns);
        if (!from_m || !to_m) continue;
        const Eigen::Vector3d by_positions_m =
            receiver_place(*from_m).enu_from_ecef * (*to_m - *from_m);
        differences_m.push_back((window.moved_m - by_positions_m.head<2>()).norm());
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

/// By how many whole seconds the positions' clock is ahead of the phases', if shifted by these the
/// two agree: leap seconds, or a clock set wrongly.
std::optional<std::int64_t> seconds_ahead(const std::vector<PhaseWindow>& windows,
                                          const ReceiverPlaces& positions, double unshifted_m) {
    constexpr std::int64_t farthest_s = 60;
    constexpr double much_better = 0.2;
    std::optional<std::int64_t> best;
    double least_m = much_better * unshifted_m;
    for (std::int64_t shift_s = -farthest_s; shift_s <= farthest_s; ++shift_s) {
        const MotionComparison shifted =
            compare_windows(windows, positions, shift_s * 1'000'000'000);
        if (shifted.outcome != PhaseMotion::agrees || *shifted.median_difference_m >= least_m)
            continue;
        least_m = *shifted.median_difference_m;
        best = shift_s;
    }
    return best;
}

/// The motion by phases beside that of the positions.
MotionComparison compare_motion(const JudgedPhases& phases, std::int64_t first_ns,
                                const ReceiverPlaces& positions) {
    const std::vector<PhaseWindow> windows = windows_of(phases, first_ns);
    MotionComparison result = compare_windows(windows, positions, 0);
    if (result.outcome == PhaseMotion::contradicts)
        if (const auto ahead_s = seconds_ahead(windows, positions, *result.median_difference_m))
            result.positions_ahead_s = *ahead_s;
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
                          std::abs(*motion.positions_ahead_s),
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
    const nlohmann::ordered_json& parameters = attempt.parameters.at("screen");
    PhaseScreeningConfig config;
    config.mask_deg = parameters.at("phase_mask_deg");
    config.repair = parameters.at("phase_slips") == "repair";
    return config;
}

ScreenedPhases screen_receiver_phases(const PhaseTable& head, PhaseRecord record,
                                      const EnuTable& table, const PhaseScreeningConfig& config) {
    ScreenedPhases result;
    result.head.receiver = head.receiver;
    result.head.first_epoch = head.first_epoch;
    result.head.epochs = std::ssize(record.epochs);
    const ReceiverPlaces positions(table.origin, table.facts.first_epoch, table.rows);
    const std::int64_t first_ns = head.first_epoch.nanoseconds();
    note_place(set_places(record, first_ns, positions), result.head.notes);
    PhaseScreening screening = screen_phases(record, config);
    list_findings(record, screening, result.head);
    result.phases = std::make_shared<const JudgedPhases>(
        JudgedPhases{.record = std::move(record), .screening = std::move(screening)});
    result.head.motion = compare_motion(*result.phases, first_ns, positions);
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
                if (finding.begins != PhaseBreak::none)
                    row.begins = starts[static_cast<std::size_t>(finding.begins) - 1];
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

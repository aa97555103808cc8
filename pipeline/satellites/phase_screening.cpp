#include "satellites/phase_screening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/angle.h"
#include "core/statistics.h"
#include "satellites/phase_displacement.h"
#include "satellites/phase_judgement.h"
#include "satellites/phase_pairs.h"
#include "satellites/phase_subsets.h"
#include "satellites/troposphere.h"

namespace runcert {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
/// Ratio of the standard deviation of a normal variable to the median of its absolute value.
constexpr double deviations_per_median = 1.4826;
constexpr double least_white_m = 0.0008;
/// Largest number of epoch pairs used to estimate noise, spread over the record.
constexpr std::size_t noise_pairs = 2000;
constexpr std::size_t fewest_satellites = 5;
constexpr double millisecond_m = 1e-3 * speed_of_light_m_s;
constexpr int wide_lane_epochs = 30;
constexpr double repair_from_whole = 0.25;
constexpr double repair_sigma_cycles = 0.12;

/// State of a satellite that is carried from epoch to epoch.
struct Track {
    struct Signal {
        std::int32_t arc = 0;
        std::int32_t correction = 0;
        std::size_t epoch = 0;  ///< last epoch at which it was used
    };
    std::map<std::size_t, Signal> signals;  ///< by code
    Signal* first = nullptr;
    Signal* second = nullptr;
    double wide_lane_mean = 0.0;
    int wide_lane_count = 0;
};

class Screen {
  public:
    Screen(const PhaseRecord& record, const PhaseScreeningConfig& config)
        : record_(record),
          config_(config),
          pairs_(record, result_.findings),
          bounds_(config.significance),
          least_sine_(std::sin(config.mask_deg * radians_per_degree)),
          tracks_(satellite_slots) {
        result_.findings.resize(record.signals.size());
    }

    PhaseScreening run() {
        classify();
        solve_clocks();
        estimate_noise();
        for (std::size_t i = 0; i < record_.epochs.size(); ++i)
            step(i);
        return std::move(result_);
    }

  private:
    /// Decides for each phase on its own whether it is used.
    void classify() {
        for (const PhaseEpoch& epoch : record_.epochs)
            for (const PhaseSatellite& satellite : record_.of(epoch)) {
                const bool low = !(satellite.sine_of_elevation >= least_sine_);
                for (std::size_t i = 0; i < satellite.signals; ++i) {
                    const std::size_t number = satellite.first_signal + i;
                    const PhaseSignal& signal = record_.signals[number];
                    PhaseFinding& finding = result_.findings[number];
                    finding.supports = !pairs_.choice().is_first(satellite.id, signal.code);
                    finding.use = !(signal.phase_cycles == signal.phase_cycles) ? PhaseUse::no_phase
                                  : !satellite.has_orbit()                      ? PhaseUse::no_orbit
                                  : !satellite.healthy ? PhaseUse::unhealthy
                                  : low                ? PhaseUse::low
                                  : signal.half_cycle  ? PhaseUse::half_cycle
                                                       : PhaseUse::used;
                }
            }
    }

    void solve_clocks() {
        result_.clock_m = receiver_clocks_m(record_, config_.mask_deg);
        for (std::size_t i = 1; i < record_.epochs.size(); ++i)
            note_jump(i);
    }

    void note_jump(std::size_t epoch) {
        const double change_m = result_.clock_m[epoch] - result_.clock_m[epoch - 1];
        if (!(change_m == change_m)) return;
        const auto milliseconds = static_cast<std::int64_t>(std::llround(change_m / millisecond_m));
        const double rest_m = change_m - static_cast<double>(milliseconds) * millisecond_m;
        // A clock that drifts this much between two epochs does not jump but runs.
        if (milliseconds != 0 && std::abs(rest_m) < 0.1 * millisecond_m)
            result_.jumps.push_back({.epoch = epoch, .milliseconds = milliseconds});
    }

    bool continues(std::size_t epoch) const {
        return epoch > 0 && pairs_.step_s(epoch) <= config_.longest_gap_s;
    }

    void estimate_noise() {
        const std::size_t count = record_.epochs.size();
        const std::size_t stride = std::max<std::size_t>(1, count / noise_pairs);
        std::vector<double> white_m, geometry_m, doppler, wide_lane;
        for (std::size_t i = 1; i < count; i += stride) {
            if (!continues(i)) continue;
            const std::vector<PhasePair> pairs = pairs_.at(i);
            for (const PhasePair& pair : pairs) {
                const double sine = pair.now->sine_of_elevation;
                if (const double change_m = pairs_.geometry_free_change_m(pair);
                    change_m == change_m)
                    geometry_m.push_back(std::abs(change_m) / zenith_factor(sine));
                const double lane = pairs_.wide_lane_cycles(*pair.now, pair.signals_now) -
                                    pairs_.wide_lane_cycles(*pair.before, pair.signals_before);
                if (lane == lane) wide_lane.push_back(std::abs(lane) / std::sqrt(2.0));
            }
            for (const auto& change : pairs_.beyond_doppler_cycles(pairs, pairs_.step_s(i)))
                if (change) doppler.push_back(std::abs(*change));
            if (pairs.size() <= fewest_satellites || !record_.epochs[i - 1].has_position())
                continue;
            const auto solution = pairs_.displacement(i, pairs, {});
            if (!solution) continue;
            ++result_.noise.pairs;
            // A residual shows only the part of an error that the estimate does not absorb.
            const double seen = std::sqrt(static_cast<double>(solution->redundancy) /
                                          static_cast<double>(pairs.size()));
            for (std::size_t j = 0; j < pairs.size(); ++j)
                white_m.push_back(std::abs(solution->residuals_m[static_cast<Eigen::Index>(j)]) /
                                  seen / zenith_factor(pairs[j].now->sine_of_elevation));
        }
        const auto deviation = [](std::vector<double>& values) -> std::optional<double> {
            if (values.empty()) return std::nullopt;
            return deviations_per_median * median(std::move(values));
        };
        if (const auto estimated = deviation(white_m))
            result_.noise.white_m = std::max(*estimated, least_white_m);
        result_.noise.geometry_free_m = deviation(geometry_m);
        result_.noise.wide_lane_cycles = deviation(wide_lane);
        result_.noise.doppler_cycles = deviation(doppler);
    }

    /// Judges the pair of epochs that ends here, and continues the arcs.
    void step(std::size_t epoch) {
        outcome_ = {};
        if (continues(epoch))
            outcome_ = judge_pair(pairs_, epoch, record_.epochs[epoch - 1].has_position(),
                                  result_.noise, bounds_);
        result_.pairs += outcome_.is_judged;
        for (PhaseSlip& slip : outcome_.slips) {
            add_wide_lane(slip);
            if (config_.repair && slip.cycles) repair(slip);
        }
        std::ranges::sort(outcome_.slips, {}, &PhaseSlip::signal);
        result_.slips.insert(result_.slips.end(), outcome_.slips.begin(), outcome_.slips.end());
        if (outcome_.refusal) result_.refusals.push_back(*outcome_.refusal);
        if (outcome_.disturbed) result_.disturbed.push_back(*outcome_.disturbed);
        carry_arcs(epoch);
    }

    /// The satellite to which the signal of a slip belongs.
    const PhaseSatellite& satellite_of(const PhaseSlip& slip) const {
        const auto all = record_.of(record_.epochs[slip.epoch]);
        return *std::prev(
            std::ranges::upper_bound(all, slip.signal, {}, &PhaseSatellite::first_signal));
    }

    void add_wide_lane(PhaseSlip& slip) const {
        const PhaseSatellite& satellite = satellite_of(slip);
        const Track& track = tracks_[slot_of(satellite.id)];
        const double lane = pairs_.wide_lane_cycles(satellite, pairs_.chosen_of(satellite));
        if (track.wide_lane_count > 0 && lane == lane)
            slip.wide_lane_cycles = lane - track.wide_lane_mean;
    }

    /// Subtracts a slip of whole cycles from the phases that follow, unless the second band
    /// contradicts it.
    void repair(PhaseSlip& slip) {
        const double whole = std::round(*slip.cycles);
        if (whole == 0.0 || std::abs(*slip.cycles - whole) >= repair_from_whole ||
            *slip.sigma_cycles >= repair_sigma_cycles)
            return;
        const PhaseSatellite& now = satellite_of(slip);
        std::int32_t second_whole = 0;
        for (const PhasePair& pair : pairs_.at(slip.epoch)) {
            if (pair.now != &now) continue;
            const double change_m = pairs_.geometry_free_change_m(pair);
            if (!(change_m == change_m)) break;
            // Both combinations must agree on the slip of the second band.
            if (!slip.wide_lane_cycles) return;
            const double second = whole - std::round(*slip.wide_lane_cycles);
            const double second_m =
                wavelength_m(now.id, record_.signals[pair.signals_now.second].code);
            const double sigma_m =
                result_.noise.geometry_free_m.value_or(0.0) * zenith_factor(now.sine_of_elevation);
            if (std::abs(pair.wavelength_m * whole - second_m * second - change_m) > 4.5 * sigma_m)
                return;
            second_whole = static_cast<std::int32_t>(second);
        }
        slip.is_repaired = true;
        outcome_.broken.erase(now.id);
        outcome_.second_broken.erase(now.id);
        Track& track = tracks_[slot_of(now.id)];
        if (track.first) track.first->correction += static_cast<std::int32_t>(whole);
        if (track.second) track.second->correction += second_whole;
    }

    /// Numbers the arcs of an epoch's signals.
    void carry_arcs(std::size_t epoch) {
        for (const PhaseSatellite& satellite : record_.of(record_.epochs[epoch])) {
            Track& track = tracks_[slot_of(satellite.id)];
            const ChosenSignals chosen = pairs_.chosen_of(satellite);
            bool new_arc_of_first = false;
            track.first = track.second = nullptr;
            for (std::size_t i = 0; i < satellite.signals; ++i) {
                const std::size_t number = satellite.first_signal + i;
                PhaseFinding& finding = result_.findings[number];
                if (finding.use != PhaseUse::used) continue;
                Track::Signal& signal = track.signals[slot_of(record_.signals[number].code)];
                finding.begins = break_before(epoch, satellite, number, signal);
                if (finding.begins != PhaseBreak::none) {
                    ++signal.arc;
                    signal.correction = 0;
                }
                signal.epoch = epoch;
                finding.arc = signal.arc;
                finding.correction = signal.correction;
                if (number == chosen.first) {
                    track.first = &signal;
                    new_arc_of_first = finding.begins != PhaseBreak::none;
                }
                if (number == chosen.second) track.second = &signal;
            }
            follow_wide_lane(satellite, chosen, track, new_arc_of_first);
            issues_[slot_of(satellite.id)] = satellite.issue;
        }
    }

    PhaseBreak break_before(std::size_t epoch, const PhaseSatellite& satellite, std::size_t number,
                            const Track::Signal& signal) const {
        if (signal.arc == 0) return PhaseBreak::start;
        if (!continues(epoch) || signal.epoch != epoch - 1) return PhaseBreak::gap;
        if (record_.signals[number].loss_of_lock) return PhaseBreak::lost_lock;
        if (issues_[slot_of(satellite.id)] != satellite.issue) return PhaseBreak::ephemeris;
        if (const auto broken = outcome_.broken.find(satellite.id); broken != outcome_.broken.end())
            return broken->second;
        if (outcome_.refusal) return PhaseBreak::refused;
        return result_.findings[number].supports && outcome_.second_broken.contains(satellite.id)
                   ? PhaseBreak::geometry_free
                   : PhaseBreak::none;
    }

    void follow_wide_lane(const PhaseSatellite& satellite, const ChosenSignals& chosen,
                          Track& track, bool new_arc) {
        const double lane = pairs_.wide_lane_cycles(satellite, chosen);
        if (!(lane == lane)) {
            track.wide_lane_count = 0;
            return;
        }
        if (new_arc) track.wide_lane_count = 0;
        track.wide_lane_count = std::min(track.wide_lane_count + 1, wide_lane_epochs);
        if (track.wide_lane_count == 1) track.wide_lane_mean = 0.0;
        track.wide_lane_mean += (lane - track.wide_lane_mean) / track.wide_lane_count;
    }

    const PhaseRecord& record_;
    const PhaseScreeningConfig& config_;
    PhaseScreening result_;
    PhasePairs pairs_;
    ChiSquaredBounds bounds_;
    double least_sine_;
    std::vector<Track> tracks_;
    std::array<std::int16_t, satellite_slots> issues_{};
    PairOutcome outcome_;  ///< of the current pair
};

}  // namespace

double wavelength_m(Satellite satellite, SignalCode code) {
    const auto frequency_hz = carrier_frequency_hz(satellite.system, code.band);
    return frequency_hz ? speed_of_light_m_s / *frequency_hz : not_known;
}

std::vector<double> receiver_clocks_m(const PhaseRecord& record, double mask_deg) {
    const double least_sine = std::sin(mask_deg * radians_per_degree);
    std::vector<double> clocks_m(record.epochs.size(), not_known);
    std::vector<double> left_m;
    for (std::size_t i = 0; i < record.epochs.size(); ++i) {
        const PhaseEpoch& epoch = record.epochs[i];
        if (!epoch.has_position()) continue;
        const ReceiverPosition receiver = receiver_position(epoch.receiver_m);
        left_m.clear();
        for (const PhaseSatellite& satellite : record.of(epoch)) {
            if (!satellite.has_orbit() || !satellite.healthy ||
                !(satellite.sine_of_elevation >= least_sine))
                continue;
            for (const PhaseSignal& signal : record.of(satellite)) {
                if (!(signal.pseudorange_m == signal.pseudorange_m)) continue;
                const LineOfSight sight = line_of_sight(satellite.position_m, receiver);
                left_m.push_back(
                    signal.pseudorange_m + satellite.clock_m - satellite.group_delay_m -
                    sight.range_m -
                    troposphere_m(receiver.height_m, std::max(sight.sine_of_elevation, 0.05)));
                break;
            }
        }
        if (left_m.size() >= 4) clocks_m[i] = median(left_m);
    }
    return clocks_m;
}

PhaseScreening screen_phases(const PhaseRecord& record, const PhaseScreeningConfig& config) {
    return Screen(record, config).run();
}

}  // namespace runcert

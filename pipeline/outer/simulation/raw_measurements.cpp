#include "simulation/raw_measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/angle.h"
#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "satellites/line_of_sight.h"
#include "satellites/troposphere.h"

namespace runcert {
namespace {

constexpr double jump_s = 1e-3;
/// Half the step by which rates are taken (s).
constexpr double half_step_s = 0.01;

/// A signal that is written, and its carrier.
struct RawBand {
    SatelliteSystem system;
    SignalCode code;
};

std::vector<RawBand> bands_of(const RawSpec& raw) {
    std::vector<RawBand> bands{{SatelliteSystem::gps, {1, 'C'}},
                               {SatelliteSystem::galileo, {1, 'C'}}};
    if (raw.bands == 2) {
        bands.push_back({SatelliteSystem::gps, {2, 'W'}});
        bands.push_back({SatelliteSystem::galileo, {5, 'Q'}});
    }
    return bands;
}

/// What is kept of a satellite's band: its ambiguity, multipath and noise.
struct BandState {
    RandomGenerator random;
    double cycles = 0.0;
    double multipath = 0.0;  ///< of unit standard deviation
    bool is_new = true;
};

std::string header_text(const RawSpec& raw, GpsTime first, const Eigen::Vector3d& place_m) {
    const auto line = [](std::string text, std::string_view label) {
        text.resize(60, ' ');
        return text + std::string(label) + "\n";
    };
    std::string text = line("     3.04           OBSERVATION DATA    M", "RINEX VERSION / TYPE");
    text += line("runcert simulate    simulated", "PGM / RUN BY / DATE");
    text += line("no receiver: these measurements are simulated", "COMMENT");
    text += line("                    simulated", "REC # / TYPE / VERS");
    text += line(fmt::format("{:14.4f}{:14.4f}{:14.4f}", place_m.x(), place_m.y(), place_m.z()),
                 "APPROX POSITION XYZ");
    text +=
        line(raw.bands == 2 ? "G    8 C1C L1C D1C S1C C2W L2W D2W S2W" : "G    4 C1C L1C D1C S1C",
             "SYS / # / OBS TYPES");
    text +=
        line(raw.bands == 2 ? "E    8 C1C L1C D1C S1C C5Q L5Q D5Q S5Q" : "E    4 C1C L1C D1C S1C",
             "SYS / # / OBS TYPES");
    const CalendarTime time = first.calendar();
    text += line(fmt::format("  {:04}    {:02}    {:02}    {:02}    {:02}   {:010.7f}     GPS",
                             time.year, time.month, time.day, time.hour, time.minute,
                             time.second + static_cast<double>(time.nanosecond) * 1e-9),
                 "TIME OF FIRST OBS");
    return text + line("", "END OF HEADER");
}

class RawSimulation {
  public:
    RawSimulation(const SimulationSpec& spec, const RawSpec& raw,
                  const std::vector<Ephemeris>& ephemerides)
        : spec_(spec),
          raw_(raw),
          interval_s_(static_cast<double>(interval_ms(spec.run)) * 1e-3),
          rotation_(rotation_enu_from_ecef(spec.place->latitude, spec.place->longitude)),
          origin_m_(ecef_from_geodetic(*spec.place).m),
          ephemerides_(ephemerides),
          bands_(bands_of(raw)) {
        std::set<Satellite> all;
        for (const Ephemeris& each : ephemerides)
            if (each.healthy) all.insert(each.satellite);
        satellites_.assign(all.begin(), all.end());
    }

    std::string text(std::span<const SimulatedEpoch> epochs) {
        std::string text;
        for (const SimulatedEpoch& epoch : epochs) {
            const double tag_s = epoch.time_s();
            follow_clock(tag_s);
            if (!epoch.recorded) continue;
            if (text.empty()) text = header_text(raw_, tag_of(epoch), position_m(epoch, 0.0));
            add_epoch(epoch, text);
        }
        return text;
    }

  private:
    GpsTime tag_of(const SimulatedEpoch& epoch) const {
        return spec_.start_gps->plus_nanoseconds(epoch.time_ms * 1'000'000);
    }

    void follow_clock(double tag_s) {
        clock_s_ = raw_.clock_offset_s + raw_.clock_drift * tag_s - jumped_s_;
        if (!raw_.clock_jumps) return;
        while (std::abs(clock_s_) > 0.5 * jump_s) {
            const double jump = clock_s_ > 0.0 ? jump_s : -jump_s;
            jumped_s_ += jump;
            clock_s_ -= jump;
        }
    }

    /// Where the receiver is so long after the epoch's nominal time.
    Eigen::Vector3d position_m(const SimulatedEpoch& epoch, double after_s) const {
        const double way_m = epoch.truth.speed_m_s * after_s;
        const Eigen::Vector3d moved_m =
            epoch.craft ? Eigen::Vector3d(after_s * epoch.craft->antenna_velocity_m_s)
                        : Eigen::Vector3d(way_m * direction_of(spec_.run));
        return origin_m_ + rotation_.transpose() * (epoch.true_enu_m + moved_m);
    }

    /// Range and satellite's clock of what is received so long after the nominal time.
    struct Path {
        double range_m = 0.0, clock_m = 0.0, delay_m = 0.0, sine = 0.0;
    };
    Path path(const Ephemeris& ephemeris, const SimulatedEpoch& epoch, double after_s) const {
        const ReceiverPosition place = receiver_position(position_m(epoch, after_s));
        const GpsTime nominal = tag_of(epoch);
        double travel_s = 0.075;
        Path result;
        for (int step = 0; step < 4; ++step) {
            const SatelliteState state = state_after(ephemeris, nominal, after_s - travel_s);
            const LineOfSight sight = line_of_sight(state.position_m, place);
            travel_s = sight.range_m / speed_of_light_m_s;
            result.range_m = sight.range_m;
            result.clock_m = state.clock_s * speed_of_light_m_s;
            result.sine = sight.sine_of_elevation;
        }
        result.delay_m = troposphere_m(place.height_m, std::max(result.sine, 0.05));
        return result;
    }

    template <class Stretch>
    static bool is_in(const std::vector<Stretch>& stretches, Satellite satellite, double time_s) {
        return std::ranges::any_of(stretches, [&](const Stretch& each) {
            return each.satellite == satellite && contains(each, time_s);
        });
    }

    void add_epoch(const SimulatedEpoch& epoch, std::string& text) {
        const double tag_s = epoch.time_s();
        const double least_sine = std::sin(Angle::from_degrees(raw_.mask_deg).radians());
        std::string lines;
        int count = 0;
        for (const Satellite satellite : satellites_) {
            const auto chosen = ephemerides_.choose(satellite, tag_of(epoch));
            if (!chosen || is_in(raw_.outages, satellite, tag_s)) continue;
            const Ephemeris& ephemeris = ephemerides_[*chosen];
            // What is measured at a reading of the receiver's clock happens so much earlier.
            const Path now = path(ephemeris, epoch, -clock_s_);
            if (now.sine < least_sine) continue;
            const Path before = path(ephemeris, epoch, -clock_s_ - half_step_s);
            const Path after = path(ephemeris, epoch, -clock_s_ + half_step_s);
            const auto modelled = [](const Path& each) {
                return each.range_m - each.clock_m + each.delay_m;
            };
            const double rate_m_s = (modelled(after) - modelled(before)) / (2.0 * half_step_s) +
                                    raw_.clock_drift * speed_of_light_m_s;
            lines += to_text(satellite);
            for (const RawBand& band : bands_)
                if (band.system == satellite.system)
                    lines +=
                        band_text(satellite, band.code, now,
                                  ephemeris.group_delay_s * speed_of_light_m_s, rate_m_s, tag_s);
            lines += "\n";
            ++count;
        }
        if (count == 0)
            throw Failure(
                "simulation",
                fmt::format("no satellite of the navigation file is above the mask at {} s", tag_s),
                "Give a navigation file of the run's day");
        const CalendarTime time = tag_of(epoch).calendar();
        text += fmt::format("> {:04} {:02} {:02} {:02} {:02} {:010.7f}  0{:3}\n", time.year,
                            time.month, time.day, time.hour, time.minute,
                            time.second + static_cast<double>(time.nanosecond) * 1e-9, count);
        text += lines;
    }

    BandState& state_of(Satellite satellite, SignalCode code) {
        const auto key = std::pair(satellite, code);
        const auto found = states_.find(key);
        if (found != states_.end()) return found->second;
        const auto seed = static_cast<std::uint64_t>(spec_.seed) * 1'000'003 +
                          static_cast<std::uint64_t>(satellite.system) * 100'000 +
                          satellite.number * std::uint64_t{100} + code.band;
        BandState& made = states_.emplace(key, BandState{RandomGenerator(seed)}).first->second;
        made.cycles = std::floor(made.random.uniform() * 2e6) - 1e6;
        return made;
    }

    std::string band_text(Satellite satellite, SignalCode code, const Path& path,
                          double group_delay_m, double rate_m_s, double tag_s) {
        BandState& state = state_of(satellite, code);
        const double wavelength_m =
            speed_of_light_m_s / *carrier_frequency_hz(satellite.system, code.band);
        const double low = std::sqrt(0.5 * (1.0 + 1.0 / (path.sine * path.sine)));
        const double steps = interval_s_ / raw_.multipath_time_s;
        const double fresh = state.random.normal();
        state.multipath = state.is_new ? fresh
                                       : std::exp(-steps) * state.multipath +
                                             std::sqrt(-std::expm1(-2.0 * steps)) * fresh;
        const double modelled_m =
            path.range_m + clock_s_ * speed_of_light_m_s - path.clock_m + path.delay_m;
        const double phase_m = modelled_m + raw_.phase_noise_m * low * state.random.normal() +
                               raw_.phase_multipath_m * low * state.multipath;
        const double pseudorange_m = modelled_m + (code.band == 1 ? group_delay_m : 0.0) +
                                     raw_.pseudorange_noise_m * low * state.random.normal();
        const double doppler_hz =
            -rate_m_s / wavelength_m + raw_.doppler_noise_hz * low * state.random.normal();
        int mark = is_in(raw_.half_cycles, satellite, tag_s) ? 2 : 0;
        double lost_cycles = 0.0;
        for (const SlipFault& slip : raw_.slips) {
            if (slip.satellite != satellite || slip.band != code.band || tag_s < slip.time_s)
                continue;
            lost_cycles += slip.cycles;
            if (slip.is_flagged && tag_s - slip.time_s < interval_s_) mark |= 1;
        }
        if (mark & 2) lost_cycles += 0.5;
        state.is_new = false;
        const double phase_cycles = phase_m / wavelength_m + state.cycles + lost_cycles;
        const double strength = 30.0 + 20.0 * path.sine;
        return fmt::format("{:14.3f}  {:14.3f}{} {:14.3f}  {:14.3f}  ", pseudorange_m, phase_cycles,
                           mark == 0 ? ' ' : static_cast<char>('0' + mark), doppler_hz, strength);
    }

    const SimulationSpec& spec_;
    const RawSpec& raw_;
    double interval_s_;
    Eigen::Matrix3d rotation_;
    Eigen::Vector3d origin_m_;
    Ephemerides ephemerides_;
    std::vector<RawBand> bands_;
    std::vector<Satellite> satellites_;
    std::map<std::pair<Satellite, SignalCode>, BandState> states_;
    double clock_s_ = 0.0;  ///< of the receiver, ahead of GPS time
    double jumped_s_ = 0.0;
};

}  // namespace

std::string rinex_observations_text(const SimulationSpec& spec, const RawSpec& raw,
                                    std::span<const SimulatedEpoch> epochs,
                                    const std::vector<Ephemeris>& ephemerides) {
    if (!spec.place || !spec.start_gps)
        throw Failure("simulation", "raw measurements need a place and a time, and one is missing",
                      "Give place and start_gps");
    return RawSimulation(spec, raw, ephemerides).text(epochs);
}

}  // namespace runcert

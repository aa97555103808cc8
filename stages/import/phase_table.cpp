#include "stages/import/phase_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <span>

#include "core/failure.h"
#include "core/statistics.h"
#include "core/text.h"
#include "satellites/ephemeris.h"
#include "satellites/point_solution.h"
#include "stages/import/cell.h"
#include "stages/import/measured_epoch.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/ubx/raw.h"

namespace runcert {
namespace {

/// The place is solved anew after so long: elevations are good to 0.1 degrees at 100 m/s.
constexpr std::int64_t place_holds_ns = 10 * GpsTime::nanoseconds_per_second;
/// Heights that a pseudorange solution may have (m); any other solution is rejected.
constexpr double lowest_m = -1000.0, highest_m = 30'000.0;

/// All measurements, held: 56 bytes a signal.
struct HeldEpoch {
    GpsTime time;
    std::int64_t byte = 0;
    std::size_t first = 0, count = 0;
};

struct Held {
    MeasurementFacts facts;
    std::vector<HeldEpoch> epochs;
    std::vector<SignalMeasurement> signals;
    std::vector<Ephemeris> ephemerides;
    bool has_lines = true;  ///< of the file, or else bytes

    std::span<const SignalMeasurement> of(const HeldEpoch& epoch) const {
        return std::span(signals).subspan(epoch.first, epoch.count);
    }
};

TakeMeasurements hold_in(Held& held) {
    return [&held](MeasuredEpoch& epoch) {
        held.epochs.push_back({.time = epoch.time,
                               .byte = epoch.byte,
                               .first = held.signals.size(),
                               .count = epoch.measurements.size()});
        held.signals.insert(held.signals.end(), epoch.measurements.begin(),
                            epoch.measurements.end());
    };
}

Held hold(const Receiver& receiver, const RecordingBytes& phase,
          const std::vector<RecordingBytes>& navigation) {
    require_readable(phase);
    Held held;
    // A signal takes at least so many bytes of either format, most of the time: less copying.
    held.signals.reserve(phase.bytes.size() / 64);
    const bool is_rinex = rinex::recognises(phase.bytes.substr(0, recognised_by));
    if (is_rinex) {
        held.facts = rinex::read_measurements(phase, hold_in(held));
    } else if (ubx::has_raw(phase.bytes.substr(0, recognised_by))) {
        held.has_lines = false;
        ubx::RawFile raw = ubx::read_raw(phase, hold_in(held));
        held.facts = std::move(raw.facts);
        held.ephemerides = std::move(raw.ephemerides);
    } else {
        throw Failure(phase.name, "the file holds no raw measurements that are read",
                      "Give RINEX observations, or a UBX log with RXM-RAWX; convert others to "
                      "RINEX");
    }
    if (!navigation.empty()) held.ephemerides.clear();
    for (std::size_t i = 0; i < navigation.size(); ++i) {
        rinex::NavigationFile file = rinex::read_navigation(navigation[i]);
        for (Ephemeris& each : file.ephemerides) {
            each.file = static_cast<std::int32_t>(i);
            held.ephemerides.push_back(each);
        }
        held.facts.notes.insert(held.facts.notes.end(), file.notes.begin(), file.notes.end());
    }
    if (held.ephemerides.empty())
        throw Failure(
            receiver.place,
            !navigation.empty() ? "navigation: has no ephemeris of GPS or Galileo"
            : is_rinex          ? "RINEX observations need broadcast orbits, and navigation: is "
                                  "not given"
                                : "the UBX log holds no whole ephemeris (RXM-SFRBX), and "
                                  "navigation: is not given",
            "Name a navigation file of that day (RINEX, GPS or Galileo): navigation: in the "
            "attempt, --navigation for inspect");
    return held;
}

/// The satellites of an epoch, each with its signals.
template <class Look>
void each_satellite(std::span<const SignalMeasurement> all, const Look& look) {
    for (std::size_t from = 0; from < all.size();) {
        std::size_t to = from + 1;
        while (to < all.size() && all[to].satellite == all[from].satellite)
            ++to;
        look(all.subspan(from, to - from));
        from = to;
    }
}

/// The pseudorange that a satellite's signals were sent by; nothing where none has one.
std::optional<double> pseudorange_of(std::span<const SignalMeasurement> signals) {
    for (const SignalMeasurement& each : signals)
        if (each.pseudorange_m) return *each.pseudorange_m;
    return std::nullopt;
}

/// Goes through the epochs, and says where the satellites are.
class Sky {
  public:
    explicit Sky(const Held& held) : held_(held), ephemerides_(held.ephemerides) {
        if (held.facts.approximate_position) set_place(held.facts.approximate_position->m);
    }

    struct Seen {
        const Ephemeris* ephemeris = nullptr;  ///< null where none is valid
        std::optional<SatelliteState> state;   ///< nothing without ephemeris or pseudorange
    };

    Seen see(std::span<const SignalMeasurement> signals, GpsTime time) {
        Seen seen;
        const auto chosen = ephemerides_.choose(signals.front().satellite, time);
        if (!chosen) return seen;
        seen.ephemeris = &ephemerides_[*chosen];
        if (const auto pseudorange_m = pseudorange_of(signals))
            seen.state = state_at_transmission(*seen.ephemeris, time, *pseudorange_m);
        return seen;
    }

    /// Solves the receiver's place at an epoch, where it was not solved shortly before.
    void locate(const HeldEpoch& epoch) {
        if (place_ && solved_at_ &&
            std::abs((epoch.time.nanoseconds() - solved_at_->nanoseconds())) < place_holds_ns)
            return;
        std::vector<CodeMeasurement> code;
        each_satellite(held_.of(epoch), [&](std::span<const SignalMeasurement> signals) {
            const Seen seen = see(signals, epoch.time);
            if (!seen.state || !seen.ephemeris->healthy) return;
            code.push_back({.system = signals.front().satellite.system,
                            .satellite_m = seen.state->position_m,
                            .pseudorange_m = *pseudorange_of(signals) +
                                             speed_of_light_m_s * (seen.state->clock_s -
                                                                   seen.ephemeris->group_delay_s)});
        });
        if (const auto solution = point_solution(code))
            if (set_place(solution->position_m)) solved_at_ = epoch.time;
    }

    std::optional<double> elevation_deg(const SatelliteState& state) const {
        if (!place_) return std::nullopt;
        const double sine = line_of_sight(state.position_m, *place_).sine_of_elevation;
        return Angle::from_radians(std::asin(std::clamp(sine, -1.0, 1.0))).degrees();
    }

    bool has_place() const { return place_.has_value(); }
    const Ephemerides& ephemerides() const { return ephemerides_; }

  private:
    bool set_place(const Eigen::Vector3d& position_m) {
        const ReceiverPosition place = receiver_position(position_m);
        if (place.height_m < lowest_m || place.height_m > highest_m) return false;
        place_ = place;
        return true;
    }

    const Held& held_;
    Ephemerides ephemerides_;
    std::optional<ReceiverPosition> place_;
    std::optional<GpsTime> solved_at_;
};

PhaseMark mark_of(const SignalMeasurement& signal) {
    if (signal.loss_of_lock) return signal.half_cycle ? PhaseMark::lost_and_half : PhaseMark::lost;
    return PhaseMark::half;
}

void give_rows(const Held& held, const TakePhaseRow& take) {
    Sky sky(held);
    // Epochs before the first solution need elevations, too.
    for (std::size_t i = 0; i < held.epochs.size() && !sky.has_place(); ++i)
        sky.locate(held.epochs[i]);
    std::int64_t number = 0;
    for (const HeldEpoch& epoch : held.epochs) {
        ++number;
        sky.locate(epoch);
        each_satellite(held.of(epoch), [&](std::span<const SignalMeasurement> signals) {
            const Sky::Seen seen = sky.see(signals, epoch.time);
            PhaseRow of_satellite;
            of_satellite.epoch = number;
            of_satellite.time.nanoseconds =
                epoch.time.nanoseconds() - held.epochs.front().time.nanoseconds();
            of_satellite.satellite = signals.front().satellite;
            if (seen.state) {
                of_satellite.satellite_x_m = seen.state->position_m.x();
                of_satellite.satellite_y_m = seen.state->position_m.y();
                of_satellite.satellite_z_m = seen.state->position_m.z();
                of_satellite.satellite_clock_m = seen.state->clock_s * speed_of_light_m_s;
                of_satellite.issue = static_cast<std::int16_t>(seen.ephemeris->issue);
                of_satellite.elevation_deg = sky.elevation_deg(*seen.state);
            }
            for (const SignalMeasurement& signal : signals) {
                PhaseRow row = of_satellite;
                row.signal = signal.signal;
                row.phase_cycles = signal.phase_cycles;
                row.pseudorange_m = signal.pseudorange_m;
                row.doppler_hz = signal.doppler_hz;
                row.strength_db_hz = signal.strength_db_hz;
                row.lock_time_s = signal.lock_time_s;
                if (signal.loss_of_lock || signal.half_cycle) row.mark = mark_of(signal);
                if (held.has_lines)
                    row.source_line = signal.line;
                else
                    row.source_byte = epoch.byte;
                take(row);
            }
        });
    }
}

double median_interval_s(const std::vector<HeldEpoch>& epochs) {
    std::vector<double> steps_s;
    for (std::size_t i = 1; i < epochs.size(); ++i)
        steps_s.push_back(epochs[i].time.seconds_since(epochs[i - 1].time));
    return steps_s.empty() ? 0.0 : median(std::move(steps_s));
}

/// "3.2 h".
std::string age_text(double age_s) {
    return fmt::format("{} h", format_fixed(age_s / 3600.0, 1));
}

/// What the ephemerides cover: those used go into the head, and notes say what is missing.
void set_ephemerides(const Held& held, const RecordingBytes& phase, bool several_files,
                     PhaseTable& head) {
    Ephemerides ephemerides(held.ephemerides);
    std::set<const Ephemeris*> used;
    struct Missing {
        std::int64_t epochs = 0;
        GpsTime first;
    };
    std::map<Satellite, Missing> missing;
    std::int64_t covered = 0;
    for (const HeldEpoch& epoch : held.epochs)
        each_satellite(held.of(epoch), [&](std::span<const SignalMeasurement> signals) {
            const Satellite satellite = signals.front().satellite;
            const auto chosen = ephemerides.choose(satellite, epoch.time);
            if (!chosen) {
                Missing& mine = missing[satellite];
                if (mine.epochs++ == 0) mine.first = epoch.time;
                return;
            }
            ++covered;
            const Ephemeris& ephemeris = ephemerides[*chosen];
            if (!used.insert(&ephemeris).second) return;
            head.ephemerides.push_back(
                {.satellite = to_text(satellite),
                 .issue = ephemeris.issue,
                 .reference_gps = to_iso(ephemeris.reference, 0),
                 .group_delay_m = ephemeris.group_delay_s * speed_of_light_m_s,
                 .healthy = ephemeris.healthy,
                 .file =
                     several_files ? std::optional<std::int64_t>(ephemeris.file + 1) : std::nullopt,
                 .place = ephemeris.place});
        });
    const auto why = [&](Satellite satellite, const Missing& absent) {
        const auto nearest = ephemerides.nearest(satellite, absent.first);
        if (!nearest) return std::string("the navigation has none of it");
        return fmt::format(
            "the nearest is {} away, and {} are allowed",
            age_text(std::abs(absent.first.seconds_since(ephemerides[*nearest].reference))),
            age_text(Ephemerides::valid_for_s));
    };
    if (covered == 0 && !missing.empty()) {
        // Of one that the navigation knows, the age is the answer.
        const auto known = std::ranges::find_if(missing, [&](const auto& each) {
            return ephemerides.nearest(each.first, each.second.first).has_value();
        });
        const auto& [satellite, absent] = known == missing.end() ? *missing.begin() : *known;
        throw Failure(phase.name,
                      fmt::format("no satellite has a broadcast orbit at these times; of {}, {}",
                                  to_text(satellite), why(satellite, absent)),
                      "Give the navigation file of the day of the measurements");
    }
    for (const auto& [satellite, absent] : missing)
        head.notes.push_back(fmt::format("{} has no broadcast orbit at {} of {} epochs: {}.",
                                         to_text(satellite), absent.epochs, held.epochs.size(),
                                         why(satellite, absent)));
}

}  // namespace

bool has_phases(std::string_view bytes) {
    return rinex::recognises(bytes) || ubx::has_raw(bytes);
}

StreamedPhases import_phases(const Receiver& receiver, const RecordingBytes& phase,
                             const std::vector<RecordingBytes>& navigation) {
    auto held = std::make_shared<Held>(hold(receiver, phase, navigation));
    StreamedPhases result{.head = {},
                          .rows = std::ssize(held->signals),
                          .give = [held](const TakePhaseRow& take) { give_rows(*held, take); }};
    PhaseTable& head = result.head;
    head.receiver = receiver.id;
    head.first_epoch = held->epochs.front().time;
    head.format = held->facts.format;
    head.device = held->facts.device;
    head.nominal_interval_s = median_interval_s(held->epochs);
    head.epochs = std::ssize(held->epochs);
    head.records = held->facts.records;
    head.notes = held->facts.notes;
    set_ephemerides(*held, phase, navigation.size() > 1, head);
    return result;
}

}  // namespace runcert

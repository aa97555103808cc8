#include <algorithm>
#include <cmath>
#include <map>

#include "core/angle.h"
#include "reports/certificate/report_data.h"
#include "satellites/line_of_sight.h"

namespace runcert {
namespace {

class View {
  public:
    View(const JudgedPhases& phases, const PhaseWitness<2>& witness, double later_s)
        : phases_(phases), witness_(witness), later_s_(later_s) {}

    void add_satellites(PhaseView& view) const {
        std::map<Satellite, SatelliteTrack> tracks;
        for (std::size_t k = 0; k < phases_.record.epochs.size(); ++k) {
            const PhaseEpoch& epoch = phases_.record.epochs[k];
            if (!epoch.has_position()) continue;
            const ReceiverPosition place = receiver_position(epoch.receiver_m);
            for (const PhaseSatellite& satellite : phases_.record.of(epoch))
                if (satellite.has_orbit())
                    tracks[satellite.id].epochs.push_back(in_view(k, satellite, place));
        }
        for (const PhaseSlip& slip : phases_.screening.slips)
            for (const PhaseSatellite& satellite :
                 phases_.record.of(phases_.record.epochs[slip.epoch]))
                if (slip.signal >= satellite.first_signal &&
                    slip.signal < satellite.first_signal + satellite.signals)
                    tracks[satellite.id].slips_s.push_back(time_s(slip.epoch));
        for (auto& [satellite, track] : tracks) {
            track.satellite = satellite;
            view.satellites.push_back(std::move(track));
        }
        for (const PhaseRefusal& refusal : phases_.screening.refusals)
            view.refused_s.push_back(time_s(refusal.epoch));
    }

    void add_steps(PhaseView& view) const {
        for (std::size_t k = 1; k < phases_.record.epochs.size(); ++k) {
            const double from_s = time_s(k - 1), to_s = time_s(k);
            if (const auto moved = witness_.between(from_s, to_s)) {
                const double step_s = to_s - from_s;
                view.speed_m_s.push_back({.time_s = 0.5 * (from_s + to_s),
                                          .value = moved->displacement_m.norm() / step_s,
                                          .standard_uncertainty = along(*moved) / step_s});
            }
            for (const PhaseResidual& residual :
                 residuals_between(phases_.record, phases_.screening, k - 1, k))
                view.residuals_m.push_back({.time_s = to_s,
                                            .value = residual.residual_m,
                                            .standard_uncertainty = residual.sigma_m});
        }
    }

    void add_differences(const TrajectoryTable& trajectory, double window_s,
                         PhaseView& view) const {
        const auto& rows = trajectory.rows;
        std::size_t from = 0;
        for (std::size_t to = 0; to < rows.size(); ++to) {
            constexpr double rounding_s = 1e-6;
            const double from_s = rows[to].time.seconds() - window_s;
            while (from < to && rows[from].time.seconds() < from_s - rounding_s)
                ++from;
            if (std::abs(rows[from].time.seconds() - from_s) > rounding_s || from == to ||
                !is_placed(rows[from]) || !is_placed(rows[to]) || rows[from].arc != rows[to].arc)
                continue;
            const auto moved = witness_.between(rows[from].time.seconds(), rows[to].time.seconds());
            if (!moved) continue;
            const auto add = [&](std::vector<ViewedValue>& list, int axis, double by_positions_m) {
                list.push_back(
                    {.time_s = rows[to].time.seconds(),
                     .value = by_positions_m - moved->displacement_m[axis],
                     .standard_uncertainty = std::sqrt(moved->covariance_m2(axis, axis))});
            };
            add(view.apart_east_m, 0, *rows[to].east_m - *rows[from].east_m);
            add(view.apart_north_m, 1, *rows[to].north_m - *rows[from].north_m);
        }
    }

  private:
    static bool is_placed(const TrajectoryEpoch& row) {
        return row.arc && row.east_m && row.north_m;
    }

    static double along(const WitnessedMotion<2>& moved) {
        const double length = moved.displacement_m.norm();
        if (!(length > 0.0)) return std::sqrt(moved.covariance_m2.trace());
        const Eigen::Vector2d direction = moved.displacement_m / length;
        return std::sqrt(direction.dot(moved.covariance_m2 * direction));
    }

    double time_s(std::size_t epoch) const {
        return static_cast<double>(phases_.record.epochs[epoch].time_ns) * 1e-9 - later_s_;
    }

    SatelliteInView in_view(std::size_t epoch, const PhaseSatellite& satellite,
                            const ReceiverPosition& place) const {
        const LineOfSight sight = line_of_sight(satellite.position_m, place);
        const Eigen::Vector3d enu = place.enu_from_ecef * sight.direction;
        SatelliteInView seen;
        seen.time_s = time_s(epoch);
        seen.azimuth_deg = std::atan2(enu.x(), enu.y()) * degrees_per_radian;
        seen.elevation_deg =
            std::asin(std::clamp(sight.sine_of_elevation, -1.0, 1.0)) * degrees_per_radian;
        for (std::size_t i = 0; i < satellite.signals; ++i) {
            const PhaseFinding& finding = phases_.screening.findings[satellite.first_signal + i];
            seen.used = seen.used || (finding.arc > 0 && !finding.supports);
        }
        return seen;
    }

    const JudgedPhases& phases_;
    const PhaseWitness<2>& witness_;
    double later_s_;
};

}  // namespace

std::optional<PhaseView> phase_view(JudgedPhases phases, const GpsTime& first_of_phases,
                                    const TrajectoryTable& trajectory, double window_s) {
    const auto shared = std::make_shared<const JudgedPhases>(std::move(phases));
    const auto witness = phase_witness<2>(shared, first_of_phases, trajectory.facts.first_epoch,
                                          trajectory.origin, 0.0);
    if (!witness) return std::nullopt;
    const double later_s =
        static_cast<double>(trajectory.facts.first_epoch->nanoseconds_since(first_of_phases)) *
        1e-9;
    const View view(*shared, *witness, later_s);
    PhaseView result;
    view.add_satellites(result);
    view.add_steps(result);
    view.add_differences(trajectory, window_s, result);
    return result;
}

}  // namespace runcert

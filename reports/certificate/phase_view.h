#pragma once

#include <optional>
#include <vector>

#include "core/satellite.h"
#include "schemas/trajectory/trajectory.h"
#include "witness/screened_phases.h"

namespace runcert {

/// A satellite at an epoch, as the receiver saw it.
struct SatelliteInView {
    double time_s = 0.0;  ///< from the positions' first epoch; so all times here
    double azimuth_deg = 0.0;
    double elevation_deg = 0.0;
    bool used = false;
};

struct SatelliteTrack {
    Satellite satellite;
    std::vector<SatelliteInView> epochs;
    std::vector<double> slips_s;
};

/// A value at a time, with its standard uncertainty.
struct ViewedValue {
    double time_s = 0.0;
    double value = 0.0;
    double standard_uncertainty = 0.0;
};

/// What the carrier phases around a window say, for its figures.
struct PhaseView {
    std::vector<SatelliteTrack> satellites;
    std::vector<double> refused_s;         ///< pairs of epochs that could not be judged: the second
    std::vector<ViewedValue> speed_m_s;    ///< horizontal, from epoch to epoch
    std::vector<ViewedValue> residuals_m;  ///< of each satellite, from epoch to epoch
    /// Displacement over the window's length by positions less that by phases, at its end.
    std::vector<ViewedValue> apart_east_m, apart_north_m;
};

/// Of the epochs of these phases. `window_s`: length of the window whose displacements are
/// compared. Empty lists where the phases say nothing; nothing where the positions have no place or
/// time.
std::optional<PhaseView> phase_view(JudgedPhases phases, const GpsTime& first_of_phases,
                                    const TrajectoryTable& trajectory, double window_s);

}  // namespace runcert

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/satellite.h"
#include "reports/run/run_view.h"
#include "store/program.h"
#include "surface/triangulation.h"
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

/// What these phases say, epoch by epoch; displacements are compared over `window_s`. Lists are
/// empty where the phases say nothing; no view where the positions have no place or no time.
std::optional<PhaseView> phase_view(JudgedPhases phases, const GpsTime& first_of_phases,
                                    const TrajectoryTable& trajectory, double window_s);

/// The headers of what the stages made of a receiver, and of the verdict, in the chain's order.
inline std::vector<const Header*> headers_of(const ReceiverResults& results,
                                             const Verdict& verdict) {
    return {&results.observations.header, &results.enu.header,     &results.screened.header,
            &results.trajectory.header,   &results.windows.header, &verdict.header};
}

/// A whole run folder, as the report needs it. The first receiver is judged; the files are what the
/// report vouches for, in the order in which they are to be listed.
struct ReportInputs : RunView {
    /// What the judged receiver's phases say around the first certified window, for its figures.
    std::optional<PhaseView> phase_view = {};
    std::optional<Triangulation> surface = {};  ///< that it ran on, in the run's frame
    /// What the receipts of the receivers' recordings show, in their order; empty where there is
    /// none, or no entry.
    std::vector<std::string> handed_in = {};

    /// Puts the results with second files in the place of those without, or back.
    void exchange_with_files() {
        std::swap(verdict.profiles, verdict.with_files);
        if (Windows& found = receivers.front().windows; !found.with_files.empty())
            std::swap(found.profiles, found.with_files);
    }
};

}  // namespace runcert

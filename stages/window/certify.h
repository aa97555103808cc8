#pragma once

#include <vector>

#include "stages/window/best_window.h"
#include "stages/window/speed_by_definition.h"
#include "stages/window/window.h"
#include "stages/window/witnesses.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// What windows are certified from, for horizontal speeds (Axes 2) or vertical ones (1).
template <int Axes>
struct AxesEstimate {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const NoiseSummary& noise;
    EstimationModel model;              ///< of the trajectory
    std::vector<WeightedModel> models;  ///< that the recording allows
    std::vector<Arc<Axes>> arcs;
    std::vector<ArcRows> rows;                    ///< of each arc, in the trajectory
    std::vector<std::vector<ElapsedTime>> times;  ///< of each arc's epochs
    HeardWitnesses<Axes> witnesses;
    double unexplained_m_s = 0.0;  ///< as `unexplained_by_velocities_m_s` has it
};

/// Failure where the trajectory does not have the arcs of the screened epochs, or does not say what
/// noise it was estimated with. Heights must have been measured for Axes 1.
template <int Axes>
AxesEstimate<Axes> estimate_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                               const WindowConfig& config, const WitnessRecords& beside);

/// A window that was found, among those that it was chosen from.
struct WindowChoice {
    const Profile& profile;
    const FoundWindow& found;
    const std::vector<FoundWindow>& all;  ///< that it is the best of, and itself
    SpeedQuantity quantity;
    double length_standard_uncertainty_m = 0.0;  ///< of quantity.length_m, of a course
};

/// The quantity that a profile's windows are certified by. Of a course the caller adds its length
/// and lines.
SpeedQuantity quantity_of(const Profile& profile);

/// The measured speed of a window with all sources of uncertainty; a vertical one is of heights
/// above the ellipsoid. What witnesses say of it stands beside it, and where they agree the budget
/// holds what they leave (`condition_on`). Failure where the trajectory is not the estimate from
/// these screened epochs.
template <int Axes>
CertifiableWindow certified(const AxesEstimate<Axes>& estimate, const WindowChoice& choice);

/// The speed in space of a window, from what both say of it by displacement: the two are at right
/// angles, and their errors are taken as fully correlated, because nothing is known of that.
CertifiableWindow in_space(const CertifiableWindow& horizontal, const CertifiableWindow& vertical);

}  // namespace runcert

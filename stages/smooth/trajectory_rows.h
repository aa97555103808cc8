#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/kalman.h"
#include "motion/sections.h"
#include "schemas/trajectory/declared.h"
#include "witness/arcs.h"

namespace runcert {

/// Data kept of a smoothed arc in addition to the rows of the table.
template <int Axes>
struct SmoothedMeans {
    std::vector<StateVector<Axes>> states;
    StateMatrix<Axes> covariance_in_the_middle;
    std::int64_t measurements = 0;
    double largest_condition = 0.0;  ///< of a covariance with its diagonal scaled to one
    double largest_asymmetry = 0.0;  ///< relative, of a covariance before it was made symmetric
};

/// The sections in which an arc is smoothed: as long as the model remembers beyond their ends, and
/// short enough to bound the memory. A short arc is one.
template <int Axes>
std::vector<ArcSection> smoothed_sections(std::span<const ArcEpoch<Axes>> epochs,
                                          const EstimationModel& model);

/// Smooths an arc and sets the smoothed motion of its rows (m, m/s, m/s^2), horizontal or vertical,
/// with its standard uncertainties. Condition and asymmetry are checked at every 16th epoch.
template <int Axes>
SmoothedMeans<Axes> smooth_rows(const Arc<Axes>& arc, const EstimationModel& model,
                                std::vector<TrajectoryEpoch>& rows);

/// Sets the jerk density used to estimate each epoch.
template <int Axes>
void set_jerk_density(const Arc<Axes>& arc, const EstimationModel& model,
                      std::vector<TrajectoryEpoch>& rows);

/// Sets the speeds by the methods of [DHD22] at the arc's usable positions.
void set_paper_methods(const Arc<2>& arc, double acceleration_sigma_m_s2,
                       std::vector<TrajectoryEpoch>& rows);

}  // namespace runcert

#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "satellites/line_of_sight.h"

namespace runcert {

/// The change of one satellite's carrier phase between two epochs of a receiver.
struct PhaseChange {
    std::array<Eigen::Vector3d, 2> satellite_m;  ///< position at each transmission
    std::array<double, 2> clock_m;               ///< satellite clock offset, times c
    double phase_m = 0.0;                        ///< second minus first phase, wavelength times
                                                 ///< cycles
};

/// Noise of the difference of two phases, for elevation el and time dt between them:
/// sigma^2 = white^2 (1 + 1/sin^2 el) + (rate dt / sin el)^2. Measured values of `white`: geodetic
/// receivers 0.9 mm, u-blox 1.2 mm standing still and 3.5 mm carried by a walker.
struct PhaseNoise {
    double white_m = 0.0012;
    double rate_m_s = 0.0012;

    double variance_m2(double sine_of_elevation, double interval_s) const;
};

/// Largest number of satellites used at once.
inline constexpr int most_phase_changes = 96;
using PhaseDesign = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, most_phase_changes, 4>;
using PhaseVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_phase_changes, 1>;

/// A displacement from the phases of at least four satellites.
struct PhaseDisplacement {
    Eigen::Vector3d enu_m;          ///< east, north, up at the place of the first epoch
    Eigen::Matrix3d covariance_m2;  ///< of white noise alone
    double clock_m = 0.0;           ///< change of the receiver clock offset, times c
    PhaseVector residuals_m;        ///< one for each satellite
    PhaseVector sigma_m;            ///< standard deviation used to weight each satellite's phase
    PhaseDesign design;             ///< design matrix of the whitened equations: east, north, up,
                                    ///< clock
    double statistic = 0.0;         ///< v'Wv, chi-squared with `redundancy` degrees of freedom
    int redundancy = 0;             ///< number of satellites minus 4
};

/// The displacement of a receiver between two epochs by time-differenced carrier phases (TDCP),
/// starting from `receiver` at the first. For every satellite
///   phase + (clock2 - clock1) - (T2 - T1) = |s2 - r2| - |s1 - r1| + c dtr,
/// solved for r2 and dtr by Gauss-Newton from r2 = r1. An error of 1 m in `receiver` causes 0.1 mm
/// horizontally and 0.8 mm vertically in 3 s. The covariance does not include systematic rates of
/// orbits, clocks and ionosphere: see `systematic_rate_m_s`. Empty with fewer than four satellites,
/// with more than `most_phase_changes`, or where they do not determine the displacement.
std::optional<PhaseDisplacement> phase_displacement(std::span<const PhaseChange> changes,
                                                    const ReceiverPosition& receiver,
                                                    double interval_s, const PhaseNoise& noise);

/// Standard deviation that systematic rates of all satellites cause in a horizontal velocity over
/// some seconds: 1 mm/s, or 3 mm/s with six satellites or fewer. Measured on receivers standing
/// still.
double systematic_rate_m_s(std::size_t satellites);

}  // namespace runcert

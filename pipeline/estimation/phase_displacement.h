#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "satellites/line_of_sight.h"

namespace runcert {

/// What one satellite's phase says of the way between two epochs of a receiver.
struct PhaseChange {
    std::array<Eigen::Vector3d, 2> satellite_m;  ///< each at its own transmission
    std::array<double, 2> clock_m;               ///< the satellite's, times c
    double phase_m = 0.0;                        ///< second minus first, wavelength times cycles
};

/// Noise of the difference of two phases, by elevation el and time dt between them:
/// sigma^2 = white^2 (1 + 1/sin^2 el) + (rate dt / sin el)^2. Measured on geodetic receivers: white
/// 0.9 mm; on u-blox 1.2 mm standing still, 3.5 mm carried by a walker.
struct PhaseNoise {
    double white_m = 0.0012;
    double rate_m_s = 0.0012;

    double variance_m2(double sine_of_elevation, double interval_s) const;
};

/// No more satellites are used at once.
inline constexpr int most_phase_changes = 96;
using PhaseDesign = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, most_phase_changes, 4>;
using PhaseVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_phase_changes, 1>;

/// A displacement by the phases of at least four satellites.
struct PhaseDisplacement {
    Eigen::Vector3d enu_m;          ///< east, north, up at the first epoch's place
    Eigen::Matrix3d covariance_m2;  ///< of white noise alone
    double clock_m = 0.0;           ///< change of the receiver's clock, times c
    PhaseVector residuals_m;        ///< of each satellite
    PhaseVector sigma_m;            ///< of each satellite's phase, as it was weighted
    PhaseDesign design;             ///< of the whitened equations: east, north, up, clock
    double statistic = 0.0;         ///< v'Wv, of which chi-square with `redundancy` is expected
    int redundancy = 0;             ///< satellites minus 4
};

/// The displacement of a receiver between two epochs by carrier phase differenced in time (TDCP),
/// from `place` at the first: for every satellite
///   phase + (clock2 - clock1) - (T2 - T1) = |s2 - r2| - |s1 - r1| + c dtr,
/// solved for r2 and dtr by Gauss-Newton from r2 = r1. A metre of error of `place` makes 0.1 mm
/// horizontally and 0.8 mm upwards in 3 s. Systematic rates of orbits, clocks and ionosphere are
/// not in the covariance: see `systematic_rate_m_s`. Nothing with fewer than four satellites, more
/// than `most_phase_changes`, or where they do not determine it.
std::optional<PhaseDisplacement> phase_displacement(std::span<const PhaseChange> changes,
                                                    const ReceiverPlace& place, double interval_s,
                                                    const PhaseNoise& noise);

/// Standard deviation of what systematic rates of all satellites do to a horizontal velocity over
/// some seconds: 1 mm/s, 3 mm/s with six satellites or fewer; measured on receivers standing still.
double systematic_rate_m_s(std::size_t satellites);

}  // namespace runcert

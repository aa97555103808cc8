#pragma once

#include <Eigen/Core>

#include "core/geodesy.h"
#include "schemas/observations/observations.h"
#include "stages/import/cell.h"
#include "stages/import/recording.h"

namespace runcert {

/// The fix type of u-blox' numbers of solutions (fixType of NAV-PVT): 2 and 3, in the plane and in
/// space, are `single`; 1 and 4, in which dead reckoning takes part, `dead_reckoning`; others
/// `none`.
FixType fix_of_ublox(unsigned type);

// Positions and accuracies as recordings give them, turned into those of an observation. A
// position that cannot be one of a craft (a latitude of 95 degrees, 100 km above or below the
// ellipsoid, an Earth-centred radius outside 6300 to 6600 km) fails at its cell.

/// A position of geographic coordinates, longitude from -180 to 360 degrees; the result's is from
/// -180 to 180. The cells are for messages.
Geodetic checked_geodetic(const Geodetic& position, const Cell& latitude, const Cell& longitude,
                          const Cell& height);

/// The same for a record of a binary format.
Geodetic checked_geodetic(const Geodetic& position, const RecordingBytes& recording,
                          const RecordPlace& place);

/// The position of Earth-centred coordinates (m).
Geodetic checked_ecef(const Eigen::Vector3d& position_m, const Cell& first);
Geodetic checked_ecef(const Eigen::Vector3d& position_m, const RecordingBytes& recording,
                      const RecordPlace& place);

/// Puts a WGS 84 position into a row.
void set_position(Observation& row, const Geodetic& position);

/// Puts a horizontal accuracy into a row: the radial one (m), root sum square of both coordinates',
/// of which each is given 1/sqrt(2), because it does not say how it is shared. Not positive or not
/// finite is unknown.
void set_radial_accuracy(StatedAccuracy& row, double radial_m);

/// Puts a recorded velocity (m/s) into a row.
void set_velocity(RecordedVelocity& row, double east_m_s, double north_m_s);

/// The course of so many degrees clockwise from true north, where there is one.
std::optional<Angle> course_of(const std::optional<double>& degrees);

/// Puts a recorded speed over ground (m/s) into a row: with its course, clockwise from true north,
/// from 0 to 360 degrees, as a velocity; without one, or with another, as a speed alone, because a
/// component must not be made up. A speed of zero is a velocity of zero in any direction. A speed
/// of -1, in whatever unit, is how telephones write that they know none; so is a course below zero.
/// Of any other speed that no craft has, the recording is refused (`set_rows`).
void set_speed(RecordedVelocity& row, double speed_m_s, const std::optional<Angle>& course);

/// Puts the accuracy of each component (m/s) of a recorded velocity, or of a recorded speed, into a
/// row, where none is stated yet.
void set_component_accuracy(RecordedVelocity& row, double sigma_m_s);

/// Puts the accuracy of a recorded velocity into a row: of its length in `axes` (2 or 3)
/// dimensions, root sum square of the coordinates', of which each is given 1/sqrt(axes). Only
/// velocities that are there are given one; so is a speed alone. Not positive or not finite is
/// unknown.
void set_velocity_accuracy(RecordedVelocity& row, double speed_sigma_m_s, int axes);

/// Standard deviations and correlations of a covariance (m^2, towards east, north, up). A
/// variance that is not positive leaves its deviation and correlations empty. A correlation
/// beyond +-1 is kept: screening judges.
StatedAccuracy accuracy_from_covariance(const Eigen::Matrix3d& covariance_m2);

/// A covariance from how RTKLIB prints it: three standard deviations, and for the pairs (0,1),
/// (1,2), (2,0) sign(c) sqrt(|c|) of the covariance c (RTKLIB 2.4.3 manual, appendix B).
Eigen::Matrix3d covariance_from_rtklib(const Eigen::Vector3d& deviations,
                                       const Eigen::Vector3d& signed_roots);

}  // namespace runcert

#pragma once

#include <span>
#include <string>

#include "simulation/simulate.h"

namespace runcert {

/// The recorded epochs as RTKLIB writes a solution (.pos; RTKLIB 2.4.3 manual, appendix B.1):
/// calendar GPS time, latitude, longitude, height. Failure (at "simulation") where the spec has
/// no place or no start time.
std::string rtklib_pos_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs);

/// The recorded epochs as CSV: epoch, time_s, east_m, north_m, up_m where heights are recorded,
/// and fix (fixed or float) where the spec has float stretches.
std::string plane_csv_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs);

/// The antenna's true run at every epoch, those inside gaps too, as CSV: time_s, east_m, north_m,
/// up_m, speed_m_s, acceleration_m_s2, to 6 decimals; with a craft its reference point, too:
/// reference_east_m, reference_north_m, reference_up_m, reference_speed_m_s, and the attitude:
/// roll_deg, pitch_deg, heading_deg. Speeds are horizontal.
std::string truth_csv_text(std::span<const SimulatedEpoch> epochs);

/// The samples of an IMU, as CSV: time_s, in seconds of the GPS week; gx, gy, gz (rad/s) and ax,
/// ay, az (m/s2), means over the interval that ends at that time, along the craft's axes forward,
/// right and down. `start` is the time from which the samples count.
std::string imu_csv_text(std::span<const ImuSample> samples, GpsTime start);

/// Speeds of a wheel, one for each epoch, as CSV: time_gps, or without a start time_s from the
/// first epoch that is recorded; speed_m_s.
std::string wheel_csv_text(std::span<const double> speeds_m_s,
                           std::span<const SimulatedEpoch> epochs,
                           const std::optional<GpsTime>& start);

}  // namespace runcert

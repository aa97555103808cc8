#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/gps_time.h"
#include "core/satellite.h"

namespace runcert {

/// The Earth's rotation rate used with broadcast orbits ([IS-GPS-200] table 20-IV).
inline constexpr double earth_rotation_rad_s = 7.2921151467e-5;

/// A satellite's broadcast orbit and clock: Keplerian elements with their corrections, of GPS
/// (LNAV) and Galileo (I/NAV, F/NAV). Angles are in radians. Names follow [IS-GPS-200] table
/// 20-III.
struct Ephemeris {
    Satellite satellite;
    GpsTime reference;        ///< reference time of the orbit (toe)
    GpsTime clock_reference;  ///< reference time of the clock (toc)
    double root_of_semi_major_axis = 0.0;
    double eccentricity = 0.0;
    double mean_anomaly = 0.0;
    double mean_motion_difference = 0.0;
    double inclination = 0.0;
    double inclination_rate = 0.0;
    double right_ascension = 0.0;  ///< at the weekly epoch (Omega 0)
    double right_ascension_rate = 0.0;
    double argument_of_perigee = 0.0;
    double cuc = 0.0, cus = 0.0, cic = 0.0, cis = 0.0;  ///< rad
    double crc = 0.0, crs = 0.0;                        ///< m
    double clock_offset_s = 0.0;
    double clock_drift = 0.0;
    double clock_drift_rate = 0.0;
    double group_delay_s = 0.0;  ///< of the first band's pseudorange relative to the clock
    std::int32_t issue = 0;      ///< IODE, IODnav
    bool healthy = true;
    bool is_fnav = false;    ///< Galileo F/NAV, whose clock refers to another pair of signals
    std::int32_t file = 0;   ///< index of the navigation file it comes from, counted from 0
    std::int64_t place = 0;  ///< line or byte at which it begins in its file
};

/// Whether the numbers can be those of a navigation satellite's orbit and clock.
bool is_plausible(const Ephemeris& ephemeris);

/// The instant at this second of a week (0 to 604800) that is nearest to another instant.
GpsTime nearest_of_week(double second_of_week, GpsTime near);

/// A satellite at an instant, in WGS 84 (Earth-centred, Earth-fixed at that instant).
struct SatelliteState {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    double clock_s = 0.0;  ///< clock offset, positive ahead of GPS time, with the relativistic
                           ///< term, without group delay
};

/// Orbit and clock of an ephemeris at an instant: [IS-GPS-200] table 20-IV and 20.3.3.3.3.1,
/// [GAL-ICD] tables 63 and 66. Agrees with RTKLIB's eph2pos to 1 um.
SatelliteState satellite_state(const Ephemeris& ephemeris, GpsTime time);

/// The state `after_s` seconds after an instant, for times that are not whole nanoseconds.
SatelliteState state_after(const Ephemeris& ephemeris, GpsTime time, double after_s);

/// The state when a signal was transmitted. The receiver measured the signal at `reception` by its
/// own clock with this pseudorange (m). The receiver's clock error cancels out.
SatelliteState state_at_transmission(const Ephemeris& ephemeris, GpsTime reception,
                                     double pseudorange_m);

/// Ephemerides of many satellites. The ephemeris chosen for a satellite is kept as long as it is
/// valid, so that its orbit has no avoidable steps.
class Ephemerides {
  public:
    /// An ephemeris is used up to this long before and after its reference time: half the fit
    /// interval of [IS-GPS-200] 20.3.4.4, for Galileo too.
    static constexpr double valid_for_s = 7200.0;

    explicit Ephemerides(std::vector<Ephemeris> all);

    /// The index (in `all`) of the satellite's ephemeris at an instant. Empty if none is valid.
    /// Calls must be in order of time.
    std::optional<std::size_t> choose(Satellite satellite, GpsTime time);

    /// The index (in `all`) of the satellite's ephemeris nearest in time, valid or not. Empty if
    /// the satellite has none.
    std::optional<std::size_t> nearest(Satellite satellite, GpsTime time) const;

    const Ephemeris& operator[](std::size_t index) const { return all_[index]; }
    const std::vector<Ephemeris>& all() const { return all_; }

  private:
    std::vector<Ephemeris> all_;  ///< ordered by satellite, then reference time
    std::vector<std::optional<std::size_t>> chosen_;
};

}  // namespace runcert

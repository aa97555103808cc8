#include "satellites/ephemeris.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace runcert {
namespace {

double gravitation(SatelliteSystem system) {
    return system == SatelliteSystem::galileo ? 3.986004418e14 : 3.9860050e14;
}

/// Solves Kepler's equation by Newton's method. Eccentricities of these orbits are below 0.03, and
/// those of any ephemeris below 1.
double eccentric_anomaly(double mean_anomaly, double eccentricity) {
    double anomaly = mean_anomaly;
    for (int step = 0; step < 30; ++step) {
        const double change = (anomaly - eccentricity * std::sin(anomaly) - mean_anomaly) /
                              (1.0 - eccentricity * std::cos(anomaly));
        anomaly -= change;
        if (std::abs(change) < 1e-14) break;
    }
    return anomaly;
}

double clock_polynomial(const Ephemeris& ephemeris, GpsTime time) {
    const double t = time.seconds_since(ephemeris.clock_reference);
    return ephemeris.clock_offset_s + t * (ephemeris.clock_drift + t * ephemeris.clock_drift_rate);
}

std::size_t index_of(Satellite satellite) {
    return static_cast<std::size_t>(satellite.system) * 100 + satellite.number % 100;
}

}  // namespace

bool is_plausible(const Ephemeris& e) {
    const auto below = [](double bound, auto... values) {
        return (... && (std::abs(values) < bound));  // false for NaN
    };
    return e.root_of_semi_major_axis > 4500.0 && e.root_of_semi_major_axis < 7000.0 &&
           e.eccentricity >= 0.0 && e.eccentricity < 0.5 &&
           below(7.0, e.mean_anomaly, e.inclination, e.right_ascension, e.argument_of_perigee) &&
           below(1e-6, e.mean_motion_difference, e.right_ascension_rate, e.inclination_rate) &&
           below(1e-2, e.cuc, e.cus, e.cic, e.cis) && below(1e5, e.crc, e.crs) &&
           below(0.1, e.clock_offset_s) && below(1e-6, e.clock_drift, e.group_delay_s) &&
           below(1e-9, e.clock_drift_rate) &&
           below(86'400.0, e.reference.seconds_since(e.clock_reference));
}

GpsTime nearest_of_week(double second_of_week, GpsTime near) {
    const auto second = static_cast<std::int64_t>(std::llround(second_of_week * 1e9));
    std::int64_t apart = second - near.nanoseconds_of_week();
    if (apart > GpsTime::nanoseconds_per_week / 2) apart -= GpsTime::nanoseconds_per_week;
    if (apart < -GpsTime::nanoseconds_per_week / 2) apart += GpsTime::nanoseconds_per_week;
    return near.plus_nanoseconds(apart);
}

SatelliteState state_after(const Ephemeris& e, GpsTime time, double after_s) {
    const double t = time.seconds_since(e.reference) + after_s;
    const double mu = gravitation(e.satellite.system);
    const double a = e.root_of_semi_major_axis * e.root_of_semi_major_axis;
    const double motion = std::sqrt(mu / (a * a * a)) + e.mean_motion_difference;
    const double anomaly = eccentric_anomaly(e.mean_anomaly + motion * t, e.eccentricity);
    const double sin_e = std::sin(anomaly), cos_e = std::cos(anomaly);
    const double latitude = std::atan2(std::sqrt(1.0 - e.eccentricity * e.eccentricity) * sin_e,
                                       cos_e - e.eccentricity) +
                            e.argument_of_perigee;
    const double sin_2u = std::sin(2.0 * latitude), cos_2u = std::cos(2.0 * latitude);
    const double u = latitude + e.cus * sin_2u + e.cuc * cos_2u;
    const double radius = a * (1.0 - e.eccentricity * cos_e) + e.crs * sin_2u + e.crc * cos_2u;
    const double inclination =
        e.inclination + e.inclination_rate * t + e.cis * sin_2u + e.cic * cos_2u;
    const double of_week_s = static_cast<double>(e.reference.nanoseconds_of_week()) * 1e-9;
    const double node = e.right_ascension + (e.right_ascension_rate - earth_rotation_rad_s) * t -
                        earth_rotation_rad_s * of_week_s;
    const double x = radius * std::cos(u), y = radius * std::sin(u);
    const double sin_node = std::sin(node), cos_node = std::cos(node);
    const double cos_i = std::cos(inclination);
    SatelliteState state;
    state.position_m = {x * cos_node - y * cos_i * sin_node, x * sin_node + y * cos_i * cos_node,
                        y * std::sin(inclination)};
    const double since_clock = time.seconds_since(e.clock_reference) + after_s;
    state.clock_s = e.clock_offset_s +
                    since_clock * (e.clock_drift + since_clock * e.clock_drift_rate) -
                    2.0 * std::sqrt(mu * a) * e.eccentricity * sin_e /
                        (speed_of_light_m_s * speed_of_light_m_s);
    return state;
}

SatelliteState satellite_state(const Ephemeris& ephemeris, GpsTime time) {
    return state_after(ephemeris, time, 0.0);
}

SatelliteState state_at_transmission(const Ephemeris& ephemeris, GpsTime reception,
                                     double pseudorange_m) {
    const double travel_s = pseudorange_m / speed_of_light_m_s;
    // The clock polynomial suffices to date the transmission; the relativistic term is negligible
    // here.
    const double clock_s = clock_polynomial(ephemeris, reception);
    return state_after(ephemeris, reception, -travel_s - clock_s);
}

Ephemerides::Ephemerides(std::vector<Ephemeris> all) : all_(std::move(all)), chosen_(7 * 100) {
    std::ranges::stable_sort(all_, [](const Ephemeris& a, const Ephemeris& b) {
        if (a.satellite != b.satellite) return a.satellite < b.satellite;
        // Of two with the same time the first is found, so I/NAV comes first.
        if (a.reference != b.reference) return a.reference < b.reference;
        return a.is_fnav < b.is_fnav;
    });
}

std::optional<std::size_t> Ephemerides::nearest(Satellite satellite, GpsTime time) const {
    std::optional<std::size_t> found;
    double least_s = std::numeric_limits<double>::infinity();
    const auto first = std::ranges::lower_bound(all_, satellite, {}, &Ephemeris::satellite);
    const auto last = std::ranges::upper_bound(all_, satellite, {}, &Ephemeris::satellite);
    for (auto each = first; each != last; ++each) {
        const double age_s = std::abs(time.seconds_since(each->reference));
        // F/NAV only where nothing else is valid.
        const double rank_s = age_s + (each->is_fnav ? valid_for_s : 0.0);
        if (rank_s >= least_s) continue;
        least_s = rank_s;
        found = static_cast<std::size_t>(each - all_.begin());
    }
    return found;
}

std::optional<std::size_t> Ephemerides::choose(Satellite satellite, GpsTime time) {
    std::optional<std::size_t>& chosen = chosen_[index_of(satellite)];
    const auto is_valid = [&](std::size_t i) {
        return std::abs(time.seconds_since(all_[i].reference)) <= valid_for_s;
    };
    if (chosen && is_valid(*chosen)) return chosen;
    chosen = nearest(satellite, time);
    if (chosen && !is_valid(*chosen)) chosen.reset();
    return chosen;
}

}  // namespace runcert

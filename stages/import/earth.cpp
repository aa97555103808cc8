#include "stages/import/earth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/speed_unit.h"
#include "stages/import/row_collector.h"

namespace runcert {
namespace {

constexpr double largest_height_m = 100e3;
constexpr double least_radius_m = 6.3e6;
constexpr double largest_radius_m = 6.6e6;

/// Whether it is -1 in some unit, which is how telephones write that they know none.
bool means_none(double speed_m_s) {
    return std::ranges::any_of(std::array{"m/s", "km/h", "kn", "mph"}, [&](const char* unit) {
        return std::abs(speed_m_s + metres_per_second(unit)) < 1e-9;
    });
}

std::optional<double> finite(double value) {
    if (!std::isfinite(value)) return std::nullopt;
    return value;
}

/// Why a position cannot be one of a craft, and which of its coordinates says so.
struct Impossible {
    int coordinate = 0;  ///< 0 latitude, 1 longitude, 2 height
    std::string what;
    std::string remedy;
};

std::optional<Impossible> find_impossible(const Geodetic& position) {
    const double latitude_deg = position.latitude.degrees();
    const double longitude_deg = position.longitude.degrees();
    if (!(std::abs(latitude_deg) <= 90.0))
        return Impossible{
            0, fmt::format("a latitude of {} degrees is impossible", latitude_deg),
            std::abs(longitude_deg) <= 90.0 && latitude_deg >= -180.0 && latitude_deg <= 360.0
                ? "Are latitude and longitude swapped?"
                : "Latitudes are within 90 degrees of the equator; check the columns"};
    if (!(longitude_deg >= -180.0 && longitude_deg <= 360.0))
        return Impossible{1, fmt::format("a longitude of {} degrees is impossible", longitude_deg),
                          "Longitudes are -180 to 360 degrees, east positive; check the columns"};
    if (!(std::abs(position.height_m) <= largest_height_m))
        return Impossible{2, fmt::format("a height of {} m is impossible", position.height_m),
                          "Heights are metres above the ellipsoid, within 100 km of it; check the "
                          "columns and their units"};
    return std::nullopt;
}

Geodetic with_signed_longitude(Geodetic position) {
    const double longitude_deg = position.longitude.degrees();
    if (longitude_deg > 180.0) position.longitude = Angle::from_degrees(longitude_deg - 360.0);
    return position;
}

Geodetic require_near_surface(const Eigen::Vector3d& position_m, const std::string& where) {
    const double radius_m = position_m.norm();
    if (!(radius_m >= least_radius_m && radius_m <= largest_radius_m))
        throw Failure(where,
                      fmt::format("the position is {:.0f} km from the centre of the Earth",
                                  radius_m / 1000.0),
                      "Earth-centred coordinates are metres, 6300 to 6600 km from the centre; "
                      "check the columns and their units");
    return geodetic_from_ecef(Ecef{position_m});
}

}  // namespace

FixType fix_of_ublox(unsigned type) {
    if (type == 1 || type == 4) return FixType::dead_reckoning;
    return type == 2 || type == 3 ? FixType::single : FixType::none;
}

Geodetic checked_geodetic(const Geodetic& position, const Cell& latitude, const Cell& longitude,
                          const Cell& height) {
    if (const auto why = find_impossible(position)) {
        const Cell& cell =
            why->coordinate == 0 ? latitude : (why->coordinate == 1 ? longitude : height);
        cell.fail(why->what, why->remedy);
    }
    return with_signed_longitude(position);
}

Geodetic checked_geodetic(const Geodetic& position, const RecordingBytes& recording,
                          const RecordPlace& place) {
    if (const auto why = find_impossible(position))
        throw Failure(place_in(recording, place), why->what,
                      "The record is damaged; take the recording as the receiver wrote it");
    return with_signed_longitude(position);
}

Geodetic checked_ecef(const Eigen::Vector3d& position_m, const Cell& first) {
    return require_near_surface(position_m, first.place());
}

Geodetic checked_ecef(const Eigen::Vector3d& position_m, const RecordingBytes& recording,
                      const RecordPlace& place) {
    return require_near_surface(position_m, place_in(recording, place));
}

void set_position(Observation& row, const Geodetic& position) {
    row.latitude_deg = position.latitude.degrees();
    row.longitude_deg = position.longitude.degrees();
    row.height_m = position.height_m;
}

void set_radial_accuracy(StatedAccuracy& row, double radial_m) {
    if (!(radial_m > 0.0) || !std::isfinite(radial_m)) return;
    row.sigma_east_m = row.sigma_north_m = radial_m / std::sqrt(2.0);
}

void set_velocity(RecordedVelocity& row, double east_m_s, double north_m_s) {
    row.recorded_velocity_east_m_s = east_m_s;
    row.recorded_velocity_north_m_s = north_m_s;
}

std::optional<Angle> course_of(const std::optional<double>& degrees) {
    return degrees ? std::optional(Angle::from_degrees(*degrees)) : std::nullopt;
}

void set_speed(RecordedVelocity& row, double speed_m_s, const std::optional<Angle>& course) {
    if (means_none(speed_m_s)) return;
    if (speed_m_s == 0.0) return set_velocity(row, 0.0, 0.0);
    const bool known =
        speed_m_s > 0.0 && course && course->degrees() >= 0.0 && course->degrees() <= 360.0;
    if (known)
        set_velocity(row, speed_m_s * std::sin(course->radians()),
                     speed_m_s * std::cos(course->radians()));
    else
        row.recorded_speed_m_s = speed_m_s;
}

void set_component_accuracy(RecordedVelocity& row, double sigma_m_s) {
    if (has_velocity_accuracy(row)) return;
    if (row.recorded_speed_m_s) row.sigma_recorded_speed_m_s = sigma_m_s;
    if (!has_velocity(row)) return;
    row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s = sigma_m_s;
    if (row.recorded_velocity_up_m_s && !row.sigma_recorded_velocity_up_m_s)
        row.sigma_recorded_velocity_up_m_s = sigma_m_s;
}

void set_velocity_accuracy(RecordedVelocity& row, double speed_sigma_m_s, int axes) {
    if (!(speed_sigma_m_s > 0.0) || !std::isfinite(speed_sigma_m_s)) return;
    const double each_m_s = speed_sigma_m_s / std::sqrt(static_cast<double>(axes));
    if (row.recorded_velocity_east_m_s) row.sigma_recorded_velocity_east_m_s = each_m_s;
    if (row.recorded_velocity_north_m_s) row.sigma_recorded_velocity_north_m_s = each_m_s;
    if (row.recorded_speed_m_s) row.sigma_recorded_speed_m_s = each_m_s;
    if (row.recorded_velocity_up_m_s && axes == 3) row.sigma_recorded_velocity_up_m_s = each_m_s;
}

StatedAccuracy accuracy_from_covariance(const Eigen::Matrix3d& covariance_m2) {
    const auto sigma = [&](int axis) -> std::optional<double> {
        if (!(covariance_m2(axis, axis) > 0.0)) return std::nullopt;
        return std::sqrt(covariance_m2(axis, axis));
    };
    StatedAccuracy accuracy;
    accuracy.sigma_east_m = sigma(0);
    accuracy.sigma_north_m = sigma(1);
    accuracy.sigma_up_m = sigma(2);
    const auto correlation = [&](int a, int b) -> std::optional<double> {
        if (!sigma(a) || !sigma(b)) return std::nullopt;
        return finite(covariance_m2(a, b) / (*sigma(a) * *sigma(b)));
    };
    accuracy.correlation_east_north = correlation(0, 1);
    accuracy.correlation_east_up = correlation(0, 2);
    accuracy.correlation_north_up = correlation(1, 2);
    return accuracy;
}

Eigen::Matrix3d covariance_from_rtklib(const Eigen::Vector3d& deviations,
                                       const Eigen::Vector3d& signed_roots) {
    Eigen::Matrix3d covariance = deviations.cwiseAbs2().asDiagonal();
    for (const int a : {0, 1, 2}) {
        const int b = (a + 1) % 3;
        const double root = signed_roots(a);
        covariance(a, b) = covariance(b, a) = std::copysign(root * root, root);
    }
    return covariance;
}

}  // namespace runcert

#include "reports/compare/enhanced_kalman.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "core/angle.h"

namespace runcert {
namespace {

constexpr double equatorial_radius_m = 6'378'137.0;
constexpr double flattening = 1.0 / 298.257223563;
constexpr double eccentricity_squared = flattening * (2.0 - flattening);

/// Metres to a degree of latitude and of longitude.
struct MetresPerDegree {
    double latitude = 0.0;
    double longitude = 0.0;
};

MetresPerDegree metres_per_degree(double latitude_deg, double height_m) {
    const Angle latitude = Angle::from_degrees(latitude_deg);
    const RadiiOfCurvature radii = radii_of_curvature(latitude);
    return {.latitude = (radii.meridian_m + height_m) / degrees_per_radian,
            .longitude = (radii.prime_vertical_m + height_m) * std::cos(latitude.radians()) /
                         degrees_per_radian};
}

/// What was measured of the velocity between two epochs.
std::optional<MeasuredVelocity> velocity_between(const EnhancedKalmanEpoch& before,
                                                 const EnhancedKalmanEpoch& after) {
    if (!before.velocity) return after.velocity;
    if (!after.velocity) return before.velocity;
    return MeasuredVelocity{.enu_m_s = 0.5 * (before.velocity->enu_m_s + after.velocity->enu_m_s),
                            .covariance_m2_s2 = 0.5 * (before.velocity->covariance_m2_s2 +
                                                       after.velocity->covariance_m2_s2)};
}

EnhancedKalmanState updated(const EnhancedKalmanState& predicted,
                            const MeasuredGeodetic& measured) {
    const Eigen::Matrix3d innovation_covariance =
        predicted.covariance_enu_m2 + measured.covariance_enu_m2;
    const Eigen::Matrix3d gain = predicted.covariance_enu_m2 * innovation_covariance.inverse();
    const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain;
    EnhancedKalmanState state;
    state.position =
        moved_by(predicted.position, gain * step_between(predicted.position, measured.position));
    // Joseph form: symmetric and positive whatever the rounding of the gain.
    state.covariance_enu_m2 = keep * predicted.covariance_enu_m2 * keep.transpose() +
                              gain * measured.covariance_enu_m2 * gain.transpose();
    return state;
}

}  // namespace

RadiiOfCurvature radii_of_curvature(Angle latitude) {
    const double sine = std::sin(latitude.radians());
    const double w_squared = 1.0 - eccentricity_squared * sine * sine;
    const double prime_vertical_m = equatorial_radius_m / std::sqrt(w_squared);
    return {.meridian_m = prime_vertical_m * (1.0 - eccentricity_squared) / w_squared,
            .prime_vertical_m = prime_vertical_m};
}

Geodetic moved_by(const Geodetic& from, const Eigen::Vector3d& enu_m) {
    const double latitude_deg = from.latitude.degrees();
    const double halfway_m = from.height_m + 0.5 * enu_m.z();
    const double halfway_deg =
        latitude_deg + 0.5 * enu_m.y() / metres_per_degree(latitude_deg, halfway_m).latitude;
    const MetresPerDegree scale = metres_per_degree(halfway_deg, halfway_m);
    return {.latitude = Angle::from_degrees(latitude_deg + enu_m.y() / scale.latitude),
            .longitude = Angle::from_degrees(
                std::remainder(from.longitude.degrees() + enu_m.x() / scale.longitude, 360.0)),
            .height_m = from.height_m + enu_m.z()};
}

Eigen::Vector3d step_between(const Geodetic& from, const Geodetic& to) {
    const MetresPerDegree scale =
        metres_per_degree(0.5 * (from.latitude.degrees() + to.latitude.degrees()),
                          0.5 * (from.height_m + to.height_m));
    return {
        std::remainder(to.longitude.degrees() - from.longitude.degrees(), 360.0) * scale.longitude,
        (to.latitude.degrees() - from.latitude.degrees()) * scale.latitude,
        to.height_m - from.height_m};
}

std::vector<std::optional<EnhancedKalmanState>> filter_enhanced_kalman(
    std::span<const EnhancedKalmanEpoch> epochs) {
    std::vector<std::optional<EnhancedKalmanState>> states;
    states.reserve(epochs.size());
    std::optional<EnhancedKalmanState> state;
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        const EnhancedKalmanEpoch& epoch = epochs[k];
        const std::optional<MeasuredVelocity> input =
            state ? velocity_between(epochs[k - 1], epoch) : std::nullopt;
        if (input) {
            const double dt_s = epoch.time_s - epochs[k - 1].time_s;
            const Geodetic before = state->position;
            state->position = moved_by(before, input->enu_m_s * dt_s);
            state->covariance_enu_m2 += input->covariance_m2_s2 * dt_s * dt_s;
            if (epoch.position) state = updated(*state, *epoch.position);
            state->velocity_enu_m_s = step_between(before, state->position) / dt_s;
        } else if (epoch.position) {
            state = EnhancedKalmanState{.position = epoch.position->position,
                                        .covariance_enu_m2 = epoch.position->covariance_enu_m2,
                                        .velocity_enu_m_s = std::nullopt};
        } else {
            state.reset();
        }
        states.push_back(state);
    }
    return states;
}

}  // namespace runcert

#include "inertial/solution.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/statistics.h"
#include "inertial/attitude.h"
#include "inertial/joint_covariance.h"

namespace runcert {
namespace {

constexpr double largest_nis = 2.0, least_nis = 0.3;
/// What an unknown heading may move the reference point by.
constexpr double heading_effect_m = 0.05;
/// RMS change of the vertical axis in a second from which a vertical lever arm shows. A car on
/// roads has 0.015, with which an arm of 0 came out as up to 0.85 m; a craft that rolls by 3
/// degrees 0.06.
constexpr double least_tilt_change_rad = 0.026;
/// Epochs at the start whose innovations test a vague prior.
constexpr std::size_t prior_epochs = 10;

PointMotion point_of(const InertialNominal& at, const ErrorMatrix& covariance,
                     const Eigen::Vector3d& arm_m, const Eigen::Vector3d& rate, double offset_s,
                     double rate_variance) {
    const Eigen::Matrix3d& c = at.state.enu_from_body;
    PointMotion point;
    point.velocity_m_s = at.state.velocity_m_s + c * rate.cross(arm_m);
    point.position_m = at.state.position_m + c * arm_m + offset_s * point.velocity_m_s;
    const auto position = point_jacobian(c, arm_m, point.velocity_m_s);
    const auto velocity = point_velocity_jacobian(c, arm_m, rate);
    point.position_covariance_m2 = position * covariance * position.transpose();
    const Eigen::Matrix3d turning = c * cross_matrix(arm_m);
    point.velocity_covariance_m2_s2 = velocity * covariance * velocity.transpose() +
                                      rate_variance * turning * turning.transpose();
    return point;
}

/// RMS change of the body's vertical axis in a second.
double tilt_change_rad(const std::vector<InertialEpoch>& epochs) {
    double squares = 0.0;
    double count = 0.0;
    std::size_t after = 0;
    for (const InertialEpoch& epoch : epochs) {
        while (after < epochs.size() && epochs[after].time_s < epoch.time_s + 1.0)
            ++after;
        if (after == epochs.size()) break;
        squares += (epochs[after].enu_from_body.row(2) - epoch.enu_from_body.row(2)).squaredNorm();
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// Of a sample's rate (rad^2/s^2), by the angular random walk alone.
double rate_variance_of(const InertialData& data) {
    const double walk = data.noise.angle_walk_rad_sqrt_s;
    return walk * walk / data.samples.front().interval_s;
}

EulerAngles sigmas(const Eigen::Matrix3d& c, const Eigen::Matrix3d& covariance) {
    const Eigen::Matrix3d jacobian = euler_jacobian(c);
    const Eigen::Vector3d sigma =
        (jacobian * covariance * jacobian.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    return {sigma.x(), sigma.y(), sigma.z()};
}

InertialEpoch epoch_of(const InertialPass& pass, std::size_t k, const InertialData& data,
                       const InertialSetup& setup) {
    using namespace error_state;
    const InertialNominal at = pass.solution(k);
    const ErrorMatrix& covariance = pass.covariance[k];
    const double carried_s = pass.carried_offset_s;
    InertialEpoch epoch;
    epoch.time_s = data.fixes[k].time_s;
    epoch.enu_from_body = at.state.enu_from_body;
    epoch.attitude = euler_angles(at.state.enu_from_body);
    epoch.attitude_sigma = sigmas(at.state.enu_from_body, covariance.topLeftCorner<3, 3>());
    epoch.rate_rad_s = measured_rate_rad_s(data.samples, epoch.time_s + carried_s) -
                       at.bias.gyro_rad_s -
                       at.state.enu_from_body.transpose() * data.earth.rotation_rad_s();
    const auto point = [&](const Eigen::Vector3d& arm_m) {
        return point_of(at, covariance, arm_m, epoch.rate_rad_s, at.time_offset_s - carried_s,
                        rate_variance_of(data));
    };
    epoch.antenna = point(at.antenna_m);
    epoch.reference_point = point(setup.reference_point_m);
    epoch.bias = at.bias;
    const auto sigma = [&](int from) -> Eigen::Vector3d {
        return covariance.diagonal().segment<3>(from).cwiseSqrt();
    };
    epoch.bias_sigma = {sigma(gyro_bias), sigma(accelerometer_bias)};
    epoch.position_error_m = at.position_error_m;
    epoch.innovation = pass.innovations[k].whitened;
    const auto h = point_jacobian(at.state.enu_from_body, at.antenna_m, epoch.antenna.velocity_m_s);
    ErrorJacobian with_arm = h;
    with_arm.middleCols<3>(lever_arm) = at.state.enu_from_body;
    epoch.antenna.position_covariance_m2 = with_arm * covariance * with_arm.transpose();
    return epoch;
}

InertialStatistics consistency_of(const std::vector<InertialEpoch>& epochs) {
    InertialStatistics result;
    const double limit = chi_squared_quantile(0.999, 3);
    const std::size_t first = std::min(prior_epochs, epochs.size() / 2);
    double products = 0.0;
    double squares = 0.0;
    double beyond = 0.0;
    for (std::size_t k = first; k < epochs.size(); ++k) {
        const Eigen::Vector3d& v = epochs[k].innovation;
        result.axis_nis += v.cwiseAbs2();
        squares += v.squaredNorm();
        if (v.squaredNorm() > limit) beyond += 1.0;
        if (k + 1 < epochs.size()) products += v.dot(epochs[k + 1].innovation);
    }
    const double count = static_cast<double>(epochs.size() - first);
    result.axis_nis /= count;
    result.nis = squares / (3.0 * count);
    result.lag_one_correlation = squares > 0.0 ? products / squares : 0.0;
    result.beyond_share = beyond / count;
    std::vector<double> all;
    for (std::size_t k = first; k < epochs.size(); ++k)
        all.push_back(epochs[k].innovation.squaredNorm());
    result.usual_nis = median(all) / chi_squared_quantile(0.5, 3);
    return result;
}

void find_doubts(InertialSolution& solution, const InertialSetup& setup, double turned) {
    auto& doubts = solution.consistency.doubts;
    const double nis = solution.consistency.nis;
    if (!(nis <= largest_nis))
        doubts.push_back({InertialFinding::innovations_large, nis, largest_nis});
    if (nis < least_nis) doubts.push_back({InertialFinding::innovations_small, nis, least_nis});
    const double horizontal_arm_m =
        (setup.reference_point_m - solution.antenna_m.value).head<2>().norm();
    double effect_m = 0.0;
    for (const InertialEpoch& epoch : solution.epochs)
        effect_m = std::max(effect_m, epoch.attitude_sigma.heading * horizontal_arm_m);
    if (effect_m > heading_effect_m)
        doubts.push_back({InertialFinding::heading_unobservable, effect_m, heading_effect_m});
    const double change = tilt_change_rad(solution.epochs);
    if (setup.estimate_antenna && change < least_tilt_change_rad)
        doubts.push_back(
            {InertialFinding::vertical_arm_unobservable, change, least_tilt_change_rad});
    if (turned > 1.0) doubts.push_back({InertialFinding::not_converged, turned, 1.0});
}

/// Steps between positions well above the median, and those where samples are missing.
std::vector<BridgedStretch> bridged_spans(const InertialPass& pass, const InertialData& data) {
    const std::vector<PositionFix>& fixes = data.fixes;
    std::vector<double> steps;
    for (std::size_t k = 1; k < fixes.size(); ++k)
        steps.push_back(fixes[k].time_s - fixes[k - 1].time_s);
    constexpr double usual = 2.5;
    const double longest_s = usual * median(steps);
    std::vector<BridgedStretch> spans;
    for (std::size_t k = 1; k < fixes.size(); ++k) {
        const bool missing = pass.imu_gap_s[k] > 0.0;
        if (missing || steps[k - 1] > longest_s)
            spans.push_back({fixes[k - 1].time_s, fixes[k].time_s, missing});
    }
    return spans;
}

}  // namespace

bool InertialStatistics::tells_motion() const {
    const auto fails = [](const InertialDoubt& doubt) {
        return doubt.finding == InertialFinding::not_converged ||
               doubt.finding == InertialFinding::noise_large ||
               doubt.finding == InertialFinding::innovations_small;
    };
    return usual_nis <= largest_nis && usual_nis >= least_nis &&
           std::ranges::none_of(doubts, fails);
}

InertialSolution solution_of(InertialPass&& pass, const InertialData& data,
                             const InertialSetup& setup, double turned) {
    InertialSolution solution;
    const std::size_t count = pass.nominal.size();
    solution.epochs.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
        solution.epochs.push_back(epoch_of(pass, k, data, setup));
    const InertialNominal last = pass.solution(count - 1);
    solution.antenna_m = {last.antenna_m, Eigen::Vector3d::Constant(setup.antenna_sigma_m)};
    solution.time_offset_s.value = last.time_offset_s;
    const ErrorVector sigma = pass.covariance.back().diagonal().cwiseSqrt();
    if (setup.estimate_antenna) solution.antenna_m.sigma = sigma.segment<3>(error_state::lever_arm);
    if (setup.estimate_time_offset) solution.time_offset_s.sigma = sigma(error_state::time_offset);
    solution.log_likelihood = pass.log_likelihood;
    solution.noise = data.noise;
    solution.bridged = bridged_spans(pass, data);
    solution.consistency = consistency_of(solution.epochs);
    find_doubts(solution, setup, turned);
    auto joint = std::make_shared<JointCovariance>();
    joint->errors = {std::move(pass.covariance), std::move(pass.gain)};
    joint->stretch = StretchErrors(pass);
    joint->reference_point_m = setup.reference_point_m;
    joint->antenna_m = last.antenna_m;
    joint->antenna_sigma_m = setup.estimate_antenna ? 0.0 : setup.antenna_sigma_m;
    joint->rate_variance = rate_variance_of(data);
    solution.joint = std::move(joint);
    return solution;
}

}  // namespace runcert

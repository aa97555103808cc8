#include "inertial/inertial_filter.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/failure.h"

namespace runcert {
namespace {

using namespace error_state;

/// Errors are carried over steps of so long at most (one sample, if that is longer).
constexpr double error_step_s = 0.0199;
/// What the rates may be wrong by where samples are missing.
constexpr double missing_rate_rad_s = 0.3;
constexpr double missing_acceleration_m_s2 = 3.0;

/// Carries nominal values and errors from epoch to epoch.
class Carrier {
  public:
    Carrier(const InertialData& data, double begin_s) : data_(data), reader_(data.samples) {
        reader_.seek(begin_s);
    }

    void carry(InertialNominal& nominal, ErrorMatrix& covariance, ErrorMatrix& product,
               double until_s) {
        product.setIdentity();
        gap_s_ = 0.0;
        while (true) {
            ErrorStep step;
            const Eigen::Matrix3d first = nominal.state.enu_from_body;
            Eigen::Vector3d force = Eigen::Vector3d::Zero();
            Eigen::Vector3d turned = Eigen::Vector3d::Zero();
            const Eigen::Vector3d velocity = nominal.state.velocity_m_s;
            while (step.dt_s < error_step_s) {
                const auto piece = reader_.next(until_s);
                if (!piece) break;
                take(*piece, nominal, step, force, turned);
            }
            if (step.dt_s == 0.0) break;
            step.enu_from_body = 0.5 * (first + nominal.state.enu_from_body);
            step.specific_force_m_s2 = force / step.dt_s;
            step.rate_rad_s = turned.norm() / step.dt_s;
            step.acceleration_m_s2 = (nominal.state.velocity_m_s - velocity).norm() / step.dt_s;
            const ErrorTransition transition =
                error_transition(step, data_.position_error, data_.earth);
            propagate(covariance, transition, error_noise(step, data_.noise, data_.position_error));
            transition.apply(product);
            nominal.position_error_m *= transition.error;
        }
        // Rounding alone takes it from a rotation, so one step of Newton's iteration is enough.
        Eigen::Matrix3d& c = nominal.state.enu_from_body;
        c = (0.5 * c * (3.0 * Eigen::Matrix3d::Identity() - c.transpose() * c)).eval();
    }

    /// The measured rate of the last piece.
    const Eigen::Vector3d& rate_rad_s() const { return rate_; }
    double gap_s() const { return gap_s_; }

  private:
    void take(const SampleReader::Piece& piece, InertialNominal& nominal, ErrorStep& step,
              Eigen::Vector3d& force, Eigen::Vector3d& turned) {
        const ImuSample& sample = piece.sample;
        const StrapdownStep next = strapdown_step(nominal.state, sample, nominal.bias, data_.earth);
        nominal.state = next.state;
        force += next.specific_velocity_m_s;
        turned += sample.angle_rad - sample.interval_s * nominal.bias.gyro_rad_s;
        step.dt_s += sample.interval_s;
        if (sample.interval_s > 1e-6) rate_ = sample.angle_rad / sample.interval_s;
        if (piece.gap_s == 0.0) return;
        gap_s_ += sample.interval_s;
        step.extra_attitude_rad_sqrt_s = missing_rate_rad_s * std::sqrt(piece.gap_s);
        step.extra_velocity_m_s_sqrt_s = missing_acceleration_m_s2 * std::sqrt(piece.gap_s);
    }

    const InertialData& data_;
    SampleReader reader_;
    Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();
    double gap_s_ = 0.0;
};

/// One position against the prediction: corrects deviation and covariance by the two-sided form of
/// Joseph.
PositionInnovation update(const PositionFix& fix, const InertialNominal& nominal,
                          const Eigen::Vector3d& rate, double carried_offset_s,
                          const EarthFrame& earth, ErrorVector& deviation,
                          ErrorMatrix& covariance) {
    const Eigen::Matrix3d& c = nominal.state.enu_from_body;
    const Eigen::Vector3d turning =
        rate - nominal.bias.gyro_rad_s - c.transpose() * earth.rotation_rad_s();
    const Eigen::Vector3d velocity =
        nominal.state.velocity_m_s + c * turning.cross(nominal.antenna_m);
    const Eigen::Vector3d predicted = nominal.state.position_m + c * nominal.antenna_m +
                                      nominal.position_error_m +
                                      velocity * (nominal.time_offset_s - carried_offset_s);
    const ErrorJacobian h = position_jacobian(c, nominal.antenna_m, velocity);
    const ErrorJacobian hp = h * covariance;
    const Eigen::Matrix3d s = hp * h.transpose() + fix.covariance_m2;
    const Eigen::LLT<Eigen::Matrix3d> factor(s);
    const Eigen::Vector3d innovation = fix.enu_m - predicted - h * deviation;
    const ErrorColumns gain = factor.solve(hp).transpose();
    deviation += gain * innovation;
    const ErrorMatrix left = covariance - gain * hp;
    const ErrorColumns left_h = left * h.transpose();
    const ErrorMatrix both = left + (gain * fix.covariance_m2 - left_h) * gain.transpose();
    covariance = 0.5 * (both + both.transpose());
    PositionInnovation seen{
        .h = h, .covariance_m2 = fix.covariance_m2, .residual_m = fix.enu_m - predicted};
    seen.whitened = factor.matrixL().solve(innovation);
    seen.log_likelihood =
        -0.5 * (seen.whitened.squaredNorm() + 3.0 * std::log(2.0 * std::numbers::pi)) -
        factor.matrixLLT().diagonal().array().log().sum();
    return seen;
}

}  // namespace

InertialNominal corrected(InertialNominal nominal, const ErrorVector& d) {
    NavigationState& state = nominal.state;
    state.enu_from_body = rotation_about(d.segment<3>(attitude)) * state.enu_from_body;
    state.velocity_m_s += d.segment<3>(velocity);
    state.position_m += d.segment<3>(position);
    nominal.bias.gyro_rad_s += d.segment<3>(gyro_bias);
    nominal.bias.accelerometer_m_s2 += d.segment<3>(accelerometer_bias);
    nominal.position_error_m += d.segment<3>(position_error);
    nominal.antenna_m += d.segment<3>(lever_arm);
    nominal.time_offset_s += d(time_offset);
    return nominal;
}

ErrorVector deviation(const InertialNominal& a, const InertialNominal& b) {
    ErrorVector d;
    d.segment<3>(attitude) =
        rotation_vector(a.state.enu_from_body * b.state.enu_from_body.transpose());
    d.segment<3>(velocity) = a.state.velocity_m_s - b.state.velocity_m_s;
    d.segment<3>(position) = a.state.position_m - b.state.position_m;
    d.segment<3>(gyro_bias) = a.bias.gyro_rad_s - b.bias.gyro_rad_s;
    d.segment<3>(accelerometer_bias) = a.bias.accelerometer_m_s2 - b.bias.accelerometer_m_s2;
    d.segment<3>(position_error) = a.position_error_m - b.position_error_m;
    d.segment<3>(lever_arm) = a.antenna_m - b.antenna_m;
    d(time_offset) = a.time_offset_s - b.time_offset_s;
    return d;
}

InertialNominal InertialPass::solution(std::size_t k) const {
    return corrected(nominal[k], estimated[k]);
}

std::vector<InertialNominal> InertialPass::trajectory() const {
    std::vector<InertialNominal> all(nominal.size());
    for (std::size_t k = 0; k < all.size(); ++k)
        all[k] = solution(k);
    for (InertialNominal& each : all)
        each.time_offset_s = all.back().time_offset_s;
    return all;
}

void InertialPass::reserve(std::size_t epochs) {
    nominal.reserve(epochs);
    predicted.reserve(epochs);
    estimated.reserve(epochs);
    predicted_covariance.reserve(epochs);
    covariance.reserve(epochs);
    transition.reserve(epochs);
    gain.reserve(epochs);
    innovations.reserve(epochs);
    imu_gap_s.reserve(epochs);
}

InertialPass filter_forwards(const InertialData& data, const InertialPrior& prior,
                             std::span<const InertialNominal> reference, std::size_t count) {
    const bool linear = !reference.empty();
    const double offset_s = linear ? reference[0].time_offset_s : prior.nominal.time_offset_s;
    InertialPass pass;
    pass.carried_offset_s = offset_s;
    pass.reserve(count);
    Carrier carrier(data, data.fixes[0].time_s + offset_s);
    InertialNominal nominal = prior.nominal;
    ErrorMatrix covariance = prior.covariance;
    ErrorVector mean = ErrorVector::Zero();
    ErrorMatrix transition;
    for (std::size_t k = 0; k < count; ++k) {
        const PositionFix& fix = data.fixes[k];
        if (k > 0) {
            carrier.carry(nominal, covariance, transition, fix.time_s + offset_s);
            mean = transition * mean;
            pass.transition.push_back(transition);
        }
        if (linear) {
            mean += deviation(nominal, reference[k]);
            nominal = reference[k];
        }
        pass.predicted.push_back(mean);
        pass.predicted_covariance.push_back(covariance);
        pass.innovations.push_back(
            update(fix, nominal, carrier.rate_rad_s(), offset_s, data.earth, mean, covariance));
        pass.log_likelihood += pass.innovations.back().log_likelihood;
        if (!linear) {
            nominal = corrected(nominal, mean);
            pass.predicted.back() -= mean;
            pass.innovations.back().residual_m -= pass.innovations.back().h * mean;
            mean.setZero();
        }
        pass.nominal.push_back(nominal);
        pass.estimated.push_back(mean);
        pass.covariance.push_back(covariance);
        pass.imu_gap_s.push_back(k > 0 ? carrier.gap_s() : 0.0);
    }
    return pass;
}

void smooth_backwards(InertialPass& pass, const InertialData& data) {
    pass.gain.resize(pass.transition.size());
    for (std::size_t k = pass.nominal.size() - 1; k-- > 0;) {
        const Eigen::LLT<ErrorMatrix> factor(pass.predicted_covariance[k + 1]);
        if (factor.info() != Eigen::Success || !pass.predicted_covariance[k + 1].allFinite())
            throw Failure(
                fmt::format("time {:.3f} s", data.fixes[k + 1].time_s),
                "the predicted covariance of the inertial solution is not positive definite",
                "Check the stated noise of the IMU and the steps of time around this epoch");
        const ErrorMatrix gain = factor.solve(pass.transition[k] * pass.covariance[k]).transpose();
        pass.estimated[k] += gain * (pass.estimated[k + 1] - pass.predicted[k + 1]);
        const ErrorMatrix covariance =
            pass.covariance[k] +
            gain * (pass.covariance[k + 1] - pass.predicted_covariance[k + 1]) * gain.transpose();
        pass.covariance[k] = 0.5 * (covariance + covariance.transpose());
        pass.gain[k] = gain;
    }
}

double log_likelihood(const InertialData& data, const InertialPrior& prior, std::size_t count) {
    return filter_forwards(data, prior, {}, count).log_likelihood;
}

namespace {

/// About each axis the attitude may turn by the greater of these in the last pass.
constexpr double settled_rad = 1e-3;
constexpr double settled_sigmas = 0.1;
constexpr int most_passes = 12;

/// The greatest turn of the attitude by the last pass, in units of what it may turn.
double turned_by(const InertialPass& pass) {
    double most = 0.0;
    for (std::size_t k = 0; k < pass.estimated.size(); ++k)
        for (int axis = 0; axis < 3; ++axis) {
            const double sigma = std::sqrt(pass.covariance[k](axis, axis));
            const double turned = std::abs(pass.estimated[k](error_state::attitude + axis));
            most = std::max(most, turned / std::max(settled_rad, settled_sigmas * sigma));
        }
    return most;
}

}  // namespace

Passes run_passes(const InertialData& data, const InertialPrior& prior,
                  std::vector<InertialNominal> about) {
    Passes passes;
    const std::size_t count = data.fixes.size();
    while (passes.count < most_passes) {
        passes.last = {};  // its memory is free before that of the next is taken
        passes.last = filter_forwards(data, prior, about, count);
        smooth_backwards(passes.last, data);
        ++passes.count;
        passes.turned = turned_by(passes.last);
        if (passes.turned < 1.0 || passes.count == most_passes) break;
        about = passes.last.trajectory();
    }
    return passes;
}

}  // namespace runcert

#pragma once

#include <vector>

#include "inertial/inertial_smoother.h"

// The passes behind `smooth_inertial`: forwards and backwards through all positions.
namespace runcert {

/// All that is estimated at an epoch, about which errors are taken.
struct InertialNominal {
    NavigationState state = {};
    ImuBias bias = {};
    Eigen::Vector3d position_error_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d antenna_m = Eigen::Vector3d::Zero();
    double time_offset_s = 0.0;
};

/// The estimate with its errors removed: `deviation` is truth less estimate.
InertialNominal corrected(InertialNominal nominal, const ErrorVector& deviation);

/// The deviation of `a` from `b`: corrected(b, deviation) is `a`.
ErrorVector deviation(const InertialNominal& a, const InertialNominal& b);

/// What the passes work on.
struct InertialData {
    std::span<const ImuSample> samples;
    std::vector<PositionFix> fixes;  ///< with floors applied
    EarthFrame earth;
    ImuNoise noise = {};
    PositionErrorModel position_error = {};
};

/// Nominal values at the first epoch and the covariance of all 22 errors.
struct InertialPrior {
    InertialNominal nominal;
    ErrorMatrix covariance;
};

/// A measured position as a linear function of the errors about `nominal`, and how the filter found
/// it.
struct PositionInnovation {
    ErrorJacobian h = ErrorJacobian::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();
    Eigen::Vector3d residual_m = Eigen::Vector3d::Zero();  ///< less that of `nominal`
    Eigen::Vector3d whitened = Eigen::Vector3d::Zero();
    double log_likelihood = 0.0;
};

/// A pass. Deviations and covariances are those of the filter until `smooth_backwards` makes them
/// those given all positions.
struct InertialPass {
    std::vector<InertialNominal> nominal;
    std::vector<ErrorVector> predicted;  ///< deviation from `nominal` before the position
    std::vector<ErrorVector> estimated;  ///< after it
    std::vector<ErrorMatrix> predicted_covariance;
    std::vector<ErrorMatrix> covariance;
    std::vector<ErrorMatrix> transition;  ///< from the epoch to the next
    std::vector<ErrorMatrix> gain;        ///< filled by `smooth_backwards`
    std::vector<PositionInnovation> innovations;
    std::vector<double> imu_gap_s;  ///< without samples before each epoch
    double carried_offset_s = 0.0;  ///< the states are those at the positions' times plus this
    double log_likelihood = 0.0;

    void reserve(std::size_t epochs);

    /// Nominal values and deviation in one.
    InertialNominal solution(std::size_t k) const;

    /// The solution of every epoch, about which the next pass may be linear. All have the time
    /// offset of the last, since it is one constant.
    std::vector<InertialNominal> trajectory() const;
};

/// The filter forwards. Without a reference it is closed-loop: each epoch's correction goes into
/// the nominal values. With one (the nominal values of each epoch) all is linear about it, and a
/// step of Gauss and Newton towards the most probable trajectory given the prior.
/// `count`: only so many epochs.
InertialPass filter_forwards(const InertialData& data, const InertialPrior& prior,
                             std::span<const InertialNominal> reference, std::size_t count);

/// The smoother backwards [YSM22]: d_k = m_k + G_k (d_{k+1} - m-_{k+1}),
/// P_k = P+_k + G_k (P_{k+1} - P-_{k+1}) G_k', G_k = P+_k Phi' (P-_{k+1})^-1. Failure (at the time)
/// where a predicted covariance is not positive definite.
void smooth_backwards(InertialPass& pass, const InertialData& data);

/// Passes from one start, until the attitude stays.
struct Passes {
    InertialPass last;  ///< smoothed
    int count = 0;
    /// What the last pass turned the attitude by about an axis, at most, in units of what it may:
    /// the greater of 1e-3 rad and a tenth of the standard deviation.
    double turned = 0.0;
};

/// Forwards in closed loop and backwards, then about the smoothed trajectory until the attitude
/// stays, 12 times at most. With a trajectory given, the first pass is about that.
Passes run_passes(const InertialData& data, const InertialPrior& prior,
                  std::vector<InertialNominal> about = {});

/// Sum of logarithms of the innovations' densities over so many epochs.
double log_likelihood(const InertialData& data, const InertialPrior& prior, std::size_t count);

}  // namespace runcert

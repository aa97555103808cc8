#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/geodetic.h"
#include "inertial/attitude.h"
#include "inertial/error_model.h"
#include "inertial/imu_noise.h"
#include "inertial/still_spans.h"
#include "inertial/strapdown.h"

namespace runcert {

/// A measured position of the antenna in the frame of east, north and up at the origin.
struct PositionFix {
    double time_s = 0.0;
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();  ///< of its white error
    /// Upward unit normal of the surface under the antenna, where there is one: for a start alone.
    std::optional<Eigen::Vector3d> ground_normal = {};
};

/// An attitude with the covariance (rad^2) of its error phi, truth = exp([phi]) estimate.
struct StartAttitude {
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Identity();
};

/// What a solution says of the IMU at an epoch.
struct ImuState {
    NavigationState motion = {};
    ImuBias bias = {};
};

/// A solution found before.
struct SolvedBefore {
    std::vector<ImuState> states;  ///< one for each position that the samples reach
    double time_offset_s = 0.0;
    bool searched = false;  ///< `StartMethod::search`
};

/// Where a second antenna was from the first at an epoch, along east, north and up.
struct BaselineFix {
    double time_s = 0.0;  ///< on the positions' scale
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();  ///< of its white error
};

/// A second antenna on the craft: with the first it shows the heading while the craft stands, too.
struct AntennaBaseline {
    Eigen::Vector3d body_m = Eigen::Vector3d::Zero();  ///< from the first, forward, right, down
    double body_sigma_m = 0.03;  ///< of the same as measured on the craft, in any direction
    std::vector<BaselineFix> fixes = {};  ///< in order of time
};

struct InertialSetup {
    Geodetic origin = {};
    ImuNoise noise = {};
    /// From the IMU, along its axes forward, right and down.
    Eigen::Vector3d antenna_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference_point_m = Eigen::Vector3d::Zero();
    double antenna_sigma_m = 0.02;  ///< of each component of `antenna_m`
    bool estimate_antenna = false;
    bool estimate_time_offset = false;
    /// The position stamped t is that at the IMU's time t + offset.
    double time_offset_s = 0.0;
    double time_offset_sigma_s = 0.3;  ///< if it is estimated
    /// Whether `noise` may be raised to what is likeliest (`fit_imu_noise`).
    bool fit_noise = true;
    /// The solution with this noise and choice of what is estimated, if it was found before. One
    /// pass about it is then enough.
    std::optional<SolvedBefore> before = {};
    PositionErrorModel position_error = {};
    /// Least standard deviations of the white error of a position.
    double least_horizontal_m = 0.006;
    double least_vertical_m = 0.009;
    /// Replaces the start that the data give. Holds at the first position.
    std::optional<StartAttitude> start = {};
    std::optional<AntennaBaseline> baseline = {};  ///< used for a start while the craft stands
};

/// How the attitude at the start was found.
enum class StartMethod {
    given,
    course,          ///< heading from the course over ground, level
    earth_rotation,  ///< while standing: level by gravity, heading by the Earth's rotation
    search,          ///< the likeliest of twelve headings
    baseline,        ///< while standing: level by gravity, heading by two antennas
    surface,         ///< roll and pitch of the surface below, heading from the course along it
};

/// A point of the craft with the covariance of its error.
struct PointMotion {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Matrix3d position_covariance_m2 = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d velocity_covariance_m2_s2 = Eigen::Matrix3d::Zero();
};

/// The smoothed solution at a position's epoch.
struct InertialEpoch {
    double time_s = 0.0;
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    EulerAngles attitude = {};                             ///< rad
    EulerAngles attitude_sigma = {};                       ///< rad
    Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();  ///< against the Earth, body axes
    PointMotion antenna = {};
    PointMotion reference_point = {};
    ImuBias bias = {};
    ImuBias bias_sigma = {};
    Eigen::Vector3d position_error_m = Eigen::Vector3d::Zero();  ///< time-correlated
    /// Measured less predicted position, whitened by the lower factor of its covariance.
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();
};

/// What speaks against a solution.
enum class InertialFinding {
    innovations_large,          ///< NIS/3 above 2: more error than the model has
    innovations_small,          ///< NIS/3 below 0.3: less
    heading_unobservable,       ///< and the arm between antenna and reference point is horizontal
    vertical_arm_unobservable,  ///< an estimated vertical lever arm on a craft that hardly rolls
    noise_large,                ///< no noise that the fit tries is enough: not rigid to the craft?
    not_converged,              ///< the last pass still turned the attitude
};

/// A finding with its figure and the limit that the figure is on the wrong side of.
struct InertialDoubt {
    InertialFinding finding{};
    double figure = 0.0;
    double limit = 0.0;
};

/// A stretch between positions, or between samples, longer than is usual in the recording.
struct BridgedStretch {
    double from_s = 0.0;
    double to_s = 0.0;
    bool imu_missing = false;  ///< samples are missing; otherwise only the IMU carries across
};

/// A value with its standard deviation.
template <class Value>
struct Estimated {
    Value value{};
    Value sigma{};
};

struct InertialStatistics {
    double nis = 0.0;  ///< mean of the normalised innovations squared, by 3: 1 is expected
    Eigen::Vector3d axis_nis = Eigen::Vector3d::Zero();  ///< of each component
    double lag_one_correlation = 0.0;                    ///< of successive innovations
    double beyond_share = 0.0;                           ///< of epochs beyond the 99.9 % point
    /// By the median of the normalised innovations squared: what `nis` is where positions do not
    /// err. 1 is expected.
    double usual_nis = 0.0;
    std::vector<InertialDoubt> doubts = {};
    Shaking shaking = {};  ///< found where there are doubts
    bool consistent() const { return doubts.empty(); }
    /// Whether the IMU can say how the antenna moved, if not where another point of the craft did:
    /// the solution converged, with innovations that are mostly as expected.
    bool tells_motion() const;
};

/// A displacement of a point between two epochs, with its covariance.
struct PointDisplacement {
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

enum class CraftPoint { antenna, reference_point };

/// What a quantity changes by per metre and per m/s of a point at an epoch.
struct PointGradient {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

/// A variance in two parts.
struct PointVariance {
    double by_errors = 0.0;  ///< by the errors that are estimated, and the gyros' noise
    double by_arm = 0.0;     ///< by `antenna_sigma_m` of a lever arm that is not
};

/// A point of the craft between two neighbouring epochs: the cubic that has the positions and
/// velocities of both.
Eigen::Vector3d position_between(const InertialEpoch& before, const InertialEpoch& after,
                                 double time_s, CraftPoint point);

/// Covariances between epochs; see `InertialSolution`.
class JointCovariance;

struct InertialSolution {
    std::vector<InertialEpoch> epochs;  ///< one for each position that the samples reach
    InertialStatistics consistency;
    StartMethod start = StartMethod::given;
    StartAttitude start_attitude = {};  ///< at the first of the epochs, before they were used
    int passes = 0;
    double log_likelihood = 0.0;
    std::vector<BridgedStretch> bridged;
    Estimated<double> time_offset_s;       ///< sigma 0 if it is not estimated
    Estimated<Eigen::Vector3d> antenna_m;  ///< sigma as declared if it is not estimated
    bool time_offset_asked_by_innovations = false;
    ImuNoise noise = {};  ///< that the solution has

    /// Displacement between two epochs s < e (indices of `epochs`) from the joint covariance of
    /// both: P_s + P_e - X - X', X = G_s ... G_{e-1} P_e [FHB03; RTS as in YSM22]. An antenna arm
    /// that is not estimated adds `antenna_sigma_m` times the change of attitude.
    PointDisplacement displacement(std::size_t s, std::size_t e, CraftPoint point) const;

    /// By how much farther than the reference point the antenna moved between two epochs. The
    /// distances from the IMU to both points were measured apart. A time offset that is not
    /// estimated may be `unseen_lag_s`.
    PointDisplacement swing(std::size_t s, std::size_t e) const;

    /// The antenna's displacement between two epochs by the IMU alone: the stretch is solved again
    /// without the positions from s to e, both included, and those after may all be displaced by
    /// one unknown vector. So only attitude, velocity and biases at both ends are known by
    /// positions.
    PointDisplacement displacement_by_imu(std::size_t s, std::size_t e) const;

    /// Variance of a sum over the epochs from s on: gradients[i].position' position +
    /// gradients[i].velocity' velocity of a point at epoch s + i, from the joint covariance of all.
    /// Length of a path and mean of speeds are such sums. The gyros' white noise adds to
    /// velocities.
    double variance(std::size_t s, std::span<const PointGradient> gradients,
                    CraftPoint point) const;

    /// The same of a sum over the reference point and another over the antenna, with gradients for
    /// the same epochs: that of the first sum less the second.
    PointVariance difference_variance(std::size_t s, std::span<const PointGradient> of_reference,
                                      std::span<const PointGradient> of_antenna) const;

    /// The last epoch at or before one instant and the first at or after another. None if the
    /// solution does not reach both.
    std::optional<std::pair<std::size_t, std::size_t>> enclosing(double from_s, double to_s) const;

    /// Whether a bridged span lies between two epochs.
    bool bridged_between(std::size_t s, std::size_t e) const;

    std::shared_ptr<const JointCovariance> joint;  ///< what `displacement` needs
};

/// Standard uncertainty of a time offset that is not estimated. A longer one is likelier and would
/// have been, where the motion shows it.
inline constexpr double unseen_lag_s = 0.002;

/// Positions that a solution needs.
inline constexpr std::size_t least_positions = 10;

/// How many positions the samples reach, with half a second to spare at either end: those that take
/// part in a solution. Failure (at "IMU") as for `smooth_inertial`.
std::size_t positions_within(std::span<const ImuSample> samples, std::span<const PositionFix> fixes,
                             const InertialSetup& setup);

/// Attitude, velocity and position of a craft by an inertial measurement unit and positions: a
/// closed-loop extended Kalman filter of 22 error states (`error_model.h`), an RTS smoother,
/// and again about the smoothed trajectory until the attitude stays.
///
/// Starts from the directions known at the first position (`find_start`): gravity, course and
/// ground, the Earth's rotation, two antennas. Without a course the likeliest of twelve headings
/// over 60 s is taken.
///
/// Noise is that which is likeliest over two minutes about the highest speed, no less than the
/// setup's (`fit_imu_noise`). Scale factors and axes that err by 0.2 to 1 %, as those of MEMS
/// sensors do, otherwise leave NIS/3 near 1 and intervals that hold the truth in 30 to 85 % of
/// cases. A time offset is estimated if it raises the likelihood there, too. The lever arm is not:
/// it takes up what scale factors err by, and then misleads.
///
/// Positions outside the samples, or within half a second of their ends, are left out. Failure (at
/// "IMU" or "positions") where fewer than ten remain, times do not increase, or a number is not
/// finite or a covariance not positive.
InertialSolution smooth_inertial(std::span<const ImuSample> samples,
                                 std::span<const PositionFix> fixes, const InertialSetup& setup);

}  // namespace runcert

#include "witness/kinds/imu.h"

#include "witness/roster.h"

namespace runcert {
namespace {

/// The antenna at an instant of the step that begins at an epoch, and of the one that ends there.
Eigen::Vector3d start_of(const InertialSolution& solution, std::size_t epoch, double time_s) {
    return position_between(solution.epochs[epoch], solution.epochs[epoch + 1], time_s,
                            CraftPoint::antenna);
}
Eigen::Vector3d end_of(const InertialSolution& solution, std::size_t epoch, double time_s) {
    return position_between(solution.epochs[epoch - 1], solution.epochs[epoch], time_s,
                            CraftPoint::antenna);
}

/// A real IMU errs by more than its noise: bridging stretches without positions on a recorded
/// drive, one of the MEMS class was off by about twice what its solution states.
constexpr double as_recorded = 2.0;

/// East and north, or up.
template <int Axes>
constexpr int first_axis = Axes == 1 ? 2 : 0;

template <int Axes>
double step_m(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return (to - from).template segment<Axes>(first_axis<Axes>).norm();
}

}  // namespace

template <int Axes>
std::optional<WitnessedMotion<Axes>> ImuWitness<Axes>::between(double from_s, double to_s) const {
    const auto found = solution_->enclosing(from_s, to_s);
    if (!found) return std::nullopt;
    const auto [s, e] = *found;
    if (solution_->bridged_between(s, e)) return std::nullopt;
    const PointDisplacement by_imu = solution_->displacement_by_imu(s, e);
    const Eigen::Vector3d beyond =
        start_of(*solution_, s, from_s) - solution_->epochs[s].antenna.position_m +
        solution_->epochs[e].antenna.position_m - end_of(*solution_, e, to_s);
    constexpr int axis = first_axis<Axes>;
    WitnessedMotion<Axes> motion;
    motion.displacement_m = (by_imu.enu_m - beyond).template segment<Axes>(axis);
    motion.covariance_m2 =
        as_recorded * as_recorded * by_imu.covariance_m2.template block<Axes, Axes>(axis, axis);
    motion.confirms = false;
    return motion;
}

template <int Axes>
TimeSpan ImuWitness<Axes>::covered() const {
    return {solution_->epochs.front().time_s, solution_->epochs.back().time_s};
}

template <int Axes>
std::optional<double> ImuWitness<Axes>::path_between(double from_s, double to_s) const {
    const auto found = solution_->enclosing(from_s, to_s);
    const auto motion = between(from_s, to_s);
    if (!found || !motion) return std::nullopt;
    const auto [s, e] = *found;
    const Eigen::Vector3d start = start_of(*solution_, s, from_s);
    const Eigen::Vector3d end = end_of(*solution_, e, to_s);
    double length_m = 0.0;
    Eigen::Vector3d at = start;
    for (std::size_t k = s + 1; k < e; ++k) {
        const Eigen::Vector3d& next = solution_->epochs[k].antenna.position_m;
        length_m += step_m<Axes>(at, next);
        at = next;
    }
    length_m += step_m<Axes>(at, end);
    return length_m + motion->displacement_m.norm() - step_m<Axes>(start, end);
}

template class ImuWitness<1>;
template class ImuWitness<2>;

namespace witnesses {
namespace {

FaultPrior fault_of_imu(const FaultPrior& /*positions*/) {
    return faults_of_speeds;
}

}  // namespace

extern const WitnessEntry imu{
    .kind = WitnessKind::imu,
    .fault = fault_of_imu,
    .silent = "IMU and positions do not agree, or have no solution",
    .remedy = "Check the IMU's axes, units and clock, and the distances on the craft.",
    .unconfirming =
        "the positions around it align the IMU, which takes an error of theirs that "
        "lasts longer than the window for motion"};

}  // namespace witnesses
}  // namespace runcert

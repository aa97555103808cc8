#include "estimation/speed.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace runcert {

SpeedEstimate horizontal_speed(const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance) {
    const double speed = std::hypot(velocity.x(), velocity.y());
    double variance = 0.0;
    if (speed > 0.0) {
        const Eigen::Vector2d direction = velocity / speed;
        variance = direction.dot(covariance * direction);
    } else {
        variance =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly)
                .eigenvalues()
                .maxCoeff();
    }
    return {speed, std::sqrt(std::max(variance, 0.0))};
}

template <int Axes>
SpeedEstimate displacement_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s) {
    const Eigen::Vector2d displacement =
        arc.states[e].mean.template head<2>() - arc.states[s].mean.template head<2>();
    const Eigen::Matrix2d cross = arc.cross_covariance(s, e).template topLeftCorner<2, 2>();
    const Eigen::Matrix2d covariance = arc.states[s].covariance.template topLeftCorner<2, 2>() +
                                       arc.states[e].covariance.template topLeftCorner<2, 2>() -
                                       cross - cross.transpose();
    return horizontal_speed(displacement / duration_s, covariance / (duration_s * duration_s));
}

template SpeedEstimate displacement_speed<2>(const SmoothedArc<2>&, std::size_t, std::size_t,
                                             double);
template SpeedEstimate displacement_speed<3>(const SmoothedArc<3>&, std::size_t, std::size_t,
                                             double);

}  // namespace runcert

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
Eigen::Matrix2d displacement_covariance(const SmoothedArc<Axes>& arc, std::size_t s,
                                        std::size_t e) {
    const Eigen::Matrix2d cross = arc.cross_covariance(s, e).template topLeftCorner<2, 2>();
    return arc.states[s].covariance.template topLeftCorner<2, 2>() +
           arc.states[e].covariance.template topLeftCorner<2, 2>() - cross - cross.transpose();
}

template <int Axes>
SpeedEstimate displacement_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s) {
    const Eigen::Vector2d displacement =
        arc.states[e].mean.template head<2>() - arc.states[s].mean.template head<2>();
    return horizontal_speed(displacement / duration_s,
                            displacement_covariance(arc, s, e) / (duration_s * duration_s));
}

template <int Axes>
SpeedEstimate path_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                         double duration_s) {
    Gradients<Axes> gradients(e - s + 1, StateVector<Axes>::Zero());
    double length_m = 0.0;
    for (std::size_t k = s; k < e; ++k) {
        const Eigen::Vector2d step =
            arc.states[k + 1].mean.template head<2>() - arc.states[k].mean.template head<2>();
        if (step.norm() == 0.0) continue;
        length_m += step.norm();
        const Eigen::Vector2d direction = step.normalized() / duration_s;
        gradients[k - s].template head<2>() -= direction;
        gradients[k - s + 1].template head<2>() += direction;
    }
    return {length_m / duration_s, std::sqrt(std::max(arc.variance(s, gradients), 0.0))};
}

template <int Axes>
SpeedEstimate mean_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e) {
    const auto count = static_cast<double>(e - s + 1);
    Gradients<Axes> gradients(e - s + 1, StateVector<Axes>::Zero());
    double sum_mps = 0.0;
    for (std::size_t k = s; k <= e; ++k) {
        const Eigen::Vector2d velocity = arc.states[k].mean.template segment<2>(Axes);
        sum_mps += velocity.norm();
        if (velocity.norm() > 0.0)
            gradients[k - s].template segment<2>(Axes) = velocity.normalized() / count;
    }
    return {sum_mps / count, std::sqrt(std::max(arc.variance(s, gradients), 0.0))};
}

#define RUNCERT_INSTANTIATE(AXES)                                                                 \
    template Eigen::Matrix2d displacement_covariance<AXES>(const SmoothedArc<AXES>&, std::size_t, \
                                                           std::size_t);                          \
    template SpeedEstimate displacement_speed<AXES>(const SmoothedArc<AXES>&, std::size_t,        \
                                                    std::size_t, double);                         \
    template SpeedEstimate path_speed<AXES>(const SmoothedArc<AXES>&, std::size_t, std::size_t,   \
                                            double);                                              \
    template SpeedEstimate mean_speed<AXES>(const SmoothedArc<AXES>&, std::size_t, std::size_t);
RUNCERT_INSTANTIATE(2)
RUNCERT_INSTANTIATE(3)

}  // namespace runcert

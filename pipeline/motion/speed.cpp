#include "motion/speed.h"

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"

namespace runcert {

SpeedEstimate horizontal_speed(const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance) {
    const double speed = std::hypot(velocity.x(), velocity.y());
    double variance = 0.0;
    if (speed > 0.0) {
        const Eigen::Vector2d direction = velocity / speed;
        variance = direction.dot(covariance * direction);
    } else {
        variance = symmetric_eigenvalues(covariance)(1);
    }
    return {speed, std::sqrt(std::max(variance, 0.0))};
}

template <int Axes>
SpeedVector<Axes> displacement(const Chain<Axes>& arc, std::size_t s, std::size_t e) {
    constexpr int counted = speed_axes<Axes>;
    return arc.mean(e).template head<counted>() - arc.mean(s).template head<counted>();
}

template <int Axes>
SpeedMatrix<Axes> displacement_covariance(const Chain<Axes>& arc, std::size_t s, std::size_t e) {
    constexpr int counted = speed_axes<Axes>;
    const SpeedMatrix<Axes> cross =
        arc.cross_covariance(s, e).template topLeftCorner<counted, counted>();
    return arc.covariance_of(0, s) + arc.covariance_of(0, e) - cross - cross.transpose();
}

#define RUNCERT_INSTANTIATE(AXES)                                                                \
    template SpeedVector<AXES> displacement<AXES>(const Chain<AXES>&, std::size_t, std::size_t); \
    template SpeedMatrix<AXES> displacement_covariance<AXES>(const Chain<AXES>&, std::size_t,    \
                                                             std::size_t);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert

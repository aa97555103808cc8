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

SpeedEstimate vertical_speed(double velocity_m_s, double variance) {
    return {std::abs(velocity_m_s), std::sqrt(std::max(variance, 0.0))};
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

template <int Axes>
SpeedEstimate displacement_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s) {
    const SpeedVector<Axes> velocity = displacement(arc, s, e) / duration_s;
    const SpeedMatrix<Axes> covariance =
        displacement_covariance(arc, s, e) / (duration_s * duration_s);
    if constexpr (Axes == 1)
        return vertical_speed(velocity.value(), covariance.value());
    else
        return horizontal_speed(velocity, covariance);
}

template <int Axes>
Gradients<Axes> displacement_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                             double duration_s) {
    const SpeedVector<Axes> moved = displacement(arc, s, e);
    Gradients<Axes> gradients(e - s + 1, StateVector<Axes>::Zero());
    if (moved.norm() == 0.0) return gradients;
    const SpeedVector<Axes> direction = moved.normalized() / duration_s;
    gradients.front().template head<speed_axes<Axes>>() -= direction;
    gradients.back().template head<speed_axes<Axes>>() += direction;
    return gradients;
}

template <int Axes>
Gradients<Axes> path_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                     double duration_s) {
    Gradients<Axes> gradients(e - s + 1, StateVector<Axes>::Zero());
    for (std::size_t k = s; k < e; ++k) {
        const Gradients<Axes> of_step = displacement_speed_gradients(arc, k, k + 1, duration_s);
        gradients[k - s] += of_step[0];
        gradients[k - s + 1] += of_step[1];
    }
    return gradients;
}

template <int Axes>
Gradients<Axes> mean_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e) {
    const auto count = static_cast<double>(e - s + 1);
    Gradients<Axes> gradients(e - s + 1, StateVector<Axes>::Zero());
    for (std::size_t k = s; k <= e; ++k) {
        const SpeedVector<Axes> velocity = arc.mean(k).template segment<speed_axes<Axes>>(Axes);
        if (velocity.norm() > 0.0)
            gradients[k - s].template segment<speed_axes<Axes>>(Axes) =
                velocity.normalized() / count;
    }
    return gradients;
}

template <int Axes>
SpeedEstimate path_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e, double duration_s) {
    double length_m = 0.0;
    const double variance = arc.variance(s, path_speed_gradients(arc, s, e, duration_s));
    for (std::size_t k = s; k < e; ++k)
        length_m += displacement(arc, k, k + 1).norm();
    return {length_m / duration_s, std::sqrt(std::max(variance, 0.0))};
}

template <int Axes>
SpeedEstimate mean_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e) {
    double sum_m_s = 0.0;
    for (std::size_t k = s; k <= e; ++k)
        sum_m_s += arc.mean(k).template segment<speed_axes<Axes>>(Axes).norm();
    return {sum_m_s / static_cast<double>(e - s + 1),
            std::sqrt(std::max(arc.variance(s, mean_speed_gradients(arc, s, e)), 0.0))};
}

#define RUNCERT_INSTANTIATE(AXES)                                                                  \
    template SpeedVector<AXES> displacement<AXES>(const Chain<AXES>&, std::size_t, std::size_t);   \
    template SpeedMatrix<AXES> displacement_covariance<AXES>(const Chain<AXES>&, std::size_t,      \
                                                             std::size_t);                         \
    template SpeedEstimate displacement_speed<AXES>(const Chain<AXES>&, std::size_t, std::size_t,  \
                                                    double);                                       \
    template SpeedEstimate path_speed<AXES>(const Chain<AXES>&, std::size_t, std::size_t, double); \
    template Gradients<AXES> displacement_speed_gradients<AXES>(const Chain<AXES>&, std::size_t,   \
                                                                std::size_t, double);              \
    template Gradients<AXES> path_speed_gradients<AXES>(const Chain<AXES>&, std::size_t,           \
                                                        std::size_t, double);                      \
    template Gradients<AXES> mean_speed_gradients<AXES>(const Chain<AXES>&, std::size_t,           \
                                                        std::size_t);                              \
    template SpeedEstimate mean_speed<AXES>(const Chain<AXES>&, std::size_t, std::size_t);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert

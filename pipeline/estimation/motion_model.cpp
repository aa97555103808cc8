#include "estimation/motion_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace runcert {
namespace {

/// Spreads a 3x3 matrix of one axis over the state of all axes.
template <int Axes>
StateMatrix<Axes> on_all_axes(const Eigen::Matrix3d& axis) {
    StateMatrix<Axes> all = StateMatrix<Axes>::Zero();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            all.template block<Axes, Axes>(row * Axes, column * Axes)
                .diagonal()
                .setConstant(axis(row, column));
    return all;
}

}  // namespace

Eigen::Matrix3d axis_transition(double dt_s) {
    Eigen::Matrix3d f;
    f << 1.0, dt_s, dt_s * dt_s / 2.0,  //
        0.0, 1.0, dt_s,                 //
        0.0, 0.0, 1.0;
    return f;
}

Eigen::Matrix3d axis_process_noise(const MotionModel& model, double dt_s) {
    const double q = model.jerk_density * model.jerk_density;
    const double d1 = dt_s;
    const double d2 = d1 * dt_s;
    const double d3 = d2 * dt_s;
    const double d4 = d3 * dt_s;
    const double d5 = d4 * dt_s;
    Eigen::Matrix3d noise;
    noise << d5 / 20.0, d4 / 8.0, d3 / 6.0,  //
        d4 / 8.0, d3 / 3.0, d2 / 2.0,        //
        d3 / 6.0, d2 / 2.0, d1;
    return q * noise;
}

Eigen::Matrix3d axis_process_whitener(const MotionModel& model, double dt_s) {
    // Q = q D Q1 D with D = diag(dt^2.5, dt^1.5, dt^0.5) and Q1 the matrix of dt = 1.
    // With the information matrix inverse(Q1) = L L', the whitening factor is L'.
    const Eigen::Matrix3d information = axis_process_noise({.jerk_density = 1.0}, 1.0).inverse();
    const Eigen::Matrix3d factor = information.llt().matrixL().transpose();
    const double root = std::sqrt(dt_s);
    const Eigen::Vector3d scale(root * dt_s * dt_s, root * dt_s, root);
    return factor * scale.cwiseInverse().asDiagonal() / model.jerk_density;
}

template <int Axes>
StateMatrix<Axes> transition(double dt_s) {
    return on_all_axes<Axes>(axis_transition(dt_s));
}

template <int Axes>
StateMatrix<Axes> process_noise(const MotionModel& model, double dt_s) {
    return on_all_axes<Axes>(axis_process_noise(model, dt_s));
}

template StateMatrix<2> transition<2>(double);
template StateMatrix<3> transition<3>(double);
template StateMatrix<2> process_noise<2>(const MotionModel&, double);
template StateMatrix<3> process_noise<3>(const MotionModel&, double);

}  // namespace runcert

#include <Eigen/Cholesky>
#include <nlohmann/json.hpp>

#include "comparison_data.h"

// A Kalman filter and RTS smoother as one would write them in an hour with Eigen: nine states,
// fixed sizes, the textbook's products. Nothing of the project's estimation is in it.

namespace runcert::comparison {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Matrix93 = Eigen::Matrix<double, 9, 3>;
using Matrix39 = Eigen::Matrix<double, 3, 9>;

struct Model {
    Matrix9 f = Matrix9::Identity();
    Matrix9 q = Matrix9::Zero();
    Matrix39 h = Matrix39::Zero();
};

/// Position, velocity, acceleration of three axes under white-noise jerk, exact for a step of dt.
Model make_model() {
    constexpr double dt = step_s;
    constexpr double density = jerk_density * jerk_density;
    Eigen::Matrix3d f, q;
    f << 1, dt, dt * dt / 2, 0, 1, dt, 0, 0, 1;
    const double dt2 = dt * dt, dt3 = dt2 * dt, dt4 = dt3 * dt, dt5 = dt4 * dt;
    q << dt5 / 20, dt4 / 8, dt3 / 6, dt4 / 8, dt3 / 3, dt2 / 2, dt3 / 6, dt2 / 2, dt;
    Model model;
    for (Eigen::Index row = 0; row < 3; ++row)
        for (Eigen::Index column = 0; column < 3; ++column) {
            model.f.block<3, 3>(3 * row, 3 * column) = f(row, column) * Eigen::Matrix3d::Identity();
            model.q.block<3, 3>(3 * row, 3 * column) =
                density * q(row, column) * Eigen::Matrix3d::Identity();
        }
    model.h.leftCols<3>().setIdentity();
    return model;
}

struct Estimate {
    Vector9 x;
    Matrix9 p;
};

struct Run {
    std::vector<Estimate> predicted;
    std::vector<Estimate> filtered;  ///< smoothed, in the end
};

Estimate vague_prior(const Eigen::Vector3d& position) {
    Vector9 sigma;
    sigma << 100, 100, 100, 300, 300, 300, 100, 100, 100;
    Estimate prior;
    prior.x << position, Eigen::Matrix<double, 6, 1>::Zero();
    prior.p = sigma.cwiseAbs2().asDiagonal();
    return prior;
}

void filter(const Model& model, const std::vector<MeasuredPosition>& measured, Run& run) {
    const Matrix9 identity = Matrix9::Identity();
    Estimate now = vague_prior(measured[0].position);
    for (std::size_t k = 0; k < measured.size(); ++k) {
        if (k > 0) {
            now.x = model.f * now.x;
            now.p = model.f * now.p * model.f.transpose() + model.q;
        }
        run.predicted[k] = now;
        const Matrix93 ph = now.p * model.h.transpose();
        const Eigen::Matrix3d s = model.h * ph + measured[k].covariance;
        const Matrix93 gain = s.llt().solve(ph.transpose()).transpose();
        now.x += gain * (measured[k].position - model.h * now.x);
        const Matrix9 factor = identity - gain * model.h;
        now.p =
            factor * now.p * factor.transpose() + gain * measured[k].covariance * gain.transpose();
        run.filtered[k] = now;
    }
}

void smooth(const Model& model, Run& run) {
    for (std::size_t k = run.filtered.size() - 1; k-- > 0;) {
        const Estimate& predicted = run.predicted[k + 1];
        const Estimate& next = run.filtered[k + 1];
        Estimate& now = run.filtered[k];
        const Matrix9 gain = predicted.p.llt().solve(model.f * now.p).transpose();
        now.x += gain * (next.x - predicted.x);
        now.p += gain * (next.p - predicted.p) * gain.transpose();
    }
}

nlohmann::ordered_json program(const Arguments& arguments) {
    const std::vector<MeasuredPosition> measured = read_positions(arguments.data);
    const Model model = make_model();
    Run run;
    const double filter_s = seconds_of([&] {
        run = {std::vector<Estimate>(measured.size()), std::vector<Estimate>(measured.size())};
        filter(model, measured, run);
    });
    const double smoother_s = seconds_of([&] { smooth(model, run); });
    write_points(arguments.result, measured.size(), arguments.every, [&](std::size_t k) {
        return SmoothedPoint{.mean = run.filtered[k].x.head<6>(),
                             .sigma = run.filtered[k].p.diagonal().head<6>().cwiseSqrt()};
    });
    return {{"epochs", measured.size()},
            {"seconds", filter_s + smoother_s},
            {"filter_seconds", filter_s}};
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run_program(argc, argv, runcert::comparison::program);
}

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/random.h"
#include "inertial/alignment.h"
#include "inertial/joint_covariance.h"
#include "inertial_test_support.h"

// The same states in one batch of nonlinear least squares: no filter, no transition matrix, no
// smoother. Motion between epochs by the mechanisation itself, derivatives by differences.
namespace runcert::RUNCERT_FILE {
namespace {

using namespace error_state;
/// The errors that the data show here: the antenna's arm and the time offset are known.
constexpr int shown = lever_arm;
using State = Eigen::Matrix<double, shown, 1>;
using Matrix = Eigen::Matrix<double, shown, shown>;

Matrix shown_of(const ErrorMatrix& all) {
    return all.topLeftCorner<shown, shown>();
}

State shown_deviation(const InertialNominal& a, const InertialNominal& b) {
    return deviation(a, b).head<shown>();
}

Matrix whitening(const Matrix& covariance) {
    return covariance.llt().matrixL().solve(Matrix::Identity());
}

/// Ceres takes differences in proportion to a parameter. From 1000 on they are 1e-3.
constexpr double zero = 1000.0;

/// An epoch's values are a deviation from what the smoother found, in its standard deviations.
struct Scaled {
    const InertialNominal* about;
    State unit;
    InertialNominal at(const double* x) const {
        const State deviates = Eigen::Map<const State>(x) - State::Constant(zero);
        ErrorVector all = ErrorVector::Zero();
        all.head<shown>() = unit.cwiseProduct(deviates);
        return corrected(*about, all);
    }
};

struct MotionResidual {
    const InertialData* data;
    const SampleReader* samples;
    Scaled from, to;
    double from_s, to_s;
    Matrix whiten;

    bool operator()(const double* a, const double* b, double* residual) const {
        InertialNominal carried = from.at(a);
        SampleReader reader = *samples;
        reader.seek(from_s);
        while (const auto piece = reader.next(to_s))
            carried.state =
                strapdown_step(carried.state, piece->sample, carried.bias, data->earth).state;
        carried.position_error_m *= std::exp(-(to_s - from_s) / data->position_error.time_s);
        Eigen::Map<State>(residual, shown) = whiten * shown_deviation(to.at(b), carried);
        return true;
    }
};

struct PositionResidual {
    PositionFix fix;
    Scaled state;
    Eigen::Matrix3d whiten;

    bool operator()(const double* x, double* residual) const {
        const InertialNominal at = state.at(x);
        const Eigen::Vector3d left = fix.enu_m - at.state.position_m -
                                     at.state.enu_from_body * at.antenna_m - at.position_error_m;
        Eigen::Map<Eigen::Vector3d>(residual, 3) = whiten * left;
        return true;
    }
};

struct PriorResidual {
    InertialNominal prior;
    Scaled state;
    Matrix whiten;

    bool operator()(const double* x, double* residual) const {
        Eigen::Map<State>(residual, shown) = whiten * shown_deviation(state.at(x), prior);
        return true;
    }
};

template <int... Sizes, class Residual>
ceres::CostFunction* cost(const Residual& residual) {
    return new ceres::NumericDiffCostFunction<Residual, ceres::CENTRAL, Sizes...>(
        new Residual(residual));
}

/// What the noise of the IMU adds between two epochs: the prediction of a known state.
Matrix step_noise(const InertialData& data, const InertialNominal& from, std::size_t k) {
    InertialData two = data;
    two.fixes = {data.fixes[k], data.fixes[k + 1]};
    const InertialPrior known{.nominal = from, .covariance = ErrorMatrix::Zero()};
    return shown_of(filter_forwards(two, known, {}, 2).predicted_covariance[1]);
}

InertialNominal nominal_of(const InertialEpoch& epoch, const InertialSetup& setup) {
    // The reference point is the IMU here.
    return {.state = {.enu_from_body = epoch.enu_from_body,
                      .velocity_m_s = epoch.reference_point.velocity_m_s,
                      .position_m = epoch.reference_point.position_m},
            .bias = epoch.bias,
            .position_error_m = epoch.position_error_m,
            .antenna_m = setup.antenna_m};
}

/// The batch's own covariances, of single epochs and between two, against the smoother's.
void expect_covariances_to_agree(ceres::Problem& problem, const std::vector<State>& x,
                                 const std::vector<Scaled>& scaled, const JointErrors& joint) {
    constexpr std::size_t s = 250, e = 280;
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    ceres::Covariance covariance(options);
    const double *at_s = x[s].data(), *at_e = x[e].data();
    ASSERT_TRUE(covariance.Compute({{at_s, at_s}, {at_s, at_e}, {at_e, at_e}}, &problem));
    // All in units of the smoother's standard deviations.
    const auto block = [&](const double* a, const double* b) {
        Eigen::Matrix<double, shown, shown, Eigen::RowMajor> found;
        EXPECT_TRUE(covariance.GetCovarianceBlock(a, b, found.data()));
        return Matrix(found);
    };
    const auto scaled_by = [&](const Matrix& m, std::size_t a, std::size_t b) -> Matrix {
        return scaled[a].unit.cwiseInverse().asDiagonal() * m *
               scaled[b].unit.cwiseInverse().asDiagonal();
    };
    ErrorMatrix carried = joint.covariance[e];
    for (std::size_t k = e; k > s; --k)
        carried = joint.gain[k - 1] * carried;
    const Matrix cross = shown_of(carried);
    const double single =
        (block(at_s, at_s) - scaled_by(shown_of(joint.covariance[s]), s, s)).cwiseAbs().maxCoeff();
    const double across = (block(at_s, at_e) - scaled_by(cross, s, e)).cwiseAbs().maxCoeff();
    EXPECT_GT(scaled_by(cross, s, e).cwiseAbs().maxCoeff(), 0.5);
    EXPECT_LT(single, 1e-2);
    EXPECT_LT(across, 1e-2);
    std::printf("covariances differ by %.1e, between epochs by %.1e\n", single, across);
}

void expect_the_batch_to_agree(InertialRunSpec spec) {
    spec.duration_s = 61.0;
    const InertialRun run = simulate_inertial(spec);
    const InertialSetup setup = setup_of(spec);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
    const auto& joint = solution.joint->errors;
    InertialData data{.samples = run.samples,
                      .fixes = {},
                      .earth = EarthFrame(spec.origin),
                      .noise = setup.noise,
                      .position_error = setup.position_error};
    const std::size_t first = test::first_truth(run, solution), count = solution.epochs.size();
    for (std::size_t k = 0; k < count; ++k)
        data.fixes.push_back(run.fixes[first + k]);
    const InertialPrior prior = find_start(data, setup).prior;
    const SampleReader reader(data.samples);

    std::vector<InertialNominal> about(count);
    std::vector<Scaled> scaled(count);
    std::vector<State> x(count);
    RandomGenerator random(1);
    for (std::size_t k = 0; k < count; ++k) {
        about[k] = nominal_of(solution.epochs[k], setup);
        scaled[k] = {.about = &about[k],
                     .unit = shown_of(joint.covariance[k]).diagonal().cwiseSqrt()};
        for (double& each : x[k])
            each = zero + random.normal();  // a standard deviation away
    }
    ceres::Problem problem;
    problem.AddResidualBlock(cost<shown, shown>(PriorResidual{
                                 prior.nominal, scaled[0], whitening(shown_of(prior.covariance))}),
                             nullptr, x[0].data());
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Matrix3d whiten =
            data.fixes[k].covariance_m2.llt().matrixL().solve(Eigen::Matrix3d::Identity());
        problem.AddResidualBlock(cost<3, shown>(PositionResidual{data.fixes[k], scaled[k], whiten}),
                                 nullptr, x[k].data());
        if (k + 1 == count) break;
        problem.AddResidualBlock(cost<shown, shown, shown>(MotionResidual{
                                     .data = &data,
                                     .samples = &reader,
                                     .from = scaled[k],
                                     .to = scaled[k + 1],
                                     .from_s = data.fixes[k].time_s,
                                     .to_s = data.fixes[k + 1].time_s,
                                     .whiten = whitening(step_noise(data, about[k], k))}),
                                 nullptr, x[k].data(), x[k + 1].data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.function_tolerance = 1e-14;
    options.max_num_iterations = 40;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    EXPECT_NE(summary.termination_type, ceres::FAILURE) << summary.BriefReport();
    double most[6] = {};
    for (std::size_t k = 0; k < count; ++k)
        for (int j = 0; j < shown; ++j)
            most[j / 3] = std::max(most[j / 3], std::abs(x[k](j) - zero));
    for (const double each : most)
        EXPECT_LT(each, 1e-2);
    expect_covariances_to_agree(problem, x, scaled, joint);
    std::printf(
        "smoother less batch, standard deviations: attitude %.1e velocity %.1e position "
        "%.1e biases %.1e %.1e error %.1e (%s)\n",
        most[0], most[1], most[2], most[3], most[4], most[5], summary.BriefReport().c_str());
}

TEST(InertialBatch, AgreesWithTheSmootherOnALake) {
    expect_the_batch_to_agree(test::lake(ImuClass::mems, 5));
}

TEST(InertialBatch, AgreesWithTheSmootherOnAnOval) {
    expect_the_batch_to_agree(test::oval(ImuClass::tactical, 6));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <nlohmann/json.hpp>

#include "comparison_data.h"
#include "motion/chain.h"

// The project's own filter and smoother, on the data of the others.

namespace runcert::comparison {
namespace {

/// The others have no error that lasts: ours is so small that the answer is the same. What it is
/// does not change the time.
constexpr GaussMarkovError next_to_none{
    .tau_s = 1.0, .process_density = 1e-9, .initial_sigma_m = 1e-9};

/// The axes from `first` on: those of the plane, or height.
template <int Axes>
std::vector<ArcEpoch<Axes>> arc_of(const std::vector<MeasuredPosition>& positions, int first) {
    std::vector<ArcEpoch<Axes>> arc(positions.size());
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k] = {
            .time_s = static_cast<double>(k) * step_s,
            .measurement = PositionMeasurement<Axes>{
                .position = positions[k].position.template segment<Axes>(first),
                .covariance = positions[k].covariance.template block<Axes, Axes>(first, first)}};
    return arc;
}

/// Of each epoch all that the stage smooth writes into its table: the means, and the standard
/// deviations of position, velocity and acceleration.
template <int Axes>
void smooth(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model, int first,
            std::vector<SmoothedPoint>& points, std::vector<Eigen::Vector3d>& accelerations) {
    const Chain<Axes> chain(arc, model);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const StateVector<Axes> mean = chain.mean(k);
        const auto sigma = [&](int kind) {
            return PositionVector<Axes>(chain.covariance_of(kind, k).diagonal().cwiseSqrt());
        };
        for (const int kind : {0, 1}) {
            points[k].mean.template segment<Axes>(3 * kind + first) =
                mean.template segment<Axes>(kind * Axes);
            points[k].sigma.template segment<Axes>(3 * kind + first) = sigma(kind);
        }
        accelerations[k].template segment<Axes>(first) = sigma(2);
    }
}

nlohmann::ordered_json program(const Arguments& arguments) {
    const std::vector<MeasuredPosition> positions = read_positions(arguments.data);
    const std::vector<ArcEpoch<2>> plane = arc_of<2>(positions, 0);
    const std::vector<ArcEpoch<1>> height = arc_of<1>(positions, 2);
    EstimationModel model;
    model.motion.jerk_density = jerk_density;
    model.error = next_to_none;
    std::vector<SmoothedPoint> points(positions.size());
    std::vector<Eigen::Vector3d> accelerations(positions.size());
    const double seconds = seconds_of([&] {
        smooth<2>(plane, model, 0, points, accelerations);
        smooth<1>(height, model, 2, points, accelerations);
    });
    write_points(arguments.result, points.size(), arguments.every,
                 [&](std::size_t k) { return points[k]; });
    return {{"epochs", points.size()}, {"seconds", seconds}};
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run_program(argc, argv, runcert::comparison::program);
}

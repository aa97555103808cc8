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

std::vector<ArcEpoch<3>> arc_of(const std::vector<MeasuredPosition>& positions) {
    std::vector<ArcEpoch<3>> arc(positions.size());
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k] = {.time_s = static_cast<double>(k) * step_s,
                  .measurement = PositionMeasurement<3>{.position = positions[k].position,
                                                        .covariance = positions[k].covariance}};
    return arc;
}

/// Of each epoch, all that the stage smooth writes into its table: the means, and the covariances
/// of position, of velocity and of acceleration.
struct Smoothed {
    std::vector<SmoothedPoint> points;
    std::vector<Eigen::Matrix3d> covariances;  // three for each epoch
};

Smoothed smoothed(std::span<const ArcEpoch<3>> arc, const EstimationModel& model) {
    Smoothed result;
    result.points.resize(arc.size());
    result.covariances.resize(3 * arc.size());
    using Smoother = MotionSmoother<3>;
    for (Smoother at(arc, model); !at.done(); at.step_back()) {
        for (const int kind : {Smoother::position, Smoother::velocity, Smoother::acceleration})
            result.covariances[3 * at.epoch() + static_cast<std::size_t>(kind)] =
                at.covariance(kind);
        SmoothedPoint& point = result.points[at.epoch()];
        point.mean = at.mean().template head<6>();
        for (const int kind : {Smoother::position, Smoother::velocity})
            point.sigma.segment<3>(3 * kind) =
                result.covariances[3 * at.epoch() + static_cast<std::size_t>(kind)]
                    .diagonal()
                    .cwiseSqrt();
    }
    return result;
}

nlohmann::ordered_json program(const Arguments& arguments) {
    const std::vector<ArcEpoch<3>> arc = arc_of(read_positions(arguments.data));
    EstimationModel model;
    model.motion.jerk_density = jerk_density;
    model.error = next_to_none;
    Smoothed result;
    const double seconds = seconds_of([&] { result = smoothed(arc, model); });
    write_points(arguments.result, arc.size(), arguments.every,
                 [&](std::size_t k) { return result.points[k]; });
    return {{"epochs", arc.size()}, {"seconds", seconds}};
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run_program(argc, argv, runcert::comparison::program);
}

#include "comparison_data.h"
#include "estimation/smoother.h"

// The project's own filter and smoother, on the data of the others.

namespace runcert::comparison {
namespace {

/// The Gauss-Markov error of the 12-state form; what it is does not change the time.
const GaussMarkovError slow_error = GaussMarkovError::steady(0.005, 5.0);

/// Too small to change a digit that is compared, which GaussMarkovError::steady's least is not: an
/// error of 10 um that lasts 1 s makes a standard deviation larger by some 1e-5 of itself.
const GaussMarkovError no_error{.tau_s = 1.0, .process_density = 1e-8, .initial_sigma_m = 1e-8};

std::vector<ArcEpoch<3>> arc_of(const std::vector<MeasuredPosition>& positions) {
    std::vector<ArcEpoch<3>> arc(positions.size());
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k] = {.time_s = static_cast<double>(k) * step_s,
                  .measurement = PositionMeasurement<3>{.position = positions[k].position,
                                                        .covariance = positions[k].covariance}};
    return arc;
}

EstimationModel model_of(int states) {
    EstimationModel model;
    model.motion.jerk_density = jerk_density;
    model.error = states == 12 ? slow_error : no_error;
    return model;
}

/// Times `smooth_arc`, which returns an arc whose states begin with positions and velocities.
template <class SmoothArc>
nlohmann::ordered_json timed(const Arguments& arguments, std::size_t epochs,
                             const SmoothArc& smooth_arc) {
    decltype(smooth_arc()) result;
    const double seconds = seconds_of([&] { result = smooth_arc(); });
    write_points(arguments.result, epochs, arguments.every, [&](std::size_t k) {
        const auto& state = result.states[k];
        return SmoothedPoint{.mean = state.mean.template head<6>(),
                             .sigma = state.covariance.diagonal().template head<6>().cwiseSqrt()};
    });
    return {{"epochs", epochs}, {"seconds", seconds}};
}

nlohmann::ordered_json program(const Arguments& arguments) {
    const std::vector<ArcEpoch<3>> arc = arc_of(read_positions(arguments.data));
    const EstimationModel model = model_of(arguments.states);
    // The one place that says which form of the smoother has how many states: there is one of 12.
    return timed(arguments, arc.size(), [&] { return smooth<3>(arc, model); });
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run_program(argc, argv, runcert::comparison::program);
}

#include "estimation/wheel_motion.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace runcert {
namespace {

/// No tyre rolls more alike from run to run.
constexpr double least_sigma = 1e-3;
constexpr std::size_t fewest_runs = 2;

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace

WheelMotion::WheelMotion(VelocityWitness<2> motion, std::vector<WheelRun> runs, double sigma_scale,
                         bool calibrated)
    : motion_(std::move(motion)),
      runs_(std::move(runs)),
      sigma_scale_(sigma_scale),
      calibrated_(calibrated) {}

WheelScale WheelMotion::scale_for(double from_s, double to_s,
                                  const PositionVector<2>& moved) const {
    const WheelScale given{.value = 1.0, .sigma = sigma_scale_, .independent = calibrated_};
    if (calibrated_) return given;
    std::vector<double> all, along, against;
    for (const WheelRun& run : runs_) {
        if (run.span.last_s > from_s - between_runs_s && run.span.first_s < to_s + between_runs_s)
            continue;
        all.push_back(run.scale);
        (run.direction.dot(moved) > 0.0 ? along : against).push_back(run.scale);
    }
    if (all.size() < fewest_runs) return given;
    const double middle = mean(all);
    double square = 0.0;
    for (const double scale : all)
        square += (scale - middle) * (scale - middle);
    const auto count = static_cast<double>(all.size());
    const double differ = std::sqrt(square / (count - 1.0) * (1.0 + 1.0 / count)) *
                          student_t_quantile(0.975, count - 1.0) / normal_quantile(0.975);
    const bool both_ways = !along.empty() && !against.empty();
    return {.value = both_ways ? 0.5 * (mean(along) + mean(against)) : middle,
            .sigma = std::hypot(least_sigma, differ),
            .independent = true};
}

std::optional<WitnessedMotion<2>> WheelMotion::between(double from_s, double to_s) const {
    auto motion = motion_.between(from_s, to_s);
    if (!motion) return std::nullopt;
    const WheelScale scale = scale_for(from_s, to_s, motion->displacement_m);
    motion->displacement_m *= scale.value;
    motion->covariance_m2 +=
        scale.sigma * scale.sigma * motion->displacement_m * motion->displacement_m.transpose();
    motion->confirms = scale.independent;
    return motion;
}

std::optional<double> WheelMotion::path_between(double from_s, double to_s) const {
    const auto path_m = motion_.path_between(from_s, to_s);
    const auto moved = path_m ? motion_.between(from_s, to_s) : std::nullopt;
    if (!moved) return std::nullopt;
    return *path_m * scale_for(from_s, to_s, moved->displacement_m).value;
}

}  // namespace runcert

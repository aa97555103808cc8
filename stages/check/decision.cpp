#include "stages/check/decision.h"

#include <cmath>

namespace runcert {

double target_speed(const Profile& profile, double record_mps) {
    const double target_mps = profile.margin_is_relative ? record_mps * (1.0 + profile.margin)
                                                         : record_mps + profile.margin;
    if (!profile.rounding) return target_mps;
    const double unit_mps = metres_per_second(profile.rounding->unit);
    const double scale = std::pow(10.0, profile.rounding->decimals);
    const double figure = target_mps / unit_mps * scale;
    // A figure that is whole but for the rounding of binary fractions is not cut to the one below.
    constexpr double tolerance = 1e-9;
    const double rounded_figure = profile.rounding->mode == "truncate"
                                      ? std::floor(figure + tolerance * figure)
                                      : std::round(figure);
    return rounded_figure / scale * unit_mps;
}

std::string decide(double speed_mps, double expanded_uncertainty_mps, double target_mps) {
    if (speed_mps < target_mps) return "not_beaten";
    return speed_mps - expanded_uncertainty_mps >= target_mps ? "beaten" : "not_proven";
}

}  // namespace runcert

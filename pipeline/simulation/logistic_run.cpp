#include "simulation/logistic_run.h"

#include <fmt/format.h>

#include <cmath>

#include "core/failure.h"

namespace runcert {

void require_valid(const LogisticRun& run) {
    // Written so that NaN fails too.
    if (!(run.half_speed_time_s > 0.0) || !std::isfinite(run.half_speed_time_s))
        throw Failure("run", "the time of half speed is not a positive number of seconds",
                      "Give the time t0 at which the speed is half the top speed");
    if (!(run.start_speed_m_s > 0.0 && run.start_speed_m_s < run.top_speed_m_s / 2.0) ||
        !std::isfinite(run.top_speed_m_s))
        throw Failure("run",
                      fmt::format("the speed at the start, {} m/s, is not between 0 and half the "
                                  "top speed of {} m/s",
                                  run.start_speed_m_s, run.top_speed_m_s),
                      "The speed must grow from the start to the time t0, when it is half the top "
                      "speed");
}

RunState logistic_run(const LogisticRun& run, double time_s) {
    require_valid(run);
    const double A = run.top_speed_m_s;
    const double t0 = run.half_speed_time_s;
    const double c = A / run.start_speed_m_s - 1.0;  // exp(r t0), as r = ln(A / v0 - 1) / t0
    const double r = std::log(c) / t0;
    const double u = r * (time_s - t0);
    // [DHD22] writes acceleration and jerk with cosh u and sinh u, which overflow far from t0.
    // With e = exp(-|u|): 1 + cosh u = (1 + e)^2 / (2 e), and sinh u / (1 + cosh u) =
    // +-(1 - e) / (1 + e).
    const double e = std::exp(-std::abs(u));
    const double one_over_1_plus_cosh = 2.0 * e / ((1.0 + e) * (1.0 + e));
    const double sinh_over_1_plus_cosh = std::copysign((1.0 - e) / (1.0 + e), u);
    return {
        .distance_m = A * (time_s + std::log((1.0 + c * std::exp(-r * time_s)) / (1.0 + c)) / r),
        .speed_m_s = A / (1.0 + std::exp(-u)),
        .acceleration_m_s2 = A * r / 2.0 * one_over_1_plus_cosh,
        .jerk_m_s3 = -A * r * r / 2.0 * sinh_over_1_plus_cosh * one_over_1_plus_cosh};
}

}  // namespace runcert

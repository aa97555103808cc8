#include "stages/check/threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/uncertainty.h"

namespace runcert {
namespace {

void require_positive(double value, const char* name) {
    if (!(value > 0.0 && std::isfinite(value)))
        throw Failure("margin", fmt::format("the {} is {}", name, value),
                      "Give a finite number above 0");
}

void require_not_negative(double value, const char* name) {
    if (!(value >= 0.0 && std::isfinite(value)))
        throw Failure("margin", fmt::format("the {} is {}", name, value),
                      "Give a finite number, 0 or more");
}

struct SpeedToReach {
    double speed_mps = 0.0;
    double derivative = 1.0;  ///< by the speed it is taken above
};

SpeedToReach faster_over_the_course(const MarginRule& rule, double speed_mps) {
    require_positive(rule.distance_m, "length of the course (m)");
    const double record_s = rule.distance_m / speed_mps;
    if (!(rule.value < record_s))
        throw Failure("margin",
                      fmt::format("{} s are to be gained on a record of {:.3f} s over {} m",
                                  rule.value, record_s, rule.distance_m),
                      "Check the record's unit and the course's length");
    const double to_reach_mps = rule.distance_m / (record_s - rule.value);
    const double gain = to_reach_mps / speed_mps;
    return {.speed_mps = to_reach_mps, .derivative = gain * gain};
}

SpeedToReach above(const MarginRule& rule, double speed_mps) {
    switch (rule.kind) {
        case MarginKind::absolute:
            return {.speed_mps = speed_mps + rule.value, .derivative = 1.0};
        case MarginKind::relative:
            return {.speed_mps = speed_mps * (1.0 + rule.value), .derivative = 1.0 + rule.value};
        case MarginKind::elapsed_time:
            break;
    }
    return faster_over_the_course(rule, speed_mps);
}

StepRounding step_rounding(RoundingMode mode) {
    switch (mode) {
        case RoundingMode::truncate:
            return StepRounding::down;
        case RoundingMode::nearest:
            return StepRounding::nearest;
        case RoundingMode::up:
            break;
    }
    return StepRounding::up;
}

}  // namespace

Threshold threshold_of(const MarginRule& rule, const StandingRecord& record) {
    require_positive(record.speed_mps, "standing record (m/s)");
    require_not_negative(record.expanded_uncertainty_mps, "record's expanded uncertainty (m/s)");
    require_not_negative(rule.value, "margin");
    const double upper_mps = record.speed_mps + record.expanded_uncertainty_mps;
    const SpeedToReach exact = above(rule, rule.above_upper_limit ? upper_mps : record.speed_mps);
    const double standard_uncertainty_mps =
        rule.above_upper_limit
            ? 0.0
            : exact.derivative * record.expanded_uncertainty_mps / usual_coverage_factor;
    require_positive(exact.speed_mps, "required speed (m/s)");
    return {.speed_mps =
                rule.rounding ? rounded_speed(exact.speed_mps, *rule.rounding) : exact.speed_mps,
            .standard_uncertainty_mps = standard_uncertainty_mps};
}

double rounded_speed(double speed_mps, const DecimalRounding& rounding) {
    if (!(speed_mps >= 0.0 && std::isfinite(speed_mps)))
        throw Failure("rounding", fmt::format("the speed is {} m/s", speed_mps),
                      "Give a finite speed, 0 or more");
    if (!(rounding.unit_mps > 0.0 && std::isfinite(rounding.unit_mps)))
        throw Failure("rounding", fmt::format("the unit is {} m/s", rounding.unit_mps),
                      "Give the metres per second in a unit");
    if (rounding.decimals < 0 || rounding.decimals > kMostDecimals)
        throw Failure("rounding", fmt::format("{} decimals", rounding.decimals),
                      fmt::format("Give 0 to {}", kMostDecimals));
    const double scale = power_of_ten(rounding.decimals);
    const double steps = speed_mps / rounding.unit_mps * scale;
    const double tolerance = std::min(2e-12 * steps, 5e-7);
    return whole_steps(steps, tolerance, step_rounding(rounding.mode)) / scale * rounding.unit_mps;
}

}  // namespace runcert

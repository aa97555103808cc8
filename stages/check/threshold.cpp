#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/uncertainty.h"
#include "stages/check/decision.h"

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
    double speed_m_s = 0.0;
    double derivative = 1.0;  ///< with respect to the speed to which the margin is added
};

SpeedToReach faster_over_the_course(const MarginRule& rule, double speed_m_s) {
    require_positive(rule.distance_m, "length of the course (m)");
    const double record_s = rule.distance_m / speed_m_s;
    if (!(rule.value < record_s))
        throw Failure("margin",
                      fmt::format("{} s are to be gained on a record of {:.3f} s over {} m",
                                  rule.value, record_s, rule.distance_m),
                      "Check the record's unit and the course's length");
    const double to_reach_m_s = rule.distance_m / (record_s - rule.value);
    const double gain = to_reach_m_s / speed_m_s;
    return {.speed_m_s = to_reach_m_s, .derivative = gain * gain};
}

SpeedToReach above(const MarginRule& rule, double speed_m_s) {
    switch (rule.kind) {
        case MarginKind::absolute:
            return {.speed_m_s = speed_m_s + rule.value, .derivative = 1.0};
        case MarginKind::relative:
            return {.speed_m_s = speed_m_s * (1.0 + rule.value), .derivative = 1.0 + rule.value};
        case MarginKind::elapsed_time:
            break;
    }
    return faster_over_the_course(rule, speed_m_s);
}

}  // namespace

Threshold threshold_of(const MarginRule& rule, const StandingRecord& record) {
    require_positive(record.speed_m_s, "standing record (m/s)");
    require_not_negative(record.expanded_uncertainty_m_s, "record's expanded uncertainty (m/s)");
    require_not_negative(rule.value, "margin");
    const double upper_m_s = record.speed_m_s + record.expanded_uncertainty_m_s;
    const SpeedToReach exact = above(rule, rule.above_upper_limit ? upper_m_s : record.speed_m_s);
    const double standard_uncertainty_m_s =
        rule.above_upper_limit
            ? 0.0
            : exact.derivative * record.expanded_uncertainty_m_s / usual_coverage_factor;
    require_positive(exact.speed_m_s, "required speed (m/s)");
    return {.speed_m_s =
                rule.rounding ? rounded_speed(exact.speed_m_s, *rule.rounding) : exact.speed_m_s,
            .standard_uncertainty_m_s = standard_uncertainty_m_s};
}

double rounded_speed(double speed_m_s, const DecimalRounding& rounding) {
    if (!(speed_m_s >= 0.0 && std::isfinite(speed_m_s)))
        throw Failure("rounding", fmt::format("the speed is {} m/s", speed_m_s),
                      "Give a finite speed, 0 or more");
    if (!(rounding.unit_m_s > 0.0 && std::isfinite(rounding.unit_m_s)))
        throw Failure("rounding", fmt::format("the unit is {} m/s", rounding.unit_m_s),
                      "Give the metres per second in a unit");
    if (rounding.decimals < 0 || rounding.decimals > kMostDecimals)
        throw Failure("rounding", fmt::format("{} decimals", rounding.decimals),
                      fmt::format("Give 0 to {}", kMostDecimals));
    const double scale = power_of_ten(rounding.decimals);
    const double steps = speed_m_s / rounding.unit_m_s * scale;
    const double tolerance = std::min(2e-12 * steps, 5e-7);
    return whole_steps(steps, tolerance, rounding.mode) / scale * rounding.unit_m_s;
}

}  // namespace runcert

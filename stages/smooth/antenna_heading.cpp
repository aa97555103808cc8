#include "stages/smooth/antenna_heading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "inertial/antenna_baseline.h"

namespace runcert {
namespace {

/// What the antennas say of the heading, in a sentence.
std::string heading_words(const BaselineJudgement& judged, const std::string& receiver) {
    const double difference_deg = judged.difference_rad.value * degrees_per_radian;
    const double expanded_deg = 2.0 * judged.difference_rad.sigma * degrees_per_radian;
    const std::string text = fmt::format(
        "By the direction to the antenna of {} the heading is {:.2f} degrees {} than by the IMU, "
        "on average over {}. The expanded uncertainty of that is {:.2f} degrees (k = 2). ",
        receiver, std::abs(difference_deg), difference_deg < 0.0 ? "less" : "more",
        counted(std::ssize(judged.headings), "epoch"), expanded_deg);
    return text + (judged.agrees ? "The two agree."
                                 : "The two do not agree: an antenna's place on the craft, or an "
                                   "axis of the IMU, is not as stated.");
}

}  // namespace

void compare_headings(const InertialSolution& solution, const InertialSetup& setup,
                      const std::string& receiver, AttitudeTable& table) {
    if (!setup.baseline) return;
    const Eigen::Vector3d& body_m = setup.baseline->body_m;
    AntennaHeading& comparison = table.baseline.emplace();
    comparison.receiver = receiver;
    comparison.declared = {body_m.x(), body_m.y(), body_m.z()};
    const auto judged = judge_baseline(solution, *setup.baseline, setup.position_error);
    if (!judged) {
        comparison.judgement = fmt::format(
            "The antenna of {} shows no heading: no epoch has heights of both antennas, or one "
            "is stated to be above the other.",
            receiver);
        return;
    }
    comparison.length_m = judged->length_m.value;
    comparison.sigma_length_m = judged->length_m.sigma;
    if (!is_stated_length(*setup.baseline, judged->length_m)) {
        comparison.judgement = fmt::format(
            "The antenna of {} is {:.3f} m away as measured, and {:.3f} m as stated. Its place on "
            "the craft is not as stated, and shows no heading.",
            receiver, judged->length_m.value, body_m.norm());
        return;
    }
    comparison.epochs = std::ssize(judged->headings);
    comparison.difference_deg = judged->difference_rad.value * degrees_per_radian;
    comparison.sigma_deg = judged->difference_rad.sigma * degrees_per_radian;
    comparison.agrees = judged->agrees;
    comparison.judgement = heading_words(*judged, receiver);
    auto row = table.rows.begin();
    for (const BaselineHeading& one : judged->headings) {
        row = std::find_if(row, table.rows.end(), [&](const AttitudeEpoch& each) {
            return each.usable && each.time.seconds() == one.time_s;
        });
        if (row == table.rows.end()) return;
        row->baseline_heading_deg = one.heading_rad * degrees_per_radian;
        row->sigma_baseline_heading_deg = one.sigma_rad * degrees_per_radian;
    }
}

}  // namespace runcert

#include "simulation/craft_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "simulation/simulate.h"

namespace runcert {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double straight_m = 600.0, radius_m = 320.0, entry_m = 150.0;

double radians(double degrees) {
    return degrees * radians_per_degree;
}

/// 0 before 0, 1 after 1, with two continuous derivatives.
double smooth_step(double x) {
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

/// Two tones: 0.8 and 0.2 of the amplitude.
double oscillation(double time_s, double hz, double phase) {
    return 0.8 * std::sin(two_pi * hz * time_s + phase) +
           0.2 * std::sin(two_pi * 1.7 * hz * time_s + 2.0 * phase);
}

/// The normal of ground along a course that rises by `slope` and leans by `roll` across it.
Eigen::Vector3d normal_of(double course, double slope, double roll) {
    return -rotation_of({.roll = roll, .pitch = std::atan(slope), .heading = course}).col(2);
}

}  // namespace

double oval_bend(double way_m) {
    constexpr double turn_m = std::numbers::pi * radius_m + entry_m;  // half a turn
    const double at = std::fmod(way_m, straight_m + turn_m) - straight_m;
    return smooth_step(at / entry_m) - smooth_step((at - turn_m + entry_m) / entry_m);
}

double oval_bank(double way_m) {
    return radians(3.0 + 11.0 * oval_bend(way_m));
}

CraftMotion::CraftMotion(const InertialRunSpec& spec, RandomGenerator& random)
    : spec_(spec), way_m_(spec.start_m), course_(radians(spec.run ? spec.run->bearing_deg : 40.0)) {
    for (double& phase : phases_)
        phase = two_pi * random.uniform();
}

CraftState CraftMotion::at(std::int64_t tick) {
    const double time_s = static_cast<double>(tick) * tick_s - spec_.stand_s;
    return spec_.course == InertialCourse::oval ? on_the_oval(time_s) : on_the_lake(time_s);
}

double CraftMotion::roll(double time_s) const {
    return radians(spec_.roll_deg) * oscillation(time_s, spec_.roll_hz, phases_[6]);
}

double CraftMotion::pitch(double time_s) const {
    return radians(spec_.pitch_deg) * oscillation(time_s, spec_.pitch_hz, phases_[7]);
}

/// A craft that stands does not swing; from a tenth of its top speed on it does so in full.
double CraftMotion::swinging(double speed_m_s) const {
    return smooth_step(speed_m_s / (0.1 * spec_.run->top_speed_m_s));
}

CraftState CraftMotion::on_the_lake(double time_s) const {
    // A craft that stands sets off smoothly; one that is recorded on its way has a speed.
    const bool from_rest = spec_.stand_s > 0.0;
    double moving = from_rest ? smooth_step(time_s / 15.0) : 1.0;
    const double turning_s = std::max(time_s, 0.0);  // a craft that stands keeps its attitude
    double speed = 0.0, course = 0.0, slope = 0.0;
    if (spec_.run) {
        speed = logistic_run(*spec_.run, time_s).speed_m_s;
        moving = swinging(speed);
        course = radians(spec_.run->bearing_deg);
    } else {
        const double logistic = 1.0 / (1.0 + std::exp(-(time_s - 25.0) / 6.0));
        speed = moving * spec_.speed_m_s / 60.0 *
                (10.0 + 50.0 * logistic + std::sin(two_pi * 0.07 * time_s + phases_[0]) +
                 0.3 * std::sin(two_pi * 0.31 * time_s + phases_[1]));
        course = radians(62.0 + 1.5 * std::sin(two_pi * 0.03 * turning_s + phases_[2]) +
                         0.5 * std::sin(two_pi * 0.11 * turning_s + phases_[3]));
        slope = 0.002 * std::sin(two_pi * 0.05 * turning_s + phases_[4]);
    }
    const double leeway =
        radians(spec_.leeway_deg) * (1.0 + 0.2 * std::sin(two_pi * 0.2 * turning_s + phases_[5]));
    return {speed * Eigen::Vector3d(std::sin(course), std::cos(course), slope),
            rotation_of({.roll = moving * roll(time_s),
                         .pitch = moving * pitch(time_s) + slope,
                         .heading = course - leeway}),
            normal_of(course, slope, 0.0)};
}

CraftState CraftMotion::on_the_oval(double time_s) {
    double moving = spec_.stand_s > 0.0 ? smooth_step(time_s / 20.0) : 1.0;
    const double bend = oval_bend(way_m_), bank = oval_bank(way_m_);
    double speed =
        moving * (75.0 - 6.0 * bend + 3.0 * std::sin(two_pi * 0.03 * time_s + phases_[0]));
    if (spec_.run) {
        speed = logistic_run(*spec_.run, time_s).speed_m_s;
        moving = swinging(speed);
    }
    const double curvature = -bend / radius_m;  // to the left
    if (time_s > 0.0) {
        way_m_ += speed * tick_s;
        course_ += curvature * speed * tick_s;
    }
    const double lateral_g = speed * speed * curvature / 9.81;
    const double slip = radians(0.4) * bend;
    // The craft leans out of the turn on its springs, against the bank.
    const double leaning = -bank - radians(0.5) * lateral_g;
    const double climb =
        spec_.run ? 0.0 : 0.3 * moving * std::sin(two_pi * 0.04 * time_s + phases_[4]);
    return {{speed * std::sin(course_), speed * std::cos(course_), climb},
            rotation_of({.roll = leaning + moving * roll(time_s),
                         .pitch = moving * pitch(time_s),
                         .heading = course_ + slip}),
            normal_of(course_, speed > 0.0 ? climb / speed : 0.0, -bank)};
}

}  // namespace runcert

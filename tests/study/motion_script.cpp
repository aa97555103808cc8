#include "motion_script.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace runcert {

LineState MotionScript::after(const Part& part, double time_s) {
    const double t = time_s - part.begin_s;
    const auto& [distance, speed, acceleration] = part.state;
    const double jerk = part.jerk_m_s3;
    return {.distance_m = distance + t * (speed + t * (acceleration / 2.0 + t * jerk / 6.0)),
            .speed_m_s = speed + t * (acceleration + t * jerk / 2.0),
            .acceleration_m_s2 = acceleration + t * jerk};
}

MotionScript& MotionScript::add(double duration_s, double jerk_m_s3) {
    if (duration_s <= 0.0) return *this;
    parts_.push_back({end_s_, end_, jerk_m_s3});
    end_s_ += duration_s;
    end_ = after(parts_.back(), end_s_);
    return *this;
}

MotionScript& MotionScript::kick(double acceleration_m_s2) {
    end_.acceleration_m_s2 += acceleration_m_s2;
    return *this;
}

MotionScript& MotionScript::change_speed(double by_m_s, double acceleration_m_s2,
                                         double rounding_s) {
    const double acceleration = std::copysign(acceleration_m_s2, by_m_s);
    const double lasts_s = by_m_s / acceleration;
    if (rounding_s <= 0.0) return kick(acceleration).add(lasts_s).kick(-acceleration);
    // Where there is no time for all of it, less acceleration in the same time.
    const double rounding = std::min(rounding_s, lasts_s);
    const double jerk = acceleration / rounding;
    return add(rounding, jerk).add(lasts_s - rounding).add(rounding, -jerk);
}

MotionScript& MotionScript::gust(double amplitude_m_s, double period_s) {
    gusts_.push_back({end_s_, amplitude_m_s, period_s});
    return *this;
}

LineState MotionScript::at(double time_s) const {
    auto part = std::upper_bound(parts_.begin(), parts_.end(), time_s,
                                 [](double time, const Part& one) { return time < one.begin_s; });
    if (part != parts_.begin()) --part;
    LineState state = after(*part, time_s);
    for (const Gust& gust : gusts_) {
        if (time_s <= gust.begin_s) continue;
        const double rate = 2.0 * std::numbers::pi / gust.period_s;
        const double phase = rate * (time_s - gust.begin_s);
        state.distance_m += gust.amplitude_m_s / rate * (1.0 - std::cos(phase));
        state.speed_m_s += gust.amplitude_m_s * std::sin(phase);
        state.acceleration_m_s2 += gust.amplitude_m_s * rate * std::cos(phase);
    }
    return state;
}

}  // namespace runcert

#pragma once

#include <vector>

namespace runcert {

/// Distance (m), speed (m/s) and acceleration (m/s^2) along a straight line.
struct LineState {
    double distance_m = 0.0;
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
};

/// A motion along a line in parts, exactly integrated: stretches of constant jerk one after the
/// other, from rest, and sinusoids of the speed on them.
class MotionScript {
  public:
    /// So long with this jerk (m/s^3).
    MotionScript& add(double duration_s, double jerk_m_s3 = 0.0);

    /// Changes the speed by so much at this acceleration (m/s^2, positive), which comes and goes in
    /// `rounding_s` each, at once where that is zero.
    MotionScript& change_speed(double by_m_s, double acceleration_m_s2, double rounding_s);

    /// The acceleration jumps by so much.
    MotionScript& kick(double acceleration_m_s2);

    /// From the end of what is there so far to the end of what is there at last: amplitude (m/s)
    /// and period (s) of a sinusoid of the speed, which begins at zero.
    MotionScript& gust(double amplitude_m_s, double period_s);

    double duration_s() const { return end_s_; }
    LineState at(double time_s) const;

  private:
    struct Part {
        double begin_s = 0.0;
        LineState state;  ///< at its beginning
        double jerk_m_s3 = 0.0;
    };
    struct Gust {
        double begin_s = 0.0;
        double amplitude_m_s = 0.0;
        double period_s = 0.0;
    };
    static LineState after(const Part& part, double time_s);

    std::vector<Part> parts_;
    std::vector<Gust> gusts_;
    LineState end_;
    double end_s_ = 0.0;
};

}  // namespace runcert

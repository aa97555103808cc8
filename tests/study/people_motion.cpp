#include "people_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace runcert {
namespace {

double between(double least, double most, RandomGenerator& random) {
    return least + (most - least) * random.uniform();
}

/// A steady Gauss-Markov process of standard deviation 1.
class Wander {
  public:
    Wander(double tau_s, RandomGenerator& random)
        : decay_(std::exp(-TruePath::step_s / tau_s)),
          kick_(std::sqrt(1.0 - decay_ * decay_)),
          value_(random.normal()) {}
    double next(RandomGenerator& random) {
        value_ = decay_ * value_ + kick_ * random.normal();
        return value_;
    }

  private:
    double decay_;
    double kick_;
    double value_;
};

/// What the sailor wants for a while.
struct Leg {
    double lasts_s = 0.0;
    double speed_m_s = 0.0;
    double turn_rad_s = 0.0;
};

class Session {
  public:
    Session(double length_s, bool crash, RandomGenerator& random)
        : random_(random),
          crash_s_(crash ? length_s - between(20.0, 60.0, random) : 2.0 * length_s),
          stops_within_s_(between(0.4, 1.0, random)),
          run_m_s_(between(6.0, 18.0, random)),
          response_(between(0.35, 0.7, random)),
          gusts_(between(5.0, 15.0, random), random),
          course_(between(4.0, 12.0, random), random),
          heading_(between(0.0, 2.0 * std::numbers::pi, random)) {}

    TruePath sail(double length_s) {
        TruePath path;
        const auto steps = static_cast<std::size_t>(std::lround(length_s / TruePath::step_s));
        Eigen::Vector2d position(500.0, -300.0);
        for (std::size_t k = 0; k <= steps; ++k) {
            const Eigen::Vector2d velocity =
                speed_ * Eigen::Vector2d(std::sin(heading_), std::cos(heading_));
            if (k > 0) position += 0.5 * TruePath::step_s * (velocity + path.velocities_m_s.back());
            path.positions_m.push_back(position);
            path.velocities_m_s.push_back(velocity);
            step(static_cast<double>(k) * TruePath::step_s);
        }
        return path;
    }

  private:
    void step(double time_s) {
        constexpr double dt_s = TruePath::step_s;
        if (time_s >= leg_ends_s_ || (time_s >= crash_s_ - 15.0 && !last_run_)) next_leg(time_s);
        const double gust = 0.08 * leg_.speed_m_s * gusts_.next(random_);
        const double wander_rad_s = 0.02 * course_.next(random_);
        if (time_s >= crash_s_) {
            crash(dt_s);
            return;
        }
        const double wanted_m_s = leg_.speed_m_s + gust;
        acceleration_ +=
            dt_s * response_ * (response_ * (wanted_m_s - speed_) - 2.0 * acceleration_);
        speed_ = std::max(0.0, speed_ + dt_s * acceleration_);
        turn_rad_s_ += dt_s / 0.5 * (leg_.turn_rad_s + wander_rad_s - turn_rad_s_);
        heading_ += dt_s * turn_rad_s_;
        before_crash_m_s_ = speed_;
    }

    void crash(double dt_s) {
        speed_ = std::max(0.0, speed_ - dt_s * before_crash_m_s_ / stops_within_s_);
    }

    void next_leg(double time_s) {
        if (time_s >= crash_s_ - 15.0) {
            leg_ = {.lasts_s = 15.0 + 60.0, .speed_m_s = run_m_s_};
            last_run_ = true;
        } else if (leg_.turn_rad_s == 0.0 && leg_.speed_m_s > 1.0) {
            const double lasts_s = between(3.0, 8.0, random_);
            const double by_rad = between(2.0, std::numbers::pi, random_);
            leg_ = {.lasts_s = lasts_s,
                    .speed_m_s = leg_.speed_m_s * between(0.4, 0.8, random_),
                    .turn_rad_s = std::copysign(by_rad / lasts_s, random_.uniform() - 0.5)};
        } else if (random_.uniform() < 0.2) {
            leg_ = {.lasts_s = between(10.0, 40.0, random_), .speed_m_s = 0.3};
        } else {
            leg_ = {.lasts_s = between(20.0, 90.0, random_),
                    .speed_m_s = run_m_s_ * between(0.75, 1.1, random_)};
        }
        leg_ends_s_ = time_s + leg_.lasts_s;
    }

    RandomGenerator& random_;
    double crash_s_;
    double stops_within_s_;
    double run_m_s_;
    double response_;  ///< 1/s, of the speed to what is wanted
    Wander gusts_;
    Wander course_;
    double heading_;  ///< rad, clockwise from north
    double speed_ = 0.0;
    double acceleration_ = 0.0;
    double turn_rad_s_ = 0.0;
    double before_crash_m_s_ = 0.0;
    Leg leg_;
    double leg_ends_s_ = 0.0;
    bool last_run_ = false;
};

}  // namespace

std::size_t TruePath::index(double time_s) const {
    const double step = std::round(time_s / step_s);
    return static_cast<std::size_t>(
        std::clamp(step, 0.0, static_cast<double>(positions_m.size() - 1)));
}

double TruePath::speed_m_s(double from_s, double to_s) const {
    return (position(to_s) - position(from_s)).norm() / (to_s - from_s);
}

double TruePath::fastest_m_s(double lasting_s, double interval_s) const {
    double fastest = 0.0;
    for (double at_s = 0.0; at_s + lasting_s <= length_s() + 0.5 * step_s; at_s += interval_s)
        fastest = std::max(fastest, speed_m_s(at_s, at_s + lasting_s));
    return fastest;
}

TruePath random_session(double length_s, bool crash, RandomGenerator& random) {
    return Session(length_s, crash, random).sail(length_s);
}

}  // namespace runcert

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "stages/window/best_window.h"

namespace runcert::test {

/// A track to search, with what stands in the way of windows told sample by sample.
struct SearchTrack {
    std::vector<SampleSeries> series;
    std::vector<std::vector<bool>> obstacle;  ///< of each series' samples
    double interval_s = 0.1;
};

/// How a random track differs from an even one.
struct TrackOptions {
    std::uint64_t seed = 1;
    int epochs = 2000;
    bool irregular = false;  ///< time steps
    bool obstacles = false;
    bool vertical = false;
    double gaps_per_epoch = 1.0 / 400.0;
};

/// A craft that sails to and fro: speeds of 5 to 25 m/s, a turn by about 180 degrees every 15 to
/// 30 s, some stands, epochs missing, and gaps after which another series begins.
class RandomTrack {
  public:
    explicit RandomTrack(const TrackOptions& options) : options_(options), random_(options.seed) {
        begin_series();
        for (int k = 0; k < options.epochs; ++k) {
            if (random_.uniform() < options.gaps_per_epoch && !track_.series.back().times.empty())
                begin_series();
            sample();
            move(step_ns());
        }
    }

    SearchTrack take() { return std::move(track_); }

  private:
    double uniform(double from, double to) { return from + (to - from) * random_.uniform(); }

    void begin_series() {
        if (!track_.series.empty()) time_ns_ += 5'000'000'000;
        position_.x() += uniform(-30.0, 30.0);
        track_.series.emplace_back();
        track_.obstacle.emplace_back();
    }

    std::int64_t step_ns() {
        if (options_.irregular) return std::llround(uniform(0.03, 0.2) * 1e9);
        const bool missing = random_.uniform() < 0.01;
        return 100'000'000 * (missing ? 1 + std::llround(uniform(0.6, 3.4)) : 1);
    }

    void sample() {
        SampleSeries& series = track_.series.back();
        series.times.push_back({time_ns_});
        series.positions.push_back(position_);
        series.speeds_m_s.push_back(std::abs(speed_m_s_ + 0.05 * random_.normal()));
        const bool obstacle = options_.obstacles && random_.uniform() < 0.003;
        track_.obstacle.back().push_back(obstacle);
        if (!options_.obstacles) return;
        series.obstacles.push_back((series.obstacles.empty() ? 0 : series.obstacles.back()) +
                                   (obstacle ? 1 : 0));
        series.bounds.push_back(!obstacle && random_.uniform() > 0.02);
    }

    void move(std::int64_t step) {
        const double dt_s = static_cast<double>(step) * 1e-9;
        time_ns_ += step;
        if (standing_s_ > 0.0) {
            standing_s_ -= dt_s;
            return;
        }
        if (random_.uniform() < 1.0 / 1000.0) standing_s_ = 3.0;
        turn_in_s_ -= dt_s;
        if (turn_in_s_ < 0.0) {
            turn_in_s_ = uniform(15.0, 30.0);
            left_to_turn_ = (random_.uniform() < 0.5 ? -1.0 : 1.0) * uniform(2.8, 3.4);
        }
        const double turned = std::clamp(left_to_turn_, -dt_s, dt_s);  // 1 rad/s
        left_to_turn_ -= turned;
        heading_ += turned + 0.01 * random_.normal();
        speed_m_s_ = std::clamp(speed_m_s_ + std::sqrt(dt_s) * random_.normal(), 5.0, 25.0);
        // Never twice the same, so that no two windows are equally fast.
        position_ += (speed_m_s_ + 0.01 * random_.normal()) * dt_s *
                     Eigen::Vector3d(std::sin(heading_), std::cos(heading_),
                                     options_.vertical ? 0.5 * random_.normal() : 0.0);
    }

    TrackOptions options_;
    RandomGenerator random_;
    SearchTrack track_;
    std::int64_t time_ns_ = 0;
    Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
    double heading_ = 0.3;
    double speed_m_s_ = 12.0;
    double turn_in_s_ = 20.0;
    double left_to_turn_ = 0.0;
    double standing_s_ = 0.0;
};

inline SearchTrack random_track(const TrackOptions& options) {
    return RandomTrack(options).take();
}

/// A different kind of track for each number.
inline TrackOptions options_of(std::uint64_t number) {
    TrackOptions options;
    options.seed = 100 + number;
    options.irregular = number % 3 == 1;
    options.obstacles = number % 4 >= 2;
    options.vertical = number % 5 == 4;
    options.gaps_per_epoch = number % 2 == 0 ? 1.0 / 400.0 : 1.0 / 2000.0;
    return options;
}

inline constexpr auto displacement = SpeedDefinition::displacement;
inline constexpr auto path_length = SpeedDefinition::path_length;

inline WindowCriteria over_time(double duration_s, SpeedDefinition definition,
                                WindowEnds ends = WindowEnds::epochs) {
    WindowCriteria rule;
    rule.kind = WindowKind::time;
    rule.definition = definition;
    rule.ends = ends;
    rule.duration_s = duration_s;
    rule.duration_tolerance_s = 0.001;
    rule.nominal_interval_s = 0.1;
    return rule;
}

inline WindowCriteria exactly(double duration_s, SpeedDefinition definition) {
    WindowCriteria rule = over_time(duration_s, definition);
    rule.exact = true;
    return rule;
}

inline WindowCriteria over_distance(double distance_m, SpeedDefinition definition,
                                    WindowEnds ends = WindowEnds::epochs) {
    WindowCriteria rule;
    rule.kind = WindowKind::distance;
    rule.definition = definition;
    rule.ends = ends;
    rule.distance_m = distance_m;
    return rule;
}

inline WindowCriteria alpha(double distance_m) {
    WindowCriteria rule = over_distance(distance_m, path_length);
    rule.kind = WindowKind::alpha;
    rule.proximity_m = 50.0;
    rule.turn_deg = 90.0;
    return rule;
}

inline WindowCriteria any_alpha(double distance_m) {
    WindowCriteria rule = alpha(distance_m);
    rule.alpha = AlphaChoice::any;
    return rule;
}

}  // namespace runcert::test

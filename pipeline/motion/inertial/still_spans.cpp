#include "inertial/still_spans.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr double second_s = 1.0;
constexpr double moving_m_s = 1.0;
constexpr double standing_m_s = 0.2;
constexpr double of_moving = 0.5;
constexpr double of_quietest = 4.0;
constexpr std::size_t quietest = 10;  ///< one in so many
constexpr double left_out_s = 3.0;
constexpr double least_still_s = 10.0;
constexpr std::size_t fewest_moving = 10;
constexpr int fewest_samples = 5;

/// Scatter of rate and force over a second.
struct Second {
    double from_s = 0.0;
    double to_s = 0.0;
    double rate_rad_s = 0.0;  ///< root of the summed variances
    double force_m_s2 = 0.0;  ///< the same
    double speed_m_s = 0.0;
};

double scatter(const Eigen::Vector3d& sum, double squares, int count) {
    return std::sqrt(std::max(0.0, squares / count - (sum / count).squaredNorm()));
}

/// Sums over the samples of a second.
class SecondSums {
  public:
    void add(const ImuSample& sample) {
        const Eigen::Vector3d rate = sample.angle_rad / sample.interval_s;
        const Eigen::Vector3d force = sample.velocity_m_s / sample.interval_s;
        if (count_ == 0) from_s_ = sample.time_s - sample.interval_s;
        to_s_ = sample.time_s;
        covered_s_ += sample.interval_s;
        rate_ += rate;
        force_ += force;
        rate_squares_ += rate.squaredNorm();
        force_squares_ += force.squaredNorm();
        ++count_;
    }
    bool full() const { return count_ > 0 && to_s_ - from_s_ >= second_s - 1e-6; }
    /// Whether samples cover it.
    bool whole() const {
        return count_ >= fewest_samples && covered_s_ > 0.9 * (to_s_ - from_s_) &&
               to_s_ - from_s_ < 1.5 * second_s;
    }
    Second second() const {
        return {.from_s = from_s_,
                .to_s = to_s_,
                .rate_rad_s = scatter(rate_, rate_squares_, count_),
                .force_m_s2 = scatter(force_, force_squares_, count_)};
    }

  private:
    double from_s_ = 0.0, to_s_ = 0.0, covered_s_ = 0.0;
    double rate_squares_ = 0.0, force_squares_ = 0.0;
    Eigen::Vector3d rate_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
    int count_ = 0;
};

std::vector<Second> seconds_of(std::span<const ImuSample> samples,
                               const std::function<double(double)>& speed_m_s) {
    std::vector<Second> seconds;
    SecondSums sums;
    for (const ImuSample& sample : samples) {
        if (!(sample.interval_s > 0.0)) continue;
        sums.add(sample);
        if (!sums.full()) continue;
        if (sums.whole()) {
            Second& one = seconds.emplace_back(sums.second());
            one.speed_m_s = speed_m_s(0.5 * (one.from_s + one.to_s));
        }
        sums = {};
    }
    return seconds;
}

/// The scatter below which an IMU feels no motion, from that of all seconds and of those in motion.
double still_scatter(std::vector<double> all, std::vector<double> moving) {
    std::ranges::sort(all);
    all.resize(std::max<std::size_t>(1, all.size() / quietest));
    return std::min(of_moving * median(std::move(moving)), of_quietest * median(std::move(all)));
}

}  // namespace

std::vector<StillSpan> still_spans(std::span<const ImuSample> samples,
                                   const std::function<double(double)>& speed_m_s) {
    const std::vector<Second> seconds = seconds_of(samples, speed_m_s);
    std::vector<double> rates, forces, moving_rates, moving_forces;
    for (const Second& one : seconds) {
        rates.push_back(one.rate_rad_s);
        forces.push_back(one.force_m_s2);
        if (!(one.speed_m_s > moving_m_s)) continue;
        moving_rates.push_back(one.rate_rad_s);
        moving_forces.push_back(one.force_m_s2);
    }
    if (moving_rates.size() < fewest_moving) return {};
    const double rate = still_scatter(std::move(rates), std::move(moving_rates));
    const double force = still_scatter(std::move(forces), std::move(moving_forces));
    std::vector<StillSpan> spans;
    StillSpan open;
    const auto close = [&] {
        const StillSpan inside{open.from_s + left_out_s, open.to_s - left_out_s};
        if (inside.to_s - inside.from_s >= least_still_s) spans.push_back(inside);
        open = {};
    };
    for (const Second& one : seconds) {
        const bool still =
            one.rate_rad_s < rate && one.force_m_s2 < force && one.speed_m_s < standing_m_s;
        const bool continues = open.to_s > open.from_s && one.from_s - open.to_s < 0.1 * second_s;
        if (!still || !continues) close();
        if (still) open = {continues ? open.from_s : one.from_s, one.to_s};
    }
    close();
    return spans;
}

Shaking shaking_of(std::span<const ImuSample> samples,
                   const std::function<double(double)>& speed_m_s) {
    const std::vector<Second> seconds = seconds_of(samples, speed_m_s);
    double greatest_m_s = 0.0;
    for (const Second& one : seconds)
        greatest_m_s = std::max(greatest_m_s, one.speed_m_s);
    std::vector<double> standing, slow, fast;
    for (const Second& one : seconds) {
        if (one.speed_m_s < standing_m_s) standing.push_back(one.force_m_s2);
        if (!(one.speed_m_s > moving_m_s)) continue;
        (one.speed_m_s < 0.5 * greatest_m_s ? slow : fast).push_back(one.force_m_s2);
    }
    const auto usual = [](std::vector<double>& values) {
        return values.empty() ? 0.0 : median(std::move(values));
    };
    return {usual(standing), usual(slow), usual(fast)};
}

}  // namespace runcert

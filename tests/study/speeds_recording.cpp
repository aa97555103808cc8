#include "speeds_recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace runcert {
namespace {

using Planar = std::vector<Eigen::Vector2d>;

constexpr double fine_s = TruePath::step_s;
constexpr double position_slow_m = 0.5, position_tau_s = 30.0, position_white_m = 0.05;
constexpr double position_stated_m = 1.0;
constexpr double overshoot_period_s = 2.0, overshoot_damping = 0.4;

double drawn_between(double least, double most, RandomGenerator& random) {
    return least + (most - least) * random.uniform();
}

Eigen::Vector2d east_and_north(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

/// Of values at each fine step.
Eigen::Vector2d value_at(const Planar& fine, double time_s) {
    const double at = std::clamp(time_s / fine_s, 0.0, static_cast<double>(fine.size() - 1));
    const auto before = static_cast<std::size_t>(at);
    const std::size_t after = std::min(before + 1, fine.size() - 1);
    const double part = at - static_cast<double>(before);
    return (1.0 - part) * fine[before] + part * fine[after];
}

/// A steady first-order Gauss-Markov error at these instants.
Planar wandering(double sigma, double tau_s, const std::vector<double>& times_s,
                 RandomGenerator& random) {
    Planar errors;
    for (std::size_t k = 0; k < times_s.size(); ++k) {
        const double kept = k > 0 ? std::exp((times_s[k - 1] - times_s[k]) / tau_s) : 0.0;
        Eigen::Vector2d error = sigma * std::sqrt(1.0 - kept * kept) * east_and_north(random);
        if (k > 0) error += kept * errors.back();
        errors.push_back(error);
    }
    return errors;
}

/// Straight legs of 20 s up to one speed, which is kept for 12 s, and turns of 4 s between them.
TruePath legs_of_one_speed(RandomGenerator& random) {
    constexpr double turning_s = 4.0, changing_s = 4.0, kept_s = 12.0;
    constexpr double leg_s = 2.0 * changing_s + kept_s, all_s = leg_s + turning_s;
    constexpr int legs = 24;
    constexpr double slow_m_s = 4.0;
    const double fast_m_s = drawn_between(10.0, 16.0, random);
    const double heading_rad = drawn_between(0.0, 2.0 * std::numbers::pi, random);
    TruePath path;
    Eigen::Vector2d position(500.0, -300.0);
    for (int k = 0; k <= std::lround(legs * all_s / fine_s); ++k) {
        const double time_s = k * fine_s;
        const double in_leg_s = std::fmod(time_s, all_s);
        const double change =
            std::clamp(std::min(in_leg_s, leg_s - in_leg_s) / changing_s, 0.0, 1.0);
        const double speed_m_s =
            slow_m_s + (fast_m_s - slow_m_s) * 0.5 * (1.0 - std::cos(std::numbers::pi * change));
        // Turns go to and fro.
        const int leg = static_cast<int>(time_s / all_s);
        const double turned = std::clamp((in_leg_s - leg_s) / turning_s, 0.0, 1.0);
        const double towards_rad =
            heading_rad + std::numbers::pi * (leg % 2 == 0 ? turned : 1.0 - turned);
        const Eigen::Vector2d velocity =
            speed_m_s * Eigen::Vector2d(std::sin(towards_rad), std::cos(towards_rad));
        if (k > 0) position += 0.5 * fine_s * (velocity + path.velocities_m_s.back());
        path.positions_m.push_back(position);
        path.velocities_m_s.push_back(velocity);
    }
    return path;
}

/// What the device's filter makes of the motion, at each fine step.
Planar as_filtered(const SpeedsCell& cell, const Planar& truth) {
    Planar filtered{truth.front()};
    Eigen::Vector2d rate = Eigen::Vector2d::Zero();
    const double natural = 2.0 * std::numbers::pi / overshoot_period_s;
    for (std::size_t k = 1; k < truth.size(); ++k) {
        const Eigen::Vector2d missing = truth[k] - filtered.back();
        if (cell.overshoots)
            rate += fine_s * natural * (natural * missing - 2.0 * overshoot_damping * rate);
        else if (cell.low_pass_s > 0.0)
            rate = missing / cell.low_pass_s;
        else
            rate = missing / fine_s;
        filtered.push_back(filtered.back() + fine_s * rate);
    }
    return filtered;
}

class SpeedsRecorder {
  public:
    SpeedsRecorder(const SpeedsCell& cell, std::uint64_t seed)
        : cell_(cell),
          random_(seed),
          path_(cell.equal_legs ? legs_of_one_speed(random_)
                                : random_session(cell.length_s, false, random_)) {
        take_instants();
        measure_velocities();
        measure_positions();
        stated_m_s_.assign(times_s_.size(), cell_.stated_m_s);
        if (cell_.spike.part > 0.0) add_spike();
    }

    SpeedsRecording record() {
        EnuTable table;
        table.facts = {.receiver = "primary",
                       .first_epoch = GpsTime{},
                       .vertical_measured = false,
                       .nominal_interval_s = interval_s(),
                       .position_resolution_m = 0.01,
                       .time_source = "satellites"};
        const std::vector<bool> lost = lost_samples();
        for (std::size_t k = 0; k < times_s_.size(); ++k) {
            if (lost[k]) continue;
            EnuEpoch& row = table.rows.emplace_back();
            row.epoch = std::ssize(table.rows);
            row.time = {std::llround(times_s_[k] * 1e9)};
            row.satellites = 9;
            row.fix = FixType::single;
            row.east_m = positions_[k].x();
            row.north_m = positions_[k].y();
            row.sigma_east_m = row.sigma_north_m = position_stated_m;
            row.recorded_velocity_east_m_s = velocities_[k].x();
            row.recorded_velocity_north_m_s = velocities_[k].y();
            row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s =
                stated_m_s_[k];
        }
        return {.path = std::move(path_), .measured = std::move(table)};
    }

  private:
    double interval_s() const { return 1.0 / cell_.rate_hz; }
    double true_speed(std::size_t k) const {
        return value_at(path_.velocities_m_s, times_s_[k]).norm();
    }

    void take_instants() {
        const double jitter_s = cell_.jitters ? drawn_between(0.002, 0.02, random_) : 0.0;
        const auto count = std::lround(path_.length_s() * cell_.rate_hz);
        for (long k = 0; k <= count; ++k)
            times_s_.push_back(
                static_cast<double>(k) * interval_s() +
                (cell_.jitters && k > 0 ? drawn_between(-jitter_s, jitter_s, random_) : 0.0));
    }

    void measure_velocities() {
        const Planar motion = as_filtered(cell_, path_.velocities_m_s);
        const Planar slow = wandering(cell_.slow_m_s, cell_.slow_tau_s, times_s_, random_);
        // So short a time is none.
        const double white_s = std::max(1e-9, cell_.white_filter_s);
        const Planar white = wandering(cell_.white_m_s, white_s, times_s_, random_);
        for (std::size_t k = 0; k < times_s_.size(); ++k)
            velocities_.emplace_back(cell_.scale * value_at(motion, times_s_[k]) + slow[k] +
                                     white[k]);
        if (cell_.bursts) add_bursts();
    }

    void add_bursts() {
        constexpr double apart_s = 30.0;
        for (double at_s = drawn_between(0.0, apart_s, random_); at_s < path_.length_s();
             at_s -= apart_s * std::log1p(-random_.uniform())) {
            const double size_m_s =
                std::copysign(drawn_between(0.3, 3.0, random_), random_.uniform() - 0.5);
            const double until_s = at_s + drawn_between(1.0, 3.0, random_);
            for (std::size_t k = 0; k < times_s_.size(); ++k) {
                if (times_s_[k] < at_s || times_s_[k] >= until_s || true_speed(k) == 0.0) continue;
                velocities_[k] +=
                    size_m_s * value_at(path_.velocities_m_s, times_s_[k]).normalized();
            }
        }
    }

    void measure_positions() {
        const Planar slow = wandering(position_slow_m, position_tau_s, times_s_, random_);
        const bool differenced = cell_.positions == SpeedsPositions::differenced;
        for (std::size_t k = 0; k < times_s_.size(); ++k)
            positions_.emplace_back(value_at(path_.positions_m, times_s_[k]) + slow[k] +
                                    (differenced ? 0.01 : position_white_m) *
                                        east_and_north(random_));
        if (cell_.wave_m > 0.0) add_wave();
        if (differenced) take_differences();
        if (cell_.positions == SpeedsPositions::smoothed) follow(cell_.positions_tau_s, 0.0);
        // Code positions with this time constant are not heard at all.
        if (cell_.positions == SpeedsPositions::integrated) follow(1e12, 0.005);
        for (Eigen::Vector2d& position : positions_)
            position += cell_.added_m * east_and_north(random_);
    }

    /// As multipath and filters make positions err.
    void add_wave() {
        constexpr double period_s = 20.0;
        const double east = random_.uniform(), north = random_.uniform();
        const auto at = [&](double phase, double time_s) {
            return cell_.wave_m * std::sin(2.0 * std::numbers::pi * (time_s / period_s + phase));
        };
        for (std::size_t k = 0; k < times_s_.size(); ++k)
            positions_[k] += Eigen::Vector2d(at(east, times_s_[k]), at(north, times_s_[k]));
    }

    void take_differences() {
        for (std::size_t k = 1; k + 1 < times_s_.size(); ++k)
            velocities_[k] =
                (positions_[k + 1] - positions_[k - 1]) / (times_s_[k + 1] - times_s_[k - 1]) +
                cell_.added_m_s * east_and_north(random_);
    }

    /// The positions become the integral of the velocities, drawn to what they were.
    void follow(double tau_s, double white_m) {
        Eigen::Vector2d now = positions_.front();
        for (std::size_t k = 1; k < times_s_.size(); ++k) {
            const double step_s = times_s_[k] - times_s_[k - 1];
            now += 0.5 * step_s * (velocities_[k - 1] + velocities_[k]);
            now += -std::expm1(-step_s / tau_s) * (positions_[k] - now);
            positions_[k] = now;
        }
        if (white_m > 0.0)
            for (Eigen::Vector2d& position : positions_)
                position += white_m * east_and_north(random_);
    }

    void add_spike() {
        std::vector<std::size_t> fastest(times_s_.size());
        for (std::size_t k = 0; k < fastest.size(); ++k)
            fastest[k] = k;
        std::ranges::sort(fastest, std::greater{}, [this](std::size_t k) { return true_speed(k); });
        const auto among = static_cast<double>(fastest.size() / 10);
        const std::size_t first = fastest[static_cast<std::size_t>(among * random_.uniform())];
        for (std::size_t k = first;
             k < std::min(times_s_.size(), first + static_cast<std::size_t>(cell_.spike.samples));
             ++k) {
            velocities_[k] *= 1.0 + cell_.spike.part;
            if (cell_.spike.stated_m_s > 0.0) stated_m_s_[k] = cell_.spike.stated_m_s;
        }
    }

    /// Mostly one at a time, else up to 3 s.
    std::vector<bool> lost_samples() {
        std::vector<bool> lost(times_s_.size(), false);
        if (!cell_.jitters) return lost;
        const double share = drawn_between(0.01, 0.05, random_);
        const double mean_samples = 0.9 + 0.1 * std::max(1.0, 1.5 * cell_.rate_hz);
        for (std::size_t k = 1; k < lost.size(); ++k) {
            if (random_.uniform() > share / mean_samples) continue;
            const double most = random_.uniform() < 0.9 ? 1.0 : 3.0 * cell_.rate_hz;
            const auto until = k + static_cast<std::size_t>(std::ceil(most * random_.uniform()));
            for (; k < std::min(until, lost.size()); ++k)
                lost[k] = true;
        }
        return lost;
    }

    const SpeedsCell& cell_;
    RandomGenerator random_;
    TruePath path_;
    std::vector<double> times_s_;
    Planar velocities_;
    Planar positions_;
    std::vector<double> stated_m_s_;
};

}  // namespace

double SpeedsCell::delay_s() const {
    return overshoots ? overshoot_damping * overshoot_period_s / std::numbers::pi : low_pass_s;
}

SpeedsRecording record_speeds(const SpeedsCell& cell, std::uint64_t seed) {
    return SpeedsRecorder(cell, seed).record();
}

}  // namespace runcert

#include "study_witnesses.h"

#include <cmath>
#include <numbers>

namespace runcert {

SlowError::SlowError(double sigma, double tau_s, double rate_hz, RandomGenerator& random)
    : decay_(std::exp(-1.0 / rate_hz / tau_s)),
      sigma_(sigma),
      random_(random),
      now_(sigma * normals()) {}

Eigen::Vector2d SlowError::next() {
    const Eigen::Vector2d now = now_;
    now_ = decay_ * now_ + sigma_ * std::sqrt(1.0 - decay_ * decay_) * normals();
    return now;
}

Eigen::Vector2d SlowError::normals() {
    const double first = random_.normal();
    return {first, random_.normal()};
}

namespace {

double rate_hz_of(const SimulatedRecording& run) {
    return 1.0 / run.screened.facts.nominal_interval_s;
}

}  // namespace

std::vector<TimedValue> wheel_of(const SimulatedRecording& run, double scale, double noise_m_s,
                                 RandomGenerator& random) {
    std::vector<TimedValue> speeds;
    for (std::size_t k = 0; k < run.velocity.size(); ++k)
        speeds.push_back(
            {.time_s = run.screened.rows[k].time.seconds(),
             .value = std::max(0.0, scale * run.velocity[k].norm() + noise_m_s * random.normal())});
    return speeds;
}

std::vector<TimedValue> gates_of(const SimulatedRecording& run, double apart_m,
                                 double least_speed_m_s, RandomGenerator& random) {
    std::vector<TimedValue> passages;
    double first_m = -1.0;
    const auto way_m = [&](std::size_t k) { return (run.truth[k] - run.truth[0]).norm(); };
    for (std::size_t k = 1; k < run.truth.size(); ++k) {
        if (run.velocity[k].norm() < least_speed_m_s) continue;
        const double before_m = way_m(k - 1), here_m = way_m(k);
        if (first_m < 0.0) first_m = before_m;
        const double gate_at_m = first_m + apart_m * static_cast<double>(passages.size());
        if (gate_at_m >= here_m) continue;
        const double part = (gate_at_m - before_m) / (here_m - before_m);
        passages.push_back(
            {.time_s = (static_cast<double>(k) - 1.0 + part) / rate_hz_of(run) +
                       study_gate_s * random.normal(),
             .value = gate_at_m - first_m + study_gate_m / std::numbers::sqrt2 * random.normal()});
    }
    return passages;
}

void record_velocities(const SimulatedRecording& run, double slow_m_s, double noise_m_s,
                       RandomGenerator& random, EnuTable& table) {
    constexpr double tau_s = 20.0;
    SlowError slow(slow_m_s, tau_s, rate_hz_of(run), random);
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const Eigen::Vector2d velocity = run.velocity[k] + slow.next();
        table.rows[k].recorded_velocity_east_m_s = velocity.x() + noise_m_s * random.normal();
        table.rows[k].recorded_velocity_north_m_s = velocity.y() + noise_m_s * random.normal();
    }
}

EnuTable second_receiver_of(const SimulatedRecording& run, const EnuTable& first, double slow_m,
                            RandomGenerator& random) {
    constexpr double tau_s = 5.0, behind_m = 0.9;
    EnuTable table = first;
    table.facts.receiver = "second";
    SlowError slow(slow_m, tau_s, rate_hz_of(run), random);
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const Eigen::Vector2d antenna = run.truth[k] - behind_m * study_direction() + slow.next();
        table.rows[k].east_m = antenna.x() + study_white_m * random.normal();
        table.rows[k].north_m = antenna.y() + study_white_m * random.normal();
    }
    return table;
}

Eigen::Vector2d study_direction() {
    return Eigen::Vector2d::Constant(1.0).normalized();
}

void hand_in(const std::string& key, const std::vector<TimedValue>& values, HandedIn& given) {
    for (const TimedValue& one : values)
        given.series[key].samples.push_back({.time_s = one.time_s, .value = one.value});
}

}  // namespace runcert

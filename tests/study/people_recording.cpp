#include "people_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace runcert {
namespace {

/// A device works at this rate and records every so many of its positions.
constexpr double device_rate_hz = 10.0;
constexpr double device_step_s = 1.0 / device_rate_hz;

using Planar = std::vector<Eigen::Vector2d>;

double evenly(double least, double most, RandomGenerator& random) {
    return least + (most - least) * random.uniform();
}

double by_ratio(double least, double most, RandomGenerator& random) {
    return least * std::pow(most / least, random.uniform());
}

Eigen::Vector2d normal_pair(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

Planar gauss_markov(std::size_t count, double sigma, double tau_s, RandomGenerator& random) {
    const double decay = std::exp(-device_step_s / tau_s);
    Planar errors{sigma * normal_pair(random)};
    while (errors.size() < count)
        errors.emplace_back(decay * errors.back() +
                            sigma * std::sqrt(1.0 - decay * decay) * normal_pair(random));
    return errors;
}

PeopleDevice random_device(const PeopleKind& kind, RandomGenerator& random) {
    PeopleDevice device{.white_m = by_ratio(0.05, 0.3, random),
                        .slow_m = by_ratio(0.5, 2.0, random),
                        .slow_tau_s = by_ratio(5.0, 60.0, random)};
    const double wrong = random.uniform();
    const double factor = wrong < 0.125 ? 0.5 : wrong < 0.25 ? 2.0 : evenly(0.8, 1.25, random);
    const double radial_m = std::numbers::sqrt2 * std::hypot(device.white_m, device.slow_m);
    device.stated_m = std::clamp(factor * radial_m, 1.0, 3.0) / std::numbers::sqrt2;
    device.velocity_white_m_s = by_ratio(0.03, 0.1, random);
    device.velocity_slow_m_s = by_ratio(0.02, 0.1, random);
    device.velocity_tau_s = by_ratio(5.0, 30.0, random);
    device.velocity_stated_m_s =
        std::hypot(device.velocity_white_m_s, device.velocity_slow_m_s) * evenly(0.8, 2.0, random);
    device.velocity_late_s = evenly(0.0, 0.5, random);
    const double filter_s = by_ratio(0.3, 1.0, random);
    if (kind.filtered) device.filter_s = filter_s;
    return device;
}

/// An alpha-beta filter, critically damped: it lags where the craft speeds up and overshoots in
/// turns.
void smooth_as_devices_do(double filter_s, Planar& positions) {
    const double memory = std::exp(-device_step_s / filter_s);
    const double alpha = 1.0 - memory * memory;
    const double beta = (1.0 - memory) * (1.0 - memory);
    Eigen::Vector2d position = positions.front();
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    for (Eigen::Vector2d& measured : positions) {
        const Eigen::Vector2d expected = position + device_step_s * velocity;
        const Eigen::Vector2d innovation = measured - expected;
        position = expected + alpha * innovation;
        velocity += beta / device_step_s * innovation;
        measured = position;
    }
}

/// What a fault adds to a position so long after its beginning, in units of its size.
double shape_of(PeopleFault fault, double after_s, double lasts_s) {
    if (after_s < 0.0) return 0.0;
    const bool over = after_s > lasts_s;
    switch (fault) {
        case PeopleFault::none:
            return 0.0;
        case PeopleFault::step:
            return 1.0;
        case PeopleFault::spike:
            return over ? 0.0 : 1.0;
        case PeopleFault::ramp:
            return std::min(after_s, lasts_s);
        case PeopleFault::multipath:
            return over ? 0.0 : 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * after_s / lasts_s);
    }
    return 0.0;
}

struct FaultSize {
    double size = 0.0;  ///< m; m/s of a ramp
    double lasts_s = 0.0;
};

FaultSize random_size(PeopleFault fault, double interval_s, RandomGenerator& random) {
    switch (fault) {
        case PeopleFault::none:
            return {};
        case PeopleFault::step:
            return {by_ratio(2.0, 30.0, random), 0.0};
        case PeopleFault::spike:
            return {by_ratio(3.0, 100.0, random),
                    (std::floor(3.0 * random.uniform()) + 0.5) * interval_s};
        case PeopleFault::ramp:
            return {by_ratio(0.05, 2.0, random), by_ratio(3.0, 30.0, random)};
        case PeopleFault::multipath:
            return {by_ratio(1.0, 30.0, random), by_ratio(1.0, 30.0, random)};
    }
    return {};
}

/// Puts the fault on the positions and says what it was.
std::string add_fault(PeopleFault fault, const PeopleKind& kind, const TruePath& path,
                      RandomGenerator& random, Planar& positions) {
    const auto [size, lasts_s] = random_size(fault, 1.0 / kind.rate_hz, random);
    const double from_s = evenly(5.0, path.length_s() - 5.0, random);
    const double angle = evenly(0.0, 2.0 * std::numbers::pi, random);
    Eigen::Vector2d direction(std::sin(angle), std::cos(angle));
    const Eigen::Vector2d velocity = path.velocity(from_s);
    const bool along = random.uniform() < 0.5 && velocity.norm() > 1.0;
    if (along) direction = velocity.normalized();
    for (std::size_t k = 0; k < positions.size(); ++k)
        positions[k] += size *
                        shape_of(fault, static_cast<double>(k) * device_step_s - from_s, lasts_s) *
                        direction;
    return fmt::format("{} of {:.2f} for {:.1f} s from {:.1f} s{}", to_text(fault), size, lasts_s,
                       from_s, along ? " along the motion" : "");
}

/// A device's first minutes: no fix for a third of it, then stated standard deviations that fall.
struct ColdStart {
    double lasts_s = 0.0;
    double stated_m = 1.0;  ///< at its end

    bool is_blind(double time_s) const { return time_s < lasts_s / 3.0; }
    /// By what its errors and stated standard deviations are larger.
    double factor(double time_s) const {
        if (time_s >= lasts_s) return 1.0;
        const double left = (lasts_s - time_s) / (lasts_s * 2.0 / 3.0);
        return std::pow(1000.0 / stated_m, std::min(1.0, left));
    }
};

/// The jump by multipath at a crash, and what the device says of it.
struct CrashErrors {
    double at_s = 0.0;
    Eigen::Vector2d jump_m = Eigen::Vector2d::Zero();
    double decay_s = 1.0;
    double stated_factor = 1.0;

    Eigen::Vector2d error(double time_s) const {
        if (time_s < at_s) return Eigen::Vector2d::Zero();
        return std::exp(-(time_s - at_s) / decay_s) * jump_m;
    }
    double factor(double time_s) const {
        return time_s < at_s || time_s > at_s + 3.0 * decay_s ? 1.0 : stated_factor;
    }
};

/// A crash is where the craft loses its speed within a second.
CrashErrors random_crash(const TruePath& path, RandomGenerator& random) {
    CrashErrors crash{.decay_s = evenly(3.0, 10.0, random),
                      .stated_factor = evenly(1.5, 5.0, random)};
    double most_lost = 0.0;
    for (double at_s = std::max(0.0, path.length_s() - 80.0); at_s + 1.0 < path.length_s();
         at_s += device_step_s) {
        const double lost = path.velocity(at_s).norm() - path.velocity(at_s + 1.0).norm();
        if (lost > most_lost) {
            most_lost = lost;
            crash.at_s = at_s;
        }
    }
    const double angle = evenly(0.0, 2.0 * std::numbers::pi, random);
    const Eigen::Vector2d along = path.velocity(crash.at_s).normalized();
    const Eigen::Vector2d anywhere(std::sin(angle), std::cos(angle));
    crash.jump_m = evenly(3.0, 20.0, random) *
                   (random.uniform() < 0.5 || !along.allFinite() ? anywhere : along);
    return crash;
}

void state_velocity(PeopleVelocities velocities, const Eigen::Vector2d& velocity, double sigma_m_s,
                    EnuEpoch& row) {
    if (velocities == PeopleVelocities::none) return;
    if (velocities == PeopleVelocities::speed_alone) {
        row.recorded_speed_m_s = velocity.norm();
        row.sigma_recorded_speed_m_s = sigma_m_s;
        return;
    }
    row.recorded_velocity_east_m_s = velocity.x();
    row.recorded_velocity_north_m_s = velocity.y();
    if (velocities == PeopleVelocities::unstated) return;
    row.sigma_recorded_velocity_east_m_s = sigma_m_s;
    row.sigma_recorded_velocity_north_m_s = sigma_m_s;
}

/// All that a device would write if it wrote every sample.
class Recorder {
  public:
    Recorder(const PeopleKind& kind, PeopleFault fault, std::uint64_t seed)
        : kind_(kind), random_(seed) {
        recording_.device = random_device(kind, random_);
        const double length_s = std::round(by_ratio(kind.shortest_s, kind.longest_s, random_));
        recording_.path = random_session(length_s, kind.crash, random_);
        samples_ = static_cast<std::size_t>(std::lround(length_s * device_rate_hz)) + 1;
        if (kind.cold_start)
            cold_ = {.lasts_s = evenly(20.0, 120.0, random_),
                     .stated_m = recording_.device.stated_m};
        if (kind.crash) crash_ = random_crash(recording_.path, random_);
        measure_positions(fault);
        measure_velocities();
    }

    PeopleRecording record() {
        EnuTable& table = recording_.measured;
        table.facts = {.receiver = "primary",
                       .first_epoch = GpsTime{},
                       .vertical_measured = false,
                       .nominal_interval_s = 1.0 / kind_.rate_hz,
                       .position_resolution_m = 0.01,
                       .time_source = "satellites"};
        const auto every = static_cast<std::size_t>(std::lround(device_rate_hz / kind_.rate_hz));
        // Shares of samples and of time are the same: so long between two losses on average.
        const double share = evenly(0.01, 0.05, random_);
        std::size_t lost_until = 0;
        bool kept = true;  // the sample before: losses do not join
        for (std::size_t k = 0; k < samples_; k += every) {
            if (kind_.drops && kept && k > 0) lost_until = k + lost(share, every);
            kept = k >= lost_until;
            if (kept) write_row(k);
        }
        return std::move(recording_);
    }

  private:
    static double time_s(std::size_t k) { return static_cast<double>(k) * device_step_s; }

    void measure_positions(PeopleFault fault) {
        const PeopleDevice& device = recording_.device;
        const Planar slow = gauss_markov(samples_, device.slow_m, device.slow_tau_s, random_);
        for (std::size_t k = 0; k < samples_; ++k)
            positions_.emplace_back(recording_.path.position(time_s(k)) +
                                    cold_.factor(time_s(k)) *
                                        (slow[k] + device.white_m * normal_pair(random_)) +
                                    crash_.error(time_s(k)));
        if (device.filter_s > 0.0) smooth_as_devices_do(device.filter_s, positions_);
        if (fault == PeopleFault::none) return;
        const auto faults = 1 + static_cast<int>(3.0 * random_.uniform());
        for (int i = 0; i < faults; ++i)
            recording_.fault +=
                (i > 0 ? "; " : "") + add_fault(fault, kind_, recording_.path, random_, positions_);
    }

    void measure_velocities() {
        const PeopleDevice& device = recording_.device;
        const Planar slow =
            gauss_markov(samples_, device.velocity_slow_m_s, device.velocity_tau_s, random_);
        for (std::size_t k = 0; k < samples_; ++k)
            velocities_.emplace_back(
                recording_.path.velocity(time_s(k) - device.velocity_late_s) +
                cold_.factor(time_s(k)) *
                    (slow[k] + device.velocity_white_m_s * normal_pair(random_)));
    }

    /// How many samples are lost from here on: mostly one, else up to 3 s.
    std::size_t lost(double share, std::size_t every) {
        const double interval_s = static_cast<double>(every) * device_step_s;
        const double mean_s = 0.7 * interval_s + 0.3 * 1.5;
        if (random_.uniform() > share * interval_s / mean_s) return 0;
        if (random_.uniform() < 0.7) return every;
        return std::max(every, static_cast<std::size_t>(3.0 * random_.uniform() * device_rate_hz));
    }

    void write_row(std::size_t k) {
        std::vector<EnuEpoch>& rows = recording_.measured.rows;
        EnuEpoch& row = rows.emplace_back();
        row.epoch = std::ssize(rows);
        row.time = {std::llround(time_s(k) * 1e9)};
        row.satellites = 9;
        if (cold_.is_blind(time_s(k))) {
            row.fix = FixType::none;
            return;
        }
        row.fix = FixType::single;
        row.east_m = positions_[k].x();
        row.north_m = positions_[k].y();
        row.sigma_east_m = row.sigma_north_m =
            recording_.device.stated_m * cold_.factor(time_s(k)) * crash_.factor(time_s(k));
        state_velocity(kind_.velocities, velocities_[k],
                       cold_.factor(time_s(k)) * recording_.device.velocity_stated_m_s, row);
    }

    const PeopleKind& kind_;
    RandomGenerator random_;
    PeopleRecording recording_;
    std::size_t samples_ = 0;
    ColdStart cold_;
    CrashErrors crash_;
    Planar positions_;
    Planar velocities_;
};

}  // namespace

std::string_view velocities_words(PeopleVelocities velocities) {
    switch (velocities) {
        case PeopleVelocities::stated:
            return ", velocities";
        case PeopleVelocities::unstated:
            return ", velocities unstated";
        case PeopleVelocities::speed_alone:
            return ", speed alone";
        case PeopleVelocities::none:
            break;
    }
    return "";
}

std::vector<PeopleKind> people_kinds() {
    using enum PeopleVelocities;
    std::vector<PeopleKind> kinds;
    const auto add = [&](PeopleKind kind, std::initializer_list<PeopleVelocities> with) {
        for (const PeopleVelocities velocities : with) {
            PeopleKind one = kind;
            one.velocities = velocities;
            one.name += velocities_words(velocities);
            kinds.push_back(std::move(one));
        }
    };
    add({.name = "1 Hz"}, {none, stated, unstated, speed_alone});
    add({.name = "5 Hz", .rate_hz = 5.0, .longest_s = 600.0}, {none, stated, unstated});
    add({.name = "10 Hz", .rate_hz = 10.0, .longest_s = 400.0},
        {none, stated, unstated, speed_alone});
    add({.name = "cold start", .longest_s = 900.0, .cold_start = true}, {none, stated});
    add({.name = "dropped samples", .longest_s = 900.0, .drops = true}, {none, stated});
    add({.name = "dropped, 5 Hz", .rate_hz = 5.0, .longest_s = 500.0, .drops = true},
        {none, stated});
    add({.name = "crash", .longest_s = 900.0, .crash = true}, {none, stated});
    add({.name = "filtered", .longest_s = 900.0, .filtered = true}, {none, stated});
    add({.name = "filtered, 5 Hz", .rate_hz = 5.0, .longest_s = 500.0, .filtered = true},
        {none, stated});
    return kinds;
}

std::string to_text(PeopleFault fault) {
    switch (fault) {
        case PeopleFault::step:
            return "step";
        case PeopleFault::spike:
            return "spike";
        case PeopleFault::ramp:
            return "ramp";
        case PeopleFault::multipath:
            return "multipath";
        case PeopleFault::none:
            break;
    }
    return "none";
}

PeopleRecording record_people(const PeopleKind& kind, PeopleFault fault, std::uint64_t seed) {
    return Recorder(kind, fault, seed).record();
}

}  // namespace runcert

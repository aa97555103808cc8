#include "people.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/statistics.h"
#include "schemas/attempt/attempt.h"
#include "stages/check/decision.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

using Eigen::Vector2d;

constexpr double fine_s = 0.02;  // steps of the true motion
constexpr double window_s = 3.0;

double between(double least, double most, RandomGenerator& random) {
    return least + (most - least) * random.uniform();
}

double log_between(double least, double most, RandomGenerator& random) {
    return least * std::pow(most / least, random.uniform());
}

Vector2d normal_pair(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

/// First-order Gauss-Markov process of both axes.
class Wander {
  public:
    Wander(double sigma, double tau_s, double step_s, RandomGenerator& random)
        : kept_(std::exp(-step_s / tau_s)),
          noise_(sigma * std::sqrt(1.0 - kept_ * kept_)),
          value_(sigma * normal_pair(random)) {}
    const Vector2d& step(RandomGenerator& random) {
        value_ = kept_ * value_ + noise_ * normal_pair(random);
        return value_;
    }

  private:
    double kept_;
    double noise_;
    Vector2d value_;
};

/// The true motion in fine steps: velocities, and positions as their sums.
struct TrueMotion {
    std::vector<Vector2d> position;
    std::vector<Vector2d> velocity;

    std::size_t index(double time_s) const {
        const auto k = static_cast<std::int64_t>(std::llround(time_s / fine_s));
        return static_cast<std::size_t>(std::clamp<std::int64_t>(k, 0, std::ssize(position) - 1));
    }
    double speed_over(double from_s, double to_s) const {
        return (position[index(to_s)] - position[index(from_s)]).norm() / (to_s - from_s);
    }
    double fastest_m_s() const {
        double fastest = 0.0;
        const auto steps = static_cast<std::size_t>(window_s / fine_s);
        for (std::size_t k = 0; k + steps < position.size(); k += 5)
            fastest = std::max(fastest, (position[k + steps] - position[k]).norm() / window_s);
        return fastest;
    }
};

/// A session: legs at changing speeds with gusts, turns with slow exits, rests; it ends suddenly
/// where there is a crash.
TrueMotion session(const PeopleKind& kind, double length_s, RandomGenerator& random) {
    TrueMotion motion;
    const double crash_s = length_s - 12.0;
    double speed = 0.0, wanted = 0.0, smoothed = 0.0;
    double heading = between(0.0, 2.0 * std::numbers::pi, random), turn = 0.0, turning = 0.0;
    double next_s = 5.0, turn_end_s = 0.0;
    const double gust_period_s = between(4.0, 15.0, random), gust = between(0.0, 0.6, random);
    Vector2d at = Vector2d::Zero();
    for (double t = 0.0; t < length_s; t += fine_s) {
        if (t >= next_s) {
            const double what = random.uniform();
            if (what < 0.15)
                wanted = 0.0;
            else
                wanted = between(4.0, 18.0, random);
            if (what > 0.6) {
                turn_end_s = t + between(4.0, 8.0, random);
                turn = between(1.0, 3.0, random) * (random.uniform() < 0.5 ? -1.0 : 1.0) /
                       (turn_end_s - t);
                wanted *= 0.5;
            }
            next_s = t + between(8.0, 40.0, random);
        }
        const bool crashed = kind.crash && t > crash_s;
        if (crashed) wanted = 0.0;
        // Two first-order lags: speed, acceleration and jerk stay what a board can do.
        const double lag_s = crashed ? 0.4 : 2.0;
        smoothed += fine_s / lag_s * (wanted - smoothed);
        speed += fine_s / lag_s * (smoothed - speed);
        turning += fine_s / 0.7 * ((t < turn_end_s ? turn : 0.0) - turning);
        heading += fine_s * turning;
        const double v = speed + std::min(gust, 0.1 * speed) *
                                     std::sin(2.0 * std::numbers::pi * t / gust_period_s);
        motion.velocity.emplace_back(v * std::sin(heading), v * std::cos(heading));
        motion.position.push_back(at);
        at += fine_s * motion.velocity.back();
    }
    return motion;
}

const Attempt& people_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: people\ncraft: {name: board, class: board}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n",
        "people");
    return attempt;
}

/// What the device does to its positions: a second-order low-pass, which lags and overshoots.
class DeviceFilter {
  public:
    DeviceFilter(double time_s, double step_s) : step_s_(step_s) {
        const double bandwidth = std::min(1.0 / time_s, 0.5 / step_s);
        position_gain_ = 1.4 * bandwidth;
        velocity_gain_ = bandwidth * bandwidth;
    }
    Vector2d operator()(const Vector2d& measured) {
        if (!begun_) position_ = measured;
        begun_ = true;
        position_ += step_s_ * velocity_;
        const Vector2d missed = measured - position_;
        position_ += std::min(1.0, position_gain_ * step_s_) * missed;
        velocity_ += velocity_gain_ * step_s_ * missed;
        return position_;
    }

  private:
    double step_s_;
    double position_gain_ = 1.0;
    double velocity_gain_ = 0.0;
    bool begun_ = false;
    Vector2d position_ = Vector2d::Zero();
    Vector2d velocity_ = Vector2d::Zero();
};

/// The error of a fault at a time.
class Fault {
  public:
    Fault(PeopleFault kind, double length_s, double interval_s, RandomGenerator& random)
        : kind_(kind), begin_s_(between(20.0, length_s - 15.0, random)) {
        const double bearing = between(0.0, 2.0 * std::numbers::pi, random);
        const Vector2d direction(std::sin(bearing), std::cos(bearing));
        switch (kind) {
            case PeopleFault::none:
                break;
            case PeopleFault::step:
                size_ = log_between(0.5, 100.0, random) * direction;
                break;
            case PeopleFault::spike:
                size_ = log_between(1.0, 300.0, random) * direction;
                length_s_ = interval_s * std::ceil(between(0.0, 4.0, random));
                break;
            case PeopleFault::ramp:
                size_ = log_between(0.05, 2.0, random) * direction;
                length_s_ = log_between(3.0, 40.0, random);
                break;
            case PeopleFault::multipath:
                size_ = log_between(0.5, 30.0, random) * direction;
                length_s_ = log_between(1.0, 30.0, random);
                break;
        }
    }
    Vector2d at(double time_s) const {
        const double since_s = time_s - begin_s_;
        if (since_s < 0.0) return Vector2d::Zero();
        switch (kind_) {
            case PeopleFault::none:
                break;
            case PeopleFault::step:
                return size_;
            case PeopleFault::spike:
                return since_s < length_s_ ? size_ : Vector2d::Zero();
            case PeopleFault::ramp:
                return std::min(since_s, length_s_) * size_;
            case PeopleFault::multipath:
                if (since_s < length_s_)
                    return 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * since_s / length_s_)) *
                           size_;
                break;
        }
        return Vector2d::Zero();
    }

  private:
    PeopleFault kind_;
    double begin_s_;
    double length_s_ = 0.0;
    Vector2d size_ = Vector2d::Zero();
};

/// The recording of a session, as its device makes it.
EnuTable record(const PeopleKind& kind, const TrueMotion& motion, const Fault& fault,
                double length_s, RandomGenerator& random) {
    const double interval_s = 1.0 / kind.rate_hz;
    const double slow_m = between(0.5, 2.0, random);
    const double white_m = between(0.05, 0.3, random);
    const double stated_m = slow_m * (random.uniform() < 0.15 ? 0.5 : between(0.8, 2.0, random));
    const double cold_s = kind.cold_start ? between(20.0, 0.3 * length_s, random) : 0.0;
    const double delay_s = between(0.0, 0.5, random);
    const double velocity_white = between(0.03, 0.1, random);
    const double velocity_slow = between(0.02, 0.1, random);
    const double dropped = between(0.01, 0.05, random);
    Wander slow(slow_m, log_between(5.0, 60.0, random), interval_s, random);
    Wander cold(1.0, 5.0, interval_s, random);
    Wander jolt(1.0, 2.0, interval_s, random);
    Wander of_velocity(velocity_slow, log_between(5.0, 30.0, random), interval_s, random);
    DeviceFilter filter(between(0.4, 1.5, random), interval_s);
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.nominal_interval_s = interval_s;
    table.facts.vertical_measured = false;
    double burst_until_s = -1.0;
    const auto rows = static_cast<std::int64_t>(length_s * kind.rate_hz);
    for (std::int64_t k = 0; k < rows; ++k) {
        const double time_s = static_cast<double>(k) * interval_s;
        const Vector2d wander = slow.step(random), cold_error = cold.step(random),
                       jolted = jolt.step(random), drift = of_velocity.step(random);
        double sigma_m = stated_m * (0.9 + 0.2 * random.uniform());
        Vector2d position = motion.position[motion.index(time_s)] + wander +
                            white_m * normal_pair(random) + fault.at(time_s);
        if (kind.filtered) position = filter(position);
        const bool crashed = kind.crash && time_s > length_s - 12.0;
        if (crashed) {
            position += 6.0 * jolted;
            sigma_m *= 4.0;
        }
        bool fix = true;
        if (time_s < cold_s) {
            fix = time_s > 0.4 * cold_s;
            const double off_m = 1000.0 * std::exp(-6.0 * (time_s - 0.4 * cold_s) / (0.6 * cold_s));
            position += off_m * cold_error;
            sigma_m = std::hypot(sigma_m, 1.2 * off_m);
        }
        const Vector2d velocity = motion.velocity[motion.index(time_s - delay_s)] +
                                  velocity_white * normal_pair(random) + drift;
        if (kind.dropped) {
            if (random.uniform() < 0.002) burst_until_s = time_s + between(0.0, 3.0, random);
            if (time_s < burst_until_s || random.uniform() < dropped) continue;
        }
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = std::ssize(table.rows);
        row.time = ElapsedTime{std::llround(time_s * 1e9)};
        row.fix = fix ? FixType::single : FixType::none;
        if (!fix) continue;
        row.east_m = std::round(position.x() * 1e2) / 1e2;
        row.north_m = std::round(position.y() * 1e2) / 1e2;
        row.sigma_east_m = row.sigma_north_m = sigma_m;
        if (!kind.velocities) continue;
        if (kind.speed_only) {
            row.recorded_speed_m_s = velocity.norm();
            if (kind.states_velocity)
                row.sigma_recorded_speed_m_s = std::hypot(velocity_white, velocity_slow);
            continue;
        }
        row.recorded_velocity_east_m_s = velocity.x();
        row.recorded_velocity_north_m_s = velocity.y();
        if (kind.states_velocity)
            row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s =
                std::hypot(velocity_white, velocity_slow);
    }
    return table;
}

double processor_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string refusal(const ProfileWindows& windows, const ScreenedTable& screened) {
    if (!windows.best) {
        const ScreeningSummary summary = summarise(screened.rows);
        return summary.usable == 0 ? "nothing usable" : "no window";
    }
    const CertifiableWindow& best = *windows.best;
    if (best.robust && !best.robust->agrees) return "robust estimate";
    for (const WitnessedSpeed& one : best.witnesses)
        if (one.normalised_error > 1.0) return "witness";
    return {};
}

void judge(const CertifiableWindow& best, const TrueMotion& motion, const Profile& profile,
           PeopleRun& run) {
    const double start_s = best.span.start.seconds();
    const double end_s = start_s + best.span.duration.seconds();
    const double true_m_s = motion.speed_over(start_s, end_s);
    run.speed_m_s = best.speed_m_s;
    run.start_s = start_s;
    run.error_m_s = best.speed_m_s - true_m_s;
    run.expanded_m_s = expanded_uncertainty_by_rule_m_s(best, profile.coverage_factor);
    for (const BudgetRow& row : best.budget)
        run.budget[row.symbol] += row.contribution_m_s;
    const double required_m_s = motion.fastest_m_s() + 0.1 / 3.6;
    const SpeedPosterior posterior{.speed_m_s = best.speed_m_s,
                                   .standard_uncertainty_m_s = best.standard_uncertainty_m_s,
                                   .degrees_of_freedom = best.effective_degrees_of_freedom,
                                   .bias_limit_m_s = best.bias_limit_m_s};
    run.false_record = decide(posterior, Threshold{.speed_m_s = required_m_s},
                              profile.decision_probability) == Outcome::beaten;
}

std::string_view name_of(PeopleFault fault) {
    switch (fault) {
        case PeopleFault::none:
            return "none";
        case PeopleFault::step:
            return "step";
        case PeopleFault::spike:
            return "spike";
        case PeopleFault::ramp:
            return "ramp";
        case PeopleFault::multipath:
            break;
    }
    return "multipath";
}

double quantile(std::vector<double> values, double part) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// One line of the table.
struct PeopleCount {
    std::int64_t runs = 0, certified = 0, held = 0, false_records = 0;
    std::vector<double> expanded, errors, usable, seconds;
    std::map<std::string, std::int64_t> refused;

    void add(const PeopleRun& run) {
        ++runs;
        usable.push_back(run.usable);
        seconds.push_back(run.seconds_per_50000);
        if (!run.refused.empty()) {
            ++refused[run.refused];
            return;
        }
        ++certified;
        held += std::abs(run.error_m_s) <= run.expanded_m_s ? 1 : 0;
        false_records += run.false_record ? 1 : 0;
        expanded.push_back(run.expanded_m_s * 3.6);
        errors.push_back(std::abs(run.error_m_s) * 3.6);
    }
    std::string line(const std::string& name) const {
        std::vector<std::string> why;
        for (const auto& [reason, count] : refused)
            why.push_back(fmt::format("{} {}", count, reason));
        const double share =
            certified > 0 ? 100.0 * static_cast<double>(held) / static_cast<double>(certified)
                          : 0.0;
        return fmt::format(
            "{:<34} {:6} {:9} {:6.1f} {:8.2f} {:7.2f} {:8.2f} {:7.1f} {:6} {:7.1f}  {}\n", name,
            runs, certified, share, quantile(expanded, 0.5), quantile(expanded, 0.9),
            quantile(errors, 0.5), 100.0 * quantile(usable, 0.5), false_records,
            quantile(seconds, 0.95), fmt::join(why, ", "));
    }
};

}  // namespace

std::vector<PeopleKind> people_kinds() {
    std::vector<PeopleKind> kinds;
    for (const double rate_hz : {1.0, 5.0, 10.0}) {
        const PeopleKind plain{.name = fmt::format("{:g} Hz", rate_hz),
                               .rate_hz = rate_hz,
                               .length_s = rate_hz > 1.0 ? 300.0 : 900.0};
        const auto add = [&](const char* words, auto change) {
            for (const bool velocities : {false, true}) {
                PeopleKind kind = plain;
                kind.velocities = velocities;
                change(kind);
                kind.name += words;
                if (velocities) kind.name += ", velocities";
                kinds.push_back(kind);
            }
        };
        add("", [](PeopleKind&) {});
        add(", cold start", [](PeopleKind& kind) { kind.cold_start = true; });
        add(", dropped samples", [](PeopleKind& kind) { kind.dropped = true; });
        add(", crash at the end", [](PeopleKind& kind) { kind.crash = true; });
        add(", filtered", [](PeopleKind& kind) { kind.filtered = true; });
        PeopleKind stated = plain;
        stated.name += ", velocities, stated";
        stated.velocities = stated.states_velocity = true;
        kinds.push_back(stated);
        PeopleKind speed = plain;
        speed.name += ", speed alone";
        speed.velocities = speed.speed_only = true;
        kinds.push_back(speed);
    }
    return kinds;
}

PeopleRun people_run(const PeopleKind& kind, std::uint64_t seed, bool fault) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    RandomGenerator random(seed);
    PeopleRun run;
    run.kind = kind.name;
    run.seed = seed;
    // Longer recordings have room for more of what goes wrong; a fault needs but one.
    const double length_s = fault ? 180.0 : kind.length_s * between(0.5, 1.5, random);
    if (fault) run.fault = static_cast<PeopleFault>(1 + static_cast<int>(4.0 * random.uniform()));
    const TrueMotion motion = session(kind, length_s, random);
    const Fault wrong(run.fault, length_s, 1.0 / kind.rate_hz, random);
    const EnuTable measured = record(kind, motion, wrong, length_s, random);
    const double begun_s = processor_s();
    try {
        const ScreenedTable screened = screen(measured, screen_config(people_attempt()));
        run.usable = static_cast<double>(summarise(screened.rows).usable) /
                     static_cast<double>(screened.rows.size());
        if (run.usable == 0.0) {
            run.refused = "nothing usable";
            return run;
        }
        const TrajectoryTable trajectory =
            smooth_trajectory(screened, smooth_config(people_attempt()));
        const Windows windows =
            find_windows(screened, trajectory, {profile},
                         window_config(people_attempt(), people_attempt().receivers.front()));
        run.refused = refusal(windows.profiles.front(), screened);
        if (const auto& best = windows.profiles.front().best; best && run.refused.empty())
            judge(*best, motion, profile, run);
    } catch (const Failure& failure) {
        run.refused = std::string("failed: ") + failure.what();
    }
    run.seconds_per_50000 =
        (processor_s() - begun_s) * 50'000.0 / static_cast<double>(measured.rows.size());
    return run;
}

std::vector<PeopleRun> study_people(const PeopleOptions& options) {
    std::vector<PeopleKind> kinds = people_kinds();
    std::erase_if(kinds, [&](const PeopleKind& kind) {
        return kind.name.find(options.only) == std::string::npos;
    });
    return results_of(options.runs * std::ssize(kinds), options.threads, [&](std::int64_t i) {
        return people_run(kinds[static_cast<std::size_t>(i / options.runs)],
                          options.seed * 7'000'003 + static_cast<std::uint64_t>(i), options.faults);
    });
}

std::string people_table(const std::vector<PeopleRun>& runs) {
    std::vector<std::string> names;
    std::map<std::string, PeopleCount> counts;
    std::map<std::string, PeopleCount> faults;
    PeopleCount all;
    for (const PeopleRun& run : runs) {
        if (!counts.contains(run.kind)) names.push_back(run.kind);
        counts[run.kind].add(run);
        all.add(run);
        if (run.fault != PeopleFault::none) faults[std::string(name_of(run.fault))].add(run);
    }
    std::string text =
        "                                            certi-  held    U, km/h          error   "
        "usable  "
        "false  s per\n"
        "kind                                 runs      fied     %   median    90 %   median       "
        "%  "
        "       50,000  refused\n";
    for (const std::string& name : names)
        text += counts[name].line(name);
    for (const auto& [name, count] : faults)
        text += count.line("fault: " + name);
    return text + all.line("all");
}

std::string people_csv(const std::vector<PeopleRun>& runs) {
    std::string text =
        "kind,fault,seed,refused,error_km_h,expanded_km_h,usable,false_record,budget\n";
    for (const PeopleRun& run : runs) {
        std::vector<std::string> budget;
        for (const auto& [symbol, share] : run.budget)
            if (share > 1e-4) budget.push_back(fmt::format("{}={:.2f}", symbol, share * 3.6));
        text += fmt::format("\"{}\",{},{},\"{}\",{:.3f},{:.3f},{:.3f},{},{}\n", run.kind,
                            name_of(run.fault), run.seed, run.refused, run.error_m_s * 3.6,
                            run.expanded_m_s * 3.6, run.usable, run.false_record ? 1 : 0,
                            fmt::join(budget, " "));
    }
    return text;
}

}  // namespace runcert

#include "speeds_study.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "reports/words/figures.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

constexpr double session_s = 600.0;
constexpr double slow_m_s = 0.05, slow_tau_s = 20.0;
constexpr double stated_m_s = 0.5;
constexpr double position_slow_m = 0.5, position_tau_s = 30.0, position_white_m = 0.05;
constexpr double step_s = 0.1;

const Attempt& speeds_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: speeds\ncraft: {name: speeds, class: board}\n"
        "receivers: [{id: primary, recording: none}]\n"
        "profiles: [gps-speed-sailing-2s, gps-speed-sailing-10s]\n",
        "speeds");
    return attempt;
}

const std::vector<Profile>& speeds_rules() {
    static const std::vector<Profile> rules = [] {
        std::vector<Profile> all;
        for (const std::string& name : speeds_attempt().profiles)
            all.push_back(read_profile(builtin_profile(name), name));
        return all;
    }();
    return rules;
}

Eigen::Vector2d east_and_north(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

/// A first-order Gauss-Markov error, a sample each tenth of a second.
class WanderingError {
  public:
    WanderingError(double sigma, double tau_s, RandomGenerator& random)
        : sigma_(sigma),
          decay_(std::exp(-step_s / tau_s)),
          value_(sigma * east_and_north(random)) {}
    Eigen::Vector2d next(RandomGenerator& random) {
        value_ =
            decay_ * value_ + sigma_ * std::sqrt(1.0 - decay_ * decay_) * east_and_north(random);
        return value_;
    }

  private:
    double sigma_, decay_;
    Eigen::Vector2d value_;
};

using TrueSpeed = std::function<double(double)>;

std::vector<CertifiedSpeed> certify(const EnuTable& measured, const TrueSpeed& true_speed) {
    std::vector<CertifiedSpeed> all;
    const Attempt& attempt = speeds_attempt();
    const ScreenedTable screened = screen(measured, screen_config(attempt));
    const TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(attempt));
    const Windows windows = find_windows(screened, trajectory, speeds_rules(),
                                         window_config(attempt, attempt.receivers.front()));
    for (std::size_t i = 0; i < windows.profiles.size(); ++i) {
        const auto& best = windows.profiles[i].best;
        if (!best) continue;
        double sum = 0.0;
        std::int64_t count = 0;
        const double from_s = best->span.start.seconds();
        const double to_s = from_s + best->span.duration.seconds();
        for (const ScreenedEpoch& row : screened.rows) {
            if (row.time.seconds() < from_s + 1e-6 || row.time.seconds() > to_s + 1e-6) continue;
            sum += true_speed(row.time.seconds());
            ++count;
        }
        all.push_back({.rule = windows.profiles[i].profile,
                       .speed = best->speed_m_s,
                       .truth = sum / static_cast<double>(count),
                       .expanded = expanded_uncertainty_by_rule_m_s(
                           *best, speeds_rules()[i].coverage_factor)});
    }
    return all;
}

}  // namespace

std::vector<SpeedsCell> speeds_cells() {
    std::vector<SpeedsCell> cells;
    for (const double rate_hz : {10.0, 1.0})
        for (const double white_m_s : {0.05, 0.1, 0.3})
            cells.push_back({.rate_hz = rate_hz, .white_m_s = white_m_s});
    for (const double white_m_s : {0.1, 0.3})
        cells.push_back({.white_m_s = white_m_s, .filter_s = 0.3});
    cells.push_back({.white_m_s = 0.1, .positions = SpeedsPositions::integrated});
    return cells;
}

std::string cell_name(const SpeedsCell& cell) {
    return fmt::format("{:g} Hz, {:g} m/s{}{}", cell.rate_hz, cell.white_m_s,
                       cell.filter_s > 0.0 ? ", filtered" : "",
                       cell.positions == SpeedsPositions::integrated ? ", integrated" : "");
}

std::vector<CertifiedSpeed> certify_speeds(const SpeedsCell& cell, std::uint64_t seed) {
    RandomGenerator random(seed);
    const TruePath path = random_session(session_s, false, random);
    WanderingError of_velocity(slow_m_s, slow_tau_s, random);
    WanderingError of_position(position_slow_m, position_tau_s, random);
    EnuTable table;
    table.facts = {.receiver = "primary",
                   .first_epoch = GpsTime{},
                   .vertical_measured = false,
                   .nominal_interval_s = 1.0 / cell.rate_hz,
                   .position_resolution_m = 0.01,
                   .time_source = "satellites"};
    // A filter keeps the size of what goes through it, so that "0.3" is what is recorded.
    const double kept = cell.filter_s > 0.0 ? std::exp(-step_s / cell.filter_s) : 0.0;
    const auto every = static_cast<std::size_t>(std::lround(1.0 / (step_s * cell.rate_hz)));
    Eigen::Vector2d noise = cell.white_m_s * east_and_north(random);
    Eigen::Vector2d integrated = path.position(0.0), before = path.velocity(0.0);
    for (std::size_t k = 0; static_cast<double>(k) * step_s <= session_s; ++k) {
        const double time_s = static_cast<double>(k) * step_s;
        noise =
            kept * noise + std::sqrt(1.0 - kept * kept) * cell.white_m_s * east_and_north(random);
        const Eigen::Vector2d velocity = path.velocity(time_s) + of_velocity.next(random) + noise;
        if (k > 0) integrated += 0.5 * step_s * (before + velocity);
        before = velocity;
        const Eigen::Vector2d position =
            cell.positions == SpeedsPositions::integrated
                ? Eigen::Vector2d(integrated + 0.005 * east_and_north(random))
                : Eigen::Vector2d(path.position(time_s) + of_position.next(random) +
                                  position_white_m * east_and_north(random));
        if (k % every != 0) continue;
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = std::ssize(table.rows);
        row.time = {std::llround(time_s * 1e9)};
        row.satellites = 9;
        row.fix = FixType::single;
        row.east_m = position.x();
        row.north_m = position.y();
        row.sigma_east_m = row.sigma_north_m = 1.0;
        row.recorded_velocity_east_m_s = velocity.x();
        row.recorded_velocity_north_m_s = velocity.y();
        row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s = stated_m_s;
    }
    return certify(table, [&](double time_s) { return path.velocity(time_s).norm(); });
}

std::vector<CertifiedSpeed> certify_speeds(const PeopleKind& kind, std::uint64_t seed) {
    const PeopleRecording recording = record_people(kind, PeopleFault::none, seed);
    return certify(recording.measured, [&](double time_s) {
        return recording.path.velocity(time_s - recording.device.velocity_late_s).norm();
    });
}

std::vector<SpeedsSummary> study_speeds(
    const std::function<std::vector<CertifiedSpeed>(std::uint64_t)>& certify, std::int64_t runs,
    std::uint64_t seed, unsigned threads) {
    std::map<std::string, std::vector<CertifiedSpeed>> by_rule;
    for (const auto& one : results_of(runs, threads, [&](std::int64_t i) {
             return certify(seed * 7'000'003 + static_cast<std::uint64_t>(i));
         }))
        for (const CertifiedSpeed& speed : one)
            by_rule[speed.rule].push_back(speed);
    std::vector<SpeedsSummary> summaries;
    for (const Profile& rule : speeds_rules()) {
        SpeedsSummary& summary = summaries.emplace_back();
        summary.rule = rule.id;
        std::vector<double> errors, expanded;
        for (const CertifiedSpeed& one : by_rule[rule.id]) {
            errors.push_back(one.error());
            expanded.push_back(one.expanded);
            summary.held += std::abs(one.error()) <= one.expanded ? 1.0 : 0.0;
        }
        summary.certified = std::ssize(errors);
        if (errors.size() < 2) continue;
        summary.held /= static_cast<double>(errors.size());
        summary.mean_error = mean(errors);
        summary.sd_error = standard_deviation(errors);
        summary.mean_expanded = mean(expanded);
    }
    return summaries;
}

std::string speeds_lines(const std::string& name, const std::vector<SpeedsSummary>& rules) {
    std::string text;
    for (const SpeedsSummary& one : rules)
        text += fmt::format(
            "{:32} {:24} certified {:4}, held {:.3f}, error {:+.3f} (sd {:.3f}), U {:.3f} km/h\n",
            name, one.rule, one.certified, one.held, 3.6 * one.mean_error, 3.6 * one.sd_error,
            3.6 * one.mean_expanded);
    return text;
}

}  // namespace runcert

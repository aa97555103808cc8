#include "stages/window/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arcs/arcs.h"
#include "core/accuracy_measures.h"
#include "core/failure.h"
#include "estimation/speed.h"
#include "stages/window/search.h"

namespace runcert {
namespace {

/// Sums along the rows of an arc, so that a window's means cost the same whatever its length.
struct RunningSums {
    std::vector<double> path_m;  ///< path length up to the row
    std::vector<double> speed;   ///< sum of smoothed speeds up to and with the row
};

Eigen::Vector2d position_of(const TrajectoryEpoch& row) {
    return {*row.east_m, *row.north_m};
}

/// The rows of one arc, as the trajectory has them.
struct ArcRows {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;
};

std::vector<ArcRows> arcs_in(const TrajectoryTable& trajectory) {
    std::vector<ArcRows> arcs;
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        const auto& arc = trajectory.rows[i].arc;
        if (!arc) continue;
        if (arcs.empty() || arcs.back().number != *arc) arcs.push_back({*arc, {}});
        arcs.back().rows.push_back(i);
    }
    return arcs;
}

RunningSums sums_over(const TrajectoryTable& trajectory, const std::vector<std::size_t>& rows) {
    RunningSums sums;
    double path_m = 0.0;
    double speed = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const TrajectoryEpoch& row = trajectory.rows[rows[k]];
        if (k > 0) path_m += (position_of(row) - position_of(trajectory.rows[rows[k - 1]])).norm();
        speed += *row.speed_mps;
        sums.path_m.push_back(path_m);
        sums.speed.push_back(speed);
    }
    return sums;
}

SpeedDefinitions definitions_of(const TrajectoryTable& trajectory, const ArcRows& arc,
                                const RunningSums& sums, EpochPair window) {
    const TrajectoryEpoch& first = trajectory.rows[arc.rows[window.first]];
    const TrajectoryEpoch& last = trajectory.rows[arc.rows[window.last]];
    const double duration_s = last.time.seconds() - first.time.seconds();
    const auto steps = static_cast<double>(window.last - window.first);
    const double later_speeds = sums.speed[window.last] - sums.speed[window.first];
    return {.displacement_mps = (position_of(last) - position_of(first)).norm() / duration_s,
            .path_length_mps = (sums.path_m[window.last] - sums.path_m[window.first]) / duration_s,
            .mean_n_plus_1_mps = (later_speeds + *first.speed_mps) / (steps + 1.0),
            .mean_n_mps = later_speeds / steps};
}

struct Candidate {
    const ArcRows* arc = nullptr;
    EpochPair window;
    SpeedDefinitions definitions;
};

/// Looks for a profile's best certifiable window, arc by arc.
class WindowSearch {
  public:
    WindowSearch(const TrajectoryTable& trajectory, const Profile& profile,
                 const WindowConfig& config)
        : trajectory_(trajectory), profile_(profile), config_(config) {
        // Every row counts, also one that belongs to no arc, as a repeated time stamp.
        for (const TrajectoryEpoch& row : trajectory.rows)
            unusable_.push_back((unusable_.empty() ? 0 : unusable_.back()) + (row.usable ? 0 : 1));
    }

    void look_in(const ArcRows& arc) {
        const RunningSums sums = sums_over(trajectory_, arc.rows);
        std::vector<ElapsedTime> times;
        for (const std::size_t row : arc.rows)
            times.push_back(trajectory_.rows[row].time);
        const auto ends = window_ends(times, profile_.duration_s, config_.duration_tolerance_s,
                                      trajectory_.facts.nominal_interval_s);
        for (std::size_t first = 0; first < arc.rows.size(); ++first)
            if (ends[first] && all_usable(arc.rows[first], arc.rows[*ends[first]]))
                consider({&arc,
                          {first, *ends[first]},
                          definitions_of(trajectory_, arc, sums, {first, *ends[first]})});
    }

    const std::optional<Candidate>& best() const { return best_; }
    std::int64_t candidates() const { return candidates_; }

  private:
    bool all_usable(std::size_t first_row, std::size_t last_row) const {
        return trajectory_.rows[first_row].usable && unusable_[last_row] == unusable_[first_row];
    }
    void consider(const Candidate& candidate) {
        ++candidates_;
        const auto speed = [&](const Candidate& one) {
            return one.definitions.by_name(profile_.definition);
        };
        if (!best_ || speed(candidate) > speed(*best_)) best_ = candidate;
    }

    const TrajectoryTable& trajectory_;
    const Profile& profile_;
    const WindowConfig& config_;
    std::vector<std::int64_t> unusable_;
    std::optional<Candidate> best_;
    std::int64_t candidates_ = 0;
};

/// Mean of a method's speeds over the window; nothing if one is missing.
std::optional<double> mean_over(const TrajectoryTable& trajectory, const Candidate& candidate,
                                std::optional<double> TrajectoryEpoch::*method) {
    double sum = 0.0;
    for (std::size_t k = candidate.window.first; k <= candidate.window.last; ++k) {
        const auto& value = trajectory.rows[candidate.arc->rows[k]].*method;
        if (!value) return std::nullopt;
        sum += *value;
    }
    return sum / static_cast<double>(candidate.window.last - candidate.window.first + 1);
}

/// What the covariances of a window's two ends say.
struct EndsUncertainty {
    double speed_mps = 0.0;       ///< standard uncertainty of the displacement speed
    double position_r95_m = 0.0;  ///< 95 % radius of the position at the worse end
};

/// Smooths the candidate's arc anew for the joint covariance of the window's ends, and checks that
/// the estimate is the trajectory's.
template <int Axes>
EndsUncertainty ends_uncertainty(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                 const Candidate& candidate, const WindowConfig& config) {
    const auto arcs = arcs_of<Axes>(screened);
    for (const Arc<Axes>& arc : arcs) {
        if (arc.number != candidate.arc->number) continue;
        const SmoothedArc<Axes> smoothed = smooth<Axes>(arc.epochs, config.model);
        const double variance_factor = trajectory.estimation.variance_factor_applied;
        EndsUncertainty uncertainty;
        for (const std::size_t k : {candidate.window.first, candidate.window.last}) {
            const TrajectoryEpoch& row = trajectory.rows[candidate.arc->rows[k]];
            const Eigen::Vector2d position = smoothed.states[k].mean.template head<2>();
            const double difference_m = (position - position_of(row)).norm();
            if (difference_m > 2e-6)  // both coordinates are written to a micrometre
                throw Failure(
                    fmt::format("epoch {}", row.epoch),
                    fmt::format("the trajectory is {:.1e} m from the estimate of the same "
                                "screened epochs",
                                difference_m),
                    "Run runcert-smooth again, with the same attempt");
            const Eigen::Matrix2d covariance =
                variance_factor * smoothed.states[k].covariance.template topLeftCorner<2, 2>();
            uncertainty.position_r95_m = std::max(uncertainty.position_r95_m, r95(covariance));
        }
        const double duration_s =
            arc.epochs[candidate.window.last].time_s - arc.epochs[candidate.window.first].time_s;
        uncertainty.speed_mps =
            std::sqrt(variance_factor) *
            displacement_speed(smoothed, candidate.window.first, candidate.window.last, duration_s)
                .standard_uncertainty_mps;
        return uncertainty;
    }
    throw Failure(fmt::format("arc {}", candidate.arc->number),
                  "the trajectory has an arc that the screened epochs do not have",
                  "Run runcert-smooth again");
}

CertifiableWindow certified(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                            const Candidate& candidate, const Profile& profile,
                            const WindowConfig& config) {
    const TrajectoryEpoch& first = trajectory.rows[candidate.arc->rows[candidate.window.first]];
    const TrajectoryEpoch& last = trajectory.rows[candidate.arc->rows[candidate.window.last]];
    CertifiableWindow window;
    window.span = window_span(trajectory.facts, first.epoch, last.epoch, first.time, last.time);
    window.arc = candidate.arc->number;
    window.definitions = candidate.definitions;
    window.speed_mps = candidate.definitions.by_name(profile.definition);
    window.displacement_m = (position_of(last) - position_of(first)).norm();
    const EndsUncertainty uncertainty =
        trajectory.facts.vertical_measured
            ? ends_uncertainty<3>(screened, trajectory, candidate, config)
            : ends_uncertainty<2>(screened, trajectory, candidate, config);
    window.standard_uncertainty_mps = uncertainty.speed_mps;
    window.position_r95_m = uncertainty.position_r95_m;
    using Row = TrajectoryEpoch;
    window.methods = {.smoothed_mps = mean_over(trajectory, candidate, &Row::speed_mps),
                      .batch_mps = mean_over(trajectory, candidate, &Row::speed_batch_mps),
                      .v1_mps = mean_over(trajectory, candidate, &Row::speed_v1_mps),
                      .v2_mps = mean_over(trajectory, candidate, &Row::speed_v2_mps),
                      .kalman_mps = mean_over(trajectory, candidate, &Row::speed_kalman_mps)};
    return window;
}

}  // namespace

WindowConfig window_config(const Attempt& attempt, const TrajectoryTable& trajectory) {
    return {.duration_tolerance_s = attempt.parameters.at("window").at("duration_tolerance_s"),
            .model = {.jerk_density = trajectory.header.parameters.at("jerk_density")}};
}

Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config) {
    Windows windows;
    windows.receiver = trajectory.facts.receiver;
    windows.first_epoch = trajectory.facts.first_epoch;
    windows.georeferenced = trajectory.facts.georeferenced;
    const std::vector<ArcRows> arcs = arcs_in(trajectory);
    for (const Profile& profile : profiles) {
        ProfileWindows entry{.profile = profile.id,
                             .duration_s = profile.duration_s,
                             .definition = profile.definition,
                             .candidates = 0,
                             .best = std::nullopt,
                             .indicated = fastest_indicated(screened, profile.duration_s, config)};
        WindowSearch search(trajectory, profile, config);
        for (const ArcRows& arc : arcs)
            search.look_in(arc);
        entry.candidates = search.candidates();
        if (search.best())
            entry.best = certified(screened, trajectory, *search.best(), profile, config);
        windows.profiles.push_back(std::move(entry));
    }
    return windows;
}

}  // namespace runcert

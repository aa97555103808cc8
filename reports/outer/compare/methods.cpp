#include "reports/compare/methods.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/chain.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

using Column = std::optional<double> TrajectoryEpoch::*;
using Motion = NoiseFitOptions::Motion;

// Where the recording states no accuracy of its velocities, or zero.
constexpr double default_velocity_sigma_m_s = 0.1;

/// The method whose speeds, and positions where it has some, are columns of the trajectory.
MethodTrack track_of(const std::string& name, SpeedDefinition window_speed,
                     const TrajectoryTable& trajectory, Column speed, Column east = nullptr,
                     Column north = nullptr) {
    MethodTrack track{.name = name, .window_speed = window_speed};
    for (const TrajectoryEpoch& row : trajectory.rows) {
        MethodEpoch& epoch = track.epochs.emplace_back();
        if (speed) epoch.speed_m_s = row.*speed;
        if (east && row.*east && row.*north)
            epoch.position_m = Eigen::Vector2d(*(row.*east), *(row.*north));
    }
    return track;
}

MethodTrack raw_positions(const ScreenedTable& screened) {
    MethodTrack track{.name = "raw positions"};
    for (const ScreenedEpoch& row : screened.rows) {
        MethodEpoch& epoch = track.epochs.emplace_back();
        if (row.usable) epoch.position_m = measured_position<2>(row);
    }
    return track;
}

/// The smoother of a model with a lag of so many epochs, in a table of so many rows.
MethodTrack smoother_track(const std::string& name, const std::vector<Arc<2>>& arcs,
                           const EstimationModel& model, std::size_t lag, std::size_t rows) {
    MethodTrack track{.name = name, .epochs = std::vector<MethodEpoch>(rows)};
    for (const Arc<2>& arc : arcs) {
        const auto states = Chain<2>(arc.epochs, model).fixed_lag(std::min(lag, arc.epochs.size()));
        for (std::size_t k = 0; k < states.size(); ++k)
            track.epochs[arc.rows[k]] = {.position_m = states[k].mean.head<2>(),
                                         .speed_m_s = states[k].mean.segment<2>(2).norm()};
    }
    return track;
}

constexpr std::size_t whole_arc = std::numeric_limits<std::size_t>::max();

/// Fixed-lag smoothers of the trajectory's own model.
void add_fixed_lags(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                    std::vector<MethodTrack>& tracks) {
    const std::vector<Arc<2>> arcs = arcs_of<2>(screened, trajectory);
    const EstimationModel model = model_of(noise_of<2>(trajectory));
    const double interval_s = trajectory.facts.nominal_interval_s;
    for (const double lag_s : {0.5, 1.0, 2.0}) {
        const auto lag = static_cast<std::size_t>(
            interval_s > 0.0 ? std::max(1.0, std::round(lag_s / interval_s)) : 1.0);
        tracks.push_back(smoother_track(
            fmt::format("fixed lag {} s ({} epoch{})", lag_s, lag, lag == 1 ? "" : "s"), arcs,
            model, lag, screened.rows.size()));
    }
    tracks.push_back(
        smoother_track("fixed lag, full", arcs, model, whole_arc, screened.rows.size()));
}

std::string choice_note(const NoiseSummary& noise, Motion asked) {
    const char* used = noise.acceleration_time_s ? "Singer acceleration" : "constant acceleration";
    if (noise.status != NoiseBasis::fitted)
        return fmt::format("The trajectory uses {}, its noise not fitted", used);
    if (asked != Motion::by_likelihood)
        return fmt::format("The trajectory uses {}, as the attempt asks", used);
    return fmt::format(
        "The trajectory uses {}, by likelihood: Singer needs a gain above 1.92 (5 %)", used);
}

/// The smoothers with either motion model, each with noise fitted for it.
void add_fitted_smoothers(const ScreenedTable& screened, NoiseFitOptions options,
                          Methods& methods) {
    const std::vector<Arc<2>> arcs = arcs_of<2>(screened);
    std::vector<std::span<const ArcEpoch<2>>> spans;
    for (const Arc<2>& arc : arcs)
        spans.emplace_back(arc.epochs);
    const auto fitted = [&](const char* name, Motion motion) {
        options.motion = motion;
        NoiseFit fit = fit_noise<2>(spans, options);
        MethodTrack& track = methods.tracks.emplace_back(
            MethodTrack{.name = name, .epochs = std::vector<MethodEpoch>(screened.rows.size())});
        if (fit.status == NoiseFit::Status::fitted)
            track = smoother_track(name, arcs, fit.model, whole_arc, screened.rows.size());
        else
            track.unavailable = fit.status == NoiseFit::Status::too_few_epochs
                                    ? "too few epochs to fit noise to"
                                    : "the positions never change: no noise can be fitted";
        return fit;
    };
    const NoiseFit constant =
        fitted("smoother, constant acceleration", Motion::constant_acceleration);
    const NoiseFit singer = fitted("smoother, Singer acceleration", Motion::singer);
    if (constant.status != NoiseFit::Status::fitted || singer.status != NoiseFit::Status::fitted)
        return;
    const auto log_likelihood = [&](const NoiseFit& fit) {
        return innovation_sums<2>(spans, fit.model).log_likelihood();
    };
    const double of_constant = log_likelihood(constant), of_singer = log_likelihood(singer);
    methods.notes.push_back(
        fmt::format("Constant acceleration: log-likelihood {:.2f}, jerk density {:.4g} m s^-2.5",
                    of_constant, constant.jerk_density.value));
    methods.notes.push_back(
        fmt::format("Singer: log-likelihood {:.2f} (gain {:.2f}), correlation time {:.3g} s",
                    of_singer, of_singer - of_constant, singer.acceleration_time.value));
}

bool is_stated(const std::optional<double>& sigma) {
    return sigma && *sigma > 0.0;
}

/// An epoch of the filter of [EKF]. A height that was not measured, or whose accuracy is not known,
/// is taken loosely.
ArcEpoch<3> measured_epoch(const ScreenedEpoch& row) {
    constexpr double loose_height_sigma_m = 1.0;
    ArcEpoch<3> epoch;
    epoch.time_s = row.time.seconds();
    if (!row.usable) return epoch;
    epoch.measurement = {
        .position = {row.east_m.value(), row.north_m.value(), row.up_m.value_or(0.0)},
        .covariance = stated_covariance<3>(row)};
    if (!row.up_m || !row.sigma_up_m)
        epoch.measurement->covariance(2, 2) = loose_height_sigma_m * loose_height_sigma_m;
    return epoch;
}

/// A recorded velocity with its covariance, as stated where it is.
std::optional<MeasuredVelocity> measured_velocity(const ScreenedEpoch& row) {
    if (!row.recorded_velocity_east_m_s || !row.recorded_velocity_north_m_s) return std::nullopt;
    const auto variance = [](const std::optional<double>& sigma_m_s) {
        return std::pow(is_stated(sigma_m_s) ? *sigma_m_s : default_velocity_sigma_m_s, 2);
    };
    const Eigen::Vector3d variances(variance(row.sigma_recorded_velocity_east_m_s),
                                    variance(row.sigma_recorded_velocity_north_m_s),
                                    variance(row.sigma_recorded_velocity_up_m_s));
    return MeasuredVelocity{
        .velocity_m_s = {*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s,
                         row.recorded_velocity_up_m_s.value_or(0.0)},
        .covariance_m2_s2 = variances.asDiagonal()};
}

/// What was recorded of the velocity, and the filter of [EKF].
void add_velocity_methods(const ScreenedTable& screened, Methods& methods) {
    const auto count = screened.rows.size();
    MethodTrack recorded{.name = "recorded velocity",
                         .window_speed = SpeedDefinition::mean_n_plus_1,
                         .epochs = std::vector<MethodEpoch>(count)};
    MethodTrack enhanced{.name = "enhanced Kalman filter [EKF]",
                         .window_speed = SpeedDefinition::mean_n,
                         .epochs = recorded.epochs};
    std::int64_t velocities = 0, unstated = 0;
    for (const Arc<2>& arc : arcs_of<2>(screened)) {
        std::vector<ArcEpoch<3>> epochs;
        std::vector<std::optional<MeasuredVelocity>> inputs;
        for (const std::size_t i : arc.rows) {
            const ScreenedEpoch& row = screened.rows[i];
            epochs.push_back(measured_epoch(row));
            if (!inputs.emplace_back(measured_velocity(row))) continue;
            recorded.epochs[i].speed_m_s = inputs.back()->velocity_m_s.head<2>().norm();
            ++velocities;
            if (!is_stated(row.sigma_recorded_velocity_east_m_s) ||
                !is_stated(row.sigma_recorded_velocity_north_m_s) ||
                (row.recorded_velocity_up_m_s && !is_stated(row.sigma_recorded_velocity_up_m_s)))
                ++unstated;
        }
        const auto states = filter_enhanced_kalman(epochs, inputs);
        for (std::size_t k = 0; k < states.size(); ++k)
            if (states[k] && states[k]->velocity_m_s)
                enhanced.epochs[arc.rows[k]] = {
                    .position_m = states[k]->position_m.head<2>(),
                    .speed_m_s = states[k]->velocity_m_s->head<2>().norm()};
    }
    if (velocities == 0)
        recorded.unavailable = enhanced.unavailable = "the recording has no velocities";
    if (unstated > 0)
        methods.notes.push_back(
            fmt::format("[EKF] takes {} m/s for the accuracy of {} of {} recorded velocities, "
                        "which is not stated",
                        default_velocity_sigma_m_s, unstated, velocities));
    methods.tracks.push_back(std::move(recorded));
    methods.tracks.push_back(std::move(enhanced));
}

/// What was measured of the velocity between two epochs.
std::optional<MeasuredVelocity> velocity_between(const std::optional<MeasuredVelocity>& before,
                                                 const std::optional<MeasuredVelocity>& after) {
    if (!before) return after;
    if (!after) return before;
    return MeasuredVelocity{
        .velocity_m_s = 0.5 * (before->velocity_m_s + after->velocity_m_s),
        .covariance_m2_s2 = 0.5 * (before->covariance_m2_s2 + after->covariance_m2_s2)};
}

void update(EnhancedKalmanState& state, const PositionMeasurement<3>& measured) {
    const Eigen::Matrix3d gain =
        state.covariance_m2 * (state.covariance_m2 + measured.covariance).inverse();
    const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain;
    state.position_m += gain * (measured.position - state.position_m);
    // Joseph form: symmetric and positive whatever the rounding of the gain.
    state.covariance_m2 = keep * state.covariance_m2 * keep.transpose() +
                          gain * measured.covariance * gain.transpose();
}

}  // namespace

Methods methods_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                   const CompareConfig& config) {
    using Row = TrajectoryEpoch;
    Methods methods;
    std::vector<MethodTrack>& tracks = methods.tracks;
    constexpr auto displacement = SpeedDefinition::displacement;
    constexpr auto mean = SpeedDefinition::mean_n_plus_1;
    tracks.push_back(raw_positions(screened));
    tracks.push_back(track_of("v1 [DHD22]", mean, trajectory, &Row::speed_v1_m_s));
    tracks.push_back(track_of("v2 [DHD22]", mean, trajectory, &Row::speed_v2_m_s));
    tracks.push_back(track_of("Kalman filter [DHD22]", mean, trajectory, &Row::speed_kalman_m_s));
    add_fixed_lags(screened, trajectory, tracks);
    add_fitted_smoothers(screened, config.fit, methods);
    methods.notes.push_back(choice_note(noise_of<2>(trajectory), config.fit.motion));
    tracks.push_back(track_of("smoother of the trajectory", displacement, trajectory,
                              &Row::speed_m_s, &Row::east_m, &Row::north_m));
    tracks.push_back(track_of("batch", mean, trajectory, &Row::speed_batch_m_s));
    tracks.push_back(track_of("robust solution", displacement, trajectory, nullptr,
                              &Row::robust_east_m, &Row::robust_north_m));
    add_velocity_methods(screened, methods);
    return methods;
}

std::vector<std::optional<EnhancedKalmanState>> filter_enhanced_kalman(
    std::span<const ArcEpoch<3>> arc, std::span<const std::optional<MeasuredVelocity>> velocities) {
    std::vector<std::optional<EnhancedKalmanState>> states;
    std::optional<EnhancedKalmanState> state;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto& measured = arc[k].measurement;
        const std::optional<MeasuredVelocity> input =
            state ? velocity_between(velocities[k - 1], velocities[k]) : std::nullopt;
        if (input) {
            const double dt_s = arc[k].time_s - arc[k - 1].time_s;
            const Eigen::Vector3d before_m = state->position_m;
            state->position_m += input->velocity_m_s * dt_s;
            state->covariance_m2 += input->covariance_m2_s2 * dt_s * dt_s;
            if (measured) update(*state, *measured);
            state->velocity_m_s = (state->position_m - before_m) / dt_s;
        } else {
            state.reset();
            if (measured)
                state = EnhancedKalmanState{.position_m = measured->position,
                                            .covariance_m2 = measured->covariance};
        }
        states.push_back(state);
    }
    return states;
}

}  // namespace runcert

#include "reports/compare/methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "motion/chain.h"
#include "schemas/enu/measured_position.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

using Column = std::optional<double> TrajectoryEpoch::*;
using Motion = NoiseFitOptions::Motion;

/// Positions from two columns of the trajectory, speeds from a third where there is one.
MethodTrack of_positions(const std::string& name, const TrajectoryTable& trajectory, Column east,
                         Column north, Column speed) {
    MethodTrack track = empty_track(name, SpeedDefinition::displacement, trajectory.rows.size());
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        const TrajectoryEpoch& row = trajectory.rows[i];
        if (row.*east && row.*north) track.positions[i] = {*(row.*east), *(row.*north)};
        if (speed) track.speeds_m_s[i] = row.*speed;
    }
    return track;
}

MethodTrack of_speeds(const std::string& name, const TrajectoryTable& trajectory, Column speed) {
    MethodTrack track = empty_track(name, SpeedDefinition::mean_n_plus_1, trajectory.rows.size());
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i)
        track.speeds_m_s[i] = trajectory.rows[i].*speed;
    return track;
}

MethodTrack raw_positions(const ScreenedTable& screened) {
    MethodTrack track =
        empty_track("raw positions", SpeedDefinition::displacement, screened.rows.size());
    for (std::size_t i = 0; i < screened.rows.size(); ++i)
        if (screened.rows[i].usable) track.positions[i] = measured_position<2>(screened.rows[i]);
    return track;
}

void take_states(const Arc<2>& arc, const std::vector<StateEstimate<2>>& states,
                 MethodTrack& track) {
    for (std::size_t k = 0; k < states.size(); ++k) {
        track.positions[arc.rows[k]] = states[k].mean.head<2>();
        track.speeds_m_s[arc.rows[k]] = states[k].mean.segment<2>(2).norm();
    }
}

/// Fixed-lag smoothers of the trajectory's own model.
void add_fixed_lags(const std::vector<Arc<2>>& arcs, const EstimationModel& model,
                    const TrajectoryTable& trajectory, std::vector<MethodTrack>& tracks) {
    const double interval_s = trajectory.facts.nominal_interval_s;
    for (const double lag_s : {0.5, 1.0, 2.0}) {
        const auto lag = static_cast<std::size_t>(
            interval_s > 0.0 ? std::max(1.0, std::round(lag_s / interval_s)) : 1.0);
        MethodTrack& track = tracks.emplace_back(
            empty_track(fmt::format("fixed lag {} s ({} epoch{})", lag_s, lag, lag == 1 ? "" : "s"),
                        SpeedDefinition::displacement, trajectory.rows.size()));
        for (const Arc<2>& arc : arcs)
            take_states(arc, Chain<2>(arc.epochs, model).fixed_lag(lag), track);
    }
    MethodTrack& full = tracks.emplace_back(
        empty_track("fixed lag, full", SpeedDefinition::displacement, trajectory.rows.size()));
    for (const Arc<2>& arc : arcs)
        take_states(arc, Chain<2>(arc.epochs, model).fixed_lag(arc.epochs.size()), full);
}

/// The smoother with one motion model and noise fitted for it.
struct FittedSmoother {
    MethodTrack track;
    NoiseFit fit;
    double log_likelihood = 0.0;
    bool fitted() const { return fit.status == NoiseFit::Status::fitted; }
};

FittedSmoother fitted_smoother(const std::string& name, const std::vector<Arc<2>>& arcs,
                               std::size_t rows, NoiseFitOptions options, Motion motion) {
    FittedSmoother result;
    result.track = empty_track(name, SpeedDefinition::displacement, rows);
    std::vector<std::span<const ArcEpoch<2>>> spans;
    spans.reserve(arcs.size());
    for (const Arc<2>& arc : arcs)
        spans.emplace_back(arc.epochs);
    options.motion = motion;
    result.fit = fit_noise<2>(spans, options);
    if (!result.fitted()) {
        result.track.unavailable = result.fit.status == NoiseFit::Status::too_few_epochs
                                       ? "too few epochs to fit noise to"
                                       : "the positions never change: no noise can be fitted";
        return result;
    }
    result.log_likelihood = innovation_sums<2>(spans, result.fit.model).log_likelihood();
    for (const Arc<2>& arc : arcs)
        take_states(arc, Chain<2>(arc.epochs, result.fit.model).fixed_lag(arc.epochs.size()),
                    result.track);
    return result;
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

void note_fits(const FittedSmoother& constant, const FittedSmoother& singer,
               const NoiseSummary& noise, Motion asked, std::vector<std::string>& notes) {
    if (constant.fitted() && singer.fitted()) {
        notes.push_back(fmt::format(
            "Constant acceleration: log-likelihood {:.2f}, jerk density {:.4g} m s^-2.5",
            constant.log_likelihood, constant.fit.jerk_density.value));
        notes.push_back(
            fmt::format("Singer: log-likelihood {:.2f} (gain {:.2f}), correlation time {:.3g} s",
                        singer.log_likelihood, singer.log_likelihood - constant.log_likelihood,
                        singer.fit.acceleration_time.value));
    }
    notes.push_back(choice_note(noise, asked));
}

}  // namespace

MethodTrack empty_track(const std::string& name, SpeedDefinition window_speed, std::size_t rows) {
    MethodTrack track;
    track.name = name;
    track.window_speed = window_speed;
    track.positions.resize(rows);
    track.speeds_m_s.resize(rows);
    return track;
}

Methods methods_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                   const CompareConfig& config) {
    const NoiseSummary& noise = noise_of<2>(trajectory);
    const std::vector<Arc<2>> arcs = arcs_of<2>(screened);
    using Row = TrajectoryEpoch;
    Methods methods;
    std::vector<MethodTrack>& tracks = methods.tracks;
    tracks.push_back(raw_positions(screened));
    tracks.push_back(of_speeds("v1 [DHD22]", trajectory, &Row::speed_v1_m_s));
    tracks.push_back(of_speeds("v2 [DHD22]", trajectory, &Row::speed_v2_m_s));
    tracks.push_back(of_speeds("Kalman filter [DHD22]", trajectory, &Row::speed_kalman_m_s));
    add_fixed_lags(arcs_of<2>(screened, trajectory), model_of(noise), trajectory, tracks);

    FittedSmoother constant =
        fitted_smoother("smoother, constant acceleration", arcs, screened.rows.size(), config.fit,
                        Motion::constant_acceleration);
    FittedSmoother singer = fitted_smoother("smoother, Singer acceleration", arcs,
                                            screened.rows.size(), config.fit, Motion::singer);
    note_fits(constant, singer, noise, config.fit.motion, methods.notes);
    tracks.push_back(std::move(constant.track));
    tracks.push_back(std::move(singer.track));

    tracks.push_back(of_positions("smoother of the trajectory", trajectory, &Row::east_m,
                                  &Row::north_m, &Row::speed_m_s));
    tracks.push_back(of_speeds("batch", trajectory, &Row::speed_batch_m_s));
    tracks.push_back(of_positions("robust solution", trajectory, &Row::robust_east_m,
                                  &Row::robust_north_m, nullptr));
    tracks.push_back(recorded_speed(screened));
    EnhancedKalmanTrack enhanced = enhanced_kalman_track(screened);
    tracks.push_back(std::move(enhanced.track));
    if (!enhanced.note.empty()) methods.notes.push_back(enhanced.note);
    return methods;
}

}  // namespace runcert

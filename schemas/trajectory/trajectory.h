#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/enu/enu.h"

namespace runcert {

/// One epoch of the smoothed trajectory. Outside arcs only epoch and time are given; vertical
/// figures only where heights were measured. Sigmas are standard uncertainties.
struct TrajectoryEpoch {
    std::int64_t epoch = 0;
    ElapsedTime time;
    std::optional<double> east_m, north_m, up_m;
    std::optional<double> velocity_east_mps, velocity_north_mps, velocity_up_mps;
    std::optional<double> acceleration_east_mps2, acceleration_north_mps2, acceleration_up_mps2;
    std::optional<double> speed_mps;
    std::optional<double> sigma_east_m, sigma_north_m, sigma_up_m;
    std::optional<double> sigma_velocity_east_mps, sigma_velocity_north_mps, sigma_velocity_up_mps;
    std::optional<double> sigma_acceleration_east_mps2, sigma_acceleration_north_mps2,
        sigma_acceleration_up_mps2;
    std::optional<double> sigma_speed_mps;
    std::optional<double> speed_batch_mps;
    std::optional<double> speed_v1_mps;
    std::optional<double> speed_v2_mps;
    std::optional<double> speed_kalman_mps;
    /// The batch with a robust loss, over all epochs that a test could have rejected wrongly or
    /// kept wrongly, and the weight it gives the epoch's measurement (1: full).
    std::optional<double> robust_east_m = std::nullopt;
    std::optional<double> robust_north_m = std::nullopt;
    std::optional<double> robust_weight = std::nullopt;
    std::optional<double> jerk_density = std::nullopt;     ///< m s^-2.5, of east and north; these
    std::optional<double> jerk_density_up = std::nullopt;  ///< since revision 1.3
    std::optional<std::int64_t> arc;
    bool usable = false;
    /// Since revision 1.2: whether the positions are offset by an unknown constant from here on, a
    /// bridged step.
    std::optional<bool> step_before = std::nullopt;

    bool begins_after_step() const { return step_before.value_or(false); }
};

/// A parameter of the noise as fitted. `relative_uncertainty` is the standard uncertainty of its
/// natural logarithm; empty where the data do not tell it.
struct NoiseParameter {
    double value = 0.0;
    std::optional<double> relative_uncertainty;
    bool at_bound = false;
};

/// A noise model that the data allow, and its share of the posterior.
struct NoiseModelShare {
    double weight = 1.0;
    double jerk_density = 0.0;
    std::optional<double> acceleration_time_s;  ///< empty: acceleration persists
    double measurement_scale = 1.0;
    double error_sigma_m = 0.0;
    double error_tau_s = 1.0;
};

/// The noise learnt from a recording, for the horizontal axes together or for the vertical one.
struct NoiseSummary {
    std::string status;  ///< "fitted", "too_few_epochs", "constant_positions", "not_asked"
    std::int64_t epochs = 0;
    std::int64_t epochs_needed = 0;
    double stated_sigma_m = 0.0;  ///< root mean square of the stated standard deviations
    bool stated_all_equal = false;
    double tau_min_s = 0.0;  ///< the correlation time was looked for between these
    double tau_max_s = 0.0;
    NoiseParameter jerk_density;       ///< m s^-2.5
    NoiseParameter measurement_scale;  ///< factor on the stated standard deviations
    std::optional<NoiseParameter> acceleration_time_s;  ///< empty: acceleration persists
    double singer_gain = 0.0;  ///< log-likelihood of Singer above persistent acceleration
    bool error_told = false;   ///< whether a correlated error could be told from white noise
    double error_gain = 0.0;   ///< its log-likelihood above white noise alone
    std::optional<NoiseParameter> error_diffusion;  ///< m s^-0.5; these three where it is told
    std::optional<NoiseParameter> error_tau_s;
    std::optional<NoiseParameter> error_sigma_m;
    double white_scale = 1.0;  ///< scale of the stated standard deviations under white noise alone
    std::int64_t evaluations = 0;
    bool converged = false;
    std::vector<NoiseModelShare> posterior;
};

/// Whether filter and smoother behaved as their model says.
struct FilterHealth {
    std::int64_t innovations = 0;  ///< scalar innovations tested
    double mean_statistic = 0.0;   ///< mean square of the normalised innovations; 1 expected
    double lower = 0.0;            ///< two-sided limits of that mean, 5 %
    double upper = 0.0;
    std::int64_t spans = 0;          ///< spans of 100 scalar innovations, each tested likewise
    std::int64_t spans_outside = 0;  ///< of them outside their limits
    std::int64_t spans_allowed = 0;  ///< as many as chance allows
    bool consistent = false;         ///< the mean within its limits, and not too many spans outside
    double autocorrelation_stated = 0.0;  ///< lag 1, with noise as stated and the class's jerk
    double autocorrelation = 0.0;         ///< lag 1, with the model used
    bool white = false;                   ///< within +-0.1
    double largest_condition = 0.0;  ///< of a smoothed covariance with its diagonal scaled to one
    double largest_asymmetry = 0.0;  ///< of a covariance before symmetrising, relative
    std::int64_t repaired = 0;       ///< covariances made positive definite again
};

/// The axes' own part of the estimation.
struct AxesEstimation {
    NoiseSummary noise;
    FilterHealth health;
};

/// How the estimate of a whole recording went.
struct EstimationSummary {
    std::int64_t arcs = 0;
    std::int64_t degrees_of_freedom = 0;
    double variance_factor = 1.0;          ///< a posteriori, of unit weight
    double variance_factor_applied = 1.0;  ///< on the stated covariances of the positions
    double largest_position_difference_m = 0.0;
    double largest_velocity_difference_mps = 0.0;
    std::int64_t batch_stretches = 0;      ///< stretches the batch was solved in
    std::int64_t robust_downweighted = 0;  ///< epochs whose robust weight is below one half
    std::int64_t robust_unsolved = 0;      ///< arcs whose robust batch did not converge
    std::optional<AxesEstimation> horizontal = std::nullopt;  ///< these since revision 1.1
    std::optional<AxesEstimation> vertical = std::nullopt;
};

/// 4-trajectory.ecsv, `schemas/trajectory/v1.yaml`.
struct TrajectoryTable {
    Header header;
    RecordingFacts facts;
    std::optional<FrameOrigin> origin;
    EstimationSummary estimation;
    std::vector<TrajectoryEpoch> rows;
};

std::string write_trajectory(const TrajectoryTable& table);
TrajectoryTable read_trajectory(std::string_view text, const std::string& where);
/// The same row by row. `text` must outlive what is returned.
OpenTable<TrajectoryTable> open_trajectory(std::string_view text, const std::string& where);

}  // namespace runcert

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/likelihood.h"

namespace runcert {

/// Data requirements and search limits of the fit. Lengths are in m, times in s.
struct NoiseFitOptions {
    double initial_jerk_density = 1.0;
    double tau_min_s = 0.5;  ///< limits of the Gauss-Markov error's correlation time
    double tau_max_s = 10.0;
    enum class Motion { by_likelihood, constant_acceleration, singer };
    /// Whether acceleration persists or decays (Singer). `by_likelihood` chooses Singer only for a
    /// gain beyond chance (likelihood ratio, chi-squared with one degree of freedom, 5 %).
    Motion motion = Motion::by_likelihood;
    std::int64_t epochs_needed = 30;  ///< measured epochs required, not counting the first three of
                                      ///< each arc
};

/// A fitted parameter.
struct FittedParameter {
    double value = 0.0;
    /// Standard uncertainty of the natural logarithm of the parameter, from the curvature of the
    /// likelihood. Infinite if the likelihood does not limit it.
    double relative_uncertainty = 0.0;
    bool at_bound = false;  ///< the search ended at one of its limits
};

/// A model and its posterior weight.
struct WeightedModel {
    EstimationModel model;
    double weight = 0.0;
};

/// Noise estimated from a recording by maximum likelihood with the forward filter.
struct NoiseFit {
    enum class Status { fitted, too_few_epochs, constant_positions };
    Status status = Status::fitted;
    std::int64_t epochs = 0;  ///< number of measured positions

    FittedParameter jerk_density;       ///< m s^-2.5
    FittedParameter measurement_scale;  ///< factor on the stated standard deviations
    FittedParameter acceleration_time;  ///< s; infinite where acceleration persists
    /// Whether a Gauss-Markov error improves the likelihood beyond chance (likelihood ratio
    /// against white noise alone, chi-squared with two degrees of freedom, 5 %).
    bool correlated_error_detected = false;
    /// sigma sqrt(2 / tau) of the Gauss-Markov error, m s^-0.5: how fast it wanders. The data
    /// determine this better than sigma or tau.
    FittedParameter error_diffusion;
    FittedParameter error_tau;    ///< its correlation time, s; often undetermined
    FittedParameter error_sigma;  ///< its standard deviation, m; determined no better than tau
    double error_gain = 0.0;      ///< log-likelihood gained over white noise alone
    double singer_gain = 0.0;     ///< log-likelihood that Singer gains over persistent acceleration
    /// Scale of the stated standard deviations if white noise were the only error.
    double white_scale = 1.0;
    /// Forward passes of one model over the recording that the fit took. One over a part of it
    /// counts as that part.
    double passes = 0.0;
    bool converged = false;

    /// The most likely model, without a Gauss-Markov error where none is detected.
    EstimationModel model;
    /// Models over a grid of the error's size and correlation time, each with its most likely jerk
    /// density and scale. Weights are likelihood times a prior uniform in size and correlation
    /// time. They sum to 1; models below 0.001 of the largest weight are left out.
    std::vector<WeightedModel> posterior;
};

/// Fits jerk density, measurement scale, and the size and correlation time of a Gauss-Markov error
/// to the innovations of all arcs. All axes share them. Where nothing can be fitted, the status
/// says why. The model then has the initial jerk density and the standard deviations as stated.
template <int Axes>
NoiseFit fit_noise(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                   const NoiseFitOptions& options);

}  // namespace runcert

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "estimation/likelihood.h"

namespace runcert {

/// What the fit may rest on and search in; lengths in m, times in s.
struct NoiseFitOptions {
    double initial_jerk_density = 1.0;
    double tau_min_s = 0.5;  ///< the correlation time of a Gauss-Markov error lies between these
    double tau_max_s = 10.0;
    enum class Motion { by_likelihood, constant_acceleration, singer };
    /// Whether acceleration persists or dies away (Singer); by likelihood, Singer needs a gain
    /// beyond chance (likelihood ratio, chi-squared with one degree of freedom, 5 %).
    Motion motion = Motion::by_likelihood;
    std::int64_t epochs_needed = 30;  ///< measured, beyond the first three of each arc
};

/// A parameter as fitted.
struct FittedParameter {
    double value = 0.0;
    /// Standard uncertainty of the parameter's natural logarithm, from the curvature of the
    /// likelihood; infinite where the likelihood does not limit it.
    double relative_uncertainty = 0.0;
    bool at_bound = false;  ///< the search ended at a limit of what it may search in
};

/// A model and its share of the posterior.
struct WeightedModel {
    EstimationModel model;
    double weight = 0.0;
};

/// Noise estimated from a recording by maximum likelihood of the forward filter.
struct NoiseFit {
    enum class Status { fitted, too_few_epochs, constant_positions };
    Status status = Status::fitted;
    std::int64_t epochs = 0;  ///< measured positions

    FittedParameter jerk_density;       ///< m s^-2.5
    FittedParameter measurement_scale;  ///< factor on the stated standard deviations
    FittedParameter acceleration_time;  ///< s; infinite where acceleration persists
    /// Whether a Gauss-Markov error improves the likelihood beyond chance (likelihood ratio
    /// against white noise alone, chi-squared with two degrees of freedom, 5 %).
    bool correlated_error_detected = false;
    /// sigma sqrt(2 / tau) of that error, m s^-0.5: how fast it wanders, which the data tell best.
    FittedParameter error_diffusion;
    FittedParameter error_tau;    ///< its correlation time, s; often not told
    FittedParameter error_sigma;  ///< its standard deviation, m; told no better than tau
    double error_gain = 0.0;      ///< log-likelihood above that of white noise alone
    double singer_gain = 0.0;     ///< log-likelihood of Singer above persistent acceleration
    /// Scale of the stated standard deviations were white noise alone the model.
    double white_scale = 1.0;
    std::int64_t evaluations = 0;  ///< of the likelihood
    bool converged = false;

    /// The most likely model; without a Gauss-Markov error where none is told.
    EstimationModel model;
    /// Models over a grid of the error's size and correlation time, each at the jerk density and
    /// scale most likely with them, weighted by likelihood times a prior uniform in size and
    /// correlation time. Weights sum to 1; those below 0.001 of the largest are left out.
    std::vector<WeightedModel> posterior;
};

/// Fits jerk density, scale, and size and correlation time of a Gauss-Markov error, shared by all
/// axes, to the innovations of all arcs. Where nothing can be fitted, the status says why and the
/// model is the initial jerk density with the accuracies as stated.
template <int Axes>
NoiseFit fit_noise(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                   const NoiseFitOptions& options);

}  // namespace runcert

#pragma once

#include "estimation/motion_model.h"

namespace runcert {

/// Mean and covariance of a state.
template <int Axes>
struct StateEstimate {
    StateVector<Axes> mean = StateVector<Axes>::Zero();
    StateMatrix<Axes> covariance = StateMatrix<Axes>::Identity();
};

/// A measured position (m) with the covariance (m^2) of its error.
template <int Axes>
struct PositionMeasurement {
    PositionVector<Axes> position = PositionVector<Axes>::Zero();
    PositionMatrix<Axes> covariance = PositionMatrix<Axes>::Identity();
};

/// What a measurement says against a prediction.
template <int Axes>
struct Innovation {
    PositionVector<Axes> residual = PositionVector<Axes>::Zero();  ///< measured less predicted
    PositionMatrix<Axes> covariance = PositionMatrix<Axes>::Identity();
    double statistic = 0.0;  ///< residual' covariance^-1 residual, chi-squared with Axes degrees
};

/// A prior that says next to nothing: at a position, with standard deviations of 100 m, 300 m/s
/// and 100 m/s^2. Against one measurement of 10 mm it moves a position by 1e-8 of the distance
/// between the two.
template <int Axes>
StateEstimate<Axes> vague_prior(const PositionVector<Axes>& position);

/// The estimate carried on by `dt` seconds.
template <int Axes>
StateEstimate<Axes> predict(const StateEstimate<Axes>& estimate, const MotionModel& model,
                            double dt_s);

template <int Axes>
Innovation<Axes> innovation(const StateEstimate<Axes>& predicted,
                            const PositionMeasurement<Axes>& measurement);

/// The estimate with the measurement taken in: two-sided Joseph form, symmetrised.
template <int Axes>
StateEstimate<Axes> update(const StateEstimate<Axes>& predicted,
                           const PositionMeasurement<Axes>& measurement);

}  // namespace runcert

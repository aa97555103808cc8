#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "estimation/motion_model.h"

namespace runcert {

/// How far the craft moved between two instants, as a witness has it.
template <int Axes>
struct WitnessedMotion {
    PositionVector<Axes> displacement_m = PositionVector<Axes>::Zero();
    PositionMatrix<Axes> covariance_m2 = PositionMatrix<Axes>::Identity();  ///< of that error
    std::int64_t satellites = 0;  ///< that it rests on; 0 of a witness that has none of its own
    bool confirms = true;  ///< false: fitted to the positions there, it can only contradict them
};

struct TimeSpan {
    double first_s = 0.0;
    double last_s = 0.0;
};

/// Anything that says how far the craft moved between two instants and does not come from the
/// positions: recorded velocities, carrier phases, a second receiver, a wheel, gates. Each has its
/// own error model; what it cannot see it does not answer.
template <int Axes>
class Witness {
  public:
    virtual ~Witness() = default;

    /// From one instant (s) to a later one, on the time scale of the positions; nothing where the
    /// witness does not cover all of it.
    virtual std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const = 0;

    /// The first and the last instant (s) that it knows anything of.
    virtual TimeSpan covered() const = 0;

    /// Length (m) of the path between, as uncertain as the displacement along it; nothing where the
    /// witness does not tell it.
    virtual std::optional<double> path_between(double from_s, double to_s) const = 0;
};

/// A figure from positions beside the same figure from a witness, with the standard uncertainties
/// of both, which are independent.
struct WitnessedFigure {
    double by_position = 0.0;
    double by_witness = 0.0;
    double uncertainty_by_position = 0.0;
    double uncertainty_by_witness = 0.0;

    double difference() const { return by_position - by_witness; }

    /// E_n at k = 2 (ISO/IEC 17043): above 1 the two contradict one another.
    double normalised_error() const {
        return std::abs(difference()) /
               (2.0 * std::hypot(uncertainty_by_position, uncertainty_by_witness));
    }
};

/// By how much the difference from the witness is the positions' error, 0 to 1: of two independent
/// errors of these standard deviations whose difference is known, the first is expected to be this
/// part of it, and its variance falls to the product of the two over their sum (the weighted
/// mean's).
inline double share_of_position(double sigma_position, double sigma_witness) {
    const double of_position = sigma_position * sigma_position;
    const double of_both = of_position + sigma_witness * sigma_witness;
    return of_both > 0.0 ? of_position / of_both : 0.0;
}

}  // namespace runcert

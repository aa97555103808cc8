#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "motion/motion_model.h"

namespace runcert {

/// The displacement of the craft between two instants, according to a witness.
template <int Axes>
struct WitnessedMotion {
    PositionVector<Axes> displacement_m = PositionVector<Axes>::Zero();
    PositionMatrix<Axes> covariance_m2 = PositionMatrix<Axes>::Identity();  ///< of its error
    std::int64_t satellites = 0;  ///< number of satellites behind it; 0 for a witness without its
                                  ///< own
    bool confirms = true;  ///< false: fitted to the positions there, so it can only contradict them
};

/// A time span (s), both ends included.
struct TimeSpan {
    double first_s = 0.0;
    double last_s = 0.0;
};

/// An independent source for the craft's displacement between two instants, one not derived from
/// the positions: recorded velocities, carrier phases, a second receiver, a wheel, gates. Each has
/// its own error model, and gives no answer about what it cannot see.
template <int Axes>
class Witness {
  public:
    virtual ~Witness() = default;

    /// Displacement from one instant (s) to a later one, on the time scale of the positions. Empty
    /// if the witness does not cover all of it.
    virtual std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const = 0;

    /// The first and the last instant (s) that it knows anything about.
    virtual TimeSpan covered() const = 0;

    /// The shortest span around two instants between which it says nothing, over which it knows the
    /// displacement. It shows an error within the window only diluted, and confirms nothing there.
    virtual std::optional<TimeSpan> enclosing(double /*from_s*/, double /*to_s*/) const {
        return std::nullopt;
    }

    /// Length (m) of the path between two instants, as uncertain as the displacement along it.
    /// Empty if the witness does not determine it.
    virtual std::optional<double> path_between(double from_s, double to_s) const = 0;
};

/// A figure by positions and the same figure by a witness, with their independent standard
/// uncertainties.
struct WitnessedFigure {
    double by_position = 0.0;
    double by_witness = 0.0;
    double uncertainty_by_position = 0.0;
    double uncertainty_by_witness = 0.0;

    double difference() const { return by_position - by_witness; }

    /// E_n at k = 2 (ISO/IEC 17043). Above 1 the two contradict each other.
    double normalised_error() const {
        return std::abs(difference()) /
               (2.0 * std::hypot(uncertainty_by_position, uncertainty_by_witness));
    }
};

/// Expected share, 0 to 1, of the positions in the difference from the witness. For two independent
/// errors with these standard deviations and a known difference, the first is expected to be this
/// fraction of it. Its variance is then that of the weighted mean: the product of the two variances
/// divided by their sum.
inline double share_of_position(double sigma_position, double sigma_witness) {
    const double of_position = sigma_position * sigma_position;
    const double of_both = of_position + sigma_witness * sigma_witness;
    return of_both > 0.0 ? of_position / of_both : 0.0;
}

}  // namespace runcert

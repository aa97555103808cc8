#pragma once

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
    /// It was calibrated by other positions of the recording, and has what lasts of their errors.
    bool calibrated_by_positions = false;
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

}  // namespace runcert

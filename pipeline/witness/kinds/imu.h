#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "inertial/inertial_smoother.h"
#include "witness/witness.h"

namespace runcert {

/// An IMU as a witness of the antenna's displacement. Of each span the positions are left out, so
/// that only those before and after align it; its error is twice that stated for carrying their
/// motion across.
///
/// It can only contradict: what the positions err by for longer than the span, it takes for motion
/// of the craft. It says nothing of spans that reach beyond its solution or across a gap in
/// positions or samples.
template <int Axes>
class ImuWitness final : public Witness<Axes> {
  public:
    /// The solution must not be empty.
    explicit ImuWitness(std::shared_ptr<const InertialSolution> solution)
        : solution_(std::move(solution)) {}

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;

    /// That of the solution's track, longer by as much as its displacement by the IMU alone is.
    std::optional<double> path_between(double from_s, double to_s) const override;

  private:
    std::shared_ptr<const InertialSolution> solution_;
};

}  // namespace runcert

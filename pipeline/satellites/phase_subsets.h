#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "satellites/phase_displacement.h"

namespace runcert {

/// Chi-squared thresholds for a given tail probability, by degrees of freedom.
class ChiSquaredBounds {
  public:
    /// Failure unless the probability is above 0 and at most 1.
    explicit ChiSquaredBounds(double probability);
    double operator()(int degrees_of_freedom) const {
        return bounds_[static_cast<std::size_t>(degrees_of_freedom)];
    }

  private:
    std::array<double, most_phase_changes + 1> bounds_{};
};

/// A slip of one satellite's phase, estimated from the residuals of a displacement.
struct EstimatedSlip {
    std::size_t satellite = 0;  ///< its index in the displacement
    double cycles = 0.0;
    double sigma_cycles = 0.0;
};

/// What is known of a satellite's phase in addition to the displacement.
struct PhaseHint {
    double wavelength_m = 0.0;
    /// Change of the phase minus that predicted by the Doppler shift, in cycles, without the part
    /// common to all satellites. Empty if unknown.
    std::optional<double> beyond_doppler_cycles = std::nullopt;
};

/// The explanation of residuals that are too large.
struct SlipSearch {
    enum class Outcome : std::uint8_t {
        slipped,    ///< by exactly one set of slips, `slips`
        disturbed,  ///< phases are disturbed by less than half a cycle, and none slipped
        unknown,    ///< several sets explain them, or none
    };
    Outcome outcome = Outcome::unknown;
    std::vector<EstimatedSlip> slips{};
};

/// Finds the satellites whose phases slipped between two epochs, where the residuals of the
/// displacement are too large. It tries all sets of one, then two, then three satellites, and keeps
/// those without which the rest passes the chi-squared test. If all their slips are too small for
/// half a cycle, nothing slipped.
///
/// Otherwise it drops sets that the Doppler shifts contradict and, if more than one is left, those
/// whose slips are not whole cycles. If exactly one set is left, it is the result.
///
/// Testing one by one ("remove the largest residual, repeat") excludes the wrong satellite in up to
/// one of seven half-cycle slips. The search over all sets does not.
SlipSearch find_slips(const PhaseDisplacement& displacement, std::span<const PhaseHint> hints,
                      const ChiSquaredBounds& bounds, double doppler_sigma_cycles);

/// The slips of a given set of at most three satellites, in ascending order, estimated from the
/// others. Empty if the others alone fail the test, or do not determine the slips.
std::optional<std::vector<EstimatedSlip>> slips_of_set(const PhaseDisplacement& displacement,
                                                       std::span<const PhaseHint> hints,
                                                       std::span<const std::size_t> set,
                                                       const ChiSquaredBounds& bounds);

/// Whether none of the slips can be half a cycle or more.
bool are_small(std::span<const EstimatedSlip> slips);

/// For each satellite of a displacement, the standard deviation (m) with which the others' phases
/// would estimate its slip. Infinite if they would not determine it.
std::vector<double> slip_deviations_m(const PhaseDisplacement& displacement);

}  // namespace runcert

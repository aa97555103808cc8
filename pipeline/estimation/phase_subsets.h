#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/phase_displacement.h"

namespace runcert {

/// What a chi-squared variable exceeds with a given probability, by its degrees of freedom.
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

/// A slip of one satellite's phase as a displacement's residuals give it.
struct EstimatedSlip {
    std::size_t satellite = 0;  ///< its number among the displacement's
    double cycles = 0.0;
    double sigma_cycles = 0.0;
};

/// What is known of a satellite's phase beside the displacement.
struct PhaseHint {
    double wavelength_m = 0.0;
    /// Change of the phase less that by the Doppler shift, in cycles, without what all satellites
    /// have in common; nothing where there is none.
    std::optional<double> beyond_doppler_cycles = std::nullopt;
};

/// What explains residuals that are too large.
struct SlipSearch {
    enum class Outcome : std::uint8_t {
        slipped,    ///< `slips`, and no other set
        disturbed,  ///< phases are disturbed by less than half a cycle: none slipped
        unknown,    ///< several sets, or none
    };
    Outcome outcome = Outcome::unknown;
    std::vector<EstimatedSlip> slips{};
};

/// Which satellites' phases slipped between two epochs whose displacement's residuals are too
/// large: of all sets of one, then two, then three satellites those without which the rest passes
/// the chi-squared test. Where all of these are too small for half a cycle, nothing slipped. Else
/// those go that the Doppler shifts contradict, and if more than one is left, those whose slips
/// are not whole cycles; if one set is left, it is the one.
///
/// One test after the other ("the largest residual out, repeat") excludes a wrong satellite in up
/// to one of seven half cycles; the search of all sets does not.
SlipSearch find_slips(const PhaseDisplacement& displacement, std::span<const PhaseHint> hints,
                      const ChiSquaredBounds& bounds, double doppler_sigma_cycles);

/// The slips of a given set of at most three satellites, ascending, by the others; nothing where
/// these do not pass the test without them, or do not tell.
std::optional<std::vector<EstimatedSlip>> slips_of_set(const PhaseDisplacement& displacement,
                                                       std::span<const PhaseHint> hints,
                                                       std::span<const std::size_t> set,
                                                       const ChiSquaredBounds& bounds);

/// Whether none of the slips can be half a cycle or more.
bool are_small(std::span<const EstimatedSlip> slips);

/// For each satellite of a displacement the deviation (m) with which the others' phases would tell
/// a slip of its own; infinite where they would not.
std::vector<double> slip_deviations_m(const PhaseDisplacement& displacement);

}  // namespace runcert

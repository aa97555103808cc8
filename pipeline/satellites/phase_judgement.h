#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "satellites/phase_pairs.h"
#include "satellites/phase_screening.h"
#include "satellites/phase_subsets.h"

namespace runcert {

/// Slips between two neighbouring epochs, according to their phases.
struct PairOutcome {
    std::vector<PhaseSlip> slips{};
    std::map<Satellite, PhaseBreak> broken{};  ///< satellites whose arcs end
    std::set<Satellite> second_broken{};       ///< satellites of which only the second band's arc
                                               ///< ends
    std::optional<PhaseRefusal> refusal{};
    std::optional<DisturbedPair> disturbed{};
    bool is_judged = false;
};

/// Judges the pair of epochs that ends at `epoch`, using the satellites tracked through both.
/// `noise` is that of the record. `has_position` says whether the receiver's position is known.
PairOutcome judge_pair(const PhasePairs& phases, std::size_t epoch, bool has_position,
                       const PhaseNoiseFigures& noise, const ChiSquaredBounds& bounds);

/// Limit on the change of the geometry-free difference (m): 4.5 standard deviations, but at least
/// the customary 50 mm, which half a cycle of either band exceeds.
double geometry_free_bound_m(const PhaseNoiseFigures& noise, double sine_of_elevation);

/// sqrt(1 + 1/sin^2 el): growth of the noise from the zenith down.
double zenith_factor(double sine_of_elevation);

}  // namespace runcert

#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "estimation/phase_pairs.h"
#include "estimation/phase_screening.h"
#include "estimation/phase_subsets.h"

namespace runcert {

/// What the phases of two neighbouring epochs say of slips between them.
struct PairOutcome {
    std::vector<PhaseSlip> slips{};
    std::map<Satellite, PhaseBreak> broken{};  ///< satellites whose arcs end
    std::set<Satellite> second_broken{};       ///< those whose second band's alone ends
    std::optional<PhaseRefusal> refusal{};
    std::optional<DisturbedPair> disturbed{};
    bool is_judged = false;
};

/// Judges the pair of epochs that ends at `epoch`, by the satellites that go on there. `noise` is
/// that of the record; `has_place`: whether it is known where the receiver was.
PairOutcome judge_pair(const PhasePairs& phases, std::size_t epoch, bool has_place,
                       const PhaseNoiseFigures& noise, const ChiSquaredBounds& bounds);

/// The bound of the change of the geometry-free difference (m): 4.5 deviations, at least the
/// customary 50 mm, which half a cycle of either band exceeds.
double geometry_free_bound_m(const PhaseNoiseFigures& noise, double sine_of_elevation);

/// sqrt(1 + 1/sin^2): how noise grows from the zenith down.
double zenith_factor(double sine_of_elevation);

}  // namespace runcert

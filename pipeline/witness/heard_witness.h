#pragma once

#include <memory>
#include <string>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/phase_motion.h"
#include "witness/witness.h"

namespace runcert {

/// A witness of a recording's positions, and which one it is.
template <int Axes>
struct HeardWitness {
    WitnessKind kind = WitnessKind::velocities;
    std::string receiver = {};  ///< id, where it is another receiver
    std::shared_ptr<const Witness<Axes>> motion;
    std::shared_ptr<const PhaseWitness<Axes>> phases = nullptr;  ///< the same, where it is that
    std::string note = {};  ///< a sentence on what was estimated of it; empty where nothing was
    /// It was made from the positions or from another witness, and says nothing of any window.
    bool is_copy = false;
    bool confirms = true;  ///< false: only a contradiction by it counts
};

template <int Axes>
using HeardWitnesses = std::vector<HeardWitness<Axes>>;

}  // namespace runcert

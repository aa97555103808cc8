#pragma once

#include "stages/check/agreement.h"

namespace runcert {

/// One profile's figures, gathered for its clauses. Speeds in m/s.
struct ClauseContext {
    const CheckInput& input;
    const Profile& profile;
    const ProfileWindows& windows;
    std::optional<Agreement> agreement = std::nullopt;  ///< where there is a second receiver
    double coverage_factor = 2.0;
    std::optional<double> expanded_uncertainty_mps = std::nullopt;
    std::optional<double> target_mps = std::nullopt;
};

/// Decides one clause by the computation it names.
Requirement decide_clause(const Clause& clause, const ClauseContext& context);

}  // namespace runcert

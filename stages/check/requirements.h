#pragma once

#include "stages/check/check.h"

namespace runcert {

/// One profile's figures, gathered for its clauses. Speeds in m/s.
struct ClauseContext {
    const CheckInput& input;
    const Profile& profile;
    const ProfileWindows& windows;
    const ProfileWindows* secondary = nullptr;
    double coverage_factor = 2.0;
    std::optional<double> expanded_uncertainty_mps = std::nullopt;
    std::optional<double> target_mps = std::nullopt;
};

/// Decides one clause by the computation it names.
Requirement decide_clause(const Clause& clause, const ClauseContext& context);

/// Normalised error of two speeds: their difference over the root sum of squares of their expanded
/// uncertainties (k = 2), all m/s. At most 1 means agreement (ISO/IEC 17043).
double normalised_error(const CertifiableWindow& a, const CertifiableWindow& b);

}  // namespace runcert

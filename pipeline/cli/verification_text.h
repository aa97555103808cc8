#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trust/run_standing.h"
#include "trust/verification.h"

namespace runcert {

/// All that `runcert verify` found.
struct VerificationResult {
    std::vector<VerificationStep> layers{};
    std::vector<Signer> signers{};
    std::optional<RunStanding> standing{};
    std::string missing_sandbox{};  ///< here, of programs of others that read the folder

    /// Every layer that was checked holds, and the signatures were checked.
    bool passed() const;
    /// The figures were computed again. What a key signs may have been written by hand.
    bool recomputed() const;
    /// "VERIFIED", "SIGNED, NOT RECOMPUTED" or "NOT VERIFIED".
    std::string verdict() const;
    /// Where each rule stands, a line each, and whose keys count.
    std::vector<std::string> standing_lines() const;
};

/// For people: a line for each layer, its details below, the verdict at the end.
std::string verification_text(const VerificationResult& result);

/// For machines, one JSON document: verdict, exit_status and its meaning, layers (passed is null
/// where nothing was checked), signers, standing.
std::string verification_json(const VerificationResult& result);

}  // namespace runcert

#pragma once

#include <filesystem>
#include <optional>

#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {

/// What is judged: a report, one signature file of it, and the time of its time stamp where that
/// holds.
struct SignatureCase {
    std::filesystem::path run_dir{};
    SignatureFile file{};
    std::optional<UtcSecond> stamped{};
};

/// Whether a signature is one of this report by a key whose signature counts, then. Failure where
/// another program that is needed is missing.
Signer judge_signature(const SignatureCase& one, const ReportFacts& report,
                       const SignatureRules& rules);

/// Whether a signature that holds, by that key, counts: by the roster, and by the time; `stamped`
/// is that of its time stamp, where it has one.
Signer judge_by_roster(Signer signer, const SshPublicKey& key, std::optional<UtcSecond> stamped,
                       const SignatureRules& rules);

}  // namespace runcert

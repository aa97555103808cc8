#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/signature.h"

namespace runcert {

/// One thing that verification looked at, and what it found.
struct VerificationStep {
    bool passed = false;
    std::string what;                  ///< "files", "chain", "signature"
    std::string finding;               ///< one sentence
    std::vector<std::string> details;  ///< one line for each file concerned
};

/// Whether every subject of RUN_DIR/report.json is there with the bytes the report names. Files of
/// the folder that the report does not name are listed in the details, and do not fail the step.
VerificationStep verify_files(const std::filesystem::path& run_dir);

/// Whether every stage file was made from the very files that the report names: the inputs in its
/// header against the report's subjects.
VerificationStep verify_chain(const std::filesystem::path& run_dir);

/// Whether RUN_DIR/report.json.minisig is a signature of report.json by that key.
VerificationStep verify_signature(const std::filesystem::path& run_dir,
                                  const std::optional<PublicKey>& key);

}  // namespace runcert

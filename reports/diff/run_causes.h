#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"

namespace runcert {

/// Something that two runs have otherwise.
struct Change {
    std::string what;  ///< "smooth.robust_scale", "recording.primary.pos"
    std::string a;
    std::string b;
    std::string note = {};  ///< how large it is, where that can be said

    bool operator==(const Change&) const = default;
};

/// Why the results of two runs may differ.
struct RunCauses {
    std::vector<Change> programs;
    std::vector<Change> inputs;
    std::vector<Change> parameters;
    std::vector<Change> attempt;  ///< but for its parameters

    bool none() const {
        return programs.empty() && inputs.empty() && parameters.empty() && attempt.empty();
    }
    bool operator==(const RunCauses&) const = default;
};

/// A run folder, and what its attempt says.
struct RunFolder {
    std::filesystem::path folder;
    Attempt attempt;
    nlohmann::ordered_json attempt_document;  ///< but for its parameters
    std::vector<std::string> products;        ///< those that are there
};

/// Failure where it is not a run folder, or holds what cannot be read.
RunFolder read_run_folder(const std::filesystem::path& folder);

/// The keys of the attempts that differ, but for their parameters.
std::vector<Change> attempt_changes(const RunFolder& a, const RunFolder& b);

/// Adds what the headers of a product in both runs say of its programs and parameters. Files of the
/// same two programs stand together; what all receivers' files say stands once.
void add_header_changes(RunCauses& causes, const std::string& product,
                        const nlohmann::ordered_json& header_a,
                        const nlohmann::ordered_json& header_b);

/// Why the results of two run folders may differ, from attempts and headers alone: no table is read
/// beyond its header, and no recording. Inputs are compared by the hashes that the headers claim,
/// so that it is those which the results were made from. Failure as `read_run_folder`.
RunCauses causes_between(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace runcert

#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/difference/declared.h"
#include "schemas/document/document.h"

namespace runcert {

/// A run folder, and what its attempt says.
struct RunFolder {
    std::filesystem::path folder;
    Attempt attempt;
    nlohmann::ordered_json attempt_document;  ///< but for its parameters
    std::vector<std::string> products = {};   ///< those that are there
};

/// Failure where it is not a run folder, or holds what cannot be read.
RunFolder read_run_folder(const std::filesystem::path& folder);

/// Files by name, each with its SHA-256 or a word for what is not there.
using HashesByName = std::map<std::string, std::string>;
/// Those that differ, by name; `absent` is said of a file that one of the two does not have.
std::vector<Change> hash_changes(const HashesByName& a, const HashesByName& b, const char* absent);

/// How the attempts differ, but for their parameters.
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

/// Compares two run folders. Failure where one is not a run folder, or holds what cannot be read.
RunDifference difference_of_runs(const std::filesystem::path& a, const std::filesystem::path& b);

/// For people: what is the same, and every difference; `all` cuts no list.
Document difference_document(const RunDifference& difference, const std::filesystem::path& a,
                             const std::filesystem::path& b, bool all);

/// For machines, complete.
nlohmann::ordered_json difference_json(const RunDifference& difference);

/// How the windows of two runs (5-windows.yaml) differ, rule by rule, with the difference
/// of speeds in units of their combined expanded uncertainty (k = 2).
std::vector<Change> window_changes(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b,
                                   const std::string& receiver);
/// The outcomes and requirements' states that differ (6-verdict.yaml).
std::vector<Change> verdict_changes(const nlohmann::ordered_json& a,
                                    const nlohmann::ordered_json& b);
/// The epochs whose state differs (3-screened.ecsv), whose names in messages are given.
EpochDifference epoch_difference(std::string_view a, std::string_view b, const std::string& where_a,
                                 const std::string& where_b);

}  // namespace runcert

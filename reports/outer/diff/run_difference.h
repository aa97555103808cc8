#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "schemas/difference/declared.h"
#include "schemas/document/document.h"

namespace runcert {

/// Why the results of two run folders may differ, from attempts and headers alone: no table is read
/// beyond its header, and no recording. Inputs are compared by the hashes that the headers claim,
/// so that it is those which the results were made from. Failure where one is not a run folder, or
/// holds what cannot be read.
RunCauses causes_between(const std::filesystem::path& a, const std::filesystem::path& b);

/// Compares two run folders, inputs by the files that are there. Failure as `causes_between`.
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

}  // namespace runcert

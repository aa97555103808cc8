#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trust/run_standing.h"

namespace runcert {

/// "nalsa/observers", its text below, as lines for a terminal.
std::string clause_heading(const DueClause& clause);
/// What was found of it, the same.
std::string clause_figures(const DueClause& clause);

/// The clauses of those names, "observers" or "nalsa/observers", in that role: of each rule that
/// has it, or of `profile` alone. Failure where there is none of a name (it says which there are),
/// and where another role answers for it.
std::vector<DueClause> chosen_clauses(const ReportFacts& report,
                                      const std::vector<std::string>& names,
                                      const std::string& profile, const std::string& role);

/// Prints what is to be attested, by role, with figures and who answered; then where each rule
/// stands. Commands name the run as `known_as`. The exit status.
int list_clauses(const std::filesystem::path& run_dir, const std::string& known_as,
                 const std::string& roster);

}  // namespace runcert

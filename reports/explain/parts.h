#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/prose.h"
#include "reports/explain/explain.h"
#include "reports/results/results.h"

// The parts of an explanation, which `explained` puts together, and the words that they share.

namespace runcert {

/// One profile of the verdict, and its rule.
struct ProfileView {
    const ProfileVerdict& verdict;
    const Profile& profile;
    const ExplainOptions& options;
};

/// One of its clauses. `clause` is null where the profile does not have it.
struct ClauseView {
    const ProfileView& of;
    const Requirement& requirement;
    const Clause* clause = nullptr;

    /// What the computation compared with, "1 m"; empty where it takes no limit.
    std::string limit() const;
    /// Who answered for it, and what.
    std::vector<std::string> answers() const;
};

/// A clause in full: text, source, computation, figures, limit, outcome.
Section clause_section(const ClauseView& view);
/// Its outcome and name; beneath them text, evidence and answers.
TableRow clause_row(const ClauseView& view);

/// How the outcome of a profile was decided, in full.
Section decision_section(const ProfileView& view);
/// Outcome, speed and reason.
Section decision_in_short(const ProfileView& view);

/// By how much the record must be beaten: "by 1 mph".
std::string margin_words(const Profile& profile);
/// How the body rounds the required speed.
std::string rounding_words(const Profile& profile);
/// The notes without those on a replaced figure, which `override_words` tells.
std::vector<std::string> notes_of(const ProfileVerdict& verdict);

}  // namespace runcert

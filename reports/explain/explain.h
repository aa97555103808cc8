#pragma once

#include <map>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/document/document.h"
#include "schemas/profile/profile.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// What is to be explained.
struct ExplainOptions {
    /// A clause's id ("flat-course"), also with its profile ("nalsa/flat-course"); "outcome" or
    /// "decision"; empty: every clause in short.
    std::string clause;
    std::string profile;  ///< id of the one profile to look at; empty: all
    /// Of "PROFILE/CLAUSE", what became of it and who answered, a line each.
    std::map<std::string, std::vector<std::string>> answers = {};
    std::string vouched_by = {};  ///< by whose roster the verdict's standing counts, see outcome.h
    Windows windows = {};         ///< of the judged receiver, where they are there
};

/// The verdict in plain words: one clause of the rules in full, or the decision, or all in short.
/// `profiles` are those of the verdict, with the figures that the attempt put in place of theirs.
///
/// Failure for a clause or profile that the verdict does not have, naming those that it has; and
/// where a profile of the verdict is not among `profiles`.
Document explained(const Attempt& attempt, const Verdict& verdict,
                   const std::vector<Profile>& profiles, const ExplainOptions& options = {});

/// A table, in Markdown, of every field of an attempt that can change what is certified: who says
/// it, what it can change, and the clauses in which an official answers for it, with the role. A
/// field that does not stand here has what the one that it is in has.
std::string inputs_table_text();

/// Id, title and body of each, what it averages over, and until when its texts were looked at.
Document profiles_document(const std::vector<Profile>& profiles);

/// A table, in Markdown, of where every clause of these rules is known from: source, edition,
/// place, certainty and what decides it; also of what is not known of them, and, last, of the
/// clauses that this program asks under every rule.
std::string citations_text(const std::vector<Profile>& profiles);

}  // namespace runcert

#pragma once

#include "stages/check/requirements.h"

namespace runcert {

/// The clauses that are asked under a rule: its own, and of this program's those that it does not
/// ask itself and for which the attempt states or hands in something.
std::vector<Clause> clauses_asked(const Profile& profile, const Attempt& attempt);

/// The ids of the clauses in which an official answers for an input under a rule; none for what the
/// rule does not look at.
std::vector<std::string> clauses_answering(const AttemptInput& input, const Profile& profile,
                                           const Attempt& attempt);

/// What the attempt states or hands in, and nobody observed, that an official answers for in that
/// clause.
std::vector<AttemptInput> inputs_answered_in(const Clause& clause, const ClauseContext& context);

/// Inputs with their values, as evidence.
std::string stated_text(const std::vector<AttemptInput>& inputs);

/// All inputs of an attempt, with the clauses in which they are answered for.
std::vector<VerdictInput> verdict_inputs(const CheckInput& input);

}  // namespace runcert

#pragma once

#include <string>
#include <vector>

#include "reports/explain/explain.h"
#include "reports/results/results.h"

// The parts of an explanation, which `explained` puts together, and the words that they share.

namespace runcert {

/// A clause of a rule. `clause` is null where the rule does not have it.
struct ClauseView {
    const RuleView& of;
    const ExplainOptions& options;
    const Requirement& requirement;
    const Clause* clause = nullptr;

    /// What the computation compared with, "1 m"; empty where it takes no limit.
    std::string limit() const;
    /// Who answered for it, and what.
    std::vector<std::string> answers() const;
};

/// A clause in full: text, source, computation, figures, limit, outcome.
Section clause_section(const ClauseView& view);

}  // namespace runcert

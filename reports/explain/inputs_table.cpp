#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "reports/explain/explain.h"
#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

/// A clause of this program's own, and who answers for it.
std::string with_role(const Clause& own) {
    return fmt::format("{} ({})", own.id, own.answered_by.role);
}

/// The clause of this program's own that the computation decides, or what a rule's is about.
std::string clause_by(const std::string& computation) {
    for (const Clause& own : own_clauses())
        if (to_text(own.decided_by) == computation) return with_role(own);
    return fmt::format("the rule's by `{}`", computation);
}

std::string answered_in(const FieldOrigin& origin) {
    std::vector<std::string> clauses;
    for (const std::string& computation : origin.decides)
        clauses.push_back(clause_by(computation));
    for (const Clause& own : own_clauses())
        if (own.id == origin.clause)
            clauses.push_back((clauses.empty() ? "" : "else ") + with_role(own));
    return fmt::format("{}", fmt::join(clauses, ", "));
}

}  // namespace

std::string inputs_table_text() {
    std::string text =
        "| input | origin | can change | answered for in (by) |\n|---|---|---|---|\n";
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!rule.origin || rule.origin->changes.empty()) continue;
        std::string origin = rule.origin->origin;
        std::ranges::replace(origin, '_', ' ');
        text += fmt::format("| `{}` | {} | {} | {} |\n", rule.path, origin,
                            fmt::join(rule.origin->changes, ", "), answered_in(*rule.origin));
    }
    return text;
}

}  // namespace runcert

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "reports/explain/explain.h"
#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

/// The clause of this program's own that the computation decides, or what a rule's is about.
std::string clause_by(const std::string& computation) {
    for (const Clause& own : own_clauses())
        if (to_text(own.decided_by) == computation) return own.id;
    return fmt::format("the rule's by `{}`", computation);
}

std::string answered_in(const FieldOrigin& origin) {
    std::vector<std::string> clauses;
    for (const std::string& computation : origin.decides)
        clauses.push_back(clause_by(computation));
    if (!origin.clause.empty())
        clauses.push_back(clauses.empty() ? origin.clause : "else " + origin.clause);
    return fmt::format("{}", fmt::join(clauses, ", "));
}

}  // namespace

std::string inputs_table_text() {
    std::string text = "| input | origin | can change | answered for in |\n|---|---|---|---|\n";
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

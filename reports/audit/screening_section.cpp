#include <fmt/format.h>

#include "reports/audit/screening_parts.h"

namespace runcert {

Section screening_section(const ScreenedTable& table, const AuditSubject& subject, bool all) {
    return {.title = fmt::format("Audit of screening: attempt {}, receiver {}, recording {}",
                                 subject.attempt, table.facts.receiver, subject.recording),
            .blocks = basis_blocks(table, subject),
            .parts = {
                {.title = "Decisions", .blocks = decision_blocks(table, subject, all)},
                {.title = "Minimal detectable biases", .blocks = smallest_blocks(table, subject)}}};
}

}  // namespace runcert

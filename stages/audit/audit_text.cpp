#include <fmt/format.h>

#include "core/text.h"
#include "stages/audit/parts.h"
#include "stages/audit/words.h"

namespace runcert {

bool holds_evidence(const ScreenedTable& table) {
    const std::string& version = table.header.schema_version;
    const auto revision = parse_integer(version.substr(version.find('.') + 1));
    return table.evidence.has_value() || (revision && *revision >= 2);
}

std::string audit_text(const ScreenedTable& table, const AuditSubject& subject, bool all) {
    const std::string title =
        wrapped(fmt::format("Audit of screening: attempt {}, receiver {}, recording {}",
                            subject.attempt, table.facts.receiver, subject.recording));
    return fmt::format("{}\n{}\n{}\n{}", title, basis_text(table, subject),
                       decisions_text(table, subject, all), smallest_text(table));
}

}  // namespace runcert

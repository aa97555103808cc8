#pragma once

#include <string>

#include "stages/audit/audit.h"

// The three parts of an audit; `audit_text` puts them together.

namespace runcert {

/// What the tests rested on, and what they found over the whole recording.
std::string basis_text(const ScreenedTable& table, const AuditSubject& subject);

/// Every decision with its rows in the recording.
std::string decisions_text(const ScreenedTable& table, const AuditSubject& subject, bool all);

/// The smallest errors that could be found, and what they would do to a speed.
std::string smallest_text(const ScreenedTable& table);

/// Whether the table's revision holds evidence: 1.2 and later.
bool holds_evidence(const ScreenedTable& table);

}  // namespace runcert

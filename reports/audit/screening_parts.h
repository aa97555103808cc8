#pragma once

#include <string>
#include <vector>

#include "reports/audit/screening.h"
#include "reports/audit/walk.h"

// The parts of the audit of screening; `screening_section` puts them together.

namespace runcert {

/// What the tests rested on, and what they found over the whole recording.
std::vector<Block> basis_blocks(const ScreenedTable& table, const AuditSubject& subject);

/// Every decision with its rows in the recording.
std::vector<Block> decision_blocks(const ScreenedTable& table, const AuditSubject& subject,
                                   bool all);

/// Why the rows of an entry were left out, without the statistic.
std::string left_out_text(const ScreenedTable& table, const AuditEntry& entry);

/// What the break before a row is, and which arcs it parts, without the statistic.
std::string break_text(const std::vector<ScreenedEpoch>& rows, std::size_t at);

/// Whether the test of a row is that of the break before it.
bool explains_break(const ScreenedEpoch& row);

/// The minimal detectable biases, and what they would do to a speed.
std::vector<Block> smallest_blocks(const ScreenedTable& table, const AuditSubject& subject);

}  // namespace runcert

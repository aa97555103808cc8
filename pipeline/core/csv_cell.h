#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// A text as one cell of a CSV file (RFC 4180), quoted where it must be. One that a spreadsheet
/// would take for a formula gets an apostrophe before it (OWASP, "CSV Injection").
std::string csv_cell(std::string_view text);

}  // namespace runcert

#pragma once

#include <string>

#include "schemas/day_results/day_results.h"

namespace runcert {

/// The day as a table for spreadsheets: CSV (RFC 4180 with LF), UTF-8, one row for each attempt and
/// rule, one for each attempt without any. Numbers are full figures, units in the columns' names.
/// Text that a spreadsheet would take for a formula gets an apostrophe before it.
std::string day_csv(const DayResults& results);

/// The day as one page that needs nothing else: no network, no other file, no script to be read
/// (with one, tables sort). It computes nothing but where to draw: every figure stands in the
/// results. Everything from outside is escaped.
std::string day_page(const DayResults& results);

}  // namespace runcert

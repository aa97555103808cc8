#pragma once

#include <string>
#include <string_view>

#include "core/prose.h"
#include "reports/words/figures.h"

// The words that the parts of an explanation share.

namespace runcert {

/// "  Its source        headings of a published report": a line of a block, with its label.
std::string labelled(std::string_view label, std::string_view text);

/// "NOT MET  nalsa/flat-course": the first line of a block, its outcome in capitals.
std::string heading(std::string_view outcome, std::string_view text);

}  // namespace runcert

#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace runcert {

/// The bytes of report.json: JSON, UTF-8, indented by 2, lists of plain numbers on one line, a line
/// end at its end. `<`, `>` and `&` are written as escapes, so that the text can stand in a page as
/// it is.
std::string report_text_of(const nlohmann::ordered_json& report);

}  // namespace runcert

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "reports/figures.h"

namespace runcert {

/// The report as one self-contained page, style and figures inside, for screen and A4 paper. It
/// shows texts and figures of the report alone, escaped; nothing is computed here.
std::string report_html(const nlohmann::ordered_json& report, const std::vector<Figure>& figures);

}  // namespace runcert

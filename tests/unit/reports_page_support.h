#pragma once

#include <string>
#include <vector>

#include "reports/certificate/report_html.h"

namespace runcert {

/// Something in the place of each drawing.
inline std::vector<std::string> drawings_of(const nlohmann::ordered_json& report) {
    return std::vector<std::string>(report["predicate"]["figures"].size(), "<svg>1</svg>");
}

/// The page for paper, with nothing to be seen in its figures.
inline std::string print_page(const nlohmann::ordered_json& report,
                              const std::vector<SignatureText>& signatures = {}) {
    return report_print_page(report, drawings_of(report), signatures);
}

}  // namespace runcert

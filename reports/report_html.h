#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "reports/figures.h"

namespace runcert {

/// A signature that the page names, as a claim: it is not checked here.
struct ReportSigner {
    std::string key_id;           ///< as key_id_text prints it
    std::string trusted_comment;  ///< what is signed along with the report
};

/// Key id and trusted comment of the text of a signature file. `where` names it in messages.
/// Failure where it is not a signature file.
ReportSigner read_signer(std::string_view signature_file_text, const std::string& where);

/// The report as one self-contained page, style and figures inside, for screen and A4 paper. It
/// shows texts and figures of the report alone, escaped; nothing is computed here. Without signers
/// the page says UNSIGNED all over.
std::string report_html(const nlohmann::ordered_json& report,
                        const std::vector<DrawnFigure>& figures,
                        const std::vector<ReportSigner>& signers);

}  // namespace runcert

#pragma once

#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "trust/run_standing.h"
#include "trust/signature_files.h"

namespace runcert {

/// A signature that the page names, as a claim: it is not checked here.
struct ReportSigner {
    std::string file;
    std::string key_id;  ///< minisign's; of an ssh signature its key's SHA-256
    std::string role;    ///< empty where the signature names none
    std::string time;    ///< as the signer states it; ssh has none
};

/// What the text of a signature file says of its signer. Failure where it is not a signature file.
ReportSigner read_signer(const SignatureFile& signature);

/// The member `page` of a report: SHA-256 of the templates, the style and the script that every
/// page of this program is made of. A page's Content-Security-Policy admits that script alone.
nlohmann::ordered_json page_parts_json();

/// The report as one self-contained page for the screen: it carries `report_text`, the bytes of
/// report.json, with the signatures, which the reader's browser checks. It shows
/// texts and figures of the report alone, escaped and drawn; nothing else is computed here. Without
/// signatures the page says UNSIGNED. `standing` is the text of a standing_json, which it carries
/// too, and which is not signed.
std::string report_page(const std::string& report_text, const nlohmann::ordered_json& report,
                        const std::vector<SignatureFile>& signatures,
                        const std::string& standing = "{}\n");

/// The same content for A4 paper, without what only a browser uses; if so, the first page alone,
/// which is the certificate.
std::string report_print_page(const std::string& report_text, const nlohmann::ordered_json& report,
                              const std::vector<SignatureFile>& signatures,
                              const std::string& standing = "{}\n", bool first_page_alone = false);

/// What a page shows of a standing in place of what report.json says, which was written before the
/// first answer: under `slots`, by the name of its place, the block that stands there now, of the
/// `predicate`'s document. The page carries it too.
/// Empty where nobody answered and no roster was given: the page is then that of report.json.
nlohmann::ordered_json standing_json(const RunStanding& standing,
                                     const nlohmann::ordered_json& predicate);

}  // namespace runcert

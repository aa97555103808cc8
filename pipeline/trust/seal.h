#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// What poppler's `pdfsig` says of a PDF's signature.
struct SealCheck {
    bool present = false;         ///< whether there is a signature at all
    bool valid = false;           ///< whether there is one, and its mathematics hold
    bool whole_document = false;  ///< whether it covers every byte of the file
    std::string signer = {};      ///< common name in its certificate: a claim
    std::string type = {};        ///< the PDF's SubFilter: "adbe.pkcs7.detached", ...
    std::string words = {};       ///< all of it in one sentence

    bool holds() const { return valid && whole_document; }
};

/// Checks the signature of a PDF with `pdfsig`. Only the mathematics are checked: whether the
/// certificate is whose it says, still good or revoked is not, and no network is used. More than
/// one signature is not valid: a report has one. Failure where the file is no readable PDF, or
/// `pdfsig` (package poppler-utils) is missing.
SealCheck check_seal(const std::filesystem::path& pdf);

/// The same from the output of `pdfsig -nocert` (22.12) on a file of that many bytes. Its exit
/// status is 0 for a broken signature too, so the words decide. Names in them come from the file:
/// a line that is missing, repeated, unknown or out of order makes the seal not valid.
SealCheck seal_from_words(std::string_view output, std::uint64_t file_bytes);

/// What a program of poppler (package poppler-utils) says of a PDF, whose name stands behind the
/// words of the command and before `more`; what it writes goes into `folder`. Failure where it
/// cannot read the PDF, or is missing.
std::string poppler(std::vector<std::string> command, const std::filesystem::path& pdf,
                    const std::vector<std::string>& more = {},
                    const std::filesystem::path& folder = {});

/// Why a PDF does not carry this report.json and no other file, in words; nothing where it does.
/// Failures as of `poppler`.
std::optional<std::string> fault_of_attachment(const std::filesystem::path& pdf,
                                               const std::string& report_text);

/// What a sealed PDF holds beside `own` and what podofosign 0.9.8 adds, in words; or nothing.
std::optional<std::string> fault_under_seal(std::string_view sealed, std::string_view own);

/// Signs RUN_DIR/report.pdf with PoDoFo's `podofosign` (package libpodofo-utils), checks the
/// result, and only then replaces the PDF. `reason` is put into the signature, visible to readers.
///
/// Failure where the PDF is missing, sealed already, or does not carry this folder's report.json;
/// where the key is encrypted, readable by others, neither RSA nor ECDSA, weaker than RSA of 3072
/// bits or P-256, or not the certificate's; where the certificate has expired; and where the seal
/// made does not hold.
SealCheck seal_report(const std::filesystem::path& run_dir, const std::filesystem::path& key,
                      const std::filesystem::path& certificate, const std::string& reason);

}  // namespace runcert

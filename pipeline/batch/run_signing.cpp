#include "batch/run_making.h"
#include "core/failure.h"
#include "files/sha256.h"
#include "trust/bundle.h"
#include "trust/signable.h"
#include "trust/signature_files.h"
#include "trust/signing.h"
#include "trust/trusted_comment.h"

namespace runcert {
namespace {

/// A run folder with other files in it does not verify, whoever signs its report.
void require_no_strangers(const std::filesystem::path& run_dir) {
    std::vector<std::string> strangers = unknown_files(run_dir);
    std::erase(strangers, superseded_folder);
    if (strangers.empty()) return;
    throw Failure((run_dir / strangers.front()).string(),
                  "this is no part of the run; nothing was signed",
                  "Move it out of the folder, and run the batch again");
}

/// The signature of this very report that the key made before in that role: it and its time stamp
/// stay, whatever is known of the run's making.
std::optional<std::string> own_signature(const std::filesystem::path& folder,
                                         const ReportFacts& report, const PublicKey& key,
                                         const std::string& role) {
    for (const SignatureFile& file : signature_files(folder)) {
        if (file.kind != SignatureKind::minisign) continue;
        try {
            const SignatureCheck check = check_signature(report.text, file.text, key, file.name);
            if (check.valid && parse_trusted_comment(check.trusted_comment).role == role)
                return file.name;
        } catch (const Failure&) {
            // No signature, whatever it is.
        }
    }
    return std::nullopt;
}

}  // namespace

/// Signs the report that the steps so far made or kept, in the work folder, and returns the name of
/// the signature. A file that was changed since it was hashed is not signed.
std::string RunMaking::sign() {
    bring_signatures();
    const std::filesystem::path& folder = files_.work_dir();
    const ReportFacts report = read_report_facts(folder);
    if (sha256_hex(report.text) != current_.at("report.json"))
        throw Failure((folder / "report.json").string(),
                      "the report changed while the run was made; nothing was signed",
                      "Find out who writes into the folder, and run the batch again");
    require_signable(folder, report, "Make the run again with --force");
    if (files_.is_published("report.json", current_.at("report.json")))
        require_no_strangers(files_.run_dir());
    const std::string role = signing_role(claim_.attempt);
    if (auto standing = own_signature(folder, report, public_key_of(*context_.key), role))
        return *standing;
    state_.signs = what_is_signed(folder);
    return sign_report(folder, report, *context_.key, role);
}

}  // namespace runcert

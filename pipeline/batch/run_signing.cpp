#include <fmt/format.h>

#include "batch/run_making.h"
#include "core/failure.h"
#include "core/plain_text.h"
#include "files/atomic_file.h"
#include "files/sha256.h"
#include "reports/words/figures.h"
#include "reports/words/outcome.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/verdict.h"
#include "trust/bundle.h"
#include "trust/signature_files.h"
#include "trust/signing.h"
#include "trust/trusted_comment.h"
#include "trust/verification.h"

namespace runcert {
namespace {

/// Whoever signs answers for these very files: what signing alone refuses, a day's signing does.
void require_signable(const std::filesystem::path& folder, const ReportFacts& report) {
    for (const VerificationStep& step :
         {verify_files(folder, report), verify_chain(folder, report),
          verify_schemas(folder, report), verify_rules(folder), verify_report(folder, report)}) {
        if (step.passed) continue;
        std::string details;
        for (const std::string& detail : step.details)
            details += (details.empty() ? ": " : "; ") + detail;
        throw Failure(folder.string(), step.finding + details,
                      "Nothing was signed. Make the run again with --force");
    }
}

/// A run folder with other files in it does not verify, whoever signs its report.
void require_no_strangers(const std::filesystem::path& run_dir) {
    std::vector<std::string> strangers = unknown_files(run_dir);
    std::erase(strangers, superseded_folder);
    if (strangers.empty()) return;
    throw Failure((run_dir / strangers.front()).string(),
                  "this is no part of the run; nothing was signed",
                  "Move it out of the folder, and run the batch again");
}

/// What is signed of each rule: its text, speed, uncertainty and outcome.
std::vector<std::string> what_is_signed(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / products::verdict_file;
    std::vector<std::string> lines;
    for (const ProfileVerdict& verdict : read_verdict(read_file(file), file.string()).profiles)
        lines.push_back(plain_text(fmt::format(
            "{}: {}{}", rule_identity_text(verdict),
            verdict.shown ? measured_speed_text(*verdict.shown, verdict.coverage_factor) + "; "
                          : std::string(),
            outcome_words(state_of(verdict)).title)));
    return lines;
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
    require_signable(folder, report);
    if (files_.is_published("report.json", current_.at("report.json")))
        require_no_strangers(files_.run_dir());
    const std::string role = signing_role(claim_.attempt);
    if (auto standing = own_signature(folder, report, public_key_of(*context_.key), role))
        return *standing;
    state_.signs = what_is_signed(folder);
    return sign_report(folder, report, *context_.key, role);
}

}  // namespace runcert

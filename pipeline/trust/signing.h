#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "trust/signature.h"
#include "trust/verification.h"

namespace runcert {

/// Reads a secret key. An encrypted one asks for its password on the terminal, without showing
/// it, or reads it from standard input where there is no terminal. Failure where the file is
/// another kind of key (it says which), where others than its owner can read it, and where the
/// password is wrong.
SecretKey load_secret_key(const std::filesystem::path& path);

/// Asks twice for a new password in the same way.
std::string ask_new_password();

/// The role a signature is made in: that of the first official the attempt names. Failure where
/// that is no role to sign in.
std::string signing_role(const Attempt& attempt);

/// Signs RUN_DIR/report.json and returns the name of the signature file: report.json.minisig, or
/// where another signer has that, report.json.ROLE.minisig, report.json.ROLE.2.minisig and so on.
/// The same key signing in the same role again replaces its own; what it replaces goes to
/// superseded/. The trusted comment names the report, the signer's role and key, the time, and
/// whether the signer left out to recompute. Failure where the role cannot be one, and where
/// report.json is no longer the `report` that was read, and perhaps checked, before.
std::string sign_report(const std::filesystem::path& run_dir, const ReportFacts& report,
                        const SecretKey& key, const std::string& role, bool recomputed = true);

/// Failure, with what was found, where a layer of verification did not pass: whoever signs answers
/// for these very files. `remedy` says what to do, after "Nothing was signed."
void require_passed(const std::filesystem::path& run_dir, const VerificationStep& step,
                    const std::string& remedy);

/// The same for the layers files, chain, schemas, rules and report.
void require_signable(const std::filesystem::path& run_dir, const ReportFacts& report,
                      const std::string& remedy);

/// What a signature of the run answers for, a line for each rule: its text, speed, uncertainty and
/// outcome. Failure where the verdict cannot be read.
std::vector<std::string> what_is_signed(const std::filesystem::path& run_dir);

}  // namespace runcert

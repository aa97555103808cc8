#pragma once

#include <filesystem>
#include <string>

#include "schemas/attempt/attempt.h"
#include "trust/report_facts.h"
#include "trust/signature.h"

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
/// The same key signing in the same role again replaces its own. The trusted comment names the
/// report, the role and the key of the signer, the time of signing, and whether the signer left out
/// to recompute. What it replaces goes to superseded/. Failure where the role is
/// none, and where report.json is no longer the `report` that was read, and perhaps checked,
/// before.
std::string sign_report(const std::filesystem::path& run_dir, const ReportFacts& report,
                        const SecretKey& key, const std::string& role, bool recomputed = true);

}  // namespace runcert

#pragma once

#include <filesystem>
#include <string>

#include "files/signature.h"
#include "schemas/attempt/attempt.h"

namespace runcert {

/// Reads a secret key. An encrypted one asks for its password on the terminal, without showing
/// it, or reads it from standard input where there is no terminal.
SecretKey load_secret_key(const std::filesystem::path& path);

/// Asks twice for a new password in the same way.
std::string ask_new_password();

/// The role a signature is made in: that of the first official the attempt names.
std::string signing_role(const Attempt& attempt);

/// Signs RUN_DIR/report.json into RUN_DIR/report.json.minisig. The trusted comment names the
/// report, the role of the signer and the time of signing.
void sign_report(const std::filesystem::path& run_dir, const SecretKey& key,
                 const std::string& role);

}  // namespace runcert

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "trust/signature.h"
#include "trust/verification.h"

// Other statements than those about a report: receipts of recordings, heads of a log. Each is an
// in-toto statement in a DSSE envelope, as an attestation is (attestation.h).

namespace runcert {

/// What an official states in a role.
struct SignedStatement {
    nlohmann::ordered_json subject = nlohmann::ordered_json::array();  ///< named, with their hashes
    nlohmann::ordered_json facts = nlohmann::ordered_json::object();   ///< of the statement's type
    std::string role{};
    std::string key{};   ///< as `minisign -P` takes it
    std::string time{};  ///< by the signer's clock, "2026-11-21T20:41:50Z"
};

/// The text of the envelope of a statement, one line of JSON, by this key at the clock's time.
std::string sign_statement(SignedStatement statement, std::string_view type, const SecretKey& key);

/// Reads such a text. Failure where it is no envelope of a statement of that type, holds another
/// byte than is written, or was not signed by the key that it names. `what` calls it in messages.
/// Whose key that is, a roster says.
SignedStatement read_statement_of(std::string_view text, std::string_view type,
                                  const std::string& what, const std::string& where);

/// Who signed it, as judged by a roster: `stamped` is the time of its time stamp, if it has one
/// that holds.
Signer judge_statement(const SignedStatement& statement, const std::string& file,
                       std::optional<UtcSecond> stamped, const SignatureRules& rules);

/// "judge (J. Doe), 2026-11-21T20:41:50Z; its key is not on the roster".
std::string signer_words(const Signer& signer);

}  // namespace runcert

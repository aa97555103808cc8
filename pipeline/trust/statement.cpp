#include "trust/statement.h"

#include <fmt/format.h>

#include <chrono>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/role_signatures.h"
#include "store/utc_second.h"
#include "trust/attestation.h"
#include "trust/ssh_signature.h"

namespace runcert {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson payload_of(const SignedStatement& statement, std::string_view type) {
    OrderedJson predicate = statement.facts;
    predicate["role"] = statement.role;
    predicate["key"] = statement.key;
    predicate["time"] = statement.time;
    return {{"_type", statement_type},
            {"subject", statement.subject},
            {"predicateType", type},
            {"predicate", std::move(predicate)}};
}

}  // namespace

std::string sign_statement(SignedStatement statement, std::string_view type, const SecretKey& key) {
    statement.key = public_key_line(public_key_of(key));
    statement.time =
        iso_text(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
    return sign_envelope(payload_of(statement, type).dump(), key);
}

SignedStatement read_statement_of(std::string_view text, std::string_view type,
                                  const std::string& what, const std::string& where) {
    const auto refuse = [&](const std::string& problem) {
        throw Failure(where, problem, "Use the file as it was made, whole and unchanged");
    };
    const Envelope envelope = read_envelope(text, where);
    SignedStatement statement;
    try {
        const OrderedJson json = OrderedJson::parse(envelope.payload);
        statement.subject = json.at("subject");
        statement.facts = json.at("predicate");
        for (const auto& [name, part] : {std::pair("role", &statement.role),
                                         {"key", &statement.key},
                                         {"time", &statement.time}}) {
            *part = statement.facts.at(name).get<std::string>();
            statement.facts.erase(name);
        }
        if (payload_of(statement, type).dump() != envelope.payload) statement.role.clear();
    } catch (const nlohmann::json::exception&) {
        statement.role.clear();
    }
    if (!is_role(statement.role) || !parse_iso_utc(statement.time))
        refuse(fmt::format("it is no {} as runcert writes one", what));
    if (!envelope_holds(envelope, parse_public_key(statement.key, where)))
        refuse(fmt::format("the {} was not signed by the key that it names", what));
    return statement;
}

Signer judge_statement(const SignedStatement& statement, const std::string& file,
                       std::optional<UtcSecond> stamped, const SignatureRules& rules) {
    return judge_by_roster(
        {.file = file, .role = statement.role, .key = statement.key, .stated_time = statement.time},
        ssh_key_of(parse_public_key(statement.key, file).key), stamped, rules);
}

std::string signer_words(const Signer& signer) {
    return plain_text(fmt::format("{}{}, {}{}", signer.role,
                                  signer.who.empty() ? "" : fmt::format(" ({})", signer.who),
                                  signer.stated_time, signer.valid ? "" : "; " + signer.reason));
}

}  // namespace runcert

#include "trust/envelope.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "files/base64.h"
#include "trust/signature_text.h"
#include "trust/ssh_key.h"

namespace runcert {
namespace {

using OrderedJson = nlohmann::ordered_json;
using signature_text::data_of;

std::string envelope_text(const Envelope& envelope) {
    const OrderedJson json{
        {"payloadType", statement_payload_type},
        {"payload", base64(envelope.payload)},
        {"signatures",
         OrderedJson::array({{{"keyid", envelope.key_id},
                              {"sig", signature_text::base64_of(envelope.signature.data(),
                                                                envelope.signature.size())}}})}};
    return json.dump(-1, ' ', true) + "\n";
}

}  // namespace

std::string dsse_bytes(std::string_view payload_type, std::string_view payload) {
    return fmt::format("DSSEv1 {} {} {} {}", payload_type.size(), payload_type, payload.size(),
                       payload);
}

std::string sign_envelope(std::string_view payload, const SecretKey& key) {
    signature_text::start_libsodium();
    Envelope envelope{.payload = std::string(payload), .key_id = key_id_text(public_key_of(key))};
    const std::string bytes = dsse_bytes(statement_payload_type, payload);
    crypto_sign_detached(envelope.signature.data(), nullptr, data_of(bytes), bytes.size(),
                         key.bytes().data());
    return envelope_text(envelope);
}

Envelope read_envelope(std::string_view text, const std::string& where) {
    Envelope envelope;
    try {
        const OrderedJson json = OrderedJson::parse(text);
        const OrderedJson& signature = json.at("signatures").at(0);
        const std::string payload = json.at("payload").get<std::string>();
        envelope.key_id = signature.at("keyid").get<std::string>();
        const std::string bytes =
            signature_text::bytes_of_base64(signature.at("sig").get<std::string>(),
                                            envelope.signature.size(), "the signature", where);
        std::ranges::copy(bytes, envelope.signature.begin());
        envelope.payload = decode_base64(payload).value_or("");
        if (envelope_text(envelope) == text) return envelope;
    } catch (const nlohmann::json::exception&) {
        // Said below, as of any other text.
    }
    throw Failure(where, "it is no envelope as runcert writes one",
                  "Use the file as it was made, whole and unchanged");
}

bool envelope_holds(const Envelope& envelope, const PublicKey& key) {
    signature_text::start_libsodium();
    const std::string bytes = dsse_bytes(statement_payload_type, envelope.payload);
    return crypto_sign_verify_detached(envelope.signature.data(), data_of(bytes), bytes.size(),
                                       key.key.data()) == 0;
}

}  // namespace runcert

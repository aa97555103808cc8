#include "trust/attestation.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "store/base64.h"
#include "store/sha256.h"
#include "trust/signature_text.h"
#include "trust/ssh_signature.h"

namespace runcert {
namespace {

using OrderedJson = nlohmann::ordered_json;

using signature_text::data_of;

/// Types of what is said of the report: answers, the files that a closing statement names, and a
/// board's "recomputed and agreed", which is in-toto's simple verification result.
constexpr std::string_view answers_type = "urn:runcert:attestation:1.0";
constexpr std::string_view closing_type = "urn:runcert:closing:1.0";
constexpr std::string_view recomputed_type = "https://in-toto.io/attestation/svr/v0.2";

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

constexpr const char* recomputed_property = "RUNCERT_RECOMPUTED_AND_AGREED";

OrderedJson file_json(const EvidenceFile& file) {
    return {{"name", file.name}, {"digest", {{"sha256", file.sha256}}}};
}

OrderedJson files_json(const std::vector<EvidenceFile>& files) {
    OrderedJson list = OrderedJson::array();
    for (const EvidenceFile& file : files)
        list.push_back(file_json(file));
    return list;
}

EvidenceFile read_file_entry(const OrderedJson& json) {
    return {.name = json.at("name").get<std::string>(),
            .sha256 = json.at("digest").at("sha256").get<std::string>()};
}

std::vector<EvidenceFile> read_files(const OrderedJson& json) {
    std::vector<EvidenceFile> files;
    for (const OrderedJson& one : json)
        files.push_back(read_file_entry(one));
    return files;
}

/// What both kinds say besides: in a simple verification result it is an extension.
OrderedJson signer_json(const Attestation& attestation) {
    return {{"report_id", attestation.report_id},
            {"attempt", attestation.attempt_id},
            {"role", attestation.role},
            {"key", attestation.key},
            {"statement", attestation.statement},
            {"evidence", files_json(attestation.evidence)},
            {"after", files_json(attestation.after)}};
}

void read_signer(const OrderedJson& json, Attestation& attestation) {
    json.at("report_id").get_to(attestation.report_id);
    json.at("attempt").get_to(attestation.attempt_id);
    json.at("role").get_to(attestation.role);
    json.at("key").get_to(attestation.key);
    json.at("statement").get_to(attestation.statement);
    attestation.evidence = read_files(json.at("evidence"));
    attestation.after = read_files(json.at("after"));
}

OrderedJson answers_json(const Attestation& attestation) {
    OrderedJson json = signer_json(attestation);
    json["time"] = attestation.time;
    if (attestation.on_paper) json["on_paper"] = file_json(*attestation.on_paper);
    if (attestation.is_closing()) json["closes"] = files_json(attestation.closes);
    for (const Answer& one : attestation.answers)
        json["answers"].push_back({{"profile", one.profile},
                                   {"clause", one.clause},
                                   {"text", one.text},
                                   {"shown", one.shown},
                                   {"answer", one.answer}});
    return json;
}

void read_answers(const OrderedJson& json, Attestation& attestation) {
    json.at("time").get_to(attestation.time);
    if (json.contains("on_paper")) attestation.on_paper = read_file_entry(json.at("on_paper"));
    if (json.contains("closes")) attestation.closes = read_files(json.at("closes"));
    for (const OrderedJson& one : json.value("answers", OrderedJson::array()))
        attestation.answers.push_back({.profile = one.at("profile").get<std::string>(),
                                       .clause = one.at("clause").get<std::string>(),
                                       .text = one.at("text").get<std::string>(),
                                       .shown = one.at("shown").get<std::string>(),
                                       .answer = one.at("answer").get<std::string>()});
    read_signer(json, attestation);
}

OrderedJson recomputed_json(const Attestation& attestation) {
    return {{"verifier",
             {{"id", "urn:runcert:role:" + attestation.role},
              {"policies", files_json(attestation.policies)}}},
            {"timeCreated", attestation.time},
            {"properties", OrderedJson::array({recomputed_property})},
            {"runcert", signer_json(attestation)}};
}

void read_recomputed(const OrderedJson& json, Attestation& attestation) {
    attestation.policies = read_files(json.at("verifier").at("policies"));
    json.at("timeCreated").get_to(attestation.time);
    read_signer(json.at("runcert"), attestation);
}

bool is_sound(const Attestation& attestation) {
    return std::ranges::all_of(attestation.answers, [](const Answer& one) {
        return one.answer == answer_yes || one.answer == answer_no ||
               one.answer == answer_withdrawn;
    });
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

std::string statement_text(const Attestation& attestation) {
    const bool recomputed = attestation.is_recomputed();
    const OrderedJson statement{
        {"_type", statement_type},
        {"subject", OrderedJson::array({file_json({"report.json", attestation.report_sha256})})},
        {"predicateType", recomputed                 ? recomputed_type
                          : attestation.is_closing() ? closing_type
                                                     : answers_type},
        {"predicate", recomputed ? recomputed_json(attestation) : answers_json(attestation)}};
    return statement.dump();
}

Attestation read_statement(std::string_view payload, const std::string& where) {
    try {
        const OrderedJson json = OrderedJson::parse(payload);
        Attestation attestation;
        attestation.report_sha256 = read_file_entry(json.at("subject").at(0)).sha256;
        const OrderedJson& predicate = json.at("predicate");
        if (json.at("predicateType") == recomputed_type)
            read_recomputed(predicate, attestation);
        else
            read_answers(predicate, attestation);
        if (is_sound(attestation) && statement_text(attestation) == payload) return attestation;
    } catch (const nlohmann::json::exception&) {
        // Said below, as of any other text.
    }
    throw Failure(where, "it holds no statement as runcert writes one",
                  "Use the file as it was made, whole and unchanged");
}

std::string attestation_id(std::string_view payload) {
    return sha256_hex(payload);
}

}  // namespace runcert

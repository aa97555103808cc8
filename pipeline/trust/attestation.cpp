#include "trust/attestation.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "files/sha256.h"

namespace runcert {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view statement_type = "https://in-toto.io/Statement/v1";
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
    return {{"report_id", attestation.report_id}, {"attempt", attestation.attempt_id},
            {"role", attestation.role},           {"key", attestation.key},
            {"statement", attestation.statement}, {"evidence", files_json(attestation.evidence)},
            {"after", attestation.after}};
}

void read_signer(const OrderedJson& json, Attestation& attestation) {
    json.at("report_id").get_to(attestation.report_id);
    json.at("attempt").get_to(attestation.attempt_id);
    json.at("role").get_to(attestation.role);
    json.at("key").get_to(attestation.key);
    json.at("statement").get_to(attestation.statement);
    attestation.evidence = read_files(json.at("evidence"));
    json.at("after").get_to(attestation.after);
}

OrderedJson answers_json(const Attestation& attestation) {
    OrderedJson json = signer_json(attestation);
    json["time"] = attestation.time;
    if (attestation.on_paper) json["on_paper"] = file_json(*attestation.on_paper);
    json["answers"] = OrderedJson::array();
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
    for (const OrderedJson& one : json.at("answers"))
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

std::string statement_text(const Attestation& attestation) {
    const bool recomputed = attestation.is_recomputed();
    const OrderedJson statement{
        {"_type", statement_type},
        {"subject", OrderedJson::array({file_json({"report.json", attestation.report_sha256})})},
        {"predicateType", recomputed ? recomputed_type : answers_type},
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

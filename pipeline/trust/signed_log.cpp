#include "trust/signed_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/folder_lock.h"
#include "store/sha256.h"
#include "trust/merkle_tree.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view head_type = "urn:runcert:log-head:1.0";
constexpr const char* as_it_was = "Take the log, or its copy, as the body keeps it";

LogEntry read_entry(const std::string& line, const std::string& where) {
    LogEntry entry;
    try {
        const OrderedJson json = OrderedJson::parse(line);
        for (const auto& [name, part] : {std::pair("time", &entry.time),
                                         {"report_id", &entry.report_id},
                                         {"report_sha256", &entry.report_sha256},
                                         {"attempt", &entry.attempt},
                                         {"craft", &entry.craft},
                                         {"role", &entry.role},
                                         {"key", &entry.key}})
            json.at(name).get_to(*part);
        json.at("recordings").get_to(entry.recordings);
        if (entry_text(entry) == line) return entry;
    } catch (const nlohmann::json::exception&) {
        // Said below, as of any other text.
    }
    throw Failure(where, "it is no entry as runcert writes one", as_it_was);
}

void add(SignedLog& log, const std::string& line, const std::string& where) {
    log.entries.push_back(
        read_entry(line, fmt::format("{}, entry {}", where, log.entries.size() + 1)));
    log.leaves.push_back(leaf_hash(line));
}

/// What a proof holds.
struct LogProof {
    std::string entry;
    std::size_t index = 0;
    std::vector<std::string> path;
    std::string head;
};

std::string proof_text(const LogProof& proof) {
    const OrderedJson json{
        {"entry", proof.entry}, {"index", proof.index}, {"path", proof.path}, {"head", proof.head}};
    return json.dump() + "\n";
}

LogProof read_proof(const std::string& text) {
    try {
        const OrderedJson json = OrderedJson::parse(text);
        LogProof proof{.entry = json.at("entry").get<std::string>(),
                       .index = json.at("index").get<std::size_t>(),
                       .path = json.at("path").get<std::vector<std::string>>(),
                       .head = json.at("head").get<std::string>()};
        if (proof_text(proof) == text) return proof;
    } catch (const nlohmann::json::exception&) {
        // Said below, as of any other text.
    }
    throw Failure(std::string(log_proof_file), "it is no proof as runcert writes one", as_it_was);
}

/// What the proof shows, in one sentence, and who signed its head. Failure where it does not hold.
std::pair<std::string, Signer> judge_proof(const LogProof& proof, const ReportFacts& report,
                                           const SignatureRules& rules) {
    const LogEntry entry = read_entry(proof.entry, std::string(log_proof_file));
    const LogHead head = read_head(proof.head, std::string(log_proof_file));
    if (entry.report_sha256 != sha256_hex(report.text))
        throw Failure(std::string(log_proof_file), "its entry is that of another report",
                      as_it_was);
    if (root_of_path(leaf_hash(proof.entry), proof.index, head.size, proof.path) != head.root)
        throw Failure(std::string(log_proof_file),
                      "its entry does not lead to the head that it names", as_it_was);
    return {fmt::format("this report is entry {} of {}, with the root {}", proof.index + 1,
                        head.size, head.root),
            judge_statement(head.signed_by, std::string(log_proof_file), std::nullopt, rules)};
}

}  // namespace

LogEntry entry_of(const ReportFacts& report, const std::string& role, const SecretKey& key) {
    LogEntry entry{
        .time =
            iso_text(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now())),
        .report_id = report.report_id,
        .report_sha256 = sha256_hex(report.text),
        .attempt = report.attempt_id,
        .craft = report.json->at("predicate").at("attempt").at("craft_name").get<std::string>(),
        .role = role,
        .key = public_key_line(public_key_of(key))};
    for (const auto& [name, sha256] : report.subjects)
        if (name.starts_with("recording.")) entry.recordings.push_back(sha256);
    return entry;
}

std::string entry_text(const LogEntry& entry) {
    const OrderedJson json{{"time", entry.time},
                           {"report_id", entry.report_id},
                           {"attempt", entry.attempt},
                           {"craft", entry.craft},
                           {"role", entry.role},
                           {"key", entry.key},
                           {"recordings", entry.recordings},
                           {"report_sha256", entry.report_sha256}};
    return json.dump(-1, ' ', true);
}

SignedLog read_log(const fs::path& file) {
    const std::string text = read_file(file);
    SignedLog log;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        if (end == std::string::npos)
            throw Failure(fmt::format("{}, entry {}", file.string(), log.entries.size() + 1),
                          "the line ends in the middle", as_it_was);
        add(log, text.substr(at, end - at), file.string());
        at = end + 1;
    }
    return log;
}

void append_to_log(const fs::path& file, const LogEntry& entry) {
    const Folder folder(folder_of(file));
    const auto lock = FolderLock::wait_lock(folder, file.filename().string() + ".lock",
                                            LockKind::exclusive, std::stop_token());
    std::string text;
    if (fs::exists(fs::symlink_status(file))) {
        (void)read_log(file);
        text = read_file(file);
    }
    write_file_atomically(file, text + entry_text(entry) + "\n");
}

std::vector<std::string> conflicts_in(const SignedLog& log) {
    std::vector<std::string> found;
    std::map<std::string, std::size_t> by_attempt, by_recording;
    for (std::size_t i = 0; i < log.entries.size(); ++i) {
        const LogEntry& entry = log.entries[i];
        const std::size_t earlier = by_attempt.emplace(entry.attempt, i).first->second;
        if (log.entries[earlier].report_sha256 != entry.report_sha256)
            found.push_back(fmt::format("Entries {} and {} are two reports of the attempt {}.",
                                        earlier + 1, i + 1, entry.attempt));
        for (const std::string& recording : entry.recordings) {
            const std::size_t other = by_recording.emplace(recording, i).first->second;
            if (log.entries[other].attempt != entry.attempt)
                found.push_back(fmt::format(
                    "Entries {} and {} have one recording, in the attempts {} ({}) and {} ({}).",
                    other + 1, i + 1, log.entries[other].attempt, log.entries[other].craft,
                    entry.attempt, entry.craft));
        }
    }
    return found;
}

std::string sign_head(const SignedLog& log, const std::string& role, const SecretKey& key) {
    SignedStatement statement{.facts = {{"size", log.leaves.size()}}, .role = role};
    statement.subject.push_back({{"name", "log"}, {"digest", {{"sha256", tree_root(log.leaves)}}}});
    return sign_statement(std::move(statement), head_type, key);
}

LogHead read_head(std::string_view text, const std::string& where) {
    LogHead head{.signed_by = read_statement_of(text, head_type, "head of a log", where)};
    try {
        head.size = head.signed_by.facts.at("size").get<std::size_t>();
        head.root = head.signed_by.subject.at(0).at("digest").at("sha256").get<std::string>();
    } catch (const nlohmann::json::exception&) {
        throw Failure(where, "it is no head of a log as runcert writes one", as_it_was);
    }
    return head;
}

bool extends(const SignedLog& log, const LogHead& head) {
    return head.size <= log.leaves.size() &&
           tree_root(std::span(log.leaves).first(head.size)) == head.root;
}

std::string prove_entry(const SignedLog& log, const std::string& report_sha256,
                        const std::string& role, const SecretKey& key, const std::string& where) {
    const auto last =
        std::find_if(log.entries.rbegin(), log.entries.rend(),
                     [&](const LogEntry& entry) { return entry.report_sha256 == report_sha256; });
    if (last == log.entries.rend())
        throw Failure(where, "the log has no entry of this report",
                      "Sign the report with --log, so that the log names it");
    const auto index = static_cast<std::size_t>(std::distance(last, log.entries.rend())) - 1;
    return proof_text({.entry = entry_text(*last),
                       .index = index,
                       .path = inclusion_path(log.leaves, index),
                       .head = sign_head(log, role, key)});
}

std::optional<VerificationStep> verify_logged(const fs::path& run_dir, const ReportFacts& report,
                                              const SignatureRules& rules) {
    if (!fs::is_regular_file(fs::symlink_status(run_dir / log_proof_file))) return std::nullopt;
    VerificationStep step{.what = "log", .answer = LayerAnswer::verified};
    try {
        const auto [shown, signer] =
            judge_proof(read_proof(read_handwritten(run_dir / log_proof_file)), report, rules);
        step.finding = shown;
        step.details.push_back("head signed by " + signer_words(signer));
        if (!signer.valid) step.answer = LayerAnswer::not_checkable;
    } catch (const ComputerFailure&) {
        throw;
    } catch (const Failure& failure) {
        step.finding = "the proof that this report was logged does not hold";
        step.fail(failure.problem());
    }
    return step;
}

}  // namespace runcert

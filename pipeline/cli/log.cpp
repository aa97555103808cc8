#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "core/text.h"
#include "run/run_lock.h"
#include "store/sha256.h"
#include "trust/merkle_tree.h"
#include "trust/roster.h"
#include "trust/signed_log.h"
#include "trust/signing.h"

namespace runcert {
namespace {

struct LogOptions {
    std::string log;
    std::string since;
    std::string head;
    std::string prove;
    std::string key;
    std::string role = "board";
};

void show(const SignedLog& log) {
    for (std::size_t i = 0; i < log.entries.size(); ++i) {
        const LogEntry& entry = log.entries[i];
        fmt::print("{:>5}  {}  {} of {} ({}), as {}\n", i + 1, entry.time, entry.report_id,
                   plain_text(entry.attempt), plain_text(entry.craft), entry.role);
    }
    fmt::print("entries  {}\nroot     {}\n", log.entries.size(), tree_root(log.leaves));
}

/// Whether the log still has what an earlier head stands for.
bool goes_on_from(const SignedLog& log, const std::string& file) {
    const LogHead head = read_head(read_handwritten(file), file);
    const bool same = extends(log, head);
    fmt::print(
        "{}  the first {} entries are {}those of the head that {} signed at {}, with the key "
        "{}\n",
        same ? "yes    " : "NO     ", head.size, same ? "" : "not ", head.signed_by.role,
        head.signed_by.time, head.signed_by.key);
    return same;
}

int log(const LogOptions& options) {
    const SignedLog log = read_log(options.log);
    show(log);
    bool sound = options.since.empty() || goes_on_from(log, options.since);
    for (const std::string& conflict : conflicts_in(log)) {
        fmt::print("NOTE     {}\n", plain_text(conflict));
        sound = false;
    }
    std::fflush(stdout);
    if (!options.head.empty() || !options.prove.empty()) {
        require_role(options.role, "--role");
        const SecretKey key = load_secret_key(options.key);
        if (!options.head.empty()) {
            write_new_file(options.head, sign_head(log, options.role, key));
            fmt::print("head     {}\n", options.head);
        }
        if (!options.prove.empty()) {
            const RunLock lock(options.prove);
            const ReportFacts report = read_report_facts(options.prove);
            const std::filesystem::path proof =
                std::filesystem::path(options.prove) / log_proof_file;
            write_file_atomically(
                proof, prove_entry(log, sha256_hex(report.text), options.role, key, options.log));
            fmt::print("proof    {}\n", proof.string());
        }
    }
    return sound ? 0 : 1;
}

}  // namespace

void add_log(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<LogOptions>(
        app, chosen, "log", "Show and check a log of what was signed, and prove what is in it",
        log);
    line.text("LOG", options.log, "the log, as `sign --log` writes it", CommandLine::required);
    line.text("--since", options.since, "an earlier head of it: is all of that still there?");
    line.text("--key", options.key, "secret key of who keeps the log");
    line.text("--role", options.role, "what whoever keeps it is (default: board)");
    line.text("--head", options.head, "sign its head, and write it to this file");
    line.text("--prove", options.prove, "write into this run folder that its report is in the log");
    line.need("--head", "--key");
    line.need("--prove", "--key");
    line.footer(
        "A log is a text file with an entry a line, to which `sign --log` adds. Its root is that "
        "of "
        "a Merkle\ntree (RFC 9162). Publish the head now and then: whoever has an earlier one sees "
        "by --since that\nnothing was taken out or changed. --prove writes report.json.logged, "
        "which a bundle takes along\nand `verify` checks.\nNOTE: two reports of one attempt, or "
        "one recording in two attempts.\nExit status: 0 all of it holds, 1 something was noted or "
        "is no longer there, 2 it cannot be read.");
}

}  // namespace runcert

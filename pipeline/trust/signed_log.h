#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trust/statement.h"

// A list of what was signed, to which entries are only ever added: a body keeps one, and whoever
// has it sees two reports of one attempt, or one recording in two attempts. It is a Merkle tree
// (merkle_tree.h), so that its head stands for all of it, and a report can prove that it is in it.

namespace runcert {

/// That a report was signed.
struct LogEntry {
    std::string time{};  ///< by the signer's clock
    std::string report_id{};
    std::string report_sha256{};
    std::string attempt{};
    std::string craft{};
    std::vector<std::string> recordings{};  ///< their SHA-256
    std::string role{};
    std::string key{};  ///< as `minisign -P` takes it
};

/// The entry of a signature of a report, made now.
LogEntry entry_of(const ReportFacts& report, const std::string& role, const SecretKey& key);

/// The line of an entry: JSON, without a line end.
std::string entry_text(const LogEntry& entry);

/// The hashes and the entries of a log, in its order.
struct SignedLog {
    std::vector<std::string> leaves{};
    std::vector<LogEntry> entries{};
};

/// Reads a log. Failure, with the entry's number, where a line is anything but what is written.
SignedLog read_log(const std::filesystem::path& file);

/// Adds an entry at the end of a log, which is made where there is none. Other calls wait
/// meanwhile. Failure where it cannot be read or written; it is then as it was.
void append_to_log(const std::filesystem::path& file, const LogEntry& entry);

/// What should not be in one log, a sentence each, by the numbers of entries: two reports of one
/// attempt, one recording in two attempts.
std::vector<std::string> conflicts_in(const SignedLog& log);

/// What stands for a log: how many entries it has, and the root over them.
struct LogHead {
    std::size_t size = 0;
    std::string root{};
    SignedStatement signed_by{};
};

/// The text of the head of a log as it is now, signed.
std::string sign_head(const SignedLog& log, const std::string& role, const SecretKey& key);

/// Reads a head. Failure where it is none, or was changed.
LogHead read_head(std::string_view text, const std::string& where);

/// Whether the log begins with all that the head stands for.
bool extends(const SignedLog& log, const LogHead& head);

/// The text of `log_proof_file`: the last entry of that report, its path to the root, and the
/// signed head. Failure where the log has no entry of it.
std::string prove_entry(const SignedLog& log, const std::string& report_sha256,
                        const std::string& role, const SecretKey& key, const std::string& where);

/// Whether the proof in a run folder holds, by a head that a key of the roster signed. Nothing
/// where there is none.
std::optional<VerificationStep> verify_logged(const std::filesystem::path& run_dir,
                                              const ReportFacts& report,
                                              const SignatureRules& rules);

}  // namespace runcert

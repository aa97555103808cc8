#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "store/folder.h"

namespace runcert {

enum class SignatureKind { minisign, ssh };

/// A signature of report.json in its run folder.
struct SignatureFile {
    std::string name{};  ///< "report.json.minisig", "report.json.judge.minisig", "report.json.sig"
    SignatureKind kind = SignatureKind::minisign;
    std::string text{};
};

/// The signature files of a run folder, by name, report.json.minisig first. Symbolic links are
/// passed over. Failure where one is longer than any signature.
std::vector<SignatureFile> signature_files(const std::filesystem::path& run_dir);

/// Whether a file of a run folder is a signature by its name.
bool is_signature_name(std::string_view name);

/// The names of a signature's time stamp and of the query for it.
std::string time_stamp_name(std::string_view signature);
std::string time_stamp_query_name(std::string_view signature);

/// The file of a run folder that proves that its report is in a log (signed_log.h).
inline constexpr std::string_view log_proof_file = "report.json.logged";

/// Whether a file of a run folder is, by its name, a signature, its time stamp or the query for it,
/// or that proof.
bool belongs_to_signatures(std::string_view name);

/// Whether a run can have a file of that name beside its report, pages and run.yaml.
bool is_file_of_a_run(const std::string& name);

/// The folder of what was superseded in a run: for each earlier report a folder, named by the
/// beginning of its SHA-256, with that report.json, its signatures, time stamps and sealed PDF, so
/// that each can still be verified there; what it was made from; and files that somebody had
/// changed in that run.
inline constexpr const char* superseded_folder = "superseded";

/// "superseded/0123456789abcdef", the folder for a run's report, which need not be there.
std::string superseded_name(const Folder& run);
/// The folder in `to`/superseded for the report of `run`, whose report.json it holds.
Folder superseded_of(const Folder& run, const Folder& to);

/// Copies a file of `from` into `kept`, under its own name or the first free one with a number, if
/// it is not there already.
void keep_copy(const Folder& from, const std::string& name, const Folder& kept);

/// Copies a file of the run folder that is about to be replaced into superseded/, if there is one.
/// Failure where `superseded` is a symbolic link.
void keep_superseded(const std::filesystem::path& run_dir, const std::string& name);

/// The same for report.pdf if it is sealed: one that is rendered again is not.
void keep_sealed_page(const std::filesystem::path& run_dir);

/// Moves all signatures, time stamps and attestations into superseded/: a new report makes them
/// void, and evidence is never deleted.
void supersede_signatures(const std::filesystem::path& run_dir);

/// Failure, with their names, where a folder holds files named like those of a run that no run put
/// there: no report in it names them, nor does `known`, the names that a batch put there. `made`
/// are the files that a new run will have. Links and folders of such names count too.
void require_a_run(const Folder& run, const std::vector<std::string>& made,
                   const std::vector<std::string>& known = {});

/// Brings what is worth keeping of a run folder into `made`, which takes its place and has a
/// report.json. Signatures and attestations stand beside that where it is unchanged, byte for byte.
/// Else they go to superseded/ with the report and what it was made from that is not in `made`, too
/// (attempt, rules, recordings); so do a sealed PDF, and files of the run that are not as its
/// report names them. Stage files and pages do not, which can be made again. The user's own files,
/// which no run has, come along. What is in `made` already stays, and a signature that differs from
/// one there is superseded.
void carry_over(const Folder& run, const Folder& made);

}  // namespace runcert

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "files/folder.h"

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

/// Whether a file of a run folder is, by its name, a signature, its time stamp or the query for it.
bool belongs_to_signatures(std::string_view name);

/// Whether a run has files of that name beside its report, pages and run.yaml.
bool is_file_of_a_run(const std::string& name);

/// The folder of what no longer stands of a run: for each report that was signed a folder, named by
/// the beginning of its SHA-256, with that report.json, its signatures, time stamps and sealed PDF,
/// so that each can still be verified there; and what somebody had changed in that run.
inline constexpr const char* superseded_folder = "superseded";

/// The folder in that one for what a run superseded: it holds the run's report.json.
Folder superseded_of(const Folder& run, const Folder& to);

/// Has a copy of a file of `from` in `kept`, under its own name or the first with a number that is
/// free; once alone where it is there already.
void keep_copy(const Folder& from, const std::string& name, const Folder& kept);

/// Copies a file that is about to be replaced there, beside the run folder's report.json, under its
/// own name or the first with a number that is free. Nothing where there is no such file. Failure
/// where `superseded` is a symbolic link.
void keep_superseded(const std::filesystem::path& run_dir, const std::string& name);

/// The same of report.pdf where it is sealed, which one that is rendered again is not.
void keep_sealed_page(const std::filesystem::path& run_dir);

/// Moves all signatures, time stamps and attestations there: a new report makes them void, and
/// evidence is never deleted.
void supersede_signatures(const std::filesystem::path& run_dir);

/// Failure, with their names, where a folder holds files of a run's names that no run put there: it
/// has no report that names them, and they are none of `known`, the names that a batch put there.
/// `made` are the files that a new run will have. Links and folders of such names count too.
void require_a_run(const Folder& run, const std::vector<std::string>& made,
                   const std::vector<std::string>& known = {});

/// Brings what stands in a run folder into `made`, which takes its place and has its report.json:
/// signatures and attestations beside that where it is unchanged, byte for byte, else into its
/// superseded/; a sealed PDF there too; files of the run that are not as its report names them
/// there too, where `made` has others; and files of the user's, which no run has. What is in `made`
/// already stays, and a signature that it has otherwise is superseded.
void carry_over(const Folder& run, const Folder& made);

}  // namespace runcert

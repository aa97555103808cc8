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

/// The folder of a run's signatures and time stamps that no longer stand.
inline constexpr const char* superseded_folder = "superseded";

/// Has a file of `from` in that folder of `to`, under its own name or the first with a number that
/// is free; once alone where it is there already.
void supersede(const Folder& from, const std::string& name, const Folder& to);

/// Copies a file that is about to be replaced into that folder, under its own name or the first
/// with a number that is free. Nothing where there is no such file. Failure where `superseded` is a
/// symbolic link.
void keep_superseded(const std::filesystem::path& run_dir, const std::string& name);

/// The same of report.pdf where it is sealed, which one that is rendered again is not.
void keep_sealed_page(const std::filesystem::path& run_dir);

/// Moves all signatures, time stamps and attestations there: a new report makes them void, and
/// evidence is never deleted.
void supersede_signatures(const std::filesystem::path& run_dir);

/// Brings what stands in a run folder into `made`, which takes its place and has its report.json:
/// signatures and attestations beside that where it is unchanged, byte for byte, else into its
/// superseded/; a sealed PDF there too; and files of the user's, those that the earlier report does
/// not name. What is in `made` already stays, and a signature that it has otherwise is superseded.
void carry_over(const Folder& run, const Folder& made);

}  // namespace runcert

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/archive.h"
#include "store/process.h"

namespace runcert {

/// The files that a bundle has beside those of its run folder.
inline constexpr const char* bundle_sums_file = "SHA256SUMS";
inline constexpr const char* bundle_keys_folder = "keys";
inline constexpr const char* bundle_roster_file = "keys/roster";
inline constexpr const char* bundle_tsa_file = "keys/tsa-ca.pem";
/// What the names of keys in OpenSSH's form begin with, in keys/.
inline constexpr std::string_view ssh_key_begin = "ssh-";

/// What the names of temporary files and folders of programs begin with. None belongs in a run.
inline constexpr std::string_view program_leftover = ".runcert-";

/// What goes into a bundle.
struct BundleInput {
    std::filesystem::path run_dir;
    std::vector<std::filesystem::path> public_keys = {};  ///< minisign's format
    std::optional<std::filesystem::path> roster = {};     ///< OpenSSH's allowed signers
    std::optional<std::filesystem::path> tsa_ca = {};     ///< root of the time stamps, PEM
    ArchiveForm form = ArchiveForm::tar_zst;
};

/// A bundle, not yet written.
struct Bundle {
    std::string attempt;                     ///< its id, the name of the one folder in the archive
    std::string bytes;                       ///< of the archive
    std::size_t files = 0;                   ///< in it
    std::vector<std::string> left_out = {};  ///< names in the run folder that are not in it
};

/// How a bundle differs from the one that `make_bundle` makes of what it holds, in words; nothing
/// where its bytes do not or, of a .tar.zst with another version of libzstd, those of the tar
/// inside do not.
std::optional<std::string> deviation_of_bundle(const std::filesystem::path& file,
                                               const std::filesystem::path& unpacked_run_dir);

/// The run folder, the keys, VERIFY.txt and SHA256SUMS in one archive: the same bytes for the same
/// files, whatever their order, times and owners. run.yaml (clock and durations, on which nothing
/// depends), superseded signatures and what killed runs left (`.runcert-*`) stay out. The keys of
/// an unpacked bundle are kept. Of a roster, each key has a file beside it: in minisign's form
/// where a signature of the run tells the key's id there, else in OpenSSH's.
///
/// Failure where the folder is over the limits (`require_within_limits`), is not whole
/// (`verify_files`, `check_sums`), holds unknown files, or a key is no public key.
Bundle make_bundle(const BundleInput& input);

/// What VERIFY.txt says of one bundle.
struct BundleFacts {
    std::string attempt;
    std::string report_id;
    std::string program_version, source_revision;  ///< of the program that made the report
    std::string program_home;                      ///< where that is to be had; may be empty
    ArchiveForm form = ArchiveForm::tar_zst;
    std::vector<std::string> files = {};  ///< in it, sorted, without VERIFY.txt and SHA256SUMS
};

/// VERIFY.txt: how a stranger checks the bundle, with runcert and without.
std::string bundle_text(const BundleFacts& facts);

/// Files and folders in a run folder that neither its report names nor this program writes, sorted.
std::vector<std::string> unknown_files(const std::filesystem::path& run_dir);

/// A file of an unpacked bundle that is not as SHA256SUMS says.
struct SumProblem {
    std::string file;
    std::string problem;  ///< what is wrong with it, in words
};

/// Compares an unpacked bundle with its SHA256SUMS, which must name every file in it but itself,
/// exactly as `make_bundle` writes it. Empty where all is well, in the order of the names
/// otherwise. Whoever changes a file can change SHA256SUMS too: only signatures prove who made it.
std::vector<SumProblem> check_sums(const std::filesystem::path& folder);

/// The text of SHA256SUMS for a folder's files, as `sha256sum -c` reads it.
std::string sums_line(const std::string& sha256, const std::string& file);

/// A bundle unpacked into a folder of its own, which goes when this does.
struct UnpackedBundle {
    std::unique_ptr<TemporaryFolder> folder;
    std::filesystem::path run_dir;
};

/// Unpacks a bundle as `unpack_archive` does, within `bundle_limits`. Failure also where it does
/// not hold exactly one folder with a report.json in it, and for a page of a report (HTML, PDF), of
/// which it says what to ask for. Messages call the file `known_as`, where that is
/// not empty.
UnpackedBundle unpack_bundle(const std::filesystem::path& file, const std::string& known_as = {});

/// A run as a reader is given it: a folder, or a bundle, which is unpacked for as long as this
/// lives. Failure as of `unpack_bundle`.
class GivenRun {
  public:
    explicit GivenRun(const std::filesystem::path& given);
    const std::filesystem::path& folder() const { return folder_; }
    bool is_bundle() const { return bundle_.has_value(); }
    /// Of a bundle, the folder in the current one that it is unpacked to for good, so that it can
    /// be written to; else the folder as given. Failure where a file of that name is there.
    std::filesystem::path run_folder_to_write();

  private:
    std::optional<UnpackedBundle> bundle_;
    std::filesystem::path folder_;
};

/// What `read` gives of the folder of a run, whose files must be of versions that this program
/// reads. Failures call a bundle by its name.
int read_given(const std::filesystem::path& given,
               const std::function<int(const std::filesystem::path& folder)>& read);

// How much a run may hold to be bundled and verified: far more than any that is certified, far less
// than fills a disk.

inline constexpr std::uint64_t longest_pdf = std::uint64_t{32} << 20;  ///< bytes

/// Failure where a PDF is longer than `longest_pdf`, and must be given to no program.
void require_readable_pdf(const std::filesystem::path& pdf);

/// The most bytes that a file of a run folder or bundle may have, by its name there.
std::uint64_t most_bytes_of(std::string_view name);

/// What a bundle of so many bytes may unpack to.
UnpackLimits bundle_limits(std::uint64_t bundle_bytes);

/// Failure where a file of a run folder, or all of them together, exceed the limits, by the sizes
/// that the file system states, before any is read. Links are not followed.
void require_within_limits(const std::filesystem::path& run_dir);

/// The limits in words, for the help of commands; lines of at most 100 characters.
std::string bundle_limits_words();

}  // namespace runcert

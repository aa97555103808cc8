#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "store/process.h"

/// Programs of others that this one calls on what it was handed: converters, renderers, checkers.
/// Each is found only in folders of the system and runs in a sandbox. Slurm's programs do not count
/// among them: they need the user's own settings, network and identity, and read no evidence.
namespace runcert {

/// One of those programs.
struct ExternalProgram {
    std::string_view name;     ///< "gpsbabel"
    std::string_view package;  ///< the Debian package that it is in
};

/// All of them, in the order in which a run may need them.
const std::vector<ExternalProgram>& external_programs();

/// The file of a program, links resolved: the first that may be run in /usr/bin, /bin and
/// /usr/local/bin; never in the caller's PATH or working directory. Where the environment has
/// RUNCERT_EXTERNAL_PATH, its folders (absolute, colons between) stand in their place. Empty where
/// there is none.
std::filesystem::path external_program_file(std::string_view name);

/// "weasyprint is not installed here (package weasyprint)" where there is no such file; else empty.
std::string missing_program_words(std::string_view name);

/// The SHA-256 of that file, 64 lower-case hexadecimal digits; empty where there is none. For a
/// program that is a script, such as weasyprint, that of the script.
std::string external_program_sha256(std::string_view name);

/// The most that one call may take.
struct ExternalLimits {
    std::chrono::seconds time{120};
    std::uint64_t memory_bytes = std::uint64_t{2} << 30;  ///< of address space
    std::uint64_t file_bytes = std::uint64_t{1} << 30;    ///< of each file that it writes
    std::size_t output_bytes = std::size_t{64} << 20;     ///< on standard output or standard error
};

/// One call of a program.
struct ExternalCall {
    /// Its name as in `external_programs`, then its arguments.
    std::vector<std::string> command = {};
    /// Its working directory, the only place where it can write, its HOME and TMPDIR: a folder made
    /// for it, which holds what it reads and where its results are found. Empty: one made for this
    /// call, that goes with it.
    std::filesystem::path folder = {};
    /// What it reads elsewhere, by the names that `external_input` gives.
    std::vector<std::filesystem::path> inputs = {};
    /// Added to HOME, TMPDIR, PATH, LC_ALL=C.UTF-8 and TZ=UTC, which are all it gets.
    std::vector<std::pair<std::string, std::string>> environment = {};
    std::filesystem::path standard_input = {};
    ExternalLimits limits = {};
    std::stop_token stop = {};  ///< where a stop is requested, the program is ended
};

/// The name of a file to be given to a program as argument and input: absolute, without links, and
/// so never taken for an option. Failure where there is no such file.
std::filesystem::path external_input(const std::filesystem::path& file);

/// Runs a program to its end, in a sandbox where there is one. Failure where it is missing, with
/// the package to install. It and all that it started die with the caller; without a sandbox, what
/// left its process group does not. The result says whether it reached a limit: by `end`, or an
/// exit status above 128; `external_problem` puts it into words.
ProcessResult run_external(const ExternalCall& call);

/// Why a call that did not succeed ended, in words: "it did not end within 120 s", "it ended with
/// status 1: WHAT IT SAID FIRST".
std::string external_problem(const ExternalCall& call, const ProcessResult& result);

/// Whether bubblewrap works here, found once, by trying: a program then sees no files but the
/// system's programs and what it was given. A closed environment, a folder of its own and limits it
/// always has.
bool has_sandbox();

/// "limits_only" where it does not; else empty.
std::string isolation_word();

/// Where external programs are not shut in, a sentence that says so, why, and what it means;
/// else empty.
std::string missing_sandbox();

/// For people: a line for each program (file, beginning of its SHA-256, how far it is shut in; or
/// what to install), and where something could not be had, why.
std::string external_programs_text();

}  // namespace runcert

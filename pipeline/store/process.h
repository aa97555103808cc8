#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace runcert {

/// How a program is run.
struct ProcessOptions {
    /// Added to the caller's environment, or in place of what has the same name there.
    std::vector<std::pair<std::string, std::string>> environment = {};
    /// Whether `environment` is all the program gets, and nothing of the caller's.
    bool closed_environment = false;
    /// The program's working directory; the caller's for an empty one.
    std::filesystem::path folder = {};
    /// The file that is the program's standard input; none for an empty one.
    std::filesystem::path standard_input = {};
    /// After this time the program is ended.
    std::optional<std::chrono::milliseconds> time_limit = {};
    /// Where a stop is requested, the program is ended; it is not begun where one was before.
    std::stop_token stop = {};
    /// Where it writes more bytes than this on either output, the program is ended.
    std::optional<std::size_t> most_output = {};
    /// Runs the program in a session and process group of its own, so that the terminal's Ctrl-C
    /// does not reach it and what it leaves running is ended after it. Always so with a limit, a
    /// stop or a guard.
    bool own_group = false;
    /// All in the program's group end with the caller, however it ends. That is for programs that
    /// start others, as bubblewrap does: its children live on where it is killed while it begins. A
    /// shell stands between: of one that a signal ends the status, 128 + signal, is known alone.
    bool guarded = false;
};

/// Why a program ended.
enum class ProcessEnd {
    by_itself,    ///< it ended, with an exit status
    by_signal,    ///< a signal ended it that its caller did not send: a crash, or want of memory
    over_time,    ///< it was ended because it reached its time limit
    over_output,  ///< it was ended because it wrote more than it may
    stopped,      ///< it was ended, or not begun, because a stop was requested
};

struct ProcessResult {
    int exit_status = 0;      ///< of the program; 128 + signal where it was ended by one
    std::string output = {};  ///< what it wrote on standard output
    std::string errors = {};  ///< what it wrote on standard error
    ProcessEnd end = ProcessEnd::by_itself;
    int signal = 0;  ///< the number of the signal that ended it; 0 where none did
    /// The largest resident memory of the program and of those it waited for. The system counts the
    /// copy of its caller that the program begins as, so it is never less than the caller's own.
    std::uint64_t peak_memory_bytes = 0;
};

/// Runs a program (searched in PATH unless it holds a slash) to its end, and returns what it said.
/// May be called from several threads at once. A program that cannot be started is a Failure that
/// names it, and so is a standard input that cannot be read.
///
/// The program starts with no signal blocked, and ends with the *thread* that called this, however
/// that ends; as this waits for the program, that is when the caller's process dies. One that lies
/// beside the running program has to `end_with_caller`; any other gets SIGTERM.
///
/// To end a program is to send SIGKILL to its process group: to itself and to all it started that
/// did not take a group of their own. Programs run by this function that do have one still die with
/// the program that ran them. Output is read until the program has ended and nobody can write any
/// more, but for no longer than a second after its end, whoever still holds it open.
ProcessResult run_process(const std::vector<std::string>& arguments,
                          const ProcessOptions& options = {});

/// Ends this program with the one whose `run_process` runs it, if one does. Before any thread
/// begins.
void end_with_caller();

/// The first file of that name which may be run, in the absolute folders of a path; else empty.
std::filesystem::path find_program(std::string_view path, std::string_view name);

/// Sets the time from now on after which every program that this one runs, or would run, is ended
/// with a Failure. Before any thread begins.
void limit_time(std::chrono::seconds limit);
bool time_is_limited();

/// Failure where that time is over: what was made until then is not to be used.
void require_time();

/// The folder that holds the running program, where its companions are.
std::filesystem::path program_folder();

/// A new empty folder that only this user can read, removed with all it holds at the end of the
/// object's life.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace runcert

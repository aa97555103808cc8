#include "files/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/failure.h"

namespace runcert {
namespace {

[[noreturn]] void fail_to_start(int error) {
    throw Failure("starting a program", std::strerror(error), "Close other programs");
}

/// A pipe whose ends are closed when it goes out of scope, and in a program that is started.
class Pipe {
  public:
    Pipe() {
        if (pipe2(ends_.data(), O_CLOEXEC) != 0) fail_to_start(errno);
        // Where the caller has closed standard input or output, its number may be given to an
        // end, and the child would overwrite it before it is used.
        for (int& end : ends_)
            if (end <= STDERR_FILENO) {
                const int moved = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
                if (moved < 0) fail_to_start(errno);
                close(end);
                end = moved;
            }
    }
    ~Pipe() {
        for (const int end : ends_)
            if (end >= 0) close(end);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int read_end() const { return ends_[0]; }
    int write_end() const { return ends_[1]; }
    void close_write_end() { close(std::exchange(ends_[1], -1)); }

  private:
    std::array<int, 2> ends_{-1, -1};
};

/// The pipes between a program and its caller. `problem` brings the error of a program that could
/// not be started, and nothing where it could.
struct Pipes {
    Pipe out;
    Pipe err;
    Pipe problem;
};

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* arguments, char* const* environment, const Pipes& pipes,
                         const char* standard_input, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    const int input = open(standard_input, O_RDONLY);
    dup2(input, STDIN_FILENO);
    dup2(pipes.out.write_end(), STDOUT_FILENO);
    dup2(pipes.err.write_end(), STDERR_FILENO);
    execvpe(arguments[0], arguments, environment);
    const int error = errno;
    [[maybe_unused]] const ssize_t written = write(pipes.problem.write_end(), &error, sizeof error);
    _exit(127);
}

/// Reads both pipes until the child has closed them.
void drain(const Pipes& pipes, ProcessResult& result) {
    std::array<pollfd, 2> files{
        {{pipes.out.read_end(), POLLIN, 0}, {pipes.err.read_end(), POLLIN, 0}}};
    const std::array<std::string*, 2> texts{&result.output, &result.errors};
    std::array<char, 65536> buffer{};
    int open_files = 2;
    while (open_files > 0) {
        if (poll(files.data(), files.size(), -1) < 0) {
            if (errno == EINTR) continue;
            break;
        }
        for (std::size_t i = 0; i < files.size(); ++i) {
            if (files[i].fd < 0 || files[i].revents == 0) continue;
            const ssize_t count = read(files[i].fd, buffer.data(), buffer.size());
            if (count > 0) {
                texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
            } else if (count == 0 || errno != EINTR) {
                files[i].fd = -1;
                --open_files;
            }
        }
    }
}

std::vector<std::string> merged_environment(
    const std::vector<std::pair<std::string, std::string>>& additions) {
    std::vector<std::string> merged;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        bool replaced = false;
        for (const auto& [name, value] : additions)
            replaced = replaced || text.starts_with(name + "=");
        if (!replaced) merged.push_back(text);
    }
    for (const auto& [name, value] : additions)
        merged.push_back(name + "=" + value);
    return merged;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (std::string& text : texts)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& arguments,
                          const std::vector<std::pair<std::string, std::string>>& environment,
                          const std::filesystem::path& standard_input) {
    const std::string input = standard_input.empty() ? "/dev/null" : standard_input.string();
    std::vector<std::string> argument_texts = arguments;
    std::vector<std::string> environment_texts = merged_environment(environment);
    const std::vector<char*> argument_list = pointers(argument_texts);
    const std::vector<char*> environment_list = pointers(environment_texts);
    Pipes pipes;
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) fail_to_start(errno);
    if (child == 0)
        become(argument_list.data(), environment_list.data(), pipes, input.c_str(), parent);
    for (Pipe* pipe : {&pipes.out, &pipes.err, &pipes.problem})
        pipe->close_write_end();
    int error = 0;
    ssize_t count = 0;
    while ((count = read(pipes.problem.read_end(), &error, sizeof error)) < 0 && errno == EINTR) {
    }
    ProcessResult result;
    drain(pipes, result);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    result.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (count == sizeof error)
        throw Failure(arguments[0],
                      fmt::format("the program could not be started: {}", std::strerror(error)),
                      "Install it (see packages.txt), or build the program again");
    return result;
}

std::filesystem::path program_folder() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

TemporaryFolder::TemporaryFolder() {
    const std::string remedy = "Make room for temporary files, or set TMPDIR";
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error) throw Failure("the folder for temporary files", error.message(), remedy);
    std::string name = (parent / "runcert-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Failure(name, std::strerror(errno), remedy);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace runcert

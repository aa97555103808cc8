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

#include "core/failure.h"

namespace runcert {
namespace {

struct Pipe {
    int read_end = -1;
    int write_end = -1;
};

Pipe open_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw Failure("starting a program", std::strerror(errno), "Close other programs");
    return {ends[0], ends[1]};
}

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* arguments, char* const* environment, const Pipe& out,
                         const Pipe& err, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    const int null = open("/dev/null", O_RDONLY);
    dup2(null, STDIN_FILENO);
    dup2(out.write_end, STDOUT_FILENO);
    dup2(err.write_end, STDERR_FILENO);
    execvpe(arguments[0], arguments, environment);
    _exit(127);
}

/// Reads both pipes until the child has closed them.
void drain(const Pipe& out, const Pipe& err, ProcessResult& result) {
    std::array<pollfd, 2> files{{{out.read_end, POLLIN, 0}, {err.read_end, POLLIN, 0}}};
    const std::array<std::string*, 2> texts{&result.output, &result.errors};
    std::array<char, 65536> buffer{};
    int open_files = 2;
    while (open_files > 0) {
        if (poll(files.data(), files.size(), -1) < 0 && errno != EINTR) break;
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
    for (const auto& [name, value] : additions) merged.push_back(name + "=" + value);
    return merged;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (std::string& text : texts) list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& arguments,
                          const std::vector<std::pair<std::string, std::string>>& environment) {
    std::vector<std::string> argument_texts = arguments;
    std::vector<std::string> environment_texts = merged_environment(environment);
    const std::vector<char*> argument_list = pointers(argument_texts);
    const std::vector<char*> environment_list = pointers(environment_texts);
    const Pipe out = open_pipe();
    const Pipe err = open_pipe();
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0)
        throw Failure("starting " + arguments[0], std::strerror(errno), "Close other programs");
    if (child == 0) become(argument_list.data(), environment_list.data(), out, err, parent);
    close(out.write_end);
    close(err.write_end);
    ProcessResult result;
    drain(out, err, result);
    close(out.read_end);
    close(err.read_end);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    result.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (result.exit_status == 127 && result.output.empty() && result.errors.empty())
        throw Failure(arguments[0], "the program could not be started",
                      "Install it (see packages.txt), or build the program again");
    return result;
}

std::filesystem::path program_folder() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "runcert-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
        throw Failure(name, std::strerror(errno), "Make room for temporary files, or set TMPDIR");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace runcert

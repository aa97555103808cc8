#include "files/process_start.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/failure.h"
#include "files/process.h"

namespace runcert {

void Descriptor::close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
}

void fail_to_start(int error) {
    throw Failure("starting a program", std::strerror(error), "Close other programs");
}

namespace {

/// The same file under a number that is none of the three standard ones: where the caller has
/// closed its own, the child would overwrite it before it is used.
Descriptor above_standard(Descriptor given) {
    if (given.number() > STDERR_FILENO) return given;
    Descriptor moved(fcntl(given.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    if (moved.number() < 0) fail_to_start(errno);
    return moved;
}

Pipe make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail_to_start(errno);
    Descriptor read_end(ends[0]);
    Descriptor write_end(ends[1]);
    return {above_standard(std::move(read_end)), above_standard(std::move(write_end))};
}

Descriptor open_standard_input(const std::string& name) {
    const std::string file = name.empty() ? "/dev/null" : name;
    const int number = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (number < 0)
        throw Failure(file, std::string("it cannot be read: ") + std::strerror(errno),
                      "Check that it is there, and that you may read it");
    return above_standard(Descriptor(number));
}

/// glibc 2.36 declares a function of its own for this that C++ cannot link.
Descriptor open_pidfd(pid_t process) {
    return Descriptor(static_cast<int>(syscall(SYS_pidfd_open, process, 0)));
}

std::vector<std::string> merged_environment(
    const std::vector<std::pair<std::string, std::string>>& additions) {
    std::vector<std::string> merged;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        const bool replaced = std::any_of(
            additions.begin(), additions.end(),
            [&text](const auto& addition) { return text.starts_with(addition.first + "="); });
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

/// What the child needs between fork and exec, made before: there it may not even ask for memory.
struct Child {
    char* const* files;  ///< to try one after the other, ended by a null pointer
    char* const* arguments;
    char* const* environment;
    int input, output, errors, problem;
    pid_t parent;
    bool own_group;
};

/// Signals that the caller handles would run its handlers in the child, and those it blocks would
/// stay blocked in the program. Those it ignores stay ignored, as nohup wants it; but not SIGTERM,
/// by which the program dies with its caller.
void reset_signals() {
    for (int number = 1; number < NSIG; ++number) {
        struct sigaction action {};
        if (sigaction(number, nullptr, &action) != 0) continue;
        if (action.sa_handler == SIG_DFL) continue;
        if (action.sa_handler == SIG_IGN && number != SIGTERM) continue;
        action = {};
        action.sa_handler = SIG_DFL;
        sigaction(number, &action, nullptr);
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void become(const Child& child) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != child.parent) _exit(127);
    if (child.own_group) setpgid(0, 0);
    dup2(child.input, STDIN_FILENO);
    dup2(child.output, STDOUT_FILENO);
    dup2(child.errors, STDERR_FILENO);
    reset_signals();
    int error = ENOENT;
    for (char* const* file = child.files; *file != nullptr; ++file) {
        execve(*file, child.arguments, child.environment);
        const bool absent = errno == ENOENT || errno == ENOTDIR;
        // Of one that is there and may not be run more is to be said than of one that is not there.
        if (!absent) error = errno;
        if (!absent && errno != EACCES) break;
    }
    [[maybe_unused]] const ssize_t written = ::write(child.problem, &error, sizeof error);
    _exit(127);
}

/// Forks with every signal blocked, so that no handler of the caller runs in the child.
pid_t fork_quietly(const Child& child) {
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t process = fork();
    if (process == 0) become(child);
    const int error = errno;
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (process < 0) fail_to_start(error);
    return process;
}

}  // namespace

std::vector<std::string> program_candidates(const std::string& name) {
    if (name.find('/') != std::string::npos) return {name};
    const char* variable = std::getenv("PATH");
    const std::string path = variable ? variable : "/usr/local/bin:/usr/bin:/bin";
    std::vector<std::string> files;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find(':', begin), path.size());
        const std::string folder = path.substr(begin, end - begin);
        files.push_back(folder.empty() ? name : folder + "/" + name);
        begin = end + 1;
    }
    return files;
}

StartedProgram start_program(const ProgramStart& program) {
    std::vector<std::string> files = program_candidates(program.arguments[0]);
    std::vector<std::string> arguments = program.arguments;
    std::vector<std::string> environment = merged_environment(program.environment);
    const std::vector<char*> file_list = pointers(files);
    const std::vector<char*> argument_list = pointers(arguments);
    const std::vector<char*> environment_list = pointers(environment);
    const Descriptor input = open_standard_input(program.standard_input);
    Pipe output = make_pipe();
    Pipe errors = make_pipe();
    Pipe problem = make_pipe();
    StartedProgram started;
    started.process = fork_quietly({.files = file_list.data(),
                                    .arguments = argument_list.data(),
                                    .environment = environment_list.data(),
                                    .input = input.number(),
                                    .output = output.write_end.number(),
                                    .errors = errors.write_end.number(),
                                    .problem = problem.write_end.number(),
                                    .parent = getpid(),
                                    .own_group = program.own_group});
    // Both do it, so that the group is there for whoever comes first.
    if (program.own_group) setpgid(started.process, started.process);
    started.ended = open_pidfd(started.process);
    if (started.ended.number() < 0) {
        const int error = errno;
        kill(started.process, SIGKILL);
        waitpid(started.process, nullptr, 0);
        fail_to_start(error);
    }
    started.output = std::move(output.read_end);
    started.errors = std::move(errors.read_end);
    started.problem = std::move(problem.read_end);
    return started;
}

}  // namespace runcert

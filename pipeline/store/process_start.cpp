#include "store/process_start.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/failure.h"

namespace runcert {

void fail_to_start(int error) {
    throw Failure("starting a program", std::strerror(error), "Close other programs");
}

namespace {

/// The same file under a number that is none of the three standard ones: where the caller has
/// closed its own, the child would overwrite it before it is used.
FileDescriptor above_standard(FileDescriptor given) {
    if (given.number() > STDERR_FILENO) return given;
    FileDescriptor moved(fcntl(given.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    if (moved.number() < 0) fail_to_start(errno);
    return moved;
}

struct Pipe {
    FileDescriptor read_end;
    FileDescriptor write_end;
};

Pipe make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail_to_start(errno);
    FileDescriptor read_end(ends[0]);
    FileDescriptor write_end(ends[1]);
    return {above_standard(std::move(read_end)), above_standard(std::move(write_end))};
}

FileDescriptor open_standard_input(const std::filesystem::path& given) {
    const std::string file = given.empty() ? "/dev/null" : given.string();
    const int number = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (number < 0)
        throw Failure(file, std::string("it cannot be read: ") + std::strerror(errno),
                      "Check that it is there, and that you may read it");
    return above_standard(FileDescriptor(number));
}

/// glibc 2.36 declares a function of its own for this that C++ cannot link.
FileDescriptor open_pidfd(pid_t process) {
    return FileDescriptor(static_cast<int>(syscall(SYS_pidfd_open, process, 0)));
}

std::vector<std::string> merged_environment(
    const std::vector<std::pair<std::string, std::string>>& additions, bool closed) {
    std::vector<std::string> merged;
    for (char** entry = environ; !closed && *entry != nullptr; ++entry) {
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

/// A limit to set in the child: of those that the caller has itself, none is raised.
struct Limit {
    __rlimit_resource_t resource;
    rlimit value;
};

void limit(std::vector<Limit>& limits, __rlimit_resource_t resource, std::uint64_t most) {
    rlimit value{};
    if (getrlimit(resource, &value) != 0) fail_to_start(errno);
    value.rlim_max = std::min<rlim_t>(value.rlim_max, most);
    value.rlim_cur = std::min(value.rlim_cur, value.rlim_max);
    limits.push_back({resource, value});
}

std::vector<Limit> limits_of(const ProcessOptions& options) {
    std::vector<Limit> limits;
    if (options.most_memory) {
        limit(limits, RLIMIT_AS, *options.most_memory);
        limit(limits, RLIMIT_CORE, 0);
    }
    if (options.longest_file) limit(limits, RLIMIT_FSIZE, *options.longest_file);
    return limits;
}

/// What the child needs between fork and exec, made before: there it may not even ask for memory.
struct Child {
    char* const* files;  ///< to try one after the other, ended by a null pointer
    char* const* arguments;
    char* const* environment;
    const char* folder;  ///< null: stays where it is
    const Limit* limits;
    std::size_t limit_count;
    int input, output, errors, problem;
    pid_t parent;
    bool own_group;
    bool guarded;
    bool no_network;
    std::string_view user_map, group_map;
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

bool put(const char* file, std::string_view text) {
    const int number = open(file, O_WRONLY | O_CLOEXEC);
    if (number < 0) return false;
    const bool put = ::write(number, text.data(), text.size()) == std::ssize(text);
    ::close(number);
    return put;
}

/// A network namespace of its own has no way out. Who may not make one by right may in a user
/// namespace of its own, where the system has those; there the user has to be named again.
bool leave_network(const Child& child) {
    if (unshare(CLONE_NEWNET) == 0) return true;
    return unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0 && put("/proc/self/setgroups", "deny") &&
           put("/proc/self/uid_map", child.user_map) && put("/proc/self/gid_map", child.group_map);
}

/// The folder, network and limits of the program; false, with errno, where they cannot be had.
bool confine(const Child& child) {
    if (child.no_network && !leave_network(child)) return false;
    if (child.folder != nullptr && chdir(child.folder) != 0) return false;
    for (std::size_t i = 0; i < child.limit_count; ++i)
        if (setrlimit(child.limits[i].resource, &child.limits[i].value) != 0) return false;
    return true;
}

[[noreturn]] void report(const Child& child, int error) {
    [[maybe_unused]] const ssize_t written = ::write(child.problem, &error, sizeof error);
    _exit(127);
}

/// Waits for the program and ends as it did.
[[noreturn]] void end_as(pid_t program) {
    int status = 0;
    while (waitpid(program, &status, 0) < 0)
        if (errno != EINTR) _exit(127);
    if (!WIFSIGNALED(status)) _exit(WEXITSTATUS(status));
    reset_signals();
    kill(getpid(), WTERMSIG(status));
    _exit(128 + WTERMSIG(status));
}

/// Returns in a new process, with the number of its guard, which this one becomes. All signals are
/// blocked when this is called, so that none that ends the guard comes before it has a group.
pid_t under_guard(const Child& child) {
    const pid_t guard = setsid();
    struct sigaction action {};
    action.sa_handler = [](int) { kill(0, SIGKILL); };
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = SIG_DFL;  // an ignored SIGCHLD would leave nothing to wait for
    sigaction(SIGCHLD, &action, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != child.parent) _exit(127);
    const pid_t program = _Fork();
    if (program == 0) return guard;
    if (program < 0) report(child, errno);
    close_range(0, std::numeric_limits<unsigned>::max(), 0);  // pipes of others among them
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    sigprocmask(SIG_UNBLOCK, &ends, nullptr);
    end_as(program);
}

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void become(const Child& child) {
    const pid_t parent = child.guarded ? under_guard(child) : child.parent;
    const bool confined = confine(child);
    const int obstacle = errno;
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // after confine: another namespace may take it away
    if (getppid() != parent) _exit(127);
    if (!confined) report(child, obstacle);
    if (child.own_group && !child.guarded) setpgid(0, 0);
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
    report(child, error);
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

/// The files that a program's name may stand for, in the order in which they are tried: itself
/// where it holds a slash, else that name in each folder of PATH.
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

}  // namespace

StartedProgram start_program(const std::vector<std::string>& command, const ProcessOptions& options,
                             bool own_group) {
    std::vector<std::string> files = program_candidates(command[0]);
    std::vector<std::string> arguments = command;
    std::vector<std::string> environment =
        merged_environment(options.environment, options.closed_environment);
    const std::vector<char*> file_list = pointers(files);
    const std::vector<char*> argument_list = pointers(arguments);
    const std::vector<char*> environment_list = pointers(environment);
    const auto same = [](auto id) { return std::to_string(id) + ' ' + std::to_string(id) + " 1"; };
    const std::string user_map = same(geteuid()), group_map = same(getegid());
    const std::vector<Limit> limits = limits_of(options);
    const FileDescriptor input = open_standard_input(options.standard_input);
    Pipe output = make_pipe();
    Pipe errors = make_pipe();
    Pipe problem = make_pipe();
    StartedProgram started;
    started.process =
        fork_quietly({.files = file_list.data(),
                      .arguments = argument_list.data(),
                      .environment = environment_list.data(),
                      .folder = options.folder.empty() ? nullptr : options.folder.c_str(),
                      .limits = limits.data(),
                      .limit_count = limits.size(),
                      .input = input.number(),
                      .output = output.write_end.number(),
                      .errors = errors.write_end.number(),
                      .problem = problem.write_end.number(),
                      .parent = getpid(),
                      .own_group = own_group,
                      .guarded = options.guarded,
                      .no_network = options.no_network,
                      .user_map = user_map,
                      .group_map = group_map});
    // Both do it, so that the group is there for whoever comes first; a guard makes a session.
    if (own_group && !options.guarded) setpgid(started.process, started.process);
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

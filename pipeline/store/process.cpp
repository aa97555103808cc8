#include "store/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
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

#include "core/failure.h"
#include "store/folder.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// How long output of those that a program left behind is waited for after its end.
constexpr std::chrono::milliseconds patience{1000};

/// The longest time limit, far from what a clock can hold.
constexpr std::chrono::hours longest{24 * 365};

/// Tells a program of ours the number of the process that runs it.
constexpr const char* caller_variable = "RUNCERT_CALLER";

/// A program of others begins as a shell, which gets SIGTERM when its caller ends. Had the caller
/// ended before that was asked for, the shell would have another parent.
constexpr const char* becomes_program = R"([ $PPID = $0 ] && exec "$@")";
constexpr const char* guards_program =
    R"(trap 'kill -KILL 0' TERM; [ $PPID = $0 ] && exec 3<&0 && { "$@" <&3 3<&- & wait $!; })";

/// When programs are ended, where that was limited.
std::optional<Clock::time_point> last_moment;

/// The milliseconds until a moment, as poll takes them: -1 for none.
int milliseconds_until(const std::optional<Clock::time_point>& moment) {
    if (!moment) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*moment - Clock::now()).count();
    return static_cast<int>(std::clamp<decltype(left)>(left, 0, std::numeric_limits<int>::max()));
}

[[noreturn]] void fail_to_start(int error) {
    throw Failure("starting a program", std::strerror(error), "Close other programs");
}

[[noreturn]] void fail_to_start(const std::string& program, int error) {
    throw Failure(program,
                  fmt::format("the program could not be started: {}", std::strerror(error)),
                  "Install it (see packages.txt), or build the program again");
}

/// The same file under a number that is none of the three standard ones: where the caller has
/// closed its own, the program's would be put over it.
FileDescriptor above_standard(int number) {
    const FileDescriptor given(number);
    FileDescriptor moved(fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    if (moved.number() < 0) fail_to_start(errno);
    return moved;
}

FileDescriptor open_standard_input(const fs::path& given) {
    const std::string file = given.empty() ? "/dev/null" : given.string();
    const int number = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (number < 0)
        throw Failure(file, std::string("it cannot be read: ") + std::strerror(errno),
                      "Check that it is there, and that you may read it");
    return above_standard(number);
}

/// Readable when the process has ended. glibc 2.36 declares a function of its own for this that C++
/// cannot link.
FileDescriptor open_pidfd(pid_t process) {
    return FileDescriptor(static_cast<int>(syscall(SYS_pidfd_open, process, 0)));
}

/// The file of a program: of that name where it holds a slash, else the first in PATH.
std::string program_file(const std::string& name) {
    const bool is_file = name.find('/') != std::string::npos;
    const char* path = std::getenv("PATH");
    const std::string file =
        is_file ? name : find_program(path ? path : "/usr/local/bin:/usr/bin:/bin", name).string();
    if (file.empty()) fail_to_start(name, ENOENT);
    if (access(file.c_str(), X_OK) != 0) fail_to_start(name, errno);
    if (!fs::is_regular_file(file)) fail_to_start(name, EACCES);
    return file;
}

std::vector<std::string> environment_of(const ProcessOptions& options, bool is_ours) {
    auto additions = options.environment;
    if (is_ours) additions.emplace_back(caller_variable, std::to_string(getpid()));
    std::vector<std::string> merged;
    for (char** entry = environ; !options.closed_environment && *entry != nullptr; ++entry) {
        const std::string_view text = *entry;
        if (std::ranges::none_of(additions, [text](const auto& addition) {
                return text.starts_with(addition.first + "=");
            }))
            merged.emplace_back(text);
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

/// Starts a program with these files as its standard ones.
pid_t start(const std::vector<std::string>& command, const ProcessOptions& options, bool own_group,
            const std::array<FileDescriptor, 3>& standard) {
    const bool is_ours = !options.guarded && fs::path(command[0]).parent_path() == program_folder();
    std::vector<std::string> environment = environment_of(options, is_ours);
    std::vector<std::string> arguments = command;
    if (!is_ours) {
        arguments[0] = program_file(command[0]);
        arguments.insert(
            arguments.begin(),
            {"/usr/bin/setpriv", "--pdeathsig", "TERM", "--", "/bin/sh", "-c",
             options.guarded ? guards_program : becomes_program, std::to_string(getpid())});
    }
    const std::vector<char*> argument_list = pointers(arguments);
    const std::vector<char*> environment_list = pointers(environment);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (int number = 0; const FileDescriptor& file : standard)
        posix_spawn_file_actions_adddup2(&files, file.number(), number++);
    if (!options.folder.empty())
        posix_spawn_file_actions_addchdir_np(&files, options.folder.c_str());
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // What the caller ignores stays ignored, as nohup wants it; but not that by which a program
    // ends with its caller.
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGTERM);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    const int session = own_group ? POSIX_SPAWN_SETSID : 0;
    posix_spawnattr_setflags(
        &attributes, static_cast<short>(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | session));
    pid_t process = -1;
    const int error = posix_spawn(&process, arguments[0].c_str(), &files, &attributes,
                                  argument_list.data(), environment_list.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error == EAGAIN || error == ENOMEM) fail_to_start(error);
    if (error != 0) fail_to_start(arguments[0], error);
    return process;
}

/// A running program, watched to its end. None outlives this object.
class Watch {
  public:
    Watch(const std::vector<std::string>& command, const ProcessOptions& options, bool own_group)
        : own_group_(own_group), most_output_(options.most_output) {
        std::array<FileDescriptor, 3> standard{open_standard_input(options.standard_input)};
        for (const std::size_t i : {0U, 1U}) {
            std::array<int, 2> ends{};
            if (pipe2(ends.data(), O_CLOEXEC) != 0) fail_to_start(errno);
            said_[i] = FileDescriptor(ends[0]);
            standard[i + 1] = above_standard(ends[1]);
        }
        process_ = start(command, options, own_group, standard);
    }
    ~Watch() {
        if (reaped_) return;
        kill_all();
        reap();
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    /// `stop` is the number of a file that becomes readable when the program is to be ended.
    ProcessResult to_end(std::optional<Clock::time_point> deadline, int stop) {
        const FileDescriptor ended = open_pidfd(process_);
        if (!ended.is_open()) fail_to_start(errno);
        deadline_ = deadline;
        files_ = {{{said_[0].number(), POLLIN, 0},
                   {said_[1].number(), POLLIN, 0},
                   {ended.number(), POLLIN, 0},
                   {stop, POLLIN, 0}}};
        while (is_open(end_file) || is_open(0) || is_open(1)) {
            if (!is_open(end_file) && Clock::now() >= *deadline_) break;
            if (poll(files_.data(), files_.size(), milliseconds_until(deadline_)) < 0) {
                if (errno != EINTR) fail_to_start(errno);
                continue;
            }
            for (const std::size_t i : {0U, 1U})
                if (is_open(i) && files_[i].revents != 0) read_from(i);
            if (is_open(end_file)) judge();
        }
        // What is left in the pipes, which hold no more than one reading takes: who still writes
        // might never end.
        if (own_group_) kill_all();
        for (const std::size_t i : {0U, 1U})
            if (int waiting = 0;
                is_open(i) && ioctl(files_[i].fd, FIONREAD, &waiting) == 0 && waiting > 0)
                read_from(i);
        reap();
        return std::move(result_);
    }

  private:
    static constexpr std::size_t end_file = 2;
    static constexpr std::size_t stop_file = 3;

    bool is_open(std::size_t i) const { return files_[i].fd >= 0; }

    void read_from(std::size_t i) {
        const ssize_t count = read(files_[i].fd, buffer_.data(), buffer_.size());
        if (count > 0)
            (i == 0 ? result_.output : result_.errors)
                .append(buffer_.data(), static_cast<std::size_t>(count));
        else if (count == 0 || errno != EINTR)
            files_[i].fd = -1;
    }

    /// Whether the program has ended, or is to.
    void judge() {
        if (files_[end_file].revents != 0) {
            files_[end_file].fd = files_[stop_file].fd = -1;
            // Those that were ended are not listened to: one that left the group might never end.
            deadline_ = Clock::now();
            if (result_.end == ProcessEnd::by_itself) *deadline_ += patience;
        } else if (most_output_ &&
                   std::max(result_.output.size(), result_.errors.size()) > *most_output_) {
            end_it(ProcessEnd::over_output);
        } else if (files_[stop_file].revents != 0) {
            end_it(ProcessEnd::stopped);
        } else if (deadline_ && Clock::now() >= *deadline_) {
            end_it(ProcessEnd::over_time);
        }
    }

    void end_it(ProcessEnd why) {
        result_.end = why;
        files_[stop_file].fd = -1;
        deadline_.reset();
        kill_all();
    }

    /// Only before the program is reaped: its number may be another's afterwards.
    void kill_all() const { kill(own_group_ ? -process_ : process_, SIGKILL); }

    void reap() {
        int status = 0;
        rusage usage{};
        while (wait4(process_, &status, 0, &usage) < 0 && errno == EINTR) {
        }
        reaped_ = true;
        result_.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
        if (WIFSIGNALED(status)) {
            result_.signal = WTERMSIG(status);
            result_.exit_status = 128 + result_.signal;
            if (result_.end == ProcessEnd::by_itself || result_.signal != SIGKILL)
                result_.end = ProcessEnd::by_signal;
        } else {
            // Even where it was to be ended: it was faster.
            result_.exit_status = WEXITSTATUS(status);
            result_.end = ProcessEnd::by_itself;
        }
    }

    pid_t process_ = -1;
    std::array<FileDescriptor, 2> said_;  ///< output and errors
    bool own_group_;
    std::optional<std::size_t> most_output_;
    bool reaped_ = false;
    std::optional<Clock::time_point> deadline_;
    std::array<pollfd, 4> files_{};
    std::vector<char> buffer_ = std::vector<char>(65536);
    ProcessResult result_;
};

}  // namespace

void limit_time(std::chrono::seconds limit) {
    last_moment = Clock::now() + std::min<std::chrono::milliseconds>(limit, longest);
}

bool time_is_limited() {
    return last_moment.has_value();
}

void require_time() {
    if (last_moment && Clock::now() >= *last_moment)
        throw Failure("--time-limit", "the time is over, and nothing was finished",
                      "Give more time, or cut the recordings down to the runs");
}

ProcessResult run_process(const std::vector<std::string>& arguments,
                          const ProcessOptions& options) {
    require_time();
    if (options.stop.stop_requested())
        return {.exit_status = 128 + SIGKILL, .end = ProcessEnd::stopped, .signal = SIGKILL};
    const bool own_group = options.own_group || options.guarded || options.time_limit ||
                           options.most_output || options.stop.stop_possible() || last_moment;
    std::optional<Clock::time_point> deadline = last_moment;
    if (options.time_limit)
        deadline = std::min(
            Clock::now() + std::min<std::chrono::milliseconds>(*options.time_limit, longest),
            last_moment.value_or(Clock::time_point::max()));
    FileDescriptor stop;
    if (options.stop.stop_possible()) {
        stop = FileDescriptor(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
        if (stop.number() < 0) fail_to_start(errno);
    }
    const std::stop_callback wake(options.stop, [&stop] { eventfd_write(stop.number(), 1); });
    ProcessResult result = Watch(arguments, options, own_group).to_end(deadline, stop.number());
    if (result.end == ProcessEnd::over_time) require_time();
    return result;
}

void end_with_caller() {
    const char* number = std::getenv(caller_variable);
    if (number == nullptr) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // It may have ended before. A script between the two is none of this program's concern.
    const FileDescriptor caller = open_pidfd(std::atoi(number));
    pollfd ended{caller.number(), POLLIN, 0};
    if (!caller.is_open() || poll(&ended, 1, 0) != 0) _exit(128 + SIGKILL);
    unsetenv(caller_variable);
}

fs::path find_program(std::string_view path, std::string_view name) {
    while (!path.empty()) {
        const std::size_t end = std::min(path.find(':'), path.size());
        const fs::path file = fs::path(path.substr(0, end)) / name;
        std::error_code error;
        if (file.is_absolute() && fs::is_regular_file(file, error) &&
            access(file.c_str(), X_OK) == 0)
            return file;
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return {};
}

fs::path program_folder() {
    return fs::read_symlink("/proc/self/exe").parent_path();
}

TemporaryFolder::TemporaryFolder() {
    const std::string remedy = "Make room for temporary files, or set TMPDIR";
    std::error_code error;
    const fs::path parent = fs::temp_directory_path(error);
    if (error) throw Failure("the folder for temporary files", error.message(), remedy);
    std::string name = (parent / "runcert-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Failure(name, std::strerror(errno), remedy);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

}  // namespace runcert

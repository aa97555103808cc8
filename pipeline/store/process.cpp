#include "store/process.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "core/failure.h"
#include "store/process_start.h"

namespace runcert {
namespace {

using Clock = std::chrono::steady_clock;

/// How long output of those that a program left behind is waited for after its end.
constexpr std::chrono::milliseconds patience{1000};

/// The longest time limit, far from what a clock can hold.
constexpr std::chrono::hours longest{24 * 365};

/// When programs are ended, where that was limited.
std::optional<Clock::time_point> last_moment;

/// The milliseconds until a moment, as poll takes them: -1 for none.
int milliseconds_until(const std::optional<Clock::time_point>& moment) {
    if (!moment) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*moment - Clock::now()).count();
    return static_cast<int>(std::clamp<decltype(left)>(left, 0, std::numeric_limits<int>::max()));
}

/// A running program, watched to its end. None outlives this object.
class Watch {
  public:
    Watch(StartedProgram program, bool own_group, std::optional<std::size_t> most_output)
        : program_(std::move(program)),
          own_group_(own_group),
          most_output_(most_output),
          files_{{{program_.output.number(), POLLIN, 0},
                  {program_.errors.number(), POLLIN, 0},
                  {program_.ended.number(), POLLIN, 0},
                  {-1, POLLIN, 0}}} {}
    ~Watch() {
        if (reaped_) return;
        kill_all();
        reap();
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    /// `stop` is the number of a file that becomes readable when the program is to be ended.
    ProcessResult to_end(std::optional<Clock::time_point> deadline, int stop) {
        files_[stop_file].fd = stop;
        deadline_ = deadline;
        while (!has_ended_ || (is_open(0) || is_open(1))) {
            if (has_ended_ && Clock::now() >= *deadline_) break;
            if (poll(files_.data(), files_.size(), milliseconds_until(deadline_)) < 0) {
                if (errno != EINTR) fail_to_start(errno);
                continue;
            }
            for (const std::size_t i : {0U, 1U})
                if (is_open(i) && files_[i].revents != 0) read_from(i, buffer_.size());
            judge();
        }
        finish();
        return std::move(result_);
    }

    /// The error number of a program that could not be started, 0 of one that was.
    int problem() const {
        int error = 0;
        ssize_t count = 0;
        do
            count = read(program_.problem.number(), &error, sizeof error);
        while (count < 0 && errno == EINTR);
        return count == sizeof error ? error : 0;
    }

  private:
    static constexpr std::size_t end_file = 2;
    static constexpr std::size_t stop_file = 3;

    bool is_open(std::size_t i) const { return files_[i].fd >= 0; }

    void read_from(std::size_t i, std::size_t bytes) {
        const ssize_t count = read(files_[i].fd, buffer_.data(), std::min(bytes, buffer_.size()));
        if (count > 0)
            (i == 0 ? result_.output : result_.errors)
                .append(buffer_.data(), static_cast<std::size_t>(count));
        else if (count == 0 || errno != EINTR)
            files_[i].fd = -1;
    }

    /// Whether the program has ended, or is to.
    void judge() {
        if (has_ended_) return;
        if (files_[end_file].revents != 0) {
            has_ended_ = true;
            files_[end_file].fd = files_[stop_file].fd = -1;
            // Those that were ended are not listened to: one that left the group might never end.
            deadline_ = ended_by_us_ ? Clock::now() : Clock::now() + patience;
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
        ended_by_us_ = why;
        files_[stop_file].fd = -1;
        deadline_.reset();
        kill_all();
    }

    /// Only before the program is reaped: its number may be another's afterwards.
    void kill_all() const {
        if (kill(own_group_ ? -program_.process : program_.process, SIGKILL) == 0) return;
        // A guard that has no group yet: it ends all that is in it as soon as it has.
        kill(program_.process, SIGTERM);
    }

    /// Reads what is left in the pipes, ends what is left of the group, and takes the status.
    void finish() {
        if (own_group_) kill_all();
        for (const std::size_t i : {0U, 1U}) {
            int waiting = 0;
            if (!is_open(i) || ioctl(files_[i].fd, FIONREAD, &waiting) != 0) continue;
            // Never more than was there: who still writes might never end.
            for (std::string& text = i == 0 ? result_.output : result_.errors; waiting > 0;) {
                const std::size_t before = text.size();
                read_from(i, static_cast<std::size_t>(waiting));
                if (text.size() == before) break;
                waiting -= static_cast<int>(text.size() - before);
            }
        }
        reap();
    }

    void reap() {
        int status = 0;
        rusage usage{};
        while (wait4(program_.process, &status, 0, &usage) < 0 && errno == EINTR) {
        }
        reaped_ = true;
        result_.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
        if (WIFSIGNALED(status)) {
            result_.signal = WTERMSIG(status);
            result_.exit_status = 128 + result_.signal;
            const bool ours = ended_by_us_ && result_.signal == SIGKILL;
            result_.end = ours ? *ended_by_us_ : ProcessEnd::by_signal;
        } else {
            // Even where it was to be ended: it was faster.
            result_.exit_status = WEXITSTATUS(status);
        }
    }

    StartedProgram program_;
    bool own_group_;
    std::optional<std::size_t> most_output_;
    bool has_ended_ = false;
    bool reaped_ = false;
    std::optional<ProcessEnd> ended_by_us_;
    std::optional<Clock::time_point> deadline_;
    std::array<pollfd, 4> files_;
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
    Watch watch(start_program(arguments, options, own_group), own_group, options.most_output);
    const ProcessResult result = watch.to_end(deadline, stop.number());
    if (result.end == ProcessEnd::over_time) require_time();
    if (const int error = watch.problem(); error != 0)
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

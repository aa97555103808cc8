#include "measured_call.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/failure.h"

namespace runcert {
namespace {

using Clock = std::chrono::steady_clock;

/// The largest resident memory that a process has had; 0 where it is over.
std::uint64_t peak_memory_of(pid_t process) {
    std::ifstream status(fmt::format("/proc/{}/status", process));
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    return 0;
}

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

class Call {
  public:
    Call(std::vector<std::string> command, std::size_t stop_after)
        : command_(std::move(command)), stop_after_(stop_after) {
        std::vector<char*> arguments;
        for (std::string& word : command_)
            arguments.push_back(word.data());
        arguments.push_back(nullptr);
        std::array<int, 2> ends{};
        if (pipe2(ends.data(), O_CLOEXEC) != 0) fail(std::strerror(errno));
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        begin_ = Clock::now();
        const int error =
            posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        close(ends[1]);
        output_ = ends[0];
        if (error != 0) fail(std::strerror(error));
    }
    ~Call() {
        close(output_);
        if (process_ > 0 && !reaped_) {
            kill(process_, SIGTERM);
            waitpid(process_, nullptr, 0);
        }
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

    MeasuredCall to_end() {
        pollfd file{.fd = output_, .events = POLLIN, .revents = 0};
        for (bool open = true; open;) {
            if (poll(&file, 1, 10) > 0) open = read_some();
            measured_.own_peak_bytes = std::max(measured_.own_peak_bytes, peak_memory_of(process_));
        }
        take_status();
        return measured_;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Failure(fmt::format("{}", fmt::join(command_, " ")), what,
                      "Run it by hand to see what it says");
    }

    double elapsed_s() const {
        return std::chrono::duration<double>(Clock::now() - begin_).count();
    }

    bool read_some() {
        std::array<char, 65536> buffer;
        const ssize_t count = read(output_, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) return true;
        if (count <= 0) return false;
        text_.append(buffer.data(), static_cast<std::size_t>(count));
        for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
            take(nlohmann::json::parse(text_.substr(0, end)));
            text_.erase(0, end + 1);
        }
        return true;
    }

    void take(const nlohmann::json& event) {
        const std::string kind = event.at("event");
        if (kind == "step") take_step(event);
        if (kind == "attempt" && event.at("state") == "failed") trouble_ = event.at("error");
        if (kind == "attempt" && stop_after_ > 0 && ++ended_ == stop_after_) kill(process_, SIGINT);
        if (kind == "end") measured_.done = event.at("done");
    }

    /// A step is told at its end; the first attempt's steps at once.
    void take_step(const nlohmann::json& event) {
        const std::string step = event.at("step");
        if (!event.at("ran").get<bool>()) {
            ++measured_.kept;
            return;
        }
        ++measured_.ran[step];
        if (step != "claim" && measured_.first_stage_s == 0.0)
            measured_.first_stage_s = elapsed_s() - event.at("seconds").get<double>();
    }

    void take_status() {
        int status = 0;
        rusage usage{};
        while (wait4(process_, &status, 0, &usage) < 0 && errno == EINTR) {
        }
        reaped_ = true;
        measured_.wall_s = elapsed_s();
        measured_.processor_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
        measured_.largest_peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
        const int expected = stop_after_ > 0 ? 2 : 0;
        if (!WIFEXITED(status) || WEXITSTATUS(status) != expected)
            fail(fmt::format("it did not end with exit status {}. {}", expected, trouble_));
    }

    std::vector<std::string> command_;
    std::size_t stop_after_;
    std::size_t ended_ = 0;
    Clock::time_point begin_;
    pid_t process_ = 0;
    int output_ = -1;
    bool reaped_ = false;
    std::string text_;
    std::string trouble_;  ///< of the last attempt that failed
    MeasuredCall measured_;
};

}  // namespace

MeasuredCall measured_call(std::vector<std::string> command, std::size_t stop_after) {
    return Call(std::move(command), stop_after).to_end();
}

}  // namespace runcert

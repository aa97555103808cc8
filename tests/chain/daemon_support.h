#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "guardian.h"

namespace runcert::chain {

/// Waits until something holds, asking fifty times a second. Whether it did within so many
/// seconds, which are to be far more than it takes on the busiest machine.
inline bool holds_within(int seconds, const std::function<bool()>& question) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
    while (!question()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
}

/// A program that runs beside the test, what it prints in a file. It is ended with the object's
/// life, or when the test itself ends or is killed, and with it all that it started, whatever
/// sessions they made for themselves.
class Daemon {
  public:
    Daemon(std::vector<std::string> command, const std::filesystem::path& log) {
        const pid_t parent = getpid();
        guardian_ = fork();
        if (guardian_ == 0) guard(std::move(command), log, parent);
    }
    ~Daemon() {
        if (guardian_ <= 0) return;
        kill(guardian_, SIGTERM);
        waitpid(guardian_, nullptr, 0);
    }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

  private:
    // A process between the test and the program.
    [[noreturn]] static void guard(std::vector<std::string> command,
                                   const std::filesystem::path& log, pid_t parent) {
        setsid();
        test::adopt_descendants();
        sigset_t awaited;
        sigset_t before;
        sigemptyset(&awaited);
        sigaddset(&awaited, SIGTERM);
        sigaddset(&awaited, SIGCHLD);
        sigprocmask(SIG_BLOCK, &awaited, &before);
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (getppid() != parent) _exit(0);
        const pid_t program = fork();
        if (program == 0) become(std::move(command), log, before);
        bool runs = true;
        int signal = 0;
        while (sigwait(&awaited, &signal) == 0 && signal == SIGCHLD)
            for (pid_t ended = 0; (ended = waitpid(-1, nullptr, WNOHANG)) > 0;)
                runs = runs && ended != program;
        if (runs) {
            kill(program, SIGTERM);
            holds_within(5, [program] { return waitpid(program, nullptr, WNOHANG) != 0; });
        }
        test::kill_children();
        _exit(0);
    }

    [[noreturn]] static void become(std::vector<std::string> command,
                                    const std::filesystem::path& log, const sigset_t& signals) {
        std::vector<char*> words;
        for (std::string& word : command)
            words.push_back(word.data());
        words.push_back(nullptr);
        const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
        dup2(output, STDOUT_FILENO);
        dup2(output, STDERR_FILENO);
        dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
        sigprocmask(SIG_SETMASK, &signals, nullptr);
        execvp(words[0], words.data());
        _exit(127);
    }

    pid_t guardian_ = -1;
};

}  // namespace runcert::chain

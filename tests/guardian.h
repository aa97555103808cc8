#pragma once

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

// No process outlives the test that started it.

namespace runcert::test {

/// Lets what the descendants of this process leave behind become its own children, so that it knows
/// them all, whatever sessions and groups they made for themselves.
inline void adopt_descendants() {
    prctl(PR_SET_CHILD_SUBREAPER, 1);
}

/// The children of this process, those waiting to be reaped among them.
inline std::vector<pid_t> children() {
    std::ifstream list("/proc/self/task/" + std::to_string(getpid()) + "/children");
    return {std::istream_iterator<pid_t>(list), {}};
}

/// Kills the children of this process and what they leave behind, until there are none.
inline void kill_children() {
    do {
        for (const pid_t child : children())
            kill(child, SIGKILL);
    } while (waitpid(-1, nullptr, 0) > 0 || errno != ECHILD);
}

/// What a process was started as, for a message; empty where it has ended.
inline std::string command_line_of(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/cmdline", std::ios::binary);
    // A process that ends while its line is read is no error: getline then finds nothing.
    std::string words;
    std::getline(file, words, '\xff');
    std::ranges::replace(words, '\0', ' ');
    return words;
}

/// Processes that run, and are not just waiting to be reaped, with a text in their command line.
inline std::vector<pid_t> processes_with(const std::string& text) {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const pid_t number = std::atoi(entry.path().filename().c_str());
        if (number > 0 && number != getpid() &&
            command_line_of(number).find(text) != std::string::npos)
            found.push_back(number);
    }
    return found;
}

/// How long a process may take to end that was told to: it is to be a fault of the test and not of
/// a busy machine where one is left.
inline constexpr std::chrono::seconds time_to_end{20};

/// Does the work in a process of its own and returns its exit status; EXIT_FAILURE, having said
/// which, where it left a process running. Those are killed.
inline int guarded(const std::function<int()>& work) {
    adopt_descendants();
    std::fflush(nullptr);
    const pid_t worker = fork();
    if (worker == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        std::exit(work());
    }
    int status = 0;
    for (pid_t ended = 0; ended != worker;) {
        int its = 0;
        ended = waitpid(-1, &its, 0);
        if (ended == worker) status = its;
        if (ended < 0 && errno != EINTR) return EXIT_FAILURE;
    }
    const auto end = std::chrono::steady_clock::now() + time_to_end;
    while (waitpid(-1, nullptr, WNOHANG) >= 0 && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::vector<pid_t> left = children();
    for (const pid_t process : left)
        std::printf("outlived its test and is killed: process %d, %s\n", process,
                    command_line_of(process).c_str());
    std::fflush(stdout);
    kill_children();
    if (WIFSIGNALED(status)) raise(WTERMSIG(status));
    return left.empty() ? WEXITSTATUS(status) : EXIT_FAILURE;
}

}  // namespace runcert::test

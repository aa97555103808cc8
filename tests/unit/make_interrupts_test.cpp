#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

#include "days/interrupts.h"
#include "store/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace std::chrono_literals;

/// What a process of its own wrote, in which signals are as they are by default.
std::string said_by_child(const std::function<void(int to)>& work, int* status = nullptr) {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe(ends.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
        for (const int number : {SIGINT, SIGTERM, SIGHUP})
            signal(number, SIG_DFL);
        work(ends[1]);
        _exit(0);
    }
    close(ends[1]);
    std::string said;
    for (char byte = 0; read(ends[0], &byte, 1) == 1;)
        said += byte;
    close(ends[0]);
    int ended = 0;
    waitpid(child, &ended, 0);
    if (status != nullptr)
        *status = ended;
    else
        EXPECT_EQ(ended, 0);
    return said;
}

void write_text(int to, const std::string& text) {
    [[maybe_unused]] const ssize_t written = write(to, text.data(), text.size());
}

/// Waits until a condition holds, for minutes at most.
bool holds_soon(const std::function<bool()>& condition) {
    for (int i = 0; i < 24'000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(10ms);
    }
    return false;
}

std::string state_of(const Interrupts& interrupts) {
    return std::string(interrupts.finish().stop_requested() ? "F" : "-") +
           (interrupts.stop().stop_requested() ? "S" : "-");
}

TEST(Interrupts, TheFirstAsksToFinishTheSecondToStop) {
    EXPECT_EQ(said_by_child([](int to) {
                  const Interrupts interrupts([to](Interruption wanted, int signal) {
                      write_text(to, std::to_string(signal) +
                                         (wanted == Interruption::finish ? "f" : "s"));
                  });
                  write_text(to, state_of(interrupts));
                  kill(getpid(), SIGINT);
                  holds_soon([&] { return interrupts.finish().stop_requested(); });
                  write_text(to, state_of(interrupts));
                  kill(getpid(), SIGINT);
                  holds_soon([&] { return interrupts.stop().stop_requested(); });
                  write_text(to, state_of(interrupts));
                  // A third changes nothing.
                  kill(getpid(), SIGINT);
                  std::this_thread::sleep_for(50ms);
              }),
              "--2fF-2sFS");
}

TEST(Interrupts, TerminationAndHangUpStopAtOnce) {
    for (const int number : {SIGTERM, SIGHUP})
        EXPECT_EQ(said_by_child([number](int to) {
                      const Interrupts interrupts;
                      kill(getpid(), number);
                      holds_soon([&] { return interrupts.stop().stop_requested(); });
                      write_text(to, state_of(interrupts));
                  }),
                  "FS");
}

TEST(Interrupts, StopCallbacksEndProgramsThatRun) {
    EXPECT_EQ(
        said_by_child([](int to) {
            const Interrupts interrupts;
            std::thread asks([] {
                std::this_thread::sleep_for(300ms);
                kill(getpid(), SIGTERM);
            });
            const ProcessResult result = run_process({"sleep", "600"}, {.stop = interrupts.stop()});
            asks.join();
            write_text(to, result.end == ProcessEnd::stopped ? "stopped" : "not stopped");
        }),
        "stopped");
}

TEST(Interrupts, ProgramsOfAnOwnGroupDoNotHearTheTerminal) {
    // As Ctrl-C does it: to every process of the group.
    EXPECT_EQ(said_by_child([](int to) {
                  setpgid(0, 0);
                  const Interrupts interrupts;
                  std::thread asks([] {
                      std::this_thread::sleep_for(300ms);
                      kill(0, SIGINT);
                  });
                  const ProcessResult result = run_process({"sh", "-c", "sleep 1; printf whole"},
                                                           {.stop = interrupts.stop()});
                  asks.join();
                  write_text(to, result.output + state_of(interrupts));
              }),
              "wholeF-");
}

TEST(Interrupts, TheHandlersBeforeAreThereAgain) {
    int status = 0;
    said_by_child(
        [](int) {
            { const Interrupts interrupts; }
            kill(getpid(), SIGINT);
            std::this_thread::sleep_for(30s);
        },
        &status);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), SIGINT);
}

TEST(Interrupts, OneAfterTheOtherEachHearsItsOwn) {
    EXPECT_EQ(said_by_child([](int to) {
                  for (int i = 0; i < 3; ++i) {
                      const Interrupts interrupts;
                      write_text(to, state_of(interrupts));
                      kill(getpid(), SIGTERM);
                      holds_soon([&] { return interrupts.stop().stop_requested(); });
                      write_text(to, state_of(interrupts));
                  }
              }),
              "--FS--FS--FS");
}

TEST(Interrupts, WhatWasIgnoredStaysIgnored) {
    EXPECT_EQ(said_by_child([](int to) {
                  signal(SIGHUP, SIG_IGN);
                  const Interrupts interrupts;
                  kill(getpid(), SIGHUP);
                  kill(getpid(), SIGINT);
                  holds_soon([&] { return interrupts.finish().stop_requested(); });
                  write_text(to, state_of(interrupts));
              }),
              "F-");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

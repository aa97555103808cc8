#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "core/text.h"
#include "guardian.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store_test_support.h"

// Programs that hang, crash, leave others behind, or are stopped.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::failure_of;
using Clock = std::chrono::steady_clock;

/// Far more than any of these programs takes that is ended, on a busy machine; far less than the
/// minutes they sleep.
constexpr auto soon = 240s;

ProcessResult shell(const std::string& script, const ProcessOptions& options) {
    return run_process({"sh", "-c", script}, options);
}

/// Whether a process runs: one that is dead and not yet taken note of does not.
bool runs(const std::string& number) {
    std::ifstream file("/proc/" + std::string(trim(number)) + "/stat");
    std::string stat;
    std::getline(file, stat);
    const std::size_t after_name = stat.rfind(") ");
    return after_name != std::string::npos && stat.at(after_name + 2) != 'Z' &&
           stat.at(after_name + 2) != 'X';
}

bool is_gone_soon(const std::string& number) {
    for (const auto end = Clock::now() + soon; Clock::now() < end;
         std::this_thread::sleep_for(10ms))
        if (!runs(number)) return true;
    return false;
}

std::size_t open_files() {
    const fs::directory_iterator files("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

class ProcessControl : public testing::Test {
  protected:
    void SetUp() override { began_ = Clock::now(); }
    void TearDown() override {
        EXPECT_LT(Clock::now() - began_, soon);
        // No zombie is left.
        EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
        EXPECT_EQ(errno, ECHILD);
        EXPECT_EQ(open_files(), open_before_);
    }
    std::string number_in(const std::string& name) {
        const fs::path file = folder_.path() / name;
        for (const auto end = Clock::now() + soon; Clock::now() < end;
             std::this_thread::sleep_for(5ms))
            if (fs::exists(file) && read_file(file).ends_with('\n')) return read_file(file);
        ADD_FAILURE() << name << " was not written";
        return "1";
    }
    ProcessOptions in_folder(ProcessOptions options) {
        options.environment.emplace_back("F", folder_.path().string());
        return options;
    }

    TemporaryFolder folder_;
    std::size_t open_before_ = open_files();
    Clock::time_point began_;
};

// Of seconds, so that a busy machine gets as far as the sleep.
TEST_F(ProcessControl, ATimeLimitEndsTheProgramAndAllItStarted) {
    const ProcessResult result =
        shell("printf said; (sh -c 'echo $$ > $F/grandchild; sleep 600'; true) & sleep 600",
              in_folder({.time_limit = 6s}));
    EXPECT_EQ(result.end, ProcessEnd::over_time);
    EXPECT_EQ(result.signal, SIGKILL);
    EXPECT_EQ(result.exit_status, 128 + SIGKILL);
    EXPECT_EQ(result.output, "said");
    EXPECT_TRUE(is_gone_soon(number_in("grandchild")));
    EXPECT_GE(Clock::now() - began_, 6s);
}

TEST_F(ProcessControl, ATimeLimitOfNothingEndsItAtOnce) {
    EXPECT_EQ(shell("sleep 600", {.time_limit = 0ms}).end, ProcessEnd::over_time);
    EXPECT_EQ(shell("exit 3", {.time_limit = std::chrono::milliseconds::max()}).exit_status, 3);
}

TEST_F(ProcessControl, OutputWithoutEndEndsTheProgram) {
    for (const char* script : {"yes", "yes >&2", "sleep 600 & yes"}) {
        const ProcessResult result = shell(script, {.most_output = 100'000});
        EXPECT_EQ(result.end, ProcessEnd::over_output) << script;
        EXPECT_EQ(result.signal, SIGKILL);
        EXPECT_GT(result.output.size() + result.errors.size(), 100'000U);
        // And no more than the pipe and one reading of it beyond.
        EXPECT_LT(result.output.size() + result.errors.size(), 500'000U);
    }
    const ProcessResult result = shell("head -c 100000 /dev/zero", {.most_output = 100'000});
    EXPECT_EQ(result.end, ProcessEnd::by_itself);
    EXPECT_EQ(result.output.size(), 100'000U);
}

TEST_F(ProcessControl, AProgramThatIgnoresSigtermIsEndedToo) {
    EXPECT_EQ(shell("trap '' TERM INT HUP; sleep 600; sleep 600", {.time_limit = 300ms}).end,
              ProcessEnd::over_time);
}

TEST_F(ProcessControl, AProgramThatClosesItsOutputIsStillWatched) {
    EXPECT_EQ(shell("exec >&- 2>&-; sleep 600", {.time_limit = 500ms}).end, ProcessEnd::over_time);
    // And one that ends afterwards by itself is waited for.
    const ProcessResult result = shell("exec >&- 2>&-; sleep 0.3; exit 7", {.time_limit = 15s});
    EXPECT_EQ(result.end, ProcessEnd::by_itself);
    EXPECT_EQ(result.exit_status, 7);
}

TEST_F(ProcessControl, WhoLeftTheGroupAndHoldsThePipeIsNotWaitedFor) {
    const ProcessResult result = shell(
        "setsid sh -c 'echo $$ > $F/other; exec sleep 600' & while [ ! -s $F/other ]; do :; done; "
        "printf said; sleep 600",
        in_folder({.time_limit = 6s}));
    EXPECT_EQ(result.end, ProcessEnd::over_time);
    EXPECT_EQ(result.output, "said");
    const std::string other = number_in("other");
    EXPECT_TRUE(runs(other));
    kill(static_cast<pid_t>(*parse_integer(trim(other))), SIGKILL);
}

TEST_F(ProcessControl, WhoIsLeftBehindIsNotWaitedForForEver) {
    // Silent, and never silent.
    for (const std::string& leaves : {std::string("sleep 600"), std::string("exec yes")}) {
        const ProcessResult result =
            shell("printf 'said\\n'; sh -c 'echo $$ > $F/left; " + leaves + "' & exit 4",
                  in_folder({.own_group = true}));
        EXPECT_EQ(result.end, ProcessEnd::by_itself);
        EXPECT_EQ(result.exit_status, 4);
        EXPECT_TRUE(result.output.starts_with("said\n"));
        EXPECT_TRUE(is_gone_soon(number_in("left"))) << leaves;
        fs::remove(folder_.path() / "left");
    }
    // In the caller's group it lives on.
    EXPECT_EQ(shell("echo $$ > $F/left; sleep 600 & echo $! > $F/left; exit 5", in_folder({}))
                  .exit_status,
              5);
    const std::string left = number_in("left");
    EXPECT_TRUE(runs(left));
    kill(static_cast<pid_t>(*parse_integer(trim(left))), SIGKILL);
}

TEST_F(ProcessControl, OutputThatComesALittleAfterTheEndIsRead) {
    EXPECT_EQ(shell("(sleep 0.2; printf late) & printf now", {}).output, "nowlate");
}

TEST_F(ProcessControl, AStopEndsTheProgramAndAllItStarted) {
    std::stop_source source;
    std::thread asks([&] {
        number_in("grandchild");
        source.request_stop();
    });
    const ProcessResult result = shell("sh -c 'echo $$ > $F/grandchild; sleep 600'; true",
                                       in_folder({.stop = source.get_token()}));
    asks.join();
    EXPECT_EQ(result.end, ProcessEnd::stopped);
    EXPECT_EQ(result.signal, SIGKILL);
    EXPECT_TRUE(is_gone_soon(number_in("grandchild")));
}

TEST_F(ProcessControl, AStopBeforehandBeginsNothing) {
    std::stop_source source;
    source.request_stop();
    EXPECT_EQ(shell("touch $F/begun", in_folder({.stop = source.get_token()})).end,
              ProcessEnd::stopped);
    EXPECT_FALSE(fs::exists(folder_.path() / "begun"));
}

TEST_F(ProcessControl, AStopThatNeverComesChangesNothing) {
    std::stop_source source;
    const ProcessResult result =
        shell("printf out; exit 3", {.time_limit = 15s, .stop = source.get_token()});
    EXPECT_EQ(result.end, ProcessEnd::by_itself);
    EXPECT_EQ(result.exit_status, 3);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.output, "out");
}

TEST_F(ProcessControl, ACrashIsNotTakenForAStop) {
    const ProcessResult result = shell("kill -SEGV $$", {.time_limit = 15s});
    EXPECT_EQ(result.end, ProcessEnd::by_signal);
    EXPECT_EQ(result.signal, SIGSEGV);
    EXPECT_EQ(shell("kill -KILL $$", {.time_limit = 15s}).end, ProcessEnd::by_signal);
}

TEST_F(ProcessControl, TheGroupIsItsOwnOnlyWhereAsked) {
    const std::string own_group = std::to_string(getpgrp()) + "\n";
    const std::string script = "ps -o pgid= -p $$ | tr -d ' '";
    EXPECT_EQ(shell(script, {}).output, own_group);
    EXPECT_NE(shell(script, {.own_group = true}).output, own_group);
    EXPECT_NE(shell(script, {.time_limit = 15s}).output, own_group);
    EXPECT_NE(shell(script, {.stop = std::stop_source().get_token()}).output, own_group);
}

TEST_F(ProcessControl, BeginsWithNoSignalBlocked) {
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const std::string status = run_process({"grep", "SigBlk", "/proc/self/status"}).output;
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    EXPECT_EQ(status, "SigBlk:\t0000000000000000\n");
}

TEST_F(ProcessControl, SaysThePeakOfMemory) {
    constexpr std::uint64_t mebibyte = 1U << 20U;
    // No program's is less than that of its caller, which a sanitizer makes large.
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const std::uint64_t own = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    const ProcessResult small = shell("true", {});
    const ProcessResult large =
        run_process({"/usr/bin/python3", "-c", "x = bytearray(b'x') * (300 << 20); print(len(x))"});
    ASSERT_EQ(large.exit_status, 0) << large.errors;
    EXPECT_GT(small.peak_memory_bytes, mebibyte / 4);
    EXPECT_LT(small.peak_memory_bytes, own + 30 * mebibyte);
    EXPECT_GE(large.peak_memory_bytes, 300 * mebibyte);
    EXPECT_LT(large.peak_memory_bytes, own + 400 * mebibyte);
    // Of a program that its own child's memory is counted for.
    EXPECT_GE(shell("/usr/bin/python3 -c \"x = bytearray(b'x') * (100 << 20)\"; true", {})
                  .peak_memory_bytes,
              100 * mebibyte);
}

TEST_F(ProcessControl, ManyAtOnceDoNotMixWhatTheySay) {
    std::stop_source source;
    std::vector<std::thread> threads;
    std::vector<int> wrong(8, 0);
    for (std::size_t t = 0; t < wrong.size(); ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 25; ++i) {
                const std::string text = std::to_string(t) + "." + std::to_string(i);
                const ProcessResult result = shell(
                    "cat; printf %s $T; exit " + std::to_string(i),
                    {.environment = {{"T", text}}, .time_limit = 60s, .stop = source.get_token()});
                if (result.output != text || result.exit_status != i) ++wrong[t];
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(std::count(wrong.begin(), wrong.end(), 0), 8);
}

TEST_F(ProcessControl, OneStopEndsManyAtOnce) {
    std::stop_source source;
    std::vector<std::thread> threads;
    std::vector<ProcessEnd> ends(8, ProcessEnd::by_itself);
    for (std::size_t t = 0; t < ends.size(); ++t)
        threads.emplace_back([&, t] {
            ends[t] = shell("echo x > $F/" + std::to_string(t) + "; sleep 600",
                            in_folder({.stop = source.get_token()}))
                          .end;
        });
    for (std::size_t t = 0; t < ends.size(); ++t)
        number_in(std::to_string(t));
    source.request_stop();
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(std::count(ends.begin(), ends.end(), ProcessEnd::stopped), 8);
}

TEST_F(ProcessControl, AStandardInputThatCannotBeReadIsNamed) {
    const std::string missing = (folder_.path() / "missing").string();
    const auto said = failure_of([&] { run_process({"cat"}, {.standard_input = missing}); });
    EXPECT_EQ(said.where, missing);
    EXPECT_TRUE(said.contains("No such file"));
}

TEST_F(ProcessControl, DiesWithItsCaller) {
    const pid_t caller = fork();
    ASSERT_GE(caller, 0);
    if (caller == 0) {
        shell("echo $$ > $F/child; exec sleep 600", in_folder({.time_limit = 600s}));
        _exit(0);
    }
    const std::string child = number_in("child");
    kill(caller, SIGKILL);
    waitpid(caller, nullptr, 0);
    EXPECT_TRUE(is_gone_soon(child));
}

TEST_F(ProcessControl, NothingIsLeftOfOneWhoseCallerIsKilledWhileItBegins) {
    const std::string named = folder_.path().string();
    for (int i = 0; i < 40; ++i) {
        const pid_t caller = fork();
        ASSERT_GE(caller, 0);
        if (caller == 0) {
            run_process({"sh", "-c", "exec sleep 600", named}, {.own_group = i % 2 == 0});
            _exit(0);
        }
        std::this_thread::sleep_for(std::chrono::microseconds(200 * i));
        kill(caller, SIGKILL);
        waitpid(caller, nullptr, 0);
    }
    const auto is_left = [&] { return !test::processes_with(named).empty(); };
    for (int tries = 0; tries < 6000 && is_left(); ++tries)
        std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(is_left());
}

TEST_F(ProcessControl, OneOfOursEndsWithItsCaller) {
    const pid_t caller = fork();
    ASSERT_GE(caller, 0);
    if (caller == 0) {
        setenv("RUNCERT_CALLER", std::to_string(getpid()).c_str(), 1);
        if (fork() > 0) pause();
        end_with_caller();
        write_file_atomically(folder_.path() / "child", std::to_string(getpid()) + "\n");
        pause();
    }
    const std::string child = number_in("child");
    EXPECT_TRUE(runs(child));
    kill(caller, SIGKILL);
    waitpid(caller, nullptr, 0);
    EXPECT_TRUE(is_gone_soon(child));
}

// Dead and not yet taken note of, or gone altogether.
TEST_F(ProcessControl, OneOfOursWhoseCallerHasEndedDoesNotBegin) {
    for (const bool taken_note_of : {false, true}) {
        const pid_t caller = fork();
        if (caller == 0) _exit(0);
        siginfo_t ended{};
        waitid(P_PID, static_cast<id_t>(caller), &ended, WEXITED | (taken_note_of ? 0 : WNOWAIT));
        const pid_t ours = fork();
        if (ours == 0) {
            setenv("RUNCERT_CALLER", std::to_string(caller).c_str(), 1);
            end_with_caller();
            _exit(0);
        }
        int status = 0;
        waitpid(ours, &status, 0);
        EXPECT_EQ(WEXITSTATUS(status), 128 + SIGKILL);
        if (!taken_note_of) waitpid(caller, nullptr, 0);
    }
}

// A script may stand between the two, and nothing that a program of ours runs is told.
TEST_F(ProcessControl, OneOfOursWhoseCallerLivesGoesOn) {
    const pid_t ours = fork();
    if (ours == 0) {
        setenv("RUNCERT_CALLER", std::to_string(getppid()).c_str(), 1);
        if (fork() > 0) {
            int status = 1;
            wait(&status);
            _exit(WEXITSTATUS(status));
        }
        end_with_caller();
        _exit(std::getenv("RUNCERT_CALLER") == nullptr ? 0 : 2);
    }
    int status = 1;
    waitpid(ours, &status, 0);
    EXPECT_EQ(status, 0);
}

TEST_F(ProcessControl, AGuardedProgramDiesWithItsCallerAndSoDoesItsGroup) {
    const pid_t caller = fork();
    ASSERT_GE(caller, 0);
    if (caller == 0) {
        shell(
            "trap '' TERM; (echo $(exec sh -c 'echo $PPID') > $F/grandchild; sleep 600; true) & "
            "echo $$ > $F/child; sleep 600; true",
            in_folder({.guarded = true}));
        _exit(0);
    }
    const std::string child = number_in("child");
    const std::string grandchild = number_in("grandchild");
    kill(caller, SIGKILL);
    waitpid(caller, nullptr, 0);
    EXPECT_TRUE(is_gone_soon(child));
    EXPECT_TRUE(is_gone_soon(grandchild));
}

TEST_F(ProcessControl, AGuardedProgramEndsAsOneWithoutAGuard) {
    const auto guarded = [&](const std::string& script, ProcessOptions options = {}) {
        options.guarded = true;
        return shell(script, in_folder(std::move(options)));
    };
    const ProcessResult exited = guarded("printf out; printf err >&2; exit 7");
    EXPECT_EQ(exited.output + exited.errors, "outerr");
    EXPECT_EQ(exited.exit_status, 7);
    EXPECT_EQ(exited.end, ProcessEnd::by_itself);
    for (const int signal : {SIGSEGV, SIGKILL, SIGTERM})
        EXPECT_EQ(guarded(fmt::format("kill -{} $$", signal)).exit_status, 128 + signal);
    const std::string input = (folder_.path() / "input").string();
    write_file_atomically(input, "given");
    // The guard keeps the standard input as number 3, and what ran this test may have left a file
    // open there.
    fcntl(3, F_SETFD, FD_CLOEXEC);
    const std::string reads = "cat; ls /proc/$$/fd";
    EXPECT_EQ(guarded(reads, {.standard_input = input}).output,
              shell(reads, {.standard_input = input}).output);
    EXPECT_EQ(guarded("sleep 600", {.time_limit = 0ms}).end, ProcessEnd::over_time);
    EXPECT_EQ(guarded("sleep 600", {.time_limit = 300ms}).end, ProcessEnd::over_time);
    EXPECT_EQ(guarded("yes", {.most_output = 100'000}).end, ProcessEnd::over_output);
    // It has a session without a terminal, and all that it started ends with it.
    EXPECT_EQ(guarded("ps -o tty= -p $$ | tr -d ' '").output, "?\n");
    EXPECT_EQ(guarded("sleep 600 & echo $! > $F/left; exit 4").exit_status, 4);
    EXPECT_TRUE(is_gone_soon(number_in("left")));
    const auto said = failure_of([] { run_process({"no such program"}, {.guarded = true}); });
    EXPECT_TRUE(said.contains("could not be started")) << said.problem;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

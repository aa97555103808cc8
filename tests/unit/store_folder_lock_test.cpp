#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "store/atomic_file.h"
#include "store/folder_lock.h"
#include "store/process.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Runs a function in a process of its own, which says "ready" by a byte and then sleeps.
class OtherProcess {
  public:
    explicit OtherProcess(const std::function<void()>& work) {
        EXPECT_EQ(pipe(ready_.data()), 0);
        process_ = fork();
        if (process_ == 0) {
            work();
            [[maybe_unused]] const ssize_t written = write(ready_[1], "x", 1);
            pause();
            _exit(0);
        }
        close(ready_[1]);
        char byte = 0;
        EXPECT_EQ(read(ready_[0], &byte, 1), 1);
    }
    ~OtherProcess() { end(); }
    OtherProcess(const OtherProcess&) = delete;
    OtherProcess& operator=(const OtherProcess&) = delete;
    pid_t number() const { return process_; }
    void end() {
        if (process_ <= 0) return;
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
        close(ready_[0]);
        process_ = -1;
    }

  private:
    std::array<int, 2> ready_{};
    pid_t process_ = -1;
};

Folder folder_of_lock(const fs::path& file) {
    make_directory(file.parent_path());
    return Folder(file.parent_path());
}

FolderLock::Attempt try_lock(const fs::path& file, LockKind kind) {
    return FolderLock::try_lock(folder_of_lock(file), file.filename().string(), kind);
}

template <class... More>
std::optional<FolderLock> wait_lock(const fs::path& file, LockKind kind, const More&... more) {
    return FolderLock::wait_lock(folder_of_lock(file), file.filename().string(), kind, more...);
}

class FolderLocks : public testing::Test {
  protected:
    FolderLock::Attempt attempt(LockKind kind = LockKind::exclusive) const {
        return try_lock(file_, kind);
    }
    TemporaryFolder folder_;
    fs::path file_ = folder_.path() / "locks" / "day";
};

/// Holds a lock for as long as its process lives.
std::function<void()> holder_of(const fs::path& file, LockKind kind) {
    return [file, kind] {
        static std::optional<FolderLock> held;
        FolderLock::Attempt taken = try_lock(file, kind);
        if (!taken.lock) _exit(1);
        held.emplace(std::move(*taken.lock));
    };
}

TEST_F(FolderLocks, SaysWhoHasIt) {
    const OtherProcess other(holder_of(file_, LockKind::exclusive));
    for (const LockKind kind : {LockKind::exclusive, LockKind::shared}) {
        const FolderLock::Attempt refused = attempt(kind);
        EXPECT_FALSE(refused.lock);
        std::array<char, 256> host{};
        gethostname(host.data(), host.size() - 1);
        const std::string begin =
            "process " + std::to_string(other.number()) + " on " + host.data() + ", since ";
        ASSERT_TRUE(refused.holder.starts_with(begin)) << refused.holder;
        EXPECT_TRUE(std::regex_match(refused.holder.substr(begin.size()),
                                     std::regex(R"(20\d\d-\d\d-\d\d \d\d:\d\d:\d\d UTC)")))
            << refused.holder;
    }
}

TEST_F(FolderLocks, AnotherLockOfTheSameProcessWaitsToo) {
    const FolderLock::Attempt first = attempt();
    ASSERT_TRUE(first.lock);
    EXPECT_FALSE(attempt().lock);
}

TEST_F(FolderLocks, IsFreeAfterItsHolder) {
    {
        const FolderLock::Attempt first = attempt();
        ASSERT_TRUE(first.lock);
        EXPECT_EQ(first.lock->left_by(), "");
    }
    const FolderLock::Attempt second = attempt();
    ASSERT_TRUE(second.lock);
    EXPECT_EQ(second.lock->left_by(), "");
}

TEST_F(FolderLocks, OneLeftByADeadProcessIsTakenOverAndRecognised) {
    OtherProcess other(holder_of(file_, LockKind::exclusive));
    const std::string holder = attempt().holder;
    other.end();
    {
        const FolderLock::Attempt taken = attempt();
        ASSERT_TRUE(taken.lock);
        EXPECT_EQ(taken.lock->left_by(), holder);
        const std::string text = read_file(file_);
        EXPECT_EQ(text.find(holder), std::string::npos) << text;
        EXPECT_TRUE(text.starts_with("held by process " + std::to_string(getpid()) + " on "));
    }
    EXPECT_EQ(attempt().lock->left_by(), "");
}

TEST_F(FolderLocks, WhatADeadProcessWasJustStartingIsWaitedFor) {
    OtherProcess other([file = file_] {
        holder_of(file, LockKind::exclusive)();
        // A program that is started has the lock until it has replaced its caller's copy.
        if (fork() == 0) {
            usleep(300'000);
            _exit(0);
        }
    });
    EXPECT_FALSE(attempt().lock);
    other.end();
    EXPECT_TRUE(attempt().lock);
}

TEST_F(FolderLocks, SharedOnesGoTogetherAndExcludeAnExclusiveOne) {
    OtherProcess first(holder_of(file_, LockKind::shared));
    OtherProcess second(holder_of(file_, LockKind::shared));
    {
        const FolderLock::Attempt third = attempt(LockKind::shared);
        ASSERT_TRUE(third.lock);
    }
    std::string holder = attempt().holder;
    EXPECT_TRUE(holder.starts_with("process " + std::to_string(second.number()) + " "));
    EXPECT_TRUE(holder.ends_with(" and 1 more")) << holder;
    // One that died is not named any more.
    second.end();
    holder = attempt().holder;
    EXPECT_TRUE(holder.starts_with("process " + std::to_string(first.number()) + " ")) << holder;
    EXPECT_TRUE(holder.ends_with(" UTC")) << holder;
    first.end();
    EXPECT_TRUE(attempt().lock);
}

TEST_F(FolderLocks, ProgramsThatAreStartedDoNotInheritIt) {
    const fs::path number = folder_.path() / "number";
    OtherProcess other([&] {
        holder_of(file_, LockKind::exclusive)();
        const std::string command =
            "sleep 600 > /dev/null 2>&1 & echo $! > '" + number.string() + "'";
        if (std::system(command.c_str()) != 0) _exit(1);
    });
    const pid_t started = std::stoi(read_file(number));
    EXPECT_FALSE(attempt().lock);
    other.end();
    EXPECT_TRUE(attempt().lock);
    EXPECT_EQ(kill(started, SIGKILL), 0);
}

/// Runs a function in several processes at once, and waits for them all.
void in_processes(int count, const std::function<void()>& work) {
    std::vector<pid_t> processes(static_cast<std::size_t>(count));
    for (pid_t& process : processes)
        if ((process = fork()) == 0) {
            work();
            _exit(0);
        }
    for (const pid_t process : processes) {
        int status = 0;
        waitpid(process, &status, 0);
        EXPECT_EQ(status, 0);
    }
}

/// Adds one to the number in a file, in steps that another would disturb.
void add_one(const fs::path& count) {
    const int before = std::stoi(read_file(count));
    std::this_thread::sleep_for(100us);
    test::spill(count, std::to_string(before + 1));
}

TEST_F(FolderLocks, OneAtATimeOfManyProcesses) {
    const fs::path count = folder_.path() / "count";
    test::spill(count, "0");
    in_processes(8, [&] {
        for (int i = 0; i < 5; ++i) {
            const auto lock = wait_lock(file_, LockKind::exclusive, std::stop_source().get_token());
            add_one(count);
        }
    });
    EXPECT_EQ(read_file(count), "40");
}

TEST_F(FolderLocks, OneAtATimeEvenWhereEachRemovesTheFileAtItsEnd) {
    // Whoever opened the file before it was removed holds nothing that others would see.
    const fs::path count = folder_.path() / "count";
    test::spill(count, "0");
    in_processes(4, [&] {
        for (int taken = 0; taken < 200;) {
            const FolderLock::Attempt now = attempt();
            if (!now.lock) continue;
            add_one(count);
            fs::remove(file_);
            ++taken;
        }
    });
    EXPECT_EQ(read_file(count), "800");
}

TEST_F(FolderLocks, WaitingSaysForWhomAndEndsWhenItIsFree) {
    OtherProcess other(holder_of(file_, LockKind::exclusive));
    std::vector<std::string> told;
    std::thread ends([&] {
        std::this_thread::sleep_for(700ms);
        other.end();
    });
    const auto lock = wait_lock(file_, LockKind::exclusive, std::stop_source().get_token(),
                                [&](const std::string& who) { told.push_back(who); });
    ends.join();
    EXPECT_TRUE(lock);
    ASSERT_EQ(told.size(), 1U);
    EXPECT_TRUE(told[0].starts_with("process ")) << told[0];
}

TEST_F(FolderLocks, WaitingCanBeStopped) {
    const OtherProcess other(holder_of(file_, LockKind::exclusive));
    std::stop_source source;
    std::thread asks([&] {
        std::this_thread::sleep_for(100ms);
        source.request_stop();
    });
    const auto lock = wait_lock(file_, LockKind::exclusive, source.get_token());
    asks.join();
    EXPECT_FALSE(lock);
}

TEST_F(FolderLocks, TheTextOfAnotherIsPrintedHarmlessly) {
    const OtherProcess other(holder_of(file_, LockKind::exclusive));
    test::spill(file_, "held by \x1b[31m process\n");
    EXPECT_EQ(attempt().holder, "\\x1b[31m process");
    for (const std::string& text :
         {std::string(), std::string(300000, 'x'), std::string("\0\n", 2)}) {
        test::spill(file_, text);
        EXPECT_EQ(attempt().holder, "another process");
    }
}

TEST_F(FolderLocks, AFileThatWasReplacedIsLockedAnew) {
    const FolderLock::Attempt old = attempt();
    fs::remove_all(file_.parent_path());
    const FolderLock::Attempt anew = attempt();
    ASSERT_TRUE(anew.lock);
    EXPECT_FALSE(attempt().lock);
}

TEST_F(FolderLocks, AFolderOfThatNameIsAFailure) {
    fs::create_directories(file_);
    const auto said = test::failure_of([&] { attempt(); });
    EXPECT_EQ(said.where, file_.string());
    EXPECT_TRUE(said.contains("Is a directory")) << said.problem;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

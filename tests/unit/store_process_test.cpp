#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include "store/process.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::failure_of;

ProcessResult shell(const std::string& script,
                    const std::vector<std::pair<std::string, std::string>>& environment = {}) {
    return run_process({"sh", "-c", script}, {.environment = environment});
}

TEST(RunProcess, ReturnsWhatTheProgramSaidAndItsStatus) {
    const ProcessResult result = shell("printf out; printf err >&2; exit 3");
    EXPECT_EQ(result.output, "out");
    EXPECT_EQ(result.errors, "err");
    EXPECT_EQ(result.exit_status, 3);
    EXPECT_EQ(run_process({"/bin/true"}).exit_status, 0);
}

TEST(RunProcess, ASilentStatusOf127IsAStatus) {
    EXPECT_EQ(shell("exit 127").exit_status, 127);
}

TEST(RunProcess, ASignalIs128AndItsNumber) {
    EXPECT_EQ(shell("kill -KILL $$").exit_status, 128 + SIGKILL);
    const ProcessResult result = shell("printf said; kill -TERM $$");
    EXPECT_EQ(result.exit_status, 128 + SIGTERM);
    EXPECT_EQ(result.output, "said");
}

TEST(RunProcess, AProgramThatCannotBeStartedIsNamed) {
    const TemporaryFolder folder;
    test::spill(folder.path() / "not_executable", "x");
    const struct {
        std::string program, said;
    } cases[] = {
        {"runcert-no-such-program", "No such file"},
        {"/no/such/program", "No such file"},
        {(folder.path() / "not_executable").string(), "Permission denied"},
        {folder.path().string(), "Permission denied"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { run_process({c.program, "argument"}); });
        EXPECT_EQ(said.where, c.program);
        EXPECT_TRUE(said.contains(c.said)) << said.problem;
        EXPECT_TRUE(said.contains("packages.txt"));
    }
}

TEST(RunProcess, ArgumentsArriveAsTheyAre) {
    const std::string odd = "a b\n\"c\" '$HOME' * \xe2\x82\xac";
    EXPECT_EQ(run_process({"printf", "%s|", odd, "", "-x"}).output, odd + "||-x|");
}

TEST(RunProcess, AddsToTheEnvironment) {
    setenv("RUNCERT_TEST_KEPT", "kept", 1);
    setenv("RUNCERT_TEST", "old", 1);
    EXPECT_EQ(shell("echo $RUNCERT_TEST $RUNCERT_TEST_KEPT $RUNCERT_TEST_NEW",
                    {{"RUNCERT_TEST", "a=b"}, {"RUNCERT_TEST_NEW", "new"}})
                  .output,
              "a=b kept new\n");
    EXPECT_EQ(shell("env | grep -c ^RUNCERT_TEST=", {{"RUNCERT_TEST", "x"}}).output, "1\n");
    EXPECT_STREQ(getenv("RUNCERT_TEST"), "old");
    unsetenv("RUNCERT_TEST");
    unsetenv("RUNCERT_TEST_KEPT");
}

TEST(RunProcess, StandardInputIsEmpty) {
    const ProcessResult result = run_process({"cat"});
    EXPECT_EQ(result.exit_status, 0);
    EXPECT_EQ(result.output, "");
}

TEST(RunProcess, LargeOutputOnBothPipesDoesNotBlock) {
    // Each far beyond what a pipe holds, one after the other and in turns.
    const ProcessResult result = shell(
        "head -c 3000000 /dev/zero >&2; head -c 3000000 /dev/zero;"
        "for i in 1 2 3 4; do head -c 100000 /dev/zero; head -c 100000 /dev/zero >&2; done");
    EXPECT_EQ(result.output.size(), 3'400'000U);
    EXPECT_EQ(result.errors.size(), 3'400'000U);
}

TEST(RunProcess, LeavesNoFileOpen) {
    const auto open_files = [] {
        int count = 0;
        for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd"))
            ++count;
        return count;
    };
    const int before = open_files();
    shell("exit 0");
    failure_of([] { run_process({"runcert-no-such-program"}); });
    EXPECT_EQ(open_files(), before);
}

TEST(RunProcess, WorksWhereTheCallerHasClosedItsOwnInputAndOutput) {
    const int in = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 10);
    const int out = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 10);
    const int err = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 10);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        close(file);
    const ProcessResult result = shell("cat; printf out; printf err >&2");
    for (const auto& [from, to] : {std::pair{in, STDIN_FILENO}, std::pair{out, STDOUT_FILENO},
                                   std::pair{err, STDERR_FILENO}}) {
        dup2(from, to);
        close(from);
    }
    EXPECT_EQ(result.output, "out");
    EXPECT_EQ(result.errors, "err");
    EXPECT_EQ(result.exit_status, 0);
}

TEST(ProgramFolder, IsWhereThisTestIs) {
    EXPECT_TRUE(fs::exists(program_folder() / "store_test")) << program_folder();
}

TEST(TemporaryFolder, IsPrivateAndGoneAtTheEnd) {
    fs::path path;
    {
        const TemporaryFolder folder;
        const TemporaryFolder other;
        path = folder.path();
        EXPECT_NE(path, other.path());
        struct stat facts {};
        ASSERT_EQ(stat(path.c_str(), &facts), 0);
        EXPECT_EQ(facts.st_mode & 0777U, 0700U);
        EXPECT_TRUE(fs::is_empty(path));
        fs::create_directories(path / "a" / "b");
        test::spill(path / "a" / "b" / "file", "x");
    }
    EXPECT_FALSE(fs::exists(path));
}

TEST(TemporaryFolder, SaysWhereTmpdirIsNoFolder) {
    const char* old = getenv("TMPDIR");
    const std::string kept = old ? old : "";
    setenv("TMPDIR", "/no/such/folder", 1);
    const auto said = failure_of([] { const TemporaryFolder folder; });
    old ? setenv("TMPDIR", kept.c_str(), 1) : unsetenv("TMPDIR");
    EXPECT_TRUE(said.contains("TMPDIR")) << said.problem;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/text.h"
#include "guardian.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store_test_support.h"

// What a program that means harm can see, change and use up.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::failure_of;

/// Puts a script of the test in place of gpsbabel.
class ExternalProgramTest : public testing::Test {
  protected:
    void SetUp() override {
        write_file_atomically(folder_.path() / "secret", "of the user\n");
        setenv("RUNCERT_EXTERNAL_PATH", programs_.path().c_str(), 1);
    }
    void TearDown() override { unsetenv("RUNCERT_EXTERNAL_PATH"); }

    void pretend(const std::string& script, const std::string& interpreter = "/bin/sh") {
        const fs::path file = programs_.path() / "gpsbabel";
        write_file_atomically(file, "#!" + interpreter + "\n" + script);
        fs::permissions(file, fs::perms::owner_all | fs::perms::others_read |
                                  fs::perms::others_exec | fs::perms::group_read |
                                  fs::perms::group_exec);
    }
    ProcessResult run(const std::string& script, ExternalCall call = {},
                      std::vector<std::string> arguments = {}) {
        pretend(script);
        call.command = {"gpsbabel"};
        call.command.insert(call.command.end(), arguments.begin(), arguments.end());
        return run_external(call);
    }

    TemporaryFolder folder_;
    TemporaryFolder programs_;
};

TEST_F(ExternalProgramTest, IsFoundInTheSystemsFoldersAlone) {
    unsetenv("RUNCERT_EXTERNAL_PATH");
    pretend("echo another\n");
    const std::string path = std::getenv("PATH");
    const fs::path here = fs::current_path();
    setenv("PATH", (programs_.path().string() + ":.:" + path).c_str(), 1);
    fs::current_path(programs_.path());
    const fs::path found = external_program_file("gpsbabel");
    fs::current_path(here);
    setenv("PATH", path.c_str(), 1);
    EXPECT_TRUE(found.empty() || found.string().starts_with("/usr/")) << found;
    setenv("RUNCERT_EXTERNAL_PATH", ".:relative:", 1);
    EXPECT_EQ(external_program_file("gpsbabel"), fs::path());
}

TEST_F(ExternalProgramTest, OneThatIsMissingNamesItsPackage) {
    const auto said = failure_of([] { (void)run_external({.command = {"openssl", "version"}}); });
    EXPECT_EQ(said.where, "openssl");
    EXPECT_EQ(said.remedy, "Install the package openssl");
    EXPECT_EQ(external_program_sha256("openssl"), "");
    EXPECT_NE(external_programs_text().find("openssl     missing: install the package openssl\n"),
              std::string::npos);
}

TEST_F(ExternalProgramTest, ItsHashIsThatOfItsFile) {
    pretend("exit 0\n");
    const std::string sum =
        run_process({"sha256sum", (programs_.path() / "gpsbabel").string()}).output.substr(0, 64);
    EXPECT_EQ(external_program_sha256("gpsbabel"), sum);
    EXPECT_NE(external_programs_text().find("SHA-256 " + sum.substr(0, 16)), std::string::npos);
}

TEST_F(ExternalProgramTest, GetsNothingOfTheCallersEnvironment) {
    setenv("RUNCERT_TEST_SECRET", "x", 1);
    setenv("LD_PRELOAD_CHECK", "x", 1);
    setenv("LC_ALL", "C", 1);
    pretend(
        "import os\nfor n in sorted(os.environ): print(n + '=' + os.environ[n])\n"
        "print(os.getcwd(), sorted(os.listdir('.')))\n",
        "/usr/bin/python3 -I");
    const ProcessResult said =
        run_external({.command = {"gpsbabel"}, .environment = {{"MORE", "1"}}});
    unsetenv("RUNCERT_TEST_SECRET");
    unsetenv("LD_PRELOAD_CHECK");
    unsetenv("LC_ALL");
    ASSERT_EQ(said.exit_status, 0) << said.errors;
    std::set<std::string> names;
    std::string home, last;
    for (std::size_t at = 0; at < said.output.size();) {
        const std::size_t end = said.output.find('\n', at);
        const std::string line = said.output.substr(at, end - at);
        if (line.find('=') != std::string::npos) names.insert(line.substr(0, line.find('=')));
        if (line.starts_with("HOME=")) home = line.substr(5);
        last = line;
        at = end + 1;
    }
    names.erase("PWD");  // bubblewrap's
    EXPECT_EQ(names, (std::set<std::string>{"HOME", "LC_ALL", "MORE", "PATH", "TMPDIR", "TZ"}));
    EXPECT_NE(said.output.find("LC_ALL=C.UTF-8\n"), std::string::npos);
    EXPECT_NE(said.output.find("PATH=/usr/bin:/bin:/usr/local/bin\n"), std::string::npos);
    EXPECT_EQ(last, home + " []");
    EXPECT_FALSE(fs::exists(home)) << "the folder of a call goes with it";
}

TEST_F(ExternalProgramTest, ReadsWhatItIsGivenAndNothingElse) {
    if (!has_sandbox()) GTEST_SKIP() << "no sandbox here";
    const fs::path secret = external_input(folder_.path() / "secret");
    const std::string script =
        "cat \"$1\"; echo changed > \"$1\"; ls -d /home /root /proc/1 2>&1\n";
    EXPECT_EQ(run(script, {}, {secret.string()}).output.find("of the user"), std::string::npos);
    const ProcessResult given = run(script, {.inputs = {secret}}, {secret.string()});
    EXPECT_TRUE(given.output.starts_with("of the user\n")) << given.output << given.errors;
    EXPECT_EQ(given.output.find("\n/home"), std::string::npos) << given.output;
    EXPECT_EQ(given.output.find("\n/root"), std::string::npos) << given.output;
    EXPECT_EQ(read_file(secret), "of the user\n");
}

TEST_F(ExternalProgramTest, WritesInItsOwnFolderAlone) {
    if (!has_sandbox()) GTEST_SKIP() << "no sandbox here";
    const TemporaryFolder own;
    const std::string name = own.path().filename().string() + "x";  // nobody else's
    const ProcessResult result =
        run("for f in / /tmp/ /usr/bin/ /dev/shm/ \"$1\"/; do echo x 2>/dev/null > $f$2 && echo "
            "wrote $f; done; echo result > here\n",
            {.folder = own.path()}, {folder_.path().string(), name});
    EXPECT_EQ(result.output.find("wrote /usr"), std::string::npos);
    EXPECT_EQ(result.output.find("wrote /\n"), std::string::npos) << result.output;
    EXPECT_FALSE(fs::exists(fs::path("/tmp") / name));
    EXPECT_FALSE(fs::exists(fs::path("/dev/shm") / name));
    EXPECT_FALSE(fs::exists(folder_.path() / name));
    EXPECT_EQ(read_file(own.path() / "here"), "result\n");
}

TEST_F(ExternalProgramTest, HasNoNetwork) {
    if (!has_sandbox()) GTEST_SKIP() << "no sandbox here";
    const int listening = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ASSERT_EQ(bind(listening, reinterpret_cast<sockaddr*>(&address), size), 0);
    ASSERT_EQ(listen(listening, 1), 0);
    ASSERT_EQ(getsockname(listening, reinterpret_cast<sockaddr*>(&address), &size), 0);
    const std::string connect = "exec 3<>/dev/tcp/127.0.0.1/" +
                                std::to_string(ntohs(address.sin_port)) + " && echo connected\n";
    EXPECT_EQ(run_process({"bash", "-c", connect}).output, "connected\n")
        << "the test sees nothing";
    pretend(connect, "/bin/bash");
    EXPECT_EQ(run_external({.command = {"gpsbabel"}}).output, "");
    close(listening);
}

TEST_F(ExternalProgramTest, EndsAtEachOfItsLimits) {
    const std::string python = "/usr/bin/python3 -I";
    pretend("x = bytearray(1 << 30)\nprint('had it')\n", python);
    EXPECT_EQ(run_external({.command = {"gpsbabel"}}).output, "had it\n");
    const ExternalCall little{.command = {"gpsbabel"},
                              .limits = {.time = 1s,
                                         .memory_bytes = std::uint64_t{512} << 20,
                                         .file_bytes = 1 << 20,
                                         .output_bytes = 1 << 20}};
    ExternalCall call = little;
    call.limits.time = 60s;
    const ProcessResult memory = run_external(call);
    EXPECT_NE(memory.exit_status, 0);
    EXPECT_NE(memory.errors.find("MemoryError"), std::string::npos) << memory.errors;

    const TemporaryFolder own;
    call.folder = own.path();
    pretend("head -c 4000000 /dev/zero > big; echo $?\n");
    EXPECT_NE(run_external(call).output, "0\n");
    EXPECT_LE(fs::file_size(own.path() / "big"), 1U << 20);

    pretend("yes\n");
    const ProcessResult output = run_external(call);
    EXPECT_EQ(output.end, ProcessEnd::over_output);
    EXPECT_EQ(external_problem(call, output), "it said more than 1 MiB");

    pretend("sleep 600 & sleep 600\n");
    const auto before = std::chrono::steady_clock::now();
    const ProcessResult time = run_external(little);
    EXPECT_EQ(time.end, ProcessEnd::over_time);
    EXPECT_EQ(external_problem(little, time), "it did not end within 1 s");
    EXPECT_LT(std::chrono::steady_clock::now() - before, 240s);
}

// Killed while it begins, bubblewrap left a child that waited for ever, once in two or three times.
TEST_F(ExternalProgramTest, NothingIsLeftOfOneWhoseCallerIsKilledWhileItBegins) {
    if (!has_sandbox()) GTEST_SKIP() << "no sandbox here";
    pretend("exec sleep 600\n");
    for (int i = 0; i < 24; ++i) {
        const pid_t caller = fork();
        ASSERT_GE(caller, 0);
        if (caller == 0) {
            (void)run_external({.command = {"gpsbabel"}});
            _exit(0);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(i));
        kill(caller, SIGKILL);
        waitpid(caller, nullptr, 0);
    }
    const auto is_left = [this] { return !test::processes_with(programs_.path()).empty(); };
    for (int tries = 0; tries < 6000 && is_left(); ++tries)
        std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(is_left());
}

TEST_F(ExternalProgramTest, ManyAtOnceDoNotMeet) {
    pretend("echo \"$1\" > mine; sleep 0.05; cat mine; ls | wc -l\n");
    std::vector<std::jthread> threads;
    std::vector<std::string> said(24);
    for (std::size_t i = 0; i < said.size(); ++i)
        threads.emplace_back([&said, i] {
            said[i] = run_external({.command = {"gpsbabel", std::to_string(i)}}).output;
        });
    threads.clear();
    for (std::size_t i = 0; i < said.size(); ++i)
        EXPECT_EQ(said[i], std::to_string(i) + "\n1\n");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <gtest/gtest.h>
#include <sys/file.h>

#include "chain_support.h"

// ./runcert of a checkout while another call builds in it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class Checkout : public testing::Test {
  protected:
    Checkout() { fs::create_directories(build()); }
    fs::path build() const { return folder_.path() / "build"; }

    /// The programs of a last build, which say only what they are called with.
    void put_ready_programs() const {
        fs::create_directory(build() / "ready.aaaaaa");
        const fs::path program = build() / "ready.aaaaaa/runcert";
        write_file_atomically(program, "#!/bin/sh\necho \"called with $*\"\n");
        fs::permissions(program, fs::perms::owner_all);
        fs::create_symlink("ready.aaaaaa", build() / "ready");
    }

    /// The script beside a build that has the lock and does not end; killed after so many seconds.
    ProcessResult while_building(std::vector<std::string> arguments, int seconds) const {
        std::vector<std::string> command{"flock",
                                         (build() / ".lock").string(),
                                         "timeout",
                                         "-s",
                                         "KILL",
                                         std::to_string(seconds),
                                         RUNCERT_SOURCE_DIR "/runcert"};
        command.insert(command.end(), arguments.begin(), arguments.end());
        return run_process(command, {.environment = {{"RUNCERT_BUILD_DIR", build().string()}}});
    }

    TemporaryFolder folder_;
};

TEST_F(Checkout, IsAnsweredByTheProgramsOfTheLastBuild) {
    put_ready_programs();
    const ProcessResult answered = while_building({"inspect", "a file"}, 100);
    EXPECT_EQ(answered.exit_status, 0) << answered.errors;
    EXPECT_EQ(answered.output, "called with inspect a file\n");
    EXPECT_NE(answered.errors.find("newer sources are being built"), std::string::npos)
        << answered.errors;
}

TEST_F(Checkout, WithoutProgramsSaysWhatItWaitsForAndHowToGoOn) {
    const ProcessResult waited = while_building({"inspect", "a file"}, 10);
    for (const std::string& part : {build().string(), std::string("waiting for another runcert"),
                                    std::string("runcert-build.log"), std::string("Ctrl+C")})
        EXPECT_NE(waited.errors.find(part), std::string::npos) << waited.errors;
}

TEST_F(Checkout, TestsWaitForTheBuildThatTheyTest) {
    put_ready_programs();
    const ProcessResult waited = while_building({"test", "-N"}, 10);
    EXPECT_NE(waited.errors.find("waiting for another runcert"), std::string::npos)
        << waited.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

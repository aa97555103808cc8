#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <utility>

#include "chain_support.h"

// A run folder that somebody is writing in is left alone by everybody else who would.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The lock of a folder, as any program may take it.
class HeldLock {
  public:
    explicit HeldLock(const fs::path& folder)
        : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        EXPECT_EQ(flock(file_, LOCK_EX | LOCK_NB), 0) << folder;
    }
    ~HeldLock() { close(file_); }
    HeldLock(const HeldLock&) = delete;
    HeldLock& operator=(const HeldLock&) = delete;

  private:
    int file_;
};

class RunFolderLock : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder;
        ASSERT_EQ(runcert({"keygen", "--out", key("key"), "--no-password"}).exit_status, 0);
        ASSERT_EQ(certify(attempt(), run(), {"--no-render", "--key", key("key.key")}).exit_status,
                  0);
    }
    static void TearDownTestSuite() { delete std::exchange(folder_, nullptr); }

    static fs::path attempt() { return examples / "land_yacht" / "attempt.yaml"; }
    static fs::path run() { return folder_->path() / "land-yacht"; }
    static std::string key(const char* name) { return (folder_->path() / name).string(); }

    /// Refused with the reason while the lock is held, and nothing in the folder is changed.
    static void expect_left_alone(const std::vector<std::string>& command) {
        const auto before = contents_of(run());
        const HeldLock lock(run());
        const ProcessResult result = runcert(command);
        EXPECT_EQ(result.exit_status, 2) << command.front() << result.output;
        EXPECT_NE(result.errors.find("Another program is writing in this run folder"),
                  std::string::npos)
            << command.front() << ": " << result.errors;
        EXPECT_NE(result.errors.find(run().string()), std::string::npos) << result.errors;
        EXPECT_EQ(contents_of(run()), before) << command.front();
    }

  private:
    inline static TemporaryFolder* folder_ = nullptr;
};

TEST_F(RunFolderLock, IsRespectedByAllWhoWrite) {
    expect_left_alone({"certify", attempt().string(), "--out", run().string(), "--no-pdf"});
    expect_left_alone({"sign", run().string(), "--key", key("key.key"), "--role", "judge"});
    expect_left_alone({"timestamp", run().string()});
    expect_left_alone(
        {"seal", run().string(), "--key", key("key.key"), "--certificate", key("key.pub")});
    const fs::path stage = RUNCERT_PROGRAMS "/runcert-check";
    const HeldLock lock(run());
    const ProcessResult result =
        run_process({stage.string(), "--attempt", (run() / "attempt.yaml").string(), "--run-dir",
                     run().string()});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("Another program is writing"), std::string::npos);
}

TEST_F(RunFolderLock, IsFreeAfterwardsAndNeedsNoFile) {
    { const HeldLock lock(run()); }
    EXPECT_EQ(
        runcert({"sign", run().string(), "--key", key("key.key"), "--role", "judge", "--no-render"})
            .exit_status,
        0);
    for (const auto& entry : fs::directory_iterator(run()))
        EXPECT_EQ(entry.path().string().find("lock"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

#include <gtest/gtest.h>

#include "make/run_files.h"
#include "store/atomic_file.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

class WorkOfARun : public testing::Test {
  protected:
    RunFiles files() const { return {folder_.path(), "run", fs::path(".runcert/work/run")}; }
    fs::path work() const { return folder_.path() / ".runcert/work"; }

    TemporaryFolder folder_;
};

TEST_F(WorkOfARun, IsClosedWhole) {
    files().open_work({});
    EXPECT_TRUE(fs::exists(work() / "run.seal"));
    files().close_work();
    EXPECT_TRUE(fs::is_empty(work()));
}

/// A kill between the removal of the folder and that of its seal.
TEST_F(WorkOfARun, LeavesNoSealBehindThatAKillLeft) {
    files().open_work({});
    fs::remove_all(work() / "run");
    files().close_work();
    EXPECT_TRUE(fs::is_empty(work()));
}

TEST_F(WorkOfARun, RemovesNoSealOfAnother) {
    fs::create_directories(work());
    for (const char* const text : {"0000", "0000\n0000", ""}) {
        write_file_atomically(work() / "run.seal", text);
        files().close_work();
        EXPECT_EQ(read_file(work() / "run.seal"), text);
    }
    // One that was copied from another folder.
    files().open_work({});
    const std::string seal = read_file(work() / "run.seal");
    files().close_work();
    write_file_atomically(work() / "other.seal", seal);
    RunFiles(folder_.path(), "other", fs::path(".runcert/work/other")).close_work();
    EXPECT_TRUE(fs::exists(work() / "other.seal"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

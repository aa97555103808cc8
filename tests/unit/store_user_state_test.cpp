#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

#include "store/process.h"
#include "store/user_state.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

class UserState : public testing::Test {
  protected:
    void SetUp() override { setenv("XDG_STATE_HOME", folder_.path().c_str(), 1); }
    void TearDown() override { setenv("XDG_STATE_HOME", before_.c_str(), 1); }

    fs::path memory() const { return folder_.path() / "runcert" / "made"; }

    TemporaryFolder folder_;
    std::string before_ = std::getenv("XDG_STATE_HOME");
};

TEST_F(UserState, IsRememberedAndForgotten) {
    EXPECT_EQ(recalled("run 1"), "");
    remember("run 1", "one");
    remember("run 2", "two");
    EXPECT_EQ(recalled("run 1"), "one");
    remember("run 1", "other");
    EXPECT_EQ(recalled("run 1"), "other");
    remember("run 1", "");
    EXPECT_EQ(recalled("run 1"), "");
    EXPECT_EQ(recalled("run 2"), "two");
}

// Whoever can write there could say that a run was made here.
TEST_F(UserState, ThatOthersCouldHaveWrittenIsNotRead) {
    remember("run 1", "one");
    struct stat facts {};
    ASSERT_EQ(stat(memory().c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777U, 0700U);
    for (const mode_t open_to : {0720U, 0702U}) {
        ASSERT_EQ(chmod(memory().c_str(), open_to), 0);
        EXPECT_EQ(recalled("run 1"), "");
        EXPECT_NE(missing_state().find("Others can write"), std::string::npos);
    }
    ASSERT_EQ(chmod(memory().c_str(), 0700), 0);
    EXPECT_EQ(recalled("run 1"), "one");
    fs::rename(memory(), folder_.path() / "elsewhere");
    fs::create_symlink(folder_.path() / "elsewhere", memory());
    EXPECT_EQ(recalled("run 1"), "");
}

TEST_F(UserState, WithoutAFolderIsSaidAndNothingFails) {
    setenv("XDG_STATE_HOME", "/proc/none", 1);
    EXPECT_NE(missing_state().find("the next call makes every run again"), std::string::npos);
    remember("run 1", "one");
    EXPECT_EQ(recalled("run 1"), "");
    setenv("XDG_STATE_HOME", "relative", 1);  // counts as none
    EXPECT_NE(state_folder()->string(), "relative/runcert");
}

TEST(OwnNames, AreNewAndCannotBeForged) {
    const std::string name = own_name();
    EXPECT_NE(name, own_name());
    EXPECT_TRUE(is_own_name(name));
    EXPECT_TRUE(is_own_name(name + ".tmp"));
    std::string other = name;
    other.back() = other.back() == '0' ? '1' : '0';
    for (const std::string& forged :
         {other, std::string(".runcert-"), std::string(".runcert-notes"), std::string("photos"),
          std::string(".runcert-4711-0-0123456789abcdef"), name.substr(1), name + "0"})
        EXPECT_FALSE(is_own_name(forged)) << forged;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

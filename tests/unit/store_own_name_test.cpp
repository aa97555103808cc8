#include <gtest/gtest.h>

#include <filesystem>

#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/process.h"
#include "store/record_key.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

TEST(OwnName, IsKnownInTheFolderWhereItWasGivenAlone) {
    keep_own_names();
    const TemporaryFolder here;
    const TemporaryFolder there;
    const Folder folder(here.path());
    const Folder other(there.path());
    const std::string name = own_name(folder, "done");
    EXPECT_TRUE(name.starts_with(".runcert-done-"));
    EXPECT_TRUE(is_own_name(folder, name));
    EXPECT_TRUE(is_own_name(folder, name + ".tmp"));
    EXPECT_FALSE(is_own_name(other, name));
    EXPECT_NE(own_name(folder), own_name(folder));
    for (const std::string& forged :
         {std::string(".runcert-"), std::string(".runcert-1-2"), std::string("runcert-1-2"),
          name.substr(0, name.size() - 1), name + "0", ".runcert-dome" + name.substr(13),
          std::string(".runcert-4711-0.tmp"), std::string(".runcert-1-0-0123456789abcdef.tmp")})
        EXPECT_FALSE(is_own_name(folder, forged)) << forged;
}

TEST(OwnName, OfACopyOfTheFolderIsNotKnown) {
    const TemporaryFolder here;
    fs::create_directory(here.path() / "a");
    const Folder folder(here.path() / "a");
    const std::string name = own_name(folder);
    fs::rename(here.path() / "a", here.path() / "b");
    EXPECT_TRUE(is_own_name(Folder(here.path() / "b"), name)) << "the same folder";
    fs::copy(here.path() / "b", here.path() / "a");
    EXPECT_FALSE(is_own_name(Folder(here.path() / "a"), name));
    EXPECT_NE(identity_of(folder), identity_of(Folder(here.path() / "a")));
}

TEST(OwnName, ASealOfAnotherUserIsNone) {
    const TemporaryFolder state;
    keep_own_names();
    EXPECT_TRUE(is_own_seal("text", own_seal("text")));
    EXPECT_FALSE(is_own_seal("text", own_seal("other")));
    EXPECT_FALSE(is_own_seal("text", record_key_in(state.path()).key.seal("text")));
    EXPECT_FALSE(is_own_seal("text", ""));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

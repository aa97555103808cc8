#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>
#include <thread>
#include <vector>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store/record_key.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

mode_t mode_of(const fs::path& file) {
    struct stat status {};
    EXPECT_EQ(stat(file.c_str(), &status), 0) << file;
    return status.st_mode & 07777U;
}

TEST(RecordKey, IsMadeOnceAndForItsOwnerAlone) {
    const TemporaryFolder folder;
    const fs::path state = folder.path() / "a/runcert";
    const mode_t before = umask(0);
    const KeptRecordKey first = record_key_in(state);
    umask(before);
    EXPECT_TRUE(first.passing.empty()) << first.passing;
    EXPECT_EQ(mode_of(state / "records.key"), 0600U);
    EXPECT_EQ(record_key_in(state).key.seal("text"), first.key.seal("text"));
    EXPECT_NE(record_key_in(folder.path() / "b").key.seal("text"), first.key.seal("text"));
    EXPECT_TRUE(first.key.sealed("text", first.key.seal("text")));
    EXPECT_FALSE(first.key.sealed("texts", first.key.seal("text")));
    EXPECT_FALSE(first.key.sealed("text", ""));
}

TEST(RecordKey, OfSeveralThatBeginAtOnceIsTheSame) {
    const TemporaryFolder folder;
    std::vector<std::string> seals(16);
    {
        std::vector<std::jthread> threads;
        for (std::string& seal : seals)
            threads.emplace_back([&] { seal = record_key_in(folder.path()).key.seal("text"); });
    }
    EXPECT_EQ(std::set<std::string>(seals.begin(), seals.end()).size(), 1U);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(RecordKey, ThatOthersCouldHaveReadOrWrittenIsRefused) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "records.key";
    record_key_in(folder.path());
    const std::string text = read_file(file);
    fs::permissions(file, fs::perms::group_read, fs::perm_options::add);
    EXPECT_THROW(record_key_in(folder.path()), Failure);
    for (const std::string& wrong :
         {std::string(), text.substr(1), text + "\n", std::string(64, 'x') + "\n"}) {
        fs::remove(file);
        write_file_atomically(file, wrong, FileAccess::owner_only);
        EXPECT_THROW(record_key_in(folder.path()), Failure) << wrong;
    }
    fs::remove(file);
    write_file_atomically(folder.path() / "other", text, FileAccess::owner_only);
    fs::create_symlink(folder.path() / "other", file);
    EXPECT_THROW(record_key_in(folder.path()), Failure);
}

TEST(RecordKey, WithoutAFolderHoldsForThisCallAlone) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "file", "");
    for (const std::optional<fs::path>& none :
         {std::optional<fs::path>(), std::optional(folder.path() / "file/runcert")}) {
        const KeptRecordKey first = record_key_in(none);
        EXPECT_FALSE(first.passing.empty());
        EXPECT_NE(first.key.seal("text"), record_key_in(none).key.seal("text"));
    }
}

TEST(RecordKey, IsInTheUsersStateFolder) {
    const std::string before = std::getenv("XDG_STATE_HOME");
    setenv("XDG_STATE_HOME", "/somewhere", 1);
    EXPECT_EQ(state_folder(), "/somewhere/runcert");
    setenv("XDG_STATE_HOME", "relative", 1);
    setenv("HOME", "/home/judge", 1);
    EXPECT_EQ(state_folder(), "/home/judge/.local/state/runcert");
    setenv("XDG_STATE_HOME", before.c_str(), 1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

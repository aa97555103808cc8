#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/folder_lock.h"
#include "store_test_support.h"

// What is done in a folder stays in it, whoever puts links there, and whenever.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

/// Exchanges a folder for a symbolic link to another, again and again, until it is destroyed.
class Swapper {
  public:
    Swapper(const fs::path& one, const fs::path& other)
        : thread_([this, one, other] {
              while (!ends_)
                  if (renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) ==
                      0)
                      ++swaps;
          }) {
        while (swaps < 10)
            std::this_thread::yield();
    }
    ~Swapper() {
        ends_ = true;
        thread_.join();
    }
    Swapper(const Swapper&) = delete;
    Swapper& operator=(const Swapper&) = delete;

    std::atomic<int> swaps{0};

  private:
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

class Folders : public testing::Test {
  protected:
    Folders() {
        fs::create_directories(root() / "sub");
        fs::create_directories(victim() / "inner");
        test::spill(victim() / "kept", "kept");
        test::spill(victim() / "inner/kept", "kept");
    }
    fs::path root() const { return folder_.path() / "root"; }
    fs::path victim() const { return folder_.path() / "victim"; }
    void expect_victim_untouched() const {
        std::size_t count = 0;
        for (const auto& entry : fs::recursive_directory_iterator(victim()))
            count += entry.exists() ? 1 : 0;
        EXPECT_EQ(count, 3U);
        EXPECT_EQ(test::slurp(victim() / "kept"), "kept");
        EXPECT_EQ(test::slurp(victim() / "inner/kept"), "kept");
    }

    TemporaryFolder folder_;
};

TEST_F(Folders, FollowTheNamedPathAlone) {
    fs::create_directory_symlink(root(), folder_.path() / "named");
    const Folder named(folder_.path() / "named");
    named.make("sub").write("file", "text");
    EXPECT_EQ(test::slurp(root() / "sub/file"), "text");
    fs::create_directory_symlink(victim(), root() / "link");
    fs::create_symlink(victim() / "kept", root() / "file-link");
    for (const char* name : {"link", "file-link"}) {
        EXPECT_TRUE(test::failure_of([&] { named.open(name); }).contains("symbolic link"));
        EXPECT_TRUE(test::failure_of([&] { named.make(name); }).contains("symbolic link"));
    }
    EXPECT_TRUE(
        test::failure_of([&] { make_below(root(), "link/inner"); }).contains("symbolic link"));
    EXPECT_TRUE(test::failure_of([&] {
                    FolderLock::try_lock(named, "file-link", LockKind::exclusive);
                }).contains("symbolic link"));
    EXPECT_TRUE(test::failure_of([&] { named.read("file-link"); }).contains("cannot open"));
    EXPECT_TRUE(test::failure_of([&] { named.open("missing"); }).contains("cannot open"));
    named.write("file-link", "the link is replaced");
    EXPECT_EQ(named.kind_of("file-link"), EntryKind::file);
    expect_victim_untouched();
}

TEST_F(Folders, RemoveNothingThroughALink) {
    fs::create_directory_symlink(victim(), root() / "sub/link");
    fs::create_symlink(victim() / "kept", root() / "sub/file-link");
    fs::create_directories(root() / "sub/a/b");
    test::spill(root() / "sub/a/b/file", "x");
    const Folder folder(root());
    folder.remove_tree("sub");
    EXPECT_TRUE(fs::is_empty(root()));
    fs::create_directory_symlink(victim(), root() / "sub");
    folder.remove_tree("sub");
    folder.remove_tree("missing");
    folder.remove("missing");
    EXPECT_TRUE(fs::is_empty(root()));
    expect_victim_untouched();
}

TEST_F(Folders, PlaceAFileWholeAndALinkAsALink) {
    const Folder folder(root());
    const Folder to = folder.make("sub");
    folder.write("file", "new");
    to.write("file", "old");
    folder.place("file", to);
    folder.place("file", to);
    EXPECT_EQ(to.read("file"), "new");
    fs::create_symlink(victim() / "kept", root() / "link");
    folder.place("link", to);
    EXPECT_EQ(to.kind_of("link"), EntryKind::link);
    EXPECT_EQ(to.names(), (std::vector<std::string>{"file", "link"}));
    EXPECT_TRUE(test::failure_of([&] { folder.place("missing", to); }).contains("put in place"));
}

// Between a look at a name and its use anything can come to stand there.
TEST_F(Folders, AreNotLeftThroughALinkThatComesAtTheMomentOfUse) {
    fs::create_directory_symlink(victim(), folder_.path() / "link");
    const Folder folder(root());
    int done = 0;
    int refused = 0;
    const Swapper swapper(root() / "sub", folder_.path() / "link");
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    for (int i = 0;
         std::chrono::steady_clock::now() < end && (i < 1000 || done < 50 || refused < 50); ++i) {
        try {
            const Folder sub = folder.make("sub");
            sub.write("file", "x");
            FolderLock::try_lock(sub, "lock", LockKind::exclusive);
            sub.remove("file");
            ++done;
        } catch (const Failure&) {
            ++refused;
        }
    }
    EXPECT_GE(done, 50);
    EXPECT_GE(refused, 50);
    expect_victim_untouched();
}

TEST_F(Folders, AreNotEmptiedThroughALinkThatComesAtTheMomentOfUse) {
    fs::create_directory_symlink(victim(), folder_.path() / "link");
    const Folder folder(root());
    const Swapper swapper(root() / "sub", folder_.path() / "link");
    for (int i = 0; i < 500; ++i) {
        try {
            folder.remove_tree("sub");
        } catch (const Failure&) {
        }
        // Wherever the two are now, there is a folder and a link again.
        std::error_code ignored;
        fs::create_directories(root() / "sub/inner", ignored);
        fs::remove(folder_.path() / "link", ignored);
        fs::create_directory_symlink(victim(), folder_.path() / "link", ignored);
    }
    expect_victim_untouched();
}

TEST_F(Folders, GiveANewFileItsNameOnceAlone) {
    std::atomic<int> made{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&] {
            try {
                AtomicFile file(root() / "new");
                file.write("whole");
                file.commit_as_new();
                ++made;
            } catch (const Failure& failure) {
                EXPECT_NE(failure.problem().find("exists"), std::string::npos);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(made, 1);
    EXPECT_EQ(Folder(root()).names(), (std::vector<std::string>{"new", "sub"}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

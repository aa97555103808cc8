#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <thread>
#include <vector>

#include "core/failure.h"
#include "store/atomic_file.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

/// Acts as an ordinary user while it lives: to root every folder is writable.
class AsOrdinaryUser {
  public:
    AsOrdinaryUser() : changed_(geteuid() == 0 && seteuid(65534) == 0) {}
    ~AsOrdinaryUser() {
        if (changed_ && seteuid(0) != 0) abort();
    }
    AsOrdinaryUser(const AsOrdinaryUser&) = delete;
    AsOrdinaryUser& operator=(const AsOrdinaryUser&) = delete;

  private:
    bool changed_;
};

/// No file can grow beyond `bytes` while it lives.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limited{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limited);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit old_{};
    void (*handler_)(int);
};

class AtomicFile : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "runcert-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        file_ = folder_ / "a file.yaml";
    }
    void TearDown() override {
        chmod(folder_.c_str(), 0700);
        fs::remove_all(folder_);
    }

    std::size_t files_in_folder() const {
        std::size_t count = 0;
        for ([[maybe_unused]] const fs::directory_entry& entry : fs::directory_iterator(folder_))
            ++count;
        return count;
    }

    fs::path folder_;
    fs::path file_;
};

/// That the call fails with a message that names the file and says what to do.
template <typename Call>
void expect_failure(const fs::path& where, const std::string& in_problem, const Call& call) {
    try {
        call();
        FAIL() << "no Failure";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), where.string());
        EXPECT_NE(failure.problem().find(in_problem), std::string::npos) << failure.problem();
        EXPECT_FALSE(failure.remedy().empty());
    }
}

TEST_F(AtomicFile, ReadsBackEveryByte) {
    std::string bytes;
    for (int i = 0; i < 3'000'000; ++i)
        bytes += static_cast<char>(i % 251);
    for (const std::string& contents : {bytes, std::string(), std::string("a\r\n\0b\n", 6)}) {
        write_file_atomically(file_, contents);
        EXPECT_EQ(read_file(file_), contents);
        EXPECT_EQ(FileView(file_).bytes(), contents);
    }
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(AtomicFile, ReplacesLongerContents) {
    write_file_atomically(file_, "a longer text than what follows");
    write_file_atomically(file_, "short");
    EXPECT_EQ(read_file(file_), "short");
}

TEST_F(AtomicFile, WritesInTheCurrentFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    write_file_atomically("plain-name", "x");
    fs::current_path(before);
    EXPECT_EQ(read_file(folder_ / "plain-name"), "x");
}

TEST_F(AtomicFile, AccessIsByUmaskOrOwnerOnly) {
    const mode_t before = umask(0022);
    write_file_atomically(file_, "x");
    write_file_atomically(folder_ / "secret", "x", FileAccess::owner_only);
    umask(before);
    struct stat status {};
    ASSERT_EQ(stat(file_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0644U);
    ASSERT_EQ(stat((folder_ / "secret").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST_F(AtomicFile, LongestPossibleNameCanBeWritten) {
    const fs::path longest = folder_ / std::string(255, 'n');
    write_file_atomically(longest, "x");
    EXPECT_EQ(read_file(longest), "x");
    const fs::path longer = folder_ / std::string(256, 'n');
    expect_failure(longer, "name", [&] { write_file_atomically(longer, "x"); });
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(AtomicFile, RefusesWhatIsNotARegularFile) {
    expect_failure(file_, "cannot open", [&] { read_file(file_); });
    expect_failure(folder_, "folder", [&] { read_file(folder_); });
    expect_failure("/dev/null", "device", [] { read_file("/dev/null"); });
    ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
    expect_failure(file_, "pipe", [&] { read_file(file_); });
    expect_failure(file_, "pipe", [&] { FileView view(file_); });
    expect_failure(folder_, "folder", [&] { FileView view(folder_); });
}

TEST_F(AtomicFile, AViewStaysWhereItIsMovedTo) {
    write_file_atomically(file_, "contents");
    FileView view(file_);
    const FileView moved = std::move(view);
    // The file's name may be given to another meanwhile: the view is of the old one.
    write_file_atomically(file_, "other");
    EXPECT_EQ(moved.bytes(), "contents");
}

TEST_F(AtomicFile, NeverReplacesAPipeOrADevice) {
    ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
    expect_failure(file_, "pipe", [&] { write_file_atomically(file_, "x"); });
    fs::create_symlink("/dev/null", folder_ / "link");
    expect_failure(folder_ / "link", "device",
                   [&] { write_file_atomically(folder_ / "link", "x"); });
    EXPECT_TRUE(fs::is_fifo(file_));
    EXPECT_EQ(files_in_folder(), 2U);
}

TEST_F(AtomicFile, RefusesWhatMayNotBeRead) {
    write_file_atomically(file_, "x");
    ASSERT_EQ(chmod(folder_.c_str(), 0755), 0);
    ASSERT_EQ(chmod(file_.c_str(), 0), 0);
    const AsOrdinaryUser user;
    expect_failure(file_, "cannot open", [&] { read_file(file_); });
}

TEST_F(AtomicFile, WriteIntoAReadOnlyFolderFails) {
    write_file_atomically(file_, "old");
    ASSERT_EQ(chmod(folder_.c_str(), 0555), 0);
    {
        const AsOrdinaryUser user;
        expect_failure(file_, "cannot create", [&] { write_file_atomically(file_, "new"); });
    }
    EXPECT_EQ(read_file(file_), "old");
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(AtomicFile, WriteIntoAMissingFolderOrOverAFolderFails) {
    const fs::path nowhere = folder_ / "missing" / "file";
    expect_failure(nowhere, "cannot create", [&] { write_file_atomically(nowhere, "x"); });
    fs::create_directory(folder_ / "sub");
    expect_failure(folder_ / "sub", "folder", [&] { write_file_atomically(folder_ / "sub", "x"); });
    expect_failure(folder_ / "sub/", "no file",
                   [&] { write_file_atomically(folder_ / "sub/", "x"); });
    EXPECT_EQ(files_in_folder(), 1U);
}

// A disk that is full and a file that may not grow fail in the same place: in the middle.
TEST_F(AtomicFile, InterruptedWriteLeavesTheOldFileAndNothingElse) {
    write_file_atomically(file_, "old");
    {
        const FileSizeLimit limit(4096);
        expect_failure(file_, "cannot write",
                       [&] { write_file_atomically(file_, std::string(100'000, 'x')); });
        expect_failure(folder_ / "new", "cannot write",
                       [&] { write_file_atomically(folder_ / "new", std::string(100'000, 'x')); });
    }
    EXPECT_EQ(read_file(file_), "old");
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(AtomicFile, ManyWritersLeaveOneWholeFile) {
    std::vector<std::thread> writers;
    for (char letter = 'a'; letter < 'g'; ++letter)
        writers.emplace_back([this, letter] {
            for (int i = 0; i < 20; ++i)
                write_file_atomically(file_, std::string(50'000, letter));
        });
    for (int i = 0; i < 50; ++i)
        if (fs::exists(file_)) {
            const std::string seen = read_file(file_);
            ASSERT_EQ(seen, std::string(50'000, seen.front()));
        }
    for (std::thread& writer : writers)
        writer.join();
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(AtomicFile, ALinkIsReplacedAndItsTargetKept) {
    write_file_atomically(folder_ / "target", "target");
    fs::create_symlink("target", file_);
    write_file_atomically(file_, "new");
    EXPECT_EQ(read_file(file_), "new");
    EXPECT_EQ(read_file(folder_ / "target"), "target");
    EXPECT_FALSE(fs::is_symlink(file_));
}

TEST_F(AtomicFile, ReadPiecesGivesAllInOrder) {
    const std::string bytes = std::string(1'500'000, 'a') + "end";
    write_file_atomically(file_, bytes);
    std::string joined;
    int pieces = 0;
    read_pieces(file_, [&](std::string_view piece) {
        joined += piece;
        ++pieces;
    });
    EXPECT_EQ(joined, bytes);
    EXPECT_GT(pieces, 1);
}

TEST_F(AtomicFile, MakesFoldersOnce) {
    const fs::path deep = folder_ / "a" / "b" / "c";
    make_directory(deep);
    EXPECT_TRUE(fs::is_directory(deep));
    make_directory(deep);
    make_directory(folder_ / "trailing/");
    EXPECT_TRUE(fs::is_directory(folder_ / "trailing"));
    write_file_atomically(file_, "x");
    expect_failure(file_, "cannot make", [&] { make_directory(file_); });
    expect_failure(file_ / "below", "cannot make", [&] { make_directory(file_ / "below"); });
    ASSERT_EQ(chmod(folder_.c_str(), 0555), 0);
    const AsOrdinaryUser user;
    expect_failure(folder_ / "new", "cannot make", [&] { make_directory(folder_ / "new"); });
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

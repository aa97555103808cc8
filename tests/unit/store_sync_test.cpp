#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/process.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::failure_of;

TEST(FileSync, WritesWithoutASyncAreWholeToo) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "f";
    write_file_unsynced(file, "old");
    write_file_unsynced(file, "new");
    EXPECT_EQ(read_file(file), "new");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);  // no temporary
    EXPECT_TRUE(failure_of([&] { write_file_unsynced(folder.path(), "x"); }).contains("folder"));
}

TEST(FileSync, WhatCallersSyncIsWrittenAllTheSame) {
    const TemporaryFolder folder;
    const auto [name, value] = synced_by_caller();
    ASSERT_EQ(setenv(name.c_str(), value.c_str(), 1), 0);
    write_file_atomically(folder.path() / "f", "text");
    unsetenv(name.c_str());
    EXPECT_EQ(read_file(folder.path() / "f"), "text");
}

TEST(FileSync, NamesTheFileThatIsNotThere) {
    const TemporaryFolder folder;
    write_file_unsynced(folder.path() / "a", "1");
    sync_files({folder.path() / "a"});
    sync_files({});
    Folder(folder.path()).sync();
    const auto said = failure_of([&] {
        sync_files({folder.path() / "a", folder.path() / "missing"});
    });
    EXPECT_NE(said.where.find("missing"), std::string::npos) << said.where;
}

/// The size of a file must not limit what is read of it: it may grow meanwhile, and files of the
/// system say that they have none.
TEST(FileSync, ReadsMoreThanTheSystemSaysAFileHas) {
    EXPECT_EQ(fs::file_size("/proc/self/status"), 0U);
    EXPECT_NE(read_file("/proc/self/status").find("VmRSS"), std::string::npos);
    const TemporaryFolder folder;
    const std::string bytes(std::size_t{3} << 20, 'x');  // in several pieces
    write_file_unsynced(folder.path() / "large", bytes);
    EXPECT_EQ(read_file(folder.path() / "large"), bytes);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

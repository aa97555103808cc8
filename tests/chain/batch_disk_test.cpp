// Disks that are full or read-only, and limits on file sizes: the batch says so, and the same
// command goes on when there is space.
#include <gtest/gtest.h>

#include "batch_crash_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

std::string quoted(const Words& words) {
    std::string text;
    for (const std::string& word : words)
        text += " '" + word + "'";
    return text;
}

/// Whether file systems can be mounted, seen by this test's programs alone.
bool can_mount() {
    return run_process({"unshare", "-m", "mount", "-t", "tmpfs", "none", "/mnt"}).exit_status == 0;
}

struct Call {
    int exit_status;
    std::string said;
};

class BatchDisk : public testing::Test {
  protected:
    /// Runs a shell script in which `batch N` writes its words to the file N and its exit status to
    /// N.status, and in which mounts are its own.
    void run(const std::string& script) const {
        const std::string batch =
            fmt::format("batch() {{ name=$1;{} > {}/$name 2>&1; echo $? > {}/$name.status; }}\n",
                        quoted(day.command(day.programs.runcert(), day.out)),
                        day.folder.path().string(), day.folder.path().string());
        const std::string names = fmt::format("OUT='{}'; COPY='{}'; SMALL='{}'\n", day.out.string(),
                                              copy.string(), small.string());
        fs::create_directories(day.out);
        fs::create_directories(small);
        const ProcessResult result =
            run_process({"unshare", "-m", "sh", "-c", names + batch + script},
                        {.time_limit = std::chrono::minutes(10)});
        ASSERT_EQ(result.end, ProcessEnd::by_itself) << "it hangs";
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
    Call call(const std::string& name) const {
        return {.exit_status = std::stoi(read_file(day.folder.path() / (name + ".status"))),
                .said = read_file(day.folder.path() / name)};
    }
    void expect_said(const std::string& name, std::string_view words) const {
        EXPECT_EQ(call(name).exit_status, 2) << call(name).said;
        EXPECT_TRUE(holds(call(name).said, words)) << call(name).said;
    }
    void expect_done(const std::string& name, const fs::path& results) {
        EXPECT_EQ(call(name).exit_status, 0) << call(name).said;
        EXPECT_EQ(differences(results_of(results), day.expected()), Words{});
        EXPECT_EQ(half_written(results), Words{});
    }

    DisturbedDay day{3, 100};
    fs::path copy = day.folder.path() / "copy";
    fs::path small = day.folder.path() / "small";
};

TEST_F(BatchDisk, AFullOneIsSaidAndTheNextCallGoesOn) {
    if (!can_mount()) GTEST_SKIP() << "no file system can be mounted here (needs root)";
    // Full at the first attempt, in its first stages, and at the reports.
    const Words sizes{"4k", "40k", "500k"};
    for (const std::string& size : sizes)
        run(
            fmt::format("mount -t tmpfs -o size={0} none $OUT\n"
                        "batch first{0}\n"
                        "mount -o remount,size=64m $OUT\n"
                        "batch second{0}\n"
                        "cp -a $OUT \"$COPY\"{0}\n",
                        size));
    for (const std::string& size : sizes) {
        expect_said("first" + size, "No space left on device");
        EXPECT_TRUE(holds(call("first" + size).said, "Free some space"));
        expect_done("second" + size, copy.string() + size);
    }
}

TEST_F(BatchDisk, AReadOnlyFolderIsSaid) {
    if (!can_mount()) GTEST_SKIP() << "no file system can be mounted here (needs root)";
    run("mount -t tmpfs -o ro none $OUT\n"
        "batch empty\n"
        "mount -o remount,rw,size=64m $OUT\n"
        "batch done\n"
        "mount -o remount,ro $OUT\n"
        "batch again\n"
        "cp -a $OUT $COPY\n");
    expect_said("empty", "Read-only file system");
    expect_said("again", "Read-only file system");
    expect_done("done", copy);
}

TEST_F(BatchDisk, ALimitOnFileSizesIsSaid) {
    if (run_process({"unshare", "-m", "true"}).exit_status != 0)
        GTEST_SKIP() << "no mounts of its own can be had here (needs root)";
    // Of 512 bytes each: less than a table, more than a record.
    run("(ulimit -f 16; batch limited)\nbatch free\n");
    expect_said("limited", "File too large");
    EXPECT_TRUE(holds(call("limited").said, "ulimit -f"));
    expect_done("free", day.out);
}

TEST_F(BatchDisk, AFullFolderForTemporaryFilesIsSaid) {
    if (!can_mount()) GTEST_SKIP() << "no file system can be mounted here (needs root)";
    DisturbedDay pages(1, 100, {});
    const std::string command = quoted(pages.command(pages.programs.runcert(), pages.out));
    run("mount -t tmpfs -o size=4k none $SMALL\n"
        "head -c 4096 /dev/zero > $SMALL/full\n"
        "TMPDIR=$SMALL" +
        command + " > " + (day.folder.path() / "full").string() +
        " 2>&1\n"
        "echo $? > " +
        (day.folder.path() / "full.status").string() + "\n");
    expect_said("full", "No space left on device");
    EXPECT_EQ(pages.batch().exit_status, 0);
    EXPECT_EQ(pages.differing(), Words{});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

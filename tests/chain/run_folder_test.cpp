// A run folder while it is replaced: whole at every moment, and nothing of its evidence is lost.
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cstddef>

#include "batch_crash_support.h"
#include "signatures_support.h"
#include "store/folder.h"
#include "store/user_state.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Whether file systems can be mounted, seen by this test's programs alone.
bool mounts() {
    return run_process({"unshare", "-m", "mount", "-t", "tmpfs", "none", "/mnt"}).exit_status == 0;
}

/// Runs a program for which no file system knows how to exchange two names.
int without_exchange(Words command) {
    const pid_t process = fork();
    if (process != 0) {
        int status = 0;
        waitpid(process, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::array<sock_filter, 6> filter{{
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[4])),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, RENAME_EXCHANGE, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    }};
    const sock_fprog program{.len = filter.size(), .filter = filter.data()};
    std::vector<char*> words;
    for (std::string& word : command)
        words.push_back(word.data());
    words.push_back(nullptr);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0)
        execv(words[0], words.data());
    _exit(127);
}

class RunFolders : public SignedRuns {
  protected:
    Words certify_words(bool other, const fs::path& to) const {
        return {RUNCERT_PROGRAMS "/runcert",
                "certify",
                attempt(other).string(),
                "--out",
                to.string(),
                "--no-render"};
    }
    ino_t inode() const {
        struct stat facts {};
        EXPECT_EQ(stat(run().c_str(), &facts), 0);
        return facts.st_ino;
    }
    /// Every file that the report names is there as it names it, and no other is.
    void expect_whole() const {
        const auto files = layer(verify_json({"--pubkey", public_key("measurer")}), "files");
        EXPECT_EQ(files["passed"], true) << files.dump(1);
        expect_nothing_left();
    }
    /// A report with another's signature among what was superseded.
    void expect_replaced(const std::string& signature, const std::string& report) const {
        EXPECT_NE(read_file(run() / "report.json"), report);
        EXPECT_EQ(read_file(superseded(report, "report.json.minisig")), signature);
        EXPECT_EQ(read_file(superseded(report, "report.json")), report);
        EXPECT_FALSE(fs::exists(run() / "report.json.minisig"));
    }
};

TEST_F(RunFolders, Files08AreExchangedWholeWithWhatIsTheUsers) {
    must_sign("measurer", "measurer");
    const std::string signature = read_file(run() / "report.json.minisig");
    const std::string report = read_file(run() / "report.json");
    fs::create_directory(run() / "keys");
    write_file_atomically(run() / "keys/a.pub", read_file(public_key("measurer")));
    write_file_atomically(run() / "SHA256SUMS", "");  // of a bundle, as the keys
    ASSERT_EQ(chmod(run().c_str(), 0750), 0);
    const ino_t before = inode();
    ASSERT_LT(run_process(certify_words(true, run())).exit_status, 2);
    EXPECT_NE(inode(), before);
    EXPECT_EQ(fs::status(run()).permissions(), static_cast<fs::perms>(0750));
    EXPECT_TRUE(fs::exists(run() / "keys/a.pub"));
    expect_replaced(signature, report);
    expect_whole();
    // A file of the earlier run that the new one has not is gone; the user's own stays.
    write_file_atomically(run() / "notes.txt", "mine");
    fs::create_symlink("elsewhere", run() / "link");
    ASSERT_LT(run_process(certify_words(false, run())).exit_status, 2);
    EXPECT_EQ(read_file(run() / "notes.txt"), "mine");
    EXPECT_TRUE(fs::is_symlink(run() / "link"));
}

TEST_F(RunFolders, Files08AFileThatTheNewRunHasNotIsGone) {
    const auto is_of_run = [](const std::string& name) {
        return name.starts_with("profile.") || name.starts_with("recording.");
    };
    int gone = 0;
    ASSERT_LT(certify(examples / "rejected/attempt.yaml", run(), {"--no-render"}).exit_status, 2);
    expect_whole();
    for (const auto& [name, bytes] : contents_of(original()))
        if (is_of_run(name) && !fs::exists(other_run() / name)) {
            EXPECT_FALSE(fs::exists(run() / name)) << name;
            ++gone;
        }
    EXPECT_GE(gone, 1);
}

// The folder that a shell is in stays the one that it is in.
TEST_F(RunFolders, Files08AFolderThatIsWorkedInIsReplacedInPlace) {
    must_sign("measurer", "measurer");
    const std::string signature = read_file(run() / "report.json.minisig");
    const std::string report = read_file(run() / "report.json");
    const ino_t before = inode();
    const ProcessResult result =
        run_process({"sh", "-c",
                     fmt::format("cd '{}' && '{}/runcert' certify '{}' --out . --no-render",
                                 run().string(), RUNCERT_PROGRAMS, attempt(true).string())});
    ASSERT_LT(result.exit_status, 2) << result.errors;
    EXPECT_EQ(inode(), before);
    expect_replaced(signature, report);
    expect_whole();
}

TEST_F(RunFolders, Files08AFolderWithTheUsersFoldersIsReplacedInPlace) {
    fs::create_directories(run() / "photos/day1");
    write_file_atomically(run() / "photos/day1/a.jpg", "a");
    const ino_t before = inode();
    ASSERT_LT(run_process(certify_words(true, run())).exit_status, 2);
    EXPECT_EQ(inode(), before);
    EXPECT_EQ(read_file(run() / "photos/day1/a.jpg"), "a");
    fs::remove_all(run() / "photos");
    expect_whole();
}

TEST_F(RunFolders, Files08WithoutAnExchangeTheyAreReplacedInPlace) {
    must_sign("measurer", "measurer");
    const std::string signature = read_file(run() / "report.json.minisig");
    const std::string report = read_file(run() / "report.json");
    const ino_t before = inode();
    ASSERT_LT(without_exchange(certify_words(true, run())), 2);
    EXPECT_EQ(inode(), before);
    expect_replaced(signature, report);
    expect_whole();
}

TEST_F(RunFolders, Files08AMountedDiskIsReplacedInPlace) {
    if (!mounts()) GTEST_SKIP() << "no file system can be mounted here (needs root)";
    const std::string report = read_file(run() / "report.json");
    const std::string script = fmt::format(
        "mount -t tmpfs none '{0}' && {1} certify '{2}' --out '{0}' --no-render --key {4}; "
        "{1} certify '{3}' --out '{0}' --no-render; cp -a '{0}' '{0}-copy'",
        run().string(), RUNCERT_PROGRAMS "/runcert", attempt().string(), attempt(true).string(),
        key("measurer"));
    run_process({"unshare", "-m", "sh", "-c", script});
    fs::remove_all(run());
    fs::rename(run().string() + "-copy", run());
    EXPECT_TRUE(fs::exists(superseded(report, "report.json.minisig")));
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig"));
    expect_whole();
}

// Whoever waited for the folder that was exchanged does not write into it.
TEST_F(RunFolders, Files08TwoAtOnceAreNeverMixed) {
    int done = 0;
    for (int round = 0; round < 6; ++round) {
        if (round % 2 == 0) fs::remove_all(run());
        Started one(certify_words(false, run()), path("one"));
        std::this_thread::sleep_for(std::chrono::milliseconds(40 * round));
        Started two(certify_words(true, run()), path("two"));
        for (Started* each : {&one, &two}) {
            const int status = each->exit_status();
            done += status < 2 ? 1 : 0;
            if (status >= 2) {
                EXPECT_TRUE(holds(each->output(), "Another program is writing"))
                    << status << each->output();
            }
        }
        expect_whole();
    }
    EXPECT_GE(done, 6);
}

TEST_F(RunFolders, Files08TwoKeygensAtOnceLeaveOnePairThatMatches) {
    for (int round = 0; round < 10; ++round) {
        const std::string name = path(fmt::format("pair{}", round)).string();
        const Words words{RUNCERT_PROGRAMS "/runcert", "keygen", "--out", name, "--no-password"};
        Started one(words, path("one"));
        Started two(words, path("two"));
        const int first = one.exit_status();
        const int second = two.exit_status();
        EXPECT_EQ(std::min(first, second), 0) << one.output() << two.output();
        EXPECT_EQ(std::max(first, second), 2) << one.output() << two.output();
        fs::remove_all(run());
        fs::copy(original(), run(), fs::copy_options::recursive);
        const ProcessResult made = runcert({"sign", run().string(), "--key", name + ".key",
                                            "--role", "measurer", "--no-render", "--no-recompute"});
        EXPECT_EQ(made.exit_status, 0) << made.errors;
        EXPECT_EQ(verify({"--pubkey", name + ".pub"}).exit_status, 0) << round;
    }
}

TEST_F(RunFolders, Files08AKeyOfAnotherIsNeverReplacedNorHalfAPairLeft) {
    const std::string name = path("half").string();
    write_file_atomically(name + ".pub", "another's");
    EXPECT_EQ(runcert({"keygen", "--out", name, "--no-password"}).exit_status, 2);
    EXPECT_EQ(read_file(name + ".pub"), "another's");
    EXPECT_FALSE(fs::exists(name + ".key"));
    fs::create_symlink("nowhere", path("link.key"));
    EXPECT_EQ(runcert({"keygen", "--out", path("link").string(), "--no-password"}).exit_status, 2);
    EXPECT_TRUE(fs::is_symlink(path("link.key")));
    EXPECT_FALSE(fs::exists(path("link.pub")));
}

/// What a folder holds, on a disk that has just so many blocks of 4 KiB left.
TEST_F(RunFolders, Files08AFullDiskLosesNoSignatureAndNoStamp) {
    if (!mounts()) GTEST_SKIP() << "no file system can be mounted here (needs root)";
    must_sign("measurer", "measurer");
    write_file_atomically(run() / "report.json.minisig.tsr", "stamp");
    write_file_atomically(run() / "report.json.minisig.tsq", "query");
    const auto before = contents_of(run());
    int failed = 0;
    int went = 0;
    // superseded/ takes the report's blocks and a page for each of three files, the new signature
    // one.
    const auto of_report = static_cast<int>(before.at("report.json").size() / 4096 + 1);
    std::vector<int> blocks{0, 1};
    for (int more = 0; more <= 8; ++more)
        blocks.push_back(of_report + more);
    const std::string kept =
        fs::relative(superseded(before.at("report.json"), "report.json.minisig"), run()).string();
    for (const int free : blocks) {
        const fs::path after = path(fmt::format("after{}", free));
        const std::string script = fmt::format(
            "mkdir -p '{0}'; mount -t tmpfs -o size=16m none '{0}' && cp -a '{1}/.' '{0}' && "
            "used=$(stat -f -c '$((%b-%f))' '{0}'); eval used=$used; "
            "mount -o remount,size=$(((used+{2})*4))k '{0}'; "
            "'{3}' sign '{0}' --key '{4}' --role measurer --no-render --no-recompute; "
            "echo $? > '{5}.status'; cp -a '{0}' '{5}'",
            path("disk").string(), run().string(), free, RUNCERT_PROGRAMS "/runcert",
            key("measurer"), after.string());
        run_process({"unshare", "-m", "sh", "-c", script});
        auto now = contents_of(after);
        if (read_file(after.string() + ".status") == "0\n") {
            ++went;
            EXPECT_EQ(now[kept], before.at("report.json.minisig"));
            EXPECT_EQ(now[kept + ".tsr"], "stamp");
            EXPECT_EQ(now[kept + ".tsq"], "query");
            continue;
        }
        ++failed;
        EXPECT_EQ(read_file(after.string() + ".status"), "2\n");
        for (const auto& [name, bytes] : before)
            EXPECT_EQ(now[name], bytes) << name << " with " << free << " blocks";
    }
    EXPECT_GE(failed, 2);
    EXPECT_GE(went, 1);
}

TEST_F(RunFolders, Files08WhatAKilledProgramHalfWroteIsRemovedByTheNext) {
    must_sign("measurer", "measurer");
    must_sign("measurer", "measurer");
    std::vector<fs::path> left;
    for (const fs::path& folder :
         {run(), superseded(read_file(run() / "report.json"), "").parent_path()}) {
        left.push_back(folder / (own_name() + ".tmp"));
        write_file_atomically(left.back(), "half");
    }
    must_sign("judge", "judge");
    for (const fs::path& each : left)
        EXPECT_FALSE(fs::exists(each)) << each;
}

TEST_F(RunFolders, Files08ACertificateThatDoesNotFitLeavesTheEarlierOne) {
    must_sign("measurer", "measurer");
    const auto before = contents_of(run());
    const ProcessResult result =
        run_process({"sh", "-c",
                     fmt::format("ulimit -f 16; '{}/runcert' certify '{}' --out '{}' --no-render",
                                 RUNCERT_PROGRAMS, attempt(true).string(), run().string())});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_TRUE(holds(result.errors, "File too large")) << result.errors;
    EXPECT_EQ(contents_of(run()), before);
    expect_whole();
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

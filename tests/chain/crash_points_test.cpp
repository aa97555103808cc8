// What a run folder is at every moment that a crash could leave: the program is killed before each
// of its calls that change a folder, one after the other; and whatever it gives its name was synced
// before, and the name after. strace does both, so that no clock and no chance is in it.
#include <algorithm>
#include <csignal>
#include <functional>

#include "core/failure.h"
#include "core/text.h"
#include "draws.h"
#include "signatures_support.h"
#include "watched_run.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Words = std::vector<std::string>;

/// strace ignores those marked ? where the processor's system does not have them.
constexpr const char* changing_calls =
    "fsync,?rename,?renameat,renameat2,?unlink,unlinkat,?rmdir,?mkdir,mkdirat,?link,linkat";

Words under_strace(Words options, const Words& command) {
    options.insert(options.begin(), {"strace", "-qq", "-y", "-s", "4096"});
    options.insert(options.end(), command.begin(), command.end());
    return options;
}

class CrashPoints : public SignedRuns {
  protected:
    void SetUp() override {
        const Words nothing = under_strace({"-o", path("log").string()}, {"true"});
        try {
            if (run_process(nothing).exit_status != 0) GTEST_SKIP() << "no process is traced here";
        } catch (const Failure&) {
            GTEST_SKIP() << "strace is not installed";
        }
        SignedRuns::SetUp();
    }

    static Words program(Words words) {
        words.insert(words.begin(), RUNCERT_PROGRAMS "/runcert");
        return words;
    }
    Words certify_other() const {
        if (!fs::exists(path("other"))) {
            fs::copy(examples / "salt_lake", path("other"), fs::copy_options::recursive);
            write_file_atomically(path("other") / "attempt.yaml",
                                  read_file(path("other") / "attempt.yaml") + "attempts_made: 2\n");
        }
        return program({"certify", (path("other") / "attempt.yaml").string(), "--out",
                        run().string(), "--no-render", "--key", key("measurer")});
    }
    Words sign_words(const std::string& name) const {
        return program({"sign", run().string(), "--key", key(name), "--role", name, "--no-render",
                        "--no-recompute"});
    }
    void must_do(const Words& command) const {
        const ProcessResult result = run_process(command);
        ASSERT_LT(result.exit_status, 2) << command[1] << ": " << result.errors;
    }

    /// The calls by which a command changes folders, as strace writes them: those of its own
    /// process, or of all that it starts too.
    Words calls_of(const Words& command, bool of_all = false) const {
        Words options{"-o", path("log").string(), "-e", std::string("trace=") + changing_calls,
                      "-e", "signal=none"};
        if (of_all) options.emplace_back("-f");
        const ProcessResult result = run_process(under_strace(options, command));
        EXPECT_LT(result.exit_status, 2) << result.errors;
        return lines_of(read_file(path("log")));
    }

    /// Runs a command and kills it before its nth call of a name. False where it has no more.
    bool killed_before(const std::string& call, int n, const Words& command) const {
        const ProcessResult result =
            run_process(under_strace({"-o", "/dev/null", "-e", "trace=" + call, "-e", "signal=none",
                                      "-e", fmt::format("inject={}:signal=KILL:when={}", call, n)},
                                     command));
        if (result.exit_status == 128 + SIGKILL) return true;
        EXPECT_LT(result.exit_status, 2) << result.errors;
        return false;
    }

    /// Kills a command before each of its calls of these names; after the first three, in the daily
    /// set, before every seventh; of removals always before every third. Each time `begin`
    /// makes the run folder first, and `look` sees what is left. How many kills there were.
    int kill_at_each(const Words& command, const std::function<void()>& begin,
                     const std::function<void()>& look) const {
        int kills = 0;
        for (const char* call : {"renameat", "renameat2", "mkdirat", "unlinkat"})
            for (int n = 1, later = draws({.daily = 7, .study = 1});;
                 n += n < 4 ? 1 : std::max(later, call == std::string_view("unlinkat") ? 3 : 1)) {
                SCOPED_TRACE(fmt::format("before {} {}", call, n));
                begin();
                if (!killed_before(call, n, command)) break;
                ++kills;
                look();
            }
        return kills;
    }
    /// The run folder as another is, with the evidence that is in it.
    Watched begun_from(const fs::path& from) const {
        fs::remove_all(run());
        fs::copy(from, run(), fs::copy_options::recursive);
        Watched watched(run());
        watched.note();
        return watched;
    }
};

TEST_F(CrashPoints, CertifyLeavesTheEarlierRunOrTheNewOne) {
    must_sign("judge", "judge");
    fs::rename(run(), path("before"));
    std::set<std::string> reports;
    const Words command = certify_other();
    Watched watched(run());
    const int kills = kill_at_each(
        command, [&] { watched = begun_from(path("before")); },
        [&] {
            watched.expect_whole();
            reports.insert(read_file(run() / "report.json"));
        });
    EXPECT_GE(kills, 10);
    EXPECT_EQ(reports.size(), 2U) << "all were killed before, or all after, the exchange";
    watched = begun_from(path("before"));
    ASSERT_TRUE(killed_before("renameat2", 1, command));
    must_do(command);
    watched.expect_whole();
    expect_nothing_left();
}

// With the user's own folder in it, a run folder is not exchanged: for a while it has no report.
TEST_F(CrashPoints, CertifyInPlaceLosesNothing) {
    must_sign("judge", "judge");
    fs::create_directory(run() / "photos");
    write_file_atomically(run() / "photos/a.jpg", "a");
    fs::rename(run(), path("before"));
    const Words command = certify_other();
    Watched watched(run());
    int without_report = 0;
    const int kills = kill_at_each(
        command, [&] { watched = begun_from(path("before")); },
        [&] {
            if (fs::exists(run() / "report.json"))
                watched.expect_whole({"photos/a.jpg"});
            else
                ++without_report;
            watched.expect_evidence();
            must_do(command);
            watched.expect_whole({"photos/a.jpg"});
            expect_nothing_left();
        });
    EXPECT_GE(kills, 20);
    EXPECT_GE(without_report, draws({.daily = 3, .study = 10}));
}

TEST_F(CrashPoints, SignLosesNoSignatureAndNoStamp) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    write_file_atomically(run() / "report.json.judge.minisig.tsr", "stamp");
    fs::rename(run(), path("before"));
    Watched watched(run());
    const int kills = kill_at_each(
        sign_words("judge"), [&] { watched = begun_from(path("before")); },
        [&] {
            watched.expect_whole();
            const auto found =
                verify_json({"--pubkey", public_key("measurer"), "--pubkey", public_key("judge")});
            for (const auto& one : found["signers"])
                EXPECT_EQ(one["valid"], true) << one.dump(1);
            must_do(sign_words("judge"));
            watched.expect_whole();
            expect_nothing_left();
        });
    EXPECT_GE(kills, 3);
}

TEST_F(CrashPoints, KeygenLeavesAPairOrNoKey) {
    const Words command = program({"keygen", "--out", path("new").string(), "--no-password"});
    const int kills = kill_at_each(
        command,
        [&] {
            fs::remove(path("new.key"));
            fs::remove(path("new.pub"));
        },
        [&] { EXPECT_FALSE(fs::exists(path("new.pub")) && !fs::exists(path("new.key"))); });
    EXPECT_GE(kills, 2);
}

bool has(const Words& lines, const std::string& begin, const std::string& part) {
    return std::ranges::any_of(lines, [&](const std::string& line) {
        return line.find(begin) != std::string::npos && line.find(part) != std::string::npos;
    });
}
Words before(const Words& lines, const std::string& part) {
    const auto found = std::ranges::find_if(
        lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
    EXPECT_NE(found, lines.end()) << part;
    return {lines.begin(), found};
}
Words after(const Words& lines, const std::string& part) {
    const Words first = before(lines, part);
    return {lines.begin() + std::ssize(first), lines.end()};
}
/// That a folder and each file in it is synced by these calls.
void expect_synced(const Words& calls, const fs::path& run, const std::string& as) {
    for (const auto& entry : fs::directory_iterator(run))
        if (entry.is_regular_file()) {
            const std::string name = entry.path().filename().string();
            EXPECT_TRUE(has(calls, "fsync(", as + "/" + name + ">")) << name;
        }
    EXPECT_TRUE(has(calls, "fsync(", as + ">")) << as;
}

TEST_F(CrashPoints, ARunIsSyncedBeforeItHasItsNameAndTheNameAfter) {
    const Words calls = calls_of(certify_other());
    expect_synced(before(calls, "RENAME_EXCHANGE"), run(), "/run");
    EXPECT_TRUE(has(after(calls, "RENAME_EXCHANGE"), "fsync(", run().parent_path().string() + ">"));
}

TEST_F(CrashPoints, ARunIsSyncedBeforeItIsPutInPlaceAndTheFolderAfter) {
    fs::create_directory(run() / "photos");
    const Words calls = calls_of(certify_other());
    const std::string removal = run().string() + ">, \"report.json\", 0)";
    expect_synced(before(calls, removal), run(), "/run");
    EXPECT_TRUE(has(after(calls, removal), "fsync(", run().string() + ">"));
}

TEST_F(CrashPoints, EveryRunOfABatchIsSynced) {
    const fs::path day = path("day");
    fs::create_directories(day);
    fs::copy(examples / "salt_lake", day / "attempt", fs::copy_options::recursive);
    const Words calls = calls_of(
        program({"batch", day.string(), "--out", path("out").string(), "--no-render"}), true);
    int runs = 0;
    for (const auto& entry : fs::directory_iterator(path("out")))
        if (fs::exists(entry.path() / "report.json")) {
            ++runs;
            expect_synced(calls, entry.path(), "/" + entry.path().filename().string());
        }
    EXPECT_EQ(runs, 1);
}

/// That each file was synced before it had its name, and the folder after.
void expect_each_synced(const Words& calls, const fs::path& folder,
                        const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const std::string named = fmt::format(", \"{}\"", name);
        const Words then = after(calls, named);
        ASSERT_FALSE(then.empty());
        const std::string temporary =
            then[0].substr(then[0].find('"') + 1,
                           then[0].find('"', then[0].find('"') + 1) - then[0].find('"') - 1);
        EXPECT_TRUE(has(before(calls, named), "fsync(", "/" + temporary + ">")) << then[0];
        EXPECT_TRUE(has(then, "fsync(", folder.string() + ">"));
    }
}

TEST_F(CrashPoints, AFileByItselfIsSyncedBeforeItHasItsNameAndTheFolderAfter) {
    expect_each_synced(
        calls_of(program({"keygen", "--out", path("new").string(), "--no-password"})),
        folder_.path(), {"new.key", "new.pub"});
    expect_each_synced(calls_of(sign_words("judge")), run(), {"report.json.minisig"});
    expect_each_synced(calls_of({RUNCERT_PROGRAMS "/runcert-enu", "--attempt",
                                 (run() / "attempt.yaml").string(), "--run-dir", run().string()}),
                       run(), {"2-enu.ecsv"});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

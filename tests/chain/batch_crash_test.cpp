// A day in which programs crash, hang, are killed or say nonsense, and in which the batch itself is
// interrupted, killed or in another's way: the same command again ends with the undisturbed bytes.
#include <gtest/gtest.h>

#include "batch_crash_support.h"
#include "store/user_state.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr int attempts = 3;
constexpr int epochs = 100;

struct Fault {
    std::string script;  ///< in place of the stage
    std::string said;
};

const std::vector<Fault> faults{
    {"kill -ABRT $$", "was ended by signal 6 (Aborted)"},
    {"exec sleep 300", "did not end within 15 s"},
    {"kill -KILL $$", "use fewer --jobs"},
    {"echo what now >&2; exit 3", "ended with status 3: what now"},
    {"exec yes", "wrote more than 16 MiB"},
    {"exit 0", "ended well without this file"},
    {"exec /nonexistent/program", "ended with status 127"},
};

/// A stage that has another fault for each attempt, and none for one more.
std::string faulty(const std::string& program) {
    std::string script = "case \"$*\" in\n";
    for (std::size_t i = 0; i < faults.size(); ++i)
        script += fmt::format("*/run-{:04}*) {} ;;\n", i + 1, faults[i].script);
    return script + "esac\nexec " + Programs::real(program) + " \"$@\"";
}

TEST(Batch, AStageThatFailsIsSaidInWordsAndTheOthersAreDone) {
    DisturbedDay day(static_cast<int>(faults.size()) + 1, epochs);
    day.programs.replace("runcert-enu", faulty("runcert-enu"));
    const ProcessResult first = day.batch({"--time-limit", "15"});
    EXPECT_EQ(first.end, ProcessEnd::by_itself);
    EXPECT_EQ(first.exit_status, 2) << first.errors;
    const auto events = events_in(first.output);
    const std::string table = read_file(day.out / "day.csv");
    for (std::size_t i = 0; i < faults.size(); ++i) {
        const std::string id = fmt::format("run-{:04}", i + 1);
        EXPECT_TRUE(holds(error_of(events, id), "enu: ")) << error_of(events, id);
        EXPECT_TRUE(holds(error_of(events, id), faults[i].said)) << error_of(events, id);
        EXPECT_TRUE(holds(table, id)) << table;
    }
    EXPECT_EQ(events.back().at("done"), 1);
    EXPECT_EQ(events.back().at("failed"), faults.size());
    EXPECT_TRUE(gone_soon(day.out.string()));

    day.programs.restore("runcert-enu");
    const ProcessResult second = day.batch();
    EXPECT_EQ(second.exit_status, 0) << second.errors << second.output;
    EXPECT_EQ(day.differing(), Words{});
    EXPECT_EQ(half_written(day.out), Words{});
}

TEST(Batch, WhatAStageLeavesRunningIsEndedAndItsRunIsDone) {
    DisturbedDay day(attempts, epochs);
    // Marked by its folder, so that it is found again.
    const std::string left = (day.folder.path() / "left").string();
    fs::create_symlink("/bin/sleep", left);
    day.programs.replace("runcert-enu",
                         left + " 300 &\nexec " + Programs::real("runcert-enu") + " \"$@\"");
    const ProcessResult result = day.batch();
    EXPECT_EQ(result.exit_status, 0) << result.errors << result.output;
    EXPECT_TRUE(gone_soon(left));
}

// Runs side by side share the processors, and what a step writes is synced when it is published.
TEST(Batch, StepsAreToldOfTheirThreadsAndThatTheBatchSyncs) {
    DisturbedDay day(attempts, epochs);
    const fs::path told = day.folder.path() / "told";
    day.programs.replace(
        "runcert-enu", fmt::format("echo \"$RUNCERT_THREADS $RUNCERT_SYNC\" >> {}\nexec {} \"$@\"",
                                   told.string(), Programs::real("runcert-enu")));
    const ProcessResult result = day.batch({"--jobs", "2"}, {{"RUNCERT_THREADS", "7"}});
    EXPECT_EQ(result.exit_status, 0) << result.errors << result.output;
    EXPECT_EQ(read_file(told), "3 caller\n3 caller\n3 caller\n");
    EXPECT_EQ(day.differing(), Words{});
}

// The files of steps that were kept between two that are done were once not there for the second.
TEST(Batch, AnotherRecordToBeatIsClaimedAndCheckedWithWhatIsKept) {
    DisturbedDay day(attempts, epochs);
    ASSERT_EQ(day.batch().exit_status, 0);
    day.change_record();
    const ProcessResult second = day.batch();
    EXPECT_EQ(second.exit_status, 0) << second.output;
    EXPECT_EQ(events_in(second.output).back().at("steps_run"), attempts * 3);
    EXPECT_EQ(day.differing(), Words{});
}

TEST(Batch, ResultsThatCannotBeWrittenAreSaidAfterTheRuns) {
    DisturbedDay day(attempts, epochs);
    // What is in the way cannot be set aside there.
    fs::create_directories(day.out / ".runcert");
    std::ofstream(day.out / ".runcert" / "superseded") << "a file";
    fs::create_directories(day.out / "day.csv");
    const ProcessResult first = day.batch();
    EXPECT_EQ(first.exit_status, 2);
    EXPECT_TRUE(holds(first.errors, "superseded")) << first.errors;
    const Event end = events_in(first.output).back();
    EXPECT_EQ(end.at("done"), attempts);
    EXPECT_TRUE(holds(end.at("closing").dump(), "results could not be written")) << end;
    fs::remove(day.out / ".runcert" / "superseded");
    const ProcessResult second = day.batch();
    EXPECT_EQ(second.exit_status, 0) << second.errors;
    EXPECT_EQ(events_in(second.output).back().at("steps_run"), 0);
}

TEST(Batch, ARunFolderThatIsNoneStopsItsAttemptAlone) {
    DisturbedDay day(attempts, epochs);
    const fs::path file = day.out / "run-0002";
    fs::create_directories(day.out);
    std::ofstream(file) << "the measurer's own";
    const ProcessResult first = day.batch({"--jobs", "2"});
    EXPECT_EQ(first.exit_status, 2) << first.errors;
    const auto events = events_in(first.output);
    EXPECT_TRUE(holds(error_of(events, "run-0002"), "run-0002"));
    EXPECT_EQ(events.back().at("done"), 2);
    EXPECT_EQ(read_file(file), "the measurer's own");
    fs::remove(file);
    EXPECT_EQ(day.batch().exit_status, 0);
    EXPECT_EQ(day.differing(), Words{});
}

TEST(Batch, WhatKilledProgramsLeftHalfWrittenIsTakenAway) {
    DisturbedDay day(attempts, epochs);
    ASSERT_EQ(day.batch().exit_status, 0);
    fs::create_directories(day.out / own_name() / "run");
    std::ofstream(day.out / "run-0001" / (own_name() + ".tmp")) << "half";
    std::ofstream(day.out / "runcert-notes") << "the measurer's own";
    day.change_record();
    EXPECT_EQ(day.batch().exit_status, 0);
    EXPECT_EQ(half_written(day.out), Words{});
    for (const auto& entry : fs::directory_iterator(day.out))
        EXPECT_FALSE(entry.path().filename().string().starts_with(".runcert-")) << entry;
    EXPECT_TRUE(fs::exists(day.out / "runcert-notes"));
}

/// A day whose second attempt is held up in its import until it may go on.
class HeldDay : public testing::Test {
  protected:
    HeldDay() {
        day.programs.replace(
            "runcert-import",
            fmt::format(
                "if grep -q 'the attempt run-0002[.]' \"$2\"; then : > '{}'\n"
                "while [ ! -e '{}' ] && kill -0 $PPID 2> /dev/null; do sleep 0.02; done; fi\n"
                "exec {} \"$@\"",
                held.string(), go.string(), Programs::real("runcert-import")));
    }
    Words command(const Words& more = {}) const {
        return day.command(day.programs.runcert(), day.out, more);
    }
    void wait_until_held() {
        ASSERT_TRUE(holds_within(120, [this] { return fs::exists(held); }));
    }
    void let_go() const { std::ofstream(go) << ""; }
    void expect_same_in_the_end() {
        let_go();
        const ProcessResult last = day.batch();
        EXPECT_EQ(last.exit_status, 0) << last.errors << last.output;
        EXPECT_EQ(day.differing(), Words{});
        EXPECT_EQ(half_written(day.out), Words{});
    }

    DisturbedDay day{attempts, epochs};
    fs::path held = day.folder.path() / "held";
    fs::path go = day.folder.path() / "go";
    fs::path log = day.folder.path() / "log";
};

TEST_F(HeldDay, InterruptedOnceFinishesWhatRunsAndSaysHowToGoOn) {
    Started batch(command({"--jobs", "1"}), log);
    wait_until_held();
    batch.send(SIGINT);
    ASSERT_TRUE(holds_within(120, [&] { return holds(batch.output(), "interrupt again"); }));
    EXPECT_FALSE(batch.has_ended());
    let_go();
    EXPECT_EQ(batch.exit_status(), 2);
    const Event end = events_in(batch.output()).back();
    EXPECT_EQ(end.at("event"), "end");
    EXPECT_EQ(end.at("done"), 2);
    EXPECT_EQ(end.at("not_processed"), 1);
    EXPECT_TRUE(holds(end.at("closing").dump(), "The same command again goes on"));
    EXPECT_TRUE(holds(read_file(day.out / "day.html"), "the batch was interrupted before"));
    expect_same_in_the_end();
}

TEST_F(HeldDay, InterruptedTwiceStopsNow) {
    Started batch(command({"--jobs", "1"}), log);
    wait_until_held();
    batch.send(SIGINT);
    ASSERT_TRUE(holds_within(120, [&] { return holds(batch.output(), "interrupt again"); }));
    batch.send(SIGINT);
    EXPECT_EQ(batch.exit_status(), 2);
    EXPECT_TRUE(gone_soon(day.out.string()));
    const Event end = events_in(batch.output()).back();
    EXPECT_EQ(end.at("done"), 1);
    EXPECT_EQ(end.at("not_processed"), 2);
    EXPECT_TRUE(holds(end.at("closing").dump(), "The same command again goes on"));
    expect_same_in_the_end();
}

TEST_F(HeldDay, ASigtermStopsNow) {
    Started batch(command({"--jobs", "2"}), log);
    wait_until_held();
    batch.send(SIGTERM);
    EXPECT_EQ(batch.exit_status(), 2);
    EXPECT_TRUE(gone_soon(day.out.string()));
    EXPECT_EQ(events_in(batch.output()).back().at("event"), "end");
    expect_same_in_the_end();
}

TEST_F(HeldDay, InterruptedAgainWhatIsDoneFromBeforeIsStillInTheResults) {
    let_go();
    ASSERT_EQ(day.batch().exit_status, 0);
    fs::remove(go);
    fs::remove(held);
    std::ofstream(day.day / "recordings" / "0002.pos", std::ios::app) << "\n";
    Started batch(command({"--jobs", "1"}), log);
    wait_until_held();
    batch.send(SIGINT);
    let_go();
    batch.exit_status();
    // The third was done before, and is though this call did not come to it.
    EXPECT_EQ(events_in(batch.output()).back().at("not_processed"), 0) << batch.output();
    EXPECT_FALSE(holds(read_file(day.out / "day.html"), "interrupted"));
}

TEST_F(HeldDay, ASecondBatchSaysWhoHasItOrWaits) {
    Started first(command(), log);
    wait_until_held();
    const ProcessResult second = day.batch();
    EXPECT_EQ(second.exit_status, 2);
    EXPECT_TRUE(holds(second.errors, "Another batch is at work on this folder: process " +
                                         std::to_string(first.number()) + " on "))
        << second.errors;
    EXPECT_TRUE(holds(second.errors, "--wait"));

    const ProcessResult share = day.batch({"--share", "0/1"});
    EXPECT_EQ(share.exit_status, 2);
    EXPECT_TRUE(holds(share.errors, "Another batch is at work")) << share.errors;

    const fs::path wait_log = day.folder.path() / "wait log";
    Started waiting(command({"--wait"}), wait_log);
    ASSERT_TRUE(holds_within(120, [&] { return holds(waiting.output(), "waiting for another"); }));
    EXPECT_FALSE(waiting.has_ended());
    let_go();
    EXPECT_EQ(first.exit_status(), 0) << first.output();
    EXPECT_EQ(waiting.exit_status(), 0) << waiting.output();
    EXPECT_EQ(day.differing(), Words{});
}

TEST_F(HeldDay, AWaitThatIsInterruptedLeavesAllToTheOther) {
    Started first(command({"--jobs", "1"}), log);
    wait_until_held();
    const fs::path wait_log = day.folder.path() / "wait log";
    Started waiting(command({"--wait"}), wait_log);
    ASSERT_TRUE(holds_within(120, [&] { return holds(waiting.output(), "waiting for another"); }));
    waiting.send(SIGINT);
    EXPECT_EQ(waiting.exit_status(), 2);
    EXPECT_FALSE(fs::exists(day.out / "day.html"));
    let_go();
    EXPECT_EQ(first.exit_status(), 0) << first.output();
    EXPECT_TRUE(fs::exists(day.out / "day.html"));
}

TEST_F(HeldDay, ABatchLeavesAShareAtWorkAlone) {
    Started share(command({"--share", "0/1"}), log);
    wait_until_held();
    const ProcessResult second = day.batch();
    EXPECT_EQ(second.exit_status, 2);
    EXPECT_TRUE(holds(second.errors, "process " + std::to_string(share.number()) + " on "))
        << second.errors;
    let_go();
    EXPECT_EQ(share.exit_status(), 0) << share.output();
    EXPECT_FALSE(fs::exists(day.out / "day.html"));
    const ProcessResult after = day.batch();
    EXPECT_EQ(after.exit_status, 0) << after.errors;
    EXPECT_EQ(events_in(after.output).back().at("steps_run"), 0);
    EXPECT_EQ(day.differing(), Words{});
}

TEST_F(HeldDay, KilledItTakesItsChildrenAlongAndItsLockIsRecognised) {
    Started batch(command({"--jobs", "1"}), log);
    wait_until_held();
    batch.send(SIGKILL);
    EXPECT_EQ(batch.exit_status(), 128 + SIGKILL);
    EXPECT_TRUE(gone_soon(day.out.string()));
    let_go();
    const ProcessResult next = day.batch();
    EXPECT_EQ(next.exit_status, 0) << next.errors << next.output;
    EXPECT_TRUE(holds(next.output,
                      "ended in its midst (process " + std::to_string(batch.number()) + " on "))
        << next.output;
    // The first attempt was done.
    EXPECT_GE(events_in(next.output).back().at("steps_kept").get<int>(), 8);
    EXPECT_EQ(day.differing(), Words{});
    EXPECT_FALSE(holds(day.batch().output, "ended in its midst"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

// A day on a cluster of three nodes, one of which fails: the results must be those of one machine,
// to the byte.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "batch_crash_support.h"
#include "draws.h"
#include "slurm_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

class SlurmDay : public testing::Test {
  protected:
    void SetUp() override {
        if (!cluster.why_not().empty()) GTEST_SKIP() << cluster.why_not();
        make_day(day, attempts, 150);
    }
    /// So that nothing waits for tasks that wait themselves.
    void TearDown() override { let_go(); }

    Words command(const fs::path& to, const Words& more) const {
        Words words{programs.runcert(), "batch", day.string(), "--out", to.string(), "--no-render"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    ProcessResult here(const fs::path& to, const Words& more = {}) const {
        return run_process(command(to, more));
    }
    Words on_cluster() const {
        return command(out, {"--engine", "slurm", "--slurm-args", "--comment='a day of many'"});
    }
    ProcessResult submitted() const { return run_process(on_cluster()); }

    /// All but two attempts wait in their first stage until they may go on.
    void hold_up() const {
        programs.replace("runcert-import",
                         fmt::format("grep -q 'the attempt run-000[12][.]' \"$2\" ||\n"
                                     "while [ ! -e '{}' ]; do sleep 0.05; done\nexec {} \"$@\"",
                                     go.string(), Programs::real("runcert-import")));
    }
    void let_go() const { write_file_atomically(go, ""); }

    std::size_t done() const {
        std::size_t count = 0;
        for (int i = 1; i <= attempts; ++i)
            count += fs::exists(out / fmt::format("run-{:04}", i) / "report.json") ? 1 : 0;
        return count;
    }
    /// Ids of the arrays that wait or run.
    static std::set<std::string> jobs() {
        const auto ids = lines_of(run_process({"squeue", "--noheader", "--format=%F"}).output);
        return {ids.begin(), ids.end()};
    }
    std::string page() const { return read_file(out / "day.html"); }

    /// Twice as many as run at once: some are done, some run and some wait when a node fails.
    const int attempts = draws({.daily = 12, .study = 40});
    TemporaryFolder folder;
    Programs programs{folder.path() / "programs"};
    fs::path day = folder.path() / "the day's attempts";
    fs::path out = folder.path() / "on the cluster";
    fs::path local = folder.path() / "local";
    fs::path go = folder.path() / "go";
    fs::path log = folder.path() / "log";
    SlurmCluster cluster;
};

TEST_F(SlurmDay, EndsWithTheBytesOfALocalRunThoughANodeFails) {
    hold_up();
    Started first(on_cluster(), log);
    ASSERT_TRUE(holds_within(120, [&] { return done() == 2 && cluster.runs_on("n2"); }))
        << first.output();
    EXPECT_TRUE(holds(first.output(), fmt::format("{0} runs to be made by {0} tasks", attempts)))
        << first.output();
    cluster.take_down("n2");
    EXPECT_EQ(here(out, {"--status"}).exit_status, 1) << "not all is done";

    const auto before = jobs();
    EXPECT_EQ(before.size(), 1U);
    const ProcessResult second = submitted();
    EXPECT_EQ(second.exit_status, 2);
    EXPECT_TRUE(holds(second.errors, "of an earlier call is at work on this day")) << second.errors;
    EXPECT_EQ(jobs(), before);

    let_go();
    ASSERT_TRUE(holds_within(240, [&] { return first.has_ended(); })) << first.output();
    EXPECT_EQ(first.exit_status(), 0) << first.output();
    EXPECT_EQ(cluster.count_nodes("down"), 1U);
    const ProcessResult result = here(local);
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    const auto expected = results_of(local);
    for (const char* name : {"day.yaml", "day.csv", "day.html"})
        EXPECT_TRUE(expected.contains(name));
    EXPECT_EQ(differences(results_of(out), expected), Words{});

    const ProcessResult again = submitted();
    EXPECT_EQ(again.exit_status, 0) << again.errors;
    EXPECT_FALSE(holds(again.output, "to be made")) << again.output;
    EXPECT_EQ(differences(results_of(out), expected), Words{});
}

TEST_F(SlurmDay, OnlyTheRestIsMade) {
    const ProcessResult result = here(out);
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    const auto expected = results_of(out);
    fs::remove_all(out / "run-0007");
    const fs::path edited = out / "run-0009" / "4-trajectory.ecsv";
    const auto time = fs::last_write_time(edited);
    std::string bytes = read_file(edited);
    bytes[bytes.size() / 2] ^= 1;
    write_file_atomically(edited, bytes);
    fs::last_write_time(edited, time);

    const ProcessResult rest = submitted();
    ASSERT_EQ(rest.exit_status, 0) << rest.errors << rest.output;
    EXPECT_TRUE(holds(rest.output, "2 runs to be made by 2 tasks")) << rest.output;
    // What somebody had changed is kept.
    EXPECT_TRUE(fs::exists(out / "run-0009" / "superseded"));
    fs::remove_all(out / "run-0009" / "superseded");
    EXPECT_EQ(differences(results_of(out), expected), Words{});
}

TEST_F(SlurmDay, ACallThatIsKilledLeavesTheArrayAtWork) {
    hold_up();
    {
        Started first(on_cluster(), log);
        ASSERT_TRUE(holds_within(120, [&] { return done() == 2; })) << first.output();
        first.send(SIGKILL);
        EXPECT_EQ(first.exit_status(), 128 + SIGKILL);
    }
    EXPECT_EQ(jobs().size(), 1U);
    const ProcessResult second = submitted();
    EXPECT_EQ(second.exit_status, 2) << second.output;
    EXPECT_TRUE(holds(second.errors, "earlier call")) << second.errors;
    let_go();
    ASSERT_TRUE(holds_within(240, [&] { return jobs().empty(); }));
    EXPECT_FALSE(fs::exists(out / "day.html"));
    const ProcessResult third = submitted();
    EXPECT_EQ(third.exit_status, 0) << third.errors << third.output;
    EXPECT_FALSE(holds(third.output, "to be made")) << third.output;
    ASSERT_EQ(here(local).exit_status, 0);
    EXPECT_EQ(differences(results_of(out), results_of(local)), Words{});
}

TEST_F(SlurmDay, OfACancelledArrayThePageSaysWhatIsNotDone) {
    hold_up();
    Started first(on_cluster(), log);
    ASSERT_TRUE(holds_within(120, [&] { return done() == 2; })) << first.output();
    run_process({"scancel", *jobs().begin()});
    EXPECT_EQ(first.exit_status(), 2) << first.output();
    EXPECT_TRUE(holds(page(), "it was not run to its end")) << first.output();
    EXPECT_TRUE(holds(read_file(out / "day.yaml"), "it was not run to its end"));
    let_go();
    const ProcessResult second = submitted();
    EXPECT_EQ(second.exit_status, 0) << second.errors << second.output;
    EXPECT_TRUE(holds(second.output, fmt::format("{} runs to be made", attempts - 2)))
        << second.output;
    ASSERT_EQ(here(local).exit_status, 0);
    EXPECT_EQ(differences(results_of(out), results_of(local)), Words{});
}

TEST(SlurmDayWithoutSlurm, SaysWhatToInstall) {
    const TemporaryFolder folder;
    make_day(folder.path() / "day", 1, 600);
    const ProcessResult result = runcert({"batch", (folder.path() / "day").string(), "--out",
                                          (folder.path() / "out").string(), "--engine", "slurm"},
                                         {{"PATH", folder.path().string()}});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(holds(result.errors, "slurm-client")) << result.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

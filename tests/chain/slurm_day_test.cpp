// A day on a cluster of three nodes, one of which fails: the results must be those of one machine,
// to the byte.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "batch_crash_support.h"
#include "draws.h"
#include "make/slurm.h"
#include "slurm_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

void expect_same(const fs::path& cluster, const fs::path& local) {
    const auto made = results_of(cluster);
    const auto expected = results_of(local);
    EXPECT_TRUE(expected.contains("day.yaml"));
    EXPECT_TRUE(expected.contains("day.csv"));
    EXPECT_TRUE(expected.contains("day.html"));
    for (const auto& [name, bytes] : expected) {
        ASSERT_TRUE(made.contains(name)) << name << " was not made";
        EXPECT_TRUE(made.at(name) == bytes) << name << " differs";
    }
    EXPECT_EQ(made.size(), expected.size());
}

class SlurmDay : public testing::Test {
  protected:
    void SetUp() override {
        if (!cluster.why_not().empty()) GTEST_SKIP() << cluster.why_not();
        make_day(day, attempts, 150);
    }

    ProcessResult batch(const std::vector<std::string>& more) const {
        std::vector<std::string> command{programs.runcert(), "batch",      day.string(), "--out",
                                         out.string(),       "--no-render"};
        command.insert(command.end(), more.begin(), more.end());
        return run_process(command);
    }
    ProcessResult submitted() const {
        return batch({"--engine", "slurm", "--slurm-args", "--comment='a day of many'"});
    }
    SlurmJobs jobs() const {
        return read_slurm_jobs(out / ".runcert" / "slurm" / "job.json").value();
    }
    JobState state() const {
        const SlurmJobs known = jobs();
        return job_state(known.array, known.cluster, known.tasks);
    }
    bool is_over() const {
        return state().is_over() && job_state(jobs().gatherer, jobs().cluster, 1).is_over();
    }

    /// Twice as many as run at once: some are done, some run and some wait when a node fails.
    const int attempts = draws({.daily = 12, .study = 40});
    TemporaryFolder folder;
    Programs programs{folder.path() / "programs"};
    fs::path day = folder.path() / "the day's attempts";
    fs::path out = folder.path() / "on the cluster";
    fs::path local = folder.path() / "local";
    SlurmCluster cluster;
};

TEST_F(SlurmDay, EndsWithTheBytesOfALocalRunThoughANodeFails) {
    // All but two wait in their first stage until the node has failed.
    const fs::path go = folder.path() / "go";
    programs.replace("runcert-import",
                     fmt::format("case \"$*\" in *run-000[12]*) ;; *)\n"
                                 "while [ ! -e '{}' ]; do sleep 0.05; done ;; esac\nexec {} \"$@\"",
                                 go.string(), Programs::real("runcert-import")));
    const ProcessResult first = submitted();
    ASSERT_EQ(first.exit_status, 0) << first.errors;
    EXPECT_TRUE(holds(first.output, "submitted job ")) << first.output;
    EXPECT_TRUE(holds(first.output, fmt::format("{0} tasks for {0} runs", attempts)))
        << first.output;
    ASSERT_TRUE(holds_within(600, [&] { return state().over >= 2 && cluster.runs_on("n2"); }));

    cluster.take_down("n2");
    ASSERT_TRUE(holds_within(600, [&] { return state().requeued > 0; }));
    write_file_atomically(go, "");
    const ProcessResult status = batch({"--status"});
    EXPECT_EQ(status.exit_status, 1) << "not all is done: " << status.errors;
    EXPECT_TRUE(holds(status.output, "begun again by Slurm")) << status.output;
    const std::string array = jobs().array;
    submitted();
    EXPECT_EQ(jobs().array, array) << "submitted twice while the first still runs";

    ASSERT_TRUE(holds_within(1200, [&] { return is_over(); }));
    EXPECT_EQ(cluster.count_nodes("down"), 1U);
    const ProcessResult here =
        runcert({"batch", day.string(), "--out", local.string(), "--no-render"});
    ASSERT_EQ(here.exit_status, 0) << here.errors;
    expect_same(out, local);

    submitted();
    EXPECT_EQ(jobs().array, array) << "submitted again though nothing is left to do";
}

TEST_F(SlurmDay, OnlyTheRestIsSubmitted) {
    const ProcessResult here = batch({"--engine", "local"});
    ASSERT_EQ(here.exit_status, 0) << here.errors;
    const auto expected = results_of(out);
    std::vector<fs::path> runs;
    for (const auto& entry : fs::directory_iterator(out))
        if (fs::exists(entry.path() / "6-verdict.yaml")) runs.push_back(entry.path());
    ASSERT_EQ(std::ssize(runs), attempts);
    fs::remove_all(runs[7]);
    const fs::path edited = runs[9] / "4-trajectory.ecsv";
    const auto time = fs::last_write_time(edited);
    std::string bytes = read_file(edited);
    bytes[bytes.size() / 2] ^= 1;
    write_file_atomically(edited, bytes);
    fs::last_write_time(edited, time);

    const ProcessResult rest = submitted();
    ASSERT_EQ(rest.exit_status, 0) << rest.errors;
    EXPECT_TRUE(holds(rest.output, "2 tasks for 2 runs")) << rest.output;
    ASSERT_TRUE(holds_within(600, [&] { return is_over(); }));
    // What somebody had changed is kept.
    EXPECT_TRUE(fs::exists(runs[9] / "superseded"));
    fs::remove_all(runs[9] / "superseded");
    EXPECT_EQ(differences(results_of(out), expected), Words{});
}

TEST_F(SlurmDay, WhatATaskLeftUnfinishedIsMadeBeforeTheResults) {
    const ProcessResult here = batch({"--engine", "local"});
    ASSERT_EQ(here.exit_status, 0) << here.errors;
    const auto expected = results_of(out);
    fs::remove_all(out / "run-0009");
    const fs::path ids = folder.path() / "ids";
    write_file_atomically(ids, "run-0008\nrun-0009\nrun-0010\n");
    const ProcessResult gathered = batch({"--gather", "--pending", ids.string()});
    EXPECT_EQ(gathered.exit_status, 0) << gathered.errors;
    EXPECT_EQ(differences(results_of(out), expected), Words{});
    // Of a task that left nothing the results say so; it was not among those submitted.
    fs::remove_all(out / "run-0009");
    write_file_atomically(ids, "run-0008\n");
    EXPECT_EQ(batch({"--gather", "--pending", ids.string()}).exit_status, 2);
    EXPECT_TRUE(holds(read_file(out / "day.yaml"), "it was not run to its end"));
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

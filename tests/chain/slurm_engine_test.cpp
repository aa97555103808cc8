// The engine's dealings with a real Slurm of three nodes; stubs stand for what the tasks run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/failure.h"
#include "make/slurm.h"
#include "slurm_support.h"
#include "store/atomic_file.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

/// A cluster, and a folder whose name holds what shells, Slurm and terminals take for their own.
class SlurmEngine : public testing::Test {
  protected:
    void SetUp() override {
        if (!cluster.why_not().empty()) GTEST_SKIP() << cluster.why_not();
        make_directory(out);
    }

    /// A program that notes what it was called with and begun, waits until it may go on, and notes
    /// that it ended; its exit status is that of the share that fails.
    fs::path stub() const {
        const fs::path program = folder.path() / "a stub's program";
        write_file_atomically(program, fmt::format(R"sh(#!/bin/sh
printf '%s\n' "$@" > "$1/begun $(echo "$3" | tr / -) $SLURM_RESTART_COUNT"
echo "share $3"
while [ ! -e '{}' ]; do sleep 0.05; done
printf '%s\n' "$@" > "$1/ended $(echo "$3" | tr / -)"
[ "$3" != 3/12 ]
)sh",
                                                   go.string()));
        fs::permissions(program, fs::perms::owner_all);
        return program;
    }

    /// A program that writes a list of what has ended when it begins.
    fs::path gatherer() const {
        const fs::path program = folder.path() / "gather";
        write_file_atomically(program,
                              "#!/bin/sh\ncd \"$1\" && ls | grep -c '^ended' > results.new; "
                              "mv results.new results\n");
        fs::permissions(program, fs::perms::owner_all);
        return program;
    }

    void let_go() const { write_file_atomically(go, ""); }

    ArrayJob job_of(std::size_t tasks) const {
        return {.name = "runcert day 'one'",
                .tasks = tasks,
                .runs = tasks,
                .command = {stub().string(), out.string()},
                .gatherer = {gatherer().string(), out.string()},
                .folder = out / ".runcert" / "slurm"};
    }

    static JobState state_of(const SlurmJobs& jobs) {
        return job_state(jobs.array, jobs.cluster, jobs.tasks);
    }
    static bool is_over(const SlurmJobs& jobs) {
        return state_of(jobs).is_over() && job_state(jobs.gatherer, jobs.cluster, 1).is_over();
    }
    bool ended(std::size_t task, std::size_t tasks) const {
        return fs::exists(out / fmt::format("ended {}-{}", task, tasks));
    }

    TemporaryFolder folder;
    fs::path out = folder.path() / "the \"day's\" $HOME 50%j `runs`\nü";
    fs::path go = folder.path() / "go";
    SlurmCluster cluster{"MaxArraySize=13"};
};

TEST_F(SlurmEngine, RunsEveryShareThenMakesTheResults) {
    slurm_ready();
    const SlurmJobs jobs = submit(job_of(12));
    ASSERT_TRUE(holds_within(240, [&] { return state_of(jobs).running >= 6; }));
    const JobState running = state_of(jobs);
    EXPECT_EQ(running.running, 6U) << "three nodes of two processors";
    EXPECT_EQ(running.pending, 6U);
    EXPECT_EQ(job_state(jobs.gatherer, "", 1).reasons,
              (std::map<std::string, std::size_t>{{"Dependency", 1}}));
    let_go();
    ASSERT_TRUE(holds_within(240, [&] { return is_over(jobs); }));
    for (std::size_t task = 0; task < 12; ++task) {
        EXPECT_TRUE(ended(task, 12)) << task;
        const std::string begun = read_file(out / fmt::format("begun {}-12 ", task));
        EXPECT_EQ(begun, fmt::format("{}\n--share\n{}/12\n", out.string(), task));
        const std::string log = fmt::format("{}_{}.txt", jobs.array, task);
        EXPECT_EQ(read_file(out / ".runcert" / "slurm" / log), fmt::format("share {}/12\n", task));
    }
    EXPECT_EQ(read_file(out / "results"), "12\n") << "though a task ended with exit status 1";
    EXPECT_EQ(state_of(jobs).over, 12U);
}

TEST_F(SlurmEngine, TasksOfAFailedNodeAreBegunAgain) {
    const SlurmJobs jobs = submit(job_of(12));
    ASSERT_TRUE(holds_within(240, [&] { return state_of(jobs).running == 6; }));
    cluster.take_down("n2");
    ASSERT_TRUE(holds_within(240, [&] { return state_of(jobs).requeued == 2; }));
    EXPECT_NE(status_text(jobs, state_of(jobs), {.pending = 1}).find("begun again by Slurm"),
              std::string::npos);
    let_go();
    ASSERT_TRUE(holds_within(240, [&] { return is_over(jobs); }));
    std::size_t begun_again = 0;
    for (std::size_t task = 0; task < 12; ++task) {
        EXPECT_TRUE(ended(task, 12)) << task;
        if (fs::exists(out / fmt::format("begun {}-12 1", task))) ++begun_again;
    }
    EXPECT_EQ(begun_again, 2U) << "the two that ran on the node";
    EXPECT_EQ(read_file(out / "results"), "12\n");
    EXPECT_EQ(cluster.count_nodes("down"), 1U);
}

TEST_F(SlurmEngine, ArraysAreAsLongAsTheClusterLets) {
    const ArrayLimits limits = array_limits();
    EXPECT_EQ(limits.max_array_size, 13);
    EXPECT_EQ(tasks_for(12, limits), 12U);
    const std::size_t tasks = tasks_for(40, limits);
    EXPECT_EQ(tasks, 13U);
    ArrayJob job = job_of(tasks);
    job.at_once = 1;
    const SlurmJobs jobs = submit(job);
    ASSERT_TRUE(holds_within(240, [&] { return state_of(jobs).running == 1; }));
    EXPECT_FALSE(holds_within(3, [&] { return state_of(jobs).running > 1; }))
        << "six processors are free";
    let_go();
    try {
        submit(job_of(tasks + 1));
        ADD_FAILURE() << "an array beyond MaxArraySize was accepted";
    } catch (const Failure& failure) {
        EXPECT_NE(failure.problem().find("Invalid job array specification"), std::string::npos)
            << failure.problem();
    }
}

TEST_F(SlurmEngine, WhatSlurmRefusesIsAFailureInItsWords) {
    ArrayJob job = job_of(3);
    job.slurm_args = {"--partition=lake"};
    try {
        submit(job);
        ADD_FAILURE() << "a partition that does not exist was accepted";
    } catch (const Failure& failure) {
        EXPECT_NE(failure.problem().find("invalid partition specified: lake"), std::string::npos)
            << failure.problem();
    }
    EXPECT_EQ(run_process({"squeue", "--noheader"}).output, "");
}

TEST_F(SlurmEngine, TheUsersWordsWin) {
    ArrayJob job = job_of(3);
    job.memory = "100M";
    job.slurm_args = {"--hold", "--mem=200M", "--comment=day 'one'"};
    const SlurmJobs jobs = submit(job);
    const std::string shown = run_process({"scontrol", "show", "job", jobs.array}).output;
    EXPECT_NE(shown.find("MinMemoryNode=200M"), std::string::npos) << shown;
    EXPECT_NE(shown.find("Comment=day 'one'"), std::string::npos) << shown;
    EXPECT_NE(shown.find("Requeue=1"), std::string::npos) << shown;
    const JobState state = state_of(jobs);
    EXPECT_EQ(state.held, 3U);
    EXPECT_EQ(state.pending, 3U);
    EXPECT_NE(status_text(jobs, state, {.pending = 1}).find("scontrol release " + jobs.array),
              std::string::npos);
    run_process({"scancel", jobs.array, jobs.gatherer});
    EXPECT_TRUE(holds_within(240, [&] { return is_over(jobs); }));
}

TEST_F(SlurmEngine, AJobThatWasNeverThereIsOver) {
    EXPECT_TRUE(job_state("4711", "", 40).is_over());
    EXPECT_EQ(job_state("4711", "", 40).over, 40U);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

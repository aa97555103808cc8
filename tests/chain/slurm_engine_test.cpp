// The engine's dealings with a real Slurm of three nodes; stubs stand for what the tasks run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "core/failure.h"
#include "days/slurm.h"
#include "slurm_support.h"
#include "store/atomic_file.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

std::string problem_of(const ArrayJob& job) {
    try {
        run_array(job);
    } catch (const Failure& failure) {
        return failure.problem();
    }
    return "the array was accepted";
}

/// A cluster, and a folder whose name holds what shells, Slurm and terminals take for their own.
class SlurmEngine : public testing::Test {
  protected:
    void SetUp() override {
        if (!cluster.why_not().empty()) GTEST_SKIP() << cluster.why_not();
        make_directory(out);
    }
    /// So that nothing waits for tasks that wait themselves.
    void TearDown() override { let_go(); }

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

    void let_go() const { write_file_atomically(go, ""); }

    ArrayJob job_of(std::size_t tasks) const {
        return {.name = "runcert-day-one",
                .tasks = tasks,
                .command = {stub().string(), out.string()},
                .folder = out / ".runcert" / "slurm"};
    }
    std::future<void> started(std::size_t tasks) const {
        return std::async(std::launch::async, [job = job_of(tasks)] { run_array(job); });
    }

    bool has(const std::string& what, std::size_t task, const std::string& more = "") const {
        return fs::exists(out / fmt::format("{} {}-12{}", what, task, more));
    }
    std::size_t count(const std::string& what, const std::string& more = "") const {
        std::size_t found = 0;
        for (std::size_t task = 0; task < 12; ++task)
            found += has(what, task, more) ? 1 : 0;
        return found;
    }

    TemporaryFolder folder;
    fs::path out = folder.path() / "the \"day's\" $HOME 50%j `runs`\nü";
    fs::path go = folder.path() / "go";
    SlurmCluster cluster{"MaxArraySize=13"};
};

TEST_F(SlurmEngine, RunsEveryShareAndWaitsForAll) {
    EXPECT_EQ(most_tasks(), 13U);
    EXPECT_EQ(job_at_work("runcert-day-one"), "");
    std::future<void> array = started(12);
    ASSERT_TRUE(holds_within(240, [&] { return count("begun", " ") == 6; }));
    const std::string id = job_at_work("runcert-day-one");
    EXPECT_NE(id, "");
    EXPECT_EQ(job_at_work("runcert-day"), "") << "another day's";
    EXPECT_FALSE(holds_within(2, [&] { return count("begun", " ") > 6; }))
        << "three nodes of two processors";
    let_go();
    array.get();  // though a task ended with exit status 1
    for (std::size_t task = 0; task < 12; ++task) {
        EXPECT_TRUE(has("ended", task)) << task;
        const std::string begun = read_file(out / fmt::format("begun {}-12 ", task));
        EXPECT_EQ(begun, fmt::format("{}\n--share\n{}/12\n", out.string(), task));
        const std::string log = fmt::format("{}_{}.txt", id, task);
        EXPECT_EQ(read_file(out / ".runcert" / "slurm" / log), fmt::format("share {}/12\n", task));
    }
    EXPECT_TRUE(holds_within(60, [] { return job_at_work("runcert-day-one").empty(); }));
}

TEST_F(SlurmEngine, TasksOfAFailedNodeAreBegunAgain) {
    std::future<void> array = started(12);
    ASSERT_TRUE(holds_within(240, [&] { return count("begun", " ") == 6; }));
    cluster.take_down("n2");
    // What has ended of the array is not all of it: the two wait to be begun again.
    EXPECT_EQ(array.wait_for(std::chrono::seconds(4)), std::future_status::timeout);
    let_go();
    array.get();
    EXPECT_EQ(count("ended"), 12U);
    EXPECT_EQ(count("begun", " 1"), 2U) << "the two that ran on the node";
    EXPECT_EQ(cluster.count_nodes("down"), 1U);
}

TEST_F(SlurmEngine, WhatSlurmRefusesIsAFailureInItsWords) {
    ArrayJob job = job_of(3);
    job.slurm_args = {"--partition=lake"};
    const std::string partition = problem_of(job);
    EXPECT_NE(partition.find("invalid partition specified: lake"), std::string::npos) << partition;
    const std::string size = problem_of(job_of(most_tasks() + 1));
    EXPECT_NE(size.find("Invalid job array specification"), std::string::npos) << size;
    EXPECT_EQ(run_process({"squeue", "--noheader"}).output, "");
}

TEST_F(SlurmEngine, TheUsersWordsWin) {
    ArrayJob job = job_of(3);
    job.slurm_args = {"--hold", "--mem=200M", "--comment=day 'one'", "--cpus-per-task=2"};
    std::future<void> array = std::async(std::launch::async, [&] { run_array(job); });
    std::string id;
    ASSERT_TRUE(holds_within(240, [&] { return !(id = job_at_work(job.name)).empty(); }));
    const std::string shown = run_process({"scontrol", "show", "job", id}).output;
    for (const char* words :
         {"MinMemoryNode=200M", "Comment=day 'one'", "Requeue=1", "CPUs/Task=2", "JobHeldUser"})
        EXPECT_NE(shown.find(words), std::string::npos) << words << " in\n" << shown;
    run_process({"scancel", id});
    array.get();
    EXPECT_EQ(job_at_work(job.name), "");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

// The engine's dealings with Slurm where its programs are missing, silent or strange: small scripts
// stand for them. With the real ones: tests/chain/slurm_engine_test.cpp.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "make/slurm.h"
#include "store/atomic_file.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::failure_of;

using Words = std::vector<std::string>;

/// A folder of programs, alone in PATH where it is to be.
class SlurmPrograms : public testing::Test {
  protected:
    SlurmPrograms() {
        for (const char* program : {"sbatch", "squeue", "scontrol", "scancel"})
            stand_in(program, "echo slurm-wlm 22.05.8");
        setenv("PATH", (folder.path().string() + ":" + path).c_str(), 1);
    }
    ~SlurmPrograms() override { setenv("PATH", path.c_str(), 1); }

    /// Makes a program that notes its arguments, one a line, in PROGRAM.calls, and does as told.
    void stand_in(const std::string& program, const std::string& script) const {
        const fs::path file = folder.path() / program;
        const std::string calls = (folder.path() / (program + ".calls")).string();
        write_file_atomically(
            file, "#!/bin/sh\nprintf '%s\\n' \"$@\" >> '" + calls + "'\n" + script + "\n");
        fs::permissions(file, fs::perms::owner_all);
    }
    std::string calls_of(const std::string& program) const {
        return read_file(folder.path() / (program + ".calls"));
    }

    ArrayJob job() const {
        return {.name = "day",
                .tasks = 40,
                .runs = 200,
                .command = {"/opt/run cert", "batch", "/day's"},
                .gatherer = {"/opt/run cert", "batch", "/day's", "--gather"},
                .folder = folder.path() / "100% out"};
    }

    TemporaryFolder folder;
    std::string path = std::getenv("PATH");
};

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST_F(SlurmPrograms, SayWhatToInstallWhereTheyAreMissing) {
    slurm_ready();
    for (const char* program : {"sbatch", "squeue", "scontrol", "scancel"}) {
        TemporaryFolder elsewhere;
        setenv("PATH", elsewhere.path().c_str(), 1);
        for (const char* other : {"sbatch", "squeue", "scontrol", "scancel"})
            if (std::string(other) != program)
                fs::create_symlink("/bin/true", elsewhere.path() / other);
        const auto said = failure_of(slurm_ready);
        EXPECT_TRUE(said.problem.starts_with(program)) << said.problem;
        EXPECT_TRUE(holds(said.problem, "No such file or directory")) << said.problem;
        EXPECT_TRUE(holds(said.remedy, "Install slurm-client (Debian)")) << said.remedy;
    }
}

TEST_F(SlurmPrograms, AControllerThatDoesNotAnswerIsAFailureInItsWords) {
    // As Slurm 22.05 writes them.
    stand_in("scontrol",
             "[ \"$1\" = --version ] && exit 0\n"
             "echo 'Slurmctld(primary) at vm is DOWN'\nexit 1");
    EXPECT_EQ(failure_of(slurm_ready).problem, "Slurmctld(primary) at vm is DOWN");
    const std::string words = "Unable to contact slurm controller (connect failure)";
    stand_in("scontrol", "echo 'slurm_load_ctl_conf error: " + words + "' >&2; exit 1");
    EXPECT_TRUE(holds(failure_of(array_limits).problem, words));
    stand_in("squeue", "echo 'slurm_load_jobs error: " + words + "' >&2; exit 1");
    EXPECT_TRUE(holds(failure_of([] { job_state("12", "", 40); }).problem, words));
}

TEST_F(SlurmPrograms, AreCalledWithTheUsersWordsBeforeWhatMustHold) {
    stand_in("sbatch", "case \"$*\" in *afterany*) echo 13;; *) echo 12;; esac");
    ArrayJob day = job();
    day.at_once = 6;
    day.memory = "2G";
    day.slurm_args = {"--partition=lake", "--mem=4G"};
    const SlurmJobs jobs = submit(day);
    EXPECT_EQ(jobs.array, "12");
    EXPECT_EQ(jobs.gatherer, "13");
    EXPECT_EQ(jobs.tasks, 40U);
    EXPECT_EQ(jobs.runs, 200U);
    const std::string out = folder.path().string() + "/100% out";
    const std::string pattern = folder.path().string() + "/100%% out";
    const std::string first =
        "--parsable\n--job-name=day\n--chdir=" + out + "\n--output=" + pattern;
    const std::string then =
        "\n--open-mode=append\n--requeue\n--cpus-per-task=1\n--mem=2G\n--partition=lake\n--mem="
        "4G\n";
    EXPECT_EQ(
        calls_of("sbatch"),
        first + "/%A_%a.txt" + then +
            "--array=0-39%6\n--wrap=exec '/opt/run cert' batch '/day'\\''s' --share "
            "\"$SLURM_ARRAY_TASK_ID\"/40\n" +
            first + "/%j.txt" + then +
            "--dependency=afterany:12\n--kill-on-invalid-dep=yes\n--wrap=exec '/opt/run cert' "
            "batch '/day'\\''s' --gather\n");
}

TEST_F(SlurmPrograms, TheArrayIsTakenBackWhereTheGathererIsRefused) {
    stand_in("sbatch",
             "case \"$*\" in\n*afterany*) echo 'sbatch: error: AssocMaxSubmitJobLimit' >&2; "
             "exit 1;;\n*) echo '12;lake';; esac");
    stand_in("scancel", "");
    const auto said = failure_of([&] { submit(job()); });
    EXPECT_TRUE(holds(said.problem, "AssocMaxSubmitJobLimit")) << said.problem;
    EXPECT_TRUE(holds(said.problem, "job 12 of the runs was cancelled")) << said.problem;
    EXPECT_EQ(calls_of("scancel"), "--clusters=lake\n12\n");
    stand_in("scancel", "echo 'scancel: error: Access denied' >&2; exit 1");
    const auto worse = failure_of([&] { submit(job()); });
    EXPECT_TRUE(holds(worse.problem, "could not be cancelled: scancel: error: Access denied"))
        << worse.problem;
}

TEST_F(SlurmPrograms, AnAnswerThatIsNoJobIsARefusal) {
    for (const std::string answer : {"", "slurm-wlm 22.05.8", "-1", "12 13", ";lake"}) {
        stand_in("sbatch", "echo '" + answer + "'");
        EXPECT_TRUE(failure_of([&] { submit(job()); }).contains("the job was not accepted"))
            << answer;
    }
}

TEST_F(SlurmPrograms, WhatTheySayDoesNotSteerTheTerminal) {
    stand_in("sbatch", "printf 'sbatch: \\033[31mno\\nreally.\\n' >&2; exit 1");
    const std::string problem = failure_of([&] { submit(job()); }).problem;
    EXPECT_TRUE(problem.ends_with("[31mno; really")) << problem;
    EXPECT_FALSE(holds(problem, "\033"));
}

TEST_F(SlurmPrograms, TasksAreCountedByHowTheyStand) {
    // As Slurm 22.05 writes them, after `scontrol requeue` and `requeuehold` of two tasks.
    stand_in("squeue", R"(cat <<END
CLUSTER: lake
COMPLETING                              1           job requeued in held state
PENDING                                 1           BeginTime
PENDING                                 0           JobArrayTaskLimit
PENDING                                 0           JobArrayTaskLimit
PENDING                                 0           JobHeldUser
PENDING                                 0           ReqNodeNotAvail, UnavailableNodes:n2
RUNNING                                 0           None
COMPLETED                               1           None
FAILED                                  0           NonZeroExitCode
END)");
    const JobState state = job_state("12", "lake", 12);
    EXPECT_EQ(state.pending, 6U);
    EXPECT_EQ(state.running, 1U);
    EXPECT_EQ(state.over, 5U);
    EXPECT_EQ(state.held, 2U);
    EXPECT_EQ(state.requeued, 2U);
    EXPECT_EQ(state.reasons.at("JobArrayTaskLimit"), 2U);
    EXPECT_EQ(state.reasons.at("ReqNodeNotAvail, UnavailableNodes:n2"), 1U);
    EXPECT_FALSE(state.is_over());
    EXPECT_TRUE(calls_of("squeue").starts_with("--clusters=lake\n"));
}

TEST_F(SlurmPrograms, AFolderThatSlurmCannotWriteToIsRefusedBefore) {
    stand_in("sbatch", "echo 12");
    ArrayJob day = job();
    day.folder = folder.path() / "back\\slash";
    EXPECT_TRUE(failure_of([&] { submit(day); }).contains("backslash"));
    EXPECT_FALSE(fs::exists(folder.path() / "sbatch.calls"));
}

// `scontrol show config` of Slurm 22.05, cut.
constexpr std::string_view configuration = R"(Configuration data as of 2026-03-14T00:25:55
KillWait                = 30 sec
MaxArraySize            = 1001
MaxJobCount             = 10000
MaxJobId                = 67043328
SchedulerParameters     = bf_interval=30,max_array_tasks=64,sched_interval=60
)";

TEST(SlurmLimits, AreReadFromTheConfiguration) {
    const ArrayLimits limits = read_array_limits(configuration);
    EXPECT_EQ(limits.max_array_size, 1001);
    EXPECT_EQ(limits.max_job_count, 10000);
    EXPECT_EQ(limits.max_array_tasks, 64);
    EXPECT_EQ(read_array_limits("MaxArraySize = 5\nMaxJobCount = 8\nSchedulerParameters = (null)\n")
                  .max_array_tasks,
              std::nullopt);
    EXPECT_TRUE(failure_of([] {
                    read_array_limits("MaxArraySizes = 5\nMaxJobCount = 8\n");
                }).contains("MaxArraySize"));
    EXPECT_TRUE(failure_of([] {
                    read_array_limits("MaxArraySize = many\nMaxJobCount = 8\n");
                }).contains("MaxArraySize"));
}

TEST(SlurmLimits, BoundTheTasks) {
    const ArrayLimits limits{.max_array_size = 1001, .max_job_count = 10000};
    EXPECT_EQ(tasks_for(1, limits), 1U);
    EXPECT_EQ(tasks_for(1001, limits), 1001U);
    EXPECT_EQ(tasks_for(2000, limits), 1001U);
    EXPECT_EQ(tasks_for(2000, {.max_array_size = 1001, .max_job_count = 100}), 50U);
    EXPECT_EQ(tasks_for(2000, read_array_limits(configuration)), 64U);
    EXPECT_TRUE(failure_of([] {
                    tasks_for(3, {.max_array_size = 0, .max_job_count = 100});
                }).contains("no job arrays"));
}

TEST(SlurmCommand, IsAbsolute) {
    const Words words = batch_command({"lake day", "/days/b"}, "out");
    const fs::path here = fs::current_path();
    EXPECT_EQ(words,
              (Words{fs::read_symlink("/proc/self/exe").string(), "batch",
                     (here / "lake day").string(), "/days/b", "--out", (here / "out").string()}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

// What is said to Slurm, and where its programs are missing, silent or strange: small scripts stand
// for them. With the real ones: tests/chain/slurm_engine_test.cpp.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "days/slurm.h"
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
        for (const char* program : {"sbatch", "squeue"})
            stand_in(program, "echo slurm-wlm 22.05.8");
        stand_in("scontrol", "echo 'MaxArraySize = 9'; echo 'MaxJobCount = 100'");
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
                .command = {"/opt/run cert", "batch", "/day's"},
                .folder = folder.path() / "100% out"};
    }

    TemporaryFolder folder;
    std::string path = std::getenv("PATH");
};

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::size_t most_at_hand() {
    return most_tasks();
}

TEST_F(SlurmPrograms, SayWhatToInstallWhereTheyAreMissing) {
    EXPECT_EQ(most_tasks(), 9U);
    for (const char* program : {"sbatch", "squeue", "scontrol"}) {
        TemporaryFolder elsewhere;
        setenv("PATH", elsewhere.path().c_str(), 1);
        for (const char* other : {"sbatch", "squeue", "scontrol"})
            if (std::string(other) != program)
                fs::create_symlink("/bin/true", elsewhere.path() / other);
        const auto said = failure_of(most_at_hand);
        EXPECT_TRUE(said.problem.starts_with(program)) << said.problem;
        EXPECT_TRUE(holds(said.problem, "No such file or directory")) << said.problem;
        EXPECT_TRUE(holds(said.remedy, "Install slurm-client (Debian)")) << said.remedy;
    }
}

TEST_F(SlurmPrograms, AControllerThatDoesNotAnswerIsAFailureInItsWords) {
    // As Slurm 22.05 writes it.
    const std::string words = "Unable to contact slurm controller (connect failure)";
    stand_in("scontrol",
             "[ \"$1\" != show ] && exit 0\n"
             "echo 'slurm_load_ctl_conf error: " +
                 words + "' >&2; exit 1");
    EXPECT_TRUE(holds(failure_of(most_at_hand).problem, words));
    stand_in("squeue", "echo 'slurm_load_jobs error: " + words + "' >&2; exit 1");
    EXPECT_TRUE(holds(failure_of([] { job_at_work("day"); }).problem, words));
}

TEST_F(SlurmPrograms, AreCalledWithTheUsersWordsBeforeWhatMustHold) {
    stand_in("sbatch", "echo '12;lake'; exit 3");  // the status of the tasks
    ArrayJob day = job();
    day.slurm_args = {"--partition=lake", "--mem=4G"};
    run_array(day);
    const std::string out = folder.path().string() + "/100% out";
    const std::string pattern = folder.path().string() + "/100%% out";
    EXPECT_EQ(calls_of("sbatch"),
              "--parsable\n--job-name=day\n--chdir=" + out + "\n--output=" + pattern +
                  "/%A_%a.txt\n--open-mode=append\n--requeue\n--cpus-per-task=1\n"
                  "--partition=lake\n--mem=4G\n--wait\n--array=0-39\n"
                  "--wrap=exec '/opt/run cert' batch '/day'\\''s' --share "
                  "\"$SLURM_ARRAY_TASK_ID\"/40\n");
    EXPECT_TRUE(fs::is_directory(out));
}

TEST_F(SlurmPrograms, AnAnswerThatIsNoJobIsARefusal) {
    for (const std::string answer : {"", "slurm-wlm 22.05.8", "-1", "12 13", ";lake"}) {
        stand_in("sbatch", "echo '" + answer + "'");
        EXPECT_TRUE(failure_of([&] { run_array(job()); }).contains("the job was not accepted"))
            << answer;
    }
}

TEST_F(SlurmPrograms, WhatTheySayDoesNotSteerTheTerminal) {
    stand_in("sbatch", "printf 'sbatch: \\033[31mno\\nreally.\\n' >&2; exit 1");
    const std::string problem = failure_of([&] { run_array(job()); }).problem;
    EXPECT_TRUE(problem.ends_with("[31mno; really")) << problem;
    EXPECT_FALSE(holds(problem, "\033"));
}

TEST_F(SlurmPrograms, FindTheUsersJobByItsName) {
    stand_in("squeue", "printf 'CLUSTER: lake\\n12\\n12\\n'");
    EXPECT_EQ(job_at_work("day"), "12");
    EXPECT_EQ(calls_of("squeue"), "--me\n--noheader\n--format=%F\n--name=day\n");
    stand_in("squeue", "echo 'CLUSTER: lake'");
    EXPECT_EQ(job_at_work("day"), "");
}

TEST_F(SlurmPrograms, AFolderThatSlurmCannotWriteToIsRefusedBefore) {
    stand_in("sbatch", "echo 12");
    ArrayJob day = job();
    day.folder = folder.path() / "back\\slash";
    EXPECT_TRUE(failure_of([&] { run_array(day); }).contains("backslash"));
    EXPECT_FALSE(fs::exists(folder.path() / "sbatch.calls"));
}

// `scontrol show config` of Slurm 22.05, cut.
constexpr const char* configuration = R"(Configuration data as of 2026-03-14T00:25:55
KillWait                = 30 sec
MaxArraySize            = 1001
MaxJobCount             = 10000
MaxJobId                = 67043328
SchedulerParameters     = bf_interval=30,max_array_tasks=64,sched_interval=60
)";

TEST(SlurmLimits, AreReadFromTheConfiguration) {
    EXPECT_EQ(most_tasks(configuration), 64U);
    const std::string others = "\nSchedulerParameters = (null)\n";
    EXPECT_EQ(most_tasks("MaxArraySize = 1001\nMaxJobCount = 10000" + others), 1001U);
    EXPECT_EQ(most_tasks("MaxArraySize = 1001\nMaxJobCount = 100" + others), 50U);
    EXPECT_EQ(most_tasks("MaxArraySize=13\nMaxJobCount=100\nSchedulerParameters=max_array_tasks=7"),
              7U);
    for (const char* wrong :
         {"MaxArraySizes = 5\nMaxJobCount = 8\n", "MaxArraySize = many\nMaxJobCount = 8\n"})
        EXPECT_TRUE(failure_of([&] { most_tasks(wrong); }).contains("states no MaxArraySize"));
    for (const char* none :
         {"MaxArraySize = 0\nMaxJobCount = 8\n", "MaxArraySize = 8\nMaxJobCount = 1\n"})
        EXPECT_TRUE(failure_of([&] { most_tasks(none); }).contains("no job arrays"));
}

TEST(SlurmLimits, BoundTheTasks) {
    EXPECT_EQ(tasks_for(1, 1001), 1U);
    EXPECT_EQ(tasks_for(200, 1001), 200U);
    EXPECT_EQ(tasks_for(2000, 1001), 200U);
    EXPECT_EQ(tasks_for(20'001, 1001), 401U);
    EXPECT_EQ(tasks_for(1'000'000, 1001), 1001U);
    EXPECT_EQ(tasks_for(40, 13), 13U);
}

TEST(SlurmArgs, AreSplitAsAShellDoes) {
    setenv("LAKE", "salt", 1);
    EXPECT_EQ(
        split_slurm_args(R"( --partition=lake  --comment 'day  "1"' --account=a\ b -p "$LAKE")"),
        (Words{"--partition=lake", "--comment", "day  \"1\"", "--account=a b", "-p", "salt"}));
    EXPECT_EQ(split_slurm_args("  "), Words{});
    EXPECT_EQ(split_slurm_args("--nodelist=n[1-3] --comment=''"),
              (Words{"--nodelist=n[1-3]", "--comment="}));
}

TEST(SlurmArgs, AreRefusedWhereTheyWouldRunACommandOrDoNotEnd) {
    TemporaryFolder folder;
    const std::string file = (folder.path() / "made").string();
    for (const std::string& text :
         {"--comment=`touch " + file + "`", "--comment=\"$(touch " + file + ")\"",
          "--comment=$((1+`touch " + file + "`))"})
        EXPECT_TRUE(failure_of([&] { split_slurm_args(text); }).contains("command")) << text;
    EXPECT_FALSE(fs::exists(file));
    EXPECT_TRUE(failure_of([] { split_slurm_args("--comment='day"); }).contains("do not end"));
    EXPECT_TRUE(failure_of([] { split_slurm_args("-p $RUNCERT_NO_SUCH"); }).contains("not set"));
    for (const char* text : {"-p lake; rm x", "-p lake | cat", "-p lake\n--hold", "-p lake > x"})
        EXPECT_TRUE(failure_of([&] { split_slurm_args(text); }).contains("not in quotes")) << text;
    EXPECT_TRUE(
        failure_of([] { split_slurm_args(std::string_view("-p a\0b", 6)); }).contains("byte"));
}

TEST(SlurmArgs, LeaveTheArrayAndTheCommandToTheProgram) {
    for (const std::string word :
         {"--array=0-3", "--array", "-a0-3", "-a", "--wrap=true", "--wait", "-W", "--test-only",
          "--job-name=x", "-Jx", "--clusters=lake", "-M"})
        EXPECT_TRUE(failure_of([&] { split_slurm_args("--hold " + word); }).contains(word)) << word;
    split_slurm_args("--account=a --partition=lake -A sailing --wait-all-nodes=1 --mem=2G");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

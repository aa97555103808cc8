// What the user says to Slurm through the program, and what the program says of Slurm's jobs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "make/slurm.h"
#include "store/atomic_file.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::failure_of;

using Words = std::vector<std::string>;

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
}

TEST(SlurmArgs, LeaveTheArrayAndTheCommandToTheProgram) {
    for (const char* word :
         {"--array=0-3", "--array", "-a0-3", "-a", "--wrap=true", "--wait", "-W", "--test-only"})
        EXPECT_TRUE(failure_of([&] { check_slurm_args({"--hold", word}); }).contains(word)) << word;
    check_slurm_args({"--account=a", "--partition=lake", "-A", "sailing", "--wait-all-nodes=1"});
}

SlurmJobs jobs() {
    return {.array = "12", .gatherer = "13", .cluster = "", .tasks = 40, .runs = 200};
}

TEST(SlurmJobsFile, IsReadAsItWasWritten) {
    TemporaryFolder folder;
    const fs::path file = folder.path() / "job.json";
    EXPECT_EQ(read_slurm_jobs(file), std::nullopt);
    SlurmJobs written = jobs();
    written.cluster = "lake";
    write_slurm_jobs(file, written);
    EXPECT_EQ(read_slurm_jobs(file), written);
}

TEST(SlurmJobsFile, IsToBeRemovedWhereItIsBroken) {
    TemporaryFolder folder;
    const fs::path file = folder.path() / "job.json";
    write_slurm_jobs(file, jobs());
    const std::string whole = read_file(file);
    const std::vector<std::pair<std::string, std::string>> changes{
        {"\"12\"", "\"-p\""}, {"\"12\"", "\"012\""}, {"\"13\"", "13"},      {"40", "-40"},
        {"40", "0"},          {"40", "\"40\""},      {"200", "2.5"},        {"runs", "days"},
        {"jobs/1", "jobs/2"}, {"\"\"", "\"-M\""},    {"\"\"", "\"a\\nb\""}, {"}", ""}};
    for (const auto& [from, to] : changes) {
        std::string text = whole;
        text.replace(text.find(from), from.size(), to);
        write_file_atomically(file, text);
        const auto said = failure_of([&] { read_slurm_jobs(file); });
        EXPECT_TRUE(said.remedy.starts_with("Remove it")) << from << " " << to;
        EXPECT_EQ(said.where, file.string());
    }
}

TEST(SlurmWords, SayWhatWasSubmittedAndHowItStands) {
    EXPECT_EQ(submission_text(jobs()),
              "submitted job 12, 40 tasks for 200 runs; results by job 13\n"
              "  `runcert batch ... --status` says how they stand; `scancel 12 13` ends them\n");
    const JobState array{.pending = 12,
                         .running = 6,
                         .over = 22,
                         .held = 1,
                         .requeued = 2,
                         .reasons = {{"BeginTime", 2}, {"JobHeldAdmin", 1}, {"Resources", 9}}};
    EXPECT_EQ(
        status_text(jobs(), array, {.pending = 1, .reasons = {{"Dependency", 1}}}),
        "job 12, 40 tasks for 200 runs: 12 waiting (2 BeginTime, 1 JobHeldAdmin, 9 Resources), "
        "6 running and\n    22 ended\n"
        "  2 tasks of job 12 put back and begun again by Slurm: a node failed, or was needed "
        "elsewhere\n"
        "  1 task of job 12 held until released: scontrol release 12\n"
        "job 13, results: waits for the runs\n");
    EXPECT_EQ(status_text(jobs(), {.over = 40}, {.pending = 1, .reasons = {{"Resources", 1}}}),
              "job 12, 40 tasks for 200 runs: 40 ended\n"
              "job 13, results: 1 waiting (1 Resources)\n");
    EXPECT_EQ(status_text(jobs(), {.over = 40}, {.over = 1}),
              "job 12, 40 tasks for 200 runs: 40 ended\njob 13, results: ended\n");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

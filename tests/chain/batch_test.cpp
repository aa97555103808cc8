// A day certified again: a step runs again where its program, its settings or its inputs changed,
// or what it wrote is not as it wrote it, and only there.
#include <fmt/format.h>
#include <sys/stat.h>

#include "batch_support.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr const char* all_steps = "claim import enu screen smooth window check report";

/// Time of change and identity of each file, but for locks, which say who had them last.
std::map<std::string, std::string> stamps(const fs::path& folder) {
    std::map<std::string, std::string> stamps;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        struct stat status {};
        const std::string name = fs::relative(entry.path(), folder).string();
        if (!entry.is_regular_file() || name.ends_with(".lock")) continue;
        EXPECT_EQ(::stat(entry.path().c_str(), &status), 0);
        stamps[name] =
            fmt::format("{} {}.{}", status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
    }
    return stamps;
}

/// Changes a byte in the middle of a file, in place, and gives it back its time stamp.
void edit_unseen(const fs::path& file) {
    const auto time = fs::last_write_time(file);
    std::string bytes = read_file(file);
    char& byte = bytes[bytes.size() / 2];
    byte = byte == '1' ? '2' : '1';
    std::ofstream(file, std::ios::binary) << bytes;
    fs::last_write_time(file, time);
}

/// The step that writes a file of a run folder.
std::string writer_of(const std::string& name) {
    for (const auto& [start, step] :
         std::vector<std::pair<std::string, std::string>>{{"attempt", "claim"},
                                                          {"profile", "claim"},
                                                          {"recording", "import"},
                                                          {"1-", "import"},
                                                          {"2-", "enu"},
                                                          {"3-", "screen"},
                                                          {"4-", "smooth"},
                                                          {"5-", "window"},
                                                          {"6-", "check"},
                                                          {"report.json", "report"}})
        if (name.starts_with(start)) return step;
    return "no step";
}

TEST_F(Batches, WhereNothingChangedNothingRunsAndNoFileIsTouched) {
    const auto before = stamps(out());
    const BatchSaid said = again();
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_run, 0) << said.text;
    EXPECT_EQ(stamps(out()), before);
}

TEST_F(Batches, TimeStampsMeanNothing) {
    for (const fs::path& folder : {day(), out()})
        for (const auto& entry : fs::recursive_directory_iterator(folder))
            if (entry.is_regular_file())
                fs::last_write_time(entry.path(), fs::file_time_type::clock::now());
    const auto before = stamps(out());
    EXPECT_EQ(again().steps_run, 0);
    EXPECT_EQ(stamps(out()), before);
}

TEST_F(Batches, AFileThatWasEditedWithItsTimeRestoredIsMadeAgainAlone) {
    for (const auto& [name, bytes] : first_made("two")) {
        edit_unseen(out() / "two" / name);
        const BatchSaid said = again();
        EXPECT_EQ(said.exit_status, 0) << said.errors;
        EXPECT_EQ(made("two"), first_made("two")) << name;
        if (name == "report.json") {  // by which a run is known
            EXPECT_EQ(said.steps_of("two"), all_steps);
            continue;
        }
        ASSERT_EQ(said.steps_of("two"), writer_of(name)) << name;
        EXPECT_EQ(said.ran.at("two").begin()->second, name + " is not as it was written");
        EXPECT_EQ(said.steps_run, 1) << name;
        EXPECT_EQ(made("two"), first_made("two")) << name;
    }
}

TEST_F(Batches, AFileThatWasRemovedIsMadeAgainAlone) {
    for (const std::string name : {"recording.spare.pos", "4-trajectory.ecsv"}) {
        fs::remove(out() / "two" / name);
        const BatchSaid said = again();
        ASSERT_EQ(said.steps_of("two"), writer_of(name)) << name;
        EXPECT_EQ(said.ran.at("two").begin()->second, name + " is missing");
        EXPECT_EQ(made("two"), first_made("two")) << name;
    }
    fs::remove_all(out() / "two");
    EXPECT_EQ(again().steps_of("two"), all_steps);
    EXPECT_EQ(made("two"), first_made("two"));
}

// What is remembered of a run is a cache: damaged, lost or another run's, it changes no file.
TEST_F(Batches, ARecordThatIsDamagedChangesNothing) {
    const auto of = [this](const char* id) {
        return "run " + digest_file(out() / id / "report.json").sha256;
    };
    const std::string whole = recalled(of("one"));
    const auto damage = [&](const std::string& from, const std::string& to) {
        std::string text = whole;
        return text.replace(text.find(from), from.size(), to);
    };
    const std::vector<std::string> damaged{
        "{}", whole.substr(0, whole.size() / 2), std::string(4 << 20, '['), "",
        // A file that a step is said not to write, and a step of other settings.
        damage("\"3-screened.ecsv\": ", "\"3-screened.ecsw\": "),
        damage("selection_samples\": 100", "selection_samples\": 101"), recalled(of("two"))};
    for (const std::string& text : damaged) {
        remember(of("one"), text);
        const BatchSaid said = again();
        EXPECT_EQ(said.exit_status, 0) << said.errors;
        EXPECT_FALSE(said.steps_of("one").empty()) << text.substr(0, 40);
        EXPECT_EQ(said.steps_of("two"), "");
        EXPECT_EQ(made("one"), first_made("one"));
    }
    EXPECT_EQ(again().steps_run, 0);
}

// A day's folder is moved, or brought to another computer of the same user.
TEST_F(Batches, WhatWasMadeIsKnownWhereverItIs) {
    fs::rename(out(), path("elsewhere"));
    EXPECT_EQ(batch_json(day(), path("elsewhere"), {"--no-render"}).steps_run, 0);
}

struct DayChange {
    const char* file;
    const char* from;
    const char* to;
    const char* one;  ///< the steps of the attempt "one" that run again
    const char* two;
    const char* reason;  ///< of the first of them, or a part of it
};

TEST_F(Batches, AChangeRunsTheStepsThatDependOnIt) {
    const std::vector<DayChange> changes{
        {"day/own.yaml", "value: 1,", "value: 1.1,", "claim check report", "claim check report",
         "input changed: profile.own.yaml"},
        {"day/own.yaml", "duration_s: 3", "duration_s: 2.8", "claim window check report",
         "claim window check report", "input changed: profile.own.yaml"},
        {"day/day.yaml", "figure: margin.value, value: 2}", "figure: margin.value, value: 3}",
         "claim check report", "", "input changed: attempt.yaml"},
        {"day/day.yaml", "window.duration_s, value: 2.5", "window.duration_s, value: 2.6",
         "claim window check report", "", "input changed: attempt.yaml"},
        {"day/day.yaml", "robust_scale: 2.0", "robust_scale: 2.5",
         "claim smooth window check report", "", "input changed: attempt.yaml"},
        {"day/day.yaml", "gap_factor: 1.5", "gap_factor: 1.6",
         "claim screen smooth window check report", "", "input changed: attempt.yaml"},
        // The same figure, which is printed as it is written.
        {"day/two.yaml", "parameters: {", "parameters: {screen: {gap_factor: 2}, ", "",
         "claim screen smooth window check report", "input changed: attempt.yaml"},
        {"day/two.yaml", "gap_factor: 2}", "gap_factor: 2.0}", "",
         "claim screen smooth window check report", "input changed: attempt.yaml"},
        {"day/day.yaml", "id: test-day", "id: another-day", "", "", ""},
        {"day/two.yaml", "id: two", "id: two # of two", "", "claim check report",
         "input changed: attempt.yaml"},
        {"day/recordings/0003.pos", "136.0", "136.1", "",
         "import enu screen smooth window check report", "input changed: recording.spare.pos"},
    };
    for (const DayChange& change : changes) {
        edit(path(change.file), change.from, change.to);
        const BatchSaid said = again();
        EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
        EXPECT_EQ(said.steps_of("one"), change.one) << change.to;
        EXPECT_EQ(said.steps_of("two"), change.two) << change.to;
        for (const auto& [id, steps] : said.ran)
            EXPECT_EQ(steps.contains("claim") ? steps.at("claim") : steps.at("import"),
                      change.reason);
        EXPECT_EQ(again().steps_run, 0) << change.to;
    }
    // And all these changes one after the other end where one batch of the last day begins.
    const BatchSaid fresh = batch_json(day(), path("fresh"), {"--no-render"});
    EXPECT_EQ(fresh.steps_run, 16);
    for (const char* id : {"one", "two"})
        EXPECT_EQ(made(id), run_contents(path("fresh") / id));
}

TEST_F(Batches, AReplacedProgramRunsAgainForAllRuns) {
    const fs::path programs = path("bin");
    fs::create_directories(programs);
    for (const auto& entry : fs::directory_iterator(RUNCERT_PROGRAMS))
        if (entry.path().filename().string().starts_with("runcert"))
            fs::copy_file(entry.path(), programs / entry.path().filename());
    std::ofstream(programs / "runcert-smooth", std::ios::binary | std::ios::app) << '\n';
    const BatchSaid said =
        batch_json(day(), out(), {"--no-render"}, (programs / "runcert").string());
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    for (const char* id : {"one", "two"}) {
        // It writes the same file, and those who read it need not run.
        ASSERT_EQ(said.steps_of(id), "smooth");
        EXPECT_EQ(said.ran.at(id).at("smooth"), "program changed: runcert-smooth");
        EXPECT_EQ(made(id), first_made(id));
    }
}

TEST_F(Batches, StepsAndAttemptsCanBeChosen) {
    EXPECT_EQ(again({"--no-render", "--from", "window"}).steps_of("one"), "window check report");
    BatchSaid said = again({"--no-render", "--force", "--only", "t*"});
    EXPECT_EQ(said.steps_of("one"), "");
    EXPECT_EQ(said.steps_of("two"), all_steps);
    EXPECT_EQ(said.ran.at("two").at("smooth"), "--force");
    EXPECT_FALSE(said.states.contains("one"));
    EXPECT_EQ(made("two"), first_made("two"));
    // The one that is left out is still among the results.
    EXPECT_NE(read_file(out() / "day.yaml").find("done: 2"), std::string::npos)
        << read_file(out() / "day.yaml");
    said = again({"--no-render", "--only", "one", "--only", "thre?"});
    EXPECT_EQ(said.exit_status, 2);
    EXPECT_NE(said.errors.find("thre?"), std::string::npos) << said.errors;
    said = again({"--from", "claim"});
    EXPECT_EQ(said.exit_status, 2);
}

TEST_F(Batches, AReceiverThatIsTakenOutLeavesTheRunFolder) {
    edit(day() / "two.yaml", "  - {id: spare, recording: recordings/0003.pos}\n", "");
    const BatchSaid said = again();
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_of("two"), all_steps);
    for (const auto& [name, bytes] : made("two"))
        EXPECT_EQ(name.find("spare"), std::string::npos) << name;
    EXPECT_EQ(made("two"), [&] {
        batch_json(day(), path("fresh"), {"--no-render"});
        return run_contents(path("fresh/two"));
    }());
    const ProcessResult verified = runcert({"verify", (out() / "two").string()});
    EXPECT_EQ(verified.output.find("spare"), std::string::npos) << verified.output;
}

TEST_F(Batches, ARunThatCannotBeMadeAgainStandsAsItWas) {
    const std::string before = read_file(day() / "two.yaml");
    const auto made_before = made("two");
    // A recording that is gone, an attempt that cannot be read, one that no rule is given for.
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"recordings/0003.pos", "recordings/gone.pos"},
             {"receivers:", "receivers: {"},
             {"profiles: [own.yaml]", "profiles: [no-such-rule]"}}) {
        edit(day() / "two.yaml", from, to);
        EXPECT_EQ(again().exit_status, 2);
        EXPECT_EQ(made("two"), made_before) << to;
        EXPECT_NE(read_file(out() / "day.html").find("What could not be processed"),
                  std::string::npos);
        const ProcessResult status =
            runcert({"batch", day().string(), "--out", out().string(), "--no-render", "--status"});
        EXPECT_EQ(status.exit_status, 1);
        EXPECT_NE(status.output.find("failed  two"), std::string::npos) << status.output;
        write_file_atomically(day() / "two.yaml", before);
        const BatchSaid said = again();
        EXPECT_EQ(said.exit_status, 0);
        EXPECT_EQ(said.steps_run, 0);
        EXPECT_EQ(made("two"), made_before);
    }
}

// Signed or not: of what takes another run's place the user is told, and it is kept.
TEST_F(Batches, AnotherAttemptOfTheSameIdIsSaidAndTheEarlierKept) {
    const auto report = first_made("one").at("report.json");
    const auto recording = first_made("one").at("recording.primary.pos");
    edit(day() / "day.yaml", "recordings/0001.pos", "recordings/0002.pos");
    const ProcessResult said =
        runcert({"batch", day().string(), "--out", out().string(), "--no-render"});
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    const std::string kept = "superseded/" + sha256_hex(report).substr(0, 16);
    EXPECT_NE(said.output.find("the earlier run is in " + kept), std::string::npos) << said.output;
    EXPECT_EQ(read_file(out() / "one" / kept / "report.json"), report);
    EXPECT_EQ(read_file(out() / "one" / kept / "recording.primary.pos"), recording);
}

TEST_F(Batches, ARunWhoseAttemptIsGoneIsNamed) {
    edit(day() / "day.yaml", "  - {attempt: two.yaml}\n", "");
    EXPECT_EQ(again().exit_status, 0);
    EXPECT_NE(read_file(out() / "day.html")
                  .find("The folder two holds a run that no attempt of this day"),
              std::string::npos);
    fs::create_directory(out() / "three");  // not a batch's
    EXPECT_EQ(again().exit_status, 0);
    EXPECT_EQ(read_file(out() / "day.html").find("The folder three"), std::string::npos);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

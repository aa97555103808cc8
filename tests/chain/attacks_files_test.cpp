// Folders that were handed in, with names in them that programs give: nothing is taken for this
// program's own, and nothing of anybody's is lost. Each test says what came of it before.
#include <array>

#include "signatures_support.h"
#include "store/sha256.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

class AttacksOnFolders : public SignedRuns {
  protected:
    ProcessResult certify_again(bool other = true) const {
        return certify(attempt(other), run(), {"--no-render"});
    }
    void must_certify(bool other = true) const {
        const ProcessResult result = certify_again(other);
        ASSERT_LT(result.exit_status, 2) << result.errors;
    }
    void put(const std::string& name, const std::string& text = "mine") const {
        fs::create_directories((run() / name).parent_path());
        write_file_atomically(run() / name, text);
    }
    /// Refused with these words before anything is measured, and the folder as it was.
    void expect_refused(const std::vector<std::string>& said) const {
        const auto before = contents_of(run());
        const ProcessResult result = certify_again();
        EXPECT_EQ(result.exit_status, 2) << result.output;
        EXPECT_FALSE(holds(result.output, "import ")) << result.output;
        for (const std::string& part : said)
            EXPECT_TRUE(holds(result.errors, part)) << part << "\n" << result.errors;
        EXPECT_EQ(contents_of(run()), before);
    }
    void begin_without_a_run() const {
        fs::remove_all(run());
        fs::create_directory(run());
    }
    /// The one folder among what was superseded.
    fs::path superseded() const {
        fs::path found;
        for (const auto& entry : fs::directory_iterator(run() / "superseded"))
            found = entry.path();
        return found;
    }
    static int minisign(const fs::path& report, const std::string& name) {
        return run_process({"minisign", "-Vm", report.string(), "-p", public_key(name)})
            .exit_status;
    }
};

// Got through: every file of the folder was deleted, or another's run put in this one's place.
TEST_F(AttacksOnFolders, Files01ARunThatLooksReadyIsTheUsersFolder) {
    put("letter.txt");
    const std::string report = read_file(run() / "report.json");
    for (const char* name : {".runcert-ready", ".runcert-4711-0-0123456789abcdef"}) {
        fs::create_directory(run() / name);
        fs::copy(other_run(), run() / name / "run", fs::copy_options::recursive);
        must_certify(false);
        EXPECT_TRUE(read_file(run() / "report.json") == report);
        EXPECT_TRUE(contents_of(run() / name / "run") == contents_of(other_run()));
        EXPECT_TRUE(fs::exists(run() / "letter.txt"));
    }
}

// Got through: nothing was put in place, but the link was deleted by its name.
TEST_F(AttacksOnFolders, Files03WhatLooksReadyAndIsALinkStays) {
    fs::create_directories(path("elsewhere") / "run");
    fs::create_symlink(path("elsewhere"), run() / ".runcert-ready");
    must_certify(true);
    EXPECT_TRUE(fs::is_symlink(run() / ".runcert-ready"));
    EXPECT_TRUE(fs::exists(path("elsewhere") / "run"));
}

// Got through: certify removed all five, by their names.
TEST_F(AttacksOnFolders, Files04NamesLikeThoseOfProgramsAreTheUsers) {
    const std::vector<std::string> names{
        ".runcert-mine.tmp",          ".runcert-notes",
        ".runcert-photos/a.jpg",      ".runcert-done/a",
        ".runcert-4711-0.tmp",        ".runcert-4711-0-0123456789abcdef.tmp",
        "superseded/.runcert-1-1.tmp"};
    for (const std::string& name : names)
        put(name);
    for (const bool other : {true, false}) {
        must_certify(other);
        for (const std::string& name : names)
            EXPECT_TRUE(fs::exists(run() / name)) << name;
    }
}

// Got through: a folder beside the run, of a name that anyone can compute, was removed.
TEST_F(AttacksOnFolders, Files05FoldersBesideTheRunAreTheUsers) {
    const std::string mark = sha256_hex("run").substr(0, 16);
    for (const char* rest : {"photos", "4711-0", "4711-0-0123456789abcdef"}) {
        const fs::path beside = path(fmt::format(".runcert-{}-{}", mark, rest));
        fs::create_directory(beside);
        write_file_atomically(beside / "a.jpg", "a");
        must_certify();
        EXPECT_TRUE(fs::exists(beside / "a.jpg")) << rest;
    }
}

// Got through: they were overwritten.
TEST_F(AttacksOnFolders, Files06ARunsNamesThatNoRunWroteAreRefusedByName) {
    for (const char* name :
         {"1-observations.ecsv", "6-verdict.yaml", "attempt.yaml", "recording.primary.pos",
          "profile.nalsa.yaml", "report.json", "report.html", "certificate.pdf", "report.pdf",
          "run.yaml", "report.json.minisig", "report.json.judge.sig", "1-phase.other.ecsv"}) {
        begin_without_a_run();
        put(name);
        put("letter.txt");
        expect_refused({name, "no report in it names", "another folder"});
    }
    begin_without_a_run();
    fs::create_directory(run() / "report.json");
    expect_refused({"report.json"});
    begin_without_a_run();
    fs::create_symlink("elsewhere", run() / "2-enu.ecsv");
    expect_refused({"2-enu.ecsv"});
    EXPECT_TRUE(fs::is_symlink(run() / "2-enu.ecsv"));
}

// Got through: such a report counted as one that names nothing.
TEST_F(AttacksOnFolders, Files07AReportThatCannotBeReadVouchesForNothing) {
    put("report.json", "{\"subject\": []}");
    expect_refused({"report.json", "4-trajectory.ecsv"});
}

// Held, and must: whoever made the run, it is one.
TEST_F(AttacksOnFolders, Files08ARunOfAnotherUserIsCertifiedAgain) {
    const ProcessResult result = certify(attempt(true), run(), {"--no-render"},
                                         {{"XDG_STATE_HOME", path("another user").string()}});
    EXPECT_LT(result.exit_status, 2) << result.errors;
    expect_nothing_left();
}

// Got through: the changed file was overwritten.
TEST_F(AttacksOnFolders, Files09AFileOfARunThatSomebodyChangedIsKept) {
    put("3-screened.ecsv", "a day's work");
    put("attempt.yaml", "my own notes in it");
    const std::string report = read_file(run() / "report.json");
    must_certify();
    EXPECT_EQ(read_file(superseded() / "3-screened.ecsv"), "a day's work");
    EXPECT_EQ(read_file(superseded() / "attempt.yaml"), "my own notes in it");
    EXPECT_EQ(read_file(superseded() / "report.json"), report);
}

// Got through: a report that names a file of the user's made it one of the run, which is replaced.
TEST_F(AttacksOnFolders, Files10AReportThatNamesTheUsersFileDoesNotMakeItTheRuns) {
    put("diary.txt");
    change("report.json", "\"subject\": [",
           fmt::format("\"subject\": [{{\"name\": \"diary.txt\", \"digest\": {{\"sha256\": "
                       "\"{}\"}}}},",
                       sha256_hex("mine")));
    must_certify();
    EXPECT_EQ(read_file(run() / "diary.txt"), "mine");
}

// Got through: the signature was kept alone, and could never be verified again.
TEST_F(AttacksOnFolders, Files11ASupersededSignatureStillVerifiesByHand) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    const std::string report = read_file(run() / "report.json");
    must_certify();
    EXPECT_EQ(read_file(superseded() / "report.json"), report);
    EXPECT_EQ(minisign(superseded() / "report.json", "measurer"), 0);
    EXPECT_EQ(run_process({"minisign", "-Vm", (superseded() / "report.json").string(), "-x",
                           (superseded() / "report.json.judge.minisig").string(), "-p",
                           public_key("judge")})
                  .exit_status,
              0);
}

// Got through: those of several reports lay together, with nothing that told whose each was.
TEST_F(AttacksOnFolders, Files12EachOfSeveralSupersededReportsHasItsOwnSignature) {
    for (const bool other : {true, false, true}) {
        must_sign("measurer", "measurer");
        must_certify(other);
    }
    int reports = 0;
    for (const auto& entry : fs::directory_iterator(run() / "superseded")) {
        ++reports;
        EXPECT_EQ(minisign(entry.path() / "report.json", "measurer"), 0) << entry.path();
    }
    EXPECT_EQ(reports, 2);  // one was made twice, and signed twice
}

// Got through: a signature that its own key replaced was kept without what it signs.
TEST_F(AttacksOnFolders, Files13ASignatureThatIsMadeAgainLeavesTheEarlierOneWithItsReport) {
    must_sign("measurer", "measurer");
    const std::string first = read_file(run() / "report.json.minisig");
    must_sign("measurer", "measurer");
    EXPECT_EQ(read_file(superseded() / "report.json.minisig"), first);
    EXPECT_EQ(minisign(superseded() / "report.json", "measurer"), 0);
}

// Got through: folders in superseded/ and keys/ were not brought along.
TEST_F(AttacksOnFolders, Files14WhatLiesDeeperInARunsOwnFoldersIsBroughtAlong) {
    put("superseded/2019/letter.txt");
    put("keys/old/a.pub");
    for (const bool other : {true, false}) {
        must_certify(other);
        EXPECT_TRUE(fs::exists(run() / "superseded/2019/letter.txt"));
        EXPECT_TRUE(fs::exists(run() / "keys/old/a.pub"));
    }
}

// Got through: "too many open files", each of the user's was held open to be synced.
TEST_F(AttacksOnFolders, Files15BesideElevenHundredFilesWithFewDescriptors) {
    for (int i = 0; i < 1100; ++i)
        std::ofstream(run() / fmt::format("photo{}.jpg", i)) << i;
    for (const int limit : {1024, 48}) {
        const ProcessResult result = run_process(
            {"sh", "-c",
             fmt::format("ulimit -n {}; '{}/runcert' certify '{}' --out '{}' "
                         "--no-render",
                         limit, RUNCERT_PROGRAMS, attempt(limit == 48).string(), run().string())});
        EXPECT_LT(result.exit_status, 2) << limit << result.errors;
        EXPECT_EQ(read_file(run() / "photo1099.jpg"), "1099");
    }
}

// Got through: they were passed over, whatever was in them.
TEST_F(AttacksOnFolders, Files16WhatAKilledProgramLeftIsRefusedByNameWhenVerified) {
    must_sign("measurer", "measurer");
    for (const char* name : {".runcert-ready/run/a", ".runcert-1-2.tmp", ".runcert-notes",
                             ".runcert-0123456789abcdef-1-0/run/report.json"}) {
        put(name);
        const std::string top = fs::path(name).begin()->string();
        const auto files = layer(verify_json({"--pubkey", public_key("measurer")}), "files");
        EXPECT_EQ(files["passed"], false) << name;
        EXPECT_TRUE(says(files["details"], top + ": left by a program that was killed")) << files;
        EXPECT_EQ(sign("judge", "judge").exit_status, 2) << name;
        fs::remove_all(run() / top);
    }
    EXPECT_EQ(verify({"--pubkey", public_key("measurer")}).exit_status, 0);
}

// Had held: no name that begins with a dot is unpacked.
TEST_F(AttacksOnFolders, Files17NoBundleBringsWhatAKilledProgramLeft) {
    fs::rename(run(), path("salt-lake"));
    fs::create_directories(path("salt-lake") / ".runcert-ready/run");
    write_file_atomically(path("salt-lake") / ".runcert-ready/run/a", "a");
    ASSERT_EQ(run_process({"tar", "--zstd", "-C", folder_.path().string(), "-cf",
                           path("a.tar.zst").string(), "salt-lake"})
                  .exit_status,
              0);
    const ProcessResult verified = runcert({"verify", path("a.tar.zst").string()});
    EXPECT_EQ(verified.exit_status, 2) << verified.output;
    EXPECT_TRUE(holds(verified.errors, ".runcert-ready")) << verified.errors;
}

/// A day of one attempt, and its results.
class AttacksOnDays : public AttacksOnFolders {
  protected:
    void SetUp() override { fs::create_directories(out()); }
    fs::path out() const { return path("out"); }
    ProcessResult batch() const {
        return runcert(
            {"batch", attempt().parent_path().string(), "--out", out().string(), "--no-render"});
    }
};

// Got through: what was in a folder of that name was deleted.
TEST_F(AttacksOnDays, Files18WhatNoBatchMadeStays) {
    for (const char* name : {".runcert/work/salt-lake/thesis/1.txt", ".runcert-mine.tmp",
                             ".runcert-4711-0-0123456789abcdef/run/1.txt"}) {
        fs::create_directories((out() / name).parent_path());
        write_file_atomically(out() / name, "mine");
        const ProcessResult result = batch();
        EXPECT_EQ(result.exit_status, 0) << result.errors << result.output;
        EXPECT_EQ(read_file(out() / name), "mine");
    }
}

// Got through: they were overwritten.
TEST_F(AttacksOnDays, Files19ResultsOfADayThatNoBatchWroteAreSetAside) {
    for (const char* name : {"day.csv", "day.yaml", "day.html"})
        write_file_atomically(out() / name, "mine");
    EXPECT_EQ(batch().exit_status, 0);
    for (const char* name : {"day.csv", "day.yaml", "day.html"}) {
        EXPECT_EQ(read_file(out() / ".runcert/superseded" / name), "mine");
        EXPECT_NE(read_file(out() / name), "mine");
    }
    EXPECT_EQ(batch().exit_status, 0);
    EXPECT_FALSE(fs::exists(out() / ".runcert/superseded/day.csv.2")) << "its own are replaced";
}

// Got through: they were overwritten. What the batch itself wrote is made again, also where its
// report is gone.
TEST_F(AttacksOnDays, Files20ARunFolderThatNoRunWroteIsRefusedByTheBatchToo) {
    fs::create_directory(out() / "salt-lake");
    write_file_atomically(out() / "salt-lake/4-trajectory.ecsv", "mine");
    const ProcessResult refused = batch();
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_TRUE(holds(refused.output + refused.errors, "4-trajectory.ecsv")) << refused.output;
    EXPECT_EQ(read_file(out() / "salt-lake/4-trajectory.ecsv"), "mine");
    fs::remove_all(out() / "salt-lake");
    ASSERT_EQ(batch().exit_status, 0);
    fs::remove(out() / "salt-lake/report.json");
    EXPECT_EQ(batch().exit_status, 0);
    EXPECT_TRUE(fs::exists(out() / "salt-lake/report.json"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

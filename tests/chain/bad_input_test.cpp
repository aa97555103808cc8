#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <regex>

#include "chain_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

const std::string good_attempt =
    "schema: attempt/1.0\n"                          // 1
    "id: bad-input\n"                                // 2
    "craft: {name: yacht, class: land-yacht}\n"      // 3
    "receivers:\n"                                   // 4
    "  - {id: primary, recording: recording.pos}\n"  // 5
    "profiles: [nalsa]\n";                           // 6

const std::string pos_header =
    "%  GPST   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  "
    "sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";

/// Twenty good epochs of a recording, with one line replaced.
std::string recording_with(int line, const std::string& text) {
    std::string recording = pos_header;
    for (int i = 2; i <= 21; ++i)
        recording += i == line ? text
                               : fmt::format(
                                     "2022/03/18 08:51:{:02}.000  35.1000{:05}  137.0000000  "
                                     "10.000 1 10 0.01 0.01 0.02 0 0 0 0 9\n",
                                     i, i * 10);
    return recording;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
    return text;
}

struct BadInput {
    const char* name;
    std::string attempt;
    std::string recording;
    std::vector<std::string> said;  ///< what the message must hold
};

std::vector<BadInput> bad_attempts() {
    const std::string good = recording_with(0, "");
    return {
        {"empty attempt", "", good, {"attempt.yaml", "empty"}},
        {"attempt cut off", good_attempt.substr(0, 70), good, {"attempt.yaml:3:"}},
        {"not YAML", "a: [1, 2\nb: {", good, {"attempt.yaml:", "YAML"}},
        {"unknown key",
         replaced(good_attempt, "receivers:", "recievers:"),
         good,
         {"attempt.yaml:4:1", "recievers", "receivers"}},
        {"unknown craft class",
         replaced(good_attempt, "land-yacht", "land-yatch"),
         good,
         {"attempt.yaml:3:", "land-yatch"}},
        {"two receivers with one id",
         replaced(good_attempt, "profiles", "  - {id: primary, recording: b.pos}\nprofiles"),
         good,
         {"attempt.yaml:6:", "two receivers", "primary"}},
        {"missing recording",
         replaced(good_attempt, "recording.pos", "absent.pos"),
         good,
         {"attempt.yaml:5:", "absent.pos", "does not exist"}},
        {"unknown profile",
         replaced(good_attempt, "[nalsa]", "[nasla]"),
         good,
         {"attempt.yaml", "nasla"}},
        {"text where a number belongs",
         good_attempt + "origin: {latitude_deg: north, longitude_deg: 1, height_m: 2}\n",
         good,
         {"attempt.yaml:7:24", "north", "number"}},
        {"latitude 95",
         good_attempt + "origin: {latitude_deg: 95, longitude_deg: 1, height_m: 2}\n",
         good,
         {"attempt.yaml:7:24", "95"}},
        {"id that is a path",
         replaced(good_attempt, "bad-input", "../bad"),
         good,
         {"attempt.yaml:2:5"}},
        {"record without unit",
         good_attempt + "record: {speed: 1, source: s}\n",
         good,
         {"attempt.yaml:7:", "unit"}},
        {"UTF-16", std::string("\xff\xfes\0c\0h\0", 8), good, {"attempt.yaml", "UTF-16"}},
    };
}

const std::string row =
    "2022/03/18 08:51:07.000  35.1000070  137.0  10.0 1 10 0.01 0.01 0.02 0 0 0 0 9\n";

std::vector<BadInput> bad_recordings() {
    return {
        {"empty recording", good_attempt, "", {"recording.pos", "empty"}},
        {"no header", good_attempt, row + row, {"recording.pos"}},
        {"header only", good_attempt, pos_header, {"recording.pos", "epochs"}},
        {"UTF-16, cut", good_attempt, std::string("\xff\xfe%\0 ", 5), {"recording.pos", "UTF-16"}},
        {"binary", good_attempt, std::string("\x00\x01\x02\x03", 4), {"recording.pos"}},
        {"of a day to come, which chose the rule in force",
         good_attempt,
         std::regex_replace(recording_with(0, ""), std::regex("2022/03"), "2089/03"),
         {"1-observations.ecsv", "2089-03-18", "later than tomorrow"}},
    };
}

/// One bad record of some twenty: what 1-observations must say of it.
std::vector<BadInput> bad_records() {
    const auto with = [&](const std::string& what, const std::string& by) {
        return recording_with(7, replaced(row, what, by));
    };
    return {
        {"cut off", good_attempt, recording_with(0, "").substr(0, 1300), {"line: 15", "cut off"}},
        {"wrong column count", good_attempt, with(" 0 0 0 0 9", " 0 0 0 0 9 9 9"), {"line: 7"}},
        {"text for a number", good_attempt, with("10.0 1", "ten 1"), {"line: 7", "ten"}},
        {"not a number", good_attempt, with("0.02", "nan"), {"line: 7", "nan"}},
        {"latitude 95", good_attempt, with("35.1000070", "95.1000070"), {"line: 7", "95"}},
        {"swapped",
         good_attempt,
         with("35.1000070  137.0", "137.0  35.1000070"),
         {"line: 7", "swapped"}},
    };
}

/// Certifies into a folder that holds an earlier result, and expects exit 2, a message with all of
/// its parts, no new file, and the earlier result untouched.
void expect_refused(const BadInput& one) {
    SCOPED_TRACE(one.name);
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "run";
    fs::create_directory(out);
    write_file_atomically(out / "result.txt", "an earlier result");
    write_file_atomically(folder.path() / "attempt.yaml", one.attempt);
    write_file_atomically(folder.path() / "recording.pos", one.recording);
    const ProcessResult result = certify(folder.path() / "attempt.yaml", out);
    EXPECT_EQ(result.exit_status, 2) << result.output;
    for (const char* part : {"error: ", "where: ", "what to do: "})
        EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors;
    for (const std::string& said : one.said)
        EXPECT_NE(result.errors.find(said), std::string::npos) << said << "\n" << result.errors;
    const std::map<std::string, std::string> untouched{{"result.txt", "an earlier result"}};
    EXPECT_EQ(contents_of(out), untouched);
    // Into a folder that did not exist: it does not exist afterwards.
    EXPECT_EQ(certify(folder.path() / "attempt.yaml", folder.path() / "new").exit_status, 2);
    EXPECT_FALSE(fs::exists(folder.path() / "new"));
}

TEST(BadInput, TheGoodAttemptIsGood) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "attempt.yaml", good_attempt);
    write_file_atomically(folder.path() / "recording.pos", recording_with(0, ""));
    const ProcessResult result =
        certify(folder.path() / "attempt.yaml", folder.path() / "run", {"--no-render"});
    EXPECT_EQ(result.exit_status, 1) << result.errors;
}

TEST(BadInput, Attempts) {
    for (const BadInput& one : bad_attempts())
        expect_refused(one);
}

TEST(BadInput, Recordings) {
    for (const BadInput& one : bad_recordings())
        expect_refused(one);
}

TEST(BadInput, ABadRecordInTwentyIsListedAndNothingIsCertified) {
    for (const BadInput& one : bad_records()) {
        SCOPED_TRACE(one.name);
        const TemporaryFolder folder;
        write_file_atomically(folder.path() / "attempt.yaml", one.attempt);
        write_file_atomically(folder.path() / "recording.pos", one.recording);
        const fs::path run = folder.path() / "run";
        const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
        EXPECT_EQ(result.exit_status, 1) << result.errors;
        const std::string table = read_file(run / "1-observations.ecsv");
        EXPECT_NE(table.find("    bad: 1\n"), std::string::npos);
        for (const std::string& said : one.said)
            EXPECT_TRUE(table.find(said) != std::string::npos) << said;
        const YamlValue profile = read_yaml(run / "6-verdict.yaml")["profiles"].list().at(0);
        EXPECT_EQ(profile["outcome"].text(), "not_certifiable");
        const std::string verdict = read_file(run / "6-verdict.yaml");
        EXPECT_NE(verdict.find("records of the recording could not be read"), std::string::npos);
    }
}

TEST(BadInput, NoAttemptAtAll) {
    const TemporaryFolder folder;
    const ProcessResult result = certify(folder.path() / "absent.yaml", folder.path() / "run");
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("absent.yaml"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder.path() / "run"));
}

TEST(BadInput, AnOutputThatIsNoFolder) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "file", "text");
    const ProcessResult result =
        certify(examples / "land_yacht" / "attempt.yaml", folder.path() / "file");
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find((folder.path() / "file").string()), std::string::npos);
    EXPECT_EQ(read_file(folder.path() / "file"), "text");
}

TEST(BadInput, AReadOnlyOutputFolder) {
    // Permissions do not bind the superuser, but nobody can write below /proc.
    const TemporaryFolder folder;
    fs::path out = "/proc/self/run";
    if (geteuid() != 0) {
        fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
        out = folder.path() / "run";
    }
    const ProcessResult result = certify(examples / "land_yacht" / "attempt.yaml", out);
    fs::permissions(folder.path(), fs::perms::owner_all);
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find(out.string()), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("what to do: "), std::string::npos);
}

TEST(BadInput, AFullDisk) {
    // A limit on the size of files stands for a disk without room: the tables do not fit.
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "run";
    fs::create_directory(out);
    write_file_atomically(out / "result.txt", "an earlier result");
    const ProcessResult result = run_process(
        {"bash", "-c",
         fmt::format("ulimit -f 30; {}/runcert certify {} --out {}", RUNCERT_PROGRAMS,
                     (examples / "land_yacht" / "attempt.yaml").string(), out.string())});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_NE(result.errors.find("1-observations.ecsv"), std::string::npos) << result.errors;
    const std::map<std::string, std::string> untouched{{"result.txt", "an earlier result"}};
    EXPECT_EQ(contents_of(out), untouched);
}

TEST(BadInput, ARunThatWasKilledLeavesNothingThatStays) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "run";
    const std::string program = RUNCERT_PROGRAMS "/runcert";
    run_process({"bash", "-c",
                 fmt::format("{} certify {} --out {} & sleep 0.03; kill -9 $!", program,
                             (examples / "salt_lake" / "attempt.yaml").string(), out.string())});
    EXPECT_FALSE(fs::exists(out / "report.json"));
    ASSERT_EQ(certify(examples / "salt_lake" / "attempt.yaml", out, {"--no-render"}).exit_status,
              0);
    for (const auto& entry : fs::directory_iterator(out))
        EXPECT_TRUE(entry.is_regular_file()) << entry.path();
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

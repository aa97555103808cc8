#include <gtest/gtest.h>

#include "make/run_record.h"
#include "store/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// What is read of a record that published these, written as the program writes one.
std::vector<std::string> published(const std::vector<std::string>& names) {
    const TemporaryFolder folder;
    const RecordKey key;
    const RecordPlace place{.file = folder.path() / "record.json", .of = "run one", .key = key};
    RunRecord record;
    record.published = names;
    write_run_record(place, record);
    return read_run_record(place).published;
}

TEST(RunRecord, AnotherKeysOrAnotherRunsRecordSaysNothing) {
    const TemporaryFolder folder;
    const RecordKey own;
    const RecordKey other;
    const std::filesystem::path file = folder.path() / "record.json";
    RunRecord record;
    record.published = {"report.json"};
    write_run_record({.file = file, .of = "run one", .key = own}, record);
    EXPECT_FALSE(read_run_record({.file = file, .of = "run one", .key = own}).foreign);
    for (const RecordPlace& place : {RecordPlace{.file = file, .of = "run one", .key = other},
                                     RecordPlace{.file = file, .of = "run two", .key = own}}) {
        const RunRecord read = read_run_record(place);
        EXPECT_TRUE(read.foreign);
        EXPECT_TRUE(read.published.empty());
    }
    const std::filesystem::path none = folder.path() / "none.json";
    EXPECT_FALSE(read_run_record({.file = none, .of = "run one", .key = own}).foreign);
}

// What a record says was published is deleted one day.
TEST(RunRecord, NamesOnlyFilesThatABatchMakes) {
    const std::vector<std::string> names{"4-trajectory.ecsv",     "1-observations.secondary.ecsv",
                                         "attempt.yaml",          "profile.nalsa.yaml",
                                         "recording.primary.pos", "report.json",
                                         "report.json.minisig",   "report.pdf"};
    EXPECT_EQ(published(names), names);
    for (const char* name : {"..", ".", "", "notes.txt", "a/report.json", "/etc/passwd",
                             "../report.json", "recording.", "day.yaml", ".runcert"})
        EXPECT_TRUE(published({"report.json", name}).empty()) << name;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

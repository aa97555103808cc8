#include "batch/run_record.h"

#include <gtest/gtest.h>

#include "files/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// What is read of a record that published these, written as the program writes one.
std::vector<std::string> published(const std::vector<std::string>& names) {
    const TemporaryFolder folder;
    RunRecord record;
    record.published = names;
    write_run_record(folder.path() / "record.json", record);
    return read_run_record(folder.path() / "record.json").published;
}

// A record can be written by anyone, checksum and all: what it says was published is deleted one
// day.
TEST(RunRecord, NamesOnlyFilesThatABatchMakes) {
    const std::vector<std::string> names{"4-trajectory.ecsv",
                                         "1-observations.secondary.ecsv",
                                         "attempt.yaml",
                                         "profile.nalsa.yaml",
                                         "recording.primary.pos",
                                         "report.json",
                                         "report.json.minisig",
                                         "report.pdf"};
    EXPECT_EQ(published(names), names);
    for (const char* name : {"..", ".", "", "notes.txt", "a/report.json", "/etc/passwd",
                             "../report.json", "recording.", "day.yaml", ".runcert"})
        EXPECT_TRUE(published({"report.json", name}).empty()) << name;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <sstream>

#include "hostile_support.h"

// A good run some of whose lines were damaged: read, counted, listed; and refused where more than 1
// % are damaged, or one is inside the window.

namespace runcert::chain::RUNCERT_FILE {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line + "\n");
    return lines;
}

struct Outcome {
    int exit_status = 0;
    YamlValue verdict;
    std::string observations;
};

/// The example's run with some of its epochs, counted from 1, made unreadable.
Outcome certified(const std::vector<std::size_t>& damaged) {
    const TemporaryFolder folder;
    std::vector<std::string> lines = lines_of(read_file(examples / "salt_lake" / "recording.pos"));
    std::size_t header = 0;
    while (lines[header].starts_with('%'))
        ++header;
    for (const std::size_t epoch : damaged)
        lines[header + epoch - 1] = "2026/03/14 ?\n";
    std::string text;
    for (const std::string& line : lines)
        text += line;
    write_plainly(folder.path() / "recording.pos", text);
    fs::copy_file(examples / "salt_lake" / "attempt.yaml", folder.path() / "attempt.yaml");
    const fs::path run = folder.path() / "run";
    const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
    EXPECT_LE(result.exit_status, 1) << result.errors;
    return {result.exit_status, read_yaml(run / "6-verdict.yaml"),
            read_file(run / "1-observations.ecsv")};
}

YamlValue first_profile(const Outcome& outcome) {
    return outcome.verdict["profiles"].list().front();
}

TEST(DamagedRecords, FewOutsideOfTheWindowAreCountedAndListed) {
    const Outcome outcome = certified({3, 7});
    EXPECT_EQ(outcome.exit_status, 0);
    EXPECT_EQ(first_profile(outcome)["outcome"].text(), "beaten");
    EXPECT_NE(outcome.observations.find("bad: 2"), std::string::npos);
    EXPECT_NE(outcome.observations.find("records cannot be read"), std::string::npos);
}

TEST(DamagedRecords, OneInsideTheWindowRefusesIt) {
    const YamlValue window = first_profile(certified({}))["window"];
    const auto first = static_cast<std::size_t>(window["first_epoch"].integer());
    const Outcome outcome = certified({first + 5});
    // Another window may take its place; that one has no damage inside.
    const YamlValue profile = first_profile(outcome);
    EXPECT_EQ(profile["outcome"].text(), "not_certifiable") << profile["reason"].text();
    EXPECT_NE(profile["reason"].text().find("could not be read"), std::string::npos)
        << profile["reason"].text();
    EXPECT_EQ(outcome.exit_status, 1);
}

TEST(DamagedRecords, MoreThanOneInAHundredRefuseTheRun) {
    std::vector<std::size_t> damaged;
    for (std::size_t epoch = 2; epoch < 40; ++epoch)
        damaged.push_back(epoch);
    const Outcome outcome = certified(damaged);
    const YamlValue profile = first_profile(outcome);
    EXPECT_EQ(outcome.exit_status, 1);
    EXPECT_EQ(profile["outcome"].text(), "not_certifiable");
    EXPECT_NE(profile["reason"].text().find("more than 1 %"), std::string::npos)
        << profile["reason"].text();
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

// A day on a computer with little memory.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "chain_support.h"
#include "day_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// How long a day took, and how long its steps did, added up.
struct DayTimes {
    double day_s = 0.0;
    double steps_s = 0.0;
    int done = 0;
};

DayTimes times_of(const fs::path& day, const fs::path& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"batch",  day.string(), "--out", out.string(),
                                       "--json", "--jobs",     "4",     "--no-render"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = runcert(arguments);
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    DayTimes times;
    std::istringstream lines(result.output);
    for (std::string line; std::getline(lines, line);) {
        const auto event = nlohmann::json::parse(line);
        if (event.at("event") == "step") times.steps_s += event.at("seconds").get<double>();
        if (event.at("event") != "end") continue;
        times.day_s = event.at("seconds");
        times.done = event.at("done");
    }
    return times;
}

TEST(BatchMemory, RunsBeyondTheBudgetAreMadeOneByOne) {
    const TemporaryFolder folder;
    const fs::path day = make_day(folder.path() / "day", 4, 200);
    // Steps that never overlap cannot take longer together than the day does. 1 ms for rounding.
    const DayTimes little = times_of(day, folder.path() / "little", {"--memory", "1"});
    EXPECT_EQ(little.done, 4);
    EXPECT_LE(little.steps_s, little.day_s + 4 * 8 * 0.001);
    // Enough for all: that they do overlap shows that the sum tells.
    const DayTimes enough = times_of(day, folder.path() / "enough", {"--memory", "4096"});
    EXPECT_EQ(enough.done, 4);
    EXPECT_GT(enough.steps_s, 1.5 * enough.day_s);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

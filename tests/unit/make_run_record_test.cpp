#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "make/run_record.h"
#include "store/process.h"
#include "store/user_state.h"

namespace runcert::RUNCERT_FILE {
namespace {

StepRecord a_step() {
    StepRecord step;
    step.programs = {{"runcert-smooth", "12"}};
    step.settings = nlohmann::ordered_json{{"seed", 1}};
    step.inputs = {{"a", "34"}};
    step.outputs = {{"b", "56"}};
    step.said = {"a line"};
    step.seconds = 0.5;
    return step;
}

TEST(RunRecord, IsReadAsItWasWrittenUnderItsFileAlone) {
    remember_record("one", {{"smooth", a_step()}});
    const RunRecord read = recalled_record("one");
    ASSERT_TRUE(read.contains("smooth"));
    EXPECT_EQ(what_changed(read.at("smooth"), a_step()), "");
    EXPECT_EQ(read.at("smooth").outputs, a_step().outputs);
    EXPECT_EQ(read.at("smooth").said, a_step().said);
    EXPECT_TRUE(recalled_record("two").empty());
    EXPECT_TRUE(recalled_record("").empty());
    remember_record("two", read, "one");
    EXPECT_TRUE(recalled_record("one").empty()) << "its file was replaced";
    EXPECT_FALSE(recalled_record("two").empty());
}

TEST(RunRecord, ThatIsBrokenIsNone) {
    for (const char* text : {"", "{", "[]", "{\"form\": \"other\", \"steps\": {}}",
                             "{\"form\": \"runcert-made/1\", \"steps\": {\"smooth\": 1}}"}) {
        remember("run broken", text);
        EXPECT_TRUE(recalled_record("broken").empty()) << text;
    }
}

TEST(RunRecord, AFailureIsOfTheAttemptThatFailed) {
    const TemporaryFolder folder;
    const RunFailure failure{.step = "smooth", .problem = "p", .where = "w", .remedy = "r"};
    remember_failure(folder.path(), {{"attempt.yaml", "1"}}, failure);
    EXPECT_EQ(recalled_failure(folder.path(), {{"attempt.yaml", "1"}}), failure);
    EXPECT_EQ(recalled_failure(folder.path(), {{"attempt.yaml", "2"}}), std::nullopt);
    EXPECT_EQ(recalled_failure(folder.path() / "b", {{"attempt.yaml", "1"}}), std::nullopt);
    remember_failure(folder.path(), {}, {});
    EXPECT_EQ(recalled_failure(folder.path(), {{"attempt.yaml", "1"}}), std::nullopt);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

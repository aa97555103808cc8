// Texts that look like others, or like nothing, in what people hand in: what verification would not
// read is refused where it stands, when it is read. Each test says what came of it before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "chain_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

class AttacksOnTexts : public testing::Test {
  protected:
    void SetUp() override {
        fs::copy(examples / "land_yacht", folder_.path() / "attempt", fs::copy_options::recursive);
        original_ = read_file(attempt());
    }
    fs::path attempt() const { return folder_.path() / "attempt/attempt.yaml"; }
    fs::path run() const { return folder_.path() / "run"; }
    void write(const std::string& from, const std::string& to) const {
        std::string text = original_;
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        write_file_atomically(attempt(), text.replace(at, from.size(), to));
    }
    std::size_t line_of(const std::string& part) const {
        const std::string text = read_file(attempt());
        return 1 +
               static_cast<std::size_t>(std::count(
                   text.begin(), text.begin() + std::ssize(text.substr(0, text.find(part))), '\n'));
    }
    void expect_refused(const std::string& part, const std::string& character) const {
        const ProcessResult result = certify(attempt(), run(), {"--no-render"});
        EXPECT_EQ(result.exit_status, 2) << character << result.output;
        EXPECT_TRUE(holds(result.errors, fmt::format("attempt.yaml:{}:", line_of(part))))
            << result.errors;
        EXPECT_TRUE(holds(result.errors, character)) << character << result.errors;
        EXPECT_FALSE(fs::exists(run()));
    }

    TemporaryFolder folder_;
    std::string original_;
};

/// Escapes of characters that cannot be shown, and what they are called.
constexpr std::array<std::pair<const char*, const char*>, 14> hidden{{{"\\U0001FFFE", "U+1FFFE"},
                                                                      {"\\uFFFE", "U+FFFE"},
                                                                      {"\\uFDD0", "U+FDD0"},
                                                                      {"\\U0010FFFF", "U+10FFFF"},
                                                                      {"\\x07", "U+0007"},
                                                                      {"\\x7f", "U+007F"},
                                                                      {"\\x9b", "U+009B"},
                                                                      {"\\u202E", "U+202E"},
                                                                      {"\\u2066", "U+2066"},
                                                                      {"\\u200F", "U+200F"},
                                                                      {"\\u061C", "U+061C"},
                                                                      {"\\u2028", "U+2028"},
                                                                      {"\\uFEFF", "U+FEFF"},
                                                                      {"\\r", "U+000D"}}};

// Got through when certifying; verify then refused the first four, as YAML that it could not read,
// and the others stood in the report.
TEST_F(AttacksOnTexts, Text01WhatCannotBeShownIsRefusedInANameWithItsLine) {
    for (const auto& [escape, character] : hidden) {
        write("name: simulated land yacht", fmt::format("name: \"land {}yacht\"", escape));
        expect_refused("name: \"land", character);
    }
}

// Got through, in every text of an attempt.
TEST_F(AttacksOnTexts, Text02ItIsRefusedInEveryTextOfAnAttemptAndInItsKeys) {
    for (const char* text :
         {"date: \"2026-03-14\\uFFFE\"",
          "rules: [{profile: nalsa, figure: window.duration_s, value: 2, reason: \"\\u202Ex\"}]",
          "amends: {report_id: \"0123456789abcdef\", sha256: \"\", reason: \"typo \\uFFFE\"}",
          "? \"pl\\u200Face\"\n: x"}) {
        write("profiles: [nalsa]", fmt::format("profiles: [nalsa]\n{}", text));
        const ProcessResult result = certify(attempt(), run(), {"--no-render"});
        EXPECT_EQ(result.exit_status, 2) << text;
        EXPECT_TRUE(holds(result.errors, "cannot be shown")) << text << result.errors;
    }
}

// Got through in each of them.
TEST_F(AttacksOnTexts, Text03ItIsRefusedInRulesDaysAndSimulations) {
    const fs::path rule = attempt().parent_path() / "ours.yaml";
    std::string text = read_file(fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles/nalsa.yaml");
    text.replace(text.find("id: nalsa"), 9, "id: ours");
    const std::size_t title = text.find("title: ");
    text.replace(title, text.find('\n', title) - title, "title: \"Ours \\U0001FFFE\"");
    write_file_atomically(rule, text);
    write("profiles: [nalsa]", "profiles: [ours.yaml]");
    ProcessResult result = certify(attempt(), run(), {"--no-render"});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(holds(result.errors, "U+1FFFE")) << result.errors;
    EXPECT_TRUE(holds(result.errors, "ours.yaml")) << result.errors;

    write_file_atomically(folder_.path() / "day.yaml",
                          "schema: day/1.0\nname: \"Lake \\u202Eyad\"\nattempts: []\n");
    result = runcert({"batch", (folder_.path() / "day.yaml").string(), "--out", run().string()});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(holds(result.errors, "U+202E")) << result.errors;

    write_file_atomically(folder_.path() / "simulation.yaml",
                          "schema: simulation/1.0\nname: \"a \\uFDD0\"\n");
    result = runcert(
        {"simulate", (folder_.path() / "simulation.yaml").string(), "--out", run().string()});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(holds(result.errors, "U+FDD0")) << result.errors;
}

// Had held: as a bare character it was refused, and in the lines of a roster.
TEST_F(AttacksOnTexts, Text04ItIsRefusedAsItIsToo) {
    for (const char* bare : {"\xE2\x80\xAE", "\xF0\x9F\xBF\xBE", "\x1B[31m"}) {
        write("name: simulated land yacht", fmt::format("name: land {}yacht", bare));
        expect_refused("name: land", "control characters");
    }
}

// Got through the other way: verify refused what certify had let pass, for it read the two halves
// of JSON's escapes as two characters.
TEST_F(AttacksOnTexts, Text05WhatCanBeShownIsAcceptedByBoth) {
    write("name: simulated land yacht",
          "name: \"\xF0\x9F\x9A\x80 \\U0001F600 J\xC3\xBCrg \xD7\x99\xD7\x95 "
          "\xF0\xA0\x80\x80 \\u200D \\\"q\\\"\"");
    const ProcessResult made = certify(attempt(), run(), {"--no-render"});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const ProcessResult verified = runcert({"verify", run().string(), "--recompute"});
    EXPECT_TRUE(holds(verified.output, "yes  schemas")) << verified.output;
    EXPECT_TRUE(holds(verified.output, "yes  recompute")) << verified.output;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

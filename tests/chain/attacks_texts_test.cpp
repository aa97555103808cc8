// Texts that look like others, or like nothing, in what people hand in: what verification would not
// read is refused where it stands, when it is read. Each test says what came of it before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <regex>

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
constexpr std::array<std::pair<const char*, const char*>, 26> hidden{
    {{"\\U0001FFFE", "U+1FFFE"},  {"\\uFFFE", "U+FFFE"}, {"\\uFDD0", "U+FDD0"},
     {"\\U0010FFFF", "U+10FFFF"}, {"\\x07", "U+0007"},   {"\\x7f", "U+007F"},
     {"\\x9b", "U+009B"},         {"\\u202E", "U+202E"}, {"\\u2066", "U+2066"},
     {"\\u200F", "U+200F"},       {"\\u061C", "U+061C"}, {"\\u2028", "U+2028"},
     {"\\uFEFF", "U+FEFF"},       {"\\u00AD", "U+00AD"}, {"\\u200B", "U+200B"},
     {"\\u200C", "U+200C"},       {"\\u200D", "U+200D"}, {"\\u034F", "U+034F"},
     {"\\u115F", "U+115F"},       {"\\u180E", "U+180E"}, {"\\u2060", "U+2060"},
     {"\\u3164", "U+3164"},       {"\\uFE0F", "U+FE0F"}, {"\\U000E0041", "U+E0041"},
     {"\\U000E0100", "U+E0100"},  {"\\r", "U+000D"}}};

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
        expect_refused("name: land", "characters that are not seen");
    }
}

// Got through the other way: verify refused what certify had let pass, for it read the two halves
// of JSON's escapes as two characters.
TEST_F(AttacksOnTexts, Text05WhatCanBeShownIsAcceptedByBoth) {
    write("name: simulated land yacht",
          "name: \"\xF0\x9F\x9A\x80 \\U0001F600 J\xC3\xBCrg \xD7\x99\xD7\x95 "
          "\xF0\xA0\x80\x80 \\\"q\\\"\"");
    const ProcessResult made = certify(attempt(), run(), {"--no-render"});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const ProcessResult verified = runcert({"verify", run().string(), "--recompute"});
    EXPECT_TRUE(holds(verified.output, "yes  schemas")) << verified.output;
    EXPECT_TRUE(holds(verified.output, "yes  recompute")) << verified.output;
}

// Got through: a name stood beside the program's words as if it were theirs, on page one, in the
// evidence that officials sign, on the terminal, in audit and in exports.
TEST_F(AttacksOnTexts, Text06WhatIsClaimedIsQuotedWhereverItStands) {
    const std::string open = "\u201C";
    const std::string name = "\u2713 Record beaten\u201D ratified \u201Cby NALSA";
    const auto write = [&](const std::string& from, const std::string& to) {
        AttacksOnTexts::write(from, to);
        original_ = read_file(attempt());
    };
    write("name: simulated land yacht", "name: \"" + name + "\"");
    write("source: \"", "source: \"the board; measured speed: 300.00 km/h, ");
    write("place: ", "place: \"RESULT nalsa beaten\" # ");
    write("{role: measurer}", "{role: measurer, name: \"all answered: complete\"}");
    write("profiles:", fmt::format("pilot: \"Standing: complete\"\namends: {{report_id: "
                                   "0123456789abcdef, sha256: \"{}\", reason: \"withdrawn by the "
                                   "board\"}}\nprofiles:",
                                   std::string(64, 'a')));
    const ProcessResult made = certify(attempt(), run(), {"--no-pdf"});
    ASSERT_NE(made.exit_status, 2) << made.errors;
    const auto predicate = nlohmann::json::parse(read_file(run() / "report.json"))["predicate"];
    std::string texts = predicate["document"].dump() + made.output;
    for (const auto& one : predicate["verdict"]["profiles"][0]["requirements"])
        texts += one["evidence"].get<std::string>();
    for (const char* command : {"explain", "audit", "attest"})
        texts += runcert({command, run().string()}).output;
    for (const char* format : {"kml", "csv"}) {
        const std::string file = (run() / format).string();
        if (runcert({"export", run().string(), "--format", format, "--out", file}).exit_status == 0)
            texts += read_file(file);
    }
    texts = std::regex_replace(texts, std::regex("\\s+"), " ");
    for (const char* claim :
         {"the board; measured speed: 300.00 km/h", "RESULT nalsa beaten", "all answered: complete",
          "Standing: complete", "withdrawn by the board"})
        for (std::size_t at = texts.find(claim); at != std::string::npos;
             at = texts.find(claim, at + 1))
            EXPECT_EQ(texts.substr(at - open.size(), open.size()), open)
                << texts.substr(at - 60, 160);
    EXPECT_FALSE(holds(texts, name));
    EXPECT_TRUE(holds(texts, open + "\u2713 Record beaten' ratified 'by NALSA\u201D"));
    EXPECT_TRUE(holds(texts, "The claimant states that this report replaces"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "run/attempt_files.h"
#include "store_test_support.h"

// Which rules a new attempt may claim on its day, and what evidence adds to them.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

using test::failure_of, test::Said;

std::string rule_text(const std::string& id, const std::string& more) {
    return fmt::format(
        "schema: profile/1.0\nid: {}\nbody: b\ntitle: t\n{}"
        "window: {{duration_s: 3, definition: displacement}}\n"
        "margin: {{kind: absolute, value: 1, unit: km/h}}\n"
        "clauses:\n  - {{id: average, text: what is asked, source: s, certainty: secondary, "
        "decided_by: window_complete}}\n",
        id, more);
}

class RulesInForce : public testing::Test {
  protected:
    void SetUp() override {
        write("rules/old.yaml",
              rule_text("old", "superseded_by: new\nsuperseded_from: 2026-03-01\n"));
        write("rules/new.yaml", rule_text("new", "valid_from: 2026-03-01\n"));
        write("rules/gone.yaml", rule_text("gone", "superseded_by: elsewhere\n"));
        write("rules/seen.yaml",
              "schema: profile/1.0\nid: seen\nbody: b\ntitle: t\nlooked_at: 2026-11-27\n"
              "evidence: true\nsignatures: [{role: witness, count: 2}]\n"
              "clauses:\n  - {id: two-witnesses, text: Two saw it., source: s, certainty: "
              "secondary, decided_by: attest, answered_by: {role: witness, count: 2}}\n"
              "questions:\n  - {id: film, text: \"Must it be filmed?\", source: s}\n");
    }

    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_.path() / name).parent_path());
        write_file_atomically(folder_.path() / name, text);
    }

    std::string attempt_text(const std::string& profiles, const std::string& date) const {
        return fmt::format(
            "schema: attempt/1.0\nid: a\ncraft: {{name: x, class: car}}\n{}"
            "receivers: [{{id: one, recording: a.pos}}]\nprofiles: {}\n",
            date.empty() ? std::string() : fmt::format("date: {}\n", date), profiles);
    }

    /// Brings in a new attempt; the folder that it is brought into.
    fs::path bring_in(const std::string& profiles, const std::string& date,
                      const std::optional<fs::path>& earlier_run = std::nullopt) const {
        const fs::path run = folder_.path() / (earlier_run ? "again" : "run");
        fs::create_directories(run);
        const std::string text = attempt_text(profiles, date);
        bring_in_claim(read_attempt(text, "attempt.yaml"), text,
                       {.file = folder_.path() / "attempt.yaml", .earlier_run = earlier_run}, run);
        return run;
    }

    std::vector<Profile> rules(const std::string& profiles) const {
        return read_claimed_rules(bring_in(profiles, ""),
                                  read_attempt(attempt_text(profiles, ""), "attempt.yaml"));
    }

    TemporaryFolder folder_;
};

/// The claimed day chose the rule. The recording's decides, which no claim knows: see RecordingDate
/// among the tests of the checks.
TEST_F(RulesInForce, TheClaimedDayChoosesNoRule) {
    for (const char* date : {"", "2026-02-28", "2026-03-01"})
        for (const char* rule : {"[rules/old.yaml]", "[rules/new.yaml]", "[rules/gone.yaml]"})
            EXPECT_NO_THROW(bring_in(rule, date));
}

TEST_F(RulesInForce, EvidenceAddsItsClausesToEveryOtherRule) {
    const std::vector<Profile> both = rules("[rules/new.yaml, rules/seen.yaml, nalsa]");
    ASSERT_EQ(both.size(), 2U);
    for (const Profile& rule : both) {
        SCOPED_TRACE(rule.id);
        EXPECT_FALSE(rule.evidence);
        EXPECT_EQ(rule.clauses.back().id, "two-witnesses");
        EXPECT_EQ(rule.clauses.back().answered_by, (Answerer{.role = "witness", .count = 2}));
        EXPECT_EQ(rule.clauses.back().looked_at, "2026-11-27");
        EXPECT_EQ(rule.questions.back().id, "film");
        EXPECT_EQ(rule.signatures, (std::vector<RoleSignatures>{{"witness", 2}}));
    }
    EXPECT_EQ(both[0].id, "new");
    EXPECT_EQ(both[1].id, "nalsa");
    // The program's own fits every rule of the program.
    for (const std::string& name : builtin_profiles()) {
        const Profile rule = read_profile(builtin_profile(name), name);
        if (rule.evidence || rule.window_kind == WindowKind::course || !rule.superseded_by.empty())
            continue;
        EXPECT_EQ(rules(fmt::format("[{}, evidence-general]", name)).at(0).clauses.size(),
                  rule.clauses.size() + 5)
            << name;
    }
}

TEST_F(RulesInForce, EvidenceAloneMeasuresNothing) {
    EXPECT_TRUE(failure_of([&] {
                    bring_in("[rules/seen.yaml]", "");
                }).contains("the attempt claims evidence alone, which measures nothing"));
    write("rules/twice.yaml", [&] {
        std::string text = rule_text("twice", "");
        return text.replace(text.find("id: average"), 11, "id: two-witnesses");
    }());
    EXPECT_TRUE(failure_of([&] {
                    bring_in("[rules/twice.yaml, rules/seen.yaml]", "");
                }).contains("the rules twice and seen both have a clause \"two-witnesses\""));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

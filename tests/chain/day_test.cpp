#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "chain_support.h"
#include "core/failure.h"
#include "core/random.h"
#include "day_outcomes.h"
#include "reports/day/day_writing.h"
#include "reports/day/page_parts.h"
#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"
#include "reports/document/document_text.h"
#include "schemas/common/header.h"
#include "store/sha256.h"

// The results of a day from real run folders, and two days compared.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

class Day : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        for (const char* day : {"old", "new"}) {
            make(day, "land_yacht", "land-yacht", {});
            make(day, "rejected", "rejected", {});
            make(day, "salt_lake", "salt-lake", {});
        }
        make("new", "salt_lake", "stated",
             "parameters:\n  smooth: {noise: stated, jerk_density: 0.01}\n");
        make("old", "salt_lake", "stated", {});
        make("new", "rejected", "other-rule",
             "rules: [{profile: nalsa, figure: margin.value, value: 0.0}]\n");
        make("old", "rejected", "other-rule", {});
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }
    static fs::path out(const std::string& day) { return folder_->path() / day; }

    static void set_key(std::string& text, const std::string& key, const std::string& value) {
        const std::size_t begin = text.find("\n" + key + ": ") + key.size() + 3;
        text.replace(begin, text.find('\n', begin) - begin, value);
    }
    /// A run of an example under another id, with more in its attempt.
    static void make(const std::string& day, const std::string& example, const std::string& id,
                     const std::string& more) {
        const fs::path source = folder_->path() / ("source-" + day) / id;
        fs::create_directories(source.parent_path());
        fs::copy(examples / example, source);
        std::string text = read_file(source / "attempt.yaml") + more;
        set_key(text, "schema", "attempt/1.0");
        set_key(text, "id", id);
        write_file_atomically(source / "attempt.yaml", text);
        const ProcessResult result =
            certify(source / "attempt.yaml", out(day) / id, {"--no-render"});
        if (result.exit_status == 2) ADD_FAILURE() << id << result.errors;
    }

    static void run_day(const std::string& day, const std::vector<std::string>& ids) {
        const MadeDay made = made_day(out(day), ids);
        write_day(made.day, made.outcomes, out(day));
    }
    static std::string results_of(const std::string& day) {
        std::string all;
        for (const char* file : {"day.yaml", "day.csv", "day.html"})
            all += read_file(out(day) / file);
        return all;
    }

    static TemporaryFolder* folder_;
};
TemporaryFolder* Day::folder_ = nullptr;

const std::vector<std::string> all_ids{"land-yacht", "rejected", "salt-lake", "stated",
                                       "other-rule"};

TEST_F(Day, HoldsWhatTheVerdictsSay) {
    run_day("old", all_ids);
    const YamlValue day = read_yaml(out("old") / "day.yaml");
    EXPECT_EQ(day["day"].text(), "lake-day");
    EXPECT_EQ(day["stage"]["name"].text(), "day");
    EXPECT_EQ(day["inputs"].list().size(), 10U);
    EXPECT_EQ(day["counts"]["done"].integer(), 5);
    for (const YamlValue& attempt : day["attempts"].list()) {
        const std::string id = attempt["id"].text();
        const YamlValue verdict = read_yaml(out("old") / id / "6-verdict.yaml");
        const auto report = Json::parse(read_file(out("old") / id / "report.json"))["predicate"];
        EXPECT_EQ(attempt["report_id"].text(), report["report_id"].get<std::string>());
        EXPECT_EQ(attempt["craft"]["name"].text(),
                  report["attempt"]["craft_name"].get<std::string>());
        const auto results = attempt["results"].list();
        const auto verdicts = verdict["profiles"].list();
        ASSERT_EQ(results.size(), verdicts.size());
        for (std::size_t i = 0; i < results.size(); ++i) {
            for (const char* key : {"profile", "outcome", "reason"})
                EXPECT_EQ(results[i][key].text(), verdicts[i][key].text());
            for (const char* key : {"speed_m_s", "expanded_uncertainty_m_s", "coverage_factor"})
                EXPECT_EQ(results[i][key].real(), verdicts[i][key].real()) << key;
            EXPECT_EQ(results[i]["start_time_s"].real(),
                      verdicts[i]["window"]["start_time_s"].real());
            EXPECT_EQ(results[i]["start_utc"].text_or(""),
                      verdicts[i]["window"]["start_utc"].text_or(""));
            EXPECT_EQ(results[i]["shown"]["speed"].text(), verdicts[i]["shown"]["speed"].text());
        }
    }
}

TEST_F(Day, TheSameRunsGiveTheSameBytesWhateverWasThereBefore) {
    run_day("old", all_ids);
    const std::string first = results_of("old");
    run_day("old", {"rejected"});
    EXPECT_NE(results_of("old"), first);
    run_day("old", all_ids);
    EXPECT_EQ(results_of("old"), first);
    EXPECT_EQ(first.find(folder_->path().string()), std::string::npos);
}

TEST_F(Day, AFileThatIsNotAsItsRunWroteItIsRefusedByName) {
    const auto problem_of = [](const MadeDay& made) -> std::string {
        try {
            write_day(made.day, made.outcomes, out("old"));
        } catch (const Failure& failure) {
            return failure.where() + ": " + failure.problem();
        }
        return {};
    };
    MadeDay made = made_day(out("old"), {"rejected", "salt-lake"});
    made.outcomes[1].files["6-verdict.yaml"] = std::string(64, '0');
    EXPECT_NE(problem_of(made).find("salt-lake/6-verdict.yaml"), std::string::npos);
    // The run of another attempt, rightly hashed.
    fs::copy(out("old") / "rejected", out("old") / "another");
    made = made_day(out("old"), {"another"});
    EXPECT_NE(problem_of(made).find("another/6-verdict.yaml"), std::string::npos);
    fs::copy_file(out("old") / "salt-lake/report.json", out("old") / "another/report.json",
                  fs::copy_options::overwrite_existing);
    made = made_day(out("old"), {"another"});
    made.day.attempts[0].id = "rejected";
    made.outcomes[0] = {.state = "done"};
    fs::rename(out("old") / "rejected/report.json", out("old") / "kept");
    EXPECT_NE(problem_of(made).find("rejected/report.json"), std::string::npos);
    fs::rename(out("old") / "kept", out("old") / "rejected/report.json");
    fs::remove_all(out("old") / "another");
}

// What a day made for a screen has, each attempt has a line of, whole.
TEST_F(Day, TheRankingStandsOnATerminalALineAnAttempt) {
    const MadeDay made = made_day(out("old"), all_ids);
    WindowCurves curves;
    const std::string text =
        ranking_text(results_of_day(made.day, made.outcomes, {}, out("old"), curves));
    for (const std::string& id : all_ids)
        EXPECT_TRUE(std::regex_search(
            text, std::regex("\n  (–|[1-9]=?( ≈)?) +" + id + " +[0-9.]+ km/h[^\n]* [A-Z]?[a-z]")))
            << id << text;
}

TEST_F(Day, ComparedWithItselfNothingChanged) {
    run_day("old", all_ids);
    const DayComparison same = compare_days(out("old"), out("old"));
    EXPECT_TRUE(same.equal());
    EXPECT_EQ(same.unchanged, 5);
    EXPECT_NE(document_text(comparison_document(same, "a", "b"), 80).find("Nothing changed.\n"),
              std::string::npos);
}

TEST_F(Day, ChangesAreNamedWithTheirCauses) {
    run_day("old", all_ids);
    run_day("new", all_ids);
    const DayComparison found = compare_days(out("old"), out("new"));
    EXPECT_EQ(found.in_both, 5);
    ASSERT_FALSE(found.causes.empty());
    const auto of = [&](const std::string& id) {
        const auto causes = std::ranges::find(found.causes, id, &ChangeCauses::id);
        return causes == found.causes.end() ? ChangeCauses{} : *causes;
    };
    const ChangeCauses stated = of("stated");
    EXPECT_EQ(stated.unknown, "");
    EXPECT_EQ(stated.causes.parameters.size(), 2U);
    EXPECT_EQ(std::ranges::count(stated.causes.parameters,
                                 Change{"smooth.noise", "\"fitted\"", "\"stated\""}),
              1);
    EXPECT_TRUE(stated.causes.programs.empty());
    EXPECT_TRUE(stated.causes.inputs.empty());
    EXPECT_TRUE(stated.causes.attempt.empty());
    // The example falls short of the record and its margin, not of the record alone.
    const auto other = std::ranges::find(found.results, "other-rule", &ResultChange::id);
    ASSERT_NE(other, found.results.end());
    EXPECT_TRUE(other->outcome_changed);
    EXPECT_EQ(other->new_result->outcome, Outcome::beaten);
    const ChangeCauses rule = of("other-rule");
    ASSERT_EQ(rule.causes.attempt.size(), 1U);
    EXPECT_EQ(rule.causes.attempt[0].what, "rules");
    for (const char* same : {"land-yacht", "rejected", "salt-lake"})
        EXPECT_TRUE(of(same).id.empty()) << same;
    const std::string text = document_text(comparison_document(found, out("old"), out("new")), 200);
    EXPECT_NE(text.find("parameter smooth.noise: \"fitted\" -> \"stated\""), std::string::npos)
        << text;
}

TEST_F(Day, IsToldToMachinesWhole) {
    run_day("old", all_ids);
    run_day("new", all_ids);
    const DayComparison found = compare_days(out("old"), out("new"));
    const Json told = comparison_json(found);
    EXPECT_EQ(told["results"].size(), found.results.size());
    EXPECT_FALSE(found.results.empty());
}

TEST_F(Day, OfNoAttemptIsADayToo) {
    EXPECT_THROW(run_day("empty", {}), Failure);  // there is no such folder
    fs::create_directory(out("empty"));
    run_day("empty", {});
    EXPECT_EQ(read_yaml(out("empty") / "day.yaml")["counts"]["attempts"].integer(), 0);
    EXPECT_TRUE(compare_days(out("empty"), out("empty")).equal());
}

/// Another recording of the same run: its first epoch is left out.
TEST_F(Day, AnotherRecordingIsACauseByItsHash) {
    const fs::path source = folder_->path() / "source-cut";
    fs::copy(folder_->path() / "source-old" / "rejected", source);
    std::string recording = read_file(source / "recording.pos");
    const std::size_t first = recording.find("\n2") + 1;
    recording.erase(first, recording.find('\n', first) + 1 - first);
    write_file_atomically(source / "recording.pos", recording);
    ASSERT_NE(
        certify(source / "attempt.yaml", folder_->path() / "cut", {"--no-render"}).exit_status, 2);
    const RunCauses causes = causes_between(out("old") / "rejected", folder_->path() / "cut");
    ASSERT_EQ(causes.inputs.size(), 1U);
    EXPECT_EQ(causes.inputs[0].what, "recording.primary.pos");
    EXPECT_EQ(causes.inputs[0].b, sha256_hex(recording));
    EXPECT_TRUE(causes.parameters.empty());
    EXPECT_TRUE(causes.programs.empty());
    EXPECT_TRUE(causes.attempt.empty());
}

/// The causes as `runcert diff`, which reads the whole of every file, has them.
void expect_as_diff_has_them(const RunCauses& causes, const fs::path& a, const fs::path& b) {
    const ProcessResult diff = runcert({"diff", a.string(), b.string(), "--json"});
    const auto found = nlohmann::json::parse(diff.output);
    const auto expect = [&](const char* kind, const std::vector<Change>& changes) {
        nlohmann::json list = nlohmann::json::array();
        for (const Change& change : changes)
            list.push_back({{"what", change.what}, {"a", change.a}, {"b", change.b}});
        EXPECT_EQ(found[kind], list) << kind;
    };
    expect("programs", causes.programs);
    expect("parameters", causes.parameters);
    expect("inputs", causes.inputs);
    expect("attempt", causes.attempt);
}

TEST_F(Day, TheCausesAreThoseThatTheDifferenceOfTwoRunsNames) {
    const fs::path a = out("old") / "stated", b = out("new") / "stated";
    expect_as_diff_has_them(causes_between(a, b), a, b);
    // Of another program, in a table, in a document, and in a document that others wrote again.
    const fs::path other = folder_->path() / "other-program";
    fs::copy(b, other);
    for (const char* file : {"3-screened.ecsv", "5-windows.yaml"})
        write_file_atomically(other / file,
                              std::regex_replace(read_file(other / file),
                                                 std::regex("(source_revision: ).*"), "$1another"));
    const YamlValue verdict = read_yaml(other / "6-verdict.yaml");
    write_file_atomically(other / "6-verdict.yaml",
                          json_from_yaml(verdict).dump(-1, ' ', true) + "\n");
    const RunCauses causes = causes_between(a, other);
    ASSERT_EQ(causes.programs.size(), 1U);
    EXPECT_EQ(causes.programs[0].what, "3-screened.ecsv, 5-windows.yaml");
    expect_as_diff_has_them(causes, a, other);
}

TEST_F(Day, ARunFolderThatIsGoneLeavesItsCausesUnknown) {
    run_day("old", {"stated"});
    run_day("new", {"stated"});
    const fs::path alone = folder_->path() / "alone";
    fs::create_directory(alone);
    fs::copy_file(out("old") / "day.yaml", alone / "day.yaml");
    const DayComparison found = compare_days(alone, out("new"));
    ASSERT_EQ(found.causes.size(), 1U);
    EXPECT_NE(found.causes[0].unknown.find("not the folder of a run"), std::string::npos);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

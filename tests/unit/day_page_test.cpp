#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>

#include "day_support.h"
#include "reports/day/day.h"
#include "reports/day/page_parts.h"
#include "store/atomic_file.h"
#include "store/process.h"

// The page and the table of a day: complete, escaped, and of the results' own numbers.

namespace runcert::RUNCERT_FILE {
namespace {

using day::attempt;
using day::results_of;

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

/// libxml2's complaints about a page, but for elements that it does not know.
std::string complaints_of(const std::string& page) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "day.html", page);
    const ProcessResult result = run_process(
        {"xmllint", "--html", "--noout", "--nonet", (folder.path() / "day.html").string()});
    std::string complaints;
    std::istringstream lines(result.errors);
    for (std::string line; std::getline(lines, line);)
        if (line.find("error :") != std::string::npos && line.find("Tag ") == std::string::npos)
            complaints += line + "\n";
    return complaints;
}

AttemptResult failed(const std::string& id) {
    return {.id = id,
            .source = id + ".yaml",
            .state = "failed",
            .failure = DayFailure{.step = "import",
                                  .problem = "line 7 is cut off",
                                  .where = "r.pos:7",
                                  .remedy = "Give the whole recording"}};
}

TEST(DayPage, SaysWhatFailedBeforeAnyRanking) {
    const std::string page =
        day_page(results_of({attempt("a", Outcome::beaten, 52.0, 0.1), failed("b")}));
    // A sentence has one full stop, whether what failed gave one or not.
    const std::size_t failure = page.find(">Line 7 is cut off.<");
    const std::size_t ranking = page.find("because of a");
    ASSERT_NE(failure, std::string::npos);
    ASSERT_NE(ranking, std::string::npos);
    EXPECT_LT(failure, ranking);
    EXPECT_NE(page.find("What to do: Give the whole recording.<"), std::string::npos);
    EXPECT_NE(page.find("Where: r.pos:7<"), std::string::npos);
    EXPECT_EQ(
        day_page(results_of({attempt("a", Outcome::beaten, 52.0, 0.1)})).find("not be processed"),
        std::string::npos);
}

TEST(DayPage, AddsNoFullStopToASentence) {
    AttemptResult bad = failed("b");
    bad.failure->problem = "The file is cut off.";
    bad.failure->remedy = "Record again!";
    const std::string page = day_page(results_of({bad}));
    EXPECT_NE(page.find(">The file is cut off.<"), std::string::npos);
    EXPECT_NE(page.find("What to do: Record again!<"), std::string::npos);
    const std::string main = page.substr(page.find("<main"));
    EXPECT_EQ(main.substr(0, main.find("</main>")).find(".."), std::string::npos);
}

TEST(DayPage, ManyFailuresDoNotHideTheRankings) {
    std::vector<AttemptResult> attempts{attempt("a", Outcome::beaten, 52.0, 0.1)};
    for (int i = 0; i < 30; ++i)
        attempts.push_back(failed(fmt::format("bad-{}", i)));
    const std::string page = day_page(results_of(attempts));
    const std::size_t ranking = page.find("because of a");
    EXPECT_LT(page.find("⚠ bad-11<"), ranking);
    EXPECT_LT(page.find("18 more stand below the rankings."), ranking);
    EXPECT_GT(page.find("⚠ bad-12<"), ranking);
    for (int i = 0; i < 30; ++i)
        EXPECT_EQ(count_of(page, fmt::format("⚠ bad-{}<", i)), 1U);
    EXPECT_EQ(complaints_of(page), "");
}

TEST(DayPage, LeadsToTheReportsAndTables) {
    AttemptResult done = attempt("a", Outcome::beaten, 52.0, 0.1);
    done.pages = {"a/report.pdf", "a/report.html"};
    DayResults results = results_of({done, attempt("b", Outcome::not_beaten, 49.0, 0.1)});
    results.header.inputs.push_back(
        {.role = "verdict", .file = "a/6-verdict.yaml", .sha256 = "ab", .original = {}});
    const std::string page = day_page(results);
    for (const char* link :
         {"a/report.html\"><bdi>a<", "b/report.json\"><bdi>b<", "day.yaml\"><bdi>day.yaml<",
          "day.csv\"><bdi>day.csv<", "a/6-verdict.yaml\"><bdi>a/6-verdict.yaml<"})
        EXPECT_EQ(count_of(page, std::string("<a href=\"") + link), 1U) << link;
}

TEST(DayPage, MarksRanksThatAreNotToldApart) {
    const std::string page = day_page(results_of(
        {attempt("a", Outcome::beaten, 52.00, 0.1), attempt("b", Outcome::beaten, 51.95, 0.1),
         attempt("c", Outcome::beaten, 51.90, 0.1), attempt("d", Outcome::beaten, 51.00, 0.1)}));
    EXPECT_EQ(count_of(page, "cannot be separated from ranks 2 to 3<"), 1U);
    EXPECT_EQ(count_of(page, "cannot be separated from ranks 1 and 3<"), 1U);
    EXPECT_EQ(count_of(page, "cannot be separated from ranks 1 to 2<"), 1U);
    EXPECT_EQ(count_of(page, ">≈ cannot be separated"), 3U);
}

TEST(DayPage, WordsOfRanksNotToldApart) {
    const auto words = [](std::optional<std::int64_t> up, std::optional<std::int64_t> down) {
        return separation_words(
            {.rank = 4, .id = "x", .tied_up_to_rank = up, .tied_down_to_rank = down}, 3, 6);
    };
    EXPECT_EQ(words({}, {}), "");
    EXPECT_EQ(words(3, {}), "cannot be separated from rank 3");
    EXPECT_EQ(words(1, {}), "cannot be separated from ranks 1 to 3");
    EXPECT_EQ(words({}, 6), "cannot be separated from rank 6");
    EXPECT_EQ(words({}, 9), "cannot be separated from ranks 6 to 9");
    EXPECT_EQ(words(3, 6), "cannot be separated from ranks 3 and 6");
    EXPECT_EQ(words(1, 9), "cannot be separated from ranks 1 to 9");
}

TEST(DayPage, WordsOfTheBestOfManyNeverShowCertainty) {
    // Just enough is not shown as less than enough.
    EXPECT_EQ(
        best_words(
            {.id = "a", .attempts = 40, .probability = 0.99938, .level = 0.999375, .beaten = true}),
        "40 attempts were made; the best of that many requires a conformance probability of at "
        "least 99.9375 %. a has 99.9380 %: as the best of that many it exceeds the record too.");
    EXPECT_EQ(
        best_words(
            {.id = "a", .attempts = 40, .probability = 0.99, .level = 0.999375, .beaten = false}),
        "40 attempts were made; the best of that many requires a conformance probability of at "
        "least 99.9375 %. a has 99.00 %: it may be the luckiest of them, so as the best of that "
        "many "
        "it is not proven.");
    EXPECT_EQ(
        best_words({.id = "a", .attempts = 1, .probability = 0.98, .level = 0.975, .beaten = true}),
        "One attempt was made; it requires a conformance probability of at least 97.5 %. a has "
        "98.00 %: it exceeds the record.");
    for (const double below_one : {0.99999, 0.9999996, 1.0 - 1e-12, 1.0})
        for (const std::int64_t attempts : {1, 1000, 10'000, 100'000}) {
            const std::string words =
                best_words({.id = "a",
                            .attempts = attempts,
                            .probability = below_one,
                            .level = 1.0 - 0.025 / static_cast<double>(attempts),
                            .beaten = true});
            EXPECT_EQ(words.find(" 100 %"), std::string::npos) << words;
            EXPECT_EQ(words.find("100.0"), std::string::npos) << words;
        }
}

TEST(DayPage, SaysWhatTheBestOfTheDayIs) {
    using day::beaten_with;
    const std::string page = day_page(
        results_of({beaten_with("a", 53.0, 0.98), attempt("b", Outcome::not_beaten, 49.0, 0.1)}));
    EXPECT_EQ(count_of(page,
                       "2 attempts were made; the best of that many requires a conformance "
                       "probability of at least 98.75 %"),
              1U);
    EXPECT_EQ(count_of(page, "as the best of that many it is not proven"), 1U);
    EXPECT_EQ(complaints_of(page), "");
    const std::string none = day_page(results_of({attempt("b", Outcome::not_beaten, 49.0, 0.1)}));
    EXPECT_EQ(none.find("attempts were made"), std::string::npos);
    EXPECT_EQ(none.find("attempt was made"), std::string::npos);
}

TEST(DayPage, DrawsEverySpeedOfAFewAndSaysHowManyOfMany) {
    std::vector<AttemptResult> attempts;
    for (int i = 0; i < 4; ++i)
        attempts.push_back(attempt(fmt::format("run-{}", i), Outcome::beaten, 52.0 + i, 0.1));
    const std::string few = day_page(results_of(attempts));
    const std::string value = " text-anchor=\"end\" fill=\"#1a1a1a\">";
    EXPECT_EQ(count_of(few, value), 2 * 4U);  // wide, and for a telephone
    EXPECT_EQ(few.find("speeds are drawn"), std::string::npos);
    for (int i = 4; i < 300; ++i)
        attempts.push_back(
            attempt(fmt::format("run-{}", i), Outcome::beaten, 52.0 + 0.01 * i, 0.1));
    const std::string many = day_page(results_of(attempts));
    EXPECT_EQ(count_of(many, value), 2 * 24U);
    EXPECT_NE(many.find("The first 24 of 300 speeds are drawn"), std::string::npos);
    EXPECT_EQ(count_of(many, "<tbody class=\"mark-yes\">"), 300U);
    EXPECT_EQ(complaints_of(many), "");
}

/// The plots of a day of one rule.
Plots plots_of(const DayResults& results, const WindowCurves& curves = {}) {
    return ranking_part(results.profiles.at(0), attempts_by_id(results), curves, 0).plots;
}

TEST(DayPage, DrawsBarsAsLongAsTheExpandedUncertainties) {
    const Plots plots = plots_of(results_of({attempt("a", Outcome::not_beaten, 40.0, 0.0),
                                             attempt("b", Outcome::not_beaten, 50.0, 5.0)}));
    ASSERT_EQ(plots.size(), 1U);
    const Plot& plot = plots[0];
    ASSERT_EQ(plot.rows.size(), 2U);
    const auto bar = std::ranges::find(plot.curves, "not beaten", &Curve::name);
    ASSERT_NE(bar, plot.curves.end());
    const std::string unit = plot.x_label;
    std::vector<double> of_b;
    for (std::size_t i = 0; i < bar->size(); ++i)
        if (bar->y[i] == plot.rows[0].y) of_b.push_back(bar->x[i]);
    ASSERT_GE(of_b.size(), 2U);
    const auto required = std::ranges::find(plot.curves, "required speed", &Curve::name);
    EXPECT_NE(required, plot.curves.end());
    const double per_m_s = (of_b[1] + of_b[0]) / 2.0 / 50.0;
    EXPECT_NEAR(of_b[1] - of_b[0], 10.0 * per_m_s, 1e-3) << unit;
    EXPECT_LE(plot.x_min, of_b[0]);
    EXPECT_GE(plot.x_max, of_b[1]);
}

const std::vector<std::string> hostile{"<script>alert(1)</script>",
                                       "\"><img src=x onerror=alert(1)>",
                                       "' onclick='alert(1)",
                                       "{{{script}}}",
                                       "{{#attempts}}",
                                       "</style><script>",
                                       "\x1b[2J\nline",
                                       "a\u202Eb",
                                       "=HYPERLINK(\"http://x\")",
                                       "@SUM(1)",
                                       "+1",
                                       "-1",
                                       "\xff\xfe",
                                       "javascript:alert(1)",
                                       "//example.org/",
                                       std::string(200, 'W'),
                                       std::string(12'000, 'W'),
                                       "Bj\u00f8rn's \u8239"};

DayResults hostile_day(const std::string& text) {
    AttemptResult done = attempt("a", Outcome::beaten, 52.0, 0.1);
    done.source = done.craft->name = done.craft->craft_class = text;
    done.notes = {text};
    done.pages = {text + ".html"};
    done.results[0].reason = text;
    done.results[0].replaced = {text};
    AttemptResult bad = failed(text);
    bad.failure = DayFailure{.step = text, .problem = text, .where = text, .remedy = text};
    bad.notes = {text};
    AttemptResult left{.id = text, .source = text, .state = "not_processed", .reason = text};
    DayResults results = results_of({done, bad, left});
    results.day = text;
    results.notes = {text};
    results.profiles[0].body = results.profiles[0].title = text;
    return results;
}

TEST(DayPage, WhatComesFromOutsideIsTextAlone) {
    const std::string plain = day_page(hostile_day("plain"));
    for (const std::string& text : hostile) {
        SCOPED_TRACE(text);
        const std::string page = day_page(hostile_day(text));
        // Nothing adds or takes an element, a script, a rule of style or an attribute of events.
        for (const char* part :
             {"<script", "</script", "<style", "</style", "<img", "<svg", "<tr", "<li"})
            EXPECT_EQ(count_of(page, part), count_of(plain, part)) << part;
        for (const char* part : {"onerror=alert(1)>", "onclick='", "\x1b", "\u202E", "\xff"})
            EXPECT_EQ(page.find(part), std::string::npos) << part;
        EXPECT_EQ(complaints_of(page), "");
        EXPECT_EQ(count_of(page, "href=\"/"), 0U);
        static const std::regex link("href=\"([^\"]*)\"");
        for (std::sregex_iterator at(page.begin(), page.end(), link), end; at != end; ++at)
            EXPECT_TRUE(std::regex_match(at->str(1), std::regex("[-A-Za-z0-9._~/%#]+")))
                << at->str(1);
    }
}

TEST(DayCsv, WhatComesFromOutsideIsACellAndNoFormula) {
    for (const std::string& text : hostile) {
        SCOPED_TRACE(text);
        const TemporaryFolder folder;
        write_file_atomically(folder.path() / "day.csv", day_csv(hostile_day(text)));
        // Python's reader says how many cells there are, and how they begin.
        const ProcessResult result =
            run_process({"python3", "-c",
                         "import csv,sys\n"
                         "rows=list(csv.reader(open(sys.argv[1],encoding='utf-8',errors='replace',"
                         "newline='')))\n"
                         "texts=[c for r in rows[1:] for c in r]\n"
                         "print(sorted({len(r) for r in rows}), len(rows),"
                         " sum(c[:1] in '=+@\\t\\r-' for c in texts if c))",
                         (folder.path() / "day.csv").string()});
        EXPECT_EQ(result.output, "[33] 4 0\n") << result.errors;
    }
}

TEST(DayCsv, HoldsEveryFigureInTheColumnOfItsName) {
    DayResults results = results_of({attempt("a", Outcome::beaten, 52.25, 0.125), failed("b")});
    results.attempts[0].results[0].start_utc = "2022-03-18T08:51:22.300Z";
    results.attempts[0].results[0].own_arithmetic = "52.26 m/s";
    EXPECT_EQ(
        day_csv(results),
        "attempt,source,state,craft,class,profile,rank,tied_up_to_rank,"
        "tied_down_to_rank,outcome,to_be_attested,signatures_required,speed_m_s,expanded_"
        "uncertainty_m_s,coverage_factor,"
        "required_speed_m_s,shown_unit,shown_speed,shown_expanded_uncertainty,shown_required_speed,"
        "window_start_utc,window_start_time_s,window_duration_s,reason,replaced_figures,"
        "failed_step,problem,where,remedy,notes,report_id,report,own_arithmetic\n"
        "a,day.yaml:1,done,craft of a,land-yacht,nalsa,1,,,beaten,0,0,52.250000,0.125000,2.000000,"
        "50.000000,m/s,52.25,0.13,50.00,2022-03-18T08:51:22.300Z,,,because of "
        "a,,,,,,,0123456789abcdef,"
        "a/report.json,52.26 m/s\n"
        "b,b.yaml,failed,,,,,,,,,,,,,,,,,,,,,,,import,line 7 is cut off,r.pos:7,"
        "Give the whole recording,,,,\n");
}

TEST(DayPage, IsItsOwnAndNeedsNoScript) {
    const std::string page = day_page(results_of({attempt("a", Outcome::beaten, 52.0, 0.1)}));
    // The namespace URIs of HTML and SVG are identifiers: nothing is fetched from them.
    EXPECT_EQ(count_of(page, "http://"), count_of(page, "'http://www.w3.org/2000/svg'") +
                                             count_of(page, "xmlns=\"http://www.w3.org/"));
    EXPECT_EQ(page.find("https://"), std::string::npos);
    EXPECT_EQ(page.find(" src="), std::string::npos);
    EXPECT_EQ(count_of(page, " style="), count_of(page, "<col style=\"width: "));
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
    // The policy's hash equals that of the script as computed by another program.
    const TemporaryFolder folder;
    const std::size_t begin = page.find("<script>") + 8;
    write_file_atomically(folder.path() / "script",
                          page.substr(begin, page.find("</script>") - begin));
    const ProcessResult hash =
        run_process({"sh", "-c", "openssl dgst -sha256 -binary \"$0\" | base64",
                     (folder.path() / "script").string()});
    ASSERT_EQ(hash.output.size(), 45U) << hash.errors;
    EXPECT_NE(page.find("'sha256-" + hash.output.substr(0, 44) + "'"), std::string::npos);
}

WindowCurve curve_of(double speed, const std::string& quantity = "speed (km/h)") {
    Curve run{"smoothed", "line", "blue"};
    run.add(-1.0, speed - 2.0);
    run.add(0.0, speed);
    run.interrupt();
    run.add(2.0, speed + 1.0);
    run.add(3.0, speed - 1.0);
    return {.profile = "nalsa", .quantity = quantity, .duration_s = 2.0, .speed = run};
}

TEST(DayPage, LaysTheWindowsOfTheFirstRunsOverOneAnother) {
    const DayResults results = results_of({attempt("a", Outcome::beaten, 52.0, 0.1),
                                           attempt("b", Outcome::not_beaten, 48.0, 0.1),
                                           attempt("c", Outcome::not_beaten, 47.0, 0.1)});
    EXPECT_EQ(day_page(results).find("Around the windows"), std::string::npos);
    EXPECT_EQ(day_page(results, {{"a", {curve_of(52.0)}}}).find("Around the windows"),
              std::string::npos);
    // Of another quantity, and of another rule: not drawn.
    WindowCurve other = curve_of(47.0);
    other.profile = "fisly";
    const std::string page =
        day_page(results, {{"a", {curve_of(52.0)}}, {"b", {curve_of(48.0)}}, {"c", {other}}});
    EXPECT_NE(page.find("first 2 of the ranking"), std::string::npos);
    const Plots plots =
        plots_of(results, {{"a", {curve_of(52.0)}}, {"b", {curve_of(48.0)}}, {"c", {other}}});
    ASSERT_EQ(plots.size(), 2U);
    const Plot& plot = plots[1];
    ASSERT_EQ(plot.curves.size(), 2U);
    EXPECT_EQ(plot.curves[0].name, "1 · a");
    EXPECT_EQ(plot.curves[1].name, "2 · b");
    EXPECT_NE(plot.curves[0].colour, plot.curves[1].colour);
    EXPECT_EQ(plot.curves[0].x, curve_of(52.0).speed.x);
    EXPECT_TRUE(std::ranges::any_of(plot.curves[0].y, [](double y) { return std::isnan(y); }));
    EXPECT_EQ(plot.spans.at(0).from, 0.0);
    EXPECT_EQ(plot.spans.at(0).to, 2.0);
    const std::string units =
        day_page(results, {{"a", {curve_of(52.0)}}, {"b", {curve_of(48.0, "speed (kn)")}}});
    EXPECT_EQ(units.find("Around the windows"), std::string::npos);
    EXPECT_TRUE(complaints_of(page).empty()) << complaints_of(page);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"

// The first page of a certificate: what is read by whoever reads nothing else.

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

const Place first{"certificate"};

sample::Run made(const sample::Options& options = {}) {
    return sample::with_one_rule(sample::make_run(options));
}

ProfileVerdict& verdict_of(sample::Run& run) {
    return run.inputs.verdict.profiles[0];
}

/// The only block of that look on the first page; null where there is none.
Json block_of_look(const Json& report, const std::string& look) {
    for (const Json& block : blocks_at(report, first))
        if (block.value("look", "") == look) return block;
    return nullptr;
}

std::size_t headlines(const Json& report) {
    std::size_t count = 0;
    for (const Json& section : report["predicate"]["document"]["sections"])
        for (const Json& block : section["blocks"])
            count += block["kind"] == "headline" ? 1 : 0;
    return count;
}

TEST(FirstPage, SaysWhereTheProgramIsToBeHadIfWhoeverBuiltItSaid) {
    Json report = report_json(made().inputs);
    report["predicate"]["program"].erase("home");
    EXPECT_EQ(print_page(report).find("The program is at"), std::string::npos);
    report["predicate"]["program"] = {{"name", "runcert"},
                                      {"version", "1.2.3"},
                                      {"source_revision", "abc"},
                                      {"arithmetic", "x"},
                                      {"home", "https://example.org/runcert"}};
    EXPECT_NE(print_page(report).find(" The program is at https://example.org/runcert (version "
                                      "1.2.3, source abc)."),
              std::string::npos);
}

TEST(FirstPage, OfARecordThatIsBeatenTheSpeedStandsLarge) {
    const Json report = report_json(made().inputs);
    ASSERT_EQ(headlines(report), 1U);
    for (const Json& block : blocks_at(report, first))
        if (block["kind"] == "headline") {
            EXPECT_EQ(block["text"], "216.00 km/h ± 0.019 km/h");
            EXPECT_EQ(block["beside"], "(k = 2, 95 %)");
        }
    EXPECT_TRUE(block_of_look(report, "reason").is_null());
    EXPECT_TRUE(slot_at(report, "outcome/nalsa")["text"].get<std::string>().starts_with(
        "Measured speed exceeds the record"));
    EXPECT_FALSE(has_fact(report, first, "Measured speed")) << "it stands there once";
    EXPECT_EQ(fact_at(report, first, "Required speed"), "204.51 km/h");
    EXPECT_EQ(fact_at(report, first, "Record to beat"),
              "202.9 km/h ± 0.05 km/h (k = 2): “published figure of 2009”");
    EXPECT_EQ(fact_at(report, first, "Conformance probability"),
              "99.9987 % (at least 95 % required)");
    EXPECT_EQ(fact_at(report, first, "Window"), "3.000 s from 2022-03-18T08:51:44.500Z");
}

// The press prints the largest figure that it finds.
TEST(FirstPage, OfEveryOtherOutcomeTheReasonStandsThereAndNoSpeedInLargeLetters) {
    for (const Outcome outcome :
         {Outcome::not_beaten, Outcome::not_proven, Outcome::not_certifiable}) {
        sample::Run run = made();
        verdict_of(run).outcome = outcome;
        verdict_of(run).reason = "The reason of it, in a sentence.";
        const Json report = report_json(run.inputs);
        EXPECT_EQ(headlines(report), 0U) << to_text(outcome);
        EXPECT_EQ(block_of_look(report, "reason")["text"], verdict_of(run).reason)
            << to_text(outcome);
        EXPECT_EQ(fact_at(report, first,
                          outcome == Outcome::not_certifiable ? "Not certified" : "Measured speed"),
                  "216.00 km/h ± 0.019 km/h (k = 2, 95 %)")
            << to_text(outcome);
        EXPECT_EQ(has_fact(report, first, "Conformance probability"),
                  outcome != Outcome::not_certifiable);
    }
    EXPECT_EQ(headlines(report_json(made({.certified = false}).inputs)), 0U);
}

TEST(FirstPage, OfNoRecordNamedHasNoFiguresOfOne) {
    sample::Run run = made();
    verdict_of(run).outcome = Outcome::not_proven;
    verdict_of(run).record.reset();
    verdict_of(run).decision.reset();
    verdict_of(run).required_speed_m_s.reset();
    verdict_of(run).shown->required_speed.clear();
    const Json report = report_json(run.inputs);
    for (const char* absent :
         {"Required speed", "Acceptance limit", "Record to beat", "Conformance probability"})
        EXPECT_FALSE(has_fact(report, first, absent)) << absent;
}

TEST(FirstPage, WithoutAnythingMeasuredStillNamesTheRequiredSpeedInItsOverview) {
    const Json report = report_json(sample::make_run({.certified = false}).inputs);
    for (const Json& block : blocks_at(report, first)) {
        if (block["kind"] != "table") continue;
        const Json& cells = block["rows"][0]["cells"];
        EXPECT_EQ(cells[1], "none");
        EXPECT_EQ(cells[2], "204.51 km/h");  // 204.509344
        EXPECT_EQ(cells[3], "none");
    }
}

TEST(FirstPage, OfSeveralRulesIsAnOverviewOfThem) {
    sample::Run run = sample::make_run();
    const Json report = report_json(run.inputs);
    EXPECT_EQ(headlines(report), 0U);
    std::vector<std::string> outcomes;
    std::vector<Json> rows;
    for (const Json& block : blocks_at(report, first)) {
        if (block.value("slot", "").starts_with("outcome/")) outcomes.push_back(block["text"]);
        if (block["kind"] == "table") rows.push_back(block["rows"]);
        EXPECT_FALSE(block.value("slot", "").starts_with("requirements/"));
    }
    ASSERT_EQ(outcomes.size(), 2U);
    EXPECT_TRUE(outcomes[0].starts_with("nalsa: Measured speed exceeds the record")) << outcomes[0];
    EXPECT_TRUE(outcomes[1].starts_with("fisly: Measured speed exceeds the record")) << outcomes[1];
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(
        rows[1][0]["cells"],
        Json({"top speed of a land yacht, International Federation of Sand and Land "
              "Yachting (FISLY)",
              "216.00 km/h ± 0.019 km/h", "204.51 km/h", "2.000 s from 2022-03-18T08:51:44.500Z"}));
    // Each rule's reason stands in the annex.
    for (const ProfileVerdict& verdict : run.inputs.verdict.profiles)
        EXPECT_NE(sentences_at(report, {.section = "requirements", .rule = verdict.profile})
                      .find(verdict.reason),
                  std::string::npos);
}

TEST(FirstPage, HoldsManyOfficialsAndTheirNamesWhole) {
    sample::Run run = made({.craft = "שלום עולם", .place = "塩湖の東岸"});
    run.inputs.attempt.officials.clear();
    std::string listed;
    for (int i = 0; i < 12; ++i) {
        const std::string name = fmt::format("{}{:02}", std::string(198, 'n'), i);
        run.inputs.attempt.officials.push_back({.role = "observer", .name = name});
        listed += (i == 0 ? "observer: “" : ", observer: “") + name + "”";
    }
    run.inputs.attempt.pilot = "王 小明";
    const Json report = report_json(run.inputs);
    EXPECT_EQ(fact_at(report, first, "Officials"), listed);
    EXPECT_EQ(fact_at(report, first, "Pilot"), "“王 小明”");
    EXPECT_TRUE(fact_at(report, first, "Craft").starts_with("“שלום עולם”, land-yacht"));
    const std::string page = section_html(print_page(report), "certificate");
    // A name that is written from right to left turns nothing beside it.
    EXPECT_NE(page.find("<dt><bdi>Craft</bdi></dt><dd><bdi>“שלום עולם”, land-yacht"),
              std::string::npos);
    EXPECT_NE(page.find("<bdi>“塩湖の東岸”; "), std::string::npos);
    for (const Official& official : run.inputs.attempt.officials)
        EXPECT_NE(page.find(official.name), std::string::npos)
            << "a name of 200 letters stays whole";
}

TEST(FirstPage, SaysWhatIsNotStated) {
    sample::Run run = made({.georeferenced = false, .place = ""});
    run.inputs.attempt.date.clear();
    run.inputs.attempt.officials.clear();
    const Json report = report_json(run.inputs);
    for (const char* name : {"Pilot", "Organisation", "Place", "Date", "Instrument", "Officials"})
        EXPECT_EQ(fact_at(report, first, name), "not stated") << name;
    EXPECT_TRUE(block_of_look(report, "caution")["text"].get<std::string>().starts_with(
        "Not georeferenced."));
}

TEST(FirstPage, NamesPeopleAndInstrumentAsTheAttemptStatesThem) {
    sample::Run run = made();
    Attempt& attempt = run.inputs.attempt;
    attempt.pilot = "A. Pilot";
    attempt.organisation = "A club";
    attempt.contact = "mail@example.org";
    attempt.craft.registration = "R-1";
    attempt.receivers[0].instrument = Instrument{.make = "Maker", .model = "M2", .serial = "77"};
    run.inputs.receivers[0].observations.device = "M2, firmware 3.1";
    const Json report = report_json(run.inputs);
    EXPECT_EQ(fact_at(report, first, "Pilot"), "“A. Pilot”");
    EXPECT_EQ(fact_at(report, first, "Organisation"), "“A club”, “mail@example.org”");
    EXPECT_TRUE(fact_at(report, first, "Craft").starts_with("“Salt Runner”, “R-1”, land-yacht"));
    EXPECT_EQ(fact_at(report, first, "Instrument"),
              "“Maker M2”, serial “77”; the recording says “M2, firmware 3.1”");
}

// 08:51:44.500 UTC.
TEST(FirstPage, GivesTheLocalTimeOfTheWindow) {
    sample::Run run = made();
    const auto local = [&](const char* offset, std::optional<int> minutes) {
        run.inputs.attempt.utc_offset = offset;
        run.inputs.attempt.utc_offset_minutes = minutes;
        return fact_at(report_json(run.inputs), first, "Local time");
    };
    EXPECT_EQ(local("+10:30", 630), "2022-03-18 19:21:44.500 (UTC+10:30)");
    EXPECT_EQ(local("-09:00", -540), "2022-03-17 23:51:44.500 (UTC-09:00)");
    EXPECT_EQ(local("-00:30", -30), "2022-03-18 08:21:44.500 (UTC-00:30)");
    EXPECT_TRUE(local("", std::nullopt).starts_with("no fact"));
    sample::Run plane = made({.georeferenced = false});
    plane.inputs.attempt.utc_offset = "+10:30";
    plane.inputs.attempt.utc_offset_minutes = 630;
    EXPECT_FALSE(has_fact(report_json(plane.inputs), first, "Local time"))
        << "the recording's time is relative";
}

TEST(FirstPage, ListsEveryRequirementWithItsState) {
    sample::Run run = made();
    const Json report = report_json(run.inputs);
    const Json facts = slot_at(report, "requirements/nalsa")["facts"];
    const Json rows = slot_at(report, "clauses")["rows"];
    const auto& requirements = verdict_of(run).requirements;
    ASSERT_EQ(facts.size(), requirements.size());
    ASSERT_EQ(rows.size(), requirements.size());
    for (std::size_t i = 0; i < requirements.size(); ++i)
        for (const Json& one : {facts[i], rows[i]}) {
            EXPECT_EQ(one["clause"], requirements[i].clause);
            EXPECT_EQ(one["mark"], to_text(requirements[i].status));
        }
    EXPECT_EQ(fact_at(report, first, "Secondary method"), "✓ by the data");
    EXPECT_EQ(fact_at(report, first, "Own start"), "☐ open: judge");
    sample::Run refused = made({.certified = false});
    EXPECT_EQ(fact_at(report_json(refused.inputs), first, "Average over 3 s"),
              "✗ NOT MET by the data");
}

TEST(FirstPage, HasTheContentsOfTheOthers) {
    const Json report = report_json(made().inputs);
    const std::string page = print_page(report);
    const std::size_t begin = page.find("<nav aria-label=\"Contents\">");
    ASSERT_NE(begin, std::string::npos);
    std::size_t at = begin, listed = 0;
    for (const Json& section : report["predicate"]["document"]["sections"]) {
        if (!section.contains("title")) continue;
        at = page.find(
            fmt::format("<li><a href=\"#{}\">{}</a></li>", section["anchor"].get<std::string>(),
                        section["title"].get<std::string>()),
            at);
        ASSERT_NE(at, std::string::npos) << section["anchor"];
        ++listed;
    }
    EXPECT_GE(listed, 7U);
    EXPECT_EQ(page.find("<nav", begin + 1), std::string::npos) << "once";
}

/// The squares of a page's code.
std::string code_of(const std::string& page) {
    const std::string begin = "<div class=\"code\"><svg ";
    const std::size_t at = page.find(begin);
    if (at == std::string::npos) return {};
    const std::size_t path = page.find("<path d=\"", at) + 9;
    return page.substr(path, page.find('"', path) - path);
}

// The page's script draws the same squares: a browser test compares them.
TEST(FirstPage, HasACodeOfItsIdAndHash) {
    Json report = report_json(made().inputs);
    report["predicate"]["report_id"] = "0123456789abcdef";
    const auto code = [&](const std::string& text) {
        return code_of(report_print_page(text, report, {}));
    };
    // "RUNCERT 0123456789ABCDEF 2CF24DBA...", whose hash is that of "hello".
    const std::string hello = code("hello");
    EXPECT_EQ(sha256_hex(hello),
              "25d2b540c76bdf9a5a747b77f2d24a9470c029caf631c46dc2e56539d7b2f2c1");
    EXPECT_NE(code("hellp"), hello);
    report["predicate"]["report_id"] = "0123456789abcdee";
    EXPECT_NE(code("hello"), hello);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

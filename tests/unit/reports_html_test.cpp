#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "core/failure.h"
#include "reports/certificate/report_html.h"
#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"
#include "store/base64.h"
#include "store/sha256.h"
#include "trust/signature.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

const KeyPair a_pair = generate_key_pair();

std::vector<SignatureFile> signed_with(const std::string& comment) {
    return {{.name = "report.json.minisig", .text = sign("report", a_pair.secret_key, comment)}};
}

const std::vector<SignatureFile> a_signature = signed_with("runcert role=measurer");

std::string page(const sample::Options& options, const std::vector<SignatureFile>& signatures) {
    return print_page(report_json(sample::make_run(options).inputs), signatures);
}

std::string screen_page(const Json& report, const std::vector<SignatureFile>& signatures = {}) {
    return report_page(report_text_of(report), report, signatures);
}

/// Without the points of the curves, among which almost every number is.
Json without_curves(Json report) {
    for (Json& figure : report["predicate"]["figures"])
        figure["curves"] = Json::array();
    return report;
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const std::size_t from = text.find(begin);
    if (from == std::string::npos) return {};
    return text.substr(from + begin.size(),
                       text.find(end, from + begin.size()) - from - begin.size());
}

std::set<std::string> numbers_of(const std::string& text) {
    static const std::regex number("[0-9]+(\\.[0-9]+)?");
    std::set<std::string> numbers;
    for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at)
        numbers.insert(at->str());
    return numbers;
}

/// What a reader sees: no head, no tags.
std::string visible_text(const std::string& html) {
    std::string body = html.substr(html.find("<body>"));
    for (std::size_t at = body.find("<svg"); at != std::string::npos; at = body.find("<svg"))
        body.erase(at, body.find("</svg>", at) + 6 - at);  // the numbers of its axes
    std::string text;
    bool inside = false;
    for (const char c : body) {
        inside = inside || c == '<';
        text += inside ? ' ' : c;
        inside = inside && c != '>';
    }
    return text;
}

class EveryPage : public testing::TestWithParam<sample::Options> {};

TEST_P(EveryPage, ShowsNoNumberThatIsNotInTheReport) {
    const Json report = report_json(sample::make_run(GetParam()).inputs);
    const std::set<std::string> known = numbers_of(report_text_of(without_curves(report)));
    std::string text = visible_text(print_page(report));
    // The hash of the report's own bytes is the one thing that these cannot hold.
    const std::string sha256 = sha256_hex(report_text_of(report));
    const std::size_t hash = text.find(sha256);
    ASSERT_NE(hash, std::string::npos);
    const std::set<std::string> shown = numbers_of(text.erase(hash, sha256.size()));
    EXPECT_GT(shown.size(), 60U);
    for (const std::string& number : shown)
        EXPECT_TRUE(known.contains(number)) << number;
}

TEST_P(EveryPage, HoldsEveryHashWhole) {
    const sample::Run run = sample::make_run(GetParam());
    const std::string html = print_page(report_json(run.inputs));
    for (const InputFile& subject : run.inputs.files)
        EXPECT_NE(html.find("<bdi>" + subject.sha256 + "</bdi>"), std::string::npos);
}

TEST_P(EveryPage, IsSelfContained) {
    std::string html = page(GetParam(), {});
    const std::string name_of_svg = "xmlns=\"http://www.w3.org/2000/svg\"";  // nothing is fetched
    for (std::size_t at = html.find(name_of_svg); at != std::string::npos;
         at = html.find(name_of_svg))
        html.erase(at, name_of_svg.size());
    for (const char* outside : {"<script", "http://", "https://", " src=\"h", "@import", "url("})
        EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    // Links lead to the page's own sections.
    static const std::regex link(" href=\"([^\"]*)");
    std::sregex_iterator at(html.begin(), html.end(), link);
    EXPECT_NE(at, std::sregex_iterator());
    for (const std::sregex_iterator end; at != end; ++at) {
        const std::string target = (*at)[1];
        EXPECT_TRUE(target.starts_with('#')) << target;
        EXPECT_NE(html.find("id=\"" + target.substr(1) + "\""), std::string::npos) << target;
    }
    EXPECT_EQ(html.find("{{"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Runs, EveryPage,
                         testing::Values(sample::Options{}, sample::Options{.certified = false},
                                         sample::Options{.second_receiver = true},
                                         sample::Options{.vertical = false, .georeferenced = false},
                                         sample::Options{.gap_every_s = 7}));

TEST(ReportHtml, PutsTheVerdictFirst) {
    const std::string text = visible_text(page({}, a_signature));
    const std::size_t verdict = text.find("Measured speed exceeds the record");
    ASSERT_NE(verdict, std::string::npos);
    EXPECT_LT(verdict, text.find("“Salt Runner”, land-yacht"));
    EXPECT_LT(verdict, text.find("Requirements of the rules"));
    EXPECT_NE(text.find("216.00 km/h ± 0.019 km/h"), std::string::npos);
    EXPECT_NE(text.find("Expanded uncertainty (k = 2)"), std::string::npos);
}

TEST(ReportHtml, ARefusedRunLooksDifferentInWordAndColour) {
    const std::string html = page({.certified = false}, a_signature);
    EXPECT_NE(html.find("Not certifiable"), std::string::npos);
    EXPECT_NE(html.find("<tbody class=\"mark-refused\">"), std::string::npos);
    EXPECT_EQ(html.find("Measured speed exceeds"), std::string::npos);
    sample::Run alone = sample::with_one_rule(sample::make_run({.certified = false}));
    EXPECT_NE(print_page(report_json(alone.inputs)).find("<p class=\"outcome_refused\">"),
              std::string::npos);
}

TEST(ReportHtml, WithoutASignatureEveryPageSaysSo) {
    const std::string html = page({}, {});
    EXPECT_NE(html.find("<div class=\"watermark\" aria-hidden=\"true\">"), std::string::npos);
    EXPECT_NE(html.find("<p class=\"warning unsigned\"><strong>Nobody has signed this report."),
              std::string::npos);
    EXPECT_NE(html.find("· UNSIGNED\""), std::string::npos);  // the foot of each page
}

TEST(ReportHtml, WithASignatureItNamesTheKey) {
    const std::string html = page({}, a_signature);
    EXPECT_EQ(html.find("UNSIGNED", html.find("</style>")), std::string::npos);
    EXPECT_EQ(html.find("· UNSIGNED\""), std::string::npos);
    EXPECT_NE(html.find(key_id_text(a_pair.public_key)), std::string::npos);
    EXPECT_NE(html.find("<th scope=\"row\"><bdi>measurer</bdi></th><td class=\"mono\">" +
                        key_id_text(a_pair.public_key)),
              std::string::npos);
}

/// Without what lets a line end within a word.
std::string without_line_ends(std::string html) {
    for (const std::string mark : {"<wbr>", "<span>", "\u200B</span>"})
        for (std::size_t at = html.find(mark); at != std::string::npos; at = html.find(mark, at))
            html.erase(at, mark.size());
    return html;
}

TEST(ReportHtml, WhatPeopleWroteStaysText) {
    std::string place;
    for (int i = 0; i < 3000; ++i)
        place += "x\xC3\xA9&";
    std::string shown = place;
    for (std::size_t at = shown.find('&'); at != std::string::npos; at = shown.find('&', at + 1))
        shown.insert(at + 1, "amp;");
    const std::string html = page(
        {.craft = "<script>alert(\"1\")</script> 'a' & =cmd() {{report_id}} \xF0\x9F\x9A\x80\a",
         .place = place},
        signed_with("<b>\"comment\"</b>"));
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_EQ(html.find("<b>"), std::string::npos);
    EXPECT_EQ(html.find('\a'), std::string::npos);
    EXPECT_NE(html.find("&lt;script&gt;alert(&apos;1&apos;)&lt;/script&gt; &apos;a&apos; &amp; "
                        "=cmd() {{report_id}} \xF0\x9F\x9A\x80"),
              std::string::npos);
    EXPECT_NE(without_line_ends(html).find(shown), std::string::npos);
}

TEST(ReportHtml, FiguresStandInThePage) {
    Json report = report_json(sample::make_run().inputs);
    for (Json& section : report["predicate"]["document"]["sections"])
        for (Json& block : section["blocks"])
            if (block.contains("plots")) block["plots"][0]["plot_title"] = "A & \"B\"";
    const std::string html = print_page(report);
    EXPECT_NE(html.find("<strong>A &amp; &quot;B&quot;.</strong>"), std::string::npos);
    EXPECT_EQ(html.find("A & \"B\""), std::string::npos);
}

// Each figure of the report stands in one place of the document, by its own title.
TEST_P(EveryPage, PlacesEveryFigureOnce) {
    const Json report = report_json(sample::make_run(GetParam()).inputs);
    const Json& figures = report["predicate"]["figures"];
    std::vector<int> places(figures.size());
    for (const Json& section : report["predicate"]["document"]["sections"])
        for (const Json& block : section["blocks"])
            for (const Json& plot : block.value("plots", Json::array())) {
                const std::size_t index = plot["plot"];
                ASSERT_LT(index, figures.size());
                EXPECT_EQ(plot["plot_title"], figures[index]["figure_title"]);
                EXPECT_EQ(plot.value("caption", ""), figures[index]["caption"]);
                ++places[index];
            }
    EXPECT_EQ(places, std::vector<int>(figures.size(), 1));
}

// What the page checks itself with: every byte of report.json, and the signatures.
TEST(ReportHtml, TheScreensPageCarriesTheReportByteForByte) {
    const Json report = report_json(
        sample::make_run({.craft = "</script><!-- & \xE2\x80\xAE", .place = "a\nb"}).inputs);
    const std::string html = screen_page(report, a_signature);
    EXPECT_EQ(between(html, "id=\"report-json\">", "</script>"), report_text_of(report));
    const Json files = Json::parse(between(html, "id=\"signature-files\">", "</script>"));
    EXPECT_EQ(files.at(0).at("text"), a_signature[0].text);
    EXPECT_EQ(between(html, "<main id=\"report\">", "</main>"),
              between(print_page(report, a_signature), "<main id=\"report\">", "</main>"));
}

// The browser runs the page's own script and no other, and loads nothing.
TEST(ReportHtml, ThePolicyNamesTheScriptByItsHash) {
    const auto report = report_json(sample::make_run().inputs);
    const std::string html = screen_page(report);
    const std::string script = between(html, "<script id=\"page-script\">", "</script>");
    EXPECT_GT(script.size(), 1000U);
    EXPECT_EQ(report["predicate"]["page"]["script_sha256"], sha256_hex(script));
    EXPECT_EQ(report["predicate"]["page"]["style_sha256"],
              sha256_hex(between(html, "<style>", "</style>")));
    EXPECT_EQ(between(html, "script-src 'sha256-", "'"), base64_of_hex(sha256_hex(script)));
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(ReportText, LooksTheSameToAJsonReaderAndHoldsNothingThatEndsAScript) {
    const Json json{{"a<b", {1, 2.5, nullptr}},
                    {"c", {{"d", "</script>&\xC3\xA9"}}},
                    {"e", Json::array()},
                    {"f", {"x", 1}},
                    {"g", Json::object()}};
    const std::string text = report_text_of(json);
    EXPECT_EQ(Json::parse(text), json);
    EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
    EXPECT_NE(text.find("[1,2.5,null]"), std::string::npos);
    EXPECT_TRUE(text.ends_with("}\n"));
}

TEST(ReportSigner, IsReadFromASignatureFile) {
    const KeyPair pair = generate_key_pair();
    const ReportSigner signer = read_signer(
        {.name = "r.minisig", .text = sign("text", pair.secret_key, "runcert role=measurer a=b")});
    EXPECT_EQ(signer.key_id, key_id_text(pair.public_key));
    EXPECT_EQ(signer.role, "measurer");
    EXPECT_EQ(signer.file, "r.minisig");
    for (const char* text :
         {"", "a\nb\nc\nd\n", "untrusted comment: a\nAAAA\ntrusted comment: b\nc"})
        EXPECT_THROW(read_signer({.name = "r.minisig", .text = text}), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

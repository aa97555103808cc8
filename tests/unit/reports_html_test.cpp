#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "core/failure.h"
#include "files/signature.h"
#include "reports/report_html.h"
#include "reports/report_json.h"
#include "reports_sample.h"

namespace runcert {
namespace {

const std::vector<ReportSigner> a_signer{{"9F3C5B7A11D04E62", "role=measurer"}};

std::string page(const sample::Options& options, const std::vector<ReportSigner>& signers) {
    return report_html(report_json(sample::make_run(options).inputs), {}, signers);
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
    const std::string body = html.substr(html.find("<body>"));
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
    const nlohmann::ordered_json report = report_json(sample::make_run(GetParam()).inputs);
    const std::set<std::string> known = numbers_of(report_text_of(report));
    const std::set<std::string> shown = numbers_of(visible_text(report_html(report, {}, {})));
    EXPECT_GT(shown.size(), 60U);
    for (const std::string& number : shown)
        EXPECT_TRUE(known.contains(number)) << number;
}

TEST_P(EveryPage, HoldsEveryHashWhole) {
    const sample::Run run = sample::make_run(GetParam());
    const std::string html = report_html(report_json(run.inputs), {}, {});
    for (const ReportSubject& subject : run.inputs.subjects)
        EXPECT_NE(html.find("<code>" + subject.sha256 + "</code>"), std::string::npos);
}

TEST_P(EveryPage, IsSelfContained) {
    const std::string html = page(GetParam(), {});
    for (const char* outside : {"<script", "http://", "https://", " src=", " href=", "@import"})
        EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    EXPECT_EQ(html.find("{{"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Runs, EveryPage,
                         testing::Values(sample::Options{}, sample::Options{.certified = false},
                                         sample::Options{.second_receiver = true},
                                         sample::Options{.vertical = false, .georeferenced = false},
                                         sample::Options{.gap_every_s = 7},
                                         sample::Options{.earlier_revision = true},
                                         sample::Options{.revision_1_1 = true},
                                         sample::Options{.verdict_1_0 = true}));

TEST(ReportHtml, PutsTheVerdictFirst) {
    const std::string text = visible_text(page({}, a_signer));
    const std::size_t verdict = text.find("Record beaten");
    ASSERT_NE(verdict, std::string::npos);
    EXPECT_LT(verdict, text.find("The attempt"));
    EXPECT_NE(text.find("216.00 ± 0.019 km/h"), std::string::npos);
    EXPECT_NE(text.find("216.009 ± 0.018 km/h"), std::string::npos);
}

TEST(ReportHtml, ARefusedRunLooksDifferentInWordAndColour) {
    const std::string html = page({.certified = false}, a_signer);
    EXPECT_NE(html.find("Not certifiable"), std::string::npos);
    EXPECT_NE(html.find("class=\"verdict tone-refused\""), std::string::npos);
    EXPECT_EQ(html.find("Record beaten"), std::string::npos);
}

TEST(ReportHtml, WithoutASignatureEveryPageSaysSo) {
    const std::string html = page({}, {});
    EXPECT_NE(html.find("<div class=\"watermark\" aria-hidden=\"true\">UNSIGNED</div>"),
              std::string::npos);
    EXPECT_NE(html.find("class=\"banner\""), std::string::npos);
    EXPECT_NE(html.find("· UNSIGNED\""), std::string::npos);  // the foot of each page
}

TEST(ReportHtml, WithASignatureItNamesTheKey) {
    const std::string html = page({}, a_signer);
    EXPECT_EQ(html.find("UNSIGNED"), std::string::npos);
    EXPECT_NE(html.find("9F3C5B7A11D04E62"), std::string::npos);
    EXPECT_NE(html.find("role=measurer"), std::string::npos);
}

std::string without_line_ends(std::string html) {
    for (std::size_t at = html.find("<wbr>"); at != std::string::npos; at = html.find("<wbr>", at))
        html.erase(at, 5);
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
        {{"KEY", "<b>\"comment\"</b>"}});
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_EQ(html.find("<b>"), std::string::npos);
    EXPECT_EQ(html.find('\a'), std::string::npos);
    EXPECT_NE(html.find("&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &apos;a&apos; &amp; "
                        "=cmd() {{report_id}} \xF0\x9F\x9A\x80"),
              std::string::npos);
    EXPECT_NE(without_line_ends(html).find(shown), std::string::npos);
}

TEST(ReportHtml, FiguresStandInThePage) {
    const auto report = report_json(sample::make_run().inputs);
    const std::string html =
        report_html(report, {{.title = "A & B", .caption = "C", .svg = "<svg>1</svg>"}}, {});
    EXPECT_NE(html.find("<svg>1</svg>"), std::string::npos);
    EXPECT_NE(html.find("A &amp; B"), std::string::npos);
}

TEST(ReportSigner, IsReadFromASignatureFile) {
    const KeyPair pair = generate_key_pair();
    const ReportSigner signer =
        read_signer(sign("text", pair.secret_key, "role=measurer", "of a report"), "r.minisig");
    EXPECT_EQ(signer.key_id, key_id_text(pair.public_key));
    EXPECT_EQ(signer.trusted_comment, "role=measurer");
    for (const char* text :
         {"", "a\nb\nc\nd\n", "untrusted comment: a\nAAAA\ntrusted comment: b\nc"})
        EXPECT_THROW(read_signer(text, "r.minisig"), Failure);
}

}  // namespace
}  // namespace runcert

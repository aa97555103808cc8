#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/prose.h"
#include "core/text.h"
#include "reports/document/document_html.h"
#include "reports/document/document_text.h"
#include "store/atomic_file.h"
#include "store/process.h"

// What people are shown, as text and as HTML.

namespace runcert::RUNCERT_FILE {
namespace {

Block budget() {
    Block budget = table({"source", ">u, km/h", "type"}, "Budget");
    add_row(budget, {"noise", "0.0037", "A"});
    add_row(budget, {"drift", "12.1", "B"}, "total").further = {"what screening left",
                                                                "drifts included"};
    return budget;
}

Block notes() {
    Block notes = list_of({"a gap"});
    notes.text = "Noticed";
    return notes;
}

const Document small{
    .title = "Audit of the attempt small",
    .sections = {{.anchor = "run",
                  .title = "The run",
                  .blocks = {facts({{"Craft", "yacht"}, {"A longer name", "1"}}), budget(),
                             paragraph("All of them.")}},
                 {.anchor = "import",
                  .title = "1. import",
                  .blocks = {list_of({"line 3: cut short", "line 9: no number"}), notes(),
                             heading("Rule nalsa"), facts({{"Best", "none, because"}}),
                             list_of({"a step"}, "apart")}}}};

TEST(DocumentText, IsAsWritten) {
    EXPECT_EQ(document_text(small, 80),
              "Audit of the attempt small\n"
              "==========================\n"
              "\n"
              "The run\n"
              "-------\n"
              "Craft          yacht\n"
              "A longer name  1\n"
              "\n"
              "Budget:\n"
              "source  u, km/h  type\n"
              "noise    0.0037  A\n"
              "drift      12.1  B\n"
              "    what screening left\n"
              "    drifts included\n"
              "\n"
              "All of them.\n"
              "\n"
              "1. import\n"
              "---------\n"
              "- line 3: cut short\n"
              "- line 9: no number\n"
              "\n"
              "Noticed:\n"
              "- a gap\n"
              "\n"
              "Rule nalsa\n"
              "Best  none, because\n"
              "  - a step\n");
}

std::string text_of(Block block, std::size_t columns) {
    return section_text({.anchor = "s", .blocks = {std::move(block)}}, columns);
}

const std::string sentences =
    "The expanded uncertainty of the speed is twice the combined standard uncertainty of its "
    "budget.";

TEST(DocumentText, LinesAreBrokenAtTheColumnsAskedFor) {
    EXPECT_EQ(text_of(paragraph(sentences), 80),
              "The expanded uncertainty of the speed is twice the combined standard uncertainty\n"
              "of its budget.\n");
    EXPECT_EQ(text_of(paragraph(sentences), 40),
              "The expanded uncertainty of the speed is\n"
              "twice the combined standard uncertainty\n"
              "of its budget.\n");
    EXPECT_EQ(text_of(facts({{"U", sentences}}), 40),
              "U  The expanded uncertainty of the speed\n"
              "   is twice the combined standard\n"
              "   uncertainty of its budget.\n");
    // A word that fits in a line is whole.
    EXPECT_EQ(text_of(facts({{"Hash", std::string(36, 'a')}, {"b", "c"}, {"d", ""}}), 40),
              "Hash\n    " + std::string(36, 'a') + "\nb     c\nd\n");
    EXPECT_EQ(text_of(list_of({sentences}), 40),
              "- The expanded uncertainty of the speed\n"
              "  is twice the combined standard\n"
              "  uncertainty of its budget.\n");
    // The last column takes what is left, if that is enough to read.
    Block wide = table({">no.", "text"});
    add_row(wide, {"1", sentences}).further = {sentences};
    EXPECT_EQ(text_of(wide, 40),
              "no.  text\n"
              "  1  The expanded uncertainty of the\n"
              "     speed is twice the combined\n"
              "     standard uncertainty of its budget.\n"
              "    The expanded uncertainty of the\n"
              "    speed is twice the combined standard\n"
              "    uncertainty of its budget.\n");
}

TEST(DocumentText, ATableThatIsTooWideIsAList) {
    Block files = table({"file", "hash", ">bytes"}, "Files");
    add_row(files, {std::string(30, 'f'), std::string(40, 'a'), "7"}).further = {"handed in"};
    add_row(files, {"g", "", "12"});
    EXPECT_EQ(text_of(files, 90),
              fmt::format("Files:\n{:<32}{:<42}bytes\n{:<32}{:<42}    7\n    handed in\n{:<77}12\n",
                          "file", "hash", std::string(30, 'f'), std::string(40, 'a'), "g"));
    EXPECT_EQ(text_of(files, 60), "Files:\n" + std::string(30, 'f') + ": hash\n    " +
                                      std::string(40, 'a') + "; bytes 7\n    handed in\n" +
                                      "g: bytes 12\n");
}

TEST(DocumentText, FiguresStandRightUnderTheirHead) {
    Block speeds = table({"method", ">speed", "by", ">error"});
    add_row(speeds, {"smoother", "216.00", "d/T", "-0.02"});
    add_row(speeds, {"v1", "9.1", "N", "1.5"});
    add_row(speeds, {"v2", "-", "N", ""});
    EXPECT_EQ(text_of(speeds, 80),
              "method     speed  by   error\n"
              "smoother  216.00  d/T  -0.02\n"
              "v1           9.1  N      1.5\n"
              "v2             -  N\n");
}

/// What a person may write into a name, and what must not come of it.
const std::string hostile =
    "<script>alert(1)</script> \"quoted\" 'single' & {{craft}} {{{craft}}} ]]> \x1b[31m \x07 line\n"
    "two \xE2\x80\xAE gnp.exe \xC2\x9B 5m \xFF\xFE =cmd() \xF0\x9F\x9B\xA5";

/// A document with a block of every kind, and the same text wherever a text may stand.
Document document_of(const std::string& text) {
    Block cells = table({text, ">" + text}, text);
    add_row(cells, {text, text}, "not_met").further = {text, text};
    Block titled = list_of({text, text});
    titled.text = text;
    Block marked = paragraph(text, "warning");
    marked.sign = text;
    return {.title = text,
            .subtitle = text,
            .sections = {{.anchor = "a",
                          .title = text,
                          .blocks = {paragraph(text),
                                     marked,
                                     heading(text),
                                     titled,
                                     list_of({text}, "apart"),
                                     facts({{text, text}}, text),
                                     cells,
                                     {.kind = BlockKind::headline, .text = text, .beside = text},
                                     plot(0, text, text),
                                     code(text),
                                     {.kind = BlockKind::signers},
                                     {.kind = BlockKind::check, .text = text}}}}};
}

/// No line is longer than the columns, but for what is to be copied and typed, `code`.
void expect_lines_within(const std::string& text, std::size_t columns, const std::string& code) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line == "    " + code) continue;
        EXPECT_LE(characters_in(line), columns) << line.substr(0, 200);
        EXPECT_FALSE(line.ends_with(' ')) << line.substr(0, 200);
    }
}

TEST(DocumentText, NoLineOfAnyBlockIsTooLong) {
    std::string words = "w";
    for (int i = 0; i < 60; ++i)
        words += " w\xC3\xB6rter";
    for (const std::size_t columns : {40U, 80U, 120U})
        for (const std::string& text : {words, std::string(10'000, 'w'), std::string("w")})
            expect_lines_within(document_text(document_of(text), columns), columns, text);
}

TEST(DocumentText, HostileTextSteersNoTerminal) {
    const std::string text = document_text(document_of(hostile), 80);
    for (const char c : text)
        EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ') << int{c};
    EXPECT_EQ(text.find("\xE2\x80\xAE"), std::string::npos);
    EXPECT_EQ(plain_text(hostile), plain_text(plain_text(hostile)));
    // Its lines are its own, and set in.
    EXPECT_EQ(text_of(code("a\nVERIFIED"), 80), "    a\n    VERIFIED\n");
}

TEST(PlainText, KeepsLettersAndTakesOutWhatSteers) {
    EXPECT_EQ(plain_text("Kr\xC3\xBCger \xF0\x9F\x9B\xA5 0.5 \xC2\xB5m"),
              "Kr\xC3\xBCger \xF0\x9F\x9B\xA5 0.5 \xC2\xB5m");
    const std::string mark = "\xEF\xBF\xBD";
    EXPECT_EQ(plain_text("a\nb\tc\rd"), "a b c d");
    EXPECT_EQ(plain_text("\x1b[31m"), mark + "[31m");
    EXPECT_EQ(plain_text(std::string("a\0b", 3)), "a" + mark + "b");
    EXPECT_EQ(plain_text("\xE2\x80\xAEx\xE2\x81\xA6y\xC2\x9Bz"),
              mark + "x" + mark + "y" + mark + "z");
    EXPECT_EQ(plain_text("\xFF"), mark);
    EXPECT_EQ(plain_text("\xC0\xAF"), mark + mark);             // an overlong "/"
    EXPECT_EQ(plain_text("\xED\xA0\x80"), mark + mark + mark);  // half of a surrogate pair
    EXPECT_EQ(plain_text("\xE2\x82"), mark + mark);             // cut short
}

/// What another program, xmllint, finds in a page by an XPath expression.
std::string found_in(const std::string& html, const std::string& xpath) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "page.html", html);
    const ProcessResult result = run_process(
        {"xmllint", "--nonet", "--xpath", xpath, (folder.path() / "page.html").string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return result.output.substr(0, result.output.find_last_not_of('\n') + 1);
}

std::string text_at(const std::string& html, const std::string& element) {
    return found_in(html, fmt::format("string(//*[local-name()='{}])", element));
}

class DocumentHtml : public testing::Test {
  protected:
    void SetUp() override {
        if (run_process({"sh", "-c", "command -v xmllint"}).exit_status != 0)
            GTEST_SKIP() << "xmllint is not installed";
    }
};

TEST_F(DocumentHtml, IsWellFormedAndHoldsWhatTheTextHolds) {
    const std::string html = document_page(small);
    EXPECT_EQ(text_at(html, "h1'"), "Audit of the attempt small");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='h2'])"), "2");
    EXPECT_EQ(text_at(html, "h3'"), "Rule nalsa");
    EXPECT_EQ(text_at(html, "caption'"), "Budget");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='th'][@scope='col'])"), "3");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='th'][@scope='row'])"), "2");
    EXPECT_EQ(text_at(html, "td'][2"), "A");
    EXPECT_EQ(text_at(html, "dt'"), "Craft");
    EXPECT_EQ(text_at(html, "dd'"), "yacht");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='main']//*[local-name()='li'])"), "4");
    // The contents lead to the sections.
    EXPECT_EQ(found_in(html,
                       "count(//*[local-name()='a'][substring(@href, 2) = "
                       "//*[local-name()='section']/@id])"),
              "2");
}

TEST_F(DocumentHtml, FiguresStandRightAndFurtherLinesBeneathTheWholeRow) {
    const std::string html = document_page(small);
    EXPECT_EQ(found_in(html, "count(//*[local-name()='tbody']//*[@class='number'])"), "2");
    EXPECT_EQ(text_at(html, "td'][@class='number'"), "0.0037");
    EXPECT_NE(document_style().find(".number { text-align: right"), std::string_view::npos);
    EXPECT_EQ(found_in(html, "string(//*[@class='further']/*/@colspan)"), "3");
    EXPECT_EQ(found_in(html, "count(//*[@class='further']//*[local-name()='span'])"), "2");
    EXPECT_EQ(found_in(html, "count(//*[@class='mark-total'])"), "1");
}

TEST_F(DocumentHtml, HostileTextIsShownAsText) {
    const std::string html = document_page(document_of(hostile), {.plots = {{.title = hostile}}});
    EXPECT_EQ(found_in(html, "count(//*[local-name()='script'])"), "0");
    for (const char* element :
         {"h1'", "h2'", "h3'", "p'", "p'][@class='subtitle'", "dt'", "dd'", "caption'", "td'",
          "th'][@scope='row'", "li'][not(*[local-name()='a'])", "small'", "bdi'"})
        EXPECT_EQ(text_at(html, element), plain_text(hostile)) << element;
    // The lines of what a person types stay lines.
    std::string typed = text_at(html, "pre'");
    std::ranges::replace(typed, '\n', ' ');
    EXPECT_EQ(typed, plain_text(hostile));
    EXPECT_NE(text_at(html, "figcaption'").find(plain_text(hostile)), std::string::npos);
    for (const char* piece : {"\x1b", "\xE2\x80\xAE", "{{craft}}<"})
        EXPECT_EQ(html.find(piece), std::string::npos) << piece;
}

/// What is filled in when a page is drawn comes from elsewhere, too.
TEST_F(DocumentHtml, HostileSignersAreShownAsText) {
    const nlohmann::ordered_json beside{
        {"signed", true},
        {"signers", {{{"role", hostile}, {"key_id", hostile}, {"signed_at", hostile}}}},
        {"missing_signatures", {{{"missing_count", "1"}, {"missing_role", hostile}}}},
        {"report_sha256", hostile}};
    for (const Medium medium : {Medium::screen, Medium::paper}) {
        const std::string html = "<main>" +
                                 sections_html(members_json(document_of(hostile)), beside, medium) +
                                 "</main>";
        EXPECT_EQ(found_in(html, "count(//script)"), "0");
        EXPECT_EQ(found_in(html, "string(//table[@class='signers']//th[@scope='row'])"),
                  plain_text(hostile));
        EXPECT_NE(found_in(html, "string(//p[@class='caution'])").find(plain_text(hostile)),
                  std::string::npos);
        EXPECT_EQ(found_in(html, "string(//p[@class='mono small'])"),
                  "SHA-256 of report.json: " + plain_text(hostile));
    }
}

TEST_F(DocumentHtml, AVeryLongWordIsWholeAndTheSameTwice) {
    const std::string word(10'000, 'w');
    const std::string html = document_page(document_of(word), {.plots = {{.title = word}}});
    EXPECT_EQ(html, document_page(document_of(word), {.plots = {{.title = word}}}));
    EXPECT_EQ(text_at(html, "h1'"), word);
    // Nothing is fetched from elsewhere.
    EXPECT_EQ(found_in(html,
                       "count(//@src | //*[local-name()='link'] | "
                       "//@href[not(starts-with(., '#'))])"),
              "0");
    EXPECT_EQ(html.find("url("), std::string::npos);
    EXPECT_EQ(html.find("@import"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/text.h"
#include "reports/audit/walk.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

const Walk small{
    .title = "Audit of the attempt small",
    .sections = {
        {.title = "The run",
         .blocks = {Facts{{{"Craft", "yacht"}, {"A longer name", "1"}}},
                    FactTable{.caption = "Came in",
                              .heads = {"as", "file", "bytes"},
                              .rows = {{"recording", "a.pos", "12"}, {"base", "b.obs", ""}}},
                    Paragraph{"All of them."}}},
        {.title = "1. import",
         .blocks = {Entries{.items = {"line 3: cut short", "line 9: no number"}}},
         .parts = {{.title = "Rule nalsa",
                    .blocks = {Paragraph{"Refused, because"},
                               Entries{.items = {"a step"}, .nested = true}}}}}}};

TEST(WalkText, IsAsWritten) {
    EXPECT_EQ(walk_text(small),
              "Audit of the attempt small\n"
              "==========================\n"
              "\n"
              "The run\n"
              "-------\n"
              "Craft          yacht\n"
              "A longer name  1\n"
              "\n"
              "Came in:\n"
              "as         file   bytes\n"
              "recording  a.pos  12\n"
              "base       b.obs\n"
              "\n"
              "All of them.\n"
              "\n"
              "1. import\n"
              "---------\n"
              "line 3: cut short\n"
              "line 9: no number\n"
              "\n"
              "Rule nalsa\n"
              "Refused, because\n"
              "    a step\n");
}

Walk long_walk() {
    const std::string words(10, 'x');
    std::string text;
    for (int i = 0; i < 60; ++i)
        text += words + " ";
    const std::string one_word(10'000, 'w');
    return {
        .title = one_word,
        .sections = {
            {.title = text,
             .blocks = {Facts{{{one_word, one_word}, {"b", text}}},
                        FactTable{.caption = text,
                                  .heads = {"a", "b", "c"},
                                  .rows = {{"1", "2", text}, {"1", "2", one_word}}},
                        FactTable{.caption = {}, .heads = {"a", "b"}, .rows = {{one_word, text}}},
                        Entries{.items = {text, one_word}},
                        Entries{.items = {text, one_word}, .nested = true}}}}};
}

TEST(WalkText, NoLineIsLongerThanAHundredColumns) {
    std::istringstream lines(walk_text(long_walk()));
    for (std::string line; std::getline(lines, line);)
        EXPECT_LE(line.size(), 100U) << line;
}

TEST(WalkText, ATableThatIsTooWideIsAList) {
    const Section section{
        .title = "t",
        .blocks = {FactTable{.caption = "c",
                             .heads = {"file", "hash", "bytes"},
                             .rows = {{std::string(60, 'f'), std::string(64, 'a'), "7"}}}}};
    EXPECT_EQ(section_text(section), "t\n-\nc:\n" + std::string(60, 'f') + ": hash\n    " +
                                         std::string(64, 'a') + "; bytes 7\n");
}

/// What a person may write into a name, and what must not come of it.
const std::string hostile =
    "<script>alert(1)</script> \"quoted\" 'single' & {{craft}} {{{craft}}} ]]> \x1b[31m \x07 line\n"
    "two \xE2\x80\xAE gnp.exe \xC2\x9B 5m \xFF\xFE =cmd() \xF0\x9F\x9B\xA5";

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
    EXPECT_EQ(plain_text(plain_text(hostile)), plain_text(hostile));
}

Walk hostile_walk() {
    return {.title = hostile,
            .sections = {{.title = hostile,
                          .blocks = {Paragraph{hostile}, Entries{.items = {hostile}},
                                     Facts{{{hostile, hostile}}},
                                     FactTable{.caption = hostile,
                                               .heads = {hostile, hostile},
                                               .rows = {{hostile, hostile}}}},
                          .parts = {{.title = hostile, .blocks = {Paragraph{hostile}}}}}}};
}

TEST(WalkText, HostileTextSteersNoTerminal) {
    for (const char c : walk_text(hostile_walk()))
        EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ') << int{c};
    EXPECT_EQ(walk_text(hostile_walk()).find("\xE2\x80\xAE"), std::string::npos);
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

bool has_xmllint() {
    return run_process({"sh", "-c", "command -v xmllint"}).exit_status == 0;
}

TEST(WalkHtml, IsWellFormedAndHoldsWhatTheTextHolds) {
    if (!has_xmllint()) GTEST_SKIP() << "xmllint is not installed";
    const std::string html = walk_html(small);
    const auto text = [&](const std::string& path) {
        return found_in(html, "string(//*[local-name()='" + path + ")");
    };
    EXPECT_EQ(text("h1']"), "Audit of the attempt small");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='h2'])"), "2");
    EXPECT_EQ(text("h3']"), "Rule nalsa");
    EXPECT_EQ(text("caption']"), "Came in");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='th'][@scope='col'])"), "3");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='th'][@scope='row'])"), "2");
    EXPECT_EQ(text("td'][2]"), "12");
    EXPECT_EQ(text("dt']"), "Craft");
    EXPECT_EQ(text("dd']"), "yacht");
    EXPECT_EQ(found_in(html, "count(//*[local-name()='li'][not(*)])"), "3");
    // The contents lead to the sections.
    EXPECT_EQ(found_in(html,
                       "count(//*[local-name()='a'][substring(@href, 2) = "
                       "//*[local-name()='section']/@id])"),
              "2");
}

TEST(WalkHtml, HostileTextIsShownAsText) {
    if (!has_xmllint()) GTEST_SKIP() << "xmllint is not installed";
    const std::string html = walk_html(hostile_walk());
    EXPECT_EQ(found_in(html, "count(//*[local-name()='script'])"), "0");
    for (const char* element : {"h1", "h2", "h3", "p", "dt", "dd", "caption", "td"})
        EXPECT_EQ(found_in(html, fmt::format("string(//*[local-name()='{}'])", element)),
                  plain_text(hostile))
            << element;
    EXPECT_EQ(found_in(html, "string(//*[local-name()='ul']/*[local-name()='li'])"),
              plain_text(hostile));
}

TEST(WalkHtml, AVeryLongWordIsWholeAndTheSameTwice) {
    if (!has_xmllint()) GTEST_SKIP() << "xmllint is not installed";
    const std::string html = walk_html(long_walk());
    EXPECT_EQ(html, walk_html(long_walk()));
    EXPECT_EQ(found_in(html, "string(//*[local-name()='h1'])"), std::string(10'000, 'w'));
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

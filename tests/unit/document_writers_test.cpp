#include <gtest/gtest.h>

#include "core/failure.h"
#include "reports/document/document_html.h"
#include "reports/document/document_text.h"
#include "store/atomic_file.h"
#include "store/process.h"

// Blocks as text and as HTML: what a person copies stays as it is, and a link leads nowhere else.

namespace runcert::RUNCERT_FILE {
namespace {

Document of(std::vector<Block> blocks) {
    return {.title = "a title", .sections = {{.anchor = "all", .blocks = std::move(blocks)}}};
}

std::string html_of(std::vector<Block> blocks) {
    return sections_html(members_json(of(std::move(blocks))));
}

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Code, KeepsItsLines) {
    const Block block = code("format: csv\ncolumns: {time: t, latitude: <b>}\n");
    EXPECT_EQ(document_text(of({paragraph("Write:"), block, paragraph("Then.")}), 20),
              "a title\n=======\n\nWrite:\n\n    format: csv\n"
              "    columns: {time: t, latitude: <b>}\n\nThen.\n");
    const std::string html = html_of({block});
    EXPECT_TRUE(holds(html, "<pre>format: csv\ncolumns: {time: t, latitude: &lt;b&gt;}\n</pre>"))
        << html;
}

TEST(List, WithATitleStandsApart) {
    Block list = list_of({"one", "two"});
    list.text = "Why";
    EXPECT_EQ(document_text({.sections = {{.blocks = {paragraph("Said."), list}}}}, 80),
              "Said.\n\nWhy:\n- one\n- two\n");
}

TEST(Link, LeadsToAFileBesideThePageAlone) {
    EXPECT_EQ(link_to("a run/report.html"), "a%20run/report.html");
    EXPECT_EQ(link_to("javascript:alert(1)"), "javascript%3Aalert%281%29");
    EXPECT_EQ(link_to("a\"><script>"), "a%22%3E%3Cscript%3E");
    EXPECT_EQ(link_to("a?b#c&d"), "a%3Fb%23c%26d");
    for (const char* elsewhere : {"/etc/passwd", "//example.org/x"})
        EXPECT_EQ(link_to(elsewhere), "") << elsewhere;
    EXPECT_EQ(link_to(std::string(401, 'w')), "");
}

TEST(Link, OfAFactAndOfARowIsEscaped) {
    Block named = facts({});
    add_fact(named, "Figures", "day <1>", "day \"1\".yaml");
    Block rows = table({"Attempt", "Rank"});
    add_row(rows, {"heat", "1"}).link = "heat/report.html";
    add_row(rows, {"other", "2"}).link = "//example.org/report.html";
    const std::string html = html_of({named, rows});
    EXPECT_TRUE(holds(html, "<dd><a href=\"day%20%221%22.yaml\"><bdi>day &lt;1&gt;</bdi></a></dd>"))
        << html;
    EXPECT_TRUE(holds(html, "<a href=\"heat/report.html\"><bdi>heat</bdi></a></th>")) << html;
    EXPECT_TRUE(holds(html, "<bdi>other</bdi></th>")) << html;
    EXPECT_FALSE(holds(html, "example.org")) << html;
    // Beside a link nothing is one.
    EXPECT_TRUE(holds(html, "<td data-label=\"Rank\"><bdi>1</bdi></td>")) << html;
}

TEST(Page, HoldsItsImagesAndRunsItsScriptAlone) {
    const Document document = of({plot(1, "Speeds", "as drawn")});
    const std::string page =
        document_page(document, {.style = "b { color: red }",
                                 .script = "if (1 < 2 && 2 > 1) document.title = 'x';\n",
                                 .plots = {{.title = "no"}, {.title = "yes"}}});
    EXPECT_TRUE(holds(page, "<div class=\"drawing\"><svg ")) << page;
    EXPECT_TRUE(holds(page, "aria-label=\"yes\""));
    EXPECT_FALSE(holds(page, "aria-label=\"no\""));
    EXPECT_THROW((void)document_page(document, {.plots = {{.title = "no"}}}), Failure);
    EXPECT_TRUE(holds(page, "b { color: red }</style>"));
    const TemporaryFolder folder;
    const std::size_t begin = page.find("<script>") + 8;
    write_file_atomically(folder.path() / "script",
                          page.substr(begin, page.find("</script>") - begin));
    const ProcessResult hash =
        run_process({"sh", "-c", "openssl dgst -sha256 -binary \"$0\" | base64",
                     (folder.path() / "script").string()});
    ASSERT_EQ(hash.output.size(), 45U) << hash.errors;
    EXPECT_TRUE(holds(page, "script-src 'sha256-" + hash.output.substr(0, 44) + "'"));
    // Well-formed XML, the script too.
    write_file_atomically(folder.path() / "page", page);
    const ProcessResult xml =
        run_process({"xmllint", "--noout", "--nonet", (folder.path() / "page").string()});
    EXPECT_EQ(xml.exit_status, 0) << xml.errors;
    const std::string without = document_page(of({paragraph("text")}));
    EXPECT_FALSE(holds(without, "<script"));
    EXPECT_FALSE(holds(without, "script-src"));
    EXPECT_TRUE(holds(without, "default-src 'none'"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

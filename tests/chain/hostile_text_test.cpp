#include <algorithm>
#include <regex>
#include <sstream>

#include "core/text.h"
#include "hostile_text_support.h"

// Text that people outside write: it is shown as text by whatever shows it, or refused.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The hostile attempt, certified once.
class HostileText : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        write_hostile_attempt(folder_->path() / "attempt");
        certified_ = certify(folder_->path() / "attempt" / "attempt.yaml", run());
        ASSERT_EQ(certified_.exit_status, 1) << certified_.errors;
    }
    static void TearDownTestSuite() { delete folder_; }
    static fs::path run() { return folder_->path() / "run"; }
    static std::string export_text(std::vector<std::string> more) {
        more.insert(more.begin(), {"export", run().string()});
        more.insert(more.end(), {"--out", "-"});
        const ProcessResult result = runcert(more);
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        EXPECT_EQ(steering_in(result.output), std::vector<std::string>{});
        return result.output;
    }

    static TemporaryFolder* folder_;
    static ProcessResult certified_;
};
TemporaryFolder* HostileText::folder_ = nullptr;
ProcessResult HostileText::certified_;

std::string without_blanks(std::string text) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\f'; });
    return text;
}

/// Whether a page shows these words as they are, or as quoted ones whose own quotation marks are
/// apostrophes.
bool holds_claimed(const std::string& shown, std::string words) {
    if (holds(shown, words)) return true;
    std::ranges::replace(words, '"', '\'');
    return holds(shown, words);
}

std::string found_in(const fs::path& page, const std::string& xpath) {
    const ProcessResult result = run_process(
        {"xmllint", "--huge", "--html", "--nowarning", "--xpath", xpath, page.string()});
    return result.output.substr(0, result.output.find_last_not_of('\n') + 1);
}

TEST_F(HostileText, IsTextOnThePage) {
    if (!has_program("xmllint")) GTEST_SKIP() << "xmllint is not installed";
    const fs::path page = run() / "report.html";
    const std::string main = found_in(page, "string(//main)");
    const std::string shown = without_blanks(main);
    EXPECT_EQ(steering_in(main), std::vector<std::string>{});
    for (const std::string& tag : tags)
        EXPECT_TRUE(holds_claimed(shown, without_blanks("cmd() " + tag + " " + markup + letters)))
            << tag;
    for (const std::string& tag : endless_tags)
        EXPECT_TRUE(holds(shown, tag + long_word)) << tag;
    EXPECT_TRUE(holds(shown, without_blanks(hostile_recording)));
    // No element or attribute came of it: what the page carries and its own script are its only
    // ones.
    EXPECT_EQ(found_in(page, "count(//script)"), "4");
    EXPECT_EQ(found_in(page, "count(//main//script | //b | //main//style | //@onmouseover)"), "0");
    EXPECT_EQ(found_in(page, "count(//title)"), "1");
    EXPECT_TRUE(holds(found_in(page, "string(//title)"), "Measurement report "));
}

TEST_F(HostileText, IsWithinTheMarginsOnPaper) {
    if (!has_program("pdftotext")) GTEST_SKIP() << "poppler-utils is not installed";
    const std::string pdf = (run() / "report.pdf").string();
    const ProcessResult text = run_process({"pdftotext", "-layout", pdf, "-"});
    const std::string words = without_blanks(text.output);
    // In the order of reading: a cell of a table may end a line between any two words.
    const std::string read = without_blanks(run_process({"pdftotext", pdf, "-"}).output);
    for (const std::string& tag : tags)
        EXPECT_TRUE(holds(read, "cmd()" + tag)) << tag;
    EXPECT_TRUE(holds_claimed(words, without_blanks("cmd() CRAFT " + markup)));
    std::string unbroken = text.output;
    std::ranges::replace(unbroken, '\f', '\n');  // pages
    // pdftotext itself puts two of them around Hebrew and Arabic.
    EXPECT_EQ(steering_in(unbroken), (std::vector<std::string>{"\u202B", "\u202C"}));
    // All letters of every long word are on paper, some of the words more than once.
    EXPECT_GE(std::ranges::count(words, 'W'),
              static_cast<std::ptrdiff_t>(endless_tags.size() * long_word.size()));
    const ProcessResult boxes = run_process({"pdftotext", "-bbox", pdf, "-"});
    static const std::regex box(
        "<word xMin=\"([-0-9.]+)\" yMin=\"([-0-9.]+)\" "
        "xMax=\"([-0-9.]+)\" yMax=\"([-0-9.]+)\"");
    constexpr double mm = 72.0 / 25.4, slack = 1.0;
    std::istringstream lines(boxes.output);
    std::ptrdiff_t count = 0;
    for (std::string line; std::getline(lines, line);) {
        std::smatch found;
        if (line.size() > 100) line.erase(line.find('>', 1) + 1);
        if (!std::regex_search(line, found, box)) continue;
        ++count;
        EXPECT_GE(std::stod(found[1]), 18 * mm - slack) << line;
        EXPECT_GE(std::stod(found[2]), 11 * mm - slack) << line;
        EXPECT_LE(std::stod(found[3]), (210 - 16) * mm + slack) << line;
        EXPECT_LE(std::stod(found[4]), 297 * mm) << line;
    }
    EXPECT_GT(count, 1000);
}

/// Nothing in it steers a terminal, and no line of it says what only the program says.
void expect_plain(const ProcessResult& result, const std::string& what) {
    for (const std::string& text : {result.output, result.errors}) {
        EXPECT_EQ(steering_in(text), std::vector<std::string>{}) << what;
        EXPECT_FALSE(text.starts_with("VERIFIED") || holds(text, "\nVERIFIED")) << what;
    }
}

TEST_F(HostileText, SteersNoTerminal) {
    expect_plain(certified_, "certify");
    const fs::path other = folder_->path() / "other";
    write_hostile_attempt(folder_->path() / "changed");
    const fs::path changed = folder_->path() / "changed" / "attempt.yaml";
    write_plainly(changed, replaced(read_file(changed), "cmd() CRAFT", "other CRAFT"));
    ASSERT_EQ(certify(changed, other, {"--no-render"}).exit_status, 1);
    // Without the PDF, which verify would make again.
    fs::copy(run(), folder_->path() / "pages", fs::copy_options::recursive);
    fs::remove(folder_->path() / "pages" / "report.pdf");
    const std::string a = (folder_->path() / "pages").string(), b = other.string();
    struct Call {
        std::vector<std::string> arguments;
        int exit_status;
        std::string shows;
    };
    const Call calls[] = {{{"verify", a}, 1, "judge"},
                          {{"verify", a, "--json"}, 1, "judge"},
                          {{"audit", a, "--all"}, 0, "cmd() CRAFT"},
                          {{"diff", a, b, "--all"}, 1, "other CRAFT"},
                          {{"diff", a, b, "--json"}, 1, "other CRAFT"},
                          {{"explain", a}, 0, "cmd() CLAUSETEXT"},
                          {{"explain", a, "decision"}, 0, "cmd() METHOD"},
                          {{"explain", a, "no \x1b[31m \u202E such clause"}, 2, "no clause"},
                          {{"compare", a}, 0, "own"}};
    for (const Call& call : calls) {
        const ProcessResult result = runcert(call.arguments);
        EXPECT_EQ(result.exit_status, call.exit_status) << call.arguments[0] << result.errors;
        expect_plain(result, call.arguments[0]);
        EXPECT_TRUE(holds(result.output + result.errors, call.shows)) << call.arguments[0];
    }
}

TEST_F(HostileText, OfARecordingSteersNoTerminal) {
    const fs::path file = folder_->path() / "a \x1b[31m\u202E\x9b name.gpx";
    std::string points;
    for (int second = 10; second < 40; ++second)
        points += fmt::format(
            "<trkpt lat=\"35.{:06}\" lon=\"137\"><time>2022-03-18T08:51:{}Z</time></trkpt>",
            second * 100, second);
    write_plainly(file,
                  "<gpx version=\"1.1\" creator=\"=cmd() MAKER &#x202e;&#x9b;31m &lt;b&gt;\">"
                  "<trk><trkseg>" +
                      points + "</trkseg></trk></gpx>");
    const ProcessResult result = runcert({"inspect", file.string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    expect_plain(result, "inspect");
    EXPECT_TRUE(holds(result.output, "=cmd() MAKER")) << result.output;
}

/// A clause whose name a shell would run is no command where it is pasted.
TEST_F(HostileText, IsNoCommandWherePasted) {
    const ProcessResult pasted =
        shell(folder_->path(), "PATH=" RUNCERT_PROGRAMS ":$PATH; runcert explain run " +
                                   shell_word("own/" + shell_clause));
    EXPECT_EQ(pasted.exit_status, 0) << pasted.errors;
    EXPECT_TRUE(holds(pasted.output, shell_clause)) << pasted.output;
    EXPECT_FALSE(fs::exists(folder_->path() / "owned"));
}

TEST_F(HostileText, IsTextInTablesAndOnMaps) {
    for (const char* table : {"observations", "enu", "screened", "trajectory"}) {
        std::istringstream rows(export_text({"--format", "csv", "--table", table}));
        static const std::regex number("-?[0-9]+([.][0-9]+)?(e[-+][0-9]+)?");
        for (std::string row; std::getline(rows, row);) {
            std::istringstream cells(row);
            for (std::string cell; std::getline(cells, cell, ',');) {
                if (std::string("=+-@\t").find(cell.substr(0, 1)) == std::string::npos) continue;
                ASSERT_TRUE(cell.empty() || std::regex_match(cell, number)) << table << cell;
            }
        }
    }
    const std::string map = export_text({"--format", "kml"});
    write_plainly(folder_->path() / "kml", map);
    const ProcessResult result =
        run_process({"xmllint", "--noout", (folder_->path() / "kml").string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_TRUE(holds(map, "document.title="));
}

TEST_F(HostileText, DoesNotReachTheBundlesNamesAndInstructions) {
    if (!has_program("zstd")) GTEST_SKIP() << "zstd is not installed";
    const fs::path bundle = folder_->path() / "b.tar.zst";
    const ProcessResult made = runcert({"bundle", run().string(), "--out", bundle.string()});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const ProcessResult names = shell(folder_->path(), "tar --zstd -tf b.tar.zst");
    EXPECT_TRUE(std::regex_match(names.output, std::regex("(course/[A-Za-z0-9._-]+\n)+")))
        << names.output;
    const std::string text =
        shell(folder_->path(), "tar --zstd -xOf b.tar.zst course/VERIFY.txt").output;
    EXPECT_TRUE(holds(text, "sha256sum -c SHA256SUMS"));
    for (const char* part : {"cmd()", "<", "touch", "{{"})
        EXPECT_FALSE(holds(text, part)) << part;
    const fs::path stranger = run() / "report.json.x;touch owned.minisig";
    write_plainly(stranger, "untrusted comment: x\n");
    expect_refused(runcert({"bundle", run().string(), "--out", bundle.string() + "2"}),
                   {"touch owned"});
    fs::remove(stranger);
}

/// Where a field takes no free text, the refusal shows what it was given as text, at its place.
TEST(HostileTextRefused, AtItsPlaceInPlainWords) {
    const std::string bad = "\"" + steering_in_yaml + "\"";
    const std::pair<std::string, std::string> cases[] = {
        {"id: hostile", "id: " + bad},
        {"class: land-yacht", "class: " + bad},
        {"id: primary", "id: " + bad},
        {"recording: recording.pos", "recording: " + bad},
        {"[nalsa]", "[" + bad + "]"},
        {"profiles", bad + ": 1\nprofiles"},
        {"profiles", "date: " + bad + "\nprofiles"},
        {"profiles", "signatures: [{role: " + bad + "}]\nprofiles"},
        {"profiles", "record: {speed: 1, unit: " + bad + ", source: s}\nprofiles"},
        {"profiles", "records: [{profile: " + bad + ", speed: 1, unit: kn, source: s}]\nprofiles"},
        {"profiles", "rules: [{profile: nalsa, figure: " + bad + ", value: 1}]\nprofiles"},
        {"profiles", "amends: {report_id: " + bad + ", sha256: a, reason: r}\nprofiles"},
        {"profiles", "parameters: {smooth: {noise: " + bad + "}}\nprofiles"}};
    for (const auto& [what, by] : cases) {
        SCOPED_TRACE(by);
        const TemporaryFolder folder;
        write_plainly(folder.path() / "attempt.yaml", replaced(good_attempt, what, by));
        write_plainly(folder.path() / "recording.pos", good_recording());
        const ProcessResult result =
            certify(folder.path() / "attempt.yaml", folder.path() / "run", {"--no-render"});
        expect_refused(result, {"attempt.yaml:"});
        expect_plain(result, by);
        EXPECT_FALSE(fs::exists(folder.path() / "run"));
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>

#include "approved.h"
#include "chain_support.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"

// What people read of a run, whole: certify, audit, explain, the report's page and that of a day.
// The texts are those of tests/approved; figures may differ by the last digit shown, as another
// compiler rounds otherwise.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Without what differs from run to run: hashes, lengths, times taken, revisions, folders.
std::string lasting(std::string text, const fs::path& folder) {
    const auto replace = [&](const char* pattern, const char* by) {
        text = std::regex_replace(text, std::regex(pattern), by);
    };
    for (std::size_t at = 0; (at = text.find(folder.string(), at)) != std::string::npos;)
        text.replace(at, folder.string().size(), "FOLDER");
    replace("\\b[0-9a-f]{12,64}\\b(-modified)?", "HASH");
    replace("[0-9,]+ bytes", "N bytes");
    replace(" *[0-9,]+ +HASH", "  N HASH");
    replace(" +[0-9]+\\.[0-9]{2} s(?=\\n)", " T s");
    replace("agrees within [0-9]e-[0-9]+ m +[0-9.]+ s", "agrees within E m T s");
    return text;
}

class Views : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        for (const char* example : {"land_yacht", "rejected", "course", "salt_lake"})
            said_[example] = certify(examples / example / "attempt.yaml", run(example)).output;
        const ProcessResult day = runcert(
            {"batch", (examples / "day").string(), "--out", run("day").string(), "--no-render"});
        EXPECT_EQ(day.exit_status, 0) << day.errors;
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }

    static fs::path run(const std::string& example) { return folder_->path() / example; }
    static void expect_view(const std::string& name, const std::string& text) {
        test::expect_approved(name, lasting(text, folder_->path()));
    }
    static std::string said_by(const std::vector<std::string>& arguments) {
        const ProcessResult result = runcert(arguments);
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        return result.output;
    }
    /// The words of a page, a line for each piece of text; scripts, styles and pictures left out.
    static std::string words_of_page(const fs::path& file) {
        const std::string page = read_file(file);
        std::string words;
        std::size_t at = page.find("<body");
        while (at < page.size()) {
            const std::size_t tag = std::min(page.find('<', at), page.size());
            if (const std::string_view word = trim(std::string_view(page).substr(at, tag - at));
                !word.empty())
                words.append(word).append("\n");
            std::string_view end = ">";
            for (const auto& [begin, its_end] :
                 {std::pair<std::string_view, std::string_view>{"<script", "</script>"},
                  {"<style", "</style>"},
                  {"<svg", "</svg>"},
                  {"<!--", "-->"}})
                if (page.compare(tag, begin.size(), begin) == 0) end = its_end;
            const std::size_t found = page.find(end, tag);
            at = found == std::string::npos ? page.size() : found + end.size();
        }
        return words;
    }

    static inline TemporaryFolder* folder_ = nullptr;
    static inline std::map<std::string, std::string> said_;
};

TEST_F(Views, Certify) {
    test::ApprovedTexts texts("certify.txt");
    for (const char* example : {"course", "land_yacht", "rejected"})
        texts.add(example, lasting(said_.at(example), folder_->path()));
}

TEST_F(Views, Audit) {
    for (const char* example : {"land_yacht", "rejected", "course"})
        expect_view(fmt::format("audit_{}.txt", example),
                    said_by({"audit", run(example).string()}));
}

TEST_F(Views, Explain) {
    for (const char* example : {"land_yacht", "rejected", "course"})
        expect_view(fmt::format("explain_{}.txt", example),
                    said_by({"explain", run(example).string()}));
}

TEST_F(Views, Report) {
    for (const char* example : {"land_yacht", "rejected", "course"})
        expect_view(fmt::format("report_{}.txt", example),
                    words_of_page(run(example) / "report.html"));
}

TEST_F(Views, Day) {
    expect_view("day.txt", words_of_page(run("day") / "day.html"));
}

/// "215.97" and "0.35" of every "215.97 km/h ± 0.35 km/h" or "215.97 ± 0.35 km/h" in a text.
std::vector<std::pair<std::string, std::string>> measured_in(const std::string& text,
                                                             const std::string& unit) {
    const std::regex pair("([0-9]+\\.[0-9]+)(?:\\s" + unit + ")?\\s±\\s([0-9]+\\.[0-9]+)\\s" +
                          unit);
    std::vector<std::pair<std::string, std::string>> found;
    for (std::sregex_iterator at(text.begin(), text.end(), pair), none; at != none; ++at)
        found.emplace_back(at->str(1), at->str(2));
    return found;
}

/// Of the window that was refused, a text shows the speed as `speed_beside` writes it, or in full.
void expect_refused(const std::string& text, const ProfileVerdict& rule) {
    const std::string& unit = rule.shown->unit;
    const double speed = rule.indicated->speed_m_s * speed_unit(unit).per_m_s;
    const std::string shown = speed_beside(rule, rule.indicated->speed_m_s, unit);
    const std::size_t decimals = shown.find(' ') - shown.find('.') - 1;
    const std::regex figure(fmt::format("\\b[0-9]+\\.[0-9]{{{}}} {}", decimals, unit));
    for (std::sregex_iterator at(text.begin(), text.end(), figure), none; at != none; ++at)
        if (std::abs(std::stod(at->str()) - speed) < 0.02) {
            EXPECT_EQ(at->str(), shown);
        }
}

// The headline, the tables, the terminal, the pages and the map show the same digits of the
// measured speed and of its expanded uncertainty. Of the other estimates of the window none is so
// near in both that it could be taken for it.
TEST_F(Views, TheMeasuredSpeedHasTheSameDigitsEverywhere) {
    for (const char* example : {"land_yacht", "rejected", "course", "salt_lake"}) {
        const fs::path folder = run(example);
        const Verdict verdict =
            read_verdict(read_file(folder / "6-verdict.yaml"), "6-verdict.yaml");
        const ProcessResult pdf =
            run_process({"pdftotext", "-layout", (folder / "report.pdf").string(), "-"});
        const std::map<std::string, std::string> texts{
            {"terminal", said_.at(example)},
            {"audit", said_by({"audit", folder.string()})},
            {"explain", said_by({"explain", folder.string()})},
            {"page", words_of_page(folder / "report.html")},
            {"pdf", pdf.output},
            {"verdict", read_file(folder / "6-verdict.yaml")},
            {"report", read_file(folder / "report.json")}};
        for (const ProfileVerdict& rule : verdict.profiles) {
            const ShownFigures& shown = rule.shown.value();
            const double per_m_s = speed_unit(shown.unit).per_m_s;
            const double speed = *rule.speed_m_s * per_m_s;
            const double uncertainty = *rule.expanded_uncertainty_m_s * per_m_s;
            for (const auto& [name, text] : texts) {
                SCOPED_TRACE(fmt::format("{}, {}, {}", example, rule.profile, name));
                std::size_t same = 0;
                for (const auto& [x, y] : measured_in(text, shown.unit)) {
                    if (std::abs(std::stod(x) - speed) > 0.02 ||
                        std::abs(std::stod(y) - uncertainty) > 0.05 * uncertainty + 0.01)
                        continue;
                    EXPECT_EQ(x, shown.speed);
                    EXPECT_EQ(y, shown.expanded_uncertainty);
                    ++same;
                }
                EXPECT_GT(same, 0U);
                if (rule.indicated) expect_refused(text, rule);
            }
        }
    }
}

TEST(MeasuredSpeeds, AreFoundInATextHoweverTheyAreWritten) {
    using Pairs = std::vector<std::pair<std::string, std::string>>;
    EXPECT_EQ(measured_in("is 1.23 km/h ± 0.10 km/h; 2.5 ± 0.1 km/h, 3.0 ± 1.0 kn", "km/h"),
              (Pairs{{"1.23", "0.10"}, {"2.5", "0.1"}}));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

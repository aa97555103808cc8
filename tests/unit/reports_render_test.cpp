#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports/plot/plot.h"
#include "reports_sample.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "trust/signature.h"

namespace runcert::RUNCERT_FILE {
namespace {

bool installed(const std::string& program) {
    try {
        return run_process({program, "--version"}).exit_status == 0 || program == "pdftotext";
    } catch (const Failure&) {
        return false;
    }
}

Plots plots_of(const sample::Run& run) {
    return read_plots(report_json(run.inputs)["predicate"]["figures"], "report.json");
}

/// The plot of that title; an empty one where there is none.
Plot titled(const Plots& plots, const std::string& title) {
    const auto found = std::ranges::find(plots, title, &Plot::title);
    return found == plots.end() ? Plot{} : *found;
}

bool has_curve(const Plot& plot, const std::string& name) {
    return std::ranges::find(plot.curves, name, &Curve::name) != plot.curves.end();
}

bool has_level(const Plot& plot, const std::string& name) {
    return std::ranges::find(plot.levels, name, &PlotLevel::name) != plot.levels.end();
}

constexpr const char* window = "The window under the rule nalsa";
constexpr const char* whole_run = "Horizontal speed over the whole run";

TEST(Drawn, FiguresAreTheSameTwice) {
    const Plots first = plots_of(sample::make_run()), second = plots_of(sample::make_run());
    // Place and result, two windows, the speeds over the rules' lengths, tests, residuals, speed,
    // track.
    ASSERT_EQ(first.size(), 9U);
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_EQ(plot_svg(first[i]), plot_svg(second[i]));
}

TEST(Drawn, ARunWithoutWindowHasFiguresToo) {
    EXPECT_EQ(plots_of(sample::make_run({.certified = false})).size(), 6U);
}

// Neither a line of the speed that counts nor one of the required speed: those are vertical.
TEST(Drawn, OfAVerticalRuleTheHorizontalSpeedIsDrawnAlone) {
    sample::Run run = sample::make_run();
    const Plots level = plots_of(run);
    EXPECT_TRUE(has_curve(titled(level, window), "speed that counts"));
    EXPECT_TRUE(has_level(titled(level, whole_run), "required speed, nalsa"));
    run.inputs.profiles[0].dimension = Dimension::vertical;
    EXPECT_EQ(titled(plots_of(run), "Vertical speed around the window").kind, "");  // none is known
    for (TrajectoryEpoch& row : run.inputs.receivers[0].trajectory.rows)
        row.velocity_up_m_s = -30.0;
    const Plots drawn = plots_of(run);
    EXPECT_FALSE(has_curve(titled(drawn, window), "speed that counts"));
    EXPECT_EQ(titled(drawn, "Vertical speed around the window").kind, "result");
    EXPECT_FALSE(has_level(titled(drawn, whole_run), "required speed, nalsa"));
    EXPECT_TRUE(has_level(titled(drawn, whole_run), "required speed, fisly"));
}

TEST(Drawn, WindowsOfOtherKindsAndFurtherOnesAreDrawn) {
    sample::Run run = sample::make_run();
    const Plots before = plots_of(run);
    for (const WindowKind kind : {WindowKind::distance, WindowKind::course, WindowKind::alpha}) {
        run.inputs.profiles[0].window_kind = kind;
        run.inputs.profiles[0].distance_m = 500.0;
        ProfileWindows& windows = run.inputs.receivers[0].windows.profiles[0];
        WindowSpan other = windows.best->span;
        other.start.nanoseconds -= 9'012'345'678;
        windows.further = {{.span = other, .arc = 1, .speed_m_s = 58.0}};
        const Plots drawn = plots_of(run);
        ASSERT_EQ(drawn.size(), before.size());
        EXPECT_EQ(titled(drawn, whole_run).spans.size(), titled(before, whole_run).spans.size() + 1)
            << to_text(kind);
        EXPECT_EQ(plot_json(titled(drawn, window)), plot_json(titled(before, window)))
            << to_text(kind);
    }
}

// What was refused is seen where the eye looks first.
TEST(Drawn, ARefusedWindowIsDrawn) {
    sample::Run run = sample::with_one_rule(sample::make_run());
    ProfileVerdict& verdict = run.inputs.verdict.profiles[0];
    verdict.indicated.reset();
    const auto is_refused = [](const Plot& plot) {
        return std::ranges::find(plot.spans, "refused", &PlotSpan::kind) != plot.spans.end();
    };
    EXPECT_FALSE(is_refused(titled(plots_of(run), whole_run)));
    WindowSpan span = *verdict.window;
    span.start.nanoseconds -= 5'000'000'000;
    verdict.indicated = RefusedWindow{.span = span, .speed_m_s = 61.0};
    const Plots both = plots_of(run);
    EXPECT_TRUE(is_refused(titled(both, whole_run)));
    EXPECT_TRUE(is_refused(titled(both, "Speed around the window")));
    EXPECT_TRUE(has_curve(titled(both, "Track and window"), "refused window"));
    verdict.window.reset();
    const Plots alone = plots_of(run);
    EXPECT_TRUE(is_refused(titled(alone, "Speed around the refused window")));
    EXPECT_FALSE(has_curve(titled(alone, "Track and window"), "certified window"));
}

TEST(Drawn, APlaneRunHasNoNorthOfTheEarth) {
    const auto caption = [](const sample::Options& options) {
        return titled(plots_of(sample::make_run(options)), "The track in the plane").caption;
    };
    EXPECT_NE(caption({.vertical = false, .georeferenced = false}).find("along the second axis"),
              std::string::npos);
    EXPECT_NE(caption({}).find("points to the north"), std::string::npos);
}

TEST(Drawn, ALongRunWithGapsStaysSmall) {
    const auto run = sample::make_run({.epochs = 28200, .interval_s = 0.05, .gap_every_s = 37});
    for (const Plot& plot : plots_of(run))
        EXPECT_LT(plot_svg(plot).size(), 100'000U);
}

// A line over a gap would show a speed that nobody measured.
TEST(Drawn, LinesBreakAtGaps) {
    const auto breaks = [](const sample::Options& options) {
        const Plot plot = titled(plots_of(sample::make_run(options)), whole_run);
        return std::ranges::count_if(plot.curves.at(0).y, [](double y) { return std::isnan(y); });
    };
    EXPECT_EQ(breaks({}), 0);
    EXPECT_EQ(breaks({.gap_every_s = 10}), 4);  // at 10, 20, 30 and 40 s
}

class Pdf : public testing::Test {
  protected:
    void SetUp() override {
        if (!installed("weasyprint")) GTEST_SKIP() << "weasyprint is not installed";
        if (!installed("pdftotext")) GTEST_SKIP() << "pdftotext is not installed";
    }

    std::string text_of_pdf(const sample::Options& options, const RenderOptions& render) {
        const sample::Run run = sample::make_run(options);
        Rendering().write(folder_.path(), write_report_json(run.inputs), render);
        return run_process({"pdftotext", (folder_.path() / "report.pdf").string(), "-"}).output;
    }

    TemporaryFolder folder_;
};

TEST_F(Pdf, TheCertificateIsTheFirstPageAlone) {
    const std::string whole = text_of_pdf({}, {});
    const std::string alone =
        run_process({"pdftotext", (folder_.path() / "certificate.pdf").string(), "-"}).output;
    const auto words = [](std::string text) {  // but for "Page 1 of 12"
        text.erase(std::min(text.find("Page 1 of"), text.size()));
        return text;
    };
    EXPECT_EQ(words(alone), words(whole.substr(0, whole.find('\f'))));
    EXPECT_EQ(std::count(alone.begin(), alone.end(), '\f'), 1);
}

// What a reader of the screen reads, in that order; WeasyPrint tags it.
TEST_F(Pdf, IsTaggedInTheOrderOfThePage) {
    (void)text_of_pdf({}, {});
    for (const char* const file : {"certificate.pdf", "report.pdf"}) {
        const std::string tags =
            run_process({"pdfinfo", "-struct-text", (folder_.path() / file).string()}).output;
        std::size_t at = 0;
        for (const char* const word :
             {"H1", "Measurement report", "Required speed", "Track and window", "SHA-256 of"}) {
            const std::size_t next = tags.find(word, at);
            EXPECT_NE(next, std::string::npos) << file << ": " << word;
            at = std::min(next, tags.size());
        }
    }
}

TEST_F(Pdf, HoldsVerdictSpeedAndEveryHash) {
    const std::string text = text_of_pdf(
        {}, {.signatures = {
                 {.name = "report.json.minisig",
                  .text = sign("report", generate_key_pair().secret_key, "role=measurer")}}});
    EXPECT_NE(text.find("Measured speed exceeds the record"), std::string::npos);
    EXPECT_NE(text.find("216.00 km/h ± 0.019 km/h"), std::string::npos);
    EXPECT_NE(text.find("Uncertainty: rule “fisly”"), std::string::npos);
    EXPECT_NE(text.find("216.00 km/h ± 0.019 km/h (k = 2)"), std::string::npos);
    EXPECT_NE(text.find("B, rectangular"), std::string::npos);
    EXPECT_EQ(text.find("UNSIGNED"), std::string::npos);
    for (const InputFile& subject : sample::make_run().inputs.files)
        EXPECT_NE(text.find(subject.sha256), std::string::npos) << subject.file;
}

TEST_F(Pdf, UnsignedStandsOnEveryPageAndLeavesTheHashesWhole) {
    const std::string text = text_of_pdf({}, {});
    std::size_t begin = 0;
    int pages = 0;
    for (std::size_t end = text.find('\f'); end != std::string::npos;
         begin = end + 1, end = text.find('\f', begin), ++pages)
        EXPECT_NE(text.substr(begin, end - begin).find("UNSIGNED"), std::string::npos) << pages;
    EXPECT_GT(pages, 3);
    for (const InputFile& subject : sample::make_run().inputs.files)
        EXPECT_NE(text.find(subject.sha256), std::string::npos) << subject.file;
}

// One file to hand over: what was signed is in it, as `pdfdetach` of another program finds it.
TEST_F(Pdf, CarriesTheReportByteForByte) {
    (void)text_of_pdf({}, {});
    const std::filesystem::path detached = folder_.path() / "detached.json";
    const ProcessResult result =
        run_process({"pdfdetach", "-savefile", "report.json", "-o", detached.string(),
                     (folder_.path() / "report.pdf").string()});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_EQ(read_file(detached), write_report_json(sample::make_run().inputs));
}

TEST_F(Pdf, IsTheSameTwice) {
    const RenderOptions unsigned_page;
    (void)text_of_pdf({}, unsigned_page);
    std::vector<std::string> first;
    for (const char* const file : {"certificate.pdf", "report.pdf"})
        first.push_back(read_file(folder_.path() / file));
    (void)text_of_pdf({}, unsigned_page);
    EXPECT_EQ(read_file(folder_.path() / "certificate.pdf"), first[0]);
    EXPECT_EQ(read_file(folder_.path() / "report.pdf"), first[1]);
}

TEST_F(Pdf, HostileTextIsOnPaperAsItWasWritten) {
    const std::string text =
        text_of_pdf({.craft = "<script>alert(1)</script> \"q\" =cmd() \xF0\x9F\x9A\x80",
                     .place = std::string(10000, 'x')},
                    {});
    EXPECT_NE(text.find("“<script>alert(1)</script> 'q' =cmd()"), std::string::npos);
    EXPECT_GT(std::count(text.begin(), text.end(), 'x'), 10000);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

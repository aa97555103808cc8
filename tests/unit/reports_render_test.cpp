#include <gtest/gtest.h>

#include <set>

#include "core/failure.h"
#include "files/process.h"
#include "reports/figures.h"
#include "reports/report_json.h"
#include "reports/report_pdf.h"
#include "reports/report_run.h"
#include "reports_sample.h"

namespace runcert {
namespace {

bool installed(const std::string& program) {
    try {
        return run_process({program, "--version"}).exit_status == 0 || program == "pdftotext";
    } catch (const Failure&) {
        return false;
    }
}

class Rendering : public testing::Test {
  protected:
    void SetUp() override {
        if (!installed("gnuplot")) GTEST_SKIP() << "gnuplot is not installed";
    }

    std::vector<DrawnFigure> figures(const sample::Options& options) {
        const sample::Run run = sample::make_run(options);
        sample::write_files(run, folder_.path());
        return draw_figures(folder_.path(), report_json(run.inputs)["predicate"]);
    }

    TemporaryFolder folder_;
};

std::set<std::string> ids_of(const std::string& svg) {
    std::set<std::string> ids;
    for (std::size_t at = svg.find(" id="); at != std::string::npos; at = svg.find(" id=", at + 1))
        ids.insert(svg.substr(at + 5, svg.find(svg[at + 4], at + 5) - at - 5));
    return ids;
}

TEST_F(Rendering, FiguresAreTheSameTwice) {
    const auto first = figures({});
    const auto second = figures({});
    ASSERT_EQ(first.size(), 4U);
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_EQ(first[i].svg, second[i].svg);
}

TEST_F(Rendering, FiguresShareNoIds) {
    std::set<std::string> all;
    std::size_t count = 0;
    for (const DrawnFigure& figure : figures({})) {
        const auto ids = ids_of(figure.svg);
        count += ids.size();
        all.insert(ids.begin(), ids.end());
        EXPECT_TRUE(figure.svg.starts_with("<svg"));
        EXPECT_EQ(figure.svg.find("currentColor' d="), std::string::npos);
    }
    EXPECT_EQ(all.size(), count);
}

TEST_F(Rendering, ARunWithoutWindowHasFiguresToo) {
    EXPECT_EQ(figures({.certified = false}).size(), 2U);
}

// Neither a line of the speed that counts nor one of the speed to reach: those are vertical.
TEST_F(Rendering, OfAVerticalRuleTheHorizontalSpeedIsDrawnAlone) {
    sample::Run run = sample::make_run();
    sample::write_files(run, folder_.path());
    const auto level = draw_figures(folder_.path(), report_json(run.inputs)["predicate"]);
    EXPECT_NE(level[1].svg.find("speed that counts"), std::string::npos);
    EXPECT_NE(level[0].svg.find("speed to reach, nalsa"), std::string::npos);
    run.inputs.profiles[0].dimension = "vertical";
    const auto drawn = draw_figures(folder_.path(), report_json(run.inputs)["predicate"]);
    EXPECT_EQ(drawn[1].svg.find("speed that counts"), std::string::npos);
    EXPECT_EQ(drawn[0].svg.find("speed to reach, nalsa"), std::string::npos);
    EXPECT_NE(drawn[0].svg.find("speed to reach, fisly"), std::string::npos);
}

TEST_F(Rendering, WindowsOfOtherKindsAndFurtherOnesAreDrawn) {
    sample::Run run = sample::make_run();
    sample::write_files(run, folder_.path());
    const auto before = draw_figures(folder_.path(), report_json(run.inputs)["predicate"]);
    for (const char* kind : {"distance", "course", "alpha"}) {
        run.inputs.profiles[0].window_kind = kind;
        run.inputs.profiles[0].distance_m = 500.0;
        ProfileWindows& windows = run.inputs.receivers[0].windows.profiles[0];
        WindowSpan other = windows.best->span;
        other.start.nanoseconds -= 9'012'345'678;
        windows.further = {{.span = other, .arc = 1, .speed_mps = 58.0}};
        const auto drawn = draw_figures(folder_.path(), report_json(run.inputs)["predicate"]);
        ASSERT_EQ(drawn.size(), before.size());
        EXPECT_NE(drawn[0].svg, before[0].svg) << kind;  // the further window is shaded
        EXPECT_EQ(drawn[1].svg, before[1].svg) << kind;
    }
}

TEST_F(Rendering, APlaneRunHasNoNorthOfTheEarth) {
    const auto drawn = figures({.vertical = false, .georeferenced = false});
    EXPECT_NE(drawn.back().svg.find("plane N"), std::string::npos);
}

TEST_F(Rendering, ALongRunWithGapsStaysSmall) {
    for (const DrawnFigure& figure :
         figures({.epochs = 28200, .interval_s = 0.05, .gap_every_s = 37}))
        EXPECT_LT(figure.svg.size(), 200'000U);
}

// A line over a gap would show a speed that nobody measured.
TEST_F(Rendering, LinesBreakAtGaps) {
    const auto moves = [](const std::string& svg) {
        const std::size_t plot = svg.find("<title>smoothed speed</title>");
        const std::size_t end = svg.find("</g>\n\t</g>", plot);
        const std::string curve = svg.substr(plot, end - plot);
        return std::count(curve.begin(), curve.end(), 'M');
    };
    const auto whole = moves(figures({})[0].svg);
    const auto broken = moves(figures({.gap_every_s = 10})[0].svg);
    EXPECT_EQ(broken - whole, 4);  // at 10, 20, 30 and 40 s
}

TEST_F(Rendering, AnotherTableThanTheVouchedOneIsRefused) {
    const sample::Run run = sample::make_run();
    sample::write_files(run, folder_.path());
    write_file_atomically(folder_.path() / "4-trajectory.ecsv",
                          run.files.at("4-trajectory.ecsv") + "\n");
    EXPECT_THROW(draw_figures(folder_.path(), report_json(run.inputs)["predicate"]), Failure);
}

class Pdf : public Rendering {
  protected:
    void SetUp() override {
        Rendering::SetUp();
        if (IsSkipped()) return;
        if (!installed("weasyprint")) GTEST_SKIP() << "weasyprint is not installed";
        if (!installed("pdftotext")) GTEST_SKIP() << "pdftotext is not installed";
    }

    std::string text_of_pdf(const sample::Options& options, const RenderOptions& render) {
        const sample::Run run = sample::make_run(options);
        sample::write_files(run, folder_.path());
        render_report(folder_.path(), write_report_json(run.inputs), render);
        return run_process({"pdftotext", (folder_.path() / "report.pdf").string(), "-"}).output;
    }
};

TEST_F(Pdf, HoldsVerdictSpeedAndEveryHash) {
    const std::string text = text_of_pdf({}, {.signers = {{"9F3C5B7A11D04E62", "comment"}}});
    EXPECT_NE(text.find("Record beaten"), std::string::npos);
    EXPECT_NE(text.find("216.00 ± 0.019 km/h"), std::string::npos);
    EXPECT_NE(text.find("Uncertainty: rule “fisly”"), std::string::npos);
    EXPECT_NE(text.find("216.009 ± 0.018 km/h (k = 2)"), std::string::npos);
    EXPECT_NE(text.find("B, rectangular"), std::string::npos);
    EXPECT_EQ(text.find("UNSIGNED"), std::string::npos);
    for (const ReportSubject& subject : sample::make_run().inputs.subjects)
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
    for (const ReportSubject& subject : sample::make_run().inputs.subjects)
        EXPECT_NE(text.find(subject.sha256), std::string::npos) << subject.file;
}

TEST_F(Pdf, IsTheSameTwice) {
    const RenderOptions unsigned_page;
    (void)text_of_pdf({}, unsigned_page);
    const std::string first = read_file(folder_.path() / "report.pdf");
    (void)text_of_pdf({}, unsigned_page);
    EXPECT_EQ(read_file(folder_.path() / "report.pdf"), first);
}

TEST_F(Pdf, HostileTextIsOnPaperAsItWasWritten) {
    const std::string text =
        text_of_pdf({.craft = "<script>alert(1)</script> \"q\" =cmd() \xF0\x9F\x9A\x80",
                     .place = std::string(10000, 'x')},
                    {});
    EXPECT_NE(text.find("<script>alert(1)</script> \"q\" =cmd()"), std::string::npos);
    EXPECT_GT(std::count(text.begin(), text.end(), 'x'), 10000);
}

}  // namespace
}  // namespace runcert

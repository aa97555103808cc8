#include <gtest/gtest.h>

#include <algorithm>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
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

class Rendering : public testing::Test {
  protected:
    void SetUp() override {
        if (!installed("gnuplot")) GTEST_SKIP() << "gnuplot is not installed";
    }

    std::vector<std::string> figures(const sample::Options& options) {
        return draw_figures(report_json(sample::make_run(options).inputs)["predicate"]);
    }

    TemporaryFolder folder_;
};

/// The drawing of that title; empty where there is none.
std::string titled(const std::vector<std::string>& drawings, const std::string& title) {
    for (const std::string& svg : drawings)
        if (svg.find("<title>" + title + "<") != std::string::npos) return svg;
    return {};
}

std::string curve_of(const std::string& svg, const std::string& title) {
    const std::size_t plot = svg.find("<title>" + title + "</title>");
    return plot == std::string::npos ? "" : svg.substr(plot, svg.find("</g>\n\t</g>", plot) - plot);
}

TEST_F(Rendering, FiguresAreTheSameTwice) {
    const auto first = figures({});
    const auto second = figures({});
    // Place and result, two windows, the speeds over the rules' lengths, speed, track, residuals,
    // tests.
    ASSERT_EQ(first.size(), 9U);
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i], second[i]);
        EXPECT_TRUE(first[i].starts_with("<svg"));
    }
}

// gnuplot takes what stands in a text for an instruction, unless it is quoted.
TEST_F(Rendering, TextsAreNotInstructions) {
    auto predicate = report_json(sample::make_run().inputs)["predicate"];
    predicate["figures"].erase(predicate["figures"].begin() + 1, predicate["figures"].end());
    const std::string hostile = "'; system('false'); set output 'x' \" `id` @common {/=9 A}\n<b>";
    for (const char* label : {"x_label", "y_label", "figure_title"})
        predicate["figures"][0][label] = hostile;
    predicate["figures"][0]["curves"][0]["curve_name"] = hostile;
    const std::string svg = draw_figures(predicate).at(0);
    EXPECT_NE(svg.find("id‘ @common {/=9 A}?&lt;b>"), std::string::npos);
    EXPECT_EQ(svg.find("<b>"), std::string::npos);
}

TEST_F(Rendering, ARunWithoutWindowHasFiguresToo) {
    EXPECT_EQ(figures({.certified = false}).size(), 6U);
}

// Neither a line of the speed that counts nor one of the required speed: those are vertical.
TEST_F(Rendering, OfAVerticalRuleTheHorizontalSpeedIsDrawnAlone) {
    sample::Run run = sample::make_run();
    const auto level = draw_figures(report_json(run.inputs)["predicate"]);
    const char* window = "The window under the rule nalsa";
    EXPECT_NE(titled(level, window).find("speed that counts"), std::string::npos);
    const auto over_the_run = [](const std::vector<std::string>& drawings) {
        return titled(drawings, "Horizontal speed over the whole run");
    };
    EXPECT_NE(over_the_run(level).find("required speed, nalsa"), std::string::npos);
    run.inputs.profiles[0].dimension = Dimension::vertical;
    const auto drawn = draw_figures(report_json(run.inputs)["predicate"]);
    EXPECT_EQ(titled(drawn, window).find("speed that counts"), std::string::npos);
    EXPECT_NE(titled(drawn, "Vertical speed around the window"), "");
    EXPECT_EQ(over_the_run(drawn).find("required speed, nalsa"), std::string::npos);
    EXPECT_NE(over_the_run(drawn).find("required speed, fisly"), std::string::npos);
}

TEST_F(Rendering, WindowsOfOtherKindsAndFurtherOnesAreDrawn) {
    sample::Run run = sample::make_run();
    const auto before = draw_figures(report_json(run.inputs)["predicate"]);
    for (const WindowKind kind : {WindowKind::distance, WindowKind::course, WindowKind::alpha}) {
        run.inputs.profiles[0].window_kind = kind;
        run.inputs.profiles[0].distance_m = 500.0;
        ProfileWindows& windows = run.inputs.receivers[0].windows.profiles[0];
        WindowSpan other = windows.best->span;
        other.start.nanoseconds -= 9'012'345'678;
        windows.further = {{.span = other, .arc = 1, .speed_m_s = 58.0}};
        const auto drawn = draw_figures(report_json(run.inputs)["predicate"]);
        ASSERT_EQ(drawn.size(), before.size());
        const char* whole_run = "Horizontal speed over the whole run";
        EXPECT_TRUE(titled(drawn, whole_run) != titled(before, whole_run))
            << to_text(kind);  // the further window is shaded
        const char* window = "The window under the rule nalsa";
        EXPECT_EQ(titled(drawn, window), titled(before, window)) << to_text(kind);
    }
}

TEST_F(Rendering, APlaneRunHasNoNorthOfTheEarth) {
    const char* track_title = "The track in the plane";
    const std::string track =
        titled(figures({.vertical = false, .georeferenced = false}), track_title);
    EXPECT_EQ(track.find("<title>north</title>"), std::string::npos);
    // What the arrow is stands in the caption.
    const auto caption = [](const sample::Options& options) {
        const auto report = report_json(sample::make_run(options).inputs);
        for (const auto& figure : report["predicate"]["figures"])
            if (figure["figure"] == "track") return figure["caption"].get<std::string>();
        return std::string();
    };
    EXPECT_NE(caption({.vertical = false, .georeferenced = false}).find("along the second axis"),
              std::string::npos);
    EXPECT_NE(caption({}).find("points to the north"), std::string::npos);
}

TEST_F(Rendering, ALongRunWithGapsStaysSmall) {
    for (const std::string& svg : figures({.epochs = 28200, .interval_s = 0.05, .gap_every_s = 37}))
        EXPECT_LT(svg.size(), 200'000U);
}

// A line over a gap would show a speed that nobody measured.
TEST_F(Rendering, LinesBreakAtGaps) {
    const auto moves = [](const std::string& svg) {
        const std::string curve = curve_of(svg, "smoothed speed");
        return std::count(curve.begin(), curve.end(), 'M');
    };
    const auto whole = moves(titled(figures({}), "Horizontal speed over the whole run"));
    const auto broken =
        moves(titled(figures({.gap_every_s = 10}), "Horizontal speed over the whole run"));
    EXPECT_GT(whole, 0);
    EXPECT_EQ(broken - whole, 4);  // at 10, 20, 30 and 40 s
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
        render_report(folder_.path(), write_report_json(run.inputs), render);
        return run_process({"pdftotext", (folder_.path() / "report.pdf").string(), "-"}).output;
    }
};

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
    const std::string first = read_file(folder_.path() / "report.pdf");
    (void)text_of_pdf({}, unsigned_page);
    EXPECT_EQ(read_file(folder_.path() / "report.pdf"), first);
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

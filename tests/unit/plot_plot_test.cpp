#include "reports/plot/plot.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "core/failure.h"
#include "reports/plot/axis.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store/sha256.h"

// A figure's declaration and its drawing: whatever a series holds, a figure or nothing, never a
// broken page.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Plot plot_of(Curve curve) {
    Plot plot{.title = "Speed", .x_label = "time (s)", .y_label = "speed (km/h)"};
    Range x, y;
    for (const double value : curve.x)
        x.widen(value);
    for (const double value : curve.y)
        y.widen(value);
    plot.add(std::move(curve));
    plot.set_axes(x, y);
    return plot;
}

Curve curve_of(const std::vector<double>& values) {
    Curve curve{"speed", "line", "blue"};
    for (std::size_t i = 0; i < values.size(); ++i)
        curve.add(static_cast<double>(i), values[i]);
    return curve;
}

/// A text, and the box that it covers.
struct Written {
    std::string text;
    double left = 0.0, right = 0.0, base = 0.0;
};

std::vector<Written> texts_in(const std::string& svg, double letters) {
    static const std::regex form(
        "<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"(?: text-anchor=\"([a-z]+)\")? "
        "fill=\"#[0-9a-f]+\">([^<]*)</text>");
    std::vector<Written> texts;
    for (std::sregex_iterator at(svg.begin(), svg.end(), form), end; at != end; ++at) {
        std::string text = (*at)[4];
        for (const auto& [escape, letter] :
             {std::pair{"&lt;", "<"}, std::pair{"&gt;", ">"}, std::pair{"&quot;", "\""},
              std::pair{"&apos;", "'"}, std::pair{"&amp;", "&"}})
            for (std::size_t found = 0; (found = text.find(escape)) != std::string::npos;)
                text.replace(found, std::string(escape).size(), letter);
        const double width = text_width(text) * letters, x = std::stod((*at)[1]);
        const double left = (*at)[3] == "end"      ? x - width
                            : (*at)[3] == "middle" ? x - 0.5 * width
                                                   : x;
        texts.push_back({(*at)[4], left, left + width, std::stod((*at)[2])});
    }
    return texts;
}

/// Well-formed, without a number that is none, and no text over another or outside.
void expect_sound(const Plot& plot, const DrawingSize& size = {}) {
    const std::string svg = plot_svg(plot, size);
    EXPECT_EQ(svg.find("nan"), std::string::npos) << svg.substr(0, 2000);
    EXPECT_EQ(svg.find("inf"), std::string::npos) << svg.substr(0, 2000);
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "plot.svg", svg);
    const ProcessResult xml =
        run_process({"xmllint", "--noout", "--nonet", (folder.path() / "plot.svg").string()});
    EXPECT_EQ(xml.exit_status, 0) << xml.errors;
    const auto texts = texts_in(svg, size.letters);
    for (std::size_t i = 0; i < texts.size(); ++i) {
        EXPECT_GE(texts[i].left, -0.1) << texts[i].text;
        EXPECT_LE(texts[i].right, size.width + 0.1) << texts[i].text;
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_FALSE(std::abs(texts[i].base - texts[k].base) < 0.7 * size.letters &&
                         texts[i].left < texts[k].right && texts[k].left < texts[i].right)
                << texts[i].text << " over " << texts[k].text;
    }
}

TEST(Plot, WhateverASeriesHoldsIsDrawnOrNot) {
    for (const std::vector<double>& values : {std::vector<double>{},
                                              {5.0},
                                              {5.0, 5.0, 5.0},
                                              {nan, nan},
                                              {1.0, nan, 2.0, infinity, 3.0},
                                              {0.0, 1e300},
                                              {-1e-300, 1e-300},
                                              {1e15, 1e15 + 1.0},
                                              {-5.0, 5.0}}) {
        expect_sound(plot_of(curve_of(values)));
        expect_sound(plot_of(curve_of(values)), small_drawing);
    }
    EXPECT_TRUE(plot_of(curve_of({})).curves.empty());
    EXPECT_TRUE(plot_of(curve_of({nan, infinity})).curves.empty());
}

TEST(Plot, AValueThatIsNoneBreaksTheLine) {
    const Curve curve = curve_of({1.0, nan, 2.0, 3.0});
    ASSERT_EQ(curve.size(), 4U);
    EXPECT_TRUE(std::isnan(curve.y[1]));
    EXPECT_EQ(plot_json(plot_of(curve))["curves"][0]["y"].dump(), "[1.0,null,2.0,3.0]");
    const std::string svg = plot_svg(plot_of(curve));
    const std::size_t path = svg.find("stroke=\"#0072b2\"");
    const std::string drawn = svg.substr(svg.rfind("<path d=\"", path), 80);
    EXPECT_EQ(std::count(drawn.begin(), drawn.end(), 'M'), 2) << drawn;
}

TEST(Plot, AxesBeyondAThousandSecondsHaveNumbersThatDoNotTouch) {
    for (const double from : {0.0, 3806.5, 100'000.0, -12'345.678, 1e9})
        for (const double length : {1e-3, 0.9, 3.0, 47.0, 3600.0, 1e6}) {
            Curve curve{"speed", "line", "blue", 6};
            curve.add(from, 40.0);
            curve.add(from + length, 60.0);
            expect_sound(plot_of(curve));
            expect_sound(plot_of(curve), small_drawing);
        }
}

TEST(Plot, LongNamesAreCutAndTheLegendIsWrapped) {
    Plot plot = plot_of(curve_of({1.0, 2.0}));
    for (int i = 0; i < 12; ++i) {
        plot.curves.push_back(curve_of({1.0, 2.0}));
        plot.curves.back().name = std::string(static_cast<std::size_t>(7 * i + 1), 'W');
        plot.levels.push_back({fmt::format("required speed, rule-{}", i), 1.5});
        plot.spans.push_back({fmt::format("window, rule-{}", i), "window", 0.2, 0.3});
        plot.marks.push_back({"start", 0.0, 1.0});
    }
    plot.y_label = plot.x_label = std::string(300, 'm');
    expect_sound(plot);
    expect_sound(plot, small_drawing);
    // Levels at one place share a name, and the legend has each kind of span once.
    const std::string svg = plot_svg(plot);
    EXPECT_NE(svg.find(">required speed, rule-0, rule-1, rule-2"), std::string::npos);
    EXPECT_EQ(svg.find(">window<"), svg.rfind(">window<"));
}

TEST(Plot, TextsAreEscaped) {
    Plot plot = plot_of(curve_of({1.0, 2.0}));
    const std::string hostile = "</svg><script>alert(1)</script> \" ' & \xE2\x80\xAE \x1b[2J";
    plot.title = plot.x_label = plot.y_label = plot.curves[0].name = hostile;
    plot.levels = {{hostile, 1.5}};
    plot.spans = {{hostile, "window", 0.2, 0.8}};
    plot.marks = {{hostile, 0.5, 1.5}};
    expect_sound(plot);
    EXPECT_EQ(plot_svg(plot).find("<script"), std::string::npos);
}

// Ten million points make a path of what a page can show, and lose no spike.
TEST(Plot, AsManyPointsAsAPageCanShow) {
    Curve curve{"speed", "line", "blue", 4};
    constexpr int count = 10'000'000, spike = 7'654'321;
    curve.x.reserve(count);
    curve.y.reserve(count);
    for (int i = 0; i < count; ++i) {
        curve.x.push_back(i * 1e-4);
        curve.y.push_back(i == spike ? 100.0 : 50.0 + 0.001 * (i % 7));
    }
    const Plot plot = plot_of(std::move(curve));
    const std::string svg = plot_svg(plot);
    EXPECT_LT(svg.size(), 60'000U);
    const PlotAxes axes = axes_of(plot, {});
    EXPECT_NE(svg.find(fmt::format("{:.1f} {:.1f}", axes.across(spike * 1e-4), axes.down(100.0))),
              std::string::npos);
}

TEST(Plot, NothingIsDrawnOutsideTheFrame) {
    Plot plot = plot_of(curve_of({0.0, 1.0, 1000.0, 1.0, -1000.0, 0.0}));
    plot.y_min = -1.0;
    plot.y_max = 2.0;
    const std::string svg = plot_svg(plot);
    const PlotAxes axes = axes_of(plot, {});
    const std::size_t stroke = svg.find("stroke=\"#0072b2\"");
    const std::size_t begin = svg.rfind("<path d=\"", stroke);
    const std::string path = svg.substr(begin, stroke - begin);
    static const std::regex point("(?:M|L)([-0-9.]+) ([-0-9.]+)");
    int points = 0;
    for (std::sregex_iterator at(path.begin(), path.end(), point), end; at != end; ++at, ++points) {
        EXPECT_GE(std::stod((*at)[2]), axes.top - 0.06);
        EXPECT_LE(std::stod((*at)[2]), axes.top + axes.high + 0.06);
    }
    EXPECT_GE(points, 6);
}

TEST(Plot, ATrackHasOneScale) {
    for (const auto& [east, north] :
         {std::pair{1000.0, 10.0}, std::pair{10.0, 1000.0}, std::pair{500.0, 500.0}}) {
        Plot plot{
            .title = "Track", .x_label = "east (m)", .y_label = "north (m)", .equal_scale = true};
        plot.set_axes({0.0, east}, {0.0, north});
        const PlotAxes axes = axes_of(plot, {});
        EXPECT_NEAR(axes.across(1.0) - axes.across(0.0), axes.down(0.0) - axes.down(1.0), 1e-9);
        EXPECT_LE(axes.x_min, 0.0);
        EXPECT_GE(axes.x_max, east);
        EXPECT_LE(axes.y_min, 0.0);
        EXPECT_GE(axes.y_max, north);
        expect_sound(plot);
    }
}

TEST(Plot, RowsHaveNamesInPlaceOfNumbers) {
    Plot plot = plot_of(curve_of({1.0, 2.0}));
    for (const char* const name :
         {"G05", "a name that is far too long to stand beside the frame"}) {
        plot.rows.push_back({name, static_cast<double>(plot.rows.size() + 1), "52.00 ± 0.10"});
        plot.set_axes({0.0, 1.0}, {0.0, static_cast<double>(plot.rows.size()) + 1.0});
        expect_sound(plot);
        EXPECT_NE(plot_svg(plot).find(">G05<"), std::string::npos);
    }
}

TEST(Plot, IsReadAgainAsItWasWritten) {
    Plot plot = plot_of(curve_of({1.0, nan, 2.0}));
    Range speeds;
    Curve band{"band, a", "dashed", "green"};
    band.add(0.0, 1.0, 0.5, speeds);
    band.add(1.0, 2.0, 0.5, speeds);
    plot.add(band);
    plot.levels = {{"required speed", 1.5}};
    plot.spans = {{"window", "refused", 0.25, 0.75}};
    plot.marks = {{"start", 0.5, 1.5}};
    plot.rows = {{"G05", 1.0}};
    plot.rule = "nalsa";
    const auto json = plot_json(plot);
    const Plots read = read_plots(nlohmann::ordered_json::array({json}), "report.json");
    ASSERT_EQ(read.size(), 1U);
    EXPECT_EQ(plot_json(read[0]), json);
    EXPECT_EQ(plot_svg(read[0]), plot_svg(plot));
}

TEST(Plot, WhatIsNoFigureIsRefusedByName) {
    const auto good = plot_json(plot_of(curve_of({1.0, 2.0})));
    for (const char* change :
         {R"([{"op": "remove", "path": "/curves"}])", R"([{"op": "remove", "path": "/x_min"}])",
          R"([{"op": "replace", "path": "/curves/0/y", "value": [1.0]}])",
          R"([{"op": "replace", "path": "/curves/0/x", "value": "abc"}])",
          R"([{"op": "replace", "path": "/curves/0/x", "value": ["a", "b"]}])",
          R"([{"op": "add", "path": "/curves/0/lower", "value": [1.0, 2.0]}])",
          R"([{"op": "replace", "path": "/curves", "value": 7}])"}) {
        const auto changed = good.patch(nlohmann::ordered_json::parse(change));
        try {
            (void)read_plots({good, changed}, "report.json");
            ADD_FAILURE() << change;
        } catch (const Failure& failure) {
            EXPECT_NE(failure.problem().find("figure 2"), std::string::npos) << failure.problem();
        }
    }
    // Each member alone: an aggregate that is half made must come apart without harm.
    for (const auto& [key, value] : good.items()) {
        auto changed = good;
        changed.erase(key);
        EXPECT_THROW((void)read_plots(nlohmann::ordered_json::array({changed}), "r"), Failure)
            << key;
    }
    for (const char* const key : {"curve_name", "curve_kind", "colour", "x", "y"}) {
        auto changed = good;
        changed["curves"][0].erase(key);
        EXPECT_THROW((void)read_plots(nlohmann::ordered_json::array({changed}), "r"), Failure)
            << key;
    }
    for (const auto& [list, part] :
         {std::pair{"levels", R"([{"level_name": "a long name that is not on the stack"}])"},
          std::pair{"spans", R"([{"span_name": "a long name that is not on the stack"}])"},
          std::pair{"marks", R"([{"mark_name": "a long name that is not on the stack"}])"},
          std::pair{"rows", R"([{"row_name": "a long name that is not on the stack"}])"}}) {
        auto changed = good;
        changed[list] = nlohmann::ordered_json::parse(part);
        EXPECT_THROW((void)read_plots(nlohmann::ordered_json::array({changed}), "r"), Failure)
            << list;
    }
    // Limits that are none are drawn as what has no extent.
    for (const double low : {3.0, nan, -infinity}) {
        Plot plot = plot_of(curve_of({1.0, 2.0}));
        plot.x_min = plot.x_max = low;
        plot.y_max = plot.y_min;
        expect_sound(plot);
    }
}

// What no program of this one writes, and a forger may: points and bands that are half there.
TEST(Plot, HalfOfAPointIsNotDrawn) {
    Range speeds;
    Curve band{"band", "line", "blue"};
    for (int i = 0; i < 5; ++i)
        band.add(i, 10.0 + i, 0.5, speeds);
    for (const char* const list : {"x", "y", "lower", "upper"}) {
        auto json = plot_json(plot_of(band));
        json["curves"][0][list][2] = nullptr;
        for (const char* const kind : {"line", "points"}) {
            json["curves"][0]["curve_kind"] = kind;
            expect_sound(read_plots(nlohmann::ordered_json::array({json}), "r").at(0));
        }
    }
    Plot plot = plot_of(band);
    plot.marks = {{"far away", 1e308, 11.0}, {"near", 2.0, 11.0}};
    expect_sound(plot);
    EXPECT_EQ(plot_svg(plot).find("far away"), std::string::npos);
    EXPECT_NE(plot_svg(plot).find(">near<"), std::string::npos);
}

// The bytes are those of every machine: arithmetic is that of IEEE 754 alone.
TEST(Plot, HasTheSameBytesEverywhere) {
    Plot plot = plot_of(curve_of({0.1, 0.7, nan, 0.3, 12.25, 1.0 / 3.0}));
    plot.levels = {{"required speed, nalsa", 5.0}};
    plot.spans = {{"window", "window", 1.0, 3.3}, {"refused window", "refused", 0.5, 0.9}};
    plot.marks = {{"start", 0.0, 0.1}};
    EXPECT_EQ(sha256_hex(plot_svg(plot)).substr(0, 16), "c04e455489fefc57");
}

TEST(Plot, TicksAreOneTwoOrFiveTimesAPowerOfTen) {
    for (const auto& [low, high, most, expected] :
         {std::tuple{0.0, 10.0, 5.0, "0 2 4 6 8 10"}, std::tuple{0.0, 1.0, 4.0, "0.0 0.5 1.0"},
          std::tuple{-0.02, 0.02, 4.0, "−0.02 −0.01 0.00 0.01 0.02"},
          std::tuple{3806.4, 3810.2, 4.0, "3807 3808 3809 3810"},
          std::tuple{0.0, 2500.0, 5.0, "0 500 1000 1500 2000 2500"}}) {
        const Ticks ticks = ticks_of(low, high, most);
        std::string words;
        for (std::size_t i = 0; i < ticks.count(); ++i)
            words += (i > 0 ? " " : "") + ticks.text(i);
        EXPECT_EQ(words, expected);
    }
    EXPECT_EQ(ticks_of(1.0, 1.0, 5.0).count(), 0U);
    EXPECT_EQ(ticks_of(nan, 1.0, 5.0).count(), 0U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

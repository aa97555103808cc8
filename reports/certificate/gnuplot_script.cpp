#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "reports/certificate/report_run.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr int figure_width = 760;  ///< points of the SVG
constexpr int small_width = 420;

/// In single quotes gnuplot takes nothing but the quote itself for an instruction; quotes are
/// written as typographers do, since 5.4 stumbles over two of them at the beginning.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        const bool control = (c >= 0 && c < ' ') || c == '\x7f';
        if (c == '\'')
            out += "\u2019";
        else if (c == '`')
            out += "\u2018";
        else
            out += control ? '?' : c;
    }
    return out + "'";
}

std::string quoted(const Json& text) {
    return quoted(text.get<std::string>());
}

std::string number(const Json& value) {
    return fmt::format("{}", value.get<double>());
}

/// Points as a block of data, a line end for each null: there the line breaks.
std::string data_block(const std::string& name, const Json& points) {
    const bool banded = points.contains("lower");
    for (const char* list : {"y", "lower", "upper"})
        if ((banded || std::string_view(list) == "y") &&
            points.at(list).size() != points.at("x").size())
            throw Failure(fmt::format("report.json, figures, {}", list),
                          fmt::format("it has {} values for {} of x", points.at(list).size(),
                                      points.at("x").size()),
                          "Take the original report, or certify the attempt again");
    std::string block = "$" + name + " << EOD\n";
    for (std::size_t i = 0; i < points["x"].size(); ++i) {
        if (!points["y"][i].is_null()) {
            block += number(points["x"][i]) + ' ' + number(points["y"][i]);
            if (banded)
                block += ' ' + number(points["lower"][i]) + ' ' + number(points["upper"][i]);
        }
        block += '\n';
    }
    return block + "EOD\n";
}

std::string curve_style(const Json& curve) {
    const std::string kind = curve["curve_kind"].get<std::string>();
    const std::string colour = "linecolor rgb " + curve["colour"].get<std::string>();
    if (kind == "points") return "with points pointtype 7 pointsize 0.4 " + colour;
    return (kind == "dashed" ? "with lines dashtype 4 linewidth 1.3 "
                             : "with lines linewidth 1.7 ") +
           colour;
}

/// What `plot` draws, in order.
struct Plots {
    std::string blocks;
    std::vector<std::string> items;
    std::size_t longest_title = 0;

    /// A line in the legend.
    std::string title(const std::string& text) {
        longest_title = std::max(longest_title, text.size());
        return "title " + quoted(text);
    }
};

void add_curves(Plots& plots, const Json& curves) {
    for (const Json& curve : curves) {
        const std::string name = fmt::format("data{}", plots.items.size());
        plots.blocks += data_block(name, curve);
        if (curve.contains("lower"))
            plots.items.push_back(fmt::format(
                "${} using 1:3:4 with filledcurves fillstyle solid 0.28 noborder linecolor rgb {} "
                "notitle",
                name, curve["colour"].get<std::string>()));
        plots.items.push_back(fmt::format("${} using 1:2 {} {}", name, curve_style(curve),
                                          plots.title(curve["curve_name"].get<std::string>())));
    }
}

/// "surface" of "surface, begin": a craft is drawn where the window begins and where it ends, and
/// the legend has each of its lines once.
std::string kind_of_segment(const std::string& name) {
    for (const std::string_view at : {", begin", ", end"})
        if (name.ends_with(at)) return name.substr(0, name.size() - at.size());
    return name;
}

void add_segments(Plots& plots, const Json& segments) {
    std::set<std::string> shown;
    for (const Json& segment : segments) {
        const std::string name = fmt::format("data{}", plots.items.size());
        plots.blocks += data_block(name, segment);
        const std::string kind = kind_of_segment(segment["segment_name"].get<std::string>());
        // The caption says what the arrow is: a legend is as wide as a narrow figure leaves it.
        const bool is_arrow = kind == "north" || kind == "second axis of the plane";
        const char* const colour = kind == "surface"          ? "green"
                                   : kind == "level"          ? "grey"
                                   : kind == "to the antenna" ? "orange"
                                                              : "black";
        const bool has_line = !is_arrow && shown.insert(kind).second;
        plots.items.push_back(
            fmt::format("${} using 1:2 with lines linewidth 2.2 linecolor rgb {} {}", name, colour,
                        has_line ? plots.title(kind) : "notitle"));
    }
}

void add_levels(Plots& plots, const Json& levels) {
    int dashes = 2;
    for (const Json& level : levels)
        plots.items.push_back(fmt::format(
            "{} with lines dashtype {} linewidth 1.4 linecolor rgb vermilion {}",
            number(level["level"]), dashes++, plots.title(level["level_name"].get<std::string>())));
}

struct SpanStyle {
    const char* kind;
    const char* title;
    const char* fill;
    const char* foot;  ///< how high it reaches, in heights of the figure
};

constexpr SpanStyle span_styles[] = {
    {"window", "window", "rgb sky fillstyle solid 0.40", "1"},
    {"refused", "refused window", "rgb orange fillstyle solid 0.30", "1"},
    {"unusable", "epochs not used", "rgb black fillstyle solid 1.0", "0.025"},
    {"gap", "gap", "rgb black fillstyle solid 0.18", "1"}};

/// The shaded stretches, and one line in the legend for each kind of them.
std::string span_objects(Plots& plots, const Json& spans) {
    std::string objects;
    std::set<std::string> shown;
    int count = 0;
    for (const SpanStyle& style : span_styles)
        for (const Json& span : spans) {
            if (span["span_kind"] != style.kind) continue;
            objects += fmt::format(
                "set object {} rect from {}, graph 0 to {}, graph {} behind fillcolor {} "
                "noborder\n",
                ++count, number(span["from"]), number(span["to"]), style.foot, style.fill);
            if (shown.insert(style.kind).second)
                plots.items.push_back(fmt::format("NaN with boxes fillcolor {} noborder {}",
                                                  style.fill, plots.title(style.title)));
        }
    return objects;
}

std::string marks(const Json& list) {
    std::string labels;
    int count = 0;
    for (const Json& mark : list) {
        ++count;
        labels += fmt::format(
            "set label {} {} at {}, {} {} front point pointtype 6 pointsize 1.1 linewidth 1.8 "
            "linecolor rgb black\n",
            count, quoted("  " + mark["mark_name"].get<std::string>() + "  "), number(mark["x"]),
            number(mark["y"]), count % 2 == 1 ? "right" : "left");
    }
    return labels;
}

/// Those of the first page stand two beside each other.
bool is_small(const Json& figure) {
    return figure["figure"] == "place" || figure["figure"] == "result";
}

/// High enough for the legend, and for a track of its own shape between a band and a square.
int height_of(const Json& figure) {
    const auto length = [&](const char* from, const char* to) {
        return figure[to].get<double>() - figure[from].get<double>();
    };
    if (is_small(figure)) return 215;
    constexpr double bar = 17.0;  // of a satellite
    if (figure["figure"] == "satellites")
        return 130 + static_cast<int>(bar * length("y_min", "y_max"));
    if (!figure["equal_scale"].get<bool>()) return figure["figure"] == "window" ? 360 : 320;
    const double shape = length("y_min", "y_max") / length("x_min", "x_max");
    return static_cast<int>(std::clamp(620.0 * shape, 170.0, 430.0)) + 90;
}

/// At most six ticks along the longer axis, of a small figure three, on both a step of 1, 2 or 5
/// times a power of ten.
std::string equal_scale(const Json& figure) {
    if (!figure["equal_scale"].get<bool>()) return {};
    const double length = std::max(figure["x_max"].get<double>() - figure["x_min"].get<double>(),
                                   figure["y_max"].get<double>() - figure["y_min"].get<double>());
    const double ticks = is_small(figure) ? 3.0 : 6.0;
    const double power = std::pow(10.0, std::floor(std::log10(length / ticks)));
    const double times = length / ticks / power;
    const double step = power * (times <= 2.0 ? 2.0 : times <= 5.0 ? 5.0 : 10.0);
    return fmt::format("set size ratio -1\nset xtics {0}\nset ytics {0}\n", step);
}

std::string joined(const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items)
        text += (text.empty() ? "" : ", \\\n    ") + item;
    return text;
}

}  // namespace

std::string gnuplot_script(const Json& figure, const std::string& svg_file) {
    Plots plots;
    const std::string objects = span_objects(plots, figure["spans"]);
    add_levels(plots, figure["levels"]);
    add_curves(plots, figure["curves"]);
    add_segments(plots, figure["segments"]);
    // Columns of the legend are narrow, so that long titles stand in one row: short ones would
    // touch.
    constexpr std::size_t short_title = 16;
    const char* const key = is_small(figure)                     ? "set key off\n"
                            : plots.longest_title <= short_title ? "set key width 1\n"
                                                                 : "";
    return fmt::format(
        "reset\n@common\n{}{}{}{}"
        "set terminal svg size {},{} font 'DejaVu Sans,13' name 'figure' background 'white'\n"
        "set output {}\nset xlabel {} noenhanced offset 0, 0.5\nset ylabel {} noenhanced\n"
        "{}set xrange [{}:{}]\nset yrange [{}:{}]\nplot {}\nset output\n",
        key, plots.blocks, objects, marks(figure["marks"]),
        is_small(figure) ? small_width : figure_width, height_of(figure), quoted(svg_file),
        quoted(figure["x_label"]), quoted(figure["y_label"]), equal_scale(figure),
        number(figure["x_min"]), number(figure["x_max"]), number(figure["y_min"]),
        number(figure["y_max"]), joined(plots.items));
}

}  // namespace runcert

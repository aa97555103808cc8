#include "reports/plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/text.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr double not_drawn = std::numeric_limits<double>::quiet_NaN();

/// A value that is not finite is null.
Json list_json(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values)
        list.push_back(std::isfinite(value) ? Json(value) : Json());
    return list;
}

std::vector<double> list_of(const Json& json) {
    std::vector<double> values;
    for (const Json& value : json)
        values.push_back(value.is_null() ? not_drawn : value.get<double>());
    return values;
}

Json curve_json(const Curve& curve) {
    Json json{{"curve_name", curve.name},
              {"curve_kind", curve.kind},
              {"colour", curve.colour},
              {"x", list_json(curve.x)},
              {"y", list_json(curve.y)}};
    if (curve.lower.empty()) return json;
    json["lower"] = list_json(curve.lower);
    json["upper"] = list_json(curve.upper);
    return json;
}

Curve read_curve(const Json& json) {
    Curve curve{json.at("curve_name"), json.at("curve_kind"), json.at("colour")};
    curve.x = list_of(json.at("x"));
    curve.y = list_of(json.at("y"));
    curve.lower = list_of(json.value("lower", Json::array()));
    curve.upper = list_of(json.value("upper", Json::array()));
    for (const auto* list : {&curve.y, &curve.lower, &curve.upper})
        if (list->size() != curve.x.size() && (list == &curve.y || !curve.lower.empty()))
            throw std::invalid_argument(
                fmt::format("a curve has {} values for {} of x", list->size(), curve.x.size()));
    return curve;
}

template <typename Part, typename Write>
Json parts_json(const std::vector<Part>& parts, const Write& json_of) {
    Json list = Json::array();
    for (const Part& part : parts)
        list.push_back(json_of(part));
    return list;
}

Plot read_plot(const Json& json) {
    Plot plot{json.at("figure"),       json.value("figure_profile", ""),
              json.at("figure_title"), json.at("caption"),
              json.at("x_label"),      json.at("y_label"),
              json.at("equal_scale"),  json.at("x_min"),
              json.at("x_max"),        json.at("y_min"),
              json.at("y_max")};
    for (const Json& curve : json.at("curves"))
        plot.curves.push_back(read_curve(curve));
    for (const Json& level : json.at("levels"))
        plot.levels.push_back({level.at("level_name"), level.at("level")});
    for (const Json& span : json.at("spans"))
        plot.spans.push_back(
            {span.at("span_name"), span.at("span_kind"), span.at("from"), span.at("to")});
    for (const Json& mark : json.at("marks"))
        plot.marks.push_back({mark.at("mark_name"), mark.at("x"), mark.at("y")});
    for (const Json& row : json.at("rows"))
        plot.rows.push_back({row.at("row_name"), row.at("y")});
    return plot;
}

/// Limits with room where they have no extent, rounded as the report has them.
std::pair<double, double> limits(const Range& range, double share) {
    constexpr double least_span = 1e-5;  // limits are written with 6 decimals
    if (!range.least) return {0.0, 1.0};
    const double room = range.span() > least_span ? share * range.span() : 0.5;
    return {rounded(*range.least - room, 6), rounded(*range.most + room, 6)};
}

}  // namespace

void Range::widen(double value) {
    if (!std::isfinite(value)) return;
    least = least ? std::min(*least, value) : value;
    most = most ? std::max(*most, value) : value;
}

void Curve::add(double at_x, double at_y) {
    if (!std::isfinite(at_x) || !std::isfinite(at_y)) return interrupt();
    if (interrupted) {
        x.push_back(rounded(at_x, x_decimals));
        y.push_back(not_drawn);
        for (auto* list : {&lower, &upper})
            if (!list->empty()) list->push_back(not_drawn);
    }
    interrupted = false;
    x.push_back(rounded(at_x, x_decimals));
    y.push_back(rounded(at_y, y_decimals));
}

void Curve::add(double at_x, double at_y, double from, double to) {
    const std::size_t before = size();
    add(at_x, at_y);
    if (size() == before) return;
    lower.push_back(rounded(from, y_decimals));
    upper.push_back(rounded(to, y_decimals));
}

void Curve::add(double at_x, double at_y, double half_width, Range& range) {
    add(at_x, at_y, at_y - half_width, at_y + half_width);
    range.widen(at_y - half_width);
    range.widen(at_y + half_width);
}

void Curve::interrupt() {
    interrupted = !empty();
}

void Plot::add(Curve curve) {
    if (!curve.empty()) curves.push_back(std::move(curve));
}

void Plot::set_axes(const Range& x, const Range& y) {
    std::tie(x_min, x_max) = limits(x, 0.0);
    std::tie(y_min, y_max) = limits(y, 0.05);
}

Json plot_json(const Plot& plot) {
    Json json{{"figure", plot.kind},
              {"figure_title", plot.title},
              {"caption", plot.caption},
              {"x_label", plot.x_label},
              {"y_label", plot.y_label},
              {"equal_scale", plot.equal_scale},
              {"x_min", plot.x_min},
              {"x_max", plot.x_max},
              {"y_min", plot.y_min},
              {"y_max", plot.y_max},
              {"curves", parts_json(plot.curves, curve_json)}};
    json["levels"] = parts_json(plot.levels, [](const PlotLevel& level) {
        return Json{{"level_name", level.name}, {"level", level.level}};
    });
    json["spans"] = parts_json(plot.spans, [](const PlotSpan& span) {
        return Json{{"span_name", span.name},
                    {"span_kind", span.kind},
                    {"from", rounded(span.from, 6)},
                    {"to", rounded(span.to, 6)}};
    });
    json["marks"] = parts_json(plot.marks, [](const PlotMark& mark) {
        return Json{{"mark_name", mark.name}, {"x", rounded(mark.x, 3)}, {"y", rounded(mark.y, 3)}};
    });
    json["rows"] = parts_json(plot.rows, [](const PlotRow& row) {
        return Json{{"row_name", row.name}, {"y", row.y}};
    });
    if (!plot.rule.empty()) json["figure_profile"] = plot.rule;
    return json;
}

Plots read_plots(const Json& figures, const std::string& where) {
    Plots read;
    try {
        for (const Json& figure : figures)
            read.push_back(read_plot(figure));
    } catch (const std::exception& error) {
        throw Failure(
            where,
            fmt::format("figure {}: {}", read.size() + 1, escape_for_message(error.what(), 200)),
            "Take the original report, or certify the attempt again");
    }
    return read;
}

void draw_plots(Json& document, const Plots& plots, bool slim_too) {
    for (Json& section : document["sections"])
        for (Json& block : section["blocks"]) {
            if (!block.contains("plots")) continue;
            const bool is_small = block.value("look", "") == "small";
            for (Json& plot : block["plots"]) {
                const auto number = plot.at("plot").get<std::size_t>();
                if (number >= plots.size())
                    throw Failure(
                        "report.json",
                        fmt::format("its document shows figure {} of {}", number + 1, plots.size()),
                        "The file was changed; take the original");
                plot["image"] = plot_svg(plots[number], is_small ? small_drawing : DrawingSize{});
                if (slim_too) plot["slim_image"] = plot_svg(plots[number], slim_drawing);
            }
        }
}

}  // namespace runcert

#include "reports/certificate/json_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/angle.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"
#include "reports/run_speeds/run_speeds.h"

namespace runcert {
namespace {

constexpr std::size_t points_of_a_line = 1000;
constexpr std::size_t points_of_a_window = 400;
constexpr std::size_t unused_bins = 400;  ///< as narrow as can be seen over the width of a page

bool is_horizontal(const RuleView& rule) {
    return rule.profile.dimension == Dimension::horizontal;
}

Json span_between(const std::string& name, const char* kind, double from, double to) {
    return {{"span_name", name},
            {"span_kind", kind},
            {"from", rounded(from, 6)},
            {"to", rounded(to, 6)}};
}

/// The windows of all rules, certified and refused, and those that make a figure with them.
Json window_spans(const std::vector<RuleView>& rules) {
    Json spans = Json::array();
    for (const RuleView& rule : rules) {
        const std::string of = ", " + rule.profile.id;
        if (rule.verdict.window) {
            add_window_span(spans, *rule.verdict.window, "window" + of, "window");
            if (rule.best() != nullptr)
                for (const FurtherWindow& further : rule.windows->further)
                    add_window_span(spans, further.span, "further window" + of, "window");
        }
        if (rule.verdict.indicated)
            add_window_span(spans, rule.verdict.indicated->span, "refused window" + of, "refused");
    }
    return spans;
}

/// Stretches of epochs that were not used; where there are very many, in bins of the time.
void add_unused_spans(Json& spans, const std::vector<ScreenedEpoch>& rows) {
    if (rows.empty()) return;
    const double begin = rows.front().time.seconds();
    const double width =
        std::max(rows.back().time.seconds() - begin, 1e-9) / static_cast<double>(unused_bins);
    double from = 0.0, to = 0.0;
    bool open = false;
    const auto close = [&] {
        if (open) spans.push_back(span_between("epochs not used", "unusable", from, to));
        open = false;
    };
    for (const ScreenedEpoch& row : rows) {
        if (row.usable) continue;
        const double time = row.time.seconds();
        if (open && time > to + width) close();
        if (!open) from = time;
        to = std::max(time, from + 0.5 * width);
        open = true;
    }
    close();
}

std::vector<const TrajectoryEpoch*> estimated(const TrajectoryTable& table) {
    std::vector<const TrajectoryEpoch*> rows;
    for (const TrajectoryEpoch& row : table.rows)
        if (row.arc && row.speed_m_s) rows.push_back(&row);
    return rows;
}

/// The curves of the methods around a window, and the range that they take.
struct MethodCurves {
    Json curves = Json::array();
    Range speeds;
};

void add_curve(MethodCurves& methods, const std::vector<const TrajectoryEpoch*>& rows,
               const CurveStyle& style, std::optional<double> TrajectoryEpoch::*speed,
               const SpeedUnit& unit) {
    Curve curve(style);
    std::optional<std::int64_t> arc;
    for (const TrajectoryEpoch* row : rows) {
        if (row->arc != arc) curve.interrupt();
        arc = row->arc;
        if (!(row->*speed)) continue;
        const double value = *(row->*speed) * unit.per_m_s;
        if (speed == &TrajectoryEpoch::speed_m_s && row->sigma_speed_m_s)
            curve.add(row->time.seconds(), value, 2.0 * *row->sigma_speed_m_s * unit.per_m_s,
                      methods.speeds);
        else
            curve.add(row->time.seconds(), value);
        if (speed != &TrajectoryEpoch::speed_kalman_m_s) methods.speeds.widen(value);
    }
    if (!curve.empty()) methods.curves.push_back(curve.json());
}

/// Those that differ most from the others come first, so that they do not hide them.
MethodCurves method_curves(const std::vector<const TrajectoryEpoch*>& rows, const SpeedUnit& unit) {
    MethodCurves methods;
    add_curve(methods, rows, {"method v1 of [DHD22]", "points", "green"},
              &TrajectoryEpoch::speed_v1_m_s, unit);
    add_curve(methods, rows, {"method v2 of [DHD22]", "points", "vermilion"},
              &TrajectoryEpoch::speed_v2_m_s, unit);
    add_curve(methods, rows, {"forward filter of [DHD22]", "dashed", "purple"},
              &TrajectoryEpoch::speed_kalman_m_s, unit);
    add_curve(methods, rows, {"smoothed, ± 2 standard uncertainties", "line", "blue"},
              &TrajectoryEpoch::speed_m_s, unit);
    add_curve(methods, rows, {"batch least squares", "dashed", "black"},
              &TrajectoryEpoch::speed_batch_m_s, unit);
    return methods;
}

std::vector<const TrajectoryEpoch*> rows_around(const TrajectoryTable& table, double from,
                                                double to) {
    std::vector<const TrajectoryEpoch*> rows;
    for (const TrajectoryEpoch* row : estimated(table))
        if (row->time.seconds() >= from && row->time.seconds() <= to) rows.push_back(row);
    const std::size_t every = 1 + rows.size() / points_of_a_window;
    std::vector<const TrajectoryEpoch*> thinned;
    for (std::size_t i = 0; i < rows.size(); i += every)
        thinned.push_back(rows[i]);
    return thinned;
}

std::string window_caption(const RuleView& rule) {
    return std::string(
               "Smoothed speed with a band of twice its standard uncertainty, and the speeds by "
               "other methods. Shaded: the window. Straight across it: the speed that counts. "
               "Dashed: the required speed, where it is within the figure.") +
           (is_horizontal(rule)
                ? ""
                : " The rule counts another than the horizontal speed, so that neither is drawn.");
}

/// The speed that counts, over its window, and the required speed where it is near.
void add_counting_speeds(Json& figure, Range& speeds, const RuleView& rule) {
    const double per_m_s = rule.unit().per_m_s;
    const WindowSpan& span = *rule.verdict.window;
    if (rule.verdict.speed_m_s) {
        const double speed = *rule.verdict.speed_m_s * per_m_s;
        const double start = span.start.seconds();
        speeds.widen(speed);
        figure["segments"].push_back(
            {{"segment_name", "speed that counts"},
             {"x", {rounded(start, 6), rounded(start + span.duration.seconds(), 6)}},
             {"y", {rounded(speed, 4), rounded(speed, 4)}}});
    }
    if (!rule.verdict.required_speed_m_s || !speeds.least) return;
    const double required_speed = *rule.verdict.required_speed_m_s * per_m_s;
    const double room = std::max(speeds.span(), 0.1);
    if (required_speed >= *speeds.least - room && required_speed <= *speeds.most + room)
        add_required_speed(figure, speeds, rule.verdict, rule.unit());
}

/// The horizontal speed over the whole run.
Json speed_figure(const ReceiverResults& results, const std::vector<RuleView>& rules) {
    const SpeedUnit& unit = rules.front().unit();
    const auto rows = estimated(results.trajectory);
    const std::size_t every = thinning(results.trajectory.rows.size());
    Json figure = empty_figure(
        "speed", "Horizontal speed over the whole run",
        "Smoothed speed; the line is broken where the recording is. Marked at the foot: epochs "
        "that were not used. Shaded: the windows, the certified and the fastest of the raw "
        "positions where that one was refused. Dashed: the required speed." +
            thinning_words(every),
        time_label, fmt::format("horizontal speed ({})", unit.name));
    Curve curve({"smoothed speed", "line", "blue"});
    Range times, speeds;
    speeds.widen(0.0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool begins = i == 0 || rows[i]->arc != rows[i - 1]->arc;
        times.widen(rows[i]->time.seconds());
        speeds.widen(*rows[i]->speed_m_s * unit.per_m_s);
        if (begins) curve.interrupt();
        if (begins || i % every == 0)
            curve.add(rows[i]->time.seconds(), *rows[i]->speed_m_s * unit.per_m_s);
    }
    figure["curves"].push_back(curve.json());
    for (const RuleView& rule : rules)
        if (is_horizontal(rule)) add_required_speed(figure, speeds, rule.verdict, unit);
    figure["spans"] = window_spans(rules);
    add_unused_spans(figure["spans"], results.screened.rows);
    const auto& screened = results.screened.rows;
    for (const auto& row : {screened.begin(), std::prev(screened.end())})
        times.widen(row->time.seconds());
    set_axes(figure, *times.least, *times.most, 0.0, *speeds.most);
    return figure;
}

/// The time around a window that its figures show.
std::pair<double, double> around(const WindowSpan& window) {
    const double start = rounded(window.start.seconds(), 9);
    const double end = start + rounded(window.duration.seconds(), 9);
    const double pad = std::max(0.5 * (end - start), 1.0);
    return {start - pad, end + pad};
}

/// Around the window of one profile, with all methods.
Json window_figure(const TrajectoryTable& table, const RuleView& rule) {
    const WindowSpan& window = *rule.verdict.window;
    const SpeedUnit& unit = rule.unit();
    const auto [from, to] = around(window);
    Json figure =
        empty_figure("window", "The window under the rule " + rule.profile.id, window_caption(rule),
                     time_label, fmt::format("horizontal speed ({})", unit.name));
    figure["figure_profile"] = rule.profile.id;
    MethodCurves methods = method_curves(rows_around(table, from, to), unit);
    figure["curves"] = std::move(methods.curves);
    add_window_span(figure["spans"], window, "window, " + rule.profile.id, "window");
    if (is_horizontal(rule)) add_counting_speeds(figure, methods.speeds, rule);
    set_axes(figure, from, to, methods.speeds.least.value_or(0.0),
             methods.speeds.most.value_or(0.0));
    return figure;
}

/// The angle of the path below the horizontal.
double dive_angle_deg(const TrajectoryEpoch& row) {
    return std::atan2(-row.velocity_up_m_s.value_or(0.0), row.speed_m_s.value_or(0.0)) *
           degrees_per_radian;
}

/// The result at a glance: the speed that counts, its window and the required speed.
Json result_figure(const TrajectoryTable& table, const RuleView& rule) {
    const WindowSpan& window = *rule.verdict.window;
    const SpeedUnit& unit = rule.unit();
    const Dimension dimension = rule.profile.dimension;
    const std::string quantity =
        dimension == Dimension::horizontal ? "speed" : std::string(words_of(dimension));
    const auto [from, to] = around(window);
    Json figure = empty_figure(
        "result", capitalised(quantity) + " around the window",
        "Shaded: the window; black: the speed that counts; dashed: the required speed, where "
        "it is near.",
        time_label, fmt::format("{} ({})", quantity, unit.name));
    figure["figure_profile"] = rule.profile.id;
    Curve curve({"smoothed", "line", "blue"});
    Curve angle({"dive angle (°)", "dashed", "green"});
    Range speeds;
    for (const TrajectoryEpoch* row : rows_around(table, from, to)) {
        const auto speed = speed_in(*row, dimension);
        if (!speed) continue;
        curve.add(row->time.seconds(), *speed * unit.per_m_s);
        speeds.widen(*speed * unit.per_m_s);
        if (dimension == Dimension::horizontal) continue;
        angle.add(row->time.seconds(), dive_angle_deg(*row));
        speeds.widen(dive_angle_deg(*row));
    }
    curve.add_to(figure);
    angle.add_to(figure);
    add_window_span(figure["spans"], window, "window", "window");
    add_counting_speeds(figure, speeds, rule);
    if (!figure["levels"].empty()) figure["levels"][0]["level_name"] = "required speed";
    set_axes(figure, from, to, speeds.least.value_or(0.0), speeds.most.value_or(0.0));
    return figure;
}

}  // namespace

Curve::Curve(const CurveStyle& style)
    : json_{{"curve_name", style.name},
            {"curve_kind", style.kind},
            {"colour", style.colour},
            {"x", Json::array()},
            {"y", Json::array()}},
      style_(style) {}

void Curve::add(double x, double y) {
    if (interrupted_) {
        json_["x"].push_back(rounded(x, style_.x_decimals));
        for (const char* values : {"y", "lower", "upper"})
            if (json_.contains(values)) json_[values].push_back(nullptr);
    }
    interrupted_ = false;
    json_["x"].push_back(rounded(x, style_.x_decimals));
    json_["y"].push_back(rounded(y, style_.y_decimals));
}

void Curve::add(double x, double y, double lower, double upper) {
    if (empty()) json_["lower"] = json_["upper"] = Json::array();
    add(x, y);
    json_["lower"].push_back(rounded(lower, style_.y_decimals));
    json_["upper"].push_back(rounded(upper, style_.y_decimals));
}

void Curve::add(double x, double y, double half_width, Range& range) {
    add(x, y, y - half_width, y + half_width);
    range.widen(y - half_width);
    range.widen(y + half_width);
}

void Curve::add_to(Json& figure) const {
    if (!empty()) figure["curves"].push_back(json_);
}

void Curve::interrupt() {
    interrupted_ = !empty();
}

void Range::widen(double value) {
    least = least ? std::min(*least, value) : value;
    most = most ? std::max(*most, value) : value;
}

void add_window_span(Json& spans, const WindowSpan& window, const std::string& name,
                     const char* kind) {
    const double start = window.start.seconds();
    spans.push_back(span_between(name, kind, start, start + window.duration.seconds()));
}

std::size_t thinning(std::size_t rows) {
    return 1 + rows / points_of_a_line;
}

std::string thinning_words(std::size_t every) {
    return every > 1 ? fmt::format(" One epoch in {} is drawn.", every) : "";
}

Json empty_figure(const std::string& kind, const std::string& title, const std::string& caption,
                  const std::string& x_label, const std::string& y_label) {
    return {{"figure", kind},          {"figure_title", title},    {"caption", caption},
            {"x_label", x_label},      {"y_label", y_label},       {"equal_scale", false},
            {"curves", Json::array()}, {"levels", Json::array()},  {"spans", Json::array()},
            {"marks", Json::array()},  {"segments", Json::array()}};
}

void set_axes(Json& figure, double x_min, double x_max, double y_min, double y_max) {
    constexpr double least_span = 1e-5;  // limits are written with 6 decimals
    const double x_room = x_max - x_min > least_span ? 0.0 : 0.5;
    const double y_room = y_max - y_min > least_span ? 0.05 * (y_max - y_min) : 0.5;
    figure["x_min"] = rounded(x_min - x_room, 6);
    figure["x_max"] = rounded(x_max + x_room, 6);
    figure["y_min"] = rounded(y_min - y_room, 6);
    figure["y_max"] = rounded(y_max + y_room, 6);
}

void add_level(Json& figure, const std::string& name, double level) {
    figure["levels"].push_back({{"level_name", name}, {"level", level}});
}

void add_required_speed(Json& figure, Range& speeds, const ProfileVerdict& verdict,
                        const SpeedUnit& unit) {
    if (!verdict.required_speed_m_s) return;
    const double required_speed = *verdict.required_speed_m_s * unit.per_m_s;
    speeds.widen(required_speed);
    add_level(figure, "required speed, " + verdict.profile, required_speed);
}

void add_mark(Json& figure, const std::string& name, double x, double y) {
    figure["marks"].push_back({{"mark_name", name}, {"x", rounded(x, 3)}, {"y", rounded(y, 3)}});
}

Json figures_json(const ReportInputs& inputs) {
    Json figures = Json::array();
    const ReceiverResults& judged = inputs.receivers.front();
    if (estimated(judged.trajectory).size() < 2) return figures;
    const std::vector<RuleView> rules = rule_views(inputs);
    const auto seen = std::ranges::find_if(
        rules, [](const RuleView& rule) { return rule.verdict.window.has_value(); });
    figures.push_back(place_figure(inputs));
    if (seen != rules.end()) figures.push_back(result_figure(judged.trajectory, *seen));
    for (const RuleView& rule : rules) {
        if (!rule.verdict.window) continue;
        Json figure = window_figure(judged.trajectory, rule);
        if (inputs.phase_view && is_horizontal(rule))
            add_phase_speed(figure, *inputs.phase_view, rule.unit());
        figures.push_back(std::move(figure));
    }
    for (Json& figure : average_figures(inputs))
        figures.push_back(std::move(figure));
    figures.push_back(speed_figure(judged, rules));
    figures.push_back(track_figure(inputs));
    for (const Json& figure :
         std::array{ground_figure(inputs), residual_figure(judged), test_figure(judged.screened)})
        if (!figure.is_null()) figures.push_back(figure);
    if (seen != rules.end())
        for (Json& figure : attitude_figures(inputs, *seen))
            figures.push_back(std::move(figure));
    if (inputs.phase_view && seen != rules.end())
        for (Json& figure : phase_figures(*inputs.phase_view, *seen->verdict.window))
            figures.push_back(std::move(figure));
    return figures;
}

}  // namespace runcert

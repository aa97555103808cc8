#include "reports/inspection/inspection_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/speed_unit.h"
#include "reports/certificate/json_figures.h"
#include "reports/certificate/report_run.h"
#include "reports/document/document_html.h"

namespace runcert {

std::string_view inspection_page_text(std::string_view name);

namespace {

constexpr const char* drawn_unit = "km/h";

void add_gaps(Json& figure, const Json& track) {
    for (const Json& gap : track["gaps"])
        figure["spans"].push_back(
            {{"span_name", "gap"}, {"span_kind", "gap"}, {"from", gap[0]}, {"to", gap[1]}});
}

/// A list of the track over time or over another one: broken where either has nothing and, over
/// time, at gaps. Of each `every` values the least and the greatest are drawn, so that no spike is
/// left out.
void add_list(Json& figure, const Json& track, const char* across, const char* up, double factor,
              const CurveStyle& style, Range& x, Range& y) {
    const Json &xs = track[across], &ys = track[up], &times = track["time_s"];
    const std::size_t every = 2 * thinning(ys.size()) - 1;
    std::set<double> after_gap;
    for (const Json& gap : track["gaps"])
        after_gap.insert(gap[1].get<double>());
    Curve curve(style);
    const auto draw = [&](std::size_t i) {
        curve.add(xs[i].get<double>(), ys[i].get<double>() * factor);
        x.widen(xs[i].get<double>());
        y.widen(ys[i].get<double>() * factor);
    };
    const auto is_there = [&](std::size_t i) { return !xs[i].is_null() && !ys[i].is_null(); };
    for (std::size_t i = 0; i < ys.size();) {
        if (!is_there(i) || after_gap.contains(times[i].get<double>())) curve.interrupt();
        if (!is_there(i)) {
            ++i;
            continue;
        }
        std::size_t least = i, most = i, end = i + 1;
        for (; end < ys.size() && end < i + every && is_there(end) &&
               !after_gap.contains(times[end].get<double>());
             ++end) {
            if (ys[end] < ys[least]) least = end;
            if (ys[end] > ys[most]) most = end;
        }
        draw(std::min(least, most));
        if (least != most) draw(std::max(least, most));
        i = end;
    }
    curve.add_to(figure);
}

void finish(Json& figures, Json figure, const Range& x, const Range& y) {
    if (figure["curves"].empty()) return;
    set_axes(figure, *x.least, *x.most, *y.least, *y.most);
    figures.push_back(std::move(figure));
}

std::string drawn_words(const Json& track) {
    const std::size_t every = 2 * thinning(track["time_s"].size()) - 1;
    return every == 1
               ? ""
               : fmt::format(" Of {} epochs the least and the greatest value are drawn.", every);
}

void add_speeds(Json& figures, const Json& track) {
    Json figure = empty_figure("speed", "Horizontal speed",
                               "As recorded, and from each position to the next; neither is "
                               "screened or smoothed. Shaded: gaps." +
                                   drawn_words(track),
                               time_label, fmt::format("speed ({})", drawn_unit));
    Range times, speeds;
    const double factor = speed_unit(drawn_unit).per_m_s;
    add_list(figure, track, "time_s", "position_speed_m_s", factor,
             {"from positions", "points", "orange"}, times, speeds);
    add_list(figure, track, "time_s", "recorded_speed_m_s", factor, {"recorded", "line", "blue"},
             times, speeds);
    add_gaps(figure, track);
    finish(figures, std::move(figure), times, speeds);
}

void add_over_time(Json& figures, const Json& track, const char* list, const char* title,
                   const char* caption, const char* label) {
    Json figure = empty_figure("series", title, caption + drawn_words(track), time_label, label);
    Range times, values;
    add_list(figure, track, "time_s", list, 1.0, {"recorded", "line", "blue"}, times, values);
    add_gaps(figure, track);
    finish(figures, std::move(figure), times, values);
}

void add_track(Json& figures, const Json& track) {
    Json figure =
        empty_figure("track", "Track", "Positions from the first one on." + drawn_words(track),
                     "east (m)", "north (m)");
    figure["equal_scale"] = true;
    Range east, north;
    add_list(figure, track, "east_m", "north_m", 1.0, {"positions", "line", "blue"}, east, north);
    finish(figures, std::move(figure), east, north);
}

/// All steps: a gap is one epoch's.
void add_steps(Json& figures, const Json& track) {
    Json figure = empty_figure("steps", "Steps between epochs",
                               "From each epoch to the next; a higher point is a gap.", time_label,
                               "step (s)");
    Curve curve({"steps", "points", "blue"});
    Range times, steps;
    const Json& time = track["time_s"];
    const std::size_t every = thinning(time.size());
    const double usual = time.size() > 1 ? (time.back().get<double>() - time[0].get<double>()) /
                                               static_cast<double>(time.size() - 1)
                                         : 0.0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double at = time[i], step = at - time[i - 1].get<double>();
        if (i % every != 0 && step < 1.4 * usual) continue;
        curve.add(at, step);
        times.widen(at);
        steps.widen(step);
    }
    curve.add_to(figure);
    finish(figures, std::move(figure), times, steps);
}

}  // namespace

std::string inspection_page(Document document, const Json& track) {
    Json figures = Json::array();
    add_speeds(figures, track);
    add_track(figures, track);
    add_over_time(figures, track, "height_m", "Height", "As recorded. Shaded: gaps.", "height (m)");
    add_over_time(figures, track, "sigma_horizontal_m", "Stated uncertainty",
                  "The horizontal standard deviation that the recording states. Shaded: gaps.",
                  "standard deviation (m)");
    add_steps(figures, track);
    Section section{.anchor = "drawn", .title = "Drawn"};
    for (std::size_t i = 0; i < figures.size(); ++i)
        add(section, plot(i, figures[i]["figure_title"], figures[i]["caption"]));
    document.sections.push_back(std::move(section));
    return document_page(document, {.style = std::string(inspection_page_text("page.css")) +
                                             "body { max-width: 250mm }\n",
                                    .images = draw_figures({{"figures", figures}})});
}

}  // namespace runcert

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/speed_unit.h"
#include "reports/certificate/json_figures.h"
#include "reports/certificate/report_run.h"
#include "reports/document/document_html.h"
#include "reports/inspection/described.h"

namespace runcert {

std::string_view inspection_page_text(std::string_view name);

namespace {

/// Of so many values the least and the greatest are drawn, so that no spike is left out.
std::size_t values_for_two(const Json& track) {
    return 2 * thinning(track["time_s"].size()) - 1;
}

/// A list of the track over another one: broken where either has nothing, and at gaps.
Curve curve_of(const Json& track, const char* across, const char* list, double factor,
               const CurveStyle& style, Range& x, Range& y) {
    const Json &xs = track[across], &ys = track[list], &times = track["time_s"];
    std::set<double> after_gap;
    for (const Json& gap : track["gaps"])
        after_gap.insert(gap[1].get<double>());
    Curve curve(style);
    std::size_t values = 0, least = 0, most = 0;
    const auto draw = [&](std::size_t i) {
        curve.add(xs[i].get<double>(), ys[i].get<double>() * factor);
        x.widen(xs[i].get<double>());
        y.widen(ys[i].get<double>() * factor);
    };
    const auto draw_both = [&] {
        if (values > 0) draw(std::min(least, most));
        if (values > 0 && least != most) draw(std::max(least, most));
        values = 0;
    };
    for (std::size_t i = 0; i < times.size(); ++i) {
        const bool is_there = !xs[i].is_null() && !ys[i].is_null();
        const bool breaks = !is_there || after_gap.contains(times[i].get<double>());
        if (breaks || values == values_for_two(track)) draw_both();
        if (breaks) curve.interrupt();
        if (!is_there) continue;
        if (values == 0 || ys[i] < ys[least]) least = i;
        if (values == 0 || ys[i] > ys[most]) most = i;
        ++values;
    }
    draw_both();
    return curve;
}

using Lists = std::vector<std::pair<const char*, CurveStyle>>;

/// Adds a figure of lists over another one, where there is anything of them to draw; over time with
/// the gaps shaded.
void add_figure(Json& figures, const Json& track, Json figure, const char* across,
                const Lists& lists, double factor = 1.0) {
    Range x, y;
    for (const auto& [list, style] : lists)
        curve_of(track, across, list, factor, style, x, y).add_to(figure);
    if (figure["curves"].empty()) return;
    if (const std::size_t values = values_for_two(track); values > 1)
        figure["caption"] =
            fmt::format("{} Of {} epochs the least and the greatest value are drawn.",
                        figure["caption"].get<std::string>(), values);
    if (std::string_view(across) != "time_s")
        figure["equal_scale"] = true;
    else
        for (const Json& gap : track["gaps"])
            figure["spans"].push_back(
                {{"span_name", "gap"}, {"span_kind", "gap"}, {"from", gap[0]}, {"to", gap[1]}});
    set_axes(figure, *x.least, *x.most, *y.least, *y.most);
    figures.push_back(std::move(figure));
}

/// From each epoch to the next.
Json steps_of(const Json& times) {
    Json steps = Json::array();
    for (std::size_t i = 0; i < times.size(); ++i)
        steps.push_back(i == 0 ? Json()
                               : Json(times[i].get<double>() - times[i - 1].get<double>()));
    return steps;
}

Json figures_of(const Json& track) {
    Json figures = Json::array();
    const auto add_over_time = [&](const char* kind, const char* title, const char* caption,
                                   const char* label, const Lists& lists, double factor = 1.0) {
        add_figure(figures, track, empty_figure(kind, title, caption, time_label, label), "time_s",
                   lists, factor);
    };
    const CurveStyle recorded{"recorded", "line", "blue"};
    add_over_time("speed", "Horizontal speed",
                  "As recorded, and from each position to the next; neither is screened or "
                  "smoothed. Shaded: gaps.",
                  "speed (km/h)",
                  {{"position_speed_m_s", {"from positions", "points", "orange"}},
                   {"recorded_speed_m_s", recorded}},
                  speed_unit("km/h").per_m_s);
    add_figure(
        figures, track,
        empty_figure("track", "Track", "Positions from the first one on.", "east (m)", "north (m)"),
        "east_m", {{"north_m", {"positions", "line", "blue"}}});
    add_over_time("series", "Height", "As recorded. Shaded: gaps.", "height (m)",
                  {{"height_m", recorded}});
    add_over_time("series", "Stated uncertainty",
                  "The horizontal standard deviation that the recording states. Shaded: gaps.",
                  "standard deviation (m)", {{"sigma_horizontal_m", recorded}});
    add_over_time("steps", "Steps between epochs", "From each epoch to the next. Shaded: gaps.",
                  "step (s)", {{"step_s", {"steps", "points", "blue"}}});
    return figures;
}

}  // namespace

std::string inspection_page(Document document, Json track) {
    track["step_s"] = steps_of(track["time_s"]);
    const Json figures = figures_of(track);
    Section section{.anchor = "drawn", .title = "Drawn"};
    for (std::size_t i = 0; i < figures.size(); ++i)
        add(section, plot(i, figures[i]["figure_title"], figures[i]["caption"]));
    document.sections.push_back(std::move(section));
    return document_page(document, {.style = std::string(inspection_page_text("page.css")) +
                                             "body { max-width: 250mm }\n",
                                    .images = draw_figures({{"figures", figures}})});
}

}  // namespace runcert

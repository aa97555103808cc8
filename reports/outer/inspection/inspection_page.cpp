#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/figures.h"
#include "reports/document/document_html.h"
#include "reports/inspection/described.h"

namespace runcert {

std::string_view inspection_page_text(std::string_view name);

namespace {

using Json = nlohmann::ordered_json;

/// Of so many values the least and the greatest are drawn, so that no spike is left out.
std::size_t values_for_two(const Json& track) {
    constexpr std::size_t points = 1000;
    return 1 + 2 * (track["time_s"].size() / points);
}

/// A list of the track over another one: broken where either has nothing, and at gaps.
Curve curve_of(const Json& track, const char* across, const char* list, double factor, Curve curve,
               Range& x, Range& y) {
    const Json &xs = track[across], &ys = track[list], &times = track["time_s"];
    std::set<double> after_gap;
    for (const Json& gap : track["gaps"])
        after_gap.insert(gap[1].get<double>());
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

using Lists = std::vector<std::pair<const char*, Curve>>;

/// Adds a plot of lists over another one, where there is anything of them to draw; over time with
/// the gaps shaded.
void add_plot(Plots& plots, const Json& track, Plot plot, const char* across, const Lists& lists,
              double factor = 1.0) {
    Range x, y;
    for (const auto& [list, curve] : lists)
        plot.add(curve_of(track, across, list, factor, curve, x, y));
    if (plot.curves.empty()) return;
    if (const std::size_t values = values_for_two(track); values > 1)
        plot.caption +=
            fmt::format(" Of {} epochs the least and the greatest value are drawn.", values);
    plot.equal_scale = std::string_view(across) != "time_s";
    if (!plot.equal_scale)
        for (const Json& gap : track["gaps"])
            plot.spans.push_back({"gap", "gap", gap[0].get<double>(), gap[1].get<double>()});
    plot.set_axes(x, y);
    plots.push_back(std::move(plot));
}

/// From each epoch to the next.
Json steps_of(const Json& times) {
    Json steps = Json::array();
    for (std::size_t i = 0; i < times.size(); ++i)
        steps.push_back(i == 0 ? Json()
                               : Json(times[i].get<double>() - times[i - 1].get<double>()));
    return steps;
}

Plots plots_of(const Json& track) {
    Plots plots;
    const auto add_over_time = [&](const char* title, const char* caption, const char* label,
                                   const Lists& lists, double factor = 1.0) {
        add_plot(plots, track,
                 {.title = title,
                  .caption = caption,
                  .x_label = "time from the first epoch (s)",
                  .y_label = label},
                 "time_s", lists, factor);
    };
    const Curve recorded{"recorded", "line", "blue"};
    add_over_time("Horizontal speed",
                  "As recorded, and from each position to the next; neither is screened or "
                  "smoothed.",
                  "speed (km/h)",
                  {{"position_speed_m_s", {"from positions", "points", "orange"}},
                   {"recorded_speed_m_s", recorded}},
                  speed_unit("km/h").per_m_s);
    add_plot(plots, track,
             {.title = "Track",
              .caption = "Positions from the first one on.",
              .x_label = "east (m)",
              .y_label = "north (m)"},
             "east_m", {{"north_m", {"positions", "line", "blue"}}});
    add_over_time("Height", "As recorded.", "height (m)", {{"height_m", recorded}});
    add_over_time("Stated uncertainty",
                  "The horizontal standard deviation that the recording states.",
                  "standard deviation (m)", {{"sigma_horizontal_m", recorded}});
    add_over_time("Steps between epochs", "From each epoch to the next.", "step (s)",
                  {{"step_s", {"steps", "points", "blue"}}});
    return plots;
}

}  // namespace

std::string inspection_page(Document document, Json track) {
    track["step_s"] = steps_of(track["time_s"]);
    const Plots plots = plots_of(track);
    Section section{.anchor = "drawn", .title = "Drawn"};
    for (std::size_t i = 0; i < plots.size(); ++i)
        add(section, plot(i, plots[i].title, plots[i].caption));
    document.sections.push_back(std::move(section));
    return document_page(document, {.style = std::string(inspection_page_text("page.css")) +
                                             "body { max-width: 250mm }\n",
                                    .plots = plots});
}

}  // namespace runcert

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "reports/certificate/plots.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

constexpr double mm_per_m = 1000.0;
constexpr double longest_step_s = 1.5;  ///< between epochs of a line that is not broken

/// The sky from above: zenith in the middle, north up, the horizon around it.
Eigen::Vector2d on_the_sky(double azimuth_deg, double elevation_deg) {
    const double azimuth = azimuth_deg * radians_per_degree;
    return (90.0 - elevation_deg) * Eigen::Vector2d(std::sin(azimuth), std::cos(azimuth));
}

Plot sky_plot(const PhaseView& view) {
    Plot plot{.kind = "sky",
              .title = "Satellites in the sky around the window",
              .caption =
                  "Seen from above: the zenith in the middle, north up, the horizon the "
                  "outer circle, elevations of 30 and 60 degrees within it.",
              .x_label = "degrees from the zenith, towards east",
              .y_label = "degrees from the zenith, towards north",
              .equal_scale = true};
    Curve rings{"", "outline", "grey", 2, 2}, used{"phases used", "points", "blue", 2, 2},
        others{"not used", "points", "orange", 2, 2};
    for (const double elevation_deg : {0.0, 30.0, 60.0}) {
        rings.interrupt();
        for (int degree = 0; degree <= 360; degree += 5) {
            const Eigen::Vector2d at = on_the_sky(degree, elevation_deg);
            rings.add(at.x(), at.y());
        }
    }
    for (const SatelliteTrack& track : view.satellites) {
        if (track.epochs.empty()) continue;
        const auto place = [](const SatelliteInView& seen) {
            return on_the_sky(seen.azimuth_deg, seen.elevation_deg);
        };
        const std::size_t every = thinning(track.epochs.size(), 20);
        for (std::size_t k = 0; k < track.epochs.size(); k += every) {
            const Eigen::Vector2d at = place(track.epochs[k]);
            (track.epochs[k].used ? used : others).add(at.x(), at.y());
        }
        const Eigen::Vector2d at = place(track.epochs[track.epochs.size() / 2]);
        plot.marks.push_back({to_text(track.satellite), at.x(), at.y()});
    }
    for (Curve* curve : {&rings, &used, &others})
        plot.add(std::move(*curve));
    plot.set_axes({-95.0, 95.0}, {-90.0, 90.0});
    return plot;
}

/// A bar of a satellite, broken where its phase is not used.
void add_bar(Curve& curve, const SatelliteTrack& track, double row) {
    curve.interrupt();
    const SatelliteInView* last = nullptr;
    for (const SatelliteInView& seen : track.epochs) {
        if (!seen.used || (last && seen.time_s - last->time_s > longest_step_s)) curve.interrupt();
        if (seen.used) curve.add(seen.time_s, row);
        last = &seen;
    }
}

Plot bars_plot(const PhaseView& view, const WindowSpan& window, const Range& times) {
    Plot plot{.kind = "satellites",
              .title = "Satellites whose phases were used, over time",
              .caption =
                  "A bar for each satellite, broken where its phase was not used. A "
                  "phase that slipped by whole cycles is not used across the slip.",
              .x_label = time_label,
              .spans = {window_span(window)}};
    Curve bars{"phase used", "line", "blue", 3, 0}, slips{"slip", "points", "vermilion", 3, 0};
    for (const SatelliteTrack& track : view.satellites) {
        if (std::ranges::none_of(track.epochs, &SatelliteInView::used)) continue;
        const double row = static_cast<double>(plot.rows.size() + 1);
        add_bar(bars, track, row);
        for (const double time_s : track.slips_s)
            slips.add(time_s, row);
        plot.rows.push_back({to_text(track.satellite), row});
    }
    const double height = static_cast<double>(plot.rows.size()) + 1.0;
    plot.add(std::move(bars));
    plot.add(std::move(slips));
    for (const double time_s : view.refused_s)
        plot.spans.push_back(
            {"pair of epochs that could not be judged", "unusable", time_s - 0.05, time_s});
    plot.set_axes(times, {0.0, height});
    plot.y_min = 0.0;
    plot.y_max = height;
    return plot;
}

Plot residuals_plot(const PhaseView& view, const Range& times) {
    constexpr std::size_t points_of_a_cloud = 1500;
    const std::size_t every = thinning(view.residuals_m.size(), points_of_a_cloud);
    Curve residuals{"residual of a satellite", "points", "blue", 3, 2};
    std::vector<double> sigmas;
    Range values;
    for (std::size_t k = 0; k < view.residuals_m.size(); ++k) {
        const ViewedValue& one = view.residuals_m[k];
        sigmas.push_back(one.standard_uncertainty * mm_per_m);
        if (k % every != 0) continue;
        residuals.add(one.time_s, one.value * mm_per_m);
        values.widen(one.value * mm_per_m);
        values.widen(-one.value * mm_per_m);
    }
    std::ranges::nth_element(sigmas, sigmas.begin() + std::ssize(sigmas) / 2);
    const double bound = 2.0 * sigmas[sigmas.size() / 2];
    values.widen(bound);
    values.widen(-bound);
    Plot plot{.kind = "phase_residuals",
              .title = "Residuals of the phases from epoch to epoch",
              .caption = fmt::format(
                  "By how much each satellite's phase differs from the displacement of all.{} "
                  "Dashed: twice the median of the standard deviations that they were "
                  "weighted with.",
                  every > 1 ? fmt::format(" One in {} is drawn.", every) : ""),
              .x_label = time_label,
              .y_label = "residual (mm)",
              .levels = {{"+ 2 standard deviations", bound}, {"− 2 standard deviations", -bound}}};
    plot.add(std::move(residuals));
    plot.set_axes(times, values);
    return plot;
}

Plot apart_plot(const PhaseView& view, const WindowSpan& window, const Range& times) {
    Plot plot{.kind = "phase_displacement",
              .title = "Displacement by positions less that by phases",
              .caption = fmt::format(
                  "Over {:g} s, at the end of each such stretch; the band is twice the "
                  "standard uncertainty of the phases. At the window's end stands what the "
                  "certificate compares.",
                  window.duration.seconds()),
              .x_label = time_label,
              .y_label = "difference (mm)",
              .levels = {{"no difference", 0.0}},
              .spans = {window_span(window)}};
    Range values;
    for (const auto& [name, colour, list] : {std::tuple{"east", "blue", &view.apart_east_m},
                                             std::tuple{"north", "orange", &view.apart_north_m}}) {
        Curve curve{name, "line", colour, 3, 2};
        add_values(curve, values, *list, {*times.least, *times.most}, mm_per_m);
        plot.add(std::move(curve));
    }
    plot.set_axes(times, values);
    return plot;
}

}  // namespace

void add_values(Curve& curve, Range& range, const std::vector<ViewedValue>& values,
                std::pair<double, double> span, double factor) {
    const ViewedValue* last = nullptr;
    for (const ViewedValue& one : values) {
        if (one.time_s < span.first || one.time_s > span.second) continue;
        if (last && one.time_s - last->time_s > longest_step_s) curve.interrupt();
        curve.add(one.time_s, one.value * factor, 2.0 * one.standard_uncertainty * factor, range);
        last = &one;
    }
}

Plots phase_plots(const ReportInputs& inputs) {
    const std::vector<RuleView> rules = rule_views(inputs);
    const RuleView* const rule = first_certified(rules);
    if (!inputs.phase_view || rule == nullptr) return {};
    const PhaseView& view = *inputs.phase_view;
    const WindowSpan& window = *rule->verdict.window;
    Range times;
    for (const SatelliteTrack& track : view.satellites)
        for (const SatelliteInView& seen : track.epochs)
            times.widen(seen.time_s);
    if (!(times.span() > 0.0)) return {};
    Plots plots{sky_plot(view), bars_plot(view, window, times)};
    if (!view.residuals_m.empty()) plots.push_back(residuals_plot(view, times));
    if (!view.apart_east_m.empty()) plots.push_back(apart_plot(view, window, times));
    return plots;
}

}  // namespace runcert

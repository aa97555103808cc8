#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "reports/certificate/json_figures.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

constexpr double mm_per_m = 1000.0;
constexpr std::size_t points_of_a_cloud = 1500;
constexpr double longest_step_s = 1.5;  ///< between epochs of a line that is not broken

/// The sky from above: zenith in the middle, north up, the horizon around it.
Eigen::Vector2d on_the_sky(double azimuth_deg, double elevation_deg) {
    const double azimuth = azimuth_deg * radians_per_degree;
    return (90.0 - elevation_deg) * Eigen::Vector2d(std::sin(azimuth), std::cos(azimuth));
}

/// The horizon and two circles within it, as one line with breaks.
Json rings() {
    Json x = Json::array(), y = Json::array();
    for (const double elevation_deg : {0.0, 30.0, 60.0}) {
        for (int degree = 0; degree <= 360; degree += 5) {
            const Eigen::Vector2d at = on_the_sky(degree, elevation_deg);
            x.push_back(rounded(at.x(), 2));
            y.push_back(rounded(at.y(), 2));
        }
        x.push_back(0.0);
        y.push_back(nullptr);
    }
    return {
        {"segment_name", "horizon, 30 and 60 degrees"}, {"x", std::move(x)}, {"y", std::move(y)}};
}

Json sky_figure(const PhaseView& view) {
    Json figure = empty_figure(
        "sky", "Satellites in the sky around the window",
        "Seen from above: the zenith in the middle, north up, the horizon the outer circle, "
        "elevations of 30 and 60 degrees within it. Satellites whose phases were used, and those "
        "that were not.",
        "degrees from the zenith, towards east", "degrees from the zenith, towards north");
    figure["equal_scale"] = true;
    Curve used({"phases used", "points", "blue", 2, 2});
    Curve others({"not used", "points", "grey", 2, 2});
    for (const SatelliteTrack& track : view.satellites) {
        if (track.epochs.empty()) continue;
        const std::size_t every = 1 + track.epochs.size() / 20;
        for (std::size_t k = 0; k < track.epochs.size(); k += every) {
            const SatelliteInView& seen = track.epochs[k];
            const Eigen::Vector2d at = on_the_sky(seen.azimuth_deg, seen.elevation_deg);
            (seen.used ? used : others).add(at.x(), at.y());
        }
        const SatelliteInView& middle = track.epochs[track.epochs.size() / 2];
        const Eigen::Vector2d at = on_the_sky(middle.azimuth_deg, middle.elevation_deg);
        add_mark(figure, to_text(track.satellite), at.x(), at.y());
    }
    used.add_to(figure);
    others.add_to(figure);
    figure["segments"].push_back(rings());
    set_axes(figure, -95.0, 95.0, -90.0, 90.0);
    return figure;
}

/// Values between two times, `factor` times themselves, with bands of twice their standard
/// uncertainty; the line breaks where they are further apart than epochs are.
void add_values(Curve& curve, Range& range, const std::vector<ViewedValue>& values, double from_s,
                double to_s, double factor) {
    const ViewedValue* last = nullptr;
    for (const ViewedValue& one : values) {
        if (one.time_s < from_s || one.time_s > to_s) continue;
        if (last && one.time_s - last->time_s > longest_step_s) curve.interrupt();
        curve.add(one.time_s, one.value * factor, 2.0 * one.standard_uncertainty * factor, range);
        last = &one;
    }
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

Json bars_figure(const PhaseView& view, const WindowSpan& window, double from_s, double to_s) {
    Json figure = empty_figure(
        "satellites", "Satellites whose phases were used, over time",
        "A bar for each satellite, broken where its phase was not used. Points: a phase slipped by "
        "whole cycles, and is not used across them. Marked at the foot: pairs of epochs that could "
        "not be judged. Shaded: the window.",
        time_label, "satellite");
    Curve bars({"phase used", "line", "blue", 3, 0});
    Curve slips({"slip", "points", "vermilion", 3, 0});
    double row = 0.0;
    const auto is_used = [](const SatelliteTrack& track) {
        return std::ranges::any_of(track.epochs, &SatelliteInView::used);
    };
    for (const SatelliteTrack& track : view.satellites) {
        if (!is_used(track)) continue;
        row += 1.0;
        add_bar(bars, track, row);
        for (const double time_s : track.slips_s)
            slips.add(time_s, row);
        add_mark(figure, to_text(track.satellite), from_s + 0.06 * (to_s - from_s), row);
    }
    bars.add_to(figure);
    slips.add_to(figure);
    add_window_span(figure["spans"], window, "window", "window");
    for (const double time_s : view.refused_s)
        figure["spans"].push_back({{"span_name", "pair of epochs that could not be judged"},
                                   {"span_kind", "unusable"},
                                   {"from", rounded(time_s - 0.05, 6)},
                                   {"to", rounded(time_s, 6)}});
    set_axes(figure, from_s, to_s, 0.0, row + 1.0);
    return figure;
}

Json residuals_figure(const PhaseView& view, double from_s, double to_s) {
    const std::size_t every = 1 + view.residuals_m.size() / points_of_a_cloud;
    Json figure = empty_figure(
        "phase_residuals", "Residuals of the phases from epoch to epoch",
        fmt::format("By how much each satellite's phase differs from the displacement of all.{} "
                    "Dashed: twice the median of the standard deviations that they were weighted "
                    "with.",
                    every > 1 ? fmt::format(" One in {} is drawn.", every) : ""),
        time_label, "residual (mm)");
    Curve residuals({"residual of a satellite", "points", "blue", 3, 2});
    std::vector<double> sigmas;
    Range values;
    for (std::size_t k = 0; k < view.residuals_m.size(); ++k) {
        const ViewedValue& one = view.residuals_m[k];
        sigmas.push_back(one.standard_uncertainty * mm_per_m);
        if (k % every != 0) continue;
        residuals.add(one.time_s, one.value * mm_per_m);
        values.widen(std::abs(one.value) * mm_per_m);
    }
    std::ranges::nth_element(sigmas, sigmas.begin() + std::ssize(sigmas) / 2);
    const double bound = 2.0 * sigmas[sigmas.size() / 2];
    values.widen(bound);
    figure["curves"].push_back(residuals.json());
    for (const double sign : {1.0, -1.0})
        add_level(figure, sign > 0.0 ? "+ 2 standard deviations" : "- 2 standard deviations",
                  rounded(sign * bound, 3));
    set_axes(figure, from_s, to_s, -*values.most, *values.most);
    return figure;
}

Json apart_figure(const PhaseView& view, const WindowSpan& window, double from_s, double to_s) {
    Json figure = empty_figure(
        "phase_displacement", "Displacement by positions less that by phases",
        fmt::format("Over {:g} s, at the end of each such stretch; the band is twice the standard "
                    "uncertainty of the phases. Shaded: the window. At its end stands what the "
                    "certificate compares.",
                    window.duration.seconds()),
        time_label, "difference (mm)");
    Range values;
    const auto add = [&](const char* name, const char* colour, const std::vector<ViewedValue>& of) {
        Curve curve({name, "line", colour, 3, 2});
        add_values(curve, values, of, from_s, to_s, mm_per_m);
        curve.add_to(figure);
    };
    add("east", "blue", view.apart_east_m);
    add("north", "orange", view.apart_north_m);
    add_level(figure, "no difference", 0.0);
    add_window_span(figure["spans"], window, "window", "window");
    set_axes(figure, from_s, to_s, values.least.value_or(0.0), values.most.value_or(0.0));
    return figure;
}

}  // namespace

void add_phase_speed(Json& figure, const PhaseView& view, const SpeedUnit& unit) {
    Curve curve({"by carrier phases, ± 2 standard uncertainties", "line", "vermilion"});
    const double from_s = figure["x_min"].get<double>(), to_s = figure["x_max"].get<double>();
    Range speeds;
    add_values(curve, speeds, view.speed_m_s, from_s, to_s, unit.per_m_s);
    if (curve.empty()) return;
    curve.add_to(figure);
    figure["y_min"] = rounded(std::min(figure["y_min"].get<double>(), *speeds.least), 6);
    figure["y_max"] = rounded(std::max(figure["y_max"].get<double>(), *speeds.most), 6);
    figure["caption"] = figure["caption"].get<std::string>() +
                        " With it the speed by the receiver's carrier phases, from epoch to epoch.";
}

std::vector<Json> phase_figures(const PhaseView& view, const WindowSpan& window) {
    std::vector<Json> figures;
    if (view.satellites.empty()) return figures;
    Range times;
    for (const SatelliteTrack& track : view.satellites)
        for (const SatelliteInView& seen : track.epochs)
            times.widen(seen.time_s);
    if (!(times.span() > 0.0)) return figures;
    figures.push_back(sky_figure(view));
    figures.push_back(bars_figure(view, window, *times.least, *times.most));
    if (!view.residuals_m.empty())
        figures.push_back(residuals_figure(view, *times.least, *times.most));
    if (!view.apart_east_m.empty())
        figures.push_back(apart_figure(view, window, *times.least, *times.most));
    return figures;
}

}  // namespace runcert

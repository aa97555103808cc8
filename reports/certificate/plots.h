#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/certificate/certificate_document.h"
#include "reports/plot/plot.h"

// What a report draws, of the judged receiver. Nothing where there is not enough to draw.

namespace runcert {

/// The track on its course, in the plane, with the windows of all rules.
Plots track_plot(const ReportInputs& inputs);
/// The same as a small map: where the window was.
Plots place_plot(const ReportInputs& inputs);
/// Heights along the track: the surface below it, and the antenna less its height above the ground.
Plots ground_plot(const ReportInputs& inputs);
/// The horizontal speed over the whole run.
Plots speed_plot(const ReportInputs& inputs);
/// The result at a glance: the speed around the first window, or around a refused one.
Plots result_plot(const ReportInputs& inputs);
/// Around the window of a rule, with all methods and the carrier phases.
Plots window_plot(const ReportInputs& inputs, const RuleView& rule);
/// The speed over each rule's length all along the run ([DHD22] (27), figure 11): a figure for each
/// dimension that a rule counts.
Plots average_plots(const ReportInputs& inputs);
/// Measured less smoothed positions.
Plots residual_plot(const ReceiverResults& results);
/// The statistics of screening's tests over their thresholds.
Plots test_plot(const ScreenedTable& table);
/// Around the window of the first rule that has one: roll and pitch, heading and course, the speeds
/// of antenna and reference point, and the craft to scale on its surface.
Plots attitude_plots(const ReportInputs& inputs);
/// Sky, satellites over time, residuals, displacements.
Plots phase_plots(const ReportInputs& inputs);

// What they share.

/// The first rule with a certified window; null if there is none.
const RuleView* first_certified(const std::vector<RuleView>& rules);
/// From and to (s) what plots of a window show: half its length, and at least a second, on either
/// side.
std::pair<double, double> around(const WindowSpan& window);
/// The windows of all rules, certified and refused, and those that make a figure with them.
std::vector<PlotSpan> window_spans(const std::vector<RuleView>& rules);
PlotSpan window_span(const WindowSpan& window);
/// Adds values within from and to, `factor` times themselves, with bands of twice their standard
/// uncertainty; the line breaks where they are further apart than epochs are.
void add_values(Curve& curve, Range& range, const std::vector<ViewedValue>& values,
                std::pair<double, double> span, double factor);
/// A dashed line at the required speed of a rule, where it has one; widens the range.
void add_required_speed(Plot& plot, Range& speeds, const RuleView& rule);
/// Of many rows every n-th is drawn, so that no more than about so many are.
std::size_t thinning(std::size_t rows, std::size_t most = 1000);
/// So many of some rows as a plot around a window can show.
template <typename Row>
std::vector<const Row*> thinned(const std::vector<const Row*>& rows) {
    constexpr std::size_t most = 400;
    std::vector<const Row*> some;
    for (std::size_t i = 0; i < rows.size(); i += thinning(rows.size(), most))
        some.push_back(rows[i]);
    return some;
}
/// " One epoch in 20 is drawn."; empty where all are.
std::string thinning_words(std::size_t every);

constexpr const char* time_label = "time from the first epoch (s)";

}  // namespace runcert

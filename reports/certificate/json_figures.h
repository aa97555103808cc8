#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The horizontal speed over the whole run.
nlohmann::ordered_json speed_figure(const ReceiverResults& results,
                                    const nlohmann::ordered_json& profiles);
/// Around the window of one profile, with all methods.
nlohmann::ordered_json window_figure(const TrajectoryTable& table,
                                     const nlohmann::ordered_json& profile);
/// The track on its course, in the plane.
nlohmann::ordered_json track_figure(const ReportInputs& inputs,
                                    const nlohmann::ordered_json& profiles);
/// Measured less smoothed positions; null where no epoch has both.
nlohmann::ordered_json residual_figure(const ReceiverResults& results);
/// The statistics of screening's tests over their thresholds; null where there are none.
nlohmann::ordered_json test_figure(const ScreenedTable& table);

/// Adds the stretch of a window to a figure's spans, of kind "window" or "refused".
void add_window_span(nlohmann::ordered_json& spans, const nlohmann::ordered_json& window,
                     const std::string& name, const char* kind);
/// Adds the speed by carrier phases to the figure of a window.
void add_phase_speed(nlohmann::ordered_json& figure, const PhaseView& view);
/// Sky, satellites over time, residuals, and displacements beside the positions'; none where the
/// phases say nothing.
std::vector<nlohmann::ordered_json> phase_figures(const PhaseView& view,
                                                  const nlohmann::ordered_json& window);

/// What the page of the raw signals says; null where there are none.
nlohmann::ordered_json raw_signals_json(const ReceiverResults& results);

/// Begins a figure: its kind ("speed", "window", ...), words and axes; nothing is drawn yet.
nlohmann::ordered_json empty_figure(const std::string& kind, const std::string& title,
                                    const std::string& caption, const std::string& x_label,
                                    const std::string& y_label);
/// What the axes show at least, with a margin of a twentieth on either side of y.
void set_axes(nlohmann::ordered_json& figure, double x_min, double x_max, double y_min,
              double y_max);

/// A line is thinned to about as many points as a page can show: of so many rows one is drawn.
std::size_t thinning(std::size_t rows);
/// "One epoch in 20 is drawn.", with a blank before it; empty where all are.
std::string thinning_words(std::size_t every);

constexpr const char* time_label = "time from the first epoch (s)";
constexpr double kmh_per_m_s = 3.6;

}  // namespace runcert

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/speed_unit.h"
#include "reports/certificate/certificate_document.h"

// The figures of a report, `figures[]` of its predicate; `figures_json` puts them together.

namespace runcert {

using Json = nlohmann::ordered_json;

/// The track on its course, in the plane.
Json track_figure(const ReportInputs& inputs);
/// The same as a small map, without axes to read: where the window was.
Json place_figure(const ReportInputs& inputs);
/// The speed over each rule's length all along the run ([DHD22] (27), figure 11): a figure for each
/// dimension that a rule counts, of the rules that have such a speed.
std::vector<Json> average_figures(const ReportInputs& inputs);
/// Heights along the track: the surface below it, and the antenna less its height above the ground;
/// null without a surface there.
Json ground_figure(const ReportInputs& inputs);
/// Measured less smoothed positions; null where no epoch has both.
Json residual_figure(const ReceiverResults& results);
/// The statistics of screening's tests over their thresholds; null where there are none.
Json test_figure(const ScreenedTable& table);
/// Adds the speed by carrier phases to the figure of a window.
void add_phase_speed(Json& figure, const PhaseView& view, const SpeedUnit& unit);
/// Sky, satellites over time, residuals, displacements; none where the phases say nothing.
std::vector<Json> phase_figures(const PhaseView& view, const WindowSpan& window);

/// Around the window of a rule: roll and pitch, heading and course, the speeds of antenna and
/// reference point, and the craft to scale on its surface. None without an IMU, or where fewer than
/// two epochs have an attitude.
std::vector<Json> attitude_figures(const ReportInputs& inputs, const RuleView& rule);

/// Least and largest of what was seen.
struct Range {
    std::optional<double> least, most;

    void widen(double value);
    double span() const { return least ? *most - *least : 0.0; }
};

/// How a curve of a figure looks.
struct CurveStyle {
    std::string name;
    std::string kind;    ///< "line", "dashed", "points"
    std::string colour;  ///< of Okabe and Ito's, by name: "blue", "vermilion", ...
    int x_decimals = 3;
    int y_decimals = 3;
};

/// Collects a curve, as `figures[].curves[]` of the report: in order, null where the line breaks.
class Curve {
  public:
    explicit Curve(const CurveStyle& style);

    void add(double x, double y);
    /// With a band around it.
    void add(double x, double y, double lower, double upper);
    /// With a band of that half width, which widens the range.
    void add(double x, double y, double half_width, Range& range);
    /// The line does not go on to the next point. Nothing happens before the first point.
    void interrupt();
    /// Adds the curve to a figure, where it has a point.
    void add_to(Json& figure) const;

    bool empty() const { return json_["x"].empty(); }
    std::size_t size() const { return json_["x"].size(); }
    const Json& json() const { return json_; }

  private:
    Json json_;
    CurveStyle style_;
    bool interrupted_ = false;
};

/// Begins a figure: its kind ("speed", "window", ...), words and axes; nothing is drawn yet.
Json empty_figure(const std::string& kind, const std::string& title, const std::string& caption,
                  const std::string& x_label, const std::string& y_label);
/// What the axes show at least, with a margin of a twentieth on either side of y.
void set_axes(Json& figure, double x_min, double x_max, double y_min, double y_max);
/// Adds the stretch of a window to a figure's spans, of kind "window" or "refused".
void add_window_span(Json& spans, const WindowSpan& window, const std::string& name,
                     const char* kind);
void add_level(Json& figure, const std::string& name, double level);
/// Adds the required speed of a rule, where it has one, as a level that widens the range.
void add_required_speed(Json& figure, Range& speeds, const ProfileVerdict& verdict,
                        const SpeedUnit& unit);
/// A line through points, as `figures[].segments[]` of the report.
Json segment(const std::string& name, const std::vector<Eigen::Vector2d>& points);
void add_mark(Json& figure, const std::string& name, double x, double y);

/// A line is thinned to about as many points as a page can show: of so many rows one is drawn.
std::size_t thinning(std::size_t rows);
/// "One epoch in 20 is drawn.", with a blank before it; empty where all are.
std::string thinning_words(std::size_t every);

constexpr const char* time_label = "time from the first epoch (s)";

}  // namespace runcert

#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

// A plot, declared once: `plot_svg` draws it on pages and on paper, and the page's charts zoom
// in what report.json holds of it. A value that is not finite is not drawn; lines break there.

namespace runcert {

/// Least and largest of the finite values that were seen.
struct Range {
    std::optional<double> least, most;

    void widen(double value);
    double span() const { return least ? *most - *least : 0.0; }
};

/// A line or a set of points. What follows a comma in its name ("surface, begin") tells it from
/// others of its kind, which the legend has once.
struct Curve {
    std::string name;
    std::string kind;    ///< "line", "thin", "dashed", "points"; "outline": not to be read off
    std::string colour;  ///< of Okabe and Ito's, by name: "blue", "vermilion", ...
    int x_decimals = 3;  ///< to which values are rounded
    int y_decimals = 3;
    std::vector<double> x = {}, y = {};          ///< y is NaN where the line breaks
    std::vector<double> lower = {}, upper = {};  ///< a band around it; empty where it has none
    bool interrupted = false;                    ///< the next point is not joined to the last

    void add(double x, double y);
    /// With a band around it; both or no values of a curve have one.
    void add(double x, double y, double lower, double upper);
    /// With a band of that half width, which widens the range.
    void add(double x, double y, double half_width, Range& range);
    /// The line does not go on to the next point. Nothing happens before the first point.
    void interrupt();

    bool empty() const { return x.empty(); }
    std::size_t size() const { return x.size(); }
};

/// A dashed line across the plot, and how it is called.
struct PlotLevel {
    std::string name;
    double level = 0.0;
};

/// A shaded stretch of the horizontal axis.
struct PlotSpan {
    std::string name;
    std::string kind;  ///< "window", "refused", "unusable", "gap"
    double from = 0.0, to = 0.0;
};

/// A single point with its name beside it.
struct PlotMark {
    std::string name;
    double x = 0.0, y = 0.0;
};

/// A named place of the vertical axis, which then has no numbers.
struct PlotRow {
    std::string name;
    double y = 0.0;
    std::string value = {};  ///< what stands at its right end
};

struct Plot {
    std::string kind = {};  ///< "speed", "window", ...
    std::string rule = {};  ///< whose window it shows
    std::string title = {}, caption = {};
    std::string x_label = {}, y_label = {};  ///< with the unit in brackets at the end
    bool equal_scale = false;                ///< metres on both axes, to one scale
    double x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0;
    std::vector<Curve> curves = {};
    std::vector<PlotLevel> levels = {};
    std::vector<PlotSpan> spans = {};
    std::vector<PlotMark> marks = {};
    std::vector<PlotRow> rows = {};

    /// Adds a curve, where it has a point.
    void add(Curve curve);
    /// What the axes show, with a margin of a twentieth on either side of y; what has no extent
    /// gets one.
    void set_axes(const Range& x, const Range& y);
};

/// None, where there is nothing to draw.
using Plots = std::vector<Plot>;

/// The members of `figures[]` of the report.
nlohmann::ordered_json plot_json(const Plot& plot);

/// Reads them again. Failure, which names `where`, if a list is of another length than its x, or
/// anything is not of its type.
Plots read_plots(const nlohmann::ordered_json& figures, const std::string& where);

/// The width that a drawing is made for, in pixels of CSS, and what may stand beside it.
struct DrawingSize {
    double width = 660.0;
    double height = 200.0;  ///< of the frame, where the figure asks for none of its own
    double letters = 11.5;
    double most_height = 320.0;  ///< of the frame of a track, whatever its shape
};
inline constexpr DrawingSize small_drawing{
    .width = 325.0, .height = 100.0, .letters = 10.0, .most_height = 105.0};
/// For a telephone, on a page where no chart takes the drawing's place.
inline constexpr DrawingSize slim_drawing{.width = 330.0, .height = 180.0, .most_height = 240.0};

/// The figure as an <svg> element that stands in a page: colours are attributes, which a page's
/// style may replace. Letters are measured as DejaVu Sans, so that no two texts overlap; a line has
/// no more points than can be seen. The same figure gives the same bytes on every machine.
std::string plot_svg(const Plot& plot, const DrawingSize& size = {});

/// Which writer draws: SHA-256 of what it makes of a fixed plot of every part, 64 hexadecimal
/// digits.
std::string drawing_fingerprint();

/// A text as SVG and HTML have it, in an attribute too.
std::string svg_text(const std::string& text);

/// The width of a text in DejaVu Sans, in ems; letters that are not measured count as wide ones.
double text_width(const std::string& text);

/// Puts the drawing of each plot of a document, `sections[].blocks[].plots[]`, into `image`, small
/// where its block is; and if so, into `slim_image` that for a telephone. Failure where the
/// document names a figure that there is not.
void draw_plots(nlohmann::ordered_json& document, const Plots& plots, bool slim_too = false);

}  // namespace runcert

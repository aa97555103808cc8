#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace runcert {

/// How a curve of a figure looks.
struct CurveStyle {
    std::string name;
    std::string kind;    ///< "line", "dashed", "points"
    std::string colour;  ///< of Okabe and Ito's, by name: "blue", "vermilion", ...
    int x_decimals = 3;
    int y_decimals = 3;
};

/// Collects the points of a curve, as `figures[].curves[]` of the report holds them: in order, a
/// null where the line breaks.
class Curve {
  public:
    explicit Curve(const CurveStyle& style);

    void add(double x, double y);
    /// With a band around it.
    void add(double x, double y, double lower, double upper);
    /// The line does not go on to the next point. Nothing happens before the first point.
    void interrupt();

    bool empty() const { return json_["x"].empty(); }
    std::size_t size() const { return json_["x"].size(); }
    const nlohmann::ordered_json& json() const { return json_; }

  private:
    nlohmann::ordered_json json_;
    CurveStyle style_;
    bool interrupted_ = false;
};

/// Least and largest of what was seen.
struct Range {
    std::optional<double> least, most;

    void widen(double value);
    double span() const { return least ? *most - *least : 0.0; }
};

}  // namespace runcert

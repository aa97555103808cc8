#pragma once

#include <cstdint>
#include <string>

#include "reports/plot/plot.h"

namespace runcert {

/// Numbers along an axis: multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
    std::int64_t first = 0, last = -1;  ///< the multiples within the axis
    std::int64_t times = 1;             ///< 1, 2 or 5
    int power = 0;                      ///< of ten

    std::size_t count() const;
    double value(std::size_t i) const;
    /// With as many decimals as the step has.
    std::string text(std::size_t i) const;
};

/// The ticks from `low` to `high`, no more than so many steps of them.
Ticks ticks_of(double low, double high, double most_steps);

/// Where a figure's frame stands in its drawing, and its axes, in pixels.
struct PlotAxes {
    double left = 0.0, top = 0.0, wide = 0.0, high = 0.0;
    double x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0;
    Ticks x = {}, y = {};
    bool rows_above = false;  ///< long names of rows stand above their lines

    double across(double value) const { return left + wide * (value - x_min) / (x_max - x_min); }
    double down(double value) const { return top + high * (y_max - value) / (y_max - y_min); }
};

/// No two numbers of an axis touch. A figure of equal scale is as high as its shape asks for,
/// within bounds; one of rows as high as these need.
PlotAxes axes_of(const Plot& plot, const DrawingSize& size);

}  // namespace runcert

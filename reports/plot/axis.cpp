#include "reports/plot/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace runcert {
namespace {

/// Exact for the powers that double has exactly: no library's rounding enters.
double ten_to(int power) {
    double value = 1.0;
    for (int i = 0; i < std::abs(power); ++i)
        value *= 10.0;
    return value;
}

double multiple(std::int64_t count, int power) {
    return power < 0 ? static_cast<double>(count) / ten_to(power)
                     : static_cast<double>(count) * ten_to(power);
}

double widest(const Ticks& ticks) {
    double width = 0.0;
    for (std::size_t i = 0; i < ticks.count(); ++i)
        width = std::max(width, text_width(ticks.text(i)));
    return width;
}

/// The most ticks whose numbers do not touch.
Ticks x_ticks(const PlotAxes& axes, double letters) {
    constexpr double blank = 1.2;  // ems between two numbers
    Ticks ticks;
    for (double steps = std::floor(axes.wide / (3.5 * letters)); steps >= 1.0; steps -= 1.0) {
        ticks = ticks_of(axes.x_min, axes.x_max, steps);
        const double step = axes.across(multiple(ticks.times, ticks.power)) - axes.across(0.0);
        if ((widest(ticks) + blank) * letters <= step) break;
    }
    return ticks;
}

/// Widens the axis that has too little to show, so that both have one scale.
void equalise(PlotAxes& axes) {
    const double scale =
        std::max((axes.x_max - axes.x_min) / axes.wide, (axes.y_max - axes.y_min) / axes.high);
    const auto around = [&](double& low, double& high, double pixels) {
        const double middle = 0.5 * (low + high);
        low = middle - 0.5 * scale * pixels;
        high = middle + 0.5 * scale * pixels;
    };
    around(axes.x_min, axes.x_max, axes.wide);
    around(axes.y_min, axes.y_max, axes.high);
}

/// How much higher than wide a frame of one scale may be.
constexpr double flattest = 0.25, highest = 0.62;

void lay_rows(PlotAxes& axes, const Plot& plot, const DrawingSize& size) {
    double width = 0.0;
    for (const PlotRow& row : plot.rows) {
        width = std::max(width, text_width(row.name) * size.letters);
        axes.rows_above = axes.rows_above || width > 0.15 * size.width || !row.value.empty();
    }
    axes.left = axes.rows_above ? 0.0 : width + 6.0;
    axes.high = (axes.y_max - axes.y_min) * size.letters * (axes.rows_above ? 3.4 : 1.5);
}

}  // namespace

std::size_t Ticks::count() const {
    return static_cast<std::size_t>(std::max<std::int64_t>(0, last - first + 1));
}

double Ticks::value(std::size_t i) const {
    return multiple((first + static_cast<std::int64_t>(i)) * times, power);
}

std::string Ticks::text(std::size_t i) const {
    constexpr int longest = 6;  // zeros that are written out
    std::string text =
        std::abs(power) > longest
            ? fmt::format("{}e{}", (first + static_cast<std::int64_t>(i)) * times, power)
            : format_fixed(value(i), std::max(0, -power));
    if (text.starts_with('-')) text.replace(0, 1, "−");
    return text;
}

Ticks ticks_of(double low, double high, double most_steps) {
    Ticks ticks;
    const double least = (high - low) / std::max(most_steps, 1.0);
    if (!std::isfinite(least) || !(least > 0.0)) return ticks;
    while (multiple(1, ticks.power) > least && ticks.power > -300)
        --ticks.power;
    while (multiple(10, ticks.power) <= least && ticks.power < 300)
        ++ticks.power;
    for (const std::int64_t times : {1, 2, 5, 10})
        if (ticks.times = times; multiple(times, ticks.power) >= least) break;
    if (ticks.times == 10) {
        ticks.times = 1;
        ++ticks.power;
    }
    const double step = multiple(ticks.times, ticks.power);
    constexpr double largest = 1e15;  // beyond, neighbouring multiples are one number
    if (!(std::abs(low) < largest * step && std::abs(high) < largest * step)) return ticks;
    constexpr double rounding = 1e-9;
    ticks.first = static_cast<std::int64_t>(std::ceil(low / step - rounding));
    ticks.last = static_cast<std::int64_t>(std::floor(high / step + rounding));
    return ticks;
}

PlotAxes axes_of(const Plot& plot, const DrawingSize& size) {
    PlotAxes axes{.top = size.letters * (plot.y_label.empty() ? 0.6 : 1.9),
                  .high = size.height,
                  .x_min = plot.x_min,
                  .x_max = plot.x_max,
                  .y_min = plot.y_min,
                  .y_max = plot.y_max};
    if (!plot.rows.empty()) lay_rows(axes, plot, size);
    for (const auto& [low, high] :
         {std::pair{&axes.x_min, &axes.x_max}, std::pair{&axes.y_min, &axes.y_max}})
        if (!std::isfinite(*high - *low) || !(*high > *low)) {
            *low = std::isfinite(*low) ? *low : 0.0;
            *high = *low + std::max(1.0, 1e-9 * std::abs(*low));
        }
    const double from = axes.x_min, to = axes.x_max, low = axes.y_min, high = axes.y_max;
    double right = 1.5 * size.letters;      // beyond the frame reaches half of the last number
    for (int pass = 0; pass < 3; ++pass) {  // the numbers' width follows from what is shown
        axes.wide = size.width - axes.left - right;
        if (plot.equal_scale) {
            axes.x_min = from;
            axes.x_max = to;
            axes.y_min = low;
            axes.y_max = high;
            axes.high =
                std::min(size.most_height,
                         axes.wide * std::clamp((high - low) / (to - from), flattest, highest));
            equalise(axes);
        }
        axes.x = x_ticks(axes, size.letters);
        const double half = 0.5 * widest(axes.x) * size.letters;
        right = std::max(right, half);
        axes.left = std::max(axes.left, half);
        if (!plot.rows.empty()) continue;
        axes.y = ticks_of(axes.y_min, axes.y_max, axes.high / (2.6 * size.letters));
        axes.left = std::max(axes.left, widest(axes.y) * size.letters + 6.0);
    }
    return axes;
}

}  // namespace runcert

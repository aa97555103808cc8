#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "reports/day/page_parts.h"

namespace runcert {
namespace {

// Lengths down are in pixels, across in per cent of the width.
constexpr int above = 24, height = 240, below_axis = 40, label_height = 18;
constexpr double from_left = 1.5, wide = 97.0;
constexpr double drawn_size = 10000.0;  // of the inner picture's own coordinates

struct Extent {
    double low, high;

    double part(double value) const { return (value - low) / (high - low); }
    void widen(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

struct Frame {
    Extent time{0.0, 0.0};
    Extent speed{0.0, 0.0};
    double longest_s = 0.0;  ///< of the windows
};

Frame frame_of(const Overlay& overlay) {
    Frame frame;
    bool first = true;
    for (const Overlay::Run& run : overlay.runs) {
        frame.longest_s = std::max(frame.longest_s, run.curve->duration_s);
        for (std::size_t i = 0; i < run.curve->time_s.size(); ++i) {
            frame.time.widen(run.curve->time_s[i]);
            if (const auto& speed = run.curve->speed[i]) {
                if (first) frame.speed = {*speed, *speed};
                first = false;
                frame.speed.widen(*speed);
            }
        }
    }
    constexpr double least_span = 1e-3;
    const double room = std::max(frame.speed.high - frame.speed.low, least_span) * 0.06;
    frame.speed = {frame.speed.low - room, frame.speed.high + room};
    frame.time.high = std::max(frame.time.high, frame.time.low + least_span);
    return frame;
}

std::string at_time(const Frame& frame, double time) {
    return fmt::format("{:.3f}%", from_left + wide * frame.time.part(time));
}

double down(const Frame& frame, double speed) {
    return above + height * (1.0 - frame.speed.part(speed));
}

/// Between two epochs on the line that joins them; nothing outside, or next to a gap.
std::optional<double> speed_at(const WindowCurve& curve, double time) {
    const auto after = std::ranges::lower_bound(curve.time_s, time);
    if (after == curve.time_s.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - curve.time_s.begin());
    if (*after == time) return curve.speed[i];
    if (i == 0) return std::nullopt;
    const std::optional<double>& before = curve.speed[i - 1];
    const std::optional<double>& next = curve.speed[i];
    if (!before || !next) return std::nullopt;
    const double part = (time - curve.time_s[i - 1]) / (curve.time_s[i] - curve.time_s[i - 1]);
    return *before + part * (*next - *before);
}

/// The curve between two times, broken where the recording is.
std::string path_of(const Frame& frame, const WindowCurve& curve, double from, double to) {
    std::string path;
    bool pen_down = false;
    const auto add = [&](double time, const std::optional<double>& speed) {
        if (speed)
            path += fmt::format("{}{:.0f} {:.0f}", pen_down ? "L" : "M",
                                drawn_size * frame.time.part(time),
                                drawn_size * (1.0 - frame.speed.part(*speed)));
        pen_down = speed.has_value();
    };
    add(from, speed_at(curve, from));
    for (std::size_t i = 0; i < curve.time_s.size(); ++i)
        if (curve.time_s[i] > from && curve.time_s[i] < to) add(curve.time_s[i], curve.speed[i]);
    add(to, speed_at(curve, to));
    return path;
}

std::string curve_svg(const Frame& frame, const WindowCurve& curve, std::size_t number) {
    const std::string whole = path_of(frame, curve, curve.time_s.front(), curve.time_s.back());
    const std::string window = path_of(frame, curve, 0.0, curve.duration_s);
    return fmt::format(
        "<path class=\"run run-{0}\" d=\"{1}\"/>\n<path class=\"run in-window run-{0}\" "
        "d=\"{2}\"/>\n",
        number, whole, window);
}

std::string speed_lines(const Frame& frame) {
    const double step = tick_step(frame.speed.high - frame.speed.low);
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step))));
    const double first = std::ceil(frame.speed.low / step) * step;
    std::string svg;
    for (int i = 0; first + i * step <= frame.speed.high; ++i) {
        const double y = down(frame, first + i * step);
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0}%\" x2=\"{1}%\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>\n",
            from_left, from_left + wide, y);
        svg += fmt::format("<text class=\"tick\" x=\"{}%\" dx=\"3\" y=\"{:.1f}\">{}</text>\n",
                           from_left, y - 3.0, format_fixed(first + i * step, decimals));
    }
    return svg;
}

std::string time_ticks(const Frame& frame) {
    const double step = tick_step(frame.time.high - frame.time.low);
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step))));
    const double first = std::ceil(frame.time.low / step) * step;
    std::string svg;
    for (int i = 0; first + i * step <= frame.time.high; ++i) {
        const double part = frame.time.part(first + i * step);
        const char* anchor = part < 0.06 ? "start" : part > 0.94 ? "end" : "middle";
        svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n",
                           at_time(frame, first + i * step), above + height + 14, anchor,
                           format_fixed(first + i * step, decimals));
    }
    return svg + fmt::format(
                     "<text class=\"tick\" x=\"50%\" y=\"{}\" text-anchor=\"middle\">time "
                     "from the start of the window (s)</text>\n",
                     above + height + 29);
}

}  // namespace

std::string overlay_svg(const Overlay& overlay) {
    if (overlay.runs.empty()) return {};
    const Frame frame = frame_of(overlay);
    const int labels = above + height + below_axis;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"picture\" width=\"100%\" height=\"{}\" "
        "role=\"img\" aria-label=\"{}\">\n",
        labels + label_height * static_cast<int>(overlay.runs.size()) + 4, svg_text(overlay.title));
    svg += fmt::format("<rect class=\"span\" x=\"{}\" y=\"{}\" width=\"{:.3f}%\" height=\"{}\"/>\n",
                       at_time(frame, 0.0), above,
                       wide * (frame.time.part(frame.longest_s) - frame.time.part(0.0)), height);
    svg += speed_lines(frame) + time_ticks(frame);
    svg += fmt::format(
        "<svg x=\"{}%\" y=\"{}\" width=\"{}%\" height=\"{}\" viewBox=\"0 0 {} {}\" "
        "preserveAspectRatio=\"none\">\n",
        from_left, above, wide, height, drawn_size, drawn_size);
    for (std::size_t i = 0; i < overlay.runs.size(); ++i)
        svg += curve_svg(frame, *overlay.runs[i].curve, i + 1);
    svg += "</svg>\n";
    svg += fmt::format(
        "<text class=\"tick\" x=\"{}%\" dx=\"-4\" y=\"{}\" text-anchor=\"end\">{}"
        "</text>\n",
        from_left + wide, above - 10, svg_text(overlay.runs[0].curve->quantity));
    for (std::size_t i = 0; i < overlay.runs.size(); ++i) {
        const int y = labels + label_height * static_cast<int>(i) + 12;
        svg += fmt::format(
            "<line class=\"run in-window run-{}\" x1=\"{}%\" x2=\"6%\" y1=\"{}\" y2=\"{}\"/>\n"
            "<text x=\"7%\" y=\"{}\">{}</text>\n",
            i + 1, from_left, y - 4, y - 4, y, svg_text(overlay.runs[i].label));
    }
    return svg + "</svg>\n";
}

}  // namespace runcert

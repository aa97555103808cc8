#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>

#include "core/text.h"
#include "reports/day/page_parts.h"

namespace runcert {
namespace {

// Lengths down are in pixels, across in per cent of the width.
constexpr int head = 24, line_height = 36, text_at = 12, bar_at = 24, foot = 34;
constexpr double left = 1.5, across = 97.0;
constexpr std::size_t longest_label = 26;

/// Cut between characters of UTF-8.
std::string shortened(const std::string& text) {
    if (text.size() <= longest_label) return text;
    std::size_t end = longest_label - 1;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
        --end;
    return text.substr(0, end) + "…";
}

/// From the least to the largest that is drawn, with room at both ends.
struct Axis {
    double low = 0.0;
    double high = 1.0;
    double step = 1.0;
    int decimals = 0;

    std::string at(double value) const {
        return fmt::format("{:.3f}%", left + across * (value - low) / (high - low));
    }
};

Axis axis_of(const std::vector<PictureLine>& lines) {
    Axis axis{.low = lines.front().speed, .high = lines.front().speed};
    for (const PictureLine& line : lines) {
        const double required_speed = line.required_speed.value_or(line.speed);
        axis.low = std::min({axis.low, line.speed - line.expanded_uncertainty, required_speed});
        axis.high = std::max({axis.high, line.speed + line.expanded_uncertainty, required_speed});
    }
    constexpr double least_span = 1e-3;
    const double room = std::max(axis.high - axis.low, least_span) * 0.04;
    axis.low -= room;
    axis.high += room;
    axis.step = tick_step(axis.high - axis.low);
    axis.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(axis.step))));
    return axis;
}

/// One required speed for all of those that have one.
std::optional<double> common_required_speed(const std::vector<PictureLine>& lines) {
    std::optional<double> common;
    for (const PictureLine& line : lines) {
        if (!line.required_speed) continue;
        if (common && std::abs(*common - *line.required_speed) > 1e-9) return std::nullopt;
        common = line.required_speed;
    }
    return common;
}

std::string vertical(const std::string& css, const std::string& x, int from, int to) {
    return fmt::format("<line class=\"{0}\" x1=\"{1}\" x2=\"{1}\" y1=\"{2}\" y2=\"{3}\"/>\n", css,
                       x, from, to);
}

/// Text beside a place, on the side where there is room.
std::string beside(const Axis& axis, double value, int y, const std::string& text) {
    const bool to_the_left = value - axis.low > 0.5 * (axis.high - axis.low);
    return fmt::format("<text x=\"{}\" dx=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n",
                       axis.at(value), to_the_left ? -5 : 5, y, to_the_left ? "end" : "start",
                       svg_text(text));
}

std::string ticks(const Axis& axis, const std::string& unit, int bottom) {
    std::string svg;
    const double first = std::ceil(axis.low / axis.step) * axis.step;
    for (int i = 0; first + i * axis.step <= axis.high; ++i) {
        const double value = first + i * axis.step;
        const double part = (value - axis.low) / (axis.high - axis.low);
        svg += vertical("grid", axis.at(value), head, bottom);
        const char* anchor = part < 0.06 ? "start" : part > 0.94 ? "end" : "middle";
        svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n",
                           axis.at(value), bottom + 14, anchor, format_fixed(value, axis.decimals));
    }
    return svg +
           fmt::format("<text class=\"tick\" x=\"50%\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       bottom + 29, svg_text(unit));
}

/// A sign of another shape for each outcome.
std::string marker(const std::string& tone) {
    if (tone == "yes") return "<circle r=\"4\"/>";
    if (tone == "no") return "<path d=\"M-3.5-3.5H3.5V3.5H-3.5Z\"/>";
    if (tone == "refused") return "<path class=\"cross\" d=\"M-4-4L4 4M-4 4L4-4\"/>";
    return "<path d=\"M0-5L5 0L0 5L-5 0Z\"/>";
}

std::string line_svg(const Axis& axis, const PictureLine& line, int top) {
    const int y = top + bar_at;
    std::string svg = fmt::format("<g class=\"of-{}\">\n<text x=\"0\" y=\"{}\">{}</text>\n",
                                  line.tone, top + text_at, svg_text(shortened(line.label)));
    svg += fmt::format("<text class=\"number\" x=\"100%\" y=\"{}\" text-anchor=\"end\">{}</text>\n",
                       top + text_at, svg_text(line.figure));
    // A rule above, so that the mark is seen to belong to the words over it.
    svg += fmt::format("<line class=\"rule\" x1=\"0\" x2=\"100%\" y1=\"{0}\" y2=\"{0}\"/>\n", top);
    const std::string from = axis.at(line.speed - line.expanded_uncertainty);
    const std::string to = axis.at(line.speed + line.expanded_uncertainty);
    svg += fmt::format("<line class=\"interval\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>\n", from,
                       to, y, y);
    svg += vertical("end", from, y - 7, y + 7) + vertical("end", to, y - 7, y + 7);
    svg += fmt::format("<svg class=\"mark\" x=\"{}\" y=\"{}\">{}</svg>\n", axis.at(line.speed), y,
                       marker(line.tone));
    // Between the lines of letters.
    if (line.required_speed)
        svg += vertical("required", axis.at(*line.required_speed), y - 8, y + 10);
    return svg + "</g>\n";
}

}  // namespace

double tick_step(double span) {
    const double power = std::pow(10.0, std::floor(std::log10(span / 3.0)));
    const double leading = span / 3.0 / power;
    return power * (leading >= 5.0 ? 5.0 : leading >= 2.0 ? 2.0 : 1.0);
}

std::string svg_text(const std::string& text) {
    return kainjow::mustache::html_escape(plain_text(text));
}

std::string picture_svg(const Picture& picture) {
    if (picture.lines.empty()) return {};
    const Axis axis = axis_of(picture.lines);
    const int bottom = head + line_height * static_cast<int>(picture.lines.size());
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"picture\" width=\"100%\" height=\"{}\" "
        "role=\"img\" aria-label=\"{}\">\n",
        bottom + foot, svg_text(picture.title));
    svg += ticks(axis, picture.unit, bottom);
    const std::optional<double> required_speed = common_required_speed(picture.lines);
    if (required_speed)
        svg += vertical("required", axis.at(*required_speed), 2, head - 2) +
               beside(axis, *required_speed, head - 10, "required");
    int top = head;
    for (const PictureLine& line : picture.lines) {
        svg += line_svg(axis, line, top);
        top += line_height;
    }
    return svg + "</svg>\n";
}

}  // namespace runcert

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <kainjow/mustache.hpp>
#include <string_view>

#include "core/text.h"
#include "reports/plot/axis.h"
#include "reports/plot/plot.h"
#include "store/sha256.h"

namespace runcert {
namespace {

struct Point {
    double x = 0.0, y = 0.0;
};

struct Box {
    double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;

    bool holds(const Box& other) const {
        return other.left >= left && other.right <= right && other.top >= top &&
               other.bottom <= bottom;
    }
    bool touches(const Box& other) const {
        return other.left < right && other.right > left && other.top < bottom && other.bottom > top;
    }
    double wide() const { return right - left; }
    double high() const { return bottom - top; }
};

constexpr const char *ink = "#1a1a1a", *muted = "#484848", *grid = "#dddddd", *paper = "#ffffff";

/// Colours of Okabe and Ito (2008), told apart by the colour-blind; in a figure of several lines
/// each has its own dashes, for those who print in black.
struct Colour {
    std::string_view name;
    const char* value;
    const char* dashes;
};
constexpr std::array<Colour, 8> colours{{{"blue", "#0072b2", ""},
                                         {"vermilion", "#d55e00", "9 3"},
                                         {"green", "#009e73", "3 2"},
                                         {"purple", "#b8558f", "11 3 3 3"},
                                         {"orange", "#e69f00", "6 2"},
                                         {"grey", "#757575", "2 2"},
                                         {"black", "#000000", "14 4"},
                                         {"sky", "#56b4e9", "5 5"}}};

const Colour& colour_of(const std::string& name) {
    const auto found = std::ranges::find(colours, name, &Colour::name);
    return found == colours.end() ? colours.front() : *found;
}

struct SpanStyle {
    std::string_view kind;
    const char* fill;
    double opacity;
    double share;  ///< of the frame's height, from its foot
};
constexpr std::array<SpanStyle, 4> span_styles{{{"window", "#56b4e9", 0.35, 1.0},
                                                {"refused", "#e69f00", 0.35, 1.0},
                                                {"gap", "#757575", 0.25, 1.0},
                                                {"unusable", "#000000", 1.0, 0.03}}};

const SpanStyle& style_of(const PlotSpan& span) {
    const auto found = std::ranges::find(span_styles, span.kind, &SpanStyle::kind);
    return found == span_styles.end() ? span_styles.front() : *found;
}

std::string kind_of(const std::string& name) {
    return name.substr(0, name.find(", "));
}

std::string tag_of(const std::string& name) {
    const std::size_t comma = name.find(", ");
    return comma == std::string::npos ? std::string() : name.substr(comma + 2);
}

/// As much of a text as there is room for, in ems.
std::string shortened(std::string text, double ems) {
    if (text_width(text) <= ems) return text;
    while (!text.empty() && text_width(text) + 1.0 > ems) {
        while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U)
            text.pop_back();
        text.pop_back();
    }
    return text + "…";
}

std::string rectangle(const Box& box, const char* fill, double opacity) {
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" "
        "fill-opacity=\"{}\"/>\n",
        box.left, box.top, box.wide(), box.high(), fill, opacity);
}

std::string line_between(Point from, Point to, const char* stroke, double width,
                         std::string_view dashes = {}) {
    return fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
        "stroke-width=\"{}\"{}/>\n",
        from.x, from.y, to.x, to.y, stroke, width,
        dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes));
}

/// The line between two points as far as it lies within a box, or nothing (Liang and Barsky, 1984).
bool clip(Point& from, Point& to, const Box& box) {
    double begin = 0.0, end = 1.0;
    const double dx = to.x - from.x, dy = to.y - from.y;
    const std::array<std::pair<double, double>, 4> edges{{{-dx, from.x - box.left},
                                                          {dx, box.right - from.x},
                                                          {-dy, from.y - box.top},
                                                          {dy, box.bottom - from.y}}};
    for (const auto& [across, room] : edges) {
        if (across == 0.0 && room < 0.0) return false;
        if (across < 0.0) begin = std::max(begin, room / across);
        if (across > 0.0) end = std::min(end, room / across);
    }
    if (begin > end) return false;
    const Point start = from;
    from = {start.x + begin * dx, start.y + begin * dy};
    to = {start.x + end * dx, start.y + end * dy};
    return true;
}

/// Draws a line with no more points than can be seen: of those within a pixel across the first, the
/// highest, the lowest and the last.
class Path {
  public:
    explicit Path(const Box& frame) : frame_(frame) {}

    /// A point that is none ends the line.
    void add(Point to) {
        if (!std::isfinite(to.x) || !std::isfinite(to.y)) return interrupt();
        if (column_.empty() || std::floor(to.x) != std::floor(column_.front().x)) flush();
        column_.push_back(to);
    }
    void interrupt() {
        flush();
        last_.reset();
    }
    std::string finished() {
        interrupt();
        return std::move(text_);
    }

  private:
    void flush() {
        if (column_.empty()) return;
        const auto [high, low] = std::ranges::minmax_element(column_, {}, &Point::y);
        auto between = std::minmax(high, low);
        draw(column_.front());
        for (const auto& at : {between.first, between.second})
            if (std::abs(at->y - column_.front().y) > 0.5 && at != column_.end() - 1) draw(*at);
        if (column_.size() > 1) draw(column_.back());
        column_.clear();
    }
    void draw(Point to) {
        Point from = last_.value_or(to), inside = to;
        last_ = to;
        if (!clip(from, inside, frame_)) {
            pen_.clear();
            return;
        }
        if (const std::string start = at(from); start != pen_) text_ += "M" + start;
        pen_ = at(inside);
        text_ += "L" + pen_;
    }
    static std::string at(Point point) { return fmt::format("{:.1f} {:.1f}", point.x, point.y); }

    Box frame_;
    std::vector<Point> column_ = {};
    std::optional<Point> last_ = {};
    std::string text_ = {}, pen_ = {};
};

class Drawing {
  public:
    Drawing(const Plot& plot, const DrawingSize& size)
        : plot_(plot), size_(size), axes_(axes_of(plot, size)) {
        frame_ = {axes_.left, axes_.top, axes_.left + axes_.wide, axes_.top + axes_.high};
    }

    std::string svg() {
        add_spans();
        add_axes();
        for (const Curve& curve : plot_.curves)
            add_band(curve);
        for (const Curve& curve : plot_.curves)
            add_curve(curve);
        add_levels();
        add_marks();
        add_span_tags();
        add_legend();
        const std::string title = svg_text(plot_.title);
        return fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
            "width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" aria-label=\"{2}\" "
            "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"{3}\">\n{4}</svg>\n",
            size_.width, std::ceil(foot_), title, size_.letters, out_);
    }

  private:
    Point place(double x, double y) const { return {axes_.across(x), axes_.down(y)}; }
    double ems(double count) const { return count * size_.letters; }
    double width_of(const std::string& text) const { return ems(text_width(text)); }

    void write(const std::string& text, Point at, const char* anchor = "start",
               const char* fill = ink) {
        out_ += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\"{} fill=\"{}\">{}</text>\n", at.x, at.y,
            std::string_view(anchor) == "start" ? "" : fmt::format(" text-anchor=\"{}\"", anchor),
            fill, svg_text(text));
    }

    /// The box of a text whose line of letters begins at a point.
    Box box_of(const std::string& text, Point at) const {
        return {at.x - 1.0, at.y - ems(0.85), at.x + width_of(text) + 1.0, at.y + ems(0.25)};
    }

    /// Writes a text at the first of some places where it is within the frame and covers no other;
    /// nowhere if there is none.
    void write_free(const std::string& text, std::initializer_list<Point> places) {
        for (const Point& at : places) {
            const Box box = box_of(text, at);
            if (!frame_.holds(box) ||
                std::ranges::any_of(taken_, [&](const Box& other) { return other.touches(box); }))
                continue;
            taken_.push_back(box);
            out_ += rectangle(box, paper, 0.75);
            return write(text, at);
        }
    }

    void add_spans() {
        constexpr double least = 2.0;  // so that a short one is seen
        for (const PlotSpan& span : plot_.spans) {
            const SpanStyle& style = style_of(span);
            Box box{std::clamp(axes_.across(span.from), frame_.left, frame_.right),
                    frame_.bottom - style.share * frame_.high(),
                    std::clamp(axes_.across(span.to), frame_.left, frame_.right), frame_.bottom};
            if (box.wide() < least) {
                box.left = std::clamp(0.5 * (box.left + box.right - least), frame_.left,
                                      frame_.right - least);
                box.right = box.left + least;
            }
            out_ += rectangle(box, style.fill, style.opacity);
            for (const double edge : {box.left, box.right})
                if (span.kind == "window" || span.kind == "refused")
                    out_ += line_between({edge, box.top}, {edge, box.bottom}, style.fill, 1.0,
                                         span.kind == "refused" ? "3 2" : "");
        }
    }

    void add_axes() {
        for (std::size_t i = 0; i < axes_.x.count(); ++i) {
            const double x = axes_.across(axes_.x.value(i));
            out_ += line_between({x, frame_.top}, {x, frame_.bottom + 3.0}, grid, 0.7);
            write(axes_.x.text(i), {x, frame_.bottom + ems(1.25)}, "middle", muted);
        }
        for (std::size_t i = 0; i < axes_.y.count() && plot_.rows.empty(); ++i) {
            const double y = axes_.down(axes_.y.value(i));
            out_ += line_between({frame_.left - 3.0, y}, {frame_.right, y}, grid, 0.7);
            write(axes_.y.text(i), {frame_.left - 5.0, y + ems(0.35)}, "end", muted);
        }
        add_rows();
        out_ +=
            line_between({frame_.left, frame_.bottom}, {frame_.right, frame_.bottom}, muted, 0.8);
        if (!axes_.rows_above)
            out_ +=
                line_between({frame_.left, frame_.top}, {frame_.left, frame_.bottom}, muted, 0.8);
        if (!plot_.y_label.empty())
            write(shortened(plot_.y_label, size_.width / size_.letters),
                  {0.0, frame_.top - ems(0.6)}, "start", muted);
        foot_ = frame_.bottom + ems(1.6);
        if (plot_.x_label.empty()) return;
        const std::string label = shortened(plot_.x_label, size_.width / size_.letters);
        const double middle = 0.5 * (frame_.left + frame_.right - width_of(label));
        write(label,
              {std::clamp(middle, 0.0, std::max(0.0, size_.width - width_of(label))),
               frame_.bottom + ems(2.6)},
              "start", muted);
        foot_ = frame_.bottom + ems(3.0);
    }

    void add_rows() {
        for (const PlotRow& row : plot_.rows) {
            const double y = axes_.down(row.y);
            if (!axes_.rows_above) {
                write(row.name, {frame_.left - 5.0, y + ems(0.35)}, "end");
                continue;
            }
            const double top = y - ems(1.0);
            const double room = size_.width - width_of(row.value) - ems(1.0);
            out_ += line_between({0.0, top - ems(1.3)}, {size_.width, top - ems(1.3)}, grid, 0.7);
            write(shortened(row.name, room / size_.letters), {0.0, top});
            write(row.value, {size_.width, top}, "end");
        }
    }

    void add_band(const Curve& curve) {
        const auto held = [&](double y) {
            return std::clamp(axes_.down(y), frame_.top, frame_.bottom);
        };
        for (std::size_t i = 0; i < curve.lower.size();) {
            Path above(wide_frame()), below(wide_frame());
            std::vector<Point> lower;
            for (; i < curve.lower.size() &&
                   std::isfinite(curve.x[i] + curve.lower[i] + curve.upper[i]);
                 ++i) {
                above.add({axes_.across(curve.x[i]), held(curve.upper[i])});
                lower.push_back({axes_.across(curve.x[i]), held(curve.lower[i])});
            }
            for (auto at = lower.rbegin(); at != lower.rend(); ++at)
                below.add(*at);
            if (std::string outline = above.finished(); !outline.empty()) {
                std::string back = below.finished();
                back[0] = 'L';
                out_ += fmt::format("<path d=\"{}{}Z\" fill=\"{}\" fill-opacity=\"0.25\"/>\n",
                                    outline, back, colour_of(curve.colour).value);
            }
            ++i;
        }
    }

    /// For what is held within the frame already.
    Box wide_frame() const {
        return {frame_.left - 1.0, frame_.top - 1.0, frame_.right + 1.0, frame_.bottom + 1.0};
    }

    void add_curve(const Curve& curve) {
        std::string path;
        if (curve.kind == "points")
            path = dots_of(curve);
        else {
            Path line(frame_);
            for (std::size_t i = 0; i < curve.size(); ++i)
                line.add(place(curve.x[i], curve.y[i]));
            path = line.finished();
        }
        if (!path.empty())
            out_ += fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", path, stroke_of(curve));
    }

    std::string dots_of(const Curve& curve) const {
        std::string path, last;
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const Point at = place(curve.x[i], curve.y[i]);
            if (!std::isfinite(curve.y[i]) || !frame_.holds({at.x, at.y, at.x, at.y})) continue;
            std::string dot = fmt::format("M{:.1f} {:.1f}h.01", at.x, at.y);
            if (dot != last) path += dot;
            last = std::move(dot);
        }
        return path;
    }

    std::string stroke_of(const Curve& curve) const {
        constexpr std::ptrdiff_t several = 3;
        const auto is_line = [](const Curve& one) { return one.kind == "line"; };
        const Colour& colour = colour_of(curve.colour);
        std::string dashes;
        if (curve.kind == "dashed") dashes = "5 3";
        if (is_line(curve) && std::ranges::count_if(plot_.curves, is_line) >= several)
            dashes = colour.dashes;
        const double width = curve.kind == "points" ? 3.2
                             : curve.kind == "thin" ? 0.9
                             : dashes.empty()       ? 1.7
                                                    : 1.5;
        return fmt::format("stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}{}",
                           colour.value, width,
                           curve.kind == "points" ? " stroke-linecap=\"round\"" : "",
                           dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes));
    }

    /// Levels so near that their names would touch share one: "required speed: nalsa, fisly".
    void add_levels() {
        std::vector<std::pair<double, std::string>> names;
        for (const PlotLevel& level : plot_.levels) {
            const double y = axes_.down(level.level);
            if (!(y >= frame_.top && y <= frame_.bottom)) continue;
            out_ +=
                line_between({frame_.left, y}, {frame_.right, y}, colours[1].value, 1.4, "9 3 2 3");
            const std::string kind = kind_of(level.name), tag = tag_of(level.name);
            if (!names.empty() && std::abs(names.back().first - y) < ems(1.2) &&
                kind_of(names.back().second) == kind && !tag.empty())
                names.back().second += ", " + tag;
            else
                names.emplace_back(y, level.name);
        }
        for (const auto& [y, name] : names) {
            const std::string text = shortened(name, frame_.wide() / size_.letters - 1.0);
            const double right = frame_.right - width_of(text) - 3.0, left = frame_.left + 4.0;
            write_free(text, {{right, y - ems(0.35)},
                              {left, y - ems(0.35)},
                              {right, y + ems(1.0)},
                              {left, y + ems(1.0)}});
        }
    }

    void add_marks() {
        for (const PlotMark& mark : plot_.marks) {
            const Point at = place(mark.x, mark.y);
            if (!frame_.holds({at.x, at.y, at.x, at.y})) continue;
            out_ += fmt::format(
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"none\" stroke=\"{}\" "
                "stroke-width=\"1.5\"/>\n",
                at.x, at.y, ink);
            const double width = width_of(mark.name);
            write_free(mark.name, {{at.x + 6.0, at.y + ems(0.35)},
                                   {at.x - width - 6.0, at.y + ems(0.35)},
                                   {at.x - 0.5 * width, at.y - ems(0.7)},
                                   {at.x - 0.5 * width, at.y + ems(1.3)}});
        }
    }

    /// Which rule's window it is, where a figure has several.
    void add_span_tags() {
        std::vector<std::string> written;
        for (const PlotSpan& span : plot_.spans) {
            const std::string tag = tag_of(span.name);
            if (tag.empty() || std::ranges::find(written, tag) != written.end() ||
                axes_.across(span.from) > frame_.right || axes_.across(span.to) < frame_.left)
                continue;
            const double middle = axes_.across(0.5 * (span.from + span.to)) - 0.5 * width_of(tag);
            const double x =
                std::clamp(middle, frame_.left + 2.0,
                           std::max(frame_.left + 2.0, frame_.right - width_of(tag) - 2.0));
            const double y = frame_.top + ems(1.0);
            written.push_back(tag);
            write_free(tag, {{x, y}, {x, y + ems(1.2)}, {x, y + ems(2.4)}, {x, y + ems(3.6)}});
        }
    }

    /// An entry for each kind of curve and of span, in lines as long as the drawing is wide.
    void add_legend() {
        std::vector<std::string> shown;
        const double swatch = ems(2.0), gap = ems(0.4), between = ems(1.4);
        Point at{0.0, foot_ + ems(1.2)};
        const auto next = [&](const std::string& name) -> std::optional<Box> {
            std::string kind = kind_of(name);
            if (kind.empty() || std::ranges::find(shown, kind) != shown.end()) return std::nullopt;
            shown.push_back(kind);
            kind = shortened(kind, (size_.width - swatch - gap) / size_.letters);
            const double width = swatch + gap + width_of(kind);
            if (at.x > 0.0 && at.x + width > size_.width) at = {0.0, at.y + ems(1.5)};
            write(kind, {at.x + swatch + gap, at.y});
            const Box sign{at.x, at.y - ems(0.75), at.x + swatch, at.y + ems(0.1)};
            at.x += width + between;
            return sign;
        };
        for (const Curve& curve : plot_.curves)
            if (const auto sign = next(curve.name)) {
                if (!curve.lower.empty())
                    out_ += rectangle(*sign, colour_of(curve.colour).value, 0.25);
                const double y = 0.5 * (sign->top + sign->bottom);
                const double x = 0.5 * (sign->left + sign->right);
                out_ += fmt::format(
                    "<path d=\"{}\" fill=\"none\" {}/>\n",
                    curve.kind == "points"
                        ? fmt::format("M{:.1f} {:.1f}h.01", x, y)
                        : fmt::format("M{:.1f} {:.1f}H{:.1f}", sign->left, y, sign->right),
                    stroke_of(curve));
            }
        for (const PlotSpan& span : plot_.spans)
            if (const auto sign = next(span.name))
                out_ += rectangle(*sign, style_of(span).fill, style_of(span).opacity);
        foot_ = shown.empty() ? foot_ : at.y + ems(0.5);
    }

    const Plot& plot_;
    DrawingSize size_;
    PlotAxes axes_;
    Box frame_;
    double foot_ = 0.0;
    std::vector<Box> taken_ = {};
    std::string out_ = {};
};

}  // namespace

std::string svg_text(const std::string& text) {
    return kainjow::mustache::html_escape(plain_text(text));
}

std::string plot_svg(const Plot& plot, const DrawingSize& size) {
    return Drawing(plot, size).svg();
}

std::string drawing_fingerprint() {
    Plot plot{.title = "title", .x_label = "x (s)", .y_label = "y (m)"};
    Range x, y;
    for (const char* const kind : {"line", "thin", "dashed", "points", "outline"}) {
        Curve curve{std::string(kind) + ", one", kind,
                    std::string(colours[plot.curves.size()].name)};
        for (int i = 0; i < 1500; ++i) {
            if (i % 400 == 399) curve.interrupt();
            curve.add(1e-2 * i, i % 37 + 10.0 * static_cast<double>(plot.curves.size()), 2.5, y);
            x.widen(1e-2 * i);
        }
        plot.add(std::move(curve));
    }
    for (const SpanStyle& style : span_styles)
        plot.spans.push_back(
            {std::string(style.kind) + ", one", std::string(style.kind), 2.0, 5.0});
    plot.levels = {{"level, one", 20.0}, {"level, two", 20.5}};
    plot.marks = {{"mark", 3.0, 30.0}, {"mark", 3.1, 30.0}};
    plot.set_axes(x, y);
    std::string drawn = plot_svg(plot) + plot_svg(plot, small_drawing);
    plot.equal_scale = true;
    drawn += plot_svg(plot);
    plot.equal_scale = false;
    plot.rows = {{"row", 10.0}};
    drawn += plot_svg(plot);
    plot.rows.front().value = "value";
    return sha256_hex(drawn + plot_svg(plot, slim_drawing));
}

}  // namespace runcert

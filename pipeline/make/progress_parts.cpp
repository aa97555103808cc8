#include "make/progress_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "make/progress_text.h"

namespace runcert {
namespace {

/// Longer lines are harder to read, and are broken when the terminal is made narrower.
constexpr std::size_t widest = 79;
constexpr std::size_t shortest_bar = 10;
constexpr std::size_t longest_bar = 30;

std::string padded(const std::string& text, std::size_t columns) {
    const std::string fit = fitted(text, columns);
    return fit + std::string(columns - columns_of(fit), ' ');
}

std::string running_line(const RunningAttempt& attempt, std::size_t id_columns,
                         std::size_t columns) {
    // Whole seconds: a figure that changes ten times a second cannot be read.
    return fitted(fmt::format("  {}  {:<6}  {:.0f} s", padded(plain_text(attempt.id), id_columns),
                              plain_text(attempt.step), std::floor(attempt.seconds)),
                  columns);
}

std::string time_left_text(double seconds) {
    if (seconds < 100.0) return fmt::format("{:.0f} s left", std::ceil(seconds));
    const double minutes = std::ceil(seconds / 60.0);
    if (minutes < 120.0) return fmt::format("{:.0f} min left", minutes);
    return fmt::format("{:.1f} h left", minutes / 60.0);
}

std::string bar(const FrameContents& contents, std::size_t columns) {
    const double part = contents.total == 0 ? 0.0
                                            : static_cast<double>(contents.ended) /
                                                  static_cast<double>(contents.total);
    const auto full =
        static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * static_cast<double>(columns));
    return fmt::format("[{:#<{}}{:.<{}}] ", "", full, "", columns - full);
}

/// The counts, and of the rest as much as there is room for: first the time left, then the rate.
std::string bar_line(const FrameContents& contents, std::size_t columns) {
    std::string counts = fmt::format("{}/{}", contents.ended, contents.total);
    if (contents.failed > 0) counts += fmt::format(", {} failed", contents.failed);
    std::string rate;
    if (contents.runs_per_minute)
        rate = fmt::format(", {:.{}f} runs/min", *contents.runs_per_minute,
                           *contents.runs_per_minute < 10.0 ? 1 : 0);
    std::string left;
    if (contents.seconds_left) left = ", " + time_left_text(*contents.seconds_left);
    std::string text = counts + rate + left;
    if (text.size() > columns) text = counts + left;
    if (text.size() + shortest_bar + 3 > columns) return fitted(text, columns);
    return bar(contents, std::min(columns - text.size() - 3, longest_bar)) + text;
}

}  // namespace

std::string ReportOrder::say(std::size_t index, std::string_view text) {
    assert(index >= next_);
    if (index == next_) return std::string(text);
    held_[index].text += text;
    return {};
}

std::string ReportOrder::end(std::size_t index) {
    assert(index >= next_);
    held_[index].ended = true;
    std::string sayable;
    for (auto first = held_.find(next_); first != held_.end(); first = held_.find(next_)) {
        sayable += std::exchange(first->second.text, {});
        if (!first->second.ended) break;
        held_.erase(first);
        ++next_;
    }
    return sayable;
}

std::string ReportOrder::rest() {
    std::string all;
    for (auto& [index, held] : held_)
        all += std::exchange(held.text, {});
    return all;
}

void Pace::begins(std::size_t index, double now_s) {
    if (!first_began_s_) first_began_s_ = now_s;
    running_.emplace(index, now_s);
    side_by_side_ = std::max(side_by_side_, running_.size());
}

void Pace::ends(std::size_t index, bool ran, double now_s) {
    const auto found = running_.find(index);
    if (found == running_.end()) return;
    if (ran) {
        ++ran_;
        ran_for_s_ += now_s - found->second;
    }
    running_.erase(found);
}

std::optional<double> Pace::runs_per_minute(double now_s) const {
    if (ran_ == 0 || now_s <= *first_began_s_) return std::nullopt;
    return 60.0 * static_cast<double>(ran_) / (now_s - *first_began_s_);
}

std::optional<double> Pace::seconds_left(std::size_t waiting, double now_s) const {
    if (ran_ == 0) return std::nullopt;
    const double each_s = ran_for_s_ / static_cast<double>(ran_);
    double work_s = each_s * static_cast<double>(waiting);
    double longest_s = 0.0;
    for (const auto& [index, began_s] : running_) {
        const double left_s = std::max(each_s - (now_s - began_s), 0.0);
        work_s += left_s;
        longest_s = std::max(longest_s, left_s);
    }
    return std::max(work_s / static_cast<double>(side_by_side_), longest_s);
}

std::vector<std::string> frame_lines(const FrameContents& contents, const TerminalSize& size) {
    const std::size_t columns = std::min(std::max<std::size_t>(size.columns, 2) - 1, widest);
    const std::size_t rows = std::max<std::size_t>(size.rows, 3) - 1;
    std::size_t shown = contents.running.size();
    // One row for the bar, and where not all find room one that says how many more there are.
    if (shown + 1 > rows) shown = rows - 2;
    std::size_t id_columns = 0;
    for (const RunningAttempt& attempt : contents.running)
        id_columns = std::max(id_columns, columns_of(plain_text(attempt.id)));
    id_columns = std::min(id_columns, columns / 2);
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < shown; ++i)
        lines.push_back(running_line(contents.running[i], id_columns, columns));
    if (shown < contents.running.size())
        lines.push_back(
            fitted(fmt::format("  and {} more", contents.running.size() - shown), columns));
    lines.push_back(bar_line(contents, columns));
    return lines;
}

std::size_t rows_of(const std::vector<std::string>& lines, std::size_t columns) {
    std::size_t rows = 0;
    for (const std::string& line : lines)
        rows += std::max<std::size_t>((columns_of(line) + columns - 1) / columns, 1);
    return rows;
}

}  // namespace runcert

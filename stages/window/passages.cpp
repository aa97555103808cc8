#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "stages/window/course_windows.h"

namespace runcert {
namespace {

enum class Line { finish, start };  // in the order in which they count if crossed at once

struct LineCrossing {
    Line line = Line::start;
    Crossing crossing;
};

using LineCrossings = std::vector<LineCrossing>;

LineCrossings both_lines(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                         const SurveyedLine& finish) {
    LineCrossings all;
    for (const Crossing& crossing : crossings(series, start))
        all.push_back({Line::start, crossing});
    for (const Crossing& crossing : crossings(series, finish))
        all.push_back({Line::finish, crossing});
    const auto key = [](const LineCrossing& one) {
        return std::tie(one.crossing.series, one.crossing.time, one.line);
    };
    std::sort(all.begin(), all.end(),
              [&](const LineCrossing& a, const LineCrossing& b) { return key(a) < key(b); });
    return all;
}

bool is_passage(const LineCrossing& a, const LineCrossing& b) {
    return a.crossing.series == b.crossing.series && a.line == Line::start && a.crossing.forward &&
           b.line == Line::finish && b.crossing.forward;
}

/// Reduces crossings of one line, with none of the other in between, to those from the first
/// forward crossing to the last.
std::vector<Crossing> trimmed(std::vector<Crossing> group) {
    const auto forward = [](const Crossing& one) { return one.forward; };
    group.erase(group.begin(), std::find_if(group.begin(), group.end(), forward));
    group.erase(std::find_if(group.rbegin(), group.rend(), forward).base(), group.end());
    return group;
}

/// The crossings of the start line up to `k` that may begin its passage, or those of the finish
/// line from `k` on that may end it: with none of the other line in between.
std::vector<Crossing> alternatives_to(const LineCrossings& all, std::size_t k) {
    const auto is_alike = [&](const LineCrossing& one) {
        return one.line == all[k].line && one.crossing.series == all[k].crossing.series;
    };
    std::size_t first = k, end = k + 1;
    while (all[k].line == Line::start && first > 0 && is_alike(all[first - 1]))
        --first;
    while (all[k].line == Line::finish && end < all.size() && is_alike(all[end]))
        ++end;
    std::vector<Crossing> group;
    for (std::size_t i = first; i < end; ++i)
        group.push_back(all[i].crossing);
    return trimmed(std::move(group));
}

std::string times_of(const std::vector<Crossing>& group) {
    std::string text;
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (i > 0) text += i + 1 == group.size() ? " and " : ", ";
        text += fmt::format("{:.3f} s", group[i].time.seconds());
    }
    return text;
}

std::string count_of(std::size_t count) {
    return count == 1 ? "once" : fmt::format("{} times", count);
}

std::string slow_crossing(std::string_view line, const Crossing& crossing) {
    if (crossing.speed_m_s >= slowest_crossing_m_s) return {};
    return fmt::format(
        "Where the track crosses the {} line, at {:.3f} s, it runs along that line or stands. It "
        "gets across at less than {} m/s, and the time of the crossing is not certain.",
        line, crossing.time.seconds(), slowest_crossing_m_s);
}

std::string ambiguity_of(const std::vector<Crossing>& starts,
                         const std::vector<Crossing>& finishes) {
    std::string text;
    if (starts.size() > 1)
        text = fmt::format(
            "The start line was crossed {} before the finish line, at {}: it is not known "
            "which crossing began the run.",
            count_of(starts.size()), times_of(starts));
    if (finishes.size() > 1)
        text += fmt::format(
            "{}The finish line was crossed {} after the start line, at {}: it is not known "
            "which crossing ended the run.",
            text.empty() ? "" : " ", count_of(finishes.size()), times_of(finishes));
    return text;
}

std::vector<Passage> passages_in(const LineCrossings& all) {
    std::vector<Passage> found;
    for (std::size_t k = 0; k + 1 < all.size(); ++k) {
        if (!is_passage(all[k], all[k + 1])) continue;
        const Crossing &start = all[k].crossing, &finish = all[k + 1].crossing;
        std::vector<std::string> refusals{
            ambiguity_of(alternatives_to(all, k), alternatives_to(all, k + 1)),
            slow_crossing("start", start), slow_crossing("finish", finish)};
        std::erase(refusals, "");
        found.push_back({start, finish, fmt::format("{}", fmt::join(refusals, " "))});
    }
    return found;
}

std::string only_against(std::string_view line, std::size_t count) {
    return fmt::format(
        "the track crosses the {} line only against the course's direction, {} (are left and right "
        "exchanged?)",
        line, count_of(count));
}

/// Crossings of the finish line after the first forward crossing of the start line.
struct FinishesAfter {
    std::size_t forward = 0;          ///< in a series with such a crossing before it
    std::size_t backward = 0;         ///< likewise
    std::size_t in_later_series = 0;  ///< with such a crossing only in an earlier series
};

FinishesAfter finishes_after_start(const LineCrossings& all) {
    FinishesAfter after;
    const LineCrossing* start = nullptr;  // the last forward crossing
    for (const LineCrossing& one : all) {
        if (one.line == Line::start) {
            if (one.crossing.forward) start = &one;
        } else if (start) {
            if (start->crossing.series != one.crossing.series)
                ++after.in_later_series;
            else
                ++(one.crossing.forward ? after.forward : after.backward);
        }
    }
    return after;
}

}  // namespace

std::vector<Passage> passages(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                              const SurveyedLine& finish) {
    return passages_in(both_lines(series, start, finish));
}

std::string why_no_passage(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                           const SurveyedLine& finish) {
    const LineCrossings all = both_lines(series, start, finish);
    if (!passages_in(all).empty()) return {};
    std::size_t forward = 0;
    std::size_t backward = 0;
    for (const LineCrossing& one : all)
        if (one.line == Line::start) ++(one.crossing.forward ? forward : backward);
    if (forward + backward == 0) return "the track never crosses the start line";
    if (forward == 0) return only_against("start", backward);
    const FinishesAfter after = finishes_after_start(all);
    const std::string begins =
        fmt::format("the track crosses the start line {}", count_of(forward));
    if (after.forward > 0)
        return begins +
               ", but always crosses a line against the course's direction before it reaches the "
               "finish line";
    if (after.backward > 0) return only_against("finish", after.backward);
    if (after.in_later_series > 0)
        return begins + ", but the finish line after it only beyond a gap in the positions";
    return begins + " but never the finish line after it";
}

}  // namespace runcert

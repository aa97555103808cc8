#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/claimed_text.h"
#include "core/failure.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/results/results.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

using Rows = std::span<const TrajectoryEpoch>;

std::string point_text(const Geodetic& at, bool with_height) {
    constexpr int degree_decimals = 9;
    std::string text = format_fixed(at.longitude.degrees(), degree_decimals) + ',' +
                       format_fixed(at.latitude.degrees(), degree_decimals);
    return with_height ? text + ',' + format_fixed(at.height_m, 3) : text;
}

/// A row on the Earth. Without a height: the position with this east and north whose height is the
/// one that import put it at. Up and height run alike to 1.3e-4 within 100 km of the origin, so
/// that few steps do.
std::string point_of(const MapInput& input, const PlaceFrames& frames, const TrajectoryEpoch& row) {
    constexpr int most_steps = 10;
    constexpr double near_m = 1e-6;
    const TrajectoryTable& trajectory = *input.trajectory;
    const double ground_m = input.receiver->height_m.value_or(trajectory.origin->position.height_m);
    Eigen::Vector3d enu_m(*row.east_m, *row.north_m, row.up_m.value_or(0.0));
    Geodetic at = frames.geodetic(row.time, enu_m);
    for (int i = 0; i < most_steps && !row.up_m && std::abs(at.height_m - ground_m) > near_m; ++i) {
        enu_m.z() += ground_m - at.height_m;
        at = frames.geodetic(row.time, enu_m);
    }
    return point_text(at, row.up_m && trajectory.facts.vertical_measured);
}

/// Of every so many rows, and of the last; none of rows without a place.
std::vector<std::string> points_of(const MapInput& input, Rows rows, std::int64_t every = 1) {
    const PlaceFrames frames(*input.trajectory->origin);
    std::vector<std::string> points;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if ((i % static_cast<std::size_t>(every) == 0 || i + 1 == rows.size()) && rows[i].east_m &&
            rows[i].north_m)
            points.push_back(point_of(input, frames, rows[i]));
    return points;
}

MapFolder track_of(const MapInput& input) {
    MapFolder track{.name = "track"};
    const std::vector<TrajectoryEpoch>& rows = input.trajectory->rows;
    for (auto from = rows.begin(), to = from; from != rows.end(); from = to) {
        to = std::ranges::find_if(from, rows.end(),
                                  [&](const TrajectoryEpoch& row) { return row.arc != from->arc; });
        if (!from->arc) continue;
        const TrajectoryEpoch& last = *std::prev(to);
        const WindowSpan span =
            window_span(input.trajectory->facts, from->epoch, last.epoch, from->time, last.time);
        track.lines.push_back({.name = fmt::format("track, arc {}", *from->arc),
                               .rgb = "333333",
                               .facts = span_facts(span).facts,
                               .points = points_of(input, {from, to}, input.every)});
    }
    return track;
}

Rows rows_of(const WindowSpan& span, const TrajectoryTable& trajectory) {
    const auto row_of = [&](std::int64_t epoch) {
        return std::ranges::find(trajectory.rows, epoch, &TrajectoryEpoch::epoch);
    };
    const auto first = row_of(span.first_epoch);
    const auto last = row_of(span.last_epoch);
    if (first == trajectory.rows.end() || last == trajectory.rows.end() || last < first)
        throw Failure(std::string(products::windows_file),
                      fmt::format("the window from epoch {} to {} is not in the trajectory",
                                  span.first_epoch, span.last_epoch),
                      "The files are of different runs; certify again");
    return {first, last + 1};
}

/// What is said of a window of a rule, which is certified, or refused for reasons.
std::vector<Fact> facts_of(const ProfileVerdict& verdict, const WindowSpan& span, double speed_m_s,
                           const std::optional<double>& expanded_uncertainty_m_s,
                           const std::vector<std::string>& refusals) {
    Block block = facts({{"Rule", verdict.profile},
                         {"Body", verdict.body},
                         {"Title", verdict.title},
                         {"Speed defined as", std::string(words_of(verdict.definition))}});
    if (refusals.empty()) {
        add_fact(block, "Outcome", outcome_words(state_of(verdict)).title);
        add_fact(block, "Why", verdict.reason);
    }
    add_fact(block, "Speed (m/s)", format_fixed(speed_m_s, speed_decimals_kept));
    if (expanded_uncertainty_m_s)
        add_fact(block,
                 fmt::format("Expanded uncertainty, k = {} (m/s)",
                             coverage_text(verdict.coverage_factor)),
                 format_fixed(*expanded_uncertainty_m_s, speed_decimals_kept));
    add_fact(block, "Not certified, because", fmt::format("{}", fmt::join(refusals, "; ")));
    std::ranges::move(span_facts(span).facts, std::back_inserter(block.facts));
    return block.facts;
}

/// The windows of one rule, in the order in which they are drawn. Colours are those of Okabe and
/// Ito [OI08], which the colour-blind tell apart. Windows of several rules lie over one another,
/// and get narrower from the first on.
void add_windows(const MapInput& input, std::size_t rule, MapFolder& windows) {
    constexpr std::array rule_rgb{"0072B2", "009E73", "CC79A7", "56B4E9"};
    constexpr const char* refused_rgb = "D55E00";
    const int width = 10 - 2 * static_cast<int>(std::min<std::size_t>(rule, 3));
    const ProfileVerdict& verdict = input.verdict->profiles[rule];
    const std::string unit = verdict.shown ? verdict.shown->unit : "km/h";
    const auto add = [&](const std::string& name, const WindowSpan& span, double speed_m_s,
                         const std::optional<double>& expanded_uncertainty_m_s,
                         const std::vector<std::string>& refusals = {}) -> MapLine& {
        return windows.lines.emplace_back(
            MapLine{.name = fmt::format("{}: {}", verdict.profile, name),
                    .rgb = rule_rgb[rule % rule_rgb.size()],
                    .width = width,
                    .facts = facts_of(verdict, span, speed_m_s, expanded_uncertainty_m_s, refusals),
                    .points = points_of(input, rows_of(span, *input.trajectory))});
    };
    if (const auto& refused = verdict.indicated) {
        MapLine& line =
            add(speed_beside(verdict, refused->speed_m_s, unit) + " REFUSED, not certified",
                refused->span, refused->speed_m_s, {}, refused->refusals);
        line.rgb = refused_rgb;
        line.width += 2;
    }
    if (const ProfileWindows* found = windows_of(*input.windows, verdict.profile))
        for (const FurtherWindow& window : found->further)
            add(speed_beside(verdict, window.speed_m_s, unit) + ", another window of the mean",
                window.span, window.speed_m_s,
                expanded_uncertainty_m_s(window, verdict.coverage_factor));
    if (verdict.window && verdict.speed_m_s)
        add(measured_speed_text(shown_of(verdict, unit)), *verdict.window, *verdict.speed_m_s,
            verdict.expanded_uncertainty_m_s);
}

MapFolder course_of(const Attempt& attempt) {
    MapFolder course{.name = "course"};
    const auto add = [&](const char* name, const CourseLine& line) {
        if (line.left.geodetic && line.right.geodetic)
            course.lines.push_back({.name = name,
                                    .rgb = "000000",
                                    .width = 4,
                                    .points = {point_text(*line.left.geodetic, false),
                                               point_text(*line.right.geodetic, false)}});
    };
    if (attempt.course) {
        add("start line", attempt.course->start);
        add("finish line", attempt.course->finish);
    }
    return course;
}

/// The file's own words on what it is.
std::vector<std::string> about(const MapInput& input) {
    const RecordingFacts& facts = input.trajectory->facts;
    std::vector<std::string> lines{"Craft, as claimed: " + claimed(input.attempt->craft.name)};
    if (!input.attempt->place.empty())
        lines.push_back("Place, as claimed: " + claimed(input.attempt->place));
    lines.push_back("Receiver: " + facts.receiver);
    lines.emplace_back(
        "Track: smoothed positions (WGS 84), cut at gaps; a map for looking, not the record: that "
        "is report.json.");
    lines.emplace_back(facts.vertical_measured
                           ? "Ellipsoidal heights: above the WGS 84 ellipsoid, not above sea level."
                           : "Heights were not measured.");
    return lines;
}

}  // namespace

RunMap map_of(const MapInput& input) {
    const TrajectoryTable& trajectory = *input.trajectory;
    if (!trajectory.facts.georeferenced || !trajectory.origin)
        throw Failure("the run of receiver \"" + trajectory.facts.receiver + "\"",
                      "its positions are engineering coordinates, and it was not stated where on "
                      "the Earth they lie: there is no map to put them on",
                      "Export the tables instead: --format csv");
    MapFolder windows{.name = "windows"};
    if (input.windows != nullptr && input.verdict != nullptr &&
        input.verdict->receiver == trajectory.facts.receiver)
        for (std::size_t rule = 0; rule < input.verdict->profiles.size(); ++rule)
            add_windows(input, rule, windows);
    RunMap map{.name = input.attempt->id,
               .about = about(input),
               .folders = {std::move(windows), course_of(*input.attempt), track_of(input)}};
    for (MapFolder& folder : map.folders)  // a refused window may hold no smoothed position
        std::erase_if(folder.lines, [](const MapLine& line) { return line.points.empty(); });
    std::erase_if(map.folders, [](const MapFolder& folder) { return folder.lines.empty(); });
    return map;
}

}  // namespace runcert

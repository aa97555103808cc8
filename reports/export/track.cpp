#include "reports/export/track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/geodesy.h"
#include "schemas/common/product_files.h"

namespace runcert {
namespace {

constexpr double degrees_step = 1e-9;  // nine decimals
constexpr double height_step_m = 1e-3;

double rounded(double value, double step) {
    return std::round(value / step) * step;
}

/// Turns rows of the trajectory into geodetic coordinates.
class ToTheEarth {
  public:
    ToTheEarth(const RecordingFacts& facts, const FrameOrigin& origin,
               std::optional<double> ground_m)
        : facts_(facts), frames_(origin), ground_m_(ground_m.value_or(origin.position.height_m)) {}

    TrackPoint point(const TrajectoryEpoch& row) const {
        const Geodetic at =
            row.up_m
                ? frames_.geodetic(row.time, {row.east_m.value(), row.north_m.value(), *row.up_m})
                : at_the_ground(row.time, row.east_m.value(), row.north_m.value());
        TrackPoint point = track_point(at);
        point.time = row.time;
        if (row.up_m && facts_.vertical_measured)
            point.height_m = rounded(at.height_m, height_step_m);
        if (facts_.first_epoch)
            point.instant = facts_.first_epoch->plus_nanoseconds(row.time.nanoseconds);
        return point;
    }

    static TrackPoint track_point(const Geodetic& at) {
        return {.latitude_deg = rounded(at.latitude.degrees(), degrees_step),
                .longitude_deg = rounded(at.longitude.degrees(), degrees_step)};
    }

  private:
    /// The position with this east and north whose height is the one that import put it at. Up and
    /// height run alike to 1.3e-4 within 100 km of the origin, so that few steps do.
    Geodetic at_the_ground(ElapsedTime time, double east_m, double north_m) const {
        constexpr int most_steps = 10;
        constexpr double near_m = 1e-6;
        Geodetic at = frames_.geodetic(time, {east_m, north_m, 0.0});
        double up_m = 0.0;
        for (int i = 0; i < most_steps && std::abs(at.height_m - ground_m_) > near_m; ++i) {
            up_m += ground_m_ - at.height_m;
            at = frames_.geodetic(time, {east_m, north_m, up_m});
        }
        return at;
    }

    RecordingFacts facts_;
    PlaceFrames frames_;
    double ground_m_;
};

std::vector<TrackArc> arcs_of(const TrackInput& input, const ToTheEarth& earth) {
    std::vector<TrackArc> arcs;
    std::vector<std::size_t> arc_rows;
    const auto& rows = input.trajectory->rows;
    const auto finish = [&] {
        if (arc_rows.empty()) return;
        TrackArc arc{.number = rows[arc_rows.front()].arc.value()};
        for (std::size_t i = 0; i < arc_rows.size(); ++i)
            if (i % static_cast<std::size_t>(input.every) == 0 || i + 1 == arc_rows.size())
                arc.points.push_back(earth.point(rows[arc_rows[i]]));
        arcs.push_back(std::move(arc));
        arc_rows.clear();
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool placed = rows[i].arc && rows[i].east_m && rows[i].north_m;
        if (!placed || (!arc_rows.empty() && rows[arc_rows.back()].arc != rows[i].arc)) finish();
        if (placed) arc_rows.push_back(i);
    }
    finish();
    return arcs;
}

std::vector<TrackPoint> points_between(const TrajectoryTable& trajectory, const WindowSpan& span,
                                       const ToTheEarth& earth) {
    std::vector<TrackPoint> points;
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
    for (auto row = first; row <= last; ++row)
        if (row->east_m && row->north_m) points.push_back(earth.point(*row));
    return points;
}

/// The windows of one rule, in the order in which they are to be drawn.
void add_windows(const TrackInput& input, std::size_t rule, const ToTheEarth& earth,
                 std::vector<TrackWindow>& windows) {
    const ProfileVerdict& verdict = input.verdict->profiles[rule];
    const auto add = [&](TrackWindowKind kind, const WindowSpan& span) -> TrackWindow& {
        return windows.emplace_back(
            TrackWindow{.kind = kind,
                        .rule = rule,
                        .verdict = &verdict,
                        .span = span,
                        .points = points_between(*input.trajectory, span, earth)});
    };
    if (verdict.indicated) {
        TrackWindow& refused = add(TrackWindowKind::refused, verdict.indicated->span);
        refused.speed_m_s = verdict.indicated->speed_m_s;
        refused.refusals = verdict.indicated->refusals;
    }
    if (const ProfileWindows* found = windows_of(*input.windows, verdict.profile))
        for (const FurtherWindow& further : found->further) {
            TrackWindow& window = add(TrackWindowKind::further, further.span);
            window.speed_m_s = further.speed_m_s;
            window.expanded_uncertainty_m_s =
                expanded_uncertainty_m_s(further, verdict.coverage_factor);
        }
    if (verdict.window && verdict.speed_m_s) {
        TrackWindow& best = add(TrackWindowKind::best, *verdict.window);
        best.speed_m_s = *verdict.speed_m_s;
        best.expanded_uncertainty_m_s = verdict.expanded_uncertainty_m_s;
    }
}

std::vector<TrackGate> gates_of(const Attempt& attempt) {
    std::vector<TrackGate> gates;
    if (!attempt.course) return gates;
    const auto add = [&](const char* name, const CourseLine& line) {
        if (line.left.geodetic && line.right.geodetic)
            gates.push_back({.name = name,
                             .left = ToTheEarth::track_point(*line.left.geodetic),
                             .right = ToTheEarth::track_point(*line.right.geodetic)});
    };
    add("start", attempt.course->start);
    add("finish", attempt.course->finish);
    return gates;
}

}  // namespace

Track track_of(const TrackInput& input) {
    const TrajectoryTable& trajectory = *input.trajectory;
    if (!trajectory.facts.georeferenced || !trajectory.origin)
        throw Failure("the run of receiver \"" + trajectory.facts.receiver + "\"",
                      "its positions are engineering coordinates, and it was not stated where on "
                      "the Earth they lie: there is no map to put them on",
                      "Export the tables instead: --format csv");
    const ToTheEarth earth(trajectory.facts, *trajectory.origin, input.receiver->height_m);
    Track track{.attempt = input.attempt->id,
                .craft = input.attempt->craft.name,
                .place = input.attempt->place,
                .receiver = trajectory.facts.receiver,
                .heights_measured = trajectory.facts.vertical_measured,
                .arcs = arcs_of(input, earth),
                .gates = gates_of(*input.attempt)};
    if (input.windows != nullptr && input.verdict != nullptr &&
        input.verdict->receiver == trajectory.facts.receiver)
        for (std::size_t rule = 0; rule < input.verdict->profiles.size(); ++rule)
            add_windows(input, rule, earth, track.windows);
    return track;
}

}  // namespace runcert

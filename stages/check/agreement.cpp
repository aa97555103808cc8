#include "stages/check/agreement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/uncertainty.h"

namespace runcert {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d;

constexpr std::int64_t tolerance_ns = 1000;

struct Motion {
    Vector2d position, velocity, acceleration;
    Vector2d variance;  ///< of the position, towards east and north
};

Motion motion_of(const TrajectoryEpoch& row) {
    return {
        .position = {row.east_m.value(), row.north_m.value()},
        .velocity = {row.velocity_east_m_s.value(), row.velocity_north_m_s.value()},
        .acceleration = {row.acceleration_east_m_s2.value(), row.acceleration_north_m_s2.value()},
        .variance = {std::pow(row.sigma_east_m.value(), 2),
                     std::pow(row.sigma_north_m.value(), 2)}};
}

/// The rows that hold a stretch of time between them, both ends on or outside it.
struct Coverage {
    std::size_t first = 0, last = 0;
    std::string missing;
};

Coverage coverage_of(const ReceiverFindings& receiver, std::int64_t from_ns, std::int64_t to_ns) {
    const auto& rows = receiver.trajectory;
    std::optional<std::size_t> first, last;
    for (std::size_t i = 0; i < rows.size() && !last; ++i) {
        if (!rows[i].arc) continue;
        if (rows[i].time.nanoseconds <= from_ns + tolerance_ns) first = i;
        if (rows[i].time.nanoseconds >= to_ns - tolerance_ns) last = i;
    }
    if (!first || !last) return {.missing = "has no estimate over the whole of that time"};
    for (std::size_t i = *first; i <= *last; ++i)
        if (!rows[i].usable || rows[i].arc != rows[*first].arc)
            return {.missing = "has a break or an unusable epoch in that time"};
    for (const std::int64_t epoch : receiver.bridged_epochs)
        if (epoch > rows[*first].epoch && epoch <= rows[*last].epoch)
            return {.missing = "has a step in that time whose offset is not known"};
    return {.first = *first, .last = *last, .missing = {}};
}

/// Position and its variance at a time between two of the rows covered.
struct PositionAt {
    Vector2d position, variance;
};

PositionAt position_at(const ReceiverFindings& receiver, const Coverage& covered,
                       std::int64_t time_ns) {
    const auto& rows = receiver.trajectory;
    std::size_t i = covered.first;
    while (i < covered.last && rows[i].time.nanoseconds < time_ns - tolerance_ns)
        ++i;
    const Motion b = motion_of(rows[i]);
    if (i == covered.first || std::abs(rows[i].time.nanoseconds - time_ns) <= tolerance_ns)
        return {b.position, b.variance};
    const Motion a = motion_of(rows[i - 1]);
    const double h = rows[i].time.seconds() - rows[i - 1].time.seconds();
    const double s = static_cast<double>(time_ns - rows[i - 1].time.nanoseconds) * 1e-9 / h;
    const double s3 = s * s * s, s4 = s3 * s, s5 = s4 * s;
    const double to_b = 10.0 * s3 - 15.0 * s4 + 6.0 * s5;
    const Vector2d velocities = (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5) * a.velocity +
                                (-4.0 * s3 + 7.0 * s4 - 3.0 * s5) * b.velocity;
    const Vector2d accelerations = 0.5 * (s * s - 3.0 * s3 + 3.0 * s4 - s5) * a.acceleration +
                                   0.5 * (s3 - 2.0 * s4 + s5) * b.acceleration;
    return {.position = a.position + to_b * (b.position - a.position) + h * velocities +
                        h * h * accelerations,
            .variance = a.variance.cwiseMax(b.variance)};
}

/// A position of one receiver in the frame of the other.
std::optional<Vector2d> in_frame(const Vector2d& position, const std::optional<FrameOrigin>& own,
                                 const std::optional<FrameOrigin>& wanted) {
    if (own.has_value() != wanted.has_value()) return std::nullopt;
    if (!own) return position;
    const Geodetic place =
        LocalFrame(own->position).geodetic_from_enu(Enu{{position.x(), position.y(), 0.0}});
    return LocalFrame(wanted->position).enu_from_geodetic(place).m.head<2>();
}

/// By how much the vector between the antennas changes as it turns with the track.
Vector2d turned_baseline(const Vector2d& baseline, const Motion& from, const Motion& to) {
    constexpr double longest_m = 50.0;
    if (!(baseline.norm() <= longest_m)) return Vector2d::Zero();
    const Vector2d &v = from.velocity, &w = to.velocity;
    const double angle = std::atan2(v.x() * w.y() - v.y() * w.x(), v.dot(w));
    return Eigen::Rotation2Dd(angle) * baseline - baseline;
}

const TrajectoryEpoch& row_of(const ReceiverFindings& receiver, std::int64_t epoch) {
    const auto row = std::ranges::find(receiver.trajectory, epoch, &TrajectoryEpoch::epoch);
    if (row == receiver.trajectory.end())
        throw Failure("4-trajectory of receiver " + receiver.receiver,
                      "the window's epochs are not in it", "Run runcert-window again");
    return *row;
}

}  // namespace

Agreement compare_speeds(const ReceiverFindings& judged, const CertifiableWindow& window,
                         const ReceiverFindings& other, const CertifiableWindow* other_window) {
    Agreement agreement;
    if (!judged.facts.first_epoch || !other.facts.first_epoch) {
        agreement.missing =
            "cannot be compared: the time of a recording is relative (give its start_gps)";
        return agreement;
    }
    const std::int64_t from_ns =
        window.span.start.nanoseconds +
        judged.facts.first_epoch->nanoseconds_since(*other.facts.first_epoch);
    const std::int64_t to_ns = from_ns + window.span.duration.nanoseconds;
    const Coverage covered = coverage_of(other, from_ns, to_ns);
    agreement.missing = covered.missing;
    if (!covered.missing.empty()) return agreement;

    const PositionAt from = position_at(other, covered, from_ns);
    const PositionAt to = position_at(other, covered, to_ns);
    const Motion judged_from = motion_of(row_of(judged, window.span.first_epoch));
    const Motion judged_to = motion_of(row_of(judged, window.span.last_epoch));
    Vector2d moved = to.position - from.position;
    if (const auto antenna = in_frame(from.position, other.origin, judged.origin))
        moved -= turned_baseline(*antenna - judged_from.position, judged_from, judged_to);

    const double duration_s = window.span.duration.seconds();
    const Vector2d direction = moved.stableNormalized();
    const double of_ends = std::sqrt(direction.cwiseAbs2().dot(from.variance + to.variance));
    agreement.judged_m_s = window.definitions.displacement_m_s;
    agreement.other_m_s = moved.norm() / duration_s;
    const auto own_m_s = [](const CertifiableWindow& one) {
        return one.own_standard_uncertainty_m_s.value_or(one.standard_uncertainty_m_s);
    };
    agreement.judged_standard_uncertainty_m_s = own_m_s(window);
    agreement.other_standard_uncertainty_m_s =
        std::max(of_ends / duration_s, other_window ? own_m_s(*other_window) : own_m_s(window));
    agreement.normalised_error =
        std::abs(agreement.other_m_s - agreement.judged_m_s) /
        (usual_coverage_factor * std::hypot(agreement.judged_standard_uncertainty_m_s,
                                            agreement.other_standard_uncertainty_m_s));
    return agreement;
}

}  // namespace runcert

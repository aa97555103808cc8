#include "stages/enu/enu.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/failure.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

/// What is one place: as far as the local frame is verified to rounding.
constexpr double place_m = 20'000.0;
constexpr double interruption_s = 60.0;

/// m; a plane of no more is what a local frame serves.
constexpr double far_m = 100'000.0;

bool has_position(const Observation& row) {
    return row.latitude_deg && row.longitude_deg && row.height_m;
}

/// Whether a row says where the receiver was.
bool is_located(const Observation& row) {
    return has_position(row) && row.fix != FixType::none;
}

Geodetic position_of(const Observation& row) {
    return {.latitude = Angle::from_degrees(*row.latitude_deg),
            .longitude = Angle::from_degrees(*row.longitude_deg),
            .height_m = *row.height_m};
}

StatedAccuracy accuracy_of(const Eigen::Matrix3d& covariance, bool vertical) {
    const Eigen::Vector3d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const auto correlation = [&](int i, int j) -> std::optional<double> {
        const double scale = sigma(i) * sigma(j);
        if (!(scale > 0.0)) return std::nullopt;
        return covariance(i, j) / scale;
    };
    StatedAccuracy accuracy{.sigma_east_m = sigma(0),
                            .sigma_north_m = sigma(1),
                            .sigma_up_m = std::nullopt,
                            .correlation_east_north = correlation(0, 1),
                            .correlation_east_up = std::nullopt,
                            .correlation_north_up = std::nullopt};
    if (vertical) {
        accuracy.sigma_up_m = sigma(2);
        accuracy.correlation_east_up = correlation(0, 2);
        accuracy.correlation_north_up = correlation(1, 2);
    }
    return accuracy;
}

void rotate_velocity(const RecordedVelocity& from, const Eigen::Matrix3d& rotation, EnuEpoch& to) {
    if (!from.recorded_velocity_east_m_s || !from.recorded_velocity_north_m_s) return;
    const Eigen::Vector3d velocity =
        rotation * Eigen::Vector3d(*from.recorded_velocity_east_m_s,
                                   *from.recorded_velocity_north_m_s,
                                   from.recorded_velocity_up_m_s.value_or(0.0));
    to.recorded_velocity_east_m_s = velocity.x();
    to.recorded_velocity_north_m_s = velocity.y();
    if (from.recorded_velocity_up_m_s) to.recorded_velocity_up_m_s = velocity.z();
    if (!from.sigma_recorded_velocity_east_m_s || !from.sigma_recorded_velocity_north_m_s) return;
    const Eigen::Vector3d variance =
        Eigen::Vector3d(*from.sigma_recorded_velocity_east_m_s,
                        *from.sigma_recorded_velocity_north_m_s,
                        from.sigma_recorded_velocity_up_m_s.value_or(0.0))
            .cwiseAbs2();
    const Eigen::Matrix3d rotated = rotation * variance.asDiagonal() * rotation.transpose();
    to.sigma_recorded_velocity_east_m_s = std::sqrt(rotated(0, 0));
    to.sigma_recorded_velocity_north_m_s = std::sqrt(rotated(1, 1));
    if (from.sigma_recorded_velocity_up_m_s)
        to.sigma_recorded_velocity_up_m_s = std::sqrt(rotated(2, 2));
}

EnuEpoch carried_over(const Observation& row) {
    EnuEpoch epoch;
    static_cast<EpochQuality&>(epoch) = row;
    epoch.epoch = row.epoch;
    epoch.time = row.time;
    epoch.recorded_speed_m_s = row.recorded_speed_m_s;
    epoch.sigma_recorded_speed_m_s = row.sigma_recorded_speed_m_s;
    return epoch;
}

EnuEpoch from_local_plane(const Observation& row) {
    EnuEpoch epoch = carried_over(row);
    static_cast<StatedAccuracy&>(epoch) = row;
    static_cast<RecordedVelocity&>(epoch) = row;
    epoch.east_m = row.plane_east_m;
    epoch.north_m = row.plane_north_m;
    epoch.up_m = row.plane_up_m;
    return epoch;
}

}  // namespace

void FirstPosition::see(const Observation& row) {
    if (!is_located(row)) return;
    const Geodetic position = position_of(row);
    if (votes_ == 0) {
        place_.emplace(position);
        fixed_.reset();
        any_.reset();
    }
    if (place_->enu_from_geodetic(position).m.norm() > place_m) {
        --votes_;
        return;
    }
    ++votes_;
    if (!any_) any_ = position;
    if (!fixed_ && row.fix == FixType::fixed) fixed_ = position;
}

Places::Places(const Geodetic& origin)
    : home_{.from = {}, .origin = origin, .origin_m = ecef_from_geodetic(origin).m}, here_(home_) {}

bool Places::is_elsewhere(ElapsedTime time, const Eigen::Vector3d& ecef_m) const {
    if ((ecef_m - here_.origin_m).norm() > far_m) return true;
    // As integers the difference of stamps centuries apart would overflow.
    return seen_ && std::abs(time.seconds() - seen_->seconds()) > interruption_s &&
           (ecef_m - seen_m_).norm() > place_m;
}

void Places::see(const Observation& row) {
    constexpr int fewest_positions = 30;
    if (!is_located(row)) return;
    const Geodetic position = position_of(row);
    const Eigen::Vector3d ecef_m = ecef_from_geodetic(position).m;
    if (!is_elsewhere(row.time, ecef_m)) {
        seen_ = row.time;
        seen_m_ = ecef_m;
        elsewhere_.reset();
        return;
    }
    if (!elsewhere_ || (ecef_m - elsewhere_->origin_m).norm() > place_m)
        elsewhere_ = {.from = row.time, .origin = position, .origin_m = ecef_m};
    if (++elsewhere_->positions < fewest_positions) return;
    begin_place();
    seen_ = row.time;
    seen_m_ = ecef_m;
}

void Places::begin_place() {
    Stay begun = *elsewhere_;
    elsewhere_.reset();
    const auto is_near = [&](const Stay& other) {
        return (other.origin_m - begun.origin_m).norm() <= place_m;
    };
    const auto known = std::ranges::find_if(places_, is_near);
    const Stay* const before = is_near(home_) ? &home_ : known != places_.end() ? &*known : nullptr;
    if (before != nullptr) {
        begun.origin = before->origin;
        begun.origin_m = before->origin_m;
    }
    here_ = begun;
    places_.push_back(begun);
}

std::vector<FramePlace> Places::found() const {
    std::vector<Stay> ordered = places_;
    std::ranges::stable_sort(ordered, {}, &Stay::from);
    const LocalFrame frame(home_.origin);
    std::vector<FramePlace> found;
    Eigen::Vector3d last_m = home_.origin_m;
    for (const Stay& stay : ordered) {
        if (stay.origin_m == last_m) continue;
        last_m = stay.origin_m;
        Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
        if (stay.origin_m != home_.origin_m) at_m = frame.enu_from_ecef({stay.origin_m}).m;
        found.push_back(
            {.from = stay.from, .position = stay.origin, .east_m = at_m.x(), .north_m = at_m.y()});
    }
    return found;
}

ToLocalFrame::ToLocalFrame(const RecordingFacts& facts, const std::optional<Geodetic>& stated,
                           const std::optional<Geodetic>& first)
    : vertical_(facts.vertical_measured) {
    if (!facts.georeferenced) {
        if (stated)
            throw Failure("origin",
                          "a geodetic origin is stated, but the recording's coordinates are "
                          "those of an engineering CRS",
                          "Remove `origin:`, or state the coordinates' real frame");
        return;
    }
    const auto position = stated ? stated : first;
    if (!position && !facts.vertical_measured)
        throw Failure("recording of receiver " + facts.receiver,
                      "the recording has no heights, and the attempt states none",
                      "Write height_m in the receiver: the course's height above the ellipsoid in "
                      "metres");
    if (!position)
        throw Failure("recording of receiver " + facts.receiver, "no epoch has a position",
                      "Give a recording with positions");
    origin_ = FrameOrigin{.position = *position, .source = stated ? "attempt" : "first_epoch"};
    frames_.emplace(*origin_);
}

void ToLocalFrame::set_receiver_positions(std::vector<FramePlace> places) {
    origin_->places = std::move(places);
    frames_.emplace(*origin_);
}

EnuEpoch ToLocalFrame::from_the_earth(const Observation& row) {
    EnuEpoch epoch = carried_over(row);
    if (!has_position(row)) return epoch;
    const Geodetic position = position_of(row);
    const Eigen::Vector3d enu = frames_->enu_m(row.time, position);
    if (row.fix != FixType::none) {
        ++positions_;
        if (enu.norm() > far_m && ++far_ == 1) {
            first_far_m_ = enu.norm();
            first_far_ = row.source_line ? fmt::format("line {} of the recording", *row.source_line)
                                         : fmt::format("epoch {}", row.epoch);
        }
    }
    epoch.east_m = enu.x();
    epoch.north_m = enu.y();
    if (vertical_) epoch.up_m = enu.z();
    const Eigen::Matrix3d rotation =
        frames_->at(row.time).rotation_from_local(position.latitude, position.longitude);
    const bool vertical_stated = vertical_ && row.sigma_up_m.has_value();
    if (row.sigma_east_m && row.sigma_north_m)
        static_cast<StatedAccuracy&>(epoch) = accuracy_of(
            rotation * stated_covariance<3>(row) * rotation.transpose(), vertical_stated);
    rotate_velocity(row, rotation, epoch);
    return epoch;
}

EnuEpoch ToLocalFrame::operator()(const Observation& row) {
    return frames_ ? from_the_earth(row) : from_local_plane(row);
}

void ToLocalFrame::finish() const {
    // So few near it may be outliers; where more are, it is a place of its own.
    constexpr long fewest_near = 30;
    if (2 * far_ <= positions_ || positions_ - far_ >= fewest_near) return;
    throw Failure(first_far_,
                  fmt::format("the position is {:.0f} km from the origin of the local frame, and "
                              "{} of {} positions lie more than {:.0f} km from it",
                              first_far_m_ / 1000.0, far_, positions_, far_m / 1000.0),
                  "Check `origin:` in the attempt, and whether latitude and longitude are "
                  "swapped");
}

EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin) {
    const RecordingFacts& facts = observations.facts;
    FirstPosition first;
    if (ToLocalFrame::needs_first_position(facts, stated_origin))
        for (const Observation& row : observations.rows)
            first.see(row);
    ToLocalFrame to_local(facts, stated_origin, first.position());
    if (to_local.origin()) {
        Places places(to_local.origin()->position);
        for (const Observation& row : observations.rows)
            places.see(row);
        to_local.set_receiver_positions(places.found());
    }
    EnuTable table;
    table.facts = facts;
    table.origin = to_local.origin();
    table.rows.reserve(observations.rows.size());
    for (const Observation& row : observations.rows)
        table.rows.push_back(to_local(row));
    to_local.finish();
    return table;
}

}  // namespace runcert

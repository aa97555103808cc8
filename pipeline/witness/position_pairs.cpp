#include "witness/position_pairs.h"

#include "core/geodesy.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

/// Transforms the positions of one table to the frame of another.
class PositionsInFrame {
  public:
    PositionsInFrame(const std::optional<FrameOrigin>& own,
                     const std::optional<FrameOrigin>& wanted, bool in_space)
        : in_space_(in_space) {
        if (!own || !wanted) return;
        const Geodetic &a = own->position, &b = wanted->position;
        if (own->places.empty() && wanted->places.empty() && a.latitude == b.latitude &&
            a.longitude == b.longitude && a.height_m == b.height_m)
            return;
        own_.emplace(*own);
        wanted_.emplace(*wanted);
    }

    /// `there` is the same moment on the other's clock.
    Vector3d of(const EnuEpoch& row, ElapsedTime there) const {
        const Vector3d own(row.east_m.value(), row.north_m.value(), in_space_ ? *row.up_m : 0.0);
        Vector3d position = own_ ? wanted_->enu_m(there, own_->geodetic(row.time, own)) : own;
        if (!in_space_) position.z() = 0.0;
        return position;
    }

  private:
    bool in_space_;
    std::optional<PlaceFrames> own_, wanted_;
};

Matrix3d covariance_of(const EnuEpoch& row, bool in_space) {
    if (in_space) return stated_covariance<3>(row);
    Matrix3d covariance = Matrix3d::Zero();
    covariance.topLeftCorner<2, 2>() = stated_covariance<2>(row);
    return covariance;
}

}  // namespace

std::vector<PositionPair> position_pairs(const ScreenedTable& first, const ScreenedTable& second) {
    constexpr std::int64_t tolerance_ns = 1000;
    std::vector<PositionPair> pairs;
    if (!first.facts.first_epoch || !second.facts.first_epoch) return pairs;
    if (first.origin.has_value() != second.origin.has_value()) return pairs;
    const bool in_space = first.facts.vertical_measured && second.facts.vertical_measured;
    const PositionsInFrame of_first(first.origin, first.origin, in_space);
    const PositionsInFrame of_second(second.origin, first.origin, in_space);
    const std::int64_t later_ns =
        second.facts.first_epoch->nanoseconds_since(*first.facts.first_epoch);
    std::size_t j = 0;
    for (std::size_t i = 0; i < first.rows.size(); ++i) {
        const ScreenedEpoch& a = first.rows[i];
        if (!a.usable) continue;
        const auto behind_ns = [&] {  // how far the second's row is behind
            return a.time.nanoseconds - second.rows[j].time.nanoseconds - later_ns;
        };
        while (j < second.rows.size() && (!second.rows[j].usable || behind_ns() > tolerance_ns))
            ++j;
        if (j == second.rows.size()) break;
        if (behind_ns() < -tolerance_ns) continue;
        const ScreenedEpoch& b = second.rows[j];
        pairs.push_back({.rows = {i, j},
                         .time = a.time,
                         .difference = of_second.of(b, a.time) - of_first.of(a, a.time),
                         .covariance = covariance_of(a, in_space) + covariance_of(b, in_space)});
    }
    return pairs;
}

}  // namespace runcert

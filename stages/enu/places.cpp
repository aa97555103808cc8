#include "stages/enu/places.h"

#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

/// What is one place: as far as the local frame is verified to rounding.
constexpr double place_m = 20'000.0;
constexpr double interruption_s = 60.0;

}  // namespace

bool is_located(const Observation& row) {
    return row.latitude_deg && row.longitude_deg && row.height_m && row.fix != FixType::none;
}

Geodetic position_of(const Observation& row) {
    return {.latitude = Angle::from_degrees(*row.latitude_deg),
            .longitude = Angle::from_degrees(*row.longitude_deg),
            .height_m = *row.height_m};
}

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

}  // namespace runcert

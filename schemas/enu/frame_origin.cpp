#include "schemas/enu/frame_origin.h"

#include <algorithm>

namespace runcert {
/// Which place holds at a time: 0 before the first, where it is the origin itself.
std::size_t FrameOrigin::number_at(ElapsedTime time) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(places, time, {}, &FramePlace::from) -
                                    places.begin());
}

FramePlace FrameOrigin::place(std::size_t number) const {
    return number == 0 ? FramePlace{.from = {}, .position = position} : places[number - 1];
}

PlaceFrames::PlaceFrames(const FrameOrigin& origin) : origin_(origin) {
    for (std::size_t number = 0; number <= origin.places.size(); ++number)
        frames_.emplace_back(origin.place(number).position);
}

Eigen::Vector3d PlaceFrames::offset_m(std::size_t number) const {
    const FramePlace place = origin_.place(number);
    return {place.east_m, place.north_m, 0.0};
}

Eigen::Vector3d PlaceFrames::enu_m(ElapsedTime time, const Geodetic& position) const {
    const std::size_t number = origin_.number_at(time);
    return frames_[number].enu_from_geodetic(position).m + offset_m(number);
}

Geodetic PlaceFrames::geodetic(ElapsedTime time, const Eigen::Vector3d& enu_m) const {
    return geodetic_from_ecef(ecef(time, enu_m));
}

Ecef PlaceFrames::ecef(ElapsedTime time, const Eigen::Vector3d& enu_m) const {
    const std::size_t number = origin_.number_at(time);
    return frames_[number].ecef_from_enu({enu_m - offset_m(number)});
}

Eigen::Vector2d PlaceFrames::on_the_ground_m(Geodetic point) const {
    const Ecef there = ecef_from_geodetic(point);
    const auto nearest = std::ranges::min_element(
        frames_, {}, [&](const LocalFrame& frame) { return frame.enu_from_ecef(there).m.norm(); });
    point.height_m = nearest->origin().height_m;
    const auto number = static_cast<std::size_t>(nearest - frames_.begin());
    return (nearest->enu_from_geodetic(point).m + offset_m(number)).head<2>();
}

double fall_at_m(const std::optional<FrameOrigin>& origin, ElapsedTime time, double east_m,
                 double north_m) {
    if (!origin) return 0.0;
    const FramePlace place = origin->place_at(time);
    return fall_below_plane_m(east_m - place.east_m, north_m - place.north_m);
}

}  // namespace runcert

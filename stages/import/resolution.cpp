#include "stages/import/resolution.h"

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"

namespace runcert {
namespace {

constexpr double least_step = 1e-9;

/// Digits after the decimal point of a number or time; nothing where it has an exponent.
std::optional<int> decimals_written(std::string_view text) {
    if (text.find_first_of("eE") != std::string_view::npos) return std::nullopt;
    const std::size_t point = text.find('.');
    if (point == std::string_view::npos) return 0;
    // Behind them a zone may stand.
    const std::size_t end = std::min(text.find_first_not_of("0123456789", point + 1), text.size());
    return static_cast<int>(end - point - 1);
}

/// Lengths of a degree of latitude and of longitude on the ellipsoid (m), as chords of 11 m.
std::array<double, 2> metres_per_degree(Angle latitude) {
    constexpr double span_deg = 1e-4;
    const auto at = [](double latitude_deg, double longitude_deg) {
        return ecef_from_geodetic({.latitude = Angle::from_degrees(latitude_deg),
                                   .longitude = Angle::from_degrees(longitude_deg)})
            .m;
    };
    const double here_deg = latitude.degrees();
    const double towards_equator_deg = here_deg - std::copysign(span_deg, here_deg);
    return {(at(here_deg, 0.0) - at(towards_equator_deg, 0.0)).norm() / span_deg,
            (at(here_deg, 0.0) - at(here_deg, span_deg)).norm() / span_deg};
}

}  // namespace

void WrittenDecimals::see(std::string_view text) {
    any_ = true;
    const std::optional<int> decimals = decimals_written(text);
    if (decimals)
        most_ = std::max(most_, *decimals);
    else
        unclear_ = true;
}

std::optional<double> WrittenDecimals::step() const {
    if (!any_ || unclear_) return std::nullopt;
    return std::pow(10.0, -most_);
}

WrittenResolution::WrittenResolution(CoordinateUnit unit, double coordinate_step,
                                     double time_step_s)
    : known_coordinate_step_(coordinate_step), known_time_step_s_(time_step_s), unit_(unit) {}

void WrittenResolution::see(const WrittenCells& cells) {
    if (known_coordinate_step_) return;
    time_.see(cells.time);
    for (std::size_t i = 0; i < cells.coordinates.size(); ++i) {
        if (cells.coordinates[i].empty()) continue;
        coordinates_[i].see(cells.coordinates[i]);
        unit_ = cells.unit;
    }
}

std::optional<double> WrittenResolution::time_s() const {
    const std::optional<double> step_s = known_time_step_s_ ? known_time_step_s_ : time_.step();
    if (!step_s) return std::nullopt;
    return std::max(*step_s, least_step);
}

double WrittenResolution::metres_per_unit(std::size_t coordinate, Angle latitude) const {
    switch (unit_) {
        case CoordinateUnit::metre:
            break;
        case CoordinateUnit::degree:
            return metres_per_degree(latitude).at(coordinate);
        case CoordinateUnit::arc_minute:
            return metres_per_degree(latitude).at(coordinate) / 60.0;
        case CoordinateUnit::arc_second:
            return metres_per_degree(latitude).at(coordinate) / 3600.0;
    }
    return 1.0;
}

std::optional<double> WrittenResolution::position_m(Angle latitude) const {
    if (known_coordinate_step_) {
        const double most_m = std::max(metres_per_unit(0, latitude), metres_per_unit(1, latitude));
        return std::max(*known_coordinate_step_ * most_m, least_step);
    }
    std::optional<double> coarsest_m;
    for (std::size_t i = 0; i < coordinates_.size(); ++i) {
        if (!coordinates_[i].any()) continue;
        const std::optional<double> step = coordinates_[i].step();
        if (!step) return std::nullopt;
        const double step_m = std::max(*step * metres_per_unit(i, latitude), least_step);
        coarsest_m = std::max(coarsest_m.value_or(0.0), step_m);
    }
    return coarsest_m;
}

}  // namespace runcert

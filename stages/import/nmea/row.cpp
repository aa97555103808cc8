#include "stages/import/nmea/row.h"

#include <cmath>

#include "stages/import/earth.h"

namespace runcert::nmea {
namespace {

/// Of GGA, GNS and RMC, in this order, the first with a position; else the first that is there.
const Solution& solution_of(const Epoch& epoch) {
    for (const Solution* solution : {&epoch.gga, &epoch.gns, &epoch.rmc})
        if (solution->position) return *solution;
    return epoch.gga.given ? epoch.gga : (epoch.gns.given ? epoch.gns : epoch.rmc);
}

/// Whether the velocities of VTG, which has no time, and RMC can be of the same moment.
bool agree(const WrittenNumber& a_m_s, const WrittenNumber& b_m_s) {
    return std::abs(*a_m_s.value - *b_m_s.value) <= a_m_s.step + b_m_s.step;
}

/// The correlation of east and north errors by an error ellipse, where it says the same of north
/// and east as the standard deviations do, to within how both are written.
OptionalReal correlation_of_ellipse(const ErrorStatistics& errors) {
    const double major_m = *errors.semi_major_m.value, minor_m = *errors.semi_minor_m.value;
    const double azimuth_rad = Angle::from_degrees(*errors.orientation_deg).radians();
    const double north = std::cos(azimuth_rad), east = std::sin(azimuth_rad);
    const double sigma_north_m = std::hypot(major_m * north, minor_m * east);
    const double sigma_east_m = std::hypot(major_m * east, minor_m * north);
    const auto same = [&](double sigma_m, const WrittenNumber& stated) {
        const double rounding_m = stated.step + errors.semi_major_m.step;
        return std::abs(sigma_m - *stated.value) <= rounding_m + 0.05 * *stated.value;
    };
    if (!same(sigma_north_m, errors.sigma_north_m) || !same(sigma_east_m, errors.sigma_east_m))
        return std::nullopt;
    return (major_m - minor_m) * (major_m + minor_m) * north * east /
           (sigma_north_m * sigma_east_m);
}

}  // namespace

bool says_position(const Epoch& epoch) {
    return epoch.gga.given || epoch.gns.given || epoch.rmc.given;
}

bool has_fix(const Epoch& epoch) {
    for (const Solution* solution : {&epoch.gga, &epoch.gns, &epoch.rmc})
        if (solution->given && solution->fix == FixType::none) return false;
    if (epoch.satellite_lists > 0 && epoch.satellite_lists == epoch.satellite_lists_without_fix)
        return false;
    return solution_of(epoch).position.has_value();
}

RecordPlace place_of(const Epoch& epoch) {
    return *solution_of(epoch).place;
}

void RowMaker::set_solution(TimedRow& row, const Solution& solution) {
    set_position(row.observation, *solution.position);
    if (!solution.has_height) {
        row.observation.height_m.reset();
        ++tally_.without_height;
    }
    if (solution.above_sea_level) ++tally_.above_sea_level;
    row.written.unit = CoordinateUnit::arc_minute;
    row.written.coordinates = {solution.coordinates[0], solution.coordinates[1], {}};
}

void RowMaker::set_ground_velocity(Observation& row, const Epoch& epoch) {
    const GroundVelocity &vtg = epoch.vtg_velocity, &rmc = epoch.rmc_velocity;
    const bool both = vtg.speed_m_s.value && rmc.speed_m_s.value;
    const bool disagree = both && !agree(vtg.speed_m_s, rmc.speed_m_s);
    if (disagree) ++tally_.velocities_disagree;
    const WrittenNumber& speed_m_s = disagree ? rmc.speed_m_s : finer(vtg.speed_m_s, rmc.speed_m_s);
    const WrittenNumber& course_deg =
        disagree ? rmc.course_deg : finer(vtg.course_deg, rmc.course_deg);
    if (speed_m_s.value) set_speed(row, *speed_m_s.value, course_of(course_deg.value));
}

void RowMaker::set_errors(Observation& row, const ErrorStatistics& errors) {
    row.sigma_north_m = errors.sigma_north_m.value;
    row.sigma_east_m = errors.sigma_east_m.value;
    if (row.height_m) row.sigma_up_m = errors.sigma_up_m;
    if (!row.sigma_north_m || !row.sigma_east_m || !errors.semi_major_m.value ||
        !errors.semi_minor_m.value || !errors.orientation_deg)
        return;
    row.correlation_east_north = correlation_of_ellipse(errors);
    if (!row.correlation_east_north) ++tally_.ellipses_disagree;
}

TimedRow RowMaker::row(const Epoch& epoch, GpsTime instant) {
    const Solution& solution = solution_of(epoch);
    TimedRow row;
    row.instant = instant;
    row.written.time = epoch.time_text;
    const Solution& counts = epoch.gga.given ? epoch.gga : epoch.gns;
    row.observation.satellites = counts.satellites;
    row.observation.fix = FixType::none;
    if (!has_fix(epoch)) return row;
    row.observation.fix = solution.fix;
    row.observation.age_s = counts.age_s;
    if (epoch.satellite_lists > 0 && epoch.satellite_lists_in_plane > 0) ++tally_.in_plane;
    set_solution(row, solution);
    set_ground_velocity(row.observation, epoch);
    set_errors(row.observation, epoch.errors);
    return row;
}

}  // namespace runcert::nmea

#include "stages/import/sbp/jumps.h"

#include <cmath>

#include "core/geodesy.h"

namespace runcert::sbp {
namespace {

constexpr std::int64_t second_ns = GpsTime::nanoseconds_per_second;
constexpr std::int64_t most_leap_seconds = 20;
/// How far off the rate a stamp may be besides the jump.
constexpr std::int64_t jitter_ns = 20'000'000;
/// Slower than this, a movement does not show how long it took.
constexpr double least_speed_m_s = 2.0;

double speed_m_s(const Observation& row) {
    return std::hypot(row.recorded_velocity_east_m_s.value_or(0.0),
                      row.recorded_velocity_north_m_s.value_or(0.0));
}

Ecef place(const Observation& row) {
    return ecef_from_geodetic({Angle::from_degrees(*row.latitude_deg),
                               Angle::from_degrees(*row.longitude_deg), *row.height_m});
}

bool repeats(const Observation& row, const Observation& before) {
    return row.latitude_deg == before.latitude_deg && row.longitude_deg == before.longitude_deg &&
           row.height_m == before.height_m &&
           row.recorded_velocity_east_m_s == before.recorded_velocity_east_m_s &&
           row.recorded_velocity_north_m_s == before.recorded_velocity_north_m_s;
}

/// Whether the craft moved between two rows by what its speed makes in `nominal_s`, to a quarter.
bool moved_for(double nominal_s, const Observation& before, const Observation& row) {
    if (!before.latitude_deg || !row.latitude_deg) return false;
    const double mean_m_s = 0.5 * (speed_m_s(before) + speed_m_s(row));
    if (mean_m_s < least_speed_m_s) return false;
    const double moved_m = (place(row).m - place(before).m).norm();
    return std::abs(moved_m - mean_m_s * nominal_s) < 0.25 * mean_m_s * nominal_s;
}

/// The whole seconds by which a step differs from the nominal one; 0 where that is no jump.
std::int64_t jump_seconds(std::int64_t step_ns, std::int64_t nominal_ns) {
    if (step_ns > nominal_ns + (most_leap_seconds + 1) * second_ns ||
        step_ns < nominal_ns - (most_leap_seconds + 1) * second_ns)
        return 0;
    const std::int64_t off_ns = step_ns - nominal_ns;
    const std::int64_t seconds =
        (off_ns + (off_ns < 0 ? -second_ns / 2 : second_ns / 2)) / second_ns;
    return std::abs(off_ns - seconds * second_ns) <= jitter_ns ? seconds : 0;
}

}  // namespace

UtcJumps find_utc_jumps(const Observations& observations) {
    UtcJumps jumps;
    const double nominal_s = observations.facts.nominal_interval_s;
    if (!(nominal_s > 0.0 && nominal_s < 60.0)) return jumps;
    const auto nominal_ns = std::llround(nominal_s * 1e9);
    const std::vector<Observation>& rows = observations.rows;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        // A step may be longer than 64 bits of nanoseconds; their difference decides nothing then.
        std::int64_t step_ns = 0;
        if (__builtin_sub_overflow(rows[i].time.nanoseconds, rows[i - 1].time.nanoseconds,
                                   &step_ns))
            continue;
        const std::int64_t seconds = jump_seconds(step_ns, nominal_ns);
        if (seconds == 0) continue;
        if (seconds < 0 ? repeats(rows[i], rows[i - 1])
                        : !moved_for(nominal_s, rows[i - 1], rows[i]))
            continue;
        if (jumps.first.size() < UtcJumps::listed_at_most) jumps.first.push_back({i, seconds});
        ++jumps.count;
    }
    return jumps;
}

}  // namespace runcert::sbp

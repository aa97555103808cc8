#include "stages/import/row_summary.h"

#include <algorithm>

namespace runcert {

bool has_horizontal_accuracy(const Observation& row) {
    return row.sigma_east_m && row.sigma_north_m;
}

bool has_position(const Observation& row) {
    return row.latitude_deg || row.plane_east_m;
}

bool has_velocity(const RecordedVelocity& row) {
    return row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s;
}

bool has_velocity_accuracy(const RecordedVelocity& row) {
    if (!has_velocity(row)) return row.recorded_speed_m_s && row.sigma_recorded_speed_m_s;
    return row.sigma_recorded_velocity_east_m_s && row.sigma_recorded_velocity_north_m_s;
}

void StepCount::add(std::int64_t step_ns) {
    ++count_[step_ns];
    ++steps_;
}

double StepCount::median_s() const {
    const auto step_s = [&](std::size_t rank) {
        auto entry = count_.begin();
        for (; rank >= entry->second; ++entry)
            rank -= entry->second;
        return static_cast<double>(entry->first) / GpsTime::nanoseconds_per_second;
    };
    return steps_ == 0 ? 0.0 : 0.5 * step_s((steps_ - 1) / 2) + 0.5 * step_s(steps_ / 2);
}

void RowSummary::add_time(const Observation& row) {
    const GpsTime instant = GpsTime::from_nanoseconds(row.time.nanoseconds);
    if (rows == 0) first = last = before_ = instant;
    std::int64_t since_first = 0, step = 0;
    const bool another_age =
        __builtin_sub_overflow(instant.nanoseconds(), first.nanoseconds(), &since_first) ||
        __builtin_sub_overflow(instant.nanoseconds(), before_.nanoseconds(), &step);
    if (another_age && !line_of_another_age) line_of_another_age = row.source_line.value_or(1);
    if (!another_age && step > 0) steps.add(step);
    last = std::max(last, instant);
    before_ = instant;
}

void RowSummary::add(const Observation& row) {
    add_time(row);
    ++rows;
    if (!first_latitude_deg && row.latitude_deg) first_latitude_deg = *row.latitude_deg;
    any_height = any_height || row.height_m;
    const bool horizontal = has_horizontal_accuracy(row);
    any_horizontal = any_horizontal || horizontal;
    any_vertical = any_vertical || row.sigma_up_m;
    without_horizontal += has_position(row) && !horizontal ? 1 : 0;
    if (!has_velocity(row) && !row.recorded_speed_m_s) return;
    ++with_velocity;
    speeds_alone += has_velocity(row) ? 0 : 1;
    velocity_unstated += has_velocity_accuracy(row) ? 0 : 1;
}

}  // namespace runcert

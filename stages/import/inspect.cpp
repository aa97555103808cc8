#include "stages/import/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geodesy.h"
#include "core/statistics.h"
#include "stages/import/row_collector.h"

namespace runcert {
namespace {

constexpr std::int64_t shortest_window_ns = 2'999'000'000;
constexpr std::int64_t window_ns = 3'000'000'000;

bool has_speed(const Observation& row) {
    return horizontal_speed(row).has_value();
}

Geodetic place_of(const Observation& row) {
    return {.latitude = Angle::from_degrees(*row.latitude_deg),
            .longitude = Angle::from_degrees(*row.longitude_deg),
            .height_m = row.height_m.value_or(0.0)};
}

/// The rows that `usable` holds for, in the order of time, the first of each time.
template <class Usable>
std::vector<const Observation*> by_time(const std::vector<Observation>& rows, Usable usable) {
    std::vector<const Observation*> sorted;
    for (const Observation& row : rows)
        if (usable(row)) sorted.push_back(&row);
    const auto earlier = [](const Observation* a, const Observation* b) {
        return a->time < b->time;
    };
    const auto equal = [](const Observation* a, const Observation* b) {
        return a->time == b->time;
    };
    std::stable_sort(sorted.begin(), sorted.end(), earlier);
    sorted.erase(std::unique(sorted.begin(), sorted.end(), equal), sorted.end());
    return sorted;
}

/// The fastest of all windows of about 3 s; `speed(from, to)` is that of the window between two
/// indices.
template <class Speed>
std::optional<RawBest> fastest(const std::vector<const Observation*>& rows,
                               double nominal_interval_s, Speed speed) {
    const auto longest_ns = window_ns + std::llround(nominal_interval_s * 1e9);
    std::optional<RawBest> best;
    std::size_t to = 0;
    for (std::size_t from = 0; from < rows.size(); ++from) {
        const auto span_ns = [&](std::size_t end) {
            return rows[end]->time.nanoseconds - rows[from]->time.nanoseconds;
        };
        while (to < rows.size() && span_ns(to) < shortest_window_ns)
            ++to;
        for (std::size_t end = to; end < rows.size() && span_ns(end) < longest_ns; ++end) {
            const double duration_s = static_cast<double>(span_ns(end)) * 1e-9;
            const double candidate = speed(from, end, duration_s);
            if (best && candidate <= best->speed_m_s) continue;
            best = RawBest{.speed_m_s = candidate,
                           .start = rows[from]->time,
                           .duration_s = duration_s,
                           .first_epoch = rows[from]->epoch,
                           .last_epoch = rows[end]->epoch,
                           .all_fixed = std::all_of(
                               rows.begin() + static_cast<std::ptrdiff_t>(from),
                               rows.begin() + static_cast<std::ptrdiff_t>(end) + 1,
                               [](const Observation* row) { return row->fix == FixType::fixed; })};
        }
    }
    return best;
}

std::optional<RawBest> best_by_position(const Observations& observations) {
    const auto rows = by_time(observations.rows, has_position);
    std::vector<Eigen::Vector3d> points;
    for (const Observation* row : rows)
        points.push_back(row->latitude_deg
                             ? ecef_from_geodetic(place_of(*row)).m
                             : Eigen::Vector3d(*row->plane_east_m, *row->plane_north_m, 0.0));
    return fastest(rows, observations.facts.nominal_interval_s,
                   [&](std::size_t from, std::size_t to, double duration_s) {
                       Eigen::Vector3d chord = points[to] - points[from];
                       if (rows[from]->latitude_deg) {
                           const Geodetic place = place_of(*rows[from]);
                           chord = rotation_enu_from_ecef(place.latitude, place.longitude) * chord;
                       }
                       return chord.head<2>().norm() / duration_s;
                   });
}

std::optional<RawBest> best_vertical_by_position(const Observations& observations) {
    const auto rows =
        by_time(observations.rows, [](const Observation& row) { return row.height_m.has_value(); });
    return fastest(rows, observations.facts.nominal_interval_s,
                   [&](std::size_t from, std::size_t to, double duration_s) {
                       return std::abs(*rows[to]->height_m - *rows[from]->height_m) / duration_s;
                   });
}

/// The fastest mean of what `speed` takes from the rows that `there` holds for; its absolute value
/// counts.
template <class There, class Speed>
std::optional<RawBest> best_mean(const Observations& observations, There there, Speed speed) {
    const auto rows = by_time(observations.rows, [](const Observation&) { return true; });
    // Sums up to each row of the speeds, and of the rows that have none.
    std::vector<double> sum(rows.size() + 1, 0.0);
    std::vector<std::size_t> missing(rows.size() + 1, 0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        sum[i + 1] = sum[i] + (there(*rows[i]) ? speed(*rows[i]) : 0.0);
        missing[i + 1] = missing[i] + (there(*rows[i]) ? 0 : 1);
    }
    std::optional<RawBest> best = fastest(
        rows, observations.facts.nominal_interval_s, [&](std::size_t from, std::size_t to, double) {
            if (missing[to + 1] != missing[from]) return -1.0;
            return std::abs(sum[to + 1] - sum[from]) / static_cast<double>(to + 1 - from);
        });
    if (best && best->speed_m_s < 0.0) best.reset();
    return best;
}

bool has_vertical_velocity(const Observation& row) {
    return row.recorded_velocity_up_m_s.has_value();
}

double vertical_speed(const Observation& row) {
    return *row.recorded_velocity_up_m_s;
}

/// Ways in which columns of positions are misread.
struct Misreading {
    std::string_view what;
    void (*put_right)(Observation& row);
};

constexpr double degrees_in_radian = 180.0 / std::numbers::pi;

const Misreading misreadings[] = {
    {"latitude and longitude are exchanged",
     [](Observation& row) { std::swap(row.latitude_deg, row.longitude_deg); }},
    {"they are in radians, not degrees",
     [](Observation& row) {
         *row.latitude_deg *= degrees_in_radian;
         *row.longitude_deg *= degrees_in_radian;
     }},
};

/// The first of these by which positions and velocities agree to a hundredth.
std::string misread_positions(const Observations& observations, const Inspection& inspection) {
    constexpr double agreeing = 0.01, differing = 0.03;
    if (!inspection.best_by_position || !inspection.best_by_velocity) return {};
    const double by_velocity = inspection.best_by_velocity->speed_m_s;
    if (std::abs(inspection.best_by_position->speed_m_s - by_velocity) <= differing * by_velocity)
        return {};
    for (const Misreading& each : misreadings) {
        Observations read;
        read.facts = observations.facts;
        for (const Observation& row : observations.rows) {
            if (!row.latitude_deg || !row.longitude_deg) continue;
            each.put_right(read.rows.emplace_back(row));
            if (std::abs(*read.rows.back().latitude_deg) > 90.0 ||
                std::abs(*read.rows.back().longitude_deg) > 180.0)
                read.rows.pop_back();
        }
        const auto best = best_by_position(read);
        if (best && std::abs(best->speed_m_s - by_velocity) <= agreeing * by_velocity)
            return std::string(each.what);
    }
    return {};
}

/// The bests of a recording, and when they begin.
void find_bests(const Observations& observations, Inspection& inspection) {
    inspection.best_by_position = best_by_position(observations);
    inspection.best_by_velocity = best_mean(
        observations, has_speed, [](const Observation& row) { return *horizontal_speed(row); });
    inspection.misread_positions = misread_positions(observations, inspection);
    inspection.best_vertical_by_position = best_vertical_by_position(observations);
    inspection.best_vertical_by_velocity =
        best_mean(observations, has_vertical_velocity, vertical_speed);
    if (!observations.facts.first_epoch) return;
    for (auto* best :
         {&inspection.best_by_position, &inspection.best_by_velocity,
          &inspection.best_vertical_by_position, &inspection.best_vertical_by_velocity})
        if (*best)
            (*best)->start_gps =
                observations.facts.first_epoch->plus_nanoseconds((*best)->start.nanoseconds);
}

void count_steps(const Observations& observations, Inspection& inspection) {
    const double gap_s = gap_factor * observations.facts.nominal_interval_s;
    const auto& rows = observations.rows;
    std::size_t at_one_time = 1;
    inspection.most_at_one_time = std::min<std::size_t>(rows.size(), 1);
    for (std::size_t i = 1; i < rows.size(); ++i) {
        at_one_time = rows[i].time == rows[i - 1].time ? at_one_time + 1 : 1;
        inspection.most_at_one_time = std::max(inspection.most_at_one_time, at_one_time);
        const std::int64_t step_ns = rows[i].time.nanoseconds - rows[i - 1].time.nanoseconds;
        const double step_s = static_cast<double>(step_ns) * 1e-9;
        inspection.repeated_times += step_ns == 0 ? 1 : 0;
        inspection.backward_times += step_ns < 0 ? 1 : 0;
        inspection.fix_changes += rows[i].fix != rows[i - 1].fix ? 1 : 0;
        if (step_ns <= 0 || step_s <= gap_s) continue;
        ++inspection.gaps;
        inspection.longest_gap_s = std::max(inspection.longest_gap_s, step_s);
    }
}

struct MedianAndWorst {
    std::optional<double> median, worst;
};

MedianAndWorst median_and_worst(std::vector<double> values) {
    if (values.empty()) return {};
    const double worst = *std::max_element(values.begin(), values.end());
    return {median(std::move(values)), worst};
}

void count_rows(const Observations& observations, Inspection& inspection) {
    constexpr std::size_t kinds = static_cast<std::size_t>(FixType::dead_reckoning) + 1;
    std::array<std::size_t, kinds> count{};
    std::vector<double> horizontal_m, velocity_m_s;
    std::size_t standing = 0;
    for (const Observation& row : observations.rows) {
        ++count[static_cast<std::size_t>(row.fix)];
        inspection.without_position += has_position(row) ? 0 : 1;
        inspection.with_velocity += has_speed(row) ? 1 : 0;
        inspection.speeds_alone += row.recorded_speed_m_s ? 1 : 0;
        standing += has_velocity(row) && *horizontal_speed(row) == 0.0 ? 1U : 0U;
        inspection.velocities_stated += has_velocity_accuracy(row) ? 1 : 0;
        inspection.with_vertical_accuracy += row.sigma_up_m ? 1 : 0;
        if (row.sigma_east_m && row.sigma_north_m)
            horizontal_m.push_back(std::hypot(*row.sigma_east_m, *row.sigma_north_m));
        if (row.sigma_recorded_velocity_east_m_s && row.sigma_recorded_velocity_north_m_s)
            velocity_m_s.push_back(std::hypot(*row.sigma_recorded_velocity_east_m_s,
                                              *row.sigma_recorded_velocity_north_m_s));
        else if (row.sigma_recorded_speed_m_s)
            velocity_m_s.push_back(*row.sigma_recorded_speed_m_s);
    }
    // A speed of zero has every course: where no other has one, none was recorded.
    if (inspection.speeds_alone > 0 &&
        inspection.speeds_alone + standing == inspection.with_velocity)
        inspection.speeds_alone = inspection.with_velocity;
    for (std::size_t kind = 0; kind < kinds; ++kind)
        if (count[kind] > 0) inspection.fixes.emplace_back(static_cast<FixType>(kind), count[kind]);
    std::stable_sort(inspection.fixes.begin(), inspection.fixes.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    inspection.with_accuracy = horizontal_m.size();
    const MedianAndWorst horizontal = median_and_worst(std::move(horizontal_m));
    inspection.median_horizontal_m = horizontal.median;
    inspection.worst_horizontal_m = horizontal.worst;
    const MedianAndWorst velocity = median_and_worst(std::move(velocity_m_s));
    inspection.median_velocity_m_s = velocity.median;
    inspection.worst_velocity_m_s = velocity.worst;
}

/// The nautical zone: 15 degrees of longitude an hour.
std::optional<int> zone_of(const std::vector<Observation>& rows) {
    for (const Observation& row : rows)
        if (row.longitude_deg) return static_cast<int>(std::lround(*row.longitude_deg / 15.0));
    return std::nullopt;
}

void measure_span(const Observations& observations, Inspection& inspection) {
    const auto& rows = observations.rows;
    if (rows.empty()) return;
    const auto [earliest, latest] = std::minmax_element(
        rows.begin(), rows.end(),
        [](const Observation& a, const Observation& b) { return a.time < b.time; });
    inspection.span_s = latest->time.seconds() - earliest->time.seconds();
    if (!observations.facts.first_epoch) return;
    inspection.first = observations.facts.first_epoch->plus_nanoseconds(earliest->time.nanoseconds);
    inspection.last = observations.facts.first_epoch->plus_nanoseconds(latest->time.nanoseconds);
}

}  // namespace

bool Inspection::is_vertical() const {
    return best_vertical_by_velocity && best_by_velocity &&
           best_vertical_by_velocity->speed_m_s > best_by_velocity->speed_m_s;
}

Inspection inspect(const Observations& observations) {
    Inspection inspection;
    inspection.epochs = observations.rows.size();
    inspection.nominal_interval_s = observations.facts.nominal_interval_s;
    inspection.zone_h = zone_of(observations.rows);
    measure_span(observations, inspection);
    count_rows(observations, inspection);
    count_steps(observations, inspection);
    inspection.bursts = bursts_in(observations.rows);
    inspection.velocity_delay_s = raw_velocity_delay_s(observations);
    inspection.velocity_delays = raw_velocity_delays(observations);
    inspection.velocity_origin = raw_velocity_origin(observations);
    find_bests(observations, inspection);
    return inspection;
}

}  // namespace runcert

#include "witness/copies.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "witness/same_origin.h"

namespace runcert {
namespace {

/// Whether a sample lies within `near_s` of a time. Where samples are sparser than rows, only the
/// rows next to a sample depend on the samples through one and the same filter.
bool is_near_a_sample(std::span<const TimedValue> samples, double time_s, double near_s) {
    const auto after = std::ranges::lower_bound(samples, time_s - near_s, {}, &TimedValue::time_s);
    return after != samples.end() && after->time_s <= time_s + near_s;
}

std::vector<velocities::SpeedBesidePosition> rows_of(std::span<const TimedPosition<2>> positions) {
    std::vector<velocities::SpeedBesidePosition> rows;
    for (const TimedPosition<2>& one : positions)
        rows.push_back({.time_s = one.time_s, .position_m = one.position});
    return rows;
}

}  // namespace

bool are_from_positions(std::span<const TimedValue> speeds,
                        std::span<const TimedPosition<2>> positions, double delay_s, double scale) {
    std::vector<velocities::SpeedBesidePosition> rows = rows_of(positions);
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
        const double time_s = rows[k].time_s + delay_s;
        if (!is_near_a_sample(speeds, time_s, 0.501 * (rows[k + 1].time_s - rows[k].time_s)))
            continue;
        if (const auto speed = value_at(speeds, time_s, longest_between_speeds_s))
            rows[k].speed_m_s = scale * *speed;
    }
    return are_filtered_positions(rows) ||
           velocities::origin_of_speeds(rows, 0.0).origin == velocities::Origin::positions;
}

bool are_between_positions(std::span<const Way> ways, std::span<const TimedPosition<2>> positions) {
    const double noise_m = velocities::white_noise_m(rows_of(positions));
    if (!(noise_m > 0.0)) return false;
    const auto position_at = [&](double time_s) -> std::optional<Eigen::Vector2d> {
        const auto after =
            std::ranges::lower_bound(positions, time_s, {}, &TimedPosition<2>::time_s);
        if (after == positions.end()) return std::nullopt;
        if (after->time_s == time_s) return after->position;
        if (after == positions.begin()) return std::nullopt;
        const TimedPosition<2>& before = *(after - 1);
        const double part = (time_s - before.time_s) / (after->time_s - before.time_s);
        return before.position + part * (after->position - before.position);
    };
    std::vector<double> differences;
    for (const Way& way : ways) {
        const auto from = position_at(way.span.first_s), to = position_at(way.span.last_s);
        if (from && to)
            differences.push_back((way.length_m - (*to - *from).norm()) /
                                  (std::numbers::sqrt2 * noise_m));
    }
    return agree_too_well(differences);
}

std::optional<WitnessSource> source_by_velocities(const ScreenedTable& screened,
                                                  const Directions& directions) {
    const auto& all = screened.basis.velocity_errors;
    const auto errors = std::ranges::find(all, TestedAxes::horizontal, &VelocityErrors::axes);
    if (errors == all.end()) return std::nullopt;
    WitnessSource source{.name = "the recorded velocities", .delay_s = model_of(*errors).delay_s};
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    double before_s = 0.0;
    for (const TimedVelocity<2>& one :
         timed_velocities<2>(screened.rows, directions, screened.facts.nominal_interval_s,
                             velocities_left_out(screened.rows, screened.basis.velocity, false))) {
        if (!source.positions.empty()) position += (one.time_s - before_s) * one.velocity;
        source.positions.push_back({.time_s = one.time_s, .position = position});
        source.speeds_m_s.push_back({.time_s = one.time_s, .value = one.velocity.norm()});
        before_s = one.time_s;
    }
    return source;
}

std::optional<WitnessSource> source_by_receiver(const ScreenedTable& screened,
                                                const ScreenedTable& other) {
    const auto &own = screened.facts.first_epoch, &its = other.facts.first_epoch;
    if (own.has_value() != its.has_value()) return std::nullopt;
    return WitnessSource{.name = fmt::format("receiver \"{}\"", other.facts.receiver),
                         .positions = timed_positions<2>(other.rows),
                         .delay_s = own ? own->seconds_since(*its) : 0.0};
}

std::optional<std::string> source_of_speeds(std::span<const TimedValue> speeds_m_s,
                                            std::span<const WitnessSource> sources, double delay_s,
                                            double scale) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        return are_from_positions(speeds_m_s, one.positions, delay_s - one.delay_s, scale);
    });
    if (source == sources.end()) return std::nullopt;
    return source->name;
}

std::optional<std::string> source_of_ways(std::span<const Way> ways,
                                          std::span<const WitnessSource> sources) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        std::vector<Way> of_source(ways.begin(), ways.end());
        for (Way& way : of_source) {
            way.span.first_s += one.delay_s;
            way.span.last_s += one.delay_s;
        }
        return are_between_positions(of_source, one.positions);
    });
    if (source == sources.end()) return std::nullopt;
    return source->name;
}

std::string copy_text(std::string_view what, std::string_view source) {
    return fmt::format(
        "The {} have the errors of {}: one was made from the other. They are no further "
        "measurement, and were not heard.",
        what, source);
}

}  // namespace runcert

#include "stages/window/copies.h"

#include <fmt/format.h>

#include <algorithm>

namespace runcert {

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
                             velocities_of_other_moments(screened.rows, screened.basis.velocity))) {
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

std::optional<std::string> source_of_speeds(const std::vector<TimedValue>& speeds_m_s,
                                            const std::vector<WitnessSource>& sources,
                                            double delay_s, double scale) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        return are_from_positions(speeds_m_s, one.positions, delay_s - one.delay_s, scale);
    });
    if (source == sources.end()) return std::nullopt;
    return source->name;
}

std::optional<std::string> source_of_gates(const std::vector<TimedValue>& passages_m,
                                           const std::vector<WitnessSource>& sources) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        std::vector<TimedValue> passages = passages_m;
        for (TimedValue& passage : passages)
            passage.time_s += one.delay_s;
        return are_between_positions(passages, one.positions);
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

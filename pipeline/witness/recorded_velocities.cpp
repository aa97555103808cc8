#include "witness/recorded_velocities.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

constexpr double longest_step = 2.5;

}  // namespace

std::optional<Eigen::Vector2d> direction_of(const Eigen::Vector2d& velocity,
                                            const Eigen::Matrix2d& covariance) {
    constexpr double slowest_m_s = 1.0;
    constexpr double in_sigmas = 3.0;
    const double speed = velocity.norm();
    if (!(speed > std::max(slowest_m_s, in_sigmas * std::sqrt(covariance.trace()))))
        return std::nullopt;
    return velocity / speed;
}

template <int Axes>
std::optional<PositionVector<Axes>> recorded_velocity(
    const ScreenedEpoch& row, const std::optional<Eigen::Vector2d>& direction) {
    if constexpr (Axes == 1) {
        if (!row.recorded_velocity_up_m_s) return std::nullopt;
        return PositionVector<1>(*row.recorded_velocity_up_m_s);
    } else {
        if (row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s)
            return PositionVector<2>(*row.recorded_velocity_east_m_s,
                                     *row.recorded_velocity_north_m_s);
        if (!row.recorded_speed_m_s || !direction) return std::nullopt;
        return PositionVector<2>(*row.recorded_speed_m_s * *direction);
    }
}

std::optional<RecordedSpeed> recorded_speed(const RecordedVelocity& velocity, bool level,
                                            bool upright) {
    const bool components =
        velocity.recorded_velocity_east_m_s && velocity.recorded_velocity_north_m_s;
    if (level && !components && !velocity.recorded_speed_m_s) return std::nullopt;
    if (upright && !velocity.recorded_velocity_up_m_s) return std::nullopt;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    Eigen::Vector3d variance = Eigen::Vector3d::Zero();
    bool stated = true;
    const auto take = [&](int axis, const OptionalReal& value, const OptionalReal& sigma) {
        v(axis) = *value;
        stated = stated && sigma.has_value();
        if (sigma) variance(axis) = *sigma * *sigma;
    };
    if (level && !components) {
        // Only the magnitude of the velocity counts here.
        take(0, velocity.recorded_speed_m_s, velocity.sigma_recorded_speed_m_s);
    } else if (level) {
        take(0, velocity.recorded_velocity_east_m_s, velocity.sigma_recorded_velocity_east_m_s);
        take(1, velocity.recorded_velocity_north_m_s, velocity.sigma_recorded_velocity_north_m_s);
    }
    if (upright)
        take(2, velocity.recorded_velocity_up_m_s, velocity.sigma_recorded_velocity_up_m_s);
    RecordedSpeed speed{.speed_m_s = v.norm(), .standard_uncertainty_m_s = std::nullopt};
    if (stated)
        speed.standard_uncertainty_m_s =
            std::sqrt(speed.speed_m_s > 0.0 ? v.cwiseAbs2().dot(variance) / v.squaredNorm()
                                            : variance.maxCoeff());
    return speed;
}

bool recorded_velocities_change(const std::vector<ScreenedEpoch>& rows) {
    const auto change = [&](const auto& value_of) {
        OptionalReal first;
        for (const ScreenedEpoch& row : rows) {
            const OptionalReal value = value_of(row);
            if (!value) continue;
            if (first && *first != *value) return true;
            first = value;
        }
        return false;
    };
    return change([](const ScreenedEpoch& row) { return row.recorded_velocity_east_m_s; }) ||
           change([](const ScreenedEpoch& row) { return row.recorded_velocity_north_m_s; }) ||
           change([](const ScreenedEpoch& row) { return row.recorded_velocity_up_m_s; }) ||
           change([](const ScreenedEpoch& row) { return row.recorded_speed_m_s; });
}

std::vector<bool> velocities_of_other_moments(const std::vector<ScreenedEpoch>& rows,
                                              const std::optional<VelocityComparison>& velocity) {
    std::vector<bool> others(rows.size(), false);
    if (!velocity) return others;
    for (const VelocityDelay& one : velocity->delays)
        for (std::size_t i = 0; one.beyond && i < rows.size(); ++i)
            if (rows[i].epoch >= one.first_epoch && rows[i].epoch <= one.last_epoch)
                others[i] = true;
    return others;
}

std::vector<bool> velocities_left_out(const std::vector<ScreenedEpoch>& rows,
                                      const std::optional<VelocityComparison>& velocity,
                                      bool upright) {
    std::vector<bool> left_out = velocities_of_other_moments(rows, velocity);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const SpeedTest& test = rows[i].speed_test;
        if (test.refused && (upright || test.axes == TestedAxes::horizontal)) left_out[i] = true;
    }
    return left_out;
}

namespace {

template <int Axes>
bool has_velocity(const ScreenedEpoch& row) {
    if constexpr (Axes == 1) return row.recorded_velocity_up_m_s.has_value();
    return row.recorded_velocity_east_m_s || row.recorded_speed_m_s;
}

/// The stated standard deviation (m/s, each axis) of a row's velocity. Zero means that the field
/// was not filled.
template <int Axes>
std::optional<double> stated_sigma(const ScreenedEpoch& row) {
    OptionalReal sigma;
    if constexpr (Axes == 1) {
        sigma = row.sigma_recorded_velocity_up_m_s;
    } else if (!row.recorded_velocity_east_m_s) {
        sigma = row.sigma_recorded_speed_m_s;
    } else if (row.sigma_recorded_velocity_east_m_s && row.sigma_recorded_velocity_north_m_s) {
        sigma = std::hypot(*row.sigma_recorded_velocity_east_m_s,
                           *row.sigma_recorded_velocity_north_m_s) /
                std::sqrt(2.0);
    }
    return sigma && *sigma > 0.0 ? sigma : OptionalReal{};
}

}  // namespace

template <int Axes>
std::vector<TimedVelocity<Axes>> timed_velocities(const std::vector<ScreenedEpoch>& rows,
                                                  const Directions& directions,
                                                  double nominal_interval_s,
                                                  const std::vector<bool>& left_out) {
    const double longest_s = longest_step * std::max(1.0, nominal_interval_s);
    const auto middle = stated_velocity_sigma<Axes>(rows);
    std::vector<TimedVelocity<Axes>> velocities;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto velocity = recorded_velocity<Axes>(rows[i], directions[i]);
        if (!velocity || left_out[i] || is_out_of_time(rows[i])) continue;
        const double time_s = rows[i].time.seconds();
        const double step_s = velocities.empty() ? 0.0 : time_s - velocities.back().time_s;
        const std::int64_t stretch =
            velocities.empty() ? 0 : velocities.back().stretch + (step_s > longest_s ? 1 : 0);
        const auto stated = stated_sigma<Axes>(rows[i]);
        velocities.push_back({.time_s = time_s,
                              .velocity = *velocity,
                              .stretch = stretch,
                              .worse = middle && stated ? std::max(1.0, *stated / *middle) : 1.0});
    }
    return velocities;
}

template <int Axes>
std::vector<TimedPosition<Axes>> timed_positions(const std::vector<ScreenedEpoch>& rows) {
    std::vector<TimedPosition<Axes>> positions;
    for (const ScreenedEpoch& row : rows) {
        if (!row.usable || !row.arc) continue;
        positions.push_back({.time_s = row.time.seconds(),
                             .position = measured_position<Axes>(row),
                             .sigma_m = std::sqrt(stated_covariance<Axes>(row).trace() / Axes),
                             .stretch = *row.arc});
    }
    return positions;
}

template <int Axes>
std::optional<double> stated_velocity_sigma(const std::vector<ScreenedEpoch>& rows) {
    std::vector<double> stated;
    std::size_t recorded = 0;
    for (const ScreenedEpoch& row : rows) {
        if (!has_velocity<Axes>(row)) continue;
        ++recorded;
        if (const auto sigma = stated_sigma<Axes>(row)) stated.push_back(*sigma);
    }
    if (stated.empty() || 2 * stated.size() < recorded) return std::nullopt;
    return median(std::move(stated));
}

VelocityErrorModel model_of(const VelocityErrors& errors) {
    VelocityErrorModel model;
    model.delay_s = errors.delay_s;
    model.sigma_delay_s = errors.sigma_delay_s;
    if (errors.density) model.density = *errors.density;
    if (errors.stated_m_s) model.stated_m_s = *errors.stated_m_s;
    model.shown_m_s = errors.shown_m_s;
    model.correlation_time_s = errors.correlation_time_s;
    return model;
}

template <int Axes>
std::optional<VelocityWitness<Axes>> velocity_witness(const ScreenedTable& table,
                                                      const Directions& directions) {
    const auto& all = table.basis.velocity_errors;
    const auto errors = std::ranges::find(all, tested_axes<Axes>, &VelocityErrors::axes);
    if (errors == all.end()) return std::nullopt;
    const VelocityErrorModel model = model_of(*errors);
    if (!model.is_known()) return std::nullopt;
    auto samples =
        timed_velocities<Axes>(table.rows, directions, table.facts.nominal_interval_s,
                               velocities_left_out(table.rows, table.basis.velocity, Axes == 1));
    if (samples.empty()) return std::nullopt;
    const auto motion =
        std::ranges::find(table.basis.models, tested_axes<Axes>, &ScreeningModel::axes);
    return VelocityWitness<Axes>(std::move(samples), model,
                                 motion == table.basis.models.end() ? 0.0 : motion->jerk_density);
}

#define RUNCERT_INSTANTIATE(AXES)                                                                  \
    template std::optional<PositionVector<AXES>> recorded_velocity<AXES>(                          \
        const ScreenedEpoch&, const std::optional<Eigen::Vector2d>&);                              \
    template std::vector<TimedVelocity<AXES>> timed_velocities<AXES>(                              \
        const std::vector<ScreenedEpoch>&, const Directions&, double, const std::vector<bool>&);   \
    template std::vector<TimedPosition<AXES>> timed_positions<AXES>(                               \
        const std::vector<ScreenedEpoch>&);                                                        \
    template std::optional<double> stated_velocity_sigma<AXES>(const std::vector<ScreenedEpoch>&); \
    template std::optional<VelocityWitness<AXES>> velocity_witness<AXES>(const ScreenedTable&,     \
                                                                         const Directions&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert

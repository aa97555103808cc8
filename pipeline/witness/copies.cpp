#include "witness/copies.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/statistics.h"

namespace runcert {
namespace {

using Eigen::Vector2d;
using Positions = std::span<const TimedPosition<2>>;

constexpr std::size_t least_rows = 30;
/// Steps longer than this many medians are gaps.
constexpr double gap_factor = 1.5;

double median_step_s(Positions rows) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (rows[i].time_s > rows[i - 1].time_s)
            steps.push_back(rows[i].time_s - rows[i - 1].time_s);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

double robust_scatter(std::vector<double> values) {
    for (double& value : values)
        value = std::abs(value);
    return median(std::move(values)) / normal_quantile(0.75);
}

double rounding_deviation(double step) {
    return step / std::sqrt(12.0);
}

/// Norm of the differences of this order of a sequence that is zero outside.
double norm_of_differences(std::vector<double> weights, int order) {
    for (int k = 0; k < order; ++k) {
        weights.push_back(0.0);
        for (std::size_t i = weights.size(); i-- > 1;)
            weights[i] -= weights[i - 1];
    }
    double squares = 0.0;
    for (const double weight : weights)
        squares += weight * weight;
    return std::sqrt(squares);
}

/// Velocity from each row to the next. Empty across a gap.
std::vector<std::optional<Vector2d>> steps_of(Positions rows, double step_s) {
    std::vector<std::optional<Vector2d>> steps(rows.size());
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const double since_s = rows[i + 1].time_s - rows[i].time_s;
        if (since_s > 0.0 && since_s < gap_factor * step_s)
            steps[i] = (rows[i + 1].position - rows[i].position) / since_s;
    }
    return steps;
}

/// The white noise of positions (m, each coordinate), from their differences of third order to
/// `last_order`. The smallest counts, so that motion is not taken for noise. White noise gives a
/// difference of order k binomial(2 k, k) times its variance. 0 if there are too few.
double white_noise_m(Positions rows, int last_order = 6) {
    constexpr int first_order = 3;
    const double step_s = median_step_s(rows);
    double noise_m = std::numeric_limits<double>::infinity();
    auto current = steps_of(rows, step_s);
    double gain = 2.0;  // binomial(2 k, k) of differences of order k
    for (int order = 2; order <= last_order; ++order) {
        gain *= 2.0 * (2.0 * order - 1.0) / order;
        for (std::size_t i = 0; i + 1 < current.size(); ++i) {
            if (current[i] && current[i + 1])
                current[i] = *current[i + 1] - *current[i];
            else
                current[i].reset();
        }
        if (order < first_order) continue;
        std::vector<double> values;
        for (const auto& each : current)
            if (each) values.push_back(step_s * each->norm());
        if (values.size() < least_rows) break;
        noise_m = std::min(
            noise_m, median(std::move(values)) / std::sqrt(chi_squared_quantile(0.5, 2) * gain));
    }
    return std::isfinite(noise_m) ? noise_m : 0.0;
}

/// Speeds at rows, each with the displacements about it (m/s).
struct Regression {
    std::size_t either_side = 0;
    std::vector<std::size_t> rows = {};
    std::vector<double> speeds = {};
    std::vector<Eigen::Matrix2Xd> steps = {};
};

Regression regression_of(Positions positions, const std::vector<std::optional<double>>& speeds,
                         std::size_t either_side, double least_m_s) {
    constexpr std::size_t most = 4000;  // more add time and no power
    const auto steps = steps_of(positions, median_step_s(positions));
    const auto width = static_cast<Eigen::Index>(2 * either_side);
    Regression found{.either_side = either_side};
    std::size_t whole_from = 0;  // rows since here have no gap between them
    for (std::size_t last = 1; last < positions.size() && found.rows.size() < most; ++last) {
        if (!steps[last - 1]) whole_from = last;
        if (last < whole_from + 2 * either_side) continue;
        const std::size_t k = last - either_side;
        if (!speeds[k] || *speeds[k] < least_m_s || !(*speeds[k] > 0.0)) continue;
        Eigen::Matrix2Xd& about = found.steps.emplace_back(2, width);
        for (Eigen::Index j = 0; j < width; ++j)
            about.col(j) = *steps[last - 2 * either_side + static_cast<std::size_t>(j)];
        found.rows.push_back(k);
        found.speeds.push_back(*speeds[k]);
    }
    return found;
}

/// What the regression leaves, and the weights of the displacements.
struct Fit {
    std::size_t compared = 0;
    double residual_m_s = 0.0;  ///< robust scatter
    Eigen::VectorXd weights = {};
};

/// Least squares of |sum of weighted displacements|, linearised about the direction of that sum,
/// after differences of an order. Distant outliers are dropped.
Fit fitted(const Regression& all, int order) {
    constexpr int rounds = 3;        // directions and outliers stand by then
    constexpr double far_off = 5.0;  // standard deviations: one normal error in two million
    constexpr std::array<double, 4> none{1.0, 0.0, 0.0, 0.0}, third{1.0, -3.0, 3.0, -1.0};
    const auto& signs = order == 0 ? none : third;
    const auto width = static_cast<Eigen::Index>(2 * all.either_side);
    const auto reach = static_cast<std::size_t>(order);
    std::vector<std::size_t> first;
    for (std::size_t i = 0; i + reach < all.rows.size(); ++i)
        if (all.rows[i + reach] == all.rows[i] + reach) first.push_back(i);
    Fit fit{.compared = first.size(), .weights = Eigen::VectorXd::Zero(width)};
    if (fit.compared < std::max<std::size_t>(least_rows, 3 * 2 * all.either_side)) return fit;
    const auto near = static_cast<Eigen::Index>(std::min<std::size_t>(all.either_side, 2));
    fit.weights.segment(width / 2 - near, 2 * near).setConstant(0.5 / static_cast<double>(near));
    Eigen::MatrixXd along(std::ssize(all.rows), width);
    Eigen::MatrixXd displacements(std::ssize(first), width);
    Eigen::VectorXd speeds(std::ssize(first)), counts = Eigen::VectorXd::Ones(std::ssize(first));
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < all.rows.size(); ++i)
            along.row(static_cast<Eigen::Index>(i)) =
                (all.steps[i] * fit.weights).normalized().transpose() * all.steps[i];
        displacements.setZero();
        speeds.setZero();
        for (std::size_t i = 0; i < first.size(); ++i)
            for (std::size_t d = 0; d <= reach; ++d) {
                const auto row = static_cast<Eigen::Index>(i);
                displacements.row(row) +=
                    signs[d] * along.row(static_cast<Eigen::Index>(first[i] + d));
                speeds[row] += signs[d] * all.speeds[first[i] + d];
            }
        fit.weights = (counts.asDiagonal() * displacements)
                          .householderQr()
                          .solve(counts.cwiseProduct(speeds));
        // Displacements of an exactly steady motion determine no filter.
        if (!fit.weights.allFinite())
            return {.compared = fit.compared, .weights = Eigen::VectorXd::Zero(width)};
        const Eigen::VectorXd residuals = speeds - displacements * fit.weights;
        fit.residual_m_s = robust_scatter({residuals.begin(), residuals.end()});
        counts = (residuals.array().abs() <= far_off * fit.residual_m_s).cast<double>().matrix();
    }
    return fit;
}

/// The speeds at the times of the positions. Where samples are sparser than rows, only the rows
/// next to a sample depend on the samples through one and the same filter.
std::vector<std::optional<double>> at_rows(std::span<const TimedValue> speeds, Positions positions,
                                           double delay_s) {
    std::vector<std::optional<double>> found(positions.size());
    for (std::size_t k = 0; k + 1 < positions.size(); ++k) {
        const double time_s = positions[k].time_s + delay_s;
        const double near_s = 0.501 * (positions[k + 1].time_s - positions[k].time_s);
        const auto after =
            std::ranges::lower_bound(speeds, time_s - near_s, {}, &TimedValue::time_s);
        if (after != speeds.end() && after->time_s <= time_s + near_s)
            found[k] = value_at(speeds, time_s, longest_between_speeds_s);
    }
    return found;
}

/// Weights of the positions that these weights of the displacements amount to.
std::vector<double> weights_of_positions(const Eigen::VectorXd& weights, double step_s) {
    std::vector<double> found(static_cast<std::size_t>(weights.size()) + 1, 0.0);
    for (Eigen::Index j = 0; j < weights.size(); ++j) {
        found[static_cast<std::size_t>(j)] -= weights[j] / step_s;
        found[static_cast<std::size_t>(j) + 1] += weights[j] / step_s;
    }
    return found;
}

}  // namespace

double resolution_m_s(std::span<const TimedValue> all, double finest_m_s) {
    constexpr double written_to_m_s = 2e-6;
    std::vector<double> speeds;
    for (const TimedValue& one : all)
        speeds.push_back(one.value);
    std::ranges::sort(speeds);
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < speeds.size(); ++i)
        if (const double gap = speeds[i] - speeds[i - 1]; gap > 2.0 * written_to_m_s)
            step = std::min(step, gap);
    // Of steps near the precision of writing every number is a multiple.
    if (!std::isfinite(step) || step < std::max(finest_m_s, 10.0 * written_to_m_s))
        return finest_m_s;
    // The smallest gap contains two rounding errors; a mean over many steps does not.
    const double steps = std::round(speeds.back() / step);
    if (steps > 0.0) step = speeds.back() / steps;
    const bool all_are = std::ranges::all_of(speeds, [&](double speed) {
        return std::abs(speed - step * std::round(speed / step)) < 2.0 * written_to_m_s;
    });
    return all_are ? std::max(step, finest_m_s) : finest_m_s;
}

VelocityOrigin made_from(std::span<const TimedValue> speeds, Positions positions, double delay_s,
                         double resolution_m) {
    // An independent speed leaves all of it: a factor of five for motion that is taken for noise.
    constexpr double share = 0.2;
    constexpr double share_of_rounding = 2.0;
    const double step_s = median_step_s(positions);
    if (!(step_s > 0.0)) return VelocityOrigin::unclear;
    const double speed_rounding_m_s = rounding_deviation(resolution_m_s(speeds));
    const auto of_rows = at_rows(speeds, positions, delay_s);
    std::vector<double> known;
    for (const auto& speed : of_rows)
        if (speed) known.push_back(*speed);
    const double least_m_s = half_of_fastest_tenth(std::move(known));
    bool compared = false, unclear = false;
    for (const std::size_t either_side : {1U, 2U, 5U, 10U, 32U}) {
        // More weights follow rougher motion, and only what they do not follow is noise to them.
        const bool few = either_side <= 2;
        const double noise_m = white_noise_m(positions, few ? 6 : 10);
        const Regression regression = regression_of(positions, of_rows, either_side, least_m_s);
        for (const int order : {0, 3}) {
            if (few && order > 0) continue;  // rough motion would stay
            const Fit fit = fitted(regression, order);
            if (fit.residual_m_s == 0.0 && fit.weights.isZero()) continue;
            const double gain =
                norm_of_differences(weights_of_positions(fit.weights, step_s), order);
            const double noise_m_s = gain * noise_m;
            const double rounding_m_s =
                share_of_rounding *
                std::hypot(speed_rounding_m_s * norm_of_differences({1.0}, order),
                           gain * rounding_deviation(resolution_m));
            const bool fits = fit.residual_m_s <= std::hypot(share * noise_m_s, rounding_m_s);
            if (fit.residual_m_s < share * noise_m_s || (fits && noise_m_s >= 2.0 * rounding_m_s))
                return VelocityOrigin::positions;
            compared = true;
            unclear = unclear || (fits && order == 0);
        }
    }
    return compared && !unclear ? VelocityOrigin::independent : VelocityOrigin::unclear;
}

bool made_from(Positions second, Positions first, double offset_s) {
    const auto from = [](Positions a, double shift_s, Positions b) {
        std::vector<TimedValue> speeds;
        const double longest_s = gap_factor * median_step_s(a);
        for (std::size_t i = 1; i < a.size(); ++i)
            if (const double since_s = a[i].time_s - a[i - 1].time_s;
                since_s > 0.0 && since_s <= longest_s)
                speeds.push_back({.time_s = 0.5 * (a[i].time_s + a[i - 1].time_s) + shift_s,
                                  .value = (a[i].position - a[i - 1].position).norm() / since_s});
        return made_from(speeds, b) == VelocityOrigin::positions;
    };
    return from(second, offset_s, first) || from(first, -offset_s, second);
}

bool made_from(const Witness<2>& integrated, double rounding_m_s, double interval_s,
               Positions positions) {
    constexpr double least_density = 0.003;  // m s^-1/2
    constexpr double of_code_m = 0.1, of_code_s = 100.0;
    // In simulation copies grow by 10 % at most, an exact wheel by a quarter over 10 s and a half
    // over 30 s (positions with 4 mm of white noise and 5 mm that last 10 s). Rounding of a steady
    // speed lasts, and adds up faster than a random walk.
    constexpr double growth = 1.15;
    constexpr double share_of_rounding = 4.0;
    std::vector<double> stated_m;
    for (const TimedPosition<2>& one : positions)
        stated_m.push_back(one.sigma_m);
    const bool of_code = !stated_m.empty() && median(std::move(stated_m)) >= of_code_m;
    bool keeps = false;
    double longest_s = 0.0, last_m = 0.0;
    for (const double span_s : {10.0, 30.0, 100.0, 300.0}) {
        const auto spread = displacement_spread(integrated, positions, span_s);
        if (!spread) break;
        keeps = keeps || spread->sd_m < least_density * std::sqrt(span_s) ||
                (of_code && span_s >= of_code_s && spread->sd_m < of_code_m);
        longest_s = span_s;
        last_m = spread->along_m;
    }
    if (!keeps) return false;
    const auto soon =
        displacement_spread(integrated, positions, std::max(1.0, 3.0 * median_step_s(positions)));
    return !soon ||
           last_m <= std::hypot(growth * soon->along_m, share_of_rounding * rounding_m_s *
                                                            std::sqrt(interval_s * longest_s));
}

bool made_from(std::span<const Way> ways, Positions positions) {
    constexpr double by_chance = 0.01;
    const double noise_m = white_noise_m(positions);
    const auto position_at = [&](double time_s) -> std::optional<Vector2d> {
        const auto after =
            std::ranges::lower_bound(positions, time_s, {}, &TimedPosition<2>::time_s);
        if (after == positions.end()) return std::nullopt;
        if (after->time_s == time_s) return after->position;
        if (after == positions.begin()) return std::nullopt;
        const TimedPosition<2>& before = *(after - 1);
        const double part = (time_s - before.time_s) / (after->time_s - before.time_s);
        return before.position + part * (after->position - before.position);
    };
    double sum = 0.0;
    int compared = 0;
    for (const Way& way : ways) {
        const double sigma_m = way.sigma_m > 0.0 ? way.sigma_m : std::numbers::sqrt2 * noise_m;
        const auto from = position_at(way.span.first_s), to = position_at(way.span.last_s);
        if (!from || !to || !(sigma_m > 0.0)) continue;
        sum += std::pow((way.length_m - (*to - *from).norm()) / sigma_m, 2);
        ++compared;
    }
    return compared > 0 && sum < chi_squared_upper_quantile(1.0 - by_chance, compared);
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

std::optional<std::string> source_of(std::span<const TimedValue> speeds_m_s,
                                     std::span<const WitnessSource> sources, double delay_s) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        return made_from(speeds_m_s, one.positions, delay_s - one.delay_s) ==
               VelocityOrigin::positions;
    });
    if (source == sources.end()) return std::nullopt;
    return source->name;
}

std::optional<std::string> source_of(std::span<const Way> ways,
                                     std::span<const WitnessSource> sources) {
    const auto source = std::ranges::find_if(sources, [&](const WitnessSource& one) {
        std::vector<Way> of_source(ways.begin(), ways.end());
        for (Way& way : of_source) {
            way.span.first_s += one.delay_s;
            way.span.last_s += one.delay_s;
        }
        return made_from(of_source, one.positions);
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

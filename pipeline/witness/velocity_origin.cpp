#include "witness/velocity_origin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/statistics.h"

namespace runcert::velocities {
namespace {

constexpr std::size_t least_compared = 30;
constexpr int longest_mean = 5;
/// Steps longer than this many medians are gaps.
constexpr double gap_factor = 1.5;
/// Fraction of a difference's noise. Speeds that lie closer were made from the same errors.
constexpr double share_of_noise = 0.2;
/// Multiple of the standard deviation of rounding. Within it a speed may be the rounded difference;
/// below twice this, the noise of a difference does not stand out.
constexpr double share_of_rounding = 2.0;
/// Finest resolution with which devices write speeds. A rotation of the axes hides the resolution.
constexpr double finest_speed_m_s = 0.01;
constexpr double normal_from_median = 1.4826;

using Vectors = std::vector<std::optional<Eigen::Vector2d>>;
using Rows = std::span<const SpeedBesidePosition>;

double rounding_deviation(double step) {
    return step / std::sqrt(12.0);
}

/// Robust scatter about zero.
double robust_scatter(std::vector<double> residuals) {
    for (double& residual : residuals)
        residual = std::abs(residual);
    return normal_from_median * median(std::move(residuals));
}

double median_step_of(Rows rows) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (rows[i].time_s > rows[i - 1].time_s)
            steps.push_back(rows[i].time_s - rows[i - 1].time_s);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// Velocity from each row's predecessor to the row. Empty across a gap.
Vectors backward_differences(Rows rows, double step_s) {
    Vectors differences(rows.size());
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double since_s = rows[i].time_s - rows[i - 1].time_s;
        if (since_s > 0.0 && since_s < gap_factor * step_s)
            differences[i] = (rows[i].position_m - rows[i - 1].position_m) / since_s;
    }
    return differences;
}

Vectors differences_of(const Vectors& backward, Difference kind) {
    if (kind == Difference::backward) return backward;
    Vectors result(backward.size());
    for (std::size_t i = 0; i + 1 < backward.size(); ++i) {
        const auto &here = backward[i], &next = backward[i + 1];
        if (kind == Difference::forward)
            result[i] = next;
        else if (here && next)
            result[i] = 0.5 * (*here + *next);
    }
    return result;
}

/// The white noise of the positions (m, each coordinate): the smallest estimate from differences of
/// orders 3 to 6. White noise gives a difference of order k binomial(2 k, k) times its variance.
double position_noise_m(const Vectors& backward, double step_s) {
    constexpr std::array<double, 4> gain{20.0, 70.0, 252.0, 924.0};  // orders 3 to 6
    double noise_m = std::numeric_limits<double>::infinity();
    Vectors current = backward;
    for (int order = 2; order <= 6; ++order) {
        for (std::size_t i = current.size(); i-- > 1;) {
            if (current[i] && current[i - 1])
                *current[i] -= *current[i - 1];
            else
                current[i].reset();
        }
        if (order < 3) continue;
        std::vector<double> values;
        for (const auto& each : current)
            if (each) values.insert(values.end(), {each->x() * step_s, each->y() * step_s});
        if (values.size() < 2 * least_compared) break;
        noise_m = std::min(noise_m, robust_scatter(std::move(values)) /
                                        std::sqrt(gain[static_cast<std::size_t>(order - 3)]));
    }
    return std::isfinite(noise_m) ? noise_m : 0.0;
}

/// Scatter of a scheme along an axis for unit white position noise (1/s).
double noise_gain(Difference kind, int mean_over, double step_s) {
    std::vector<double> weight(static_cast<std::size_t>(mean_over) + 2, 0.0);
    const std::size_t span = kind == Difference::central ? 2 : 1;
    for (std::size_t i = 0; i < static_cast<std::size_t>(mean_over); ++i) {
        weight[i] -= 1.0;
        weight[i + span] += 1.0;
    }
    double squares = 0.0;
    for (const double each : weight)
        squares += each * each;
    return std::sqrt(squares) / (mean_over * static_cast<double>(span) * step_s);
}

/// The recorded speeds minus those of a scheme, where both exist.
std::vector<double> residuals_of(Rows rows, const Vectors& differences, int before, int after) {
    std::vector<double> residuals;
    const auto size = std::ssize(rows);
    for (std::ptrdiff_t i = before; i + after < size; ++i) {
        const auto& speed = rows[static_cast<std::size_t>(i)].speed_m_s;
        if (!speed || *speed <= 0.0) continue;  // devices write zero for slow motion
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        bool whole = true;
        for (std::ptrdiff_t j = i - before; j <= i + after; ++j) {
            const auto& each = differences[static_cast<std::size_t>(j)];
            whole = whole && each;
            if (each) sum += *each;
        }
        if (whole) residuals.push_back(*speed - sum.norm() / (before + after + 1));
    }
    return residuals;
}

/// The judgement on one scheme: `independent` where the speeds are not its differences.
OriginFound judged(OriginFound scheme, std::vector<double> residuals, double rounding_m_s) {
    scheme.compared = residuals.size();
    if (scheme.compared < least_compared) return scheme;
    scheme.residual_m_s = robust_scatter(std::move(residuals));
    const double rounded_m_s = share_of_rounding * rounding_m_s;
    const bool fits =
        scheme.residual_m_s <= std::hypot(share_of_noise * scheme.noise_m_s, rounded_m_s);
    const bool stands_out = scheme.noise_m_s >= 2.0 * rounded_m_s;
    scheme.origin = !fits ? Origin::independent : stands_out ? Origin::positions : Origin::unclear;
    return scheme;
}

/// Whether answer `a` takes precedence over `b`: first one that certainly finds positions, then a
/// doubtful one, then the nearest.
bool outweighs(const OriginFound& a, const OriginFound& b) {
    const auto rank = [](const OriginFound& each) {
        if (each.compared < least_compared) return 3;
        return each.origin == Origin::positions ? 0 : each.origin == Origin::unclear ? 1 : 2;
    };
    if (rank(a) != rank(b)) return rank(a) < rank(b);
    return a.residual_m_s < b.residual_m_s;
}

}  // namespace

double speed_resolution_m_s(Rows rows) {
    constexpr double written_to_m_s = 2e-6;
    std::vector<double> speeds;
    for (const SpeedBesidePosition& row : rows)
        if (row.speed_m_s) speeds.push_back(*row.speed_m_s);
    std::sort(speeds.begin(), speeds.end());
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < speeds.size(); ++i)
        if (const double gap = speeds[i] - speeds[i - 1]; gap > 2.0 * written_to_m_s)
            step = std::min(step, gap);
    if (!std::isfinite(step) || step < finest_speed_m_s) return finest_speed_m_s;
    // The smallest gap contains two rounding errors; a mean over many steps does not.
    const double steps = std::round(speeds.back() / step);
    if (steps > 0.0) step = speeds.back() / steps;
    const bool all = std::all_of(speeds.begin(), speeds.end(), [&](double speed) {
        return std::abs(speed - step * std::round(speed / step)) < 2.0 * written_to_m_s;
    });
    return all ? step : finest_speed_m_s;
}

double white_noise_m(Rows rows) {
    const double step_s = median_step_of(rows);
    return step_s > 0.0 ? position_noise_m(backward_differences(rows, step_s), step_s) : 0.0;
}

OriginFound origin_of_speeds(Rows rows, double position_resolution_m) {
    OriginFound best;
    const double step_s = median_step_of(rows);
    if (step_s <= 0.0) return best;
    const Vectors backward = backward_differences(rows, step_s);
    const double noise_m = position_noise_m(backward, step_s);
    const double speed_rounding_m_s = rounding_deviation(speed_resolution_m_s(rows));
    for (const Difference kind : {Difference::backward, Difference::forward, Difference::central}) {
        const Vectors differences = differences_of(backward, kind);
        for (int mean_over = 1; mean_over <= longest_mean; ++mean_over) {
            const double gain = noise_gain(kind, mean_over, step_s);
            const double rounding_m_s =
                std::hypot(speed_rounding_m_s, gain * rounding_deviation(position_resolution_m));
            for (int after = 0; after < mean_over; ++after) {
                OriginFound scheme;
                scheme.difference = kind;
                scheme.before = mean_over - 1 - after;
                scheme.after = after;
                scheme.noise_m_s = gain * noise_m;
                scheme = judged(scheme, residuals_of(rows, differences, scheme.before, after),
                                rounding_m_s);
                if (outweighs(scheme, best)) best = scheme;
            }
        }
    }
    return best;
}

}  // namespace runcert::velocities

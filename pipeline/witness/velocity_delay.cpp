#include "witness/velocity_delay.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "core/uncertainty.h"

namespace runcert::velocities {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

/// The first of the two knots around `time_s`, in the arc of knot `near`. Empty outside the arc.
std::optional<std::size_t> knot_before(const Knots& knots, std::size_t near, double time_s) {
    const std::int64_t arc = knots[near].arc;
    std::size_t k = near;
    while (knots[k].time_s > time_s) {
        if (k == 0 || knots[k - 1].arc != arc) return std::nullopt;
        --k;
    }
    while (k + 1 < knots.size() && knots[k + 1].arc == arc && knots[k + 1].time_s <= time_s)
        ++k;
    const bool last = k + 1 == knots.size() || knots[k + 1].arc != arc;
    if (!last) return k;
    // The last knot itself belongs to the segment before it.
    if (knots[k].time_s < time_s || k == 0 || knots[k - 1].arc != arc) return std::nullopt;
    return k - 1;
}

}  // namespace

std::optional<Knot> motion_at(const Knots& knots, std::size_t near, double time_s) {
    const auto before = knot_before(knots, near, time_s);
    if (!before) return std::nullopt;
    const Knot &a = knots[*before], &b = knots[*before + 1];
    const double h = b.time_s - a.time_s, s = (time_s - a.time_s) / h, r = 1.0 - s;
    Knot at = knots[near];
    at.time_s = time_s;
    at.velocity = r * r * ((1.0 + 2.0 * s) * a.velocity + s * h * a.acceleration) +
                  s * s * ((1.0 + 2.0 * r) * b.velocity - r * h * b.acceleration);
    at.acceleration = 6.0 * s * r / h * (b.velocity - a.velocity) +
                      r * (1.0 - 3.0 * s) * a.acceleration + s * (1.0 - 3.0 * r) * b.acceleration;
    return at;
}

double scale_of(double squared_norm, double probability) {
    return std::sqrt(squared_norm / chi_squared_quantile(probability, 2));
}

Delay delay_of(const std::function<double(double)>& mean_square, double middle_s, double range_s,
               double step_s, double independent) {
    Delay found{.delay_s = std::nullopt, .sigma_s = std::numeric_limits<double>::infinity()};
    const auto steps = static_cast<int>(std::lround(range_s / step_s));
    std::vector<double> profile;
    for (int k = -steps; k <= steps; ++k)
        profile.push_back(mean_square(middle_s + k * step_s));
    const auto least = std::ranges::min_element(profile);
    if (least == profile.begin() || least + 1 == profile.end()) return found;
    const double left = *(least - 1), right = *(least + 1), bend = left - 2.0 * *least + right;
    if (!(bend > 0.0 && std::isfinite(bend))) return found;
    const double vertex = static_cast<double>(least - profile.begin()) - steps;
    found.delay_s = middle_s + (vertex + 0.5 * (left - right) / bend) * step_s;
    found.sigma_s = step_s * std::sqrt(2.0 * *least / (bend * independent));
    return found;
}

namespace {

/// One comparison as a function of the delay: its difference and derivative there.
struct DelayTerm {
    std::int64_t arc = 0;
    double time_s = 0.0;
    Vector2d difference = Vector2d::Zero();
    Vector2d acceleration = Vector2d::Zero();
};

std::vector<DelayTerm> delay_terms(const Knots& knots, const std::vector<Comparison>& comparisons,
                                   double delay_s) {
    std::vector<DelayTerm> terms;
    terms.reserve(comparisons.size());
    for (const Comparison& c : comparisons) {
        const auto at = motion_at(knots, c.knot, knots[c.knot].time_s - delay_s);
        if (at) terms.push_back({at->arc, at->time_s, c.recorded - at->velocity, at->acceleration});
    }
    return terms;
}

/// The comparisons that contribute to the delay. Their acceleration must exceed noise (95 %), and
/// the whole range of delays must lie inside the arc, so that every delay is judged by the same
/// epochs. Epochs at a standstill thereby drop out, and cannot make the scale too small for the
/// others.
std::vector<Comparison> accelerating(const Knots& knots, const Motion& motion,
                                     const std::vector<Comparison>& comparisons,
                                     double delay_max_s) {
    const double significant = chi_squared_upper_quantile(0.05, 2);
    std::vector<Comparison> chosen;
    for (const Comparison& c : comparisons) {
        const Knot& knot = knots[c.knot];
        const Matrix2d& covariance = motion[knot.row]->acceleration_covariance;
        const bool moves =
            knot.acceleration.dot(covariance.inverse() * knot.acceleration) > significant &&
            motion_at(knots, c.knot, knot.time_s - delay_max_s) &&
            motion_at(knots, c.knot, knot.time_s + delay_max_s);
        if (moves) chosen.push_back(c);
    }
    return chosen;
}

/// Limit of the quadratic part of Huber's function, in scales of the norm: 86 % of normal errors
/// lie within.
constexpr double huber_bend = 2.0;

double huber(double x) {
    return x <= huber_bend ? 0.5 * x * x : huber_bend * (x - 0.5 * huber_bend);
}
double huber_weight(double x) {
    return x <= huber_bend ? 1.0 : huber_bend / x;
}

/// Standard deviation of the M-estimate by the sandwich formula. It combines the curvature of the
/// criterion with the sum of its terms' covariances over two seconds (Bartlett weights, [NW87]),
/// because neighbouring differences share the errors of the smoothed motion.
double delay_sigma(const std::vector<DelayTerm>& terms, double scale, double interval_s) {
    const double span_s = std::max(2.0, 3.0 * interval_s);
    double curvature = 0.0, white = 0.0, correlated = 0.0;
    std::vector<double> slopes;
    for (const DelayTerm& term : terms) {
        const double norm = term.difference.norm(), weight = huber_weight(norm / scale);
        double bend = weight * term.acceleration.squaredNorm();
        if (weight < 1.0)
            bend -= weight * std::pow(term.acceleration.dot(term.difference) / norm, 2);
        curvature += bend;
        slopes.push_back(weight * term.acceleration.dot(term.difference));
    }
    for (std::size_t i = 0; i < terms.size(); ++i) {
        white += slopes[i] * slopes[i];
        for (std::size_t j = i + 1; j < terms.size() && terms[j].arc == terms[i].arc; ++j) {
            const double apart_s = terms[j].time_s - terms[i].time_s;
            if (apart_s >= span_s) break;
            correlated += 2.0 * (1.0 - apart_s / span_s) * slopes[i] * slopes[j];
        }
    }
    if (curvature <= 0.0) return std::numeric_limits<double>::infinity();
    return std::sqrt(std::max(white, white + correlated)) / curvature;
}

struct CoarseDelay {
    double delay_s = 0.0;
    double scale = 0.0;
    double step_s = 0.0;
    bool at_limit = false;
};

/// A few thousand comparisons, evenly spread: enough for a grid.
std::vector<Comparison> spread(const std::vector<Comparison>& all) {
    constexpr std::size_t enough = 2000;
    const std::size_t stride = 1 + all.size() / (2 * enough);
    std::vector<Comparison> chosen;
    for (std::size_t k = 0; k < all.size(); k += stride)
        chosen.push_back(all[k]);
    return chosen;
}

/// The delay with the least Huber criterion on a grid over the whole range. Its scale is that of
/// the grid's least median [Rousseeuw84], which up to half of the epochs cannot spoil.
CoarseDelay coarse_delay(const Knots& knots, const std::vector<Comparison>& all,
                         double delay_max_s) {
    const std::vector<Comparison> comparisons = spread(all);
    constexpr int half = 25;
    CoarseDelay coarse{.scale = std::numeric_limits<double>::infinity(),
                       .step_s = delay_max_s / half};
    std::vector<std::vector<double>> grid;  // squared norms
    for (int g = -half; g <= half; ++g) {
        std::vector<double>& squares = grid.emplace_back();
        for (const DelayTerm& term : delay_terms(knots, comparisons, g * coarse.step_s))
            squares.push_back(term.difference.squaredNorm());
        coarse.scale = std::min(coarse.scale, scale_of(median(squares), 0.5));
    }
    // A floor, because noise-free velocities would make the divisor zero.
    coarse.scale = std::max(coarse.scale, 1e-6);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t g = 0; g < grid.size(); ++g) {
        double sum = 0.0;
        for (const double square : grid[g])
            sum += huber(std::sqrt(square) / coarse.scale);
        if (sum >= least) continue;
        least = sum;
        coarse.delay_s = (static_cast<double>(g) - half) * coarse.step_s;
        coarse.at_limit = g == 0 || g + 1 == grid.size();
    }
    return coarse;
}

}  // namespace

Delay estimate_delay(const Knots& knots, const Motion& motion, const std::vector<Comparison>& all,
                     double limit_s, double interval_s) {
    const Delay undetermined{.delay_s = std::nullopt, .sigma_s = rectangular_uncertainty(limit_s)};
    if (limit_s <= 0.0) return undetermined;
    const auto comparisons = accelerating(knots, motion, all, limit_s);
    if (comparisons.size() < least_comparisons) return undetermined;
    const CoarseDelay coarse = coarse_delay(knots, comparisons, limit_s);
    if (coarse.at_limit) return undetermined;
    const auto criterion = [&](double delay_s) {
        double sum = 0.0;
        for (const DelayTerm& term : delay_terms(knots, comparisons, delay_s))
            sum += huber(term.difference.norm() / coarse.scale);
        return sum;
    };
    constexpr double parts = 8.0;  // of a step, so that the criterion is a parabola between them
    const auto delay_s = delay_of(criterion, coarse.delay_s, coarse.step_s + coarse.step_s / parts,
                                  coarse.step_s / parts, 1.0)
                             .delay_s;
    if (!delay_s) return undetermined;
    const std::vector<DelayTerm> terms = delay_terms(knots, comparisons, *delay_s);
    const double sigma_s = delay_sigma(terms, coarse.scale, interval_s);
    if (!(sigma_s <= 0.5 * interval_s)) return undetermined;
    return {.delay_s = delay_s, .sigma_s = sigma_s};
}

}  // namespace runcert::velocities

#include "stages/screen/velocity_check.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/statistics.h"

namespace runcert {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr std::size_t least_comparisons = 30;
/// Neighbours on either side that a local scale comes from, and over which a wrong position may
/// have bent the smoothed motion.
constexpr std::size_t neighbours = 10;
constexpr std::size_t least_neighbours = 8;

/// A velocity at a time of an arc, with its slope.
struct Knot {
    std::size_t row = 0;
    std::int64_t arc = 0;
    double time_s = 0.0;
    Vector2d velocity = Vector2d::Zero();
    Vector2d acceleration = Vector2d::Zero();
    Matrix2d covariance = Matrix2d::Zero();
};
using Knots = std::vector<Knot>;

/// The first of the two knots about `time_s` in the arc of knot `near`, where the search starts.
/// Nothing outside the arc.
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
    // At the last knot itself the segment before it serves.
    if (knots[k].time_s < time_s || k == 0 || knots[k - 1].arc != arc) return std::nullopt;
    return k - 1;
}

/// Velocity and acceleration between knots by the cubic that has both at either end (Hermite);
/// the covariance linearly between theirs. Nothing outside the arc.
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
    at.covariance = r * a.covariance + s * b.covariance;
    return at;
}

std::optional<Vector2d> recorded_velocity(const ScreenedEpoch& row) {
    if (!row.recorded_velocity_east_mps || !row.recorded_velocity_north_mps) return std::nullopt;
    return Vector2d(*row.recorded_velocity_east_mps, *row.recorded_velocity_north_mps);
}

/// A usable row with a recorded velocity, and the knot of its smoothed motion.
struct Comparison {
    std::size_t knot = 0;
    Vector2d recorded = Vector2d::Zero();
};

/// A recorded velocity less another at one row (m/s), what is known of its variance without the
/// recorded velocity's part, and the statistic that the test made of it.
struct Difference {
    std::size_t row = 0;
    std::int64_t arc = 0;
    Vector2d value = Vector2d::Zero();
    Matrix2d known = Matrix2d::Zero();
    double statistic = 0.0;
};
using Differences = std::vector<Difference>;

struct Delay {
    std::optional<double> delay_s;
    double sigma_s = 0.0;
};

/// What one comparison says about the delay: the difference there, and its derivative.
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

/// The comparisons that can tell a delay: acceleration that is not just noise (95 %), and the
/// whole range of delays inside the arc, so that every delay is judged by the same epochs. Epochs
/// that stand still are thereby left out, and cannot make the scale too small for the others.
std::vector<Comparison> accelerating(const Knots& knots, const Motion& motion,
                                     const std::vector<Comparison>& comparisons,
                                     double delay_max_s) {
    const double told = chi_squared_upper_quantile(0.05, 2);
    std::vector<Comparison> chosen;
    for (const Comparison& c : comparisons) {
        const Knot& knot = knots[c.knot];
        const Matrix2d& covariance = motion[knot.row]->acceleration_covariance;
        const bool moves = knot.acceleration.dot(covariance.inverse() * knot.acceleration) > told &&
                           motion_at(knots, c.knot, knot.time_s - delay_max_s) &&
                           motion_at(knots, c.knot, knot.time_s + delay_max_s);
        if (moves) chosen.push_back(c);
    }
    return chosen;
}

/// Standard deviation for each axis of two-dimensional vectors whose squared norm has the given
/// quantile at `probability`, for normal errors.
double scale_of(double squared_norm, double probability) {
    return std::sqrt(squared_norm / chi_squared_quantile(probability, 2));
}

/// Huber's function of the norm (in scales), quadratic up to here: 86 % of normal errors.
constexpr double huber_bend = 2.0;

double huber(double x) {
    return x <= huber_bend ? 0.5 * x * x : huber_bend * (x - 0.5 * huber_bend);
}
double huber_weight(double x) {
    return x <= huber_bend ? 1.0 : huber_bend / x;
}

/// Standard deviation of the M-estimate by the sandwich: curvature of the criterion, and the sum of
/// its terms' covariances over two seconds (Bartlett weights, Newey & West 1987), because
/// neighbouring differences share the errors of the smoothed motion.
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

/// The delay on a grid over the whole range that has the least Huber criterion, in the scale of
/// the grid's least median (Rousseeuw 1984), which up to half of the epochs cannot spoil.
CoarseDelay coarse_delay(const Knots& knots, const std::vector<Comparison>& comparisons,
                         double delay_max_s) {
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
    // Noise-free velocities would leave nothing to divide by.
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

/// The delay d of v_recorded(t) = v(t - d) by a Huber M-estimate, refined from the grid by
/// reweighted least squares. Not told where hardly any epoch accelerates, where the criterion is
/// least at the limit of the range, or where its standard uncertainty is over half an interval.
Delay estimate_delay(const Knots& knots, const Motion& motion, const std::vector<Comparison>& all,
                     const VelocityCheckOptions& options) {
    const double limit_s = options.delay_max_s;
    const Delay not_told{.delay_s = std::nullopt, .sigma_s = limit_s};
    if (limit_s <= 0.0) return not_told;
    const auto comparisons = accelerating(knots, motion, all, limit_s);
    if (comparisons.size() < least_comparisons) return not_told;
    const CoarseDelay coarse = coarse_delay(knots, comparisons, limit_s);
    if (coarse.at_limit) return not_told;
    double delay_s = coarse.delay_s;
    std::vector<DelayTerm> terms;
    for (int iteration = 0; iteration < 50; ++iteration) {
        terms = delay_terms(knots, comparisons, delay_s);
        double along = 0.0, squares = 0.0;
        for (const DelayTerm& term : terms) {
            const double weight = huber_weight(term.difference.norm() / coarse.scale);
            along += weight * term.acceleration.dot(term.difference);
            squares += weight * term.acceleration.squaredNorm();
        }
        // The derivative of a difference by the delay is the acceleration.
        const double next_s = std::clamp(delay_s - along / squares, coarse.delay_s - coarse.step_s,
                                         coarse.delay_s + coarse.step_s);
        const bool settled = std::abs(next_s - delay_s) < 1e-7;
        delay_s = next_s;
        if (settled) break;
    }
    const double sigma_s = delay_sigma(terms, coarse.scale, options.nominal_interval_s);
    if (!(sigma_s <= 0.5 * options.nominal_interval_s)) return not_told;
    return {.delay_s = delay_s, .sigma_s = sigma_s};
}

/// What the tables say, gathered; `comparisons` and `recorded` are of the same rows.
struct Gathered {
    Knots smoothed;
    std::vector<Comparison> comparisons;
    Knots recorded;
};

/// The recorded velocity at a time in the arc, linearly between epochs.
std::optional<Vector2d> recorded_at(const Knots& recorded, std::size_t near, double time_s) {
    const auto before = knot_before(recorded, near, time_s);
    if (!before) return std::nullopt;
    const Knot &a = recorded[*before], &b = recorded[*before + 1];
    return a.velocity + (time_s - a.time_s) / (b.time_s - a.time_s) * (b.velocity - a.velocity);
}

/// The variance that an uncertain delay makes: by what the recorded velocity changes over it. A
/// delay not told counts as its largest. Where the velocity hardly changes, as it does then, this
/// costs little; where it does change, the comparison loses its weight by itself. The smoothed
/// acceleration would not do: a wrong position makes it large, and would excuse itself.
Matrix2d delay_variance(const Knots& recorded, std::size_t k, const Delay& delay) {
    const Knot& knot = recorded[k];
    const auto before = recorded_at(recorded, k, knot.time_s - delay.sigma_s);
    const auto after = recorded_at(recorded, k, knot.time_s + delay.sigma_s);
    const Vector2d change = 0.5 * (after.value_or(knot.velocity) - before.value_or(knot.velocity));
    return change * change.transpose();
}

/// Recorded less smoothed velocities.
Differences smoothed_differences(const Gathered& gathered, const Delay& delay) {
    Differences differences;
    for (std::size_t k = 0; k < gathered.recorded.size(); ++k) {
        const Knot& recorded = gathered.recorded[k];
        const auto at = motion_at(gathered.smoothed, gathered.comparisons[k].knot,
                                  recorded.time_s - delay.delay_s.value_or(0.0));
        if (!at) continue;
        differences.push_back(
            {.row = recorded.row,
             .arc = recorded.arc,
             .value = recorded.velocity - at->velocity,
             .known = at->covariance + delay_variance(gathered.recorded, k, delay)});
    }
    return differences;
}

/// Mean recorded velocities, of both ends of each step between rows that are compared and each
/// taken a delay later, less the displacement over the interval. The row is the step's second.
Differences displacement_differences(const std::vector<ScreenedEpoch>& rows, const Knots& recorded,
                                     const Delay& delay) {
    Differences differences;
    const double delay_s = delay.delay_s.value_or(0.0);
    for (std::size_t k = 1; k < recorded.size(); ++k) {
        const Knot &a = recorded[k - 1], &b = recorded[k];
        const auto from = recorded_at(recorded, k - 1, a.time_s + delay_s);
        const auto to = recorded_at(recorded, k, b.time_s + delay_s);
        if (a.arc != b.arc || !from || !to) continue;
        const double dt_s = b.time_s - a.time_s;
        const Vector2d moved =
            measured_position<2>(rows[b.row]) - measured_position<2>(rows[a.row]);
        const Matrix2d stated =
            stated_covariance<2>(rows[a.row]) + stated_covariance<2>(rows[b.row]);
        differences.push_back(
            {.row = b.row,
             .arc = b.arc,
             .value = 0.5 * (*from + *to) - moved / dt_s,
             .known = stated / (dt_s * dt_s) + delay_variance(recorded, k, delay)});
    }
    return differences;
}

/// Scatter around a difference, from the steps between neighbours: a drift of the positions, which
/// moves many of them by the same, does not hide itself in it. From the upper quartile, because a
/// window at the beginning of a run is half of epochs that stand still.
double local_scale(const Differences& differences, std::size_t k) {
    std::vector<double> squares;
    const std::size_t last = std::min(differences.size() - 1, k + neighbours);
    for (std::size_t i = k - std::min(k, neighbours); i < last; ++i)
        if (differences[i].arc == differences[k].arc &&
            differences[i + 1].arc == differences[k].arc)
            squares.push_back(0.5 *
                              (differences[i + 1].value - differences[i].value).squaredNorm());
    if (squares.size() < least_neighbours) return 0.0;
    const auto quartile =
        squares.begin() + static_cast<std::ptrdiff_t>(3 * (squares.size() - 1) / 4);
    std::nth_element(squares.begin(), quartile, squares.end());
    return scale_of(*quartile, 0.75);
}

/// Fills the statistics; the scale of all is returned.
///
/// The variance is what is known of the other side (larger near the ends of arcs and after gaps),
/// plus the recorded velocity's own: the square of the scale less the typical known variance. The
/// scale is the larger of the whole recording's and the local one, because no recording seen has
/// one scale. Seen at 1 and 4 Hz: 7 to 8 mm/s standing against 18 to 60 mm/s moving, and tails far
/// heavier than normal: one difference in a hundred beyond 0.13 m/s where the scale is 0.017 m/s,
/// up to 0.2 m/s alone and 0.3 m/s within a few scattered epochs. With one scale and without a
/// second epoch that agrees, 33 good epochs of 2187 would be marked; so none is.
double test_differences(Differences& differences) {
    if (differences.size() < least_comparisons) return 0.0;
    std::vector<double> squares, variances;
    for (const Difference& difference : differences) {
        squares.push_back(difference.value.squaredNorm());
        variances.push_back(0.5 * difference.known.trace());
    }
    const double scale = scale_of(median(std::move(squares)), 0.5);
    const double typical = median(std::move(variances));
    for (std::size_t k = 0; k < differences.size(); ++k) {
        Difference& d = differences[k];
        const double largest = std::max(scale, local_scale(differences, k));
        const double own = std::max(0.0, largest * largest - typical);
        const Matrix2d covariance = d.known + own * Matrix2d::Identity();
        d.statistic = d.value.dot(covariance.inverse() * d.value);
    }
    return scale;
}

/// Whether differences `k` and `k + 1` are of one arc, both beyond the threshold, and in one
/// direction (or in opposite ones).
bool contradict(const Differences& differences, std::size_t k, double threshold, bool opposite) {
    const Difference &a = differences[k], &b = differences[k + 1];
    if (a.arc != b.arc || !(a.statistic > threshold && b.statistic > threshold)) return false;
    return (a.value.dot(b.value) < 0.0) == opposite;
}

void mark(ScreenedEpoch& row, double statistic, double threshold) {
    row.usable = false;
    row.reason = Reason::velocity;
    row.hypothesis = Hypothesis::velocity;
    row.tested_axes = TestedAxes::horizontal;
    row.statistic = statistic;
    row.threshold = threshold;
}

/// The epochs between two displacements that contradict in opposite directions: their rows.
std::vector<std::size_t> mark_displaced(std::vector<ScreenedEpoch>& rows,
                                        const Differences& displacements, double threshold) {
    std::vector<std::size_t> marked;
    for (std::size_t k = 0; k + 1 < displacements.size(); ++k) {
        if (!contradict(displacements, k, threshold, true)) continue;
        const Difference &to = displacements[k], &from = displacements[k + 1];
        mark(rows[to.row], std::min(to.statistic, from.statistic), threshold);
        marked.push_back(to.row);
    }
    return marked;
}

/// Both epochs of each two that contradict in one direction, if no wrong position bent the motion.
void mark_drifting(std::vector<ScreenedEpoch>& rows, const Differences& differences,
                   const std::vector<std::size_t>& displaced, double threshold) {
    std::vector<bool> bent(differences.size(), false);
    for (const std::size_t row : displaced)
        for (std::size_t k = 0; k < differences.size(); ++k)
            if (differences[k].row + neighbours >= row && differences[k].row <= row + neighbours)
                bent[k] = true;
    for (std::size_t k = 0; k + 1 < differences.size(); ++k) {
        if (!contradict(differences, k, threshold, false)) continue;
        for (const std::size_t i : {k, k + 1})
            if (!bent[i]) mark(rows[differences[i].row], differences[i].statistic, threshold);
    }
}

Gathered gather(const std::vector<ScreenedEpoch>& rows, const Motion& motion) {
    Gathered gathered;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].arc || !motion[i]) continue;
        Knot knot{.row = i,
                  .arc = *rows[i].arc,
                  .time_s = rows[i].time.seconds(),
                  .velocity = motion[i]->velocity,
                  .acceleration = motion[i]->acceleration,
                  .covariance = motion[i]->velocity_covariance};
        gathered.smoothed.push_back(knot);
        const auto recorded = recorded_velocity(rows[i]);
        if (!rows[i].usable || !recorded) continue;
        gathered.comparisons.push_back({gathered.smoothed.size() - 1, *recorded});
        knot.velocity = *recorded;
        gathered.recorded.push_back(knot);
    }
    return gathered;
}

/// Whether the receiver fills the field: the velocities of a real one never stay the same.
bool recorded_velocities_change(const std::vector<ScreenedEpoch>& rows) {
    std::optional<Vector2d> first;
    for (const ScreenedEpoch& row : rows) {
        const auto recorded = recorded_velocity(row);
        if (first && recorded && *recorded != *first) return true;
        if (!first) first = recorded;
    }
    return false;
}

}  // namespace

std::optional<VelocityEvidence> check_velocities(std::vector<ScreenedEpoch>& rows,
                                                 const Motion& motion,
                                                 const VelocityCheckOptions& options) {
    assert(rows.size() == motion.size());
    const auto recorded = std::count_if(rows.begin(), rows.end(), [](const ScreenedEpoch& row) {
        return recorded_velocity(row).has_value();
    });
    if (recorded < static_cast<std::ptrdiff_t>(least_comparisons)) return std::nullopt;
    VelocityEvidence evidence;
    if (!recorded_velocities_change(rows)) return evidence;

    const Gathered gathered = gather(rows, motion);
    const Delay delay = estimate_delay(gathered.smoothed, motion, gathered.comparisons, options);
    Differences differences = smoothed_differences(gathered, delay);
    if (differences.size() < least_comparisons) return evidence;
    Differences displacements = displacement_differences(rows, gathered.recorded, delay);
    evidence.compared = static_cast<std::int64_t>(differences.size());
    evidence.delay_s = delay.delay_s;
    if (delay.delay_s) evidence.sigma_delay_s = delay.sigma_s;
    evidence.scale_mps = test_differences(differences);
    test_differences(displacements);

    const double threshold = chi_squared_upper_quantile(options.test_size, 2);
    const auto displaced = mark_displaced(rows, displacements, threshold);
    mark_drifting(rows, differences, displaced, threshold);
    evidence.rejected = std::count_if(gathered.recorded.begin(), gathered.recorded.end(),
                                      [&](const Knot& knot) { return !rows[knot.row].usable; });
    return evidence;
}

}  // namespace runcert

#include "stages/window/combination.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "stages/window/velocity_noise.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

constexpr double nominal_window_s = 3.0;
constexpr double largest_probability = 0.05;

/// Whether a test of screening rejected an epoch's position.
bool is_rejected(const ScreenedEpoch& row) {
    return !row.usable && row.hypothesis.has_value();
}

/// How often such positions have undetected errors, relative to those of the best fix type.
double times_as_likely(const ScreenedTable& screened, EpochPair rows) {
    constexpr double of_other_kinds = 25.0, of_disturbed = 5.0, near_s = 60.0;
    for (std::size_t i = rows.first; i <= rows.last; ++i)
        if (screened.rows[i].usable && screened.rows[i].fix != FixType::fixed)
            return of_other_kinds;
    const double from_s = screened.rows[rows.first].time.seconds() - near_s;
    const double to_s = screened.rows[rows.last].time.seconds() + near_s;
    const bool disturbed = std::ranges::any_of(screened.rows, [&](const ScreenedEpoch& row) {
        return row.time.seconds() >= from_s && row.time.seconds() <= to_s && is_rejected(row);
    });
    return disturbed ? of_disturbed : 1.0;
}

/// Largest undetected error of positions by their fix type: 3 m for an incorrect fix; for code a
/// tenth of a chip, where reflections obscure its edge.
double largest_error_m(const ScreenedTable& screened, EpochPair rows) {
    constexpr double by_phases_m = 3.0, by_code_m = 30.0;
    for (std::size_t i = rows.first; i <= rows.last; ++i) {
        const FixType fix = screened.rows[i].fix;
        if (screened.rows[i].usable && fix != FixType::fixed && fix != FixType::float_ambiguities &&
            fix != FixType::ppp)
            return by_code_m;
    }
    return by_phases_m;
}

/// Increase of a window's fault probability by its rivals, in units of that probability.
double by_rivals(const FoundWindow& found, const std::vector<FoundWindow>& all,
                 double largest_m_s) {
    if (largest_m_s <= 0.0) return 0.0;
    std::vector<const FoundWindow*> near;
    for (const FoundWindow& window : all)
        if (found.speed_m_s - window.speed_m_s < largest_m_s) near.push_back(&window);
    std::ranges::stable_sort(near, std::greater<>(),
                             [](const FoundWindow* window) { return window->speed_m_s; });
    std::vector<std::pair<ElapsedTime, ElapsedTime>> taken{{found.start, found.end}};
    double sum = 0.0;
    for (const FoundWindow* const window : near) {
        const auto after = std::ranges::lower_bound(taken, window->start, {},
                                                    [](const auto& one) { return one.first; });
        const bool overlaps = (after != taken.end() && after->first < window->end) ||
                              (after != taken.begin() && std::prev(after)->second > window->start);
        if (overlaps) continue;
        taken.insert(after, {window->start, window->end});
        const double slower_m_s = std::max(0.0, found.speed_m_s - window->speed_m_s);
        sum += 0.5 * (1.0 - slower_m_s / largest_m_s);
    }
    return sum;
}

/// A row's recorded velocity towards east, or upwards. A speed alone is taken as it is.
OptionalReal recorded_along(const ScreenedEpoch& row, TestedAxes axes) {
    if (axes == TestedAxes::vertical) return row.recorded_velocity_up_m_s;
    return row.recorded_velocity_east_m_s ? row.recorded_velocity_east_m_s : row.recorded_speed_m_s;
}

/// Contribution of the white noise of recorded velocities, from their third differences, to the
/// variance of a displacement per second (m^2/s).
double white_of_velocities(const ScreenedTable& screened, TestedAxes axes) {
    std::vector<double> third;
    const auto& rows = screened.rows;
    for (std::size_t i = 3; i < rows.size(); ++i) {
        const auto a = recorded_along(rows[i - 3], axes), b = recorded_along(rows[i - 2], axes),
                   c = recorded_along(rows[i - 1], axes), d = recorded_along(rows[i], axes);
        if (a && b && c && d) third.push_back(std::abs(*d - 3.0 * *c + 3.0 * *b - *a));
    }
    if (third.empty()) return 0.0;
    return std::pow(robust_sd(std::move(third), 20.0), 2) * screened.facts.nominal_interval_s;
}

/// The variance (m^2) of a displacement between positions, with twice the stated errors at both
/// ends: nearly all that positions could explain.
double explained_by_positions_m2(const ScreenedTable& screened, TestedAxes axes) {
    std::vector<double> sigmas;
    for (const ScreenedEpoch& row : screened.rows) {
        const auto& sigma = axes == TestedAxes::vertical ? row.sigma_up_m : row.sigma_east_m;
        if (row.usable && sigma) sigmas.push_back(*sigma);
    }
    return sigmas.empty() ? 0.0 : 2.0 * std::pow(2.0 * median(std::move(sigmas)), 2);
}

/// What the positions' stated errors and the white noise of the velocities explain of their
/// difference.
struct Explained {
    double positions_m2 = 0.0, white_m2_s = 0.0;

    double over_m2(double span_s) const { return positions_m2 + white_m2_s * span_s; }
};

Explained explained_in(const ScreenedTable& screened, TestedAxes axes) {
    // Doubled, because a short recording has few spans that do not overlap.
    return {.positions_m2 = explained_by_positions_m2(screened, axes),
            .white_m2_s = 2.0 * white_of_velocities(screened, axes)};
}

/// Lasting error of good receivers, whatever they state, or what these state.
double known_of_velocities_m_s(const VelocityErrors& errors) {
    const double of_good_m_s = errors.axes == TestedAxes::vertical ? 0.1 : 0.07;
    return std::max(of_good_m_s, errors.stated_m_s.value_or(0.0));
}

using Covariance = Eigen::MatrixXd;

/// Joint covariance of the speeds by positions (first) and by the witnesses.
Covariance covariance_of(const PositionTerms& positions, std::span<const WitnessTerm> witnesses) {
    const double slow_m_s = positions.slow_m_s;
    const Eigen::Index size = 1 + std::ssize(witnesses);
    Covariance covariance = Covariance::Zero(size, size);
    covariance(0, 0) = positions.own_m_s * positions.own_m_s + slow_m_s * slow_m_s +
                       positions.fault_m_s * positions.fault_m_s;
    for (Eigen::Index i = 1; i < size; ++i) {
        const WitnessTerm& one = witnesses[static_cast<std::size_t>(i) - 1];
        const double shared_m_s = one.shares_slow ? slow_m_s : one.shared_m_s;
        covariance(i, i) = one.own_m_s * one.own_m_s + shared_m_s * shared_m_s;
        // At most the smaller of the two is common.
        covariance(0, i) = covariance(i, 0) = shared_m_s * std::min(shared_m_s, slow_m_s);
        for (Eigen::Index j = 1; j < i; ++j)
            if (one.shares_slow || witnesses[static_cast<std::size_t>(j) - 1].shares_slow)
                covariance(i, j) = covariance(j, i) = std::min(covariance(0, i), covariance(0, j));
    }
    return covariance;
}

/// The witnesses as if another receiver's time-correlated error had nothing in common with the
/// positions' own, so that their difference shows both.
std::vector<WitnessTerm> as_independent(const PositionTerms& positions,
                                        std::span<const WitnessTerm> witnesses) {
    std::vector<WitnessTerm> terms(witnesses.begin(), witnesses.end());
    for (WitnessTerm& one : terms)
        if (std::exchange(one.shares_slow, false))
            one.own_m_s = std::hypot(one.own_m_s, positions.slow_m_s);
    return terms;
}

/// The non-negative weights of least variance. Speeds that would have a negative weight are
/// dropped, the most negative first.
Eigen::VectorXd weights_of(const Covariance& covariance) {
    std::vector<Eigen::Index> kept(static_cast<std::size_t>(covariance.rows()));
    std::iota(kept.begin(), kept.end(), Eigen::Index{0});
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(covariance.rows());
    while (!kept.empty()) {
        const Covariance of_kept = covariance(kept, kept);
        const auto ones = Eigen::VectorXd::Ones(std::ssize(kept));
        const Eigen::VectorXd inverse = of_kept.ldlt().solve(ones);
        const Eigen::VectorXd found = inverse / inverse.sum();
        Eigen::Index least = 0;
        if (found.minCoeff(&least) >= 0.0 || kept.size() == 1) {
            for (std::size_t k = 0; k < kept.size(); ++k)
                weights(kept[k]) = kept.size() == 1 ? 1.0 : found(static_cast<Eigen::Index>(k));
            break;
        }
        kept.erase(kept.begin() + least);
    }
    return weights;
}

}  // namespace

double WindowFault::standard_uncertainty_m_s(double times) const {
    return std::sqrt(std::min(1.0, times * prior.probability)) *
           rectangular_uncertainty(prior.largest_m_s);
}

void WindowFault::raise(double probability, double largest, std::string finding) {
    prior.probability = std::max(prior.probability, probability);
    chosen_probability = std::max(chosen_probability, probability);
    prior.largest_m_s = std::max(prior.largest_m_s, largest);
    shown = std::move(finding);
}

double unexplained_by_velocities_m_s(const ScreenedTable& screened, TestedAxes axes) {
    constexpr double longest_span_s = 10.0;
    const auto& all = screened.basis.velocity_errors;
    const auto errors = std::ranges::find(all, axes, &VelocityErrors::axes);
    if (errors == all.end()) return 0.0;
    const Explained explained = explained_in(screened, axes);
    double lasting_m_s = errors->shown_m_s;
    for (const VelocitySpread& spread : errors->spreads) {
        if (spread.span_s > longest_span_s)
            continue;  // a longer span may not fill part of the recording
        const double beyond_m2 = spread.sd_m * spread.sd_m - explained.over_m2(spread.span_s);
        lasting_m_s = std::min(lasting_m_s, std::sqrt(std::max(0.0, beyond_m2)) / spread.span_s);
    }
    return lasting_m_s > known_of_velocities_m_s(*errors) ? lasting_m_s : 0.0;
}

template <int Axes>
LastingDifference lasting_difference(const ScreenedTable& screened,
                                     const Witness<Axes>* velocities) {
    constexpr TestedAxes axes = Axes == 1 ? TestedAxes::vertical : TestedAxes::horizontal;
    const double size_m_s = unexplained_by_velocities_m_s(screened, axes);
    if (!(size_m_s > 0.0) || velocities == nullptr) return {.size_m_s = size_m_s};
    const auto& all = screened.basis.velocity_errors;
    return weigh_scale_and_drift(
        size_m_s, compare_spans<Axes>(*velocities, timed_positions<Axes>(screened.rows)),
        std::sqrt(explained_in(screened, axes).over_m2(compared_span_s)) / compared_span_s,
        known_of_velocities_m_s(*std::ranges::find(all, axes, &VelocityErrors::axes)));
}
template LastingDifference lasting_difference(const ScreenedTable&, const Witness<1>*);
template LastingDifference lasting_difference(const ScreenedTable&, const Witness<2>*);

WindowFault window_fault(const ScreenedTable& screened, const FoundWindow& found,
                         const std::vector<FoundWindow>& all, EpochPair rows,
                         const std::vector<UndetectedError>& reliability, bool by_path,
                         double probability, const LastingDifference& lasting) {
    const double duration_s = found.end.seconds() - found.start.seconds();
    WindowFault fault;
    fault.prior.probability =
        std::min(largest_probability, probability * times_as_likely(screened, rows) *
                                          std::max(1.0, duration_s / nominal_window_s));
    fault.prior.upwards_alone = by_path;
    if (!reliability.empty()) fault.prior.largest_m_s = reliability.front().speed_m_s;
    fault.prior.largest_m_s =
        std::min(fault.prior.largest_m_s,
                 (by_path ? 2.0 : 1.0) * largest_error_m(screened, rows) / duration_s);
    if (lasting.size_m_s > 0.0) {
        // With even odds, twice the standard uncertainty covers what the two axes show together.
        const double largest_m_s = std::max(fault.prior.largest_m_s, 2.0 * lasting.size_m_s);
        const double at_fault = lasting.positions_at_fault(fault.prior.probability, largest_m_s);
        if (at_fault > fault.prior.probability)
            fault.raise(at_fault, largest_m_s,
                        "positions and recorded velocities differ all over the recording by more "
                        "than the errors of either explain");
    }
    // The probability for one window among its rivals, proportional to their number where it is
    // small.
    fault.chosen_probability = 1.0 - std::pow(1.0 - fault.prior.probability,
                                              1.0 + by_rivals(found, all, fault.prior.largest_m_s));
    return fault;
}

WeightedSpeed weigh(const PositionTerms& positions, std::span<const WitnessTerm> witnesses) {
    const Eigen::VectorXd weights = weights_of(covariance_of(positions, witnesses));
    WeightedSpeed mean;
    mean.positions = weights(0);
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
        mean.witnesses.push_back(weights(static_cast<Eigen::Index>(i) + 1));
        mean.difference_m_s += mean.witnesses.back() * witnesses[i].difference_m_s;
    }
    return mean;
}

WitnessMean mean_of_witnesses(const PositionTerms& positions,
                              std::span<const WitnessTerm> witnesses) {
    const Covariance covariance = covariance_of(positions, as_independent(positions, witnesses));
    const Eigen::Index count = std::ssize(witnesses);
    const Covariance of_witnesses = covariance.bottomRightCorner(count, count);
    const Eigen::VectorXd weights = weights_of(of_witnesses);
    WitnessMean mean;
    mean.standard_uncertainty_m_s = std::sqrt(weights.dot(of_witnesses * weights));
    mean.common_m_s = std::sqrt(std::max(0.0, weights.dot(covariance.col(0).tail(count))));
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
        const double weight = weights(static_cast<Eigen::Index>(i));
        mean.difference_m_s += weight * witnesses[i].difference_m_s;
        if (weight == 0.0) continue;
        // Treated as independent, an error that may be common keeps only half its variance in the
        // mean. The other half is added here.
        if (witnesses[i].shares_slow)
            mean.besides_m_s += weight * positions.slow_m_s / std::numbers::sqrt2;
        mean.fault.probability += witnesses[i].fault.probability;
        mean.fault.largest_m_s =
            std::max(mean.fault.largest_m_s, weight * witnesses[i].fault.largest_m_s);
    }
    return mean;
}

double disagreement(const PositionTerms& positions, std::span<const WitnessTerm> witnesses) {
    if (witnesses.empty()) return 0.0;
    constexpr double test_size = 1e-3;
    PositionTerms healthy = positions;
    healthy.fault_m_s = 0.0;
    const Covariance covariance = covariance_of(healthy, as_independent(healthy, witnesses));
    Eigen::VectorXd speeds = Eigen::VectorXd::Zero(covariance.rows());
    for (std::size_t i = 0; i < witnesses.size(); ++i)
        speeds(static_cast<Eigen::Index>(i) + 1) = -witnesses[i].difference_m_s;
    const auto factor = covariance.ldlt();
    const Eigen::VectorXd inverse = factor.solve(Eigen::VectorXd::Ones(covariance.rows()));
    const Eigen::VectorXd apart =
        speeds - Eigen::VectorXd::Constant(covariance.rows(), inverse.dot(speeds) / inverse.sum());
    return std::sqrt(apart.dot(factor.solve(apart)) /
                     chi_squared_upper_quantile(test_size, static_cast<int>(witnesses.size())));
}

}  // namespace runcert

#include "motion/joint_speeds.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/statistics.h"

namespace runcert {
namespace {

/// Keeps the covariance positive definite: below what any speed is written to.
constexpr double least_own_m_s = 1e-9;

double square(double x) {
    return x * x;
}

/// What the differences of the sources say, by the formulas of the header.
struct Differences {
    double sum_of_squares = 0.0;
    struct OfSource {
        double precision = 0.0;  ///< of its fault; 0 where no other source tells
        double fault_m_s = 0.0;  ///< its likeliest fault
    };
    std::vector<OfSource> of;

    explicit Differences(std::span<const SpeedBySource> speeds) {
        std::vector<double> weights;
        double sum = 0.0, mean_m_s = 0.0;
        for (const SpeedBySource& one : speeds)
            sum += weights.emplace_back(1.0 / (square(one.alone_m_s()) + square(least_own_m_s)));
        for (std::size_t i = 0; i < speeds.size(); ++i)
            mean_m_s += weights[i] / sum * speeds[i].speed_m_s;
        for (std::size_t i = 0; i < speeds.size(); ++i) {
            const double apart_m_s = speeds[i].speed_m_s - mean_m_s;
            const double of_others = (sum - weights[i]) / sum;
            sum_of_squares += weights[i] * square(apart_m_s);
            of.push_back(speeds.size() > 1 ? OfSource{weights[i] * of_others, apart_m_s / of_others}
                                           : OfSource{});
        }
    }
};

struct FaultRange {
    double lowest_m_s = 0.0, highest_m_s = 0.0;
    double width() const { return highest_m_s - lowest_m_s; }
};

FaultRange range_of(const FaultPrior& fault) {
    return {fault.upwards_alone ? 0.0 : -fault.largest_m_s, fault.largest_m_s};
}

double prior_of(const FaultPrior& fault) {
    return fault.largest_m_s > 0.0 ? fault.probability : 0.0;
}

/// Prior probability that this source alone is at fault; of no source, that all are sound.
double prior_of(std::span<const SpeedBySource> speeds, const SpeedBySource* at_fault) {
    double product = 1.0;
    for (const SpeedBySource& one : speeds)
        product *= &one == at_fault ? prior_of(one.fault) : 1.0 - prior_of(one.fault);
    return product;
}

/// Where an increasing function reaches a value, between two limits.
template <class Function>
double argument_at(double value, double low, double high, int halvings, const Function& function) {
    for (int halving = 0; halving < halvings; ++halving) {
        const double middle = 0.5 * (low + high);
        (function(middle) < value ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

double SpeedBySource::alone_m_s() const {
    return slow_differs ? std::hypot(own_m_s, slow_m_s) : own_m_s;
}

MeanSpeed mean_of(std::span<const SpeedBySource> speeds, double fault_m_s) {
    const Eigen::Index size = std::ssize(speeds);
    const auto at = [&](Eigen::Index i) -> const SpeedBySource& {
        return speeds[static_cast<std::size_t>(i)];
    };
    const Eigen::MatrixXd slow =
        Eigen::MatrixXd::NullaryExpr(size, size, [&](Eigen::Index i, Eigen::Index k) {
            return square(std::min(at(i).slow_m_s, at(k).slow_m_s));
        });
    Eigen::MatrixXd covariance = slow;
    for (Eigen::Index i = 0; i < size; ++i)
        covariance(i, i) += square(at(i).own_m_s) + square(least_own_m_s);
    covariance(0, 0) += square(fault_m_s);
    // Below zero is rounding.
    Eigen::VectorXd weights = covariance.ldlt().solve(Eigen::VectorXd::Ones(size)).cwiseMax(0.0);
    weights /= weights.sum();
    MeanSpeed mean{.weights = {weights.begin(), weights.end()},
                   .standard_uncertainty_m_s = std::sqrt(weights.dot(covariance * weights)),
                   .slow_m_s = std::sqrt(weights.dot(slow * weights))};
    for (Eigen::Index i = 0; i < size; ++i)
        mean.speed_m_s += weights(i) * at(i).speed_m_s;
    return mean;
}

double over_chance(double sum_of_squares, int degrees_of_freedom) {
    constexpr double by_chance = 1e-3;
    return std::sqrt(sum_of_squares / chi_squared_upper_quantile(by_chance, degrees_of_freedom));
}

double disagreement(std::span<const SpeedBySource> speeds) {
    if (speeds.size() < 2) return 0.0;
    return over_chance(Differences(speeds).sum_of_squares, static_cast<int>(speeds.size()) - 1);
}

std::vector<double> fault_posteriors(std::span<const SpeedBySource> speeds) {
    const Differences differences(speeds);
    std::vector<double> posteriors;
    double sum = prior_of(speeds, nullptr) * std::exp(-0.5 * differences.sum_of_squares);
    for (std::size_t j = 0; j < speeds.size(); ++j) {
        const auto& source = differences.of[j];
        double likelihood = 1.0;
        if (const FaultRange range = range_of(speeds[j].fault);
            source.precision > 0.0 && range.width() > 0.0) {
            const double sigma_m_s = 1.0 / std::sqrt(source.precision);
            likelihood = std::exp(-0.5 * (differences.sum_of_squares -
                                          source.precision * square(source.fault_m_s))) *
                         sigma_m_s * std::sqrt(2.0 * std::numbers::pi) / range.width() *
                         (normal_cdf((range.highest_m_s - source.fault_m_s) / sigma_m_s) -
                          normal_cdf((range.lowest_m_s - source.fault_m_s) / sigma_m_s));
        }
        sum += posteriors.emplace_back(prior_of(speeds, &speeds[j]) * likelihood);
    }
    if (!(sum > 0.0)) {
        posteriors.assign(speeds.size(), 0.0);
        posteriors.front() = 1.0;
        return posteriors;
    }
    for (double& one : posteriors)
        one /= sum;
    return posteriors;
}

SpeedMixture::SpeedMixture(std::span<const SpeedBySource> speeds, double common_m_s)
    : common_m_s_(common_m_s) {
    const Differences differences(speeds);
    const std::vector<double> at_fault = fault_posteriors(speeds);
    const MeanSpeed mean = mean_of(speeds);
    const double sigma_m_s = mean.standard_uncertainty_m_s;
    double sound = 1.0;
    for (std::size_t j = 0; j < speeds.size(); ++j) {
        sound -= at_fault[j];
        if (!(at_fault[j] > 0.0)) continue;
        // Faults beyond `enough` standard deviations do not explain the differences. Their density
        // is constant enough within half a standard deviation of it and of the speed.
        constexpr double enough = 9.0, half = 0.5, most_parts = 4000.0;
        const auto& source = differences.of[j];
        const double of_fault_m_s = 1.0 / std::sqrt(source.precision);
        FaultRange range = range_of(speeds[j].fault);
        range = {std::max(range.lowest_m_s, source.fault_m_s - enough * of_fault_m_s),
                 std::min(range.highest_m_s, source.fault_m_s + enough * of_fault_m_s)};
        if (range.width() <= 0.0) continue;
        const double step_m_s =
            half * std::min(of_fault_m_s, sigma_m_s / std::max(mean.weights[j], least_own_m_s));
        const double parts = std::clamp(std::ceil(range.width() / step_m_s), 1.0, most_parts);
        const double part_m_s = range.width() / parts;
        const std::size_t first = components_.size();
        double sum = 0.0;
        for (double k = 0.5; k < parts; k += 1.0) {
            const double fault_m_s = range.lowest_m_s + k * part_m_s;
            const double weight =
                std::exp(-0.5 * source.precision * square(fault_m_s - source.fault_m_s));
            sum += weight;
            components_.push_back(
                {weight, mean.speed_m_s - mean.weights[j] * fault_m_s,
                 std::hypot(sigma_m_s, mean.weights[j] * part_m_s / std::sqrt(12.0))});
        }
        for (std::size_t k = first; k < components_.size(); ++k)
            components_[k].weight *= sum > 0.0 ? at_fault[j] / sum : 0.0;
    }
    components_.push_back({std::max(0.0, sound), mean.speed_m_s, sigma_m_s});
    // No hypothesis expects such differences: the first source, which is stated, without the
    // others.
    const auto has_weight = [](const Component& one) { return one.weight > 0.0; };
    if (std::ranges::none_of(components_, has_weight))
        *this = SpeedMixture(speeds.first(1), common_m_s);
}

double SpeedMixture::tail(double speed_m_s, double standard_uncertainty_m_s, double sign) const {
    double sum = 0.0;
    for (const Component& one : components_)
        sum += one.weight *
               normal_cdf(sign * (one.mean_m_s - speed_m_s) /
                          std::hypot(one.sigma_m_s, common_m_s_, standard_uncertainty_m_s));
    return std::min(sum, 1.0);
}

double SpeedMixture::probability_not_below(double speed_m_s,
                                           double standard_uncertainty_m_s) const {
    return tail(speed_m_s, standard_uncertainty_m_s, 1.0);
}

double SpeedMixture::probability_below(double speed_m_s, double standard_uncertainty_m_s) const {
    return tail(speed_m_s, standard_uncertainty_m_s, -1.0);
}

double SpeedMixture::quantile(double probability) const {
    double low = components_.front().mean_m_s, high = low;
    for (const Component& one : components_) {
        constexpr double enough = 40.0;
        const double reach = enough * std::hypot(one.sigma_m_s, common_m_s_);
        low = std::min(low, one.mean_m_s - reach);
        high = std::max(high, one.mean_m_s + reach);
    }
    return argument_at(probability, low, high, 100,
                       [&](double speed_m_s) { return probability_below(speed_m_s); });
}

double SpeedMixture::half_width(double speed_m_s, double probability) const {
    constexpr double enough = 10.0;
    double high = 0.0;
    for (const Component& one : components_)
        high = std::max(high, std::abs(one.mean_m_s - speed_m_s) +
                                  enough * std::hypot(one.sigma_m_s, common_m_s_));
    return argument_at(probability, 0.0, high, 50, [&](double half_m_s) {
        return 1.0 - probability_below(speed_m_s - half_m_s) -
               probability_not_below(speed_m_s + half_m_s);
    });
}

}  // namespace runcert

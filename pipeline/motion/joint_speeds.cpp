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

/// Beyond so many standard deviations a normal distribution holds nothing that counts.
constexpr double enough = 10.0;

double square(double x) {
    return x * x;
}

/// Whether a fault of source j moves the speed by source i.
bool moves(std::span<const SpeedBySource> speeds, std::size_t j, std::size_t i) {
    return i == j || (j == 0 && speeds[i].fault_is_common);
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
        for (std::size_t j = 0; j < speeds.size(); ++j) {
            sum_of_squares += weights[j] * square(speeds[j].speed_m_s - mean_m_s);
            double moved = 0.0, score = 0.0, others = 0.0;
            for (std::size_t i = 0; i < speeds.size(); ++i)
                if (moves(speeds, j, i)) {
                    moved += weights[i];
                    score += weights[i] * (speeds[i].speed_m_s - mean_m_s);
                } else {
                    others += weights[i];
                }
            const double precision = moved * others / sum;
            of.push_back(others > 0.0 ? OfSource{precision, score / precision} : OfSource{});
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
    const auto at = [&](Eigen::Index i) { return speeds[static_cast<std::size_t>(i)]; };
    Eigen::MatrixXd slow(size, size), covariance(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index k = 0; k < size; ++k) {
            slow(i, k) = square(std::min(at(i).slow_m_s, at(k).slow_m_s));
            covariance(i, k) = slow(i, k);
            if (i == k) covariance(i, k) += square(at(i).own_m_s) + square(least_own_m_s);
            if ((i == 0 || at(i).fault_is_common) && (k == 0 || at(k).fault_is_common))
                covariance(i, k) += square(fault_m_s);
        }
    std::vector<Eigen::Index> remaining(speeds.size());
    std::iota(remaining.begin(), remaining.end(), Eigen::Index{0});
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(size);
    for (bool found = false; !found;) {
        const Eigen::MatrixXd of_remaining = covariance(remaining, remaining);
        const Eigen::VectorXd inverse =
            of_remaining.ldlt().solve(Eigen::VectorXd::Ones(std::ssize(remaining)));
        Eigen::Index least = 0;
        found = remaining.size() == 1 || inverse.minCoeff(&least) >= 0.0;
        if (found)
            weights(remaining) = inverse / inverse.sum();
        else
            remaining.erase(remaining.begin() + least);
    }
    MeanSpeed mean{.weights = {weights.begin(), weights.end()},
                   .standard_uncertainty_m_s = std::sqrt(weights.dot(covariance * weights)),
                   .slow_m_s = std::sqrt(weights.dot(slow * weights))};
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        mean.speed_m_s += mean.weights[i] * speeds[i].speed_m_s;
        if (moves(speeds, 0, i)) mean.fault_share += mean.weights[i];
    }
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
        const double share = j == 0 ? mean.fault_share : mean.weights[j];
        // Their density is constant enough within half a standard deviation of it and of the speed.
        constexpr double half = 0.5, most_parts = 4000.0;
        const auto& source = differences.of[j];
        const double of_fault_m_s = 1.0 / std::sqrt(source.precision);
        FaultRange range = range_of(speeds[j].fault);
        range = {std::max(range.lowest_m_s, source.fault_m_s - enough * of_fault_m_s),
                 std::min(range.highest_m_s, source.fault_m_s + enough * of_fault_m_s)};
        if (range.width() <= 0.0) continue;
        const double step_m_s =
            half * std::min(of_fault_m_s, sigma_m_s / std::max(share, least_own_m_s));
        const double parts = std::clamp(std::ceil(range.width() / step_m_s), 1.0, most_parts);
        const double part_m_s = range.width() / parts;
        const std::size_t first = components_.size();
        double sum = 0.0;
        for (double k = 0.5; k < parts; k += 1.0) {
            const double fault_m_s = range.lowest_m_s + k * part_m_s;
            const double weight =
                std::exp(-0.5 * source.precision * square(fault_m_s - source.fault_m_s));
            sum += weight;
            components_.push_back({weight, mean.speed_m_s - share * fault_m_s,
                                   std::hypot(sigma_m_s, share * part_m_s / std::sqrt(12.0))});
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
        const double reach = enough * std::hypot(one.sigma_m_s, common_m_s_);
        low = std::min(low, one.mean_m_s - reach);
        high = std::max(high, one.mean_m_s + reach);
    }
    return argument_at(probability, low, high, 100,
                       [&](double speed_m_s) { return probability_below(speed_m_s); });
}

double SpeedMixture::half_width(double speed_m_s, double probability) const {
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

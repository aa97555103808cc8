#include "motion/speed_mixture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/statistics.h"

namespace runcert {
namespace {

double density(double x, double sigma) {
    const double z = x / sigma;
    return std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * std::numbers::pi));
}

struct FaultRange {
    double lowest_m_s = 0.0, highest_m_s = 0.0;
    double width() const { return highest_m_s - lowest_m_s; }
};

FaultRange range_of(const FaultPrior& fault) {
    return {fault.upwards_alone ? 0.0 : -fault.largest_m_s, fault.largest_m_s};
}

bool is_possible(const FaultPrior& fault) {
    return fault.probability > 0.0 && fault.largest_m_s > 0.0;
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

/// Divides a range into equal parts of at most `step_m_s`, unless there would be too many. Calls
/// `call` with the fault in the middle of each part and the standard deviation of the faults within
/// it.
template <class Call>
void for_parts(const FaultRange& range, double step_m_s, const Call& call) {
    constexpr double most = 4000.0;
    const double count = std::clamp(std::ceil(range.width() / step_m_s), 1.0, most);
    const double part_m_s = range.width() / count;
    for (double k = 0.0; k < count; k += 1.0)
        call(range.lowest_m_s + (k + 0.5) * part_m_s, part_m_s / std::sqrt(12.0), 1.0 / count);
}

}  // namespace

SpeedMixture::SpeedMixture(const SpeedBySource& positions,
                           const std::optional<SpeedBySource>& witness, double shared_m_s)
    : shared_m_s_(shared_m_s) {
    const double of_positions = is_possible(positions.fault) ? positions.fault.probability : 0.0;
    if (!witness) {
        positions_at_fault_ = of_positions;
        add_alone(positions, 1.0);
        return;
    }
    const double of_witness = is_possible(witness->fault) ? witness->fault.probability : 0.0;
    const double p2 = std::pow(positions.standard_uncertainty_m_s, 2);
    const double w2 = std::pow(witness->standard_uncertainty_m_s, 2);
    const double sigma = std::sqrt(p2 + w2);
    const double difference = positions.speed_m_s - witness->speed_m_s;
    components_.push_back(
        {.weight = (1.0 - of_positions) * (1.0 - of_witness) * density(difference, sigma),
         .mean_m_s = positions.speed_m_s - p2 / (p2 + w2) * difference,
         .sigma_m_s = std::sqrt(p2 * w2 / (p2 + w2))});
    if (of_positions > 0.0) add_positions_at_fault(positions, *witness);
    double faulty = 0.0;
    for (std::size_t k = 1; k < components_.size(); ++k)
        faulty += components_[k].weight *= 1.0 - of_witness;
    double by_witness = 0.0;
    if (of_witness > 0.0) {
        const auto [low, high] = range_of(witness->fault);
        by_witness =
            of_witness * (1.0 - of_positions) *
            (normal_cdf((high + difference) / sigma) - normal_cdf((low + difference) / sigma)) /
            (high - low);
        components_.push_back({.weight = by_witness,
                               .mean_m_s = positions.speed_m_s,
                               .sigma_m_s = positions.standard_uncertainty_m_s});
    }
    double sum = 0.0;
    for (const Component& one : components_)
        sum += one.weight;
    // No hypothesis expects such a difference. One of the two is wrong, and which one is unknown.
    if (!(sum > 0.0)) {
        components_.clear();
        positions_at_fault_ = 1.0;
        add_alone(positions, 1.0);
        return;
    }
    positions_at_fault_ = faulty / sum;
    witness_at_fault_ = by_witness / sum;
    for (Component& one : components_)
        one.weight /= sum;
}

void SpeedMixture::add_alone(const SpeedBySource& positions, double weight) {
    const double faulty = is_possible(positions.fault) ? positions.fault.probability : 0.0;
    const double sigma = positions.standard_uncertainty_m_s;
    components_.push_back(
        {.weight = weight * (1.0 - faulty), .mean_m_s = positions.speed_m_s, .sigma_m_s = sigma});
    if (faulty == 0.0) return;
    for_parts(range_of(positions.fault), 0.5 * sigma,
              [&](double fault_m_s, double spread_m_s, double part) {
                  components_.push_back({.weight = weight * faulty * part,
                                         .mean_m_s = positions.speed_m_s - fault_m_s,
                                         .sigma_m_s = std::hypot(sigma, spread_m_s)});
              });
}

void SpeedMixture::add_positions_at_fault(const SpeedBySource& positions,
                                          const SpeedBySource& witness) {
    const double p = positions.standard_uncertainty_m_s, w = witness.standard_uncertainty_m_s;
    const double sigma = std::hypot(p, w);
    const double difference = positions.speed_m_s - witness.speed_m_s;
    // Faults beyond this many standard deviations do not explain the difference.
    constexpr double enough = 9.0;
    const FaultRange whole = range_of(positions.fault);
    const FaultRange range{std::max(whole.lowest_m_s, difference - enough * sigma),
                           std::min(whole.highest_m_s, difference + enough * sigma)};
    if (range.width() <= 0.0) return;
    const double prior = positions.fault.probability * range.width() / whole.width();
    for_parts(
        range, 0.5 * std::min(sigma, p * sigma / w),
        [&](double fault_m_s, double spread_m_s, double part) {
            const double rest = difference - fault_m_s;
            components_.push_back(
                {.weight = prior * part * density(rest, sigma),
                 .mean_m_s = positions.speed_m_s - fault_m_s - p * p / (sigma * sigma) * rest,
                 .sigma_m_s = std::hypot(p * w / sigma, spread_m_s * w * w / (sigma * sigma))});
        });
}

double SpeedMixture::tail(double speed_m_s, double standard_uncertainty_m_s, double sign) const {
    double sum = 0.0;
    for (const Component& one : components_)
        sum += one.weight *
               normal_cdf(sign * (one.mean_m_s - speed_m_s) /
                          std::hypot(one.sigma_m_s, shared_m_s_, standard_uncertainty_m_s));
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
        const double reach = enough * std::hypot(one.sigma_m_s, shared_m_s_);
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
                                  enough * std::hypot(one.sigma_m_s, shared_m_s_));
    return argument_at(probability, 0.0, high, 50, [&](double half_m_s) {
        return 1.0 - probability_below(speed_m_s - half_m_s) -
               probability_not_below(speed_m_s + half_m_s);
    });
}

}  // namespace runcert

#include "satellites/phase_subsets.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/statistics.h"

namespace runcert {
namespace {

/// Slips are compared with the Doppler shift, and with whole cycles, to within this many standard
/// deviations.
constexpr double doppler_deviations = 4.5;
constexpr double doppler_tolerance_cycles = 0.7;
constexpr double whole_deviations = 3.3;
/// A slip is known to be whole cycles only where its standard deviation, in cycles, is below this.
constexpr double whole_sigma_cycles = 0.2;
/// Below this share of a satellite's own variance, the residuals show nothing of it.
constexpr double least_redundancy = 1e-4;

constexpr int most_in_set = 3;
using Slips = std::vector<EstimatedSlip>;
using SetVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_in_set, 1>;
using SetMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_in_set, most_in_set>;

/// The whitened residuals of a displacement, and how they depend on the errors.
class Residuals {
  public:
    explicit Residuals(const PhaseDisplacement& displacement)
        : displacement_(displacement),
          whitened_(displacement.residuals_m.cwiseQuotient(displacement.sigma_m)),
          gain_(displacement.design *
                (displacement.design.transpose() * displacement.design).inverse()) {}

    /// The slips of these satellites, if only they slipped and the others pass the test without
    /// them. With slips in the model, the squared norm of the residuals falls by w' R^-1 w. Here w
    /// holds the residuals of the set and R its block of their covariance. R^-1 w are the slips.
    std::optional<std::vector<EstimatedSlip>> explain(std::span<const std::size_t> set,
                                                      std::span<const PhaseHint> hints,
                                                      const ChiSquaredBounds& bounds) const {
        const auto size = static_cast<Eigen::Index>(set.size());
        SetMatrix left(size, size);
        SetVector own(size);
        for (Eigen::Index i = 0; i < size; ++i) {
            const auto row = static_cast<Eigen::Index>(set[static_cast<std::size_t>(i)]);
            own[i] = whitened_[row];
            for (Eigen::Index j = 0; j < size; ++j) {
                const auto column = static_cast<Eigen::Index>(set[static_cast<std::size_t>(j)]);
                left(i, j) =
                    (i == j ? 1.0 : 0.0) - gain_.row(row).dot(displacement_.design.row(column));
            }
        }
        const Eigen::LDLT<SetMatrix> solver(left);
        if (solver.vectorD().minCoeff() < least_redundancy) return std::nullopt;
        const SetVector slips = solver.solve(own);
        if (displacement_.statistic - own.dot(slips) >
            bounds(displacement_.redundancy - static_cast<int>(size)))
            return std::nullopt;
        const SetMatrix covariance = solver.solve(SetMatrix::Identity(size, size));
        std::vector<EstimatedSlip> estimated;
        for (Eigen::Index i = 0; i < size; ++i) {
            const std::size_t satellite = set[static_cast<std::size_t>(i)];
            const double in_cycles = displacement_.sigma_m[static_cast<Eigen::Index>(satellite)] /
                                     hints[satellite].wavelength_m;
            estimated.push_back({.satellite = satellite,
                                 .cycles = slips[i] * in_cycles,
                                 .sigma_cycles = std::sqrt(covariance(i, i)) * in_cycles});
        }
        return estimated;
    }

  private:
    const PhaseDisplacement& displacement_;
    PhaseVector whitened_;
    PhaseDesign gain_;
};

/// Whether the Doppler shift of a satellite contradicts a slip of this many cycles. With weak
/// signals it deviates by far more than its usual standard deviation.
bool contradicts(const PhaseHint& hint, double cycles, double sigma_cycles,
                 double doppler_sigma_cycles) {
    return hint.beyond_doppler_cycles &&
           std::abs(*hint.beyond_doppler_cycles - cycles) >
               std::max(doppler_tolerance_cycles,
                        doppler_deviations * std::hypot(doppler_sigma_cycles, sigma_cycles));
}

/// Removes the candidates that the Doppler shifts contradict, judged at every satellite that this
/// candidate or another says has slipped.
void compare_with_doppler(std::vector<Slips>& candidates, std::span<const PhaseHint> hints,
                          double doppler_sigma_cycles) {
    std::set<std::size_t> suspects;
    for (const Slips& slips : candidates)
        for (const EstimatedSlip& slip : slips)
            suspects.insert(slip.satellite);
    std::erase_if(candidates, [&](const Slips& slips) {
        return std::ranges::any_of(suspects, [&](std::size_t satellite) {
            const auto mine = std::ranges::find(slips, satellite, &EstimatedSlip::satellite);
            const bool slipped = mine != slips.end();
            return contradicts(hints[satellite], slipped ? mine->cycles : 0.0,
                               slipped ? mine->sigma_cycles : 0.0, doppler_sigma_cycles);
        });
    });
}

bool are_whole(std::span<const EstimatedSlip> slips) {
    return std::ranges::all_of(slips, [](const EstimatedSlip& slip) {
        const double whole = std::round(slip.cycles);
        return whole != 0.0 && slip.sigma_cycles < whole_sigma_cycles &&
               std::abs(slip.cycles - whole) <= whole_deviations * slip.sigma_cycles;
    });
}

/// Advances a set of ascending numbers below `count` to the next set of its size. Returns false
/// after the last.
bool step_set(std::vector<std::size_t>& set, std::size_t count) {
    for (std::size_t i = set.size(); i-- > 0;) {
        if (set[i] + (set.size() - i) >= count) continue;
        ++set[i];
        for (std::size_t j = i + 1; j < set.size(); ++j)
            set[j] = set[j - 1] + 1;
        return true;
    }
    return false;
}

}  // namespace

ChiSquaredBounds::ChiSquaredBounds(double probability) {
    for (std::size_t i = 1; i < bounds_.size(); ++i)
        bounds_[i] = chi_squared_upper_quantile(probability, static_cast<int>(i));
}

bool are_small(std::span<const EstimatedSlip> slips) {
    return std::ranges::all_of(slips, [](const EstimatedSlip& slip) {
        return std::abs(slip.cycles) + whole_deviations * slip.sigma_cycles < 0.5;
    });
}

std::optional<std::vector<EstimatedSlip>> slips_of_set(const PhaseDisplacement& displacement,
                                                       std::span<const PhaseHint> hints,
                                                       std::span<const std::size_t> set,
                                                       const ChiSquaredBounds& bounds) {
    if (set.empty() || set.size() > most_in_set ||
        displacement.redundancy - static_cast<int>(set.size()) < 1)
        return std::nullopt;
    return Residuals(displacement).explain(set, hints, bounds);
}

SlipSearch find_slips(const PhaseDisplacement& displacement, std::span<const PhaseHint> hints,
                      const ChiSquaredBounds& bounds, double doppler_sigma_cycles) {
    const Residuals residuals(displacement);
    // With more satellites than are ever in view, there are too many sets of three.
    const std::size_t most = hints.size() > 48 ? 2 : most_in_set;
    for (std::size_t size = 1; size <= most; ++size) {
        if (displacement.redundancy - static_cast<int>(size) < 1) break;
        std::vector<Slips> candidates;
        std::vector<std::size_t> set(size);
        for (std::size_t i = 0; i < size; ++i)
            set[i] = i;
        do {
            if (auto explained = residuals.explain(set, hints, bounds))
                candidates.push_back(std::move(*explained));
        } while (step_set(set, hints.size()));
        if (candidates.empty()) continue;
        if (std::ranges::all_of(candidates, [](const Slips& slips) { return are_small(slips); }))
            return {.outcome = SlipSearch::Outcome::disturbed};
        compare_with_doppler(candidates, hints, doppler_sigma_cycles);
        if (candidates.size() > 1)
            std::erase_if(candidates, [](const Slips& slips) { return !are_whole(slips); });
        // Several candidates cannot be distinguished, and larger sets would explain even more.
        if (candidates.size() != 1) break;
        return {.outcome = SlipSearch::Outcome::slipped, .slips = std::move(candidates.front())};
    }
    return {};
}

std::vector<double> slip_deviations_m(const PhaseDisplacement& displacement) {
    const PhaseDesign& design = displacement.design;
    const Eigen::Matrix4d inverse = (design.transpose() * design).inverse();
    std::vector<double> deviations_m;
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
        const double left = 1.0 - design.row(i) * inverse * design.row(i).transpose();
        deviations_m.push_back(left > least_redundancy ? displacement.sigma_m[i] / std::sqrt(left)
                                                       : std::numeric_limits<double>::infinity());
    }
    return deviations_m;
}

}  // namespace runcert

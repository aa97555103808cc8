#include "stages/smooth/robust.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "motion/chain.h"
#include "stages/smooth/batch_problem.h"

namespace runcert {
namespace {

/// The last step moves no more than 1e-5 standard deviations of the weighted measurements, over all
/// of them. The remainder of Newton's method is smaller still, and is less than the table shows.
constexpr double square_of_a_last_step = 1e-10;
/// Where the allowed iterations are used up, a tenth of a standard deviation may remain.
constexpr double square_left_at_last = 1e-2;
/// Rounding of the coordinates hides smaller changes of the cost, relative to it.
constexpr double rounding_of_cost = 1e-10;
/// The loss of a distant measurement has negative curvature, which no measurement has. This
/// fraction of the weight stands for smaller ones. It leaves the local steps too short, never too
/// long.
constexpr double least_curvature = 0.1;
constexpr double shortest = 0.1;  // step, before a reweighted one

/// A square along a step, or a sum of such.
struct Square {
    double value = 0.0;
    double falls = 0.0;  ///< minus half its first derivative at the beginning
    double curvature = 0.0;

    double after(double length) const {
        return value - length * (2.0 * falls - length * curvature);
    }
};

/// A measurement at the current states, and what a whole step would change. Positions are in m.
template <int Axes>
struct Residual {
    std::size_t k = 0;
    PositionMatrix<Axes> whitener;
    PositionVector<Axes> error;                                  ///< measured minus estimated
    PositionVector<Axes> change = PositionVector<Axes>::Zero();  ///< of the estimated position
    Square square = {};  ///< of the error, in standard deviations of the measurement
    double weight = 1.0;
    double curvature = 1.0;  ///< along the error, as a fraction of the weight
};

template <int Axes>
PositionVector<Axes> observed(const StateVector<Axes>& state) {
    return state.template head<Axes>() + state.template tail<Axes>();
}

/// The robust problem of one section.
template <int Axes>
class RobustSection {
  public:
    RobustSection(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model, double scale,
                  std::span<const StateVector<Axes>> start)
        : arc_(arc),
          model_(model),
          scale_squared_(scale * scale),
          replaced_(arc.begin(), arc.end()) {
        for (std::size_t k = 0; k < arc.size(); ++k)
            if (const auto& measured = arc[k].measurement)
                residuals_.push_back({.k = k,
                                      .whitener = whitener<Axes>(*measured, model),
                                      .error = measured->position - observed<Axes>(start[k])});
    }

    std::int64_t passes() const { return passes_; }
    StateVector<Axes> state(std::size_t k) const { return chain_.mean(k); }

    /// Whether it ended. Each pass is one chain, which minimises the squares of process noise and
    /// of the replacing measurements. Their sum, less those of the measurements, is the part of the
    /// process noise. It is quadratic along the step, so that the cost after any part of a step
    /// needs no further pass.
    bool solve(std::int64_t passes_allowed) {
        if (!go(0.0)) return false;
        bool by_curvature = false;
        double process = -HUGE_VAL;  // known after the first step, which need not be judged
        double left = 0.0;
        while (passes_ < passes_allowed) {
            ++passes_;
            replace_measurements(by_curvature);
            chain_ = ChainMeans<Axes>(replaced_, model_);
            const Square measured = take_changes();
            const double least = chain_.innovation_sum();
            left = measured.curvature;
            // The whole gain holds the part of the measurements, though rounding may hide it.
            const double gain = std::max(process + measured.value - least, left);
            const auto process_after = [&](double length) {
                return least + (1.0 - length) * (1.0 - length) * gain - measured.after(length);
            };
            const auto cost_after = [&](double length) {
                return process_after(length) + loss_after(length);
            };
            double length = 1.0;
            const bool near = left <= square_of_a_last_step;
            if (by_curvature && !near) {
                const double allowed = (process + loss_after(0.0)) * (1.0 + rounding_of_cost);
                double then = cost_after(length);
                while (length > shortest && !(then <= allowed))
                    then = cost_after(length *= 0.5);
                by_curvature = then <= allowed;
                if (!by_curvature) continue;
                if (length == 1.0 && cost_after(2.0) < then) length = 2.0;
            }
            process = process_after(length);
            if (!go(length)) return false;
            if (near) return true;
            by_curvature = true;
        }
        // No step has raised the cost. What counts is how much is left, not how many it took.
        return left <= square_left_at_last;
    }

  private:
    /// Goes a part of the step. Returns whether the errors are numbers.
    bool go(double length) {
        bool finite = true;
        for (Residual<Axes>& one : residuals_) {
            one.error -= length * one.change;
            one.square.value = (one.whitener * one.error).squaredNorm();
            finite = finite && std::isfinite(one.square.value);
        }
        return finite;
    }

    /// Replaces each measurement by that whose square has the slope of the loss at the current
    /// error e: of weight w, and along e of curvature c w, it is at e / c. By the weight alone c
    /// is 1. The first one stays where it was measured, because the vague prior does.
    void replace_measurements(bool by_curvature) {
        const double variance = model_.measurement_scale * model_.measurement_scale;
        for (Residual<Axes>& one : residuals_) {
            const double square = one.square.value / scale_squared_;
            one.weight = 1.0 / (1.0 + square);
            one.curvature = 1.0;
            PositionMeasurement<Axes>& by = *replaced_[one.k].measurement;
            by = *arc_[one.k].measurement;
            if (by_curvature && one.k > 0 && square > 0.0) {
                one.curvature = std::max(one.weight * (1.0 - square), least_curvature);
                const double more = 1.0 / one.curvature - 1.0;
                by.position += more * one.error;
                by.covariance +=
                    (more / (one.square.value * variance)) * one.error * one.error.transpose();
            }
            by.covariance /= one.weight;
        }
    }

    /// Sets the changes that the chain makes. Returns the sum of the replacing measurements'
    /// squares.
    Square take_changes() {
        Square sum;
        for (Residual<Axes>& one : residuals_) {
            one.change = observed<Axes>(chain_.mean(one.k)) -
                         (arc_[one.k].measurement->position - one.error);
            const PositionVector<Axes> change = one.whitener * one.change;
            Square& square = one.square;
            square.falls = change.dot(one.whitener * one.error);
            square.curvature = change.squaredNorm();
            sum.value += one.weight * square.value / one.curvature;
            sum.falls += one.weight * square.falls;
            sum.curvature += one.weight * square.curvature;
            if (one.curvature < 1.0)
                sum.curvature -=
                    one.weight * (1.0 - one.curvature) * square.falls * square.falls / square.value;
        }
        return sum;
    }

    double loss_after(double length) const {
        double sum = 0.0;
        for (const Residual<Axes>& one : residuals_)
            sum += std::log1p(one.square.after(length) / scale_squared_);
        return scale_squared_ * sum;
    }

    std::span<const ArcEpoch<Axes>> arc_;
    EstimationModel model_;
    double scale_squared_;
    std::vector<ArcEpoch<Axes>> replaced_;
    std::vector<Residual<Axes>> residuals_;
    ChainMeans<Axes> chain_;
    std::int64_t passes_ = 0;
};

}  // namespace

template <int Axes>
RobustSolution<Axes> solve_robust(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                  double scale, std::span<const StateVector<Axes>> start,
                                  std::span<const ArcSection> sections,
                                  std::int64_t passes_allowed) {
    assert(start.size() == arc.size() && scale > 0.0);
    RobustSolution<Axes> solution;
    solution.states.resize(arc.size());
    solution.weights.resize(arc.size());
    const auto passes = results_of(std::ssize(sections), threads_allowed(), [&](std::int64_t i) {
        const ArcSection& section = sections[static_cast<std::size_t>(i)];
        const std::size_t from = section.used_first;
        const std::size_t count = section.used_end - from;
        RobustSection<Axes> robust(arc.subspan(from, count), model, scale,
                                   start.subspan(from, count));
        if (!robust.solve(passes_allowed)) return std::int64_t{-1};
        for (std::size_t k = section.first; k < section.end; ++k) {
            solution.states[k] = robust.state(k - from);
            if (!arc[k].measurement) continue;
            const double square =
                whitened_residual<Axes>(*arc[k].measurement, model, solution.states[k])
                    .squaredNorm();
            solution.weights[k] = 1.0 / (1.0 + square / (scale * scale));
        }
        return robust.passes();
    });
    for (const std::int64_t of_section : passes) {
        if (of_section < 0) return {.states = {}, .weights = {}, .converged = false};
        solution.passes += of_section;
    }
    return solution;
}

template RobustSolution<1> solve_robust<1>(std::span<const ArcEpoch<1>>, const EstimationModel&,
                                           double, std::span<const StateVector<1>>,
                                           std::span<const ArcSection>, std::int64_t);
template RobustSolution<2> solve_robust<2>(std::span<const ArcEpoch<2>>, const EstimationModel&,
                                           double, std::span<const StateVector<2>>,
                                           std::span<const ArcSection>, std::int64_t);

}  // namespace runcert

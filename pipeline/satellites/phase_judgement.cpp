#include "satellites/phase_judgement.h"

#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

constexpr double least_geometry_free_m = 0.05;
constexpr double geometry_free_deviations = 4.5;
constexpr std::size_t fewest_satellites = 5;
/// With this standard deviation or less, a slip of one cycle is detected with probability 0.98 by a
/// test of size 0.001 with two degrees of freedom. The same limit holds for the Doppler shift.
constexpr double control_cycles = 0.18;
/// More satellites than this always control one another.
constexpr std::size_t most_to_control = 14;

class Judge {
  public:
    Judge(const PhasePairs& phases, std::size_t epoch, const PhaseNoiseFigures& noise,
          const ChiSquaredBounds& bounds)
        : phases_(phases),
          epoch_(epoch),
          noise_(noise),
          bounds_(bounds),
          pairs_(phases.at(epoch)),
          doppler_(phases.beyond_doppler_cycles(pairs_, phases.step_s(epoch))) {
        for (const PhasePair& pair : pairs_)
            parted_m_.push_back(std::abs(phases.geometry_free_change_m(pair)));
    }

    PairOutcome judge(bool has_position) {
        if (!pairs_.empty()) {
            if (!has_position)
                refuse(RefusalReason::no_place);
            else
                test();
        }
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            if (is_parted(i)) outcome_.second_broken.insert(pairs_[i].now->id);
        return std::move(outcome_);
    }

  private:
    bool is_parted(std::size_t i) const {
        return parted_m_[i] > geometry_free_bound_m(noise_, pairs_[i].now->sine_of_elevation);
    }

    void refuse(RefusalReason reason, double statistic = 0.0, double threshold = 0.0) {
        outcome_.refusal = PhaseRefusal{.epoch = epoch_,
                                        .reason = reason,
                                        .satellites = pairs_.size(),
                                        .statistic = statistic,
                                        .threshold = threshold};
    }

    std::optional<PhaseDisplacement> displacement() const {
        if (pairs_.size() < fewest_satellites || pairs_.size() > most_phase_changes)
            return std::nullopt;
        return phases_.displacement(epoch_, pairs_, {.white_m = noise_.white_m});
    }

    void remove(std::size_t i) {
        const auto at = static_cast<std::ptrdiff_t>(i);
        pairs_.erase(pairs_.begin() + at);
        doppler_.erase(doppler_.begin() + at);
        parted_m_.erase(parted_m_.begin() + at);
    }

    void test() {
        auto solution = displacement();
        if (!solution) return refuse(RefusalReason::few_satellites);
        outcome_.is_judged = true;
        const double statistic = solution->statistic;
        const double threshold = bounds_(solution->redundancy);
        if (statistic <= threshold) return require_control(*solution);
        if (parted_explain(*solution)) return;
        if (remove_parted()) solution = displacement();
        if (!solution) return refuse(RefusalReason::few_satellites, statistic, threshold);
        if (solution->statistic > bounds_(solution->redundancy)) search(*solution);
    }

    std::vector<PhaseHint> hints() const {
        std::vector<PhaseHint> all;
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            all.push_back(
                {.wavelength_m = pairs_[i].wavelength_m, .beyond_doppler_cycles = doppler_[i]});
        return all;
    }

    /// Whether the satellites whose bands diverged are those that slipped. The others determine the
    /// size of their slips.
    bool parted_explain(const PhaseDisplacement& solution) {
        std::vector<std::size_t> set;
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            if (is_parted(i)) set.push_back(i);
        const auto slips = slips_of_set(solution, hints(), set, bounds_);
        if (!slips || are_small(*slips)) return false;
        add_sized(*slips, [&](std::size_t i) -> PhaseSlip& { return add_parted(i); });
        return true;
    }

    /// Adds slips and their sizes, in ascending order of satellites, and removes these satellites.
    template <class Add>
    void add_sized(const std::vector<EstimatedSlip>& slips, const Add& add) {
        for (std::size_t i = slips.size(); i-- > 0;) {
            PhaseSlip& slip = add(slips[i].satellite);
            slip.cycles = slips[i].cycles;
            slip.sigma_cycles = slips[i].sigma_cycles;
            remove(slips[i].satellite);
        }
    }

    /// Removes the satellites whose bands diverged. Returns false if there are none.
    bool remove_parted() {
        bool any = false;
        for (std::size_t i = pairs_.size(); i-- > 0;) {
            if (!is_parted(i)) continue;
            add_parted(i);
            remove(i);
            any = true;
        }
        return any;
    }

    PhaseSlip& add_parted(std::size_t i) {
        PhaseSlip& slip = add_slip(i, PhaseBreak::geometry_free);
        slip.statistic = parted_m_[i];
        slip.threshold = geometry_free_bound_m(noise_, pairs_[i].now->sine_of_elevation);
        return slip;
    }

    PhaseSlip& add_slip(std::size_t i, PhaseBreak test) {
        PhaseSlip& slip = outcome_.slips.emplace_back();
        slip.signal = pairs_[i].signals_now.first;
        slip.epoch = epoch_;
        slip.test = test;
        slip.beyond_doppler_cycles = doppler_[i];
        outcome_.broken[pairs_[i].now->id] = test;
        return slip;
    }

    void search(const PhaseDisplacement& solution) {
        const SlipSearch found =
            find_slips(solution, hints(), bounds_, noise_.doppler_cycles.value_or(1.0));
        const double threshold = bounds_(solution.redundancy);
        switch (found.outcome) {
            case SlipSearch::Outcome::disturbed:
                outcome_.disturbed = DisturbedPair{
                    .epoch = epoch_, .statistic = solution.statistic, .threshold = threshold};
                return;
            case SlipSearch::Outcome::unknown:
                return refuse(RefusalReason::no_single_set, solution.statistic, threshold);
            case SlipSearch::Outcome::slipped:
                break;
        }
        add_sized(found.slips, [&](std::size_t i) -> PhaseSlip& {
            PhaseSlip& slip = add_slip(i, PhaseBreak::displacement);
            slip.statistic = solution.statistic;
            slip.threshold = threshold;
            return slip;
        });
    }

    /// Whether Doppler or a second band shows that no cycle slipped.
    bool is_controlled_otherwise(std::size_t i) const {
        const bool by_doppler = noise_.doppler_cycles.value_or(1.0) <= control_cycles;
        if (by_doppler && doppler_[i] && std::abs(*doppler_[i]) < 0.5) return true;
        return parted_m_[i] == parted_m_[i] && !is_parted(i);
    }

    /// Ends the arcs of satellites for which nothing could have shown a slip of one cycle.
    void require_control(const PhaseDisplacement& solution) {
        if (pairs_.size() > most_to_control) return;
        const std::vector<double> deviations_m = slip_deviations_m(solution);
        for (std::size_t i = 0; i < pairs_.size(); ++i)
            if (deviations_m[i] > control_cycles * pairs_[i].wavelength_m &&
                !is_controlled_otherwise(i))
                outcome_.broken[pairs_[i].now->id] = PhaseBreak::uncontrolled;
    }

    const PhasePairs& phases_;
    std::size_t epoch_;
    const PhaseNoiseFigures& noise_;
    const ChiSquaredBounds& bounds_;
    std::vector<PhasePair> pairs_;  ///< those still in use
    std::vector<std::optional<double>> doppler_;
    std::vector<double> parted_m_;  ///< change of the geometry-free difference; may be NaN
    PairOutcome outcome_;
};

}  // namespace

double zenith_factor(double sine_of_elevation) {
    return std::sqrt(1.0 + 1.0 / (sine_of_elevation * sine_of_elevation));
}

double geometry_free_bound_m(const PhaseNoiseFigures& noise, double sine_of_elevation) {
    return std::max(least_geometry_free_m, geometry_free_deviations *
                                               noise.geometry_free_m.value_or(0.0) *
                                               zenith_factor(sine_of_elevation));
}

PairOutcome judge_pair(const PhasePairs& phases, std::size_t epoch, bool has_position,
                       const PhaseNoiseFigures& noise, const ChiSquaredBounds& bounds) {
    return Judge(phases, epoch, noise, bounds).judge(has_position);
}

}  // namespace runcert

#include "stages/screen/adaptation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/statistics.h"

namespace runcert {
namespace {

// An error of which the data tell less than this has no test: the vague prior would decide it.
constexpr double largest_sigma_m = 20.0;
constexpr double largest_sigma_mps = 20.0;
constexpr double largest_sigma_s = 1.0;
constexpr std::size_t local_epochs = 100;  // on each side
constexpr std::int64_t passes_max = 200;

struct Candidate {
    double log_tail = 0.0;
    Hypothesis hypothesis = Hypothesis::outlier;
    std::size_t first = 0;
    std::size_t last = 0;
    double statistic = 0.0;
    int degrees_of_freedom = 1;
};

/// Simpler hypotheses first; of two that say the same, the simpler is taken.
int complexity(const Candidate& candidate) {
    switch (candidate.hypothesis) {
        case Hypothesis::outlier:
            return 0;
        case Hypothesis::step:
            return 1;
        case Hypothesis::burst:
            return 2;
        case Hypothesis::time_shift:
            return 3;
        default:
            return 4;
    }
}

/// The tests of one stretch under the decisions so far.
template <int Axes>
class StretchTests {
  public:
    StretchTests(const TestedStretch<Axes>& stretch, const EstimationModel& model,
                 const TestPlan& plan)
        : stretch_(stretch),
          plan_(plan),
          diagnosis_(stretch.epochs, model),
          factors_(local_variance_factors(diagnosis_)) {}

    const ArcDiagnosis<Axes>& diagnosis() const { return diagnosis_; }

    EstimatedError estimate_of(const Candidate& candidate) const {
        switch (candidate.hypothesis) {
            case Hypothesis::outlier:
                return estimated_error(diagnosis_.outlier(candidate.first));
            case Hypothesis::step:
                return estimated_error(diagnosis_.step(candidate.first));
            case Hypothesis::ramp:
                return estimated_rate(diagnosis_.ramp(candidate.first));
            case Hypothesis::time_shift:
                return estimated_time(diagnosis_.time_shift(candidate.first).value());
            default:
                return {};  // each epoch of a burst has its own, once it is left out
        }
    }

    double factor(std::size_t k) const { return factors_[k]; }

    double sigma_rate_of(const Candidate& candidate) const {
        if (candidate.hypothesis != Hypothesis::ramp) return 0.0;
        return std::sqrt(diagnosis_.ramp(candidate.first).covariance().trace());
    }

    /// Every hypothesis whose test rejects the model.
    std::vector<Candidate> candidates() const {
        std::vector<Candidate> found;
        const auto& epochs = stretch_.epochs;
        for (std::size_t k = 0; k < epochs.size(); ++k) {
            if (!epochs[k].measurement) continue;
            consider(diagnosis_.outlier(k), largest_sigma_m, Hypothesis::outlier, k, k, found);
            if (k == 0) continue;
            if (!epochs[k].step_before) {
                consider(diagnosis_.step(k), largest_sigma_m, Hypothesis::step, k, k, found);
                if constexpr (Axes == 2)
                    if (const auto test = diagnosis_.time_shift(k))
                        consider(*test, largest_sigma_s, Hypothesis::time_shift, k, k, found);
            }
            consider(diagnosis_.ramp(k), largest_sigma_mps, Hypothesis::ramp, k, k, found);
        }
        diagnosis_.for_each_burst(plan_.burst_epochs_max(), [&](std::size_t k, std::size_t length,
                                                                const ScoreTest<Axes>& test) {
            consider(test, largest_sigma_m, Hypothesis::burst, k, k + length - 1, found);
        });
        return found;
    }

    /// The set of neighbouring epochs, each with an error of its own, that is better supported
    /// than the candidate; the candidate itself if there is none. Grows from the candidate's epochs
    /// to whichever side gains more.
    Candidate best_set(const Candidate& candidate) const {
        const double factor = factors_[candidate.first];
        Candidate best = set_of(candidate.first, candidate.last, factor);
        Candidate grown = best;
        // Some growth without a gain is looked over: an epoch between two wrong ones may be good.
        constexpr int patience = 3;
        for (int without_gain = 0; without_gain < patience;) {
            if (grown.last - grown.first + 1 >= plan_.burst_epochs_max()) break;
            std::optional<Candidate> next;
            if (grown.first > 0) next = set_of(grown.first - 1, grown.last, factor);
            if (grown.last + 1 < stretch_.epochs.size()) {
                const Candidate right = set_of(grown.first, grown.last + 1, factor);
                if (!next || right.log_tail < next->log_tail) next = right;
            }
            if (!next) break;
            grown = *next;
            without_gain = grown.log_tail < best.log_tail ? 0 : without_gain + 1;
            if (without_gain == 0) best = grown;
        }
        return best.log_tail < candidate.log_tail ? best : candidate;
    }

    /// The shortest span whose innovations are together too large, the worst of that length.
    std::optional<Candidate> failing_span() const {
        for (const std::size_t length : span_lengths) {
            std::optional<Candidate> worst;
            double sum = 0.0;
            std::vector<std::pair<std::size_t, double>> window;  // epochs with an innovation
            std::size_t begin = 0;
            for (std::size_t k = 0; k < diagnosis_.size(); ++k) {
                const auto innovation = diagnosis_.innovation(k);
                if (!innovation) continue;
                window.emplace_back(k, *innovation / factors_[k]);
                sum += window.back().second;
                if (window.size() - begin > length) sum -= window[begin++].second;
                if (window.size() - begin < length) continue;
                const int degrees = static_cast<int>(length) * Axes;
                if (sum > plan_.critical(degrees) && (!worst || sum > worst->statistic))
                    worst = Candidate{.log_tail = log_chi_squared_upper_tail(sum, degrees),
                                      .hypothesis = Hypothesis::model,
                                      .first = window[begin].first,
                                      .last = k,
                                      .statistic = sum,
                                      .degrees_of_freedom = degrees};
            }
            if (worst) return worst;
        }
        return std::nullopt;
    }

  private:
    template <int Size>
    void consider(const ScoreTest<Size>& test, double largest_sigma, Hypothesis hypothesis,
                  std::size_t first, std::size_t last, std::vector<Candidate>& found) const {
        const double statistic = test.statistic() / factors_[first];
        if (!(statistic > plan_.critical(Size))) return;
        if (!(test.covariance().trace() < Size * largest_sigma * largest_sigma)) return;
        found.push_back({.log_tail = log_chi_squared_upper_tail(statistic, Size),
                         .hypothesis = hypothesis,
                         .first = first,
                         .last = last,
                         .statistic = statistic,
                         .degrees_of_freedom = Size});
    }

    Candidate set_of(std::size_t first, std::size_t last, double variance_factor) const {
        const SetTest test = diagnosis_.own_errors(first, last);
        if (test.degrees_of_freedom == 0) return {.first = first, .last = last};
        const double statistic = test.statistic / variance_factor;
        return {.log_tail = log_chi_squared_upper_tail(statistic, test.degrees_of_freedom),
                .hypothesis = first == last ? Hypothesis::outlier : Hypothesis::burst,
                .first = first,
                .last = last,
                .statistic = statistic,
                .degrees_of_freedom = test.degrees_of_freedom};
    }

    const TestedStretch<Axes>& stretch_;
    const TestPlan& plan_;
    ArcDiagnosis<Axes> diagnosis_;
    std::vector<double> factors_;
};

/// Of the candidates, those that are accepted in one pass: the best supported, and others further
/// from it than `reach` epochs.
std::vector<Candidate> choose(std::vector<Candidate> candidates, std::size_t reach) {
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::tuple(a.log_tail, complexity(a), a.first) <
               std::tuple(b.log_tail, complexity(b), b.first);
    });
    std::vector<Candidate> chosen;
    std::set<std::size_t> taken;  // first and last epochs of those chosen
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Candidate& candidate = candidates[i];
        const auto next = taken.lower_bound(candidate.first < reach ? 0 : candidate.first - reach);
        if (next != taken.end() && *next <= candidate.last + reach) continue;
        // Hypotheses that say the same differ by rounding alone.
        const Candidate* simplest = &candidate;
        for (std::size_t j = i + 1; j < candidates.size(); ++j) {
            const Candidate& other = candidates[j];
            if (other.log_tail > candidate.log_tail * (1.0 - 1e-7)) break;
            const bool near =
                other.first <= candidate.last + reach && candidate.first <= other.last + reach;
            if (near && complexity(other) < complexity(*simplest)) simplest = &other;
        }
        chosen.push_back(*simplest);
        taken.insert(simplest->first);
        taken.insert(simplest->last);
    }
    return chosen;
}

template <int Axes>
class Adaptation {
  public:
    Adaptation(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
               const TestPlan& plan)
        : arc_(arc), model_(model), plan_(plan) {
        decisions_.left_out.resize(arc.size());
        decisions_.breaks.resize(arc.size());
    }

    ArcDecisions run() {
        bool changed = true;
        while (changed && decisions_.passes < passes_max) {
            ++decisions_.passes;
            changed = false;
            for (const TestedStretch<Axes>& stretch : stretches_of(arc_, decisions_)) {
                const std::size_t end = stretch.first + stretch.epochs.size();
                if (settled_.contains({stretch.first, end})) continue;
                if (adapt_stretch(stretch))
                    changed = true;
                else
                    settled_.insert({stretch.first, end});
            }
        }
        if (changed) give_up();
        return std::move(decisions_);
    }

  private:
    /// Stretches that no number of decisions has made fit are left out.
    void give_up() {
        for (const TestedStretch<Axes>& stretch : stretches_of(arc_, decisions_)) {
            const std::size_t end = stretch.first + stretch.epochs.size();
            if (settled_.contains({stretch.first, end})) continue;
            const Decision decision{.hypothesis = Hypothesis::model,
                                    .first = stretch.first,
                                    .last = end - 1,
                                    .statistic = static_cast<double>(decisions_.passes),
                                    .threshold = static_cast<double>(passes_max),
                                    .estimated = {}};
            for (std::size_t k = stretch.first; k < end; ++k)
                if (!decisions_.left_out[k]) decisions_.left_out[k] = decision;
        }
    }

    bool adapt_stretch(const TestedStretch<Axes>& stretch) {
        const StretchTests<Axes> tests(stretch, model_, plan_);
        const std::size_t reach = 2 * plan_.burst_epochs_max();
        const std::vector<Candidate> chosen = choose(tests.candidates(), reach);
        for (const Candidate& candidate : chosen)
            accept(stretch, tests, tests.best_set(candidate));
        if (!chosen.empty()) return true;
        if (const auto span = tests.failing_span()) {
            accept(stretch, tests, *span);
            return true;
        }
        return take_back(stretch, tests);
    }

    void accept(const TestedStretch<Axes>& stretch, const StretchTests<Axes>& tests,
                const Candidate& candidate) {
        const Decision decision{.hypothesis = candidate.hypothesis,
                                .first = stretch.first + candidate.first,
                                .last = stretch.first + candidate.last,
                                .statistic = candidate.statistic,
                                .threshold = plan_.critical(candidate.degrees_of_freedom),
                                .estimated = tests.estimate_of(candidate),
                                .sigma_rate_mps = tests.sigma_rate_of(candidate)};
        const bool leaves_out = candidate.hypothesis == Hypothesis::outlier ||
                                candidate.hypothesis == Hypothesis::burst ||
                                candidate.hypothesis == Hypothesis::model;
        if (!leaves_out) {
            decisions_.breaks[decision.first] = decision;
            return;
        }
        for (std::size_t k = decision.first; k <= decision.last; ++k)
            if (!decisions_.left_out[k]) decisions_.left_out[k] = decision;
    }

    /// Outliers and steps that, given everything else decided, are none.
    bool take_back(const TestedStretch<Axes>& stretch, const StretchTests<Axes>& tests) {
        bool changed = false;
        for (std::size_t i = 0; i < stretch.epochs.size(); ++i) {
            const std::size_t k = stretch.first + i;
            auto& left_out = decisions_.left_out[k];
            if (left_out && left_out->hypothesis == Hypothesis::outlier) {
                const double statistic =
                    tests.diagnosis().left_out(i, *arc_[k].measurement).statistic() /
                    tests.factor(i);
                if (statistic > plan_.critical(Axes))
                    left_out->statistic = statistic;
                else if (reconsidered_.insert(k).second) {
                    left_out.reset();
                    changed = true;
                }
            }
            if (stretch.epochs[i].step_before) {
                // The step may have been found at an epoch before it that is left out now.
                std::size_t at = k;
                while (!decisions_.breaks[at])
                    --at;
                auto& step = decisions_.breaks[at];
                const double statistic =
                    tests.diagnosis().bridged_step(i).statistic() / tests.factor(i);
                if (statistic > plan_.critical(Axes))
                    step->statistic = statistic;
                else if (reconsidered_.insert(arc_.size() + at).second) {
                    step.reset();
                    changed = true;
                }
            }
        }
        return changed;
    }

    const std::vector<ArcEpoch<Axes>>& arc_;
    const EstimationModel& model_;
    const TestPlan& plan_;
    ArcDecisions decisions_;
    std::set<std::pair<std::size_t, std::size_t>> settled_;
    std::set<std::size_t> reconsidered_;  ///< epochs left out, and arc size + epochs of steps
};

}  // namespace

template <int Axes>
std::vector<TestedStretch<Axes>> stretches_of(const std::vector<ArcEpoch<Axes>>& arc,
                                              const ArcDecisions& decisions) {
    std::vector<TestedStretch<Axes>> stretches;
    bool open = false;
    bool step = false;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto& broken = decisions.breaks[k];
        if (broken && broken->hypothesis != Hypothesis::step) open = false;
        step = step || (broken && broken->hypothesis == Hypothesis::step);
        const bool used = !decisions.left_out[k];
        if (!open && !used) continue;
        if (!open) {
            stretches.push_back({k, {}});
            step = false;
        }
        open = true;
        ArcEpoch<Axes> epoch = arc[k];
        if (!used) epoch.measurement.reset();
        // A step among epochs left out shows at the next measurement.
        epoch.step_before = used && step;
        if (used) step = false;
        stretches.back().epochs.push_back(epoch);
    }
    for (TestedStretch<Axes>& stretch : stretches)
        while (!stretch.epochs.back().measurement)
            stretch.epochs.pop_back();
    return stretches;
}

template <int Axes>
EstimatedError estimated_error(const ScoreTest<Axes>& test) {
    const auto estimate = test.estimate();
    const auto covariance = test.covariance();
    EstimatedError error;
    if constexpr (Axes == 1) {
        error.up_m = estimate(0);
        error.sigma_up_m = std::sqrt(covariance(0, 0));
    } else {
        error.east_m = estimate(0);
        error.north_m = estimate(1);
        error.sigma_east_m = std::sqrt(covariance(0, 0));
        error.sigma_north_m = std::sqrt(covariance(1, 1));
        error.correlation_east_north =
            covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
    }
    return error;
}

template <int Axes>
EstimatedError estimated_rate(const ScoreTest<Axes>& test) {
    const auto estimate = test.estimate();
    EstimatedError error;
    if constexpr (Axes == 1) {
        error.rate_up_mps = estimate(0);
    } else {
        error.rate_east_mps = estimate(0);
        error.rate_north_mps = estimate(1);
    }
    return error;
}

EstimatedError estimated_time(const ScoreTest<1>& test) {
    EstimatedError error;
    error.time_s = test.estimate()(0);
    return error;
}

template <int Axes>
std::vector<double> local_variance_factors(const ArcDiagnosis<Axes>& diagnosis) {
    constexpr std::size_t fewest = 30;
    std::vector<double> statistics;
    std::vector<std::size_t> before;  // statistics up to each epoch
    for (std::size_t k = 0; k < diagnosis.size(); ++k) {
        before.push_back(statistics.size());
        if (const auto innovation = diagnosis.innovation(k)) statistics.push_back(*innovation);
    }
    std::vector<double> factors(diagnosis.size(), 1.0);
    if (statistics.size() < fewest) return factors;
    const double expected = chi_squared_quantile(0.5, Axes);
    // Changes slowly: taken at every tenth epoch.
    constexpr std::size_t every = 10;
    double factor = 1.0;
    for (std::size_t k = 0; k < diagnosis.size(); ++k) {
        if (k % every == 0) {
            const std::size_t middle = std::min(before[k], statistics.size() - 1);
            const std::size_t first = middle < local_epochs ? 0 : middle - local_epochs;
            const std::size_t last = std::min(statistics.size(), middle + local_epochs + 1);
            std::vector<double> around(statistics.begin() + static_cast<std::ptrdiff_t>(first),
                                       statistics.begin() + static_cast<std::ptrdiff_t>(last));
            const auto half = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
            std::nth_element(around.begin(), half, around.end());
            factor = std::max(1.0, *half / expected);
        }
        factors[k] = factor;
    }
    return factors;
}

template <int Axes>
ArcDecisions adapt(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
                   const TestPlan& plan) {
    return Adaptation<Axes>(arc, model, plan).run();
}

#define RUNCERT_INSTANTIATE(AXES)                                                              \
    template EstimatedError estimated_error(const ScoreTest<AXES>&);                           \
    template EstimatedError estimated_rate(const ScoreTest<AXES>&);                            \
    template std::vector<TestedStretch<AXES>> stretches_of(const std::vector<ArcEpoch<AXES>>&, \
                                                           const ArcDecisions&);               \
    template std::vector<double> local_variance_factors(const ArcDiagnosis<AXES>&);            \
    template ArcDecisions adapt(const std::vector<ArcEpoch<AXES>>&, const EstimationModel&,    \
                                const TestPlan&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)

}  // namespace runcert

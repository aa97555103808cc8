#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/statistics.h"
#include "motion/chain.h"
#include "motion/sections.h"
#include "schemas/screened/screened.h"
#include "stages/screen/test_plan.h"

namespace runcert {

/// A stretch of an arc between breaks, which is tested as a whole. Steps do not end it: the offset
/// after each is an unknown.
template <int Axes>
struct TestedStretch {
    std::size_t first = 0;               ///< epoch of the arc at which `epochs` begins
    std::vector<ArcEpoch<Axes>> epochs;  ///< measurements that are left out are missing
};

/// The estimate of an error, in the units of the table's columns: m, m/s for a ramp, s for time
/// stamps.
template <int Axes>
EstimatedError estimated_error(const ScoreTest<Axes>& test);
template <int Axes>
EstimatedError estimated_rate(const ScoreTest<Axes>& test);
EstimatedError estimated_time(const ScoreTest<1>& test);

/// For each epoch, the factor by which the innovations around it exceed the model: their median
/// over 201 epochs divided by the chi-squared median, at least 1. It is robust, so that a few
/// outliers do not change it. Every statistic of the epoch is divided by it.
template <int Axes>
std::vector<double> local_variance_factors(const Chain<Axes>& diagnosis);

/// A hypothesis for epochs `first` to `last` of a stretch, and its support.
struct Candidate {
    double log_tail = 0.0;
    Hypothesis hypothesis = Hypothesis::outlier;
    /// Not an error: the craft changed its acceleration before `first`.
    bool manoeuvre = false;
    std::size_t first = 0;
    std::size_t last = 0;
    double statistic = 0.0;
    int degrees_of_freedom = 1;
};

/// The tests of one stretch, given the decisions so far.
template <int Axes>
class StretchTests {
  public:
    StretchTests(const TestedStretch<Axes>& stretch, const EstimationModel& model,
                 const TestPlan& plan)
        : stretch_(stretch),
          plan_(plan),
          diagnosis_(stretch.epochs, model),
          factors_(local_variance_factors(diagnosis_)) {}

    const Chain<Axes>& diagnosis() const { return diagnosis_; }

    EstimatedError estimate_of(const Candidate& candidate) const {
        if (candidate.manoeuvre) return {};
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
                return {};  // each epoch of a burst has its own error, known once it is left out
        }
    }

    /// The estimated change of acceleration (m/s^2) in a manoeuvre.
    double manoeuvre_of(const Candidate& candidate) const {
        return diagnosis_.manoeuvre(candidate.first).estimate().norm();
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
            consider(diagnosis_.ramp(k), largest_sigma_m_s, Hypothesis::ramp, k, k, found);
            consider_manoeuvre(k, found);
        }
        diagnosis_.for_each_burst(plan_.burst_epochs_max(), [&](std::size_t k, std::size_t length,
                                                                const ScoreTest<Axes>& test) {
            consider(test, largest_sigma_m, Hypothesis::burst, k, k + length - 1, found);
        });
        return found;
    }

    /// The best explanation of a candidate: motion, a set of neighbouring epochs, or else the
    /// candidate itself. `hard` says that a manoeuvre was found nearby, so that another needs to
    /// explain less of it.
    Candidate best_explanation(const Candidate& candidate, bool hard) const {
        constexpr double share = 0.6;
        if (candidate.manoeuvre) return candidate;
        if (candidate.hypothesis != Hypothesis::outlier)
            if (const auto motion = motion_instead(
                    candidate, (hard ? share_of_hard_motion : share) * candidate.statistic))
                return *motion;
        return best_set(candidate);
    }

    /// The explanation of a failing span that no hypothesis explains: motion, where it accounts for
    /// a good part of the excess, or else the span itself. Motion does not explain scatter larger
    /// than stated, which has no lasting direction.
    Candidate explanation_of_span(const Candidate& span) const {
        constexpr double share = 0.2;
        const double excess = span.statistic - span.degrees_of_freedom;
        return motion_instead(span, share * excess).value_or(span);
    }

    /// The set of neighbouring epochs, each with its own error, that is better supported than the
    /// candidate, or else the candidate itself. It grows from the candidate's epochs to whichever
    /// side gains more.
    Candidate best_set(const Candidate& candidate) const {
        const double factor = factors_[candidate.first];
        Candidate best = set_of(candidate.first, candidate.last, factor);
        Candidate grown = best;
        // Growth may continue for a few steps without a gain, because a good epoch may lie between
        // two outliers.
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

    /// The shortest span whose innovations are jointly too large, and the worst of that length.
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
    // An error that the data determine less well than this is not tested, because the vague prior
    // would decide.
    static constexpr double largest_sigma_m = 20.0;
    static constexpr double largest_sigma_m_s = 20.0;
    static constexpr double largest_sigma_s = 1.0;
    static constexpr double largest_sigma_m_s2 = 5.0;
    /// Fraction of the statistic that a manoeuvre must explain near another one. Hard motion
    /// consists of several changes, and each explains only a part.
    static constexpr double share_of_hard_motion = 0.3;

    template <int Size>
    static bool is_determined(const ScoreTest<Size>& test, double largest_sigma) {
        return test.covariance().trace() < Size * largest_sigma * largest_sigma;
    }

    template <int Size>
    void consider(const ScoreTest<Size>& test, double largest_sigma, Hypothesis hypothesis,
                  std::size_t first, std::size_t last, std::vector<Candidate>& found) const {
        const double statistic = test.statistic() / factors_[first];
        if (!(statistic > plan_.critical(Size))) return;
        if (!is_determined(test, largest_sigma)) return;
        found.push_back({.log_tail = log_chi_squared_upper_tail(statistic, Size),
                         .hypothesis = hypothesis,
                         .first = first,
                         .last = last,
                         .statistic = statistic,
                         .degrees_of_freedom = Size});
    }

    /// Considers a manoeuvre, if it is no larger than a craft of the class can make.
    void consider_manoeuvre(std::size_t k, std::vector<Candidate>& found) const {
        if (plan_.manoeuvre_max_m_s2() <= 0.0) return;
        const ScoreTest<Axes> test = diagnosis_.manoeuvre(k);
        const std::size_t before = found.size();
        consider(test, largest_sigma_m_s2, Hypothesis::ramp, k, k, found);
        if (found.size() == before) return;
        if (test.estimate().norm() <= plan_.manoeuvre_max_m_s2())
            found.back().manoeuvre = true;
        else
            found.pop_back();
    }

    /// A manoeuvre near an error whose statistic exceeds `support`. Hard motion is never purely one
    /// or the other. A real error remains visible after the manoeuvre is allowed for, whereas a
    /// false drift takes the whole stretch with it.
    std::optional<Candidate> motion_instead(const Candidate& error, double support) const {
        if (plan_.manoeuvre_max_m_s2() <= 0.0) return std::nullopt;
        const std::size_t reach = 2 * plan_.burst_epochs_max();
        const std::size_t end = std::min(stretch_.epochs.size(), error.first + reach + 1);
        std::optional<Candidate> best;
        for (std::size_t k = error.first > reach ? error.first - reach : 1; k < end; ++k) {
            if (!stretch_.epochs[k].measurement) continue;
            const ScoreTest<Axes> test = diagnosis_.manoeuvre(k);
            const double statistic = test.statistic() / factors_[k];
            if (!(statistic > support) || (best && statistic <= best->statistic)) continue;
            if (!is_determined(test, largest_sigma_m_s2) ||
                test.estimate().norm() > plan_.manoeuvre_max_m_s2())
                continue;
            best = Candidate{.log_tail = log_chi_squared_upper_tail(statistic, Axes),
                             .hypothesis = Hypothesis::ramp,
                             .manoeuvre = true,
                             .first = k,
                             .last = k,
                             .statistic = statistic,
                             .degrees_of_freedom = Axes};
        }
        return best;
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
    Chain<Axes> diagnosis_;
    std::vector<double> factors_;
};

/// A section of a stretch with its tests, which count epochs from the first one included.
template <int Axes>
struct SectionTests {
    SectionTests(const TestedStretch<Axes>& stretch, const ArcSection& of,
                 const EstimationModel& model, const TestPlan& plan)
        : section(of),
          part{.first = stretch.first + of.used_first,
               .epochs = {stretch.epochs.begin() + static_cast<std::ptrdiff_t>(of.used_first),
                          stretch.epochs.begin() + static_cast<std::ptrdiff_t>(of.used_end)}},
          tests(part, model, plan) {}
    SectionTests(const SectionTests&) = delete;  // the tests refer to `part`
    SectionTests& operator=(const SectionTests&) = delete;

    ArcSection section;
    TestedStretch<Axes> part;
    StretchTests<Axes> tests;
};

/// The tests of a stretch, one section at a time. Only the last one used is kept.
template <int Axes>
class SectionTestsCache {
  public:
    SectionTestsCache(const TestedStretch<Axes>& stretch, const EstimationModel& model,
                      const TestPlan& plan)
        : stretch_(stretch), model_(model), plan_(plan) {}

    const SectionTests<Axes>& at(const ArcSection& section) {
        if (!tests_ || tests_->section.first != section.first) {
            tests_.reset();  // frees memory before the next are built
            tests_ = std::make_unique<SectionTests<Axes>>(stretch_, section, model_, plan_);
        }
        return *tests_;
    }

  private:
    const TestedStretch<Axes>& stretch_;
    const EstimationModel& model_;
    const TestPlan& plan_;
    std::unique_ptr<SectionTests<Axes>> tests_;
};

/// Whether a candidate begins in the epochs whose tests the section decides.
inline bool decides_on(const ArcSection& section, const Candidate& candidate) {
    return candidate.first >= section.first && candidate.first < section.end;
}

/// A candidate whose epoch numbers are increased by `on` and decreased by `back`.
inline Candidate shifted(Candidate candidate, std::size_t on, std::size_t back) {
    candidate.first = candidate.first + on - back;
    candidate.last = candidate.last + on - back;
    return candidate;
}

}  // namespace runcert

#pragma once

#include <memory>
#include <optional>
#include <vector>

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
    double factor(std::size_t k) const { return factors_[k]; }

    EstimatedError estimate_of(const Candidate& candidate) const;

    /// The estimated change of acceleration (m/s^2) in a manoeuvre.
    double manoeuvre_of(const Candidate& candidate) const;

    double sigma_rate_of(const Candidate& candidate) const;

    /// Every hypothesis whose test rejects the model.
    std::vector<Candidate> candidates() const;

    /// The best explanation of a candidate: motion, a set of neighbouring epochs, or else the
    /// candidate itself. `hard` says that a manoeuvre was found nearby, so that another needs to
    /// explain less of it.
    Candidate best_explanation(const Candidate& candidate, bool hard) const;

    /// The explanation of a failing span that no hypothesis explains: motion, where it accounts for
    /// a good part of the excess, or else the span itself. Motion does not explain scatter larger
    /// than stated, which has no lasting direction.
    Candidate explanation_of_span(const Candidate& span) const;

    /// The shortest span whose innovations are jointly too large, and the worst of that length.
    std::optional<Candidate> failing_span() const;

  private:
    template <int Size>
    void consider(const ScoreTest<Size>& test, double largest_sigma, Hypothesis hypothesis,
                  std::size_t first, std::size_t last, std::vector<Candidate>& found) const;
    void consider_manoeuvre(std::size_t k, std::vector<Candidate>& found) const;
    std::optional<Candidate> motion_instead(const Candidate& error, double support) const;
    Candidate best_set(const Candidate& candidate) const;
    Candidate set_of(std::size_t first, std::size_t last, double variance_factor) const;

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

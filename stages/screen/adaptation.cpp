#include "stages/screen/adaptation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "motion/kalman.h"
#include "stages/screen/stretch_tests.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

constexpr std::int64_t passes_max = 200;

/// Orders hypotheses by simplicity. Of two that are equivalent, the simpler is taken.
int complexity(const Candidate& candidate) {
    if (candidate.manoeuvre) return 5;
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

/// The candidates accepted in one pass: the best supported, and others more than `reach` epochs
/// away.
std::vector<Candidate> choose(std::vector<Candidate> candidates, std::size_t reach) {
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::tuple(a.log_tail, complexity(a), a.first) <
               std::tuple(b.log_tail, complexity(b), b.first);
    });
    std::vector<Candidate> chosen;
    std::set<std::size_t> taken;  // first and last epochs of the chosen candidates
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Candidate& candidate = candidates[i];
        const auto next = taken.lower_bound(candidate.first < reach ? 0 : candidate.first - reach);
        if (next != taken.end() && *next <= candidate.last + reach) continue;
        // Equivalent hypotheses differ only by rounding.
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
               const TestPlan& plan, std::size_t section_epochs)
        : arc_(arc),
          model_(model),
          plan_(plan),
          section_epochs_(section_epochs),
          decisions_(arc.size()) {}

    /// The stretches that remain after the decisions and are not known to fit the model.
    std::vector<TestedStretch<Axes>> begin_pass() {
        ++decisions_.passes;
        return open_stretches();
    }

    /// Tests every hypothesis at every epoch of a stretch, and accepts the best supported of those
    /// above their critical values. If there is none, it withdraws unnecessary decisions. Returns
    /// whether anything changed.
    bool adapt_stretch(const TestedStretch<Axes>& stretch) {
        const bool changed = decide_in(stretch);
        if (!changed) settled_.insert(range_of(stretch));
        return changed;
    }

    /// Leaves out stretches that no number of decisions has made fit.
    void give_up() {
        for (const TestedStretch<Axes>& stretch : open_stretches()) {
            const auto [first, end] = range_of(stretch);
            const ScreeningDecision decision{.hypothesis = Hypothesis::model,
                                             .first = first,
                                             .last = end - 1,
                                             .statistic = static_cast<double>(decisions_.passes),
                                             .threshold = static_cast<double>(passes_max),
                                             .estimated = {}};
            for (std::size_t k = first; k < end; ++k)
                if (!decisions_.left_out[k]) decisions_.left_out[k] = decision;
        }
    }

    std::int64_t passes() const { return decisions_.passes; }
    ArcDecisions decisions() && { return std::move(decisions_); }

  private:
    static std::pair<std::size_t, std::size_t> range_of(const TestedStretch<Axes>& stretch) {
        return {stretch.first, stretch.first + stretch.epochs.size()};
    }

    std::vector<TestedStretch<Axes>> open_stretches() const {
        std::vector<TestedStretch<Axes>> stretches = stretches_of(arc_, model_, decisions_);
        std::erase_if(stretches, [&](const TestedStretch<Axes>& stretch) {
            return settled_.contains(range_of(stretch));
        });
        return stretches;
    }

    struct Findings {
        std::vector<Candidate> candidates;
        std::optional<Candidate> span;  ///< the shortest that fails, and the worst of that length
    };

    Findings findings_of(const std::vector<ArcSection>& sections,
                         SectionTestsCache<Axes>& section_tests) const {
        Findings findings;
        for (const ArcSection& section : sections) {
            const StretchTests<Axes>& tests = section_tests.at(section).tests;
            for (const Candidate& candidate : tests.candidates())
                if (const Candidate here = shifted(candidate, section.used_first, 0);
                    decides_on(section, here))
                    findings.candidates.push_back(here);
            if (!findings.candidates.empty()) continue;
            const auto failing = tests.failing_span();
            if (!failing) continue;
            const Candidate span = shifted(*failing, section.used_first, 0);
            const auto rank = [](const Candidate& one) {
                return std::pair(one.degrees_of_freedom, -one.statistic);
            };
            if (decides_on(section, span) && (!findings.span || rank(span) < rank(*findings.span)))
                findings.span = span;
        }
        return findings;
    }

    bool decide_in(const TestedStretch<Axes>& stretch) {
        const std::vector<ArcSection> sections = sections_of<Axes>(
            stretch.epochs,
            stretch.epochs.size() > section_epochs_ ? memory_s<Axes>(stretch.epochs, model_) : 0.0,
            section_epochs_);
        SectionTestsCache<Axes> section_tests(stretch, model_, plan_);
        Findings findings = findings_of(sections, section_tests);
        const std::size_t reach = 2 * plan_.burst_epochs_max();
        const std::vector<Candidate> chosen = choose(std::move(findings.candidates), reach);
        bool changed = false;
        for (const ArcSection& section : sections) {
            for (const Candidate& candidate : chosen) {
                if (!decides_on(section, candidate)) continue;
                const SectionTests<Axes>& at = section_tests.at(section);
                accept(at.part, at.tests,
                       at.tests.best_explanation(shifted(candidate, 0, section.used_first),
                                                 is_hard_motion(stretch.first + candidate.first)));
                changed = true;
            }
            if (chosen.empty() && findings.span && decides_on(section, *findings.span)) {
                const SectionTests<Axes>& at = section_tests.at(section);
                accept(
                    at.part, at.tests,
                    at.tests.explanation_of_span(shifted(*findings.span, 0, section.used_first)));
                changed = true;
            }
        }
        if (changed) return true;
        for (const ArcSection& section : sections)
            if (decided_in(stretch, section))
                changed = withdraw(section_tests.at(section)) || changed;
        return changed;
    }

    /// Whether a manoeuvre was found within 15 s of an epoch of the arc.
    bool is_hard_motion(std::size_t epoch) const {
        constexpr double reach_s = 15.0;
        const auto is_near = [&](std::size_t k) {
            return std::abs(arc_[k].time_s - arc_[epoch].time_s) <= reach_s;
        };
        const auto& sizes_m_s2 = decisions_.manoeuvres_m_s2;
        for (std::size_t k = epoch; k > 0 && is_near(k); --k)
            if (sizes_m_s2[k] > 0.0) return true;
        for (std::size_t k = epoch; k < arc_.size() && is_near(k); ++k)
            if (sizes_m_s2[k] > 0.0) return true;
        return false;
    }

    /// Whether a section has decisions that could be withdrawn.
    bool decided_in(const TestedStretch<Axes>& stretch, const ArcSection& section) const {
        for (std::size_t i = section.first; i < section.end; ++i)
            if (decisions_.left_out[stretch.first + i] || stretch.epochs[i].step_before)
                return true;
        return false;
    }

    void accept(const TestedStretch<Axes>& stretch, const StretchTests<Axes>& tests,
                const Candidate& candidate) {
        if (candidate.manoeuvre) {
            double& size = decisions_.manoeuvres_m_s2[stretch.first + candidate.first];
            size = std::hypot(size, tests.manoeuvre_of(candidate));
            return;
        }
        const ScreeningDecision decision{.hypothesis = candidate.hypothesis,
                                         .first = stretch.first + candidate.first,
                                         .last = stretch.first + candidate.last,
                                         .statistic = candidate.statistic,
                                         .threshold = plan_.critical(candidate.degrees_of_freedom),
                                         .estimated = tests.estimate_of(candidate),
                                         .sigma_rate_m_s = tests.sigma_rate_of(candidate)};
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

    /// Withdraws outliers and steps that are none, given all other decisions.
    bool withdraw(const SectionTests<Axes>& section) {
        const TestedStretch<Axes>& stretch = section.part;
        const StretchTests<Axes>& tests = section.tests;
        bool changed = false;
        for (std::size_t i = section.section.first - section.section.used_first;
             i < section.section.end - section.section.used_first; ++i) {
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
                // The step may have been found at an earlier epoch that is now left out.
                std::size_t at = k;
                while (!decisions_.breaks[at])
                    --at;
                auto& step = decisions_.breaks[at];
                const double statistic =
                    tests.diagnosis().known_step(i).statistic() / tests.factor(i);
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
    std::size_t section_epochs_;
    ArcDecisions decisions_;
    std::set<std::pair<std::size_t, std::size_t>> settled_;
    std::set<std::size_t> reconsidered_;  ///< epochs left out, and arc size + epoch for steps
};

}  // namespace

template <int Axes>
std::vector<TestedStretch<Axes>> stretches_of(const std::vector<ArcEpoch<Axes>>& arc,
                                              const EstimationModel& model,
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
        if (decisions.manoeuvres_m_s2[k] > 0.0)
            allow_manoeuvre(arc[k - 1], decisions.manoeuvres_m_s2[k], model, epoch);
        if (!used) epoch.measurement.reset();
        // A step among epochs left out takes effect at the next measurement.
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
ArcDecisions adapt(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
                   const TestPlan& plan, std::size_t section_epochs) {
    Adaptation<Axes> adaptation(arc, model, plan, section_epochs);
    for (bool changed = true; changed && adaptation.passes() < passes_max;) {
        changed = false;
        for (const TestedStretch<Axes>& stretch : adaptation.begin_pass())
            changed = adaptation.adapt_stretch(stretch) || changed;
        if (changed && adaptation.passes() == passes_max) adaptation.give_up();
    }
    return std::move(adaptation).decisions();
}

#define RUNCERT_INSTANTIATE(AXES)                                                           \
    template std::vector<TestedStretch<AXES>> stretches_of(                                 \
        const std::vector<ArcEpoch<AXES>>&, const EstimationModel&, const ArcDecisions&);   \
    template ArcDecisions adapt(const std::vector<ArcEpoch<AXES>>&, const EstimationModel&, \
                                const TestPlan&, std::size_t);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert

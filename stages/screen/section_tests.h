#pragma once

#include <memory>

#include "stages/screen/sections.h"
#include "stages/screen/stretch_tests.h"

namespace runcert {

/// A section of a stretch with its tests, which count epochs from the first taken in.
template <int Axes>
struct SectionTests {
    SectionTests(const TestedStretch<Axes>& stretch, const Section& of,
                 const EstimationModel& model, const TestPlan& plan)
        : section(of),
          part{.first = stretch.first + of.taken_first,
               .epochs = {stretch.epochs.begin() + static_cast<std::ptrdiff_t>(of.taken_first),
                          stretch.epochs.begin() + static_cast<std::ptrdiff_t>(of.taken_end)}},
          tests(part, model, plan) {}
    SectionTests(const SectionTests&) = delete;  // the tests refer to the part
    SectionTests& operator=(const SectionTests&) = delete;

    Section section;
    TestedStretch<Axes> part;
    StretchTests<Axes> tests;
};

/// The tests of a stretch, one section at a time: the one last looked at is kept.
template <int Axes>
class SectionLooks {
  public:
    SectionLooks(const TestedStretch<Axes>& stretch, const EstimationModel& model,
                 const TestPlan& plan)
        : stretch_(stretch), model_(model), plan_(plan) {}

    const SectionTests<Axes>& at(const Section& section) {
        if (!tests_ || tests_->section.first != section.first) {
            tests_.reset();  // before the next take their place in memory
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

inline bool answers_for(const Section& section, const Candidate& candidate) {
    return candidate.first >= section.first && candidate.first < section.end;
}

/// A candidate with its epochs counted from so much further back, or on.
inline Candidate moved(Candidate candidate, std::size_t on, std::size_t back) {
    candidate.first = candidate.first + on - back;
    candidate.last = candidate.last + on - back;
    return candidate;
}

}  // namespace runcert

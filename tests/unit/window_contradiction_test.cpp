#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "stages/window/budget.h"
#include "stages/window/contradictions.h"
#include "stages/window/witnessed_budget.h"
#include "window_test_support.h"
#include "witness/evidence.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// The true motion of `recorded`, as well as a witness knows it, until it falls silent.
class TrueMotion final : public Witness<2> {
  public:
    explicit TrueMotion(double sigma_m, double until_s = 100.0)
        : sigma_m_(sigma_m), until_s_(until_s) {}
    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override {
        if (to_s > until_s_) return std::nullopt;
        const double along_m =
            (test::run_distance_m(to_s) - test::run_distance_m(from_s)) / std::numbers::sqrt2;
        return WitnessedMotion<2>{
            .displacement_m = {along_m, along_m},
            .covariance_m2 = sigma_m_ * sigma_m_ * Eigen::Matrix2d::Identity()};
    }
    TimeSpan covered() const override { return {0.0, until_s_}; }
    std::optional<double> path_between(double from_s, double to_s) const override {
        const auto moved = between(from_s, to_s);
        if (!moved) return std::nullopt;
        return moved->displacement_m.norm();
    }

  private:
    double sigma_m_, until_s_;
};

/// A run at 60 m/s whose positions drift along the track from 40 s to 46 s, beside a wheel.
struct Drifting {
    ScreenedTable screened = test::recorded({.to_s = 80.0});
    TrajectoryTable trajectory;
    WindowConfig config = test::few_draws();
    Profile profile = test::rule_over(3.0);
    AxesEstimate<2> estimate;

    /// Screening would have missed drifts of so many m/s.
    explicit Drifting(double rate_m_s, std::shared_ptr<const Witness<2>> wheel,
                      std::optional<double> missed_m_s = {})
        : trajectory(smoothed(rate_m_s, missed_m_s)),
          estimate(estimate_of<2>(screened, trajectory, config, {}, {})) {
        estimate.witnesses = {{.kind = WitnessKind::wheel, .motion = std::move(wheel)}};
    }
    TrajectoryTable smoothed(double rate_m_s, std::optional<double> missed_m_s) {
        for (ScreenedEpoch& row : screened.rows) {
            row.detectable.ramp_m_s = missed_m_s;
            const double by_m =
                rate_m_s / std::numbers::sqrt2 * std::clamp(row.time.seconds() - 40.0, 0.0, 6.0);
            *row.east_m += by_m;
            *row.north_m += by_m;
        }
        return test::smoothed_with(screened, test::summary_of({.motion = {.jerk_density = 0.6}}));
    }
    FoundWindow from(std::size_t first) const {
        FoundWindow found;
        found.first = first;
        found.last = first + 30;
        found.start = screened.rows[first].time;
        found.end = screened.rows[first + 30].time;
        found.speed_m_s = 60.0;
        return found;
    }
    /// The window, and others as fast that do not overlap it.
    std::vector<FoundWindow> rivals_of(std::size_t first) const {
        std::vector<FoundWindow> all{from(first)};
        for (std::size_t other = 200; other + 30 < screened.rows.size(); other += 30)
            if (other + 30 <= first || other >= first + 30) all.push_back(from(other));
        return all;
    }
    CertifiableWindow certified_from(std::size_t first,
                                     std::span<const Contradiction> contradictions = {},
                                     const std::vector<FoundWindow>& rivals = {}) const {
        const FoundWindow found = from(first);
        const std::vector<FoundWindow> all = rivals.empty() ? std::vector{found} : rivals;
        return certify_by_positions(estimate, {.profile = profile,
                                               .found = found,
                                               .all = all,
                                               .quantity = quantity_of(profile),
                                               .contradictions = contradictions});
    }
    std::vector<Contradiction> contradictions_from(std::size_t first) const {
        return contradictions_in(estimate, from(first), certified_from(first));
    }
};

const BudgetRow& row_of(const CertifiableWindow& window, const char* symbol) {
    return *std::ranges::find(window.budget, symbol, &BudgetRow::symbol);
}

// A witness that found a drift refused one window; the next was certified as if nothing had been
// found.
TEST(Contradictions, LastUntilTheWitnessShowsThePositionsSound) {
    const Drifting run(0.4, std::make_shared<const TrueMotion>(0.06));
    const auto found = run.contradictions_from(420);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].drift_m_s, 0.4, 0.03);
    EXPECT_EQ(found[0].kind, WitnessKind::wheel);
    // Sound before the drift and after it, over spans of 3.6 s.
    EXPECT_LT(found[0].sound_until_s, 40.0 - 2.0);
    EXPECT_GT(found[0].sound_until_s, 40.0 - 6.0);
    EXPECT_GT(found[0].sound_from_s, 46.0 + 2.0);
    EXPECT_LT(found[0].sound_from_s, 46.0 + 6.0);
    const auto of = [&](std::size_t first) { return run.certified_from(first, found); };
    EXPECT_DOUBLE_EQ(of(200).evidence->fault_probability, 0.002);
    EXPECT_DOUBLE_EQ(of(600).evidence->fault_probability, 0.002);
    // A window of which a third of the drift is left agrees no better than by 1.96 sigma.
    const CertifiableWindow partly = of(382);
    EXPECT_DOUBLE_EQ(partly.evidence->fault_probability, 0.5);
    EXPECT_NE(row_of(partly, "d").note.find("have not shown them sound again"), std::string::npos)
        << row_of(partly, "d").note;
    EXPECT_GT(partly.standard_uncertainty_m_s, run.certified_from(382).standard_uncertainty_m_s);
}

TEST(Contradictions, LastWhereTheWitnessIsTooPoorOrSilent) {
    // It finds 0.4 m/s with less than 0.8 wherever its standard uncertainty is 0.2 m/s.
    const Drifting poor(0.9, std::make_shared<const TrueMotion>(0.12));
    auto found = poor.contradictions_from(420);
    ASSERT_EQ(found.size(), 1U);
    found[0].drift_m_s = 0.08;
    found[0].sound_from_s = std::numeric_limits<double>::infinity();
    found[0].sound_until_s = -found[0].sound_from_s;
    EXPECT_DOUBLE_EQ(poor.certified_from(600, found).evidence->fault_probability, 0.5);
    // Of another arc nothing is known.
    found[0].series = 7;
    EXPECT_DOUBLE_EQ(poor.certified_from(600, found).evidence->fault_probability, 0.002);
    const Drifting silent(0.4, std::make_shared<const TrueMotion>(0.06, 46.0));
    const auto until = silent.contradictions_from(420);
    ASSERT_EQ(until.size(), 1U);
    EXPECT_DOUBLE_EQ(silent.certified_from(600, until).evidence->fault_probability, 0.5);
    EXPECT_DOUBLE_EQ(silent.certified_from(200, until).evidence->fault_probability, 0.002);
}

// A wheel 3.2 standard uncertainties off left U as it was, and an error of 0.2 m/s outside.
TEST(Contradictions, BeginWithADifferenceBeyondThe95PercentOfBoth) {
    const Drifting run(0.055, std::make_shared<const TrueMotion>(0.06));
    const CertifiableWindow window = run.certified_from(420);
    const WitnessedSpeed& wheel = window.witnesses.front();
    ASSERT_GT(
        std::abs(wheel.difference_m_s),
        1.96 * std::hypot(wheel.standard_uncertainty_m_s, wheel.position_standard_uncertainty_m_s));
    EXPECT_DOUBLE_EQ(window.evidence->fault_probability, 0.5);
    EXPECT_NE(row_of(window, "d").note.find("differ from the positions"), std::string::npos);
    EXPECT_EQ(run.contradictions_from(420).size(), 1U);
    const Drifting sound(0.0, std::make_shared<const TrueMotion>(0.06));
    EXPECT_DOUBLE_EQ(sound.certified_from(420).evidence->fault_probability, 0.002);
    EXPECT_TRUE(sound.contradictions_from(420).empty());
}

// A calibrated wheel left the window just under its threshold: 0 of 60 inside, a fault's
// probability of 0.4 beside ± 0.32 km/h.
TEST(MixtureOfFaults, IsHeldByTheExpandedUncertainty) {
    const Drifting run(0.4, std::make_shared<const TrueMotion>(0.3), 1.0);
    for (std::size_t first = 385; first < 403; ++first) {
        const CertifiableWindow window = run.certified_from(first, {}, run.rivals_of(first));
        if (std::ranges::any_of(window.witnesses, &contradicts)) continue;
        const SpeedMixture mixture =
            mixture_of(*window.evidence, window.speed_m_s, WitnessSet::all);
        const double expanded_m_s = expanded_uncertainty_m_s(window, 2.0);
        if (fault_posteriors(speeds_of(*window.evidence, window.speed_m_s))[0] <= 0.002) continue;
        EXPECT_GE(expanded_m_s, mixture.half_width(window.speed_m_s, 0.9545) - 1e-9);
        const auto row = std::ranges::find(window.budget, "x", &BudgetRow::symbol);
        if (row == window.budget.end()) continue;
        EXPECT_NEAR(expanded_m_s, mixture.half_width(window.speed_m_s, 0.9545), 1e-9);
        EXPECT_NEAR(combine(window.budget).standard_uncertainty, window.standard_uncertainty_m_s,
                    1e-12);
        EXPECT_GE(window.evidence->at_five_times_m_s, window.evidence->at_a_fifth_m_s);
    }
}

TEST(MixtureOfFaults, WidensOnlyWhereAFaultGotLikelier) {
    SpeedEvidence evidence{.position_standard_uncertainty_m_s = 0.0213};
    evidence.fault_probability = 0.002;
    evidence.chosen_fault_probability = 0.02;
    evidence.fault_m_s = 0.97;
    evidence.witnesses = {{.difference_m_s = 0.33,
                           .own_standard_uncertainty_m_s = 0.1,
                           .fault_probability = 0.01,
                           .fault_m_s = 1.0}};
    const SpeedMixture mixture = mixture_of(evidence, 60.0, WitnessSet::all);
    EXPECT_GT(fault_posteriors(speeds_of(evidence, 60.0))[0], 0.2);
    EXPECT_DOUBLE_EQ(least_expanded_m_s(evidence, 60.0, 0.07), mixture.half_width(60.0, 0.9545));
    EXPECT_GT(least_expanded_m_s(evidence, 60.0, 0.07), 0.33);
    // One that agrees makes no interval wider than the positions' own.
    evidence.witnesses[0].difference_m_s = 0.01;
    EXPECT_DOUBLE_EQ(least_expanded_m_s(evidence, 60.0, 0.01), 0.01);
    evidence.witnesses.clear();
    EXPECT_DOUBLE_EQ(least_expanded_m_s(evidence, 60.0, 0.01), 0.01);
    // Positions that are suspect, and nothing confirms.
    evidence.fault_probability = evidence.chosen_fault_probability = 0.5;
    EXPECT_NEAR(least_expanded_m_s(evidence, 60.0, 0.01), 0.909 * 0.97, 1e-3);
}

/// Gates of `recorded` at these times, which know the way between them and nothing else.
class Gates final : public Witness<2> {
  public:
    explicit Gates(std::vector<double> times_s) : times_s_(std::move(times_s)) {}
    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override {
        const auto is_gate = [&](double at_s) {
            return std::ranges::any_of(times_s_,
                                       [&](double one) { return std::abs(one - at_s) < 1e-6; });
        };
        if (!is_gate(from_s) || !is_gate(to_s)) return std::nullopt;
        return TrueMotion(0.005).between(from_s, to_s);
    }
    TimeSpan covered() const override { return {times_s_.front(), times_s_.back()}; }
    std::optional<TimeSpan> enclosing(double from_s, double to_s) const override {
        const auto after = std::ranges::upper_bound(times_s_, from_s);
        const auto last = std::ranges::lower_bound(times_s_, to_s);
        if (after == times_s_.begin() || last == times_s_.end()) return std::nullopt;
        return TimeSpan{*std::prev(after), *last};
    }
    std::optional<double> path_between(double, double) const override { return std::nullopt; }

  private:
    std::vector<double> times_s_;
};

// Gates whose passages were 0.3 s from the window's ends said nothing of it.
TEST(AWitnessAtOtherInstants, ContradictsAndConfirmsNothing) {
    const auto gates =
        std::make_shared<const Gates>(std::vector{20.03, 24.57, 41.73, 45.36, 60.04, 64.21});
    const Drifting sound(0.0, gates);
    const CertifiableWindow beside = sound.certified_from(420);
    ASSERT_EQ(beside.witnesses.size(), 1U);
    const WitnessedSpeed& one = beside.witnesses.front();
    EXPECT_NEAR(one.compared_over_s.value(), 45.36 - 41.73, 1e-9);
    EXPECT_FALSE(one.confirms || contradicts(one));
    EXPECT_EQ(one.share, 0.0);
    EXPECT_NEAR(one.speed_m_s, 60.0, 0.01);
    EXPECT_NEAR(one.difference_m_s, 0.0, 0.02);
    Drifting alone(0.0, gates);
    alone.estimate.witnesses.clear();
    EXPECT_DOUBLE_EQ(beside.standard_uncertainty_m_s,
                     alone.certified_from(420).standard_uncertainty_m_s);
    const CertifiableWindow drifting = Drifting(0.4, gates).certified_from(420);
    ASSERT_EQ(drifting.witnesses.size(), 1U);
    EXPECT_TRUE(contradicts(drifting.witnesses.front()));
    EXPECT_NEAR(drifting.witnesses.front().difference_m_s, 0.4, 0.03);
    // Before the first gate there is none that encloses.
    EXPECT_TRUE(sound.certified_from(180).witnesses.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

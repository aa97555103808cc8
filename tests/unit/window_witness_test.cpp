#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/random.h"
#include "core/uncertainty.h"
#include "stages/window/budget.h"
#include "stages/window/course_windows.h"
#include "stages/window/witnessed_budget.h"
#include "stages/window/witnesses.h"
#include "window_test_support.h"
#include "witness/evidence.h"

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<BudgetRow> rows_of(double white, double slow, double undetected, double frame) {
    return {speed_row("w", "white", "A", white, RowScope::source, ""),
            speed_row("b", "slow", "B", slow, RowScope::slow, ""),
            speed_row("d", "undetected", "B", undetected, RowScope::fault, ""),
            speed_row("m", "frame", "B", frame, RowScope::window, "")};
}

WitnessedBudget beside(const std::vector<BudgetRow>& alone, std::vector<WitnessedSpeed> witnesses) {
    return combine_with_witnesses(alone, WindowFault{}, SelectionBias{}, std::move(witnesses));
}

// The budget beside a witness is that of the weighted mean, with the difference that is not
// corrected.
TEST(WitnessedBudgets, AreThoseOfTheWeightedMean) {
    const std::vector<BudgetRow> alone = rows_of(0.3, 0.4, 1.2, 0.1);
    EXPECT_DOUBLE_EQ(positions_of(alone).alone_m_s(), 0.5);
    WitnessedSpeed witnessed;
    witnessed.standard_uncertainty_m_s = 0.2;
    witnessed.difference_m_s = -0.25;
    const WitnessedBudget heard = beside(alone, {witnessed});
    const double share = 1.69 / (1.69 + 0.04);
    EXPECT_NEAR(heard.witnesses[0].share, share, 1e-12);
    EXPECT_NEAR(heard.position_share, 1.0 - share, 1e-12);
    EXPECT_NEAR(heard.evidence.difference_m_s, -0.25 * share, 1e-12);
    const double mean = 1.3 * 1.3 * 0.04 / (1.3 * 1.3 + 0.04);
    EXPECT_NEAR(combine(heard.rows).standard_uncertainty,
                std::sqrt(mean + std::pow(0.25 * share, 2) + 0.01), 1e-12);
    for (const BudgetRow& row : heard.rows)
        EXPECT_NEAR(row.contribution_m_s, std::abs(row.sensitivity) * row.standard_uncertainty,
                    1e-12)
            << row.symbol;
}

/// By phases whose own error is small, positions and phases sharing 0.05 m/s, and a receiver with
/// the positions' own errors.
std::vector<WitnessedSpeed> two_witnesses() {
    WitnessedSpeed phases, receiver;
    phases.kind = WitnessKind::phases;
    phases.standard_uncertainty_m_s = 0.01;
    phases.shared_standard_uncertainty_m_s = 0.05;
    receiver.kind = WitnessKind::receiver;
    receiver.standard_uncertainty_m_s = std::hypot(0.3, 0.4);
    return {phases, receiver};
}

TEST(WitnessedBudgets, OfAllWitnessesAreNoWiderThanOfAny) {
    const std::vector<BudgetRow> alone = rows_of(0.3, 0.4, 1.2, 0.1);
    const auto with = [&](const std::vector<WitnessedSpeed>& witnesses) {
        return combine(beside(alone, witnesses).rows).standard_uncertainty;
    };
    const auto both = two_witnesses();
    EXPECT_NEAR(with({both[0]}), std::hypot(0.01, 0.05, 0.1), 2e-3);
    // A receiver takes noise and fault off, and nothing of what both may have.
    const double own = 0.3 * std::sqrt((0.09 + 1.44) / (0.09 + 0.09 + 1.44));
    EXPECT_NEAR(with({both[1]}), std::hypot(own, 0.4, 0.1), 1e-9);
    EXPECT_LE(with(both), with({both[0]}));
    EXPECT_LT(with(both), with({both[1]}));
}

// The rows are the covariance's: whatever the sources share, their sum is its quadratic form.
TEST(WitnessedBudgets, HaveTheVarianceOfTheCovariance) {
    for (const double slow_m_s : {0.02, 0.05, 0.4}) {
        const std::vector<BudgetRow> alone = rows_of(0.3, slow_m_s, 0.0, 0.1);
        const WitnessedBudget heard = beside(alone, two_witnesses());
        EXPECT_NEAR(
            combine(heard.rows).standard_uncertainty,
            std::hypot(mean_of(speeds_of(heard.evidence, 60.0)).standard_uncertainty_m_s, 0.1),
            1e-9);
    }
}

TEST(WitnessedBudgets, OfAContradictionSayNothing) {
    const std::vector<BudgetRow> alone = rows_of(0.3, 0.4, 1.2, 0.1);
    for (const int kind : {0, 1, 2}) {
        auto witnesses = two_witnesses();
        if (kind == 0) witnesses[1].fault_posterior = 0.6;
        if (kind == 1) {
            witnesses[1].fault_posterior = 0.0;
            witnesses[1].chance_error = 1.1;
        }
        // Off to opposite sides: either agrees with the positions.
        if (kind == 2) {
            witnesses[0].difference_m_s = 1.0;
            witnesses[1].difference_m_s = -1.7;
        }
        const WitnessedBudget heard = beside(alone, witnesses);
        EXPECT_EQ(heard.position_share, 1.0);
        EXPECT_EQ(heard.evidence.disagreement > 1.0, kind == 2);
        EXPECT_EQ(heard.witnesses[0].share + heard.witnesses[1].share, 0.0);
        EXPECT_DOUBLE_EQ(combine(heard.rows).standard_uncertainty,
                         combine(alone).standard_uncertainty);
    }
    // One that confirms nothing has no share, whether it agrees or not.
    auto witnesses = two_witnesses();
    witnesses[0].confirms = witnesses[1].confirms = false;
    EXPECT_EQ(beside(alone, witnesses).position_share, 1.0);
    EXPECT_TRUE(beside(alone, witnesses).evidence.witnesses.empty());
}

TEST(ExpectedBesideVelocities, IsWhatAWitnessOfThatSizeMakes) {
    // The positions' own part of 0.5 m/s, bounded by 1.3: by hand, 1 Hz over 4 s.
    const std::vector<BudgetRow> rows = rows_of(0.3, 0.4, 1.2, 0.1);
    const double sigma = std::hypot(0.03, 0.1 * std::sqrt(1.0 / 4.0));
    const double share = 1.69 / (1.69 + sigma * sigma);
    const double apart = share * 0.6745 * std::hypot(0.5, sigma);
    const double mean = 1.69 * sigma * sigma / (1.69 + sigma * sigma);
    EXPECT_NEAR(expected_with_velocities(rows, 0.5, 0.2, 4.0, 1.0),
                2.0 * std::sqrt(mean + apart * apart + 0.01) + (1.0 - share) * 0.2, 1e-9);
    // More often recorded, they say more.
    EXPECT_LT(expected_with_velocities(rows, 0.05, 0.0, 4.0, 0.1),
              expected_with_velocities(rows, 0.05, 0.0, 4.0, 1.0));
}

/// A run of 60 m/s at 10 Hz with velocities beside its positions, which a row from 300 on drift.
struct Witnessed {
    ScreenedTable screened;
    TrajectoryTable trajectory;

    explicit Witnessed(double rate_m_s, bool velocities = true) {
        test::RecordedRun run{.to_s = 45.0, .sigma_m = 0.5};
        screened = test::recorded(run);
        RandomGenerator random(7);
        for (std::size_t k = 0; k < screened.rows.size(); ++k) {
            ScreenedEpoch& row = screened.rows[k];
            const double time_s = row.time.seconds();
            const double speed =
                (test::run_distance_m(time_s + 0.05) - test::run_distance_m(time_s - 0.05)) / 0.1;
            if (velocities) {
                row.recorded_velocity_east_m_s =
                    speed / std::numbers::sqrt2 + 0.05 * random.normal();
                row.recorded_velocity_north_m_s =
                    speed / std::numbers::sqrt2 + 0.05 * random.normal();
            }
            *row.east_m += rate_m_s * std::max(0.0, time_s - 30.0);
            *row.north_m += rate_m_s * std::max(0.0, time_s - 30.0);
        }
        VelocityErrors errors;
        errors.axes = TestedAxes::horizontal;
        errors.stated_m_s = 0.05;
        if (velocities) screened.basis.velocity_errors.push_back(errors);
        EstimationModel model;
        model.motion.jerk_density = 0.6;
        trajectory = test::smoothed_with(screened, test::summary_of(model));
        for (TrajectoryEpoch& row : trajectory.rows)
            row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = 0.3;
    }
    ProfileWindows windows() const {
        return find_windows(screened, trajectory, {test::rule_over(3.0)}, test::few_draws())
            .profiles.front();
    }
};

TEST(WitnessedWindow, ThatAgreesLeavesWhatTheWitnessLeaves) {
    const CertifiableWindow alone = Witnessed(0.0, false).windows().best.value();
    const CertifiableWindow best = Witnessed(0.0).windows().best.value();
    EXPECT_TRUE(alone.witnesses.empty());
    ASSERT_EQ(best.witnesses.size(), 1U);
    const WitnessedSpeed& witnessed = best.witnesses.front();
    EXPECT_LE(witnessed.normalised_error, 1.0);
    EXPECT_NEAR(witnessed.speed_m_s, 60.0, 0.15);
    EXPECT_NEAR(witnessed.standard_uncertainty_m_s, 0.05, 0.01);
    EXPECT_GT(witnessed.share, 0.5);
    EXPECT_LT(best.standard_uncertainty_m_s, 0.75 * alone.standard_uncertainty_m_s);
    EXPECT_LE(std::abs(best.speed_m_s - 60.0),
              2.0 * best.standard_uncertainty_m_s + best.bias_limit_m_s);
}

/// The best window in space, of a craft that goes down by 10 m/s.
CertifiableWindow in_space(Witnessed run) {
    NoiseSummary noise = test::summary_of({.motion = {.jerk_density = 0.6}});
    run.screened.facts.vertical_measured = run.trajectory.facts.vertical_measured = true;
    RandomGenerator random(11);
    for (ScreenedEpoch& row : run.screened.rows) {
        row.up_m = 3000.0 - 10.0 * row.time.seconds() + 0.5 * random.normal();
        row.sigma_up_m = 0.5;
    }
    run.trajectory.estimation.vertical = AxesEstimation{.noise = noise, .health = {}};
    for (const Arc<1>& arc : arcs_of<1>(run.screened)) {
        const Chain<1> smoothed = Chain<1>(arc.epochs, model_of(noise));
        for (std::size_t k = 0; k < arc.rows.size(); ++k) {
            const StateVector<1>& state = smoothed.mean(k);
            TrajectoryEpoch& epoch = run.trajectory.rows[arc.rows[k]];
            epoch.up_m = state(0);
            epoch.velocity_up_m_s = state(1);
            epoch.acceleration_up_m_s2 = state(2);
        }
    }
    Profile rule = test::rule_over(3.0);
    rule.dimension = Dimension::space;
    return find_windows(run.screened, run.trajectory, {rule}, test::few_draws())
        .profiles.front()
        .best.value();
}

// Velocities on the level took the rows of the positions down to a third, and their evidence was
// thrown away: a speed in space rests on positions, which they can only contradict.
TEST(WitnessedWindow, InSpaceRestsOnPositionsAlone) {
    const CertifiableWindow alone = in_space(Witnessed(0.0, false));
    const CertifiableWindow best = in_space(Witnessed(0.0));
    EXPECT_NEAR(best.speed_m_s, std::hypot(60.0, 10.0), 0.5);
    EXPECT_EQ(best.standard_uncertainty_m_s, alone.standard_uncertainty_m_s);
    EXPECT_EQ(best.speed_m_s, alone.speed_m_s);
    EXPECT_TRUE(best.evidence->witnesses.empty());
    EXPECT_EQ(std::ranges::count(best.budget, "g", &BudgetRow::symbol), 0);
    ASSERT_EQ(best.witnesses.size(), 1U);
    EXPECT_EQ(best.witnesses.front().share, 0.0);
    EXPECT_FALSE(best.witnesses.front().confirms);
}

// Positions that drift by 3 m/s show the faster windows; none of these can be claimed.
TEST(WitnessedWindow, ThatIsContradictedIsNotChosen) {
    const ProfileWindows drifting = Witnessed(3.0).windows();
    ASSERT_TRUE(drifting.best && drifting.fastest);
    EXPECT_GT(drifting.fastest->speed_m_s, 62.0);
    EXPECT_GT(drifting.fastest->witnesses.front().normalised_error, 1.0);
    EXPECT_LE(drifting.best->witnesses.front().normalised_error, 1.0);
    EXPECT_LE(std::abs(drifting.best->speed_m_s - drifting.best->witnesses.front().speed_m_s),
              2.0 * drifting.best->standard_uncertainty_m_s + drifting.best->bias_limit_m_s);
    // Without velocities nobody knows.
    EXPECT_FALSE(Witnessed(3.0, false).windows().fastest);
}

// The end of a session: 2 km/h faster by what it shows, and stated ten times as uncertain.
TEST(BestProof, IsNotTheFastestWindow) {
    ScreenedTable screened = test::recorded({.to_s = 40.0, .sigma_m = 0.05});
    for (std::size_t k = 330; k < screened.rows.size(); ++k) {
        ScreenedEpoch& row = screened.rows[k];
        row.sigma_east_m = row.sigma_north_m = 3.0;
        *row.east_m += 0.4 * (row.time.seconds() - 33.0);
        *row.north_m += 0.4 * (row.time.seconds() - 33.0);
    }
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    const TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    const ProfileWindows windows =
        find_windows(screened, trajectory, {test::rule_over(3.0)}, test::few_draws())
            .profiles.front();
    ASSERT_TRUE(windows.best && windows.fastest);
    EXPECT_LE(windows.best->span.last_epoch, 331);
    EXPECT_GT(windows.best->speed_m_s - 2.0 * windows.best->standard_uncertainty_m_s -
                  windows.best->bias_limit_m_s,
              windows.fastest->speed_m_s - 2.0 * windows.fastest->standard_uncertainty_m_s -
                  windows.fastest->bias_limit_m_s);
}

// A drift of 0.4 m/s that velocities show, and that is faster by less than it is uncertain.
TEST(BestProof, LiesOutsideADriftThatAWitnessDoubts) {
    const ProfileWindows drifting = Witnessed(0.4).windows();
    ASSERT_TRUE(drifting.best && drifting.fastest);
    EXPECT_GT(drifting.fastest->speed_m_s, drifting.best->speed_m_s);
    EXPECT_LT(drifting.best->evidence->fault_probability, 0.5);
    EXPECT_LE(std::abs(drifting.best->speed_m_s - 60.0),
              2.0 * drifting.best->standard_uncertainty_m_s + drifting.best->bias_limit_m_s);
}

/// Without the rows from one to before another.
ScreenedTable without(ScreenedTable table, std::size_t from, std::size_t to) {
    table.rows.erase(table.rows.begin() + static_cast<std::ptrdiff_t>(from),
                     table.rows.begin() + static_cast<std::ptrdiff_t>(to));
    return table;
}

std::optional<CertifiableWindow> best_of(const ScreenedTable& screened, const Profile& profile) {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    return find_windows(screened, test::smoothed_with(screened, test::summary_of(model)), {profile},
                        test::few_draws())
        .profiles.front()
        .best;
}

// Of 4.1 s at full speed half a second is missing: a window of 3 s must hold the gap.
TEST(GapInAWindow, IsBridgedWhereTheRuleAllowsTheRateThatIsLeft) {
    const ScreenedTable whole = test::recorded({.from_s = 40.0, .to_s = 44.1});
    const ScreenedTable gapped = without(whole, 18, 22);
    const auto bridged = best_of(gapped, test::rule_over(3.0));
    ASSERT_TRUE(bridged);
    EXPECT_NEAR(bridged->speed_m_s, 60.0, 0.05);
    Profile asking = test::rule_over(3.0);
    asking.clauses.push_back({.id = "rate",
                              .text = {},
                              .source = {},
                              .decided_by = Computation::sampling_rate,
                              .limit = 5.0,
                              .unit = "Hz"});
    EXPECT_FALSE(best_of(gapped, asking));
    asking.clauses.front().limit = 2.0;
    EXPECT_TRUE(best_of(gapped, asking));
    // A mean of speeds would count the time of the gap for nothing.
    EXPECT_FALSE(best_of(gapped, test::rule_over(3.0, SpeedDefinition::mean_n)));
    EXPECT_TRUE(best_of(whole, test::rule_over(3.0, SpeedDefinition::mean_n)));
}

// What calls itself worthless is no evidence; what does not is.
TEST(Indicated, ComparesWhatEpochsStateOfThemselves) {
    ScreenedTable screened = test::recorded({.to_s = 40.0});
    *screened.rows[5].east_m += 2000.0;
    screened.rows[5].usable = false;
    screened.rows[5].reason = Reason::accuracy_absurd;
    screened.rows[5].sigma_east_m = screened.rows[5].sigma_north_m = 1409.0;
    const auto of = [&] {
        return fastest_indicated(screened, test::rule_over(3.0), test::few_draws(), std::nullopt)
            .value();
    };
    EXPECT_NEAR(of().speed_m_s, 60.0, 0.1);
    EXPECT_TRUE(of().refusals.empty());
    screened.rows[5].sigma_east_m = screened.rows[5].sigma_north_m = 1.0;
    screened.rows[5].reason = Reason::burst;
    EXPECT_GT(of().speed_m_s, 600.0);
    ASSERT_EQ(of().refusals.size(), 1U);
    EXPECT_NE(of().refusals.front().find("0.5 s after the first epoch"), std::string::npos)
        << of().refusals.front();
}

TEST(Indicated, NamesTheGapItsLengthAndTheKey) {
    ScreenedTable screened = without(test::recorded({.from_s = 40.0, .to_s = 45.0}), 20, 45);
    screened.rows[20].break_before = ArcBreak::gap;
    const auto indicated =
        fastest_indicated(screened, test::rule_over(3.0), test::few_draws(), std::nullopt);
    ASSERT_TRUE(indicated && indicated->refusals.size() == 1U);
    EXPECT_EQ(indicated->refusals.front(),
              "a gap of 2.6 s 4.5 s after the first epoch (longer than screen.gap_max_s, 2 s)");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

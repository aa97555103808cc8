#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "stages/window/position_noise.h"
#include "stages/window/sample_series.h"
#include "stages/window/selection.h"
#include "window_test_support.h"

// Windows across bridged steps.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::size_t step_row = 150;

EstimationModel motion() {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    return model;
}

EstimationModel bounded() {
    EstimationModel model = motion();
    model.error = GaussMarkovError::bounding(0.02, 0.5, 10.0);
    return model;
}

/// The run of [DHD22] from 20 s on; from a row in it, positions are offset towards east.
struct SteppedRun {
    ScreenedTable screened = test::recorded({.from_s = 20.0, .to_s = 50.0});
    TrajectoryTable trajectory;

    explicit SteppedRun(double offset_m) {
        test::add_bridged_step(screened, step_row, offset_m);
        trajectory = test::smoothed_with(screened, test::summary_of(motion()));
    }
    Arc<2> arc() const { return arcs_of<2>(screened).front(); }
};

/// How many windows can be certified, and how many of them hold the step.
struct Count {
    std::size_t all = 0;
    std::size_t across = 0;
};

Count windows_of(const TrajectoryTable& trajectory, BridgedSteps bridged) {
    const auto arcs = arcs_in(trajectory);
    const auto windows = certifiable_windows(trajectory, arcs, 3.0, 0.001, bridged);
    Count count;
    for (const EpochPair& window : windows.at(0)) {
        ++count.all;
        if (window.first < step_row && window.last >= step_row) ++count.across;
    }
    return count;
}

TEST(BridgedWindows, AreCertifiableOnlyWhereAllowed) {
    SteppedRun run(0.5);
    const Count refused = windows_of(run.trajectory, BridgedSteps::refused);
    const Count allowed = windows_of(run.trajectory, BridgedSteps::allowed);
    EXPECT_EQ(allowed.all, 301U - 30U);
    EXPECT_EQ(allowed.across, 30U);
    EXPECT_EQ(refused.all, allowed.all - 30U);
    EXPECT_EQ(refused.across, 0U);
    // A window may begin with the first of the offset positions, or end just before it.
    const auto windows = certifiable_windows(run.trajectory, arcs_in(run.trajectory), 3.0, 0.001,
                                             BridgedSteps::refused);
    EXPECT_EQ(windows[0][step_row - 30].first, step_row);
    EXPECT_EQ(windows[0][step_row - 31].last, step_row - 1);
    // An unusable epoch is an obstacle either way.
    run.trajectory.rows[step_row].usable = false;
    EXPECT_EQ(windows_of(run.trajectory, BridgedSteps::refused).all, 301U - 30U - 31U);
    EXPECT_EQ(windows_of(run.trajectory, BridgedSteps::allowed).all, 301U - 30U - 31U);
}

TEST(BridgedWindows, SpeedsOfTheSearchAreThoseOfTheSmoother) {
    for (const double offset_m : {0.0, 0.5, -40.0}) {
        const SteppedRun run(offset_m);
        const SmoothedArc<2> smoothed = smooth<2>(run.arc().epochs, motion());
        const EpochPair window{step_row - 12, step_row + 18};
        const auto expected = [&](SpeedDefinition definition) {
            return speed_by_definition(smoothed, window, 3.0, {definition}).speed_m_s;
        };
        for (const SpeedDefinition definition :
             {SpeedDefinition::displacement, SpeedDefinition::path_length,
              SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
            Profile profile = test::rule_over(3.0, definition);
            profile.repaired_steps = true;
            const auto all = allowed_and_best(certifiable_series(run.screened, run.trajectory,
                                                                 arcs_in(run.trajectory), profile),
                                              window_criteria(profile, 0.001, 0.1), 1)
                                 .all;
            const auto found = std::ranges::find(all, window.first, &FoundWindow::first);
            ASSERT_NE(found, all.end());
            EXPECT_EQ(found->last, window.last);
            EXPECT_NEAR(found->speed_m_s, expected(definition), 1e-9)
                << to_text(definition) << ", " << offset_m << " m";
            EXPECT_NEAR(found->speed_m_s, 60.0, 0.02);
        }
    }
}

TEST(BridgedWindows, ManyStepsAddUp) {
    SteppedRun run(0.5);
    test::add_bridged_step(run.screened, step_row + 1, -3.0);
    test::add_bridged_step(run.screened, step_row + 7, 0.25);
    run.trajectory = test::smoothed_with(run.screened, test::summary_of(motion()));
    Profile profile = test::rule_over(3.0);
    profile.repaired_steps = true;
    const auto series =
        certifiable_series(run.screened, run.trajectory, arcs_in(run.trajectory), profile);
    const auto& positions = series.front().positions;
    const SmoothedArc<2> smoothed = smooth<2>(run.arc().epochs, motion());
    for (const EpochPair window : {EpochPair{0, 300}, EpochPair{149, 150}, EpochPair{150, 157}})
        EXPECT_LT((Eigen::Vector3d(positions[window.last] - positions[window.first]).head<2>() -
                   displacement(smoothed, window.first, window.last))
                      .norm(),
                  1e-9);
}

TEST(BridgedWindows, PartsOfTheUncertaintyAddUpAndTheOffsetChangesNothing) {
    const EpochPair window{step_row - 12, step_row + 18};
    const SteppedRun without(0.0);
    const SteppedRun with(0.5);
    for (const SpeedDefinition definition :
         {SpeedDefinition::displacement, SpeedDefinition::path_length, SpeedDefinition::mean_n}) {
        const auto noise_of = [&](const SteppedRun& run) {
            const WindowStretch<2> stretch = cut_stretch(run.arc(), window, 60.0);
            const EstimationModel model = motion();
            const SmoothedArc<2> smoothed = smooth<2>(stretch.epochs, model);
            const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                        .smoothed = smoothed,
                                        .model = model,
                                        .window = stretch.window,
                                        .duration_s = stretch.duration_s};
            ErrorBound bound;
            bound.tau_min_s = 0.5;
            bound.tau_max_s = 10.0;
            return position_noise(at, {definition}, speed_weights(at, {definition}),
                                  bounded().error, bound);
        };
        const PositionNoise noise = noise_of(with);
        const PositionNoise same = noise_of(without);
        EXPECT_NEAR(noise.displacement_m, same.displacement_m, 1e-4);
        EXPECT_NEAR(noise.displacement_m, 180.0, 0.06);
        EXPECT_NEAR(noise.speed.speed_m_s, same.speed.speed_m_s, 1e-5);
        const double u = noise.speed.standard_uncertainty_m_s;
        EXPECT_NEAR(std::pow(noise.white_m_s, 2) + std::pow(noise.correlated_m_s, 2) +
                        std::pow(noise.motion_m_s, 2),
                    u * u, 1e-6 * u * u)
            << to_text(definition);
    }
}

TEST(BridgedWindows, RadiusOfThePositionHoldsTheOffset) {
    const SteppedRun run(0.5);
    const SmoothedArc<2> smoothed = smooth<2>(run.arc().epochs, motion());
    ErrorBound bound;
    bound.sigma_m = 0.02;
    const double before = position_r95_m(smoothed, {step_row - 40, step_row - 10}, bound);
    const double across = position_r95_m(smoothed, {step_row - 12, step_row + 18}, bound);
    // sqrt(chi-squared) of two degrees of freedom at 95 % is 2.448.
    EXPECT_GT(before, 2.447 * 0.02);
    EXPECT_LT(before, 2.448 * std::hypot(0.02, 0.01));
    EXPECT_NEAR(across - before, 0.5, 0.02);
}

TEST(CutStretch, SaysWhereItBegins) {
    const Arc<2> arc = SteppedRun(0.5).arc();
    const WindowStretch<2> stretch = cut_stretch(arc, {step_row - 12, step_row + 18}, 2.0);
    EXPECT_EQ(stretch.first, step_row - 32);
    EXPECT_EQ(stretch.epochs.front().time_s, arc.epochs[stretch.first].time_s);
    EXPECT_EQ(stretch.window.first + stretch.first, step_row - 12);
    EXPECT_TRUE(stretch.epochs[32].step_before);
    EXPECT_EQ(cut_stretch(arc, {10, 40}, 60.0).first, 0U);
}

/// Windows of 3 s that all hold the step, the one in the middle chosen.
WindowCluster<2> across_step(const Arc<2>& arc) {
    WindowCluster<2> cluster;
    cluster.arc = &arc;
    for (std::size_t k = step_row - 25; k < step_row - 5; ++k)
        cluster.windows.push_back({k, k + 30});
    cluster.chosen = 10;
    return cluster;
}

SelectionBias bias_of(Arc<2> arc, double stated_m_s = 60.0) {
    return selection_bias<2>({across_step(arc)}, {.estimated = motion(), .bound_m = 0.02},
                             stated_m_s, 200, 1);
}

TEST(BridgedWindows, SelectionDoesNotDependOnTheOffset) {
    const SelectionBias none = bias_of(SteppedRun(0.0).arc());
    const SelectionBias some = bias_of(SteppedRun(0.5).arc());
    EXPECT_NEAR(some.bias_m_s, none.bias_m_s, 1e-5);
    EXPECT_NEAR(some.chosen_sd_m_s, none.chosen_sd_m_s, 1e-5);
    EXPECT_NEAR(some.best_mean_m_s, none.best_mean_m_s, 1e-4);
    EXPECT_NEAR(some.best_mean_m_s, 60.0, 0.03);
    // Across the step less is known than without one: errors scatter more.
    ScreenedTable whole = test::recorded({.from_s = 20.0, .to_s = 50.0});
    EXPECT_GT(some.chosen_sd_m_s, 1.02 * bias_of(arcs_of<2>(whole).front()).chosen_sd_m_s);
}

TEST(BridgedWindows, AStepBeforeADroppedEpochStandsBeforeTheNext) {
    // Rejected by the robust search's standards, the epoch of the step has no measurement.
    SteppedRun dropped(0.5);
    dropped.screened.rows[step_row].usable = false;
    SteppedRun later(0.0);
    later.screened.rows[step_row].usable = false;
    for (std::size_t k = step_row; k < later.screened.rows.size(); ++k)
        *later.screened.rows[k].east_m += 0.5;
    later.screened.rows[step_row].break_before.reset();
    later.screened.rows[step_row + 1].break_before = ArcBreak::bridged;
    const SelectionBias a = bias_of(dropped.arc());
    const SelectionBias b = bias_of(later.arc());
    EXPECT_EQ(a.bias_m_s, b.bias_m_s);
    EXPECT_EQ(a.best_mean_m_s, b.best_mean_m_s);
    EXPECT_NEAR(a.best_mean_m_s, 60.0, 0.03);
}

/// The only windows of 3 s hold the step.
struct ShortRun {
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 33.5});
    TrajectoryTable trajectory;
    Profile profile = test::rule_over(3.0);

    ShortRun() {
        test::add_bridged_step(screened, 17, 0.5);
        trajectory = test::smoothed_with(screened, test::summary_of(motion()));
        for (TrajectoryEpoch& row : trajectory.rows) {
            row.robust_east_m = row.east_m;
            row.robust_north_m = row.north_m;
            row.robust_weight = 1.0;
        }
        profile.repaired_steps = true;
    }
    ProfileWindows windows() const {
        return find_windows(screened, trajectory, {profile}, test::few_draws()).profiles.at(0);
    }
};

TEST(BridgedWindows, AreCertifiedUnderAProfileThatAllowsThem) {
    ShortRun run;
    const ProfileWindows allowed = run.windows();
    EXPECT_EQ(allowed.candidates, 6);
    const CertifiableWindow& best = allowed.best.value();
    EXPECT_EQ(best.repaired_steps, 1);
    EXPECT_NEAR(best.speed_m_s, 60.0, 3.0 * best.standard_uncertainty_m_s);
    EXPECT_NEAR(best.displacement_m, 180.0, 0.1);
    EXPECT_GT(best.position_r95_m, 0.5);
    run.profile.repaired_steps = false;
    const ProfileWindows refused = run.windows();
    EXPECT_EQ(refused.candidates, 0);
    EXPECT_FALSE(refused.best);
}

TEST(BridgedWindows, RobustPositionsAreComparedWithoutTheirOffset) {
    ShortRun run;
    const RobustSpeed robust = run.windows().best->robust.value();
    EXPECT_TRUE(robust.agrees);
    EXPECT_NEAR(robust.difference_m_s, 0.0, 1e-6);
    // An offset of its own changes nothing; more of the run after the step does.
    for (std::size_t k = 17; k < run.trajectory.rows.size(); ++k)
        *run.trajectory.rows[k].robust_north_m += 2.0;
    EXPECT_NEAR(run.windows().best->robust->difference_m_s, 0.0, 1e-6);
    for (std::size_t k = 20; k < run.trajectory.rows.size(); ++k)
        *run.trajectory.rows[k].robust_north_m += 0.3;
    EXPECT_NEAR(run.windows().best->robust->difference_m_s, 0.1 / std::numbers::sqrt2, 1e-3);
}

TEST(BridgedWindows, ATrajectoryWithoutTheStepsIsRefused) {
    ShortRun run;
    EXPECT_NO_THROW(run.windows());
    run.trajectory.rows[17].step_before.reset();
    EXPECT_THROW(run.windows(), Failure);
}

TEST(BridgedWindows, IndicatedAreRefusedForTheStepUnlessAllowed) {
    ShortRun run;
    EXPECT_TRUE(run.windows().indicated->refusals.empty());
    run.profile.repaired_steps = false;
    const std::vector<std::string> refusals = run.windows().indicated->refusals;
    ASSERT_EQ(refusals.size(), 1U);
    EXPECT_EQ(refusals[0].rfind("1 repaired step", 0), 0U) << refusals[0];
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

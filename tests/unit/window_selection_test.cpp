#include <gtest/gtest.h>

#include "core/failure.h"
#include "motion/noise_fit.h"
#include "stages/window/selection.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

EstimationModel searched() {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    return model;
}

SelectionModels models() {
    return {.estimated = searched(), .bound_m = 0.02};
}

/// All windows of 3 s of an arc that begin in the first `begins` epochs from the fifth second on.
WindowLeg windows_of(std::size_t arc, std::size_t begins, std::optional<std::size_t> chosen = {}) {
    WindowLeg leg{.windows = {}, .chosen = chosen};
    for (std::size_t k = 0; k < begins; ++k) {
        FoundWindow& window = leg.windows.emplace_back();
        window.series = arc;
        window.first = 50 + k;
        window.last = 80 + k;
    }
    return leg;
}

/// One arc or two, each 15 s at top speed.
std::vector<Arc<2>> at_top_speed(int count) {
    ScreenedTable table = test::recorded({.from_s = 30.0, .to_s = 45.0, .seed = 1});
    if (count == 2) test::append_arc(table, {.from_s = 30.0, .to_s = 45.0, .seed = 2});
    return arcs_of<2>(table);
}

TEST(SelectionBias, OneWindowLeavesNoChoice) {
    const auto arcs = at_top_speed(1);
    const SelectionBias bias =
        selection_bias<2>(arcs, {windows_of(0, 1, 0)}, models(), 60.0, 100, 1);
    EXPECT_EQ(bias.candidates, 1);
    // What is left is what smoothing itself does to a window at steady speed.
    EXPECT_NEAR(bias.bias_m_s, 0.0, 1e-6);
    EXPECT_LT(bias.bias_uncertainty_m_s, 1e-6);
    EXPECT_EQ(bias.chosen_mean_m_s, 60.0 - bias.bias_m_s);
    EXPECT_GT(bias.chosen_sd_m_s, 0.0);
}

TEST(SelectionBias, IsNotSimulatedWhereNothingHangsOnIt) {  // noise took minutes and a gigabyte
    const auto arcs = at_top_speed(1);
    const SelectionBias bias = selection_bias<2>(arcs, {windows_of(0, 21)}, models(), 60.0, 0, 1);
    EXPECT_EQ(bias.candidates, 21);
    EXPECT_EQ(bias.samples, 0);
    EXPECT_EQ(bias.bounded_bias_m_s, 0.0);
    EXPECT_EQ(bias.chosen_mean_m_s, 60.0);
}

TEST(SelectionBias, GrowsWithTheWindowsToChooseFrom) {
    const auto arcs = at_top_speed(2);
    const auto bias_of = [&](const std::vector<WindowLeg>& legs) {
        return selection_bias<2>(arcs, legs, models(), 60.0, 500, 1);
    };
    const SelectionBias of_21 = bias_of({windows_of(0, 21, 10)});
    const SelectionBias of_61 = bias_of({windows_of(0, 61, 30)});
    const SelectionBias of_122 = bias_of({windows_of(0, 61, 30), windows_of(1, 61)});
    EXPECT_EQ(of_122.candidates, 122);
    // Beyond chance: three standard uncertainties of the difference.
    const auto chance = [](const SelectionBias& a, const SelectionBias& b) {
        return 3.0 * std::hypot(a.bias_uncertainty_m_s, b.bias_uncertainty_m_s);
    };
    EXPECT_GT(of_21.bias_m_s, 3.0 * of_21.bias_uncertainty_m_s);
    EXPECT_GT(of_61.bias_m_s, of_21.bias_m_s + chance(of_61, of_21));
    EXPECT_GT(of_122.bias_m_s, of_61.bias_m_s + chance(of_122, of_61));
}

TEST(SelectionBias, GrowsWithTheBoundAndNotBelowTheFitted) {
    const auto arcs = at_top_speed(1);
    const std::vector<WindowLeg> legs{windows_of(0, 61, 30)};
    SelectionModels none = models();
    none.bound_m = 0.0;
    SelectionModels large = models();
    large.bound_m = 0.1;
    const SelectionBias of_none = selection_bias<2>(arcs, legs, none, 60.0, 500, 1);
    const SelectionBias of_20_mm = selection_bias<2>(arcs, legs, models(), 60.0, 500, 1);
    const SelectionBias of_100_mm = selection_bias<2>(arcs, legs, large, 60.0, 500, 1);
    EXPECT_NEAR(of_none.bounded_bias_m_s, of_none.fitted_bias_m_s, 0.05 * of_none.fitted_bias_m_s);
    EXPECT_EQ(of_20_mm.fitted_bias_m_s, of_none.fitted_bias_m_s);
    EXPECT_GT(of_20_mm.bounded_bias_m_s, 1.5 * of_20_mm.fitted_bias_m_s);
    // For errors far larger than the white noise it is of their size.
    EXPECT_NEAR(of_100_mm.bounded_bias_m_s / of_20_mm.bounded_bias_m_s, 5.0, 1.5);
}

TEST(WindowLegs, AreOfWindowsThatOverlap) {
    const auto window = [](std::size_t series, std::size_t first, double speed_m_s) {
        FoundWindow found;
        found.series = series;
        found.first = first;
        found.last = first + 20;
        found.start.nanoseconds = static_cast<std::int64_t>(first);
        found.end.nanoseconds = found.start.nanoseconds + 20;
        found.speed_m_s = speed_m_s;
        return found;
    };
    const std::vector<FoundWindow> all{window(1, 0, 15.0),  window(0, 0, 15.0),
                                       window(0, 20, 15.2), window(0, 25, 13.0),
                                       window(0, 40, 15.0), window(0, 61, 15.0)};
    const auto legs = legs_of(all, all[2], 14.0);
    ASSERT_EQ(legs.size(), 3U);
    EXPECT_EQ(legs[0].windows.size(), 3U);  // the slow one is none
    EXPECT_EQ(legs[0].chosen, 1U);
    EXPECT_EQ(legs[1].windows.front().first, 61U);
    EXPECT_FALSE(legs[1].chosen);
    EXPECT_EQ(legs[2].series(), 1U);
    EXPECT_EQ(legs_of(all, all[2], 14.0, 30).size(), 4U);
}

TEST(ChoiceSimulation, CountsTheErrorOfTheWindowThatIsThenTheFastest) {
    // The second becomes the fastest, of two speeds north and east.
    const Rivals rivals{.components = 2,
                        .velocities_m_s = {0.0, 10.0, 9.5, 0.0},
                        .allowances_m_s = {0.0, 0.1},
                        .legs = {0, 1}};
    const Eigen::Vector4d errors(0.0, 0.2, 1.0, 0.0), none = Eigen::Vector4d::Zero();
    const SimulatedChoice choice = ChoiceSimulation(rivals)(errors, none);
    EXPECT_DOUBLE_EQ(choice.error, 1.0);
    EXPECT_DOUBLE_EQ(choice.calibrated, 1.0 - 0.2);
    EXPECT_DOUBLE_EQ(choice.best_true, 10.0);
    // Errors that part them before keep it the slower.
    const SimulatedChoice parted =
        ChoiceSimulation(rivals)(errors, Eigen::Vector4d(0.0, 2.0, 0.0, 0.0));
    EXPECT_DOUBLE_EQ(parted.calibrated, 2.0 * (1.0 - 0.2) - (0.2 - 0.2));
}

TEST(ChoiceSimulation, DrawsLegsTogetherThatErrorsExplain) {
    const Rivals rivals{.velocities_m_s = {14.9, 15.0, 15.1},
                        .allowances_m_s = {0.0, 0.0, 0.0},
                        .legs = {0, 1, 2},
                        .chosen = 2};
    const Eigen::Vector3d errors(0.1, 0.0, 0.0), none = Eigen::Vector3d::Zero();
    EXPECT_DOUBLE_EQ(ChoiceSimulation(rivals)(errors, none).error, 0.0);
    EXPECT_NEAR(ChoiceSimulation(rivals, 0.2)(errors, none).error, 0.1, 1e-12);
    EXPECT_NEAR(ChoiceSimulation(rivals, 0.2)(errors, none).best_true, 15.0, 1e-12);
}

/// A time-correlated error of 30 mm that forgets within two seconds, and windows to choose from.
struct SlowErrors {
    std::vector<Arc<2>> arcs = at_top_speed(1);
    std::vector<WindowLeg> legs{windows_of(0, 61, 30)};
    SelectionModels models = RUNCERT_FILE::models();

    SlowErrors() {
        models.estimated.error = GaussMarkovError::steady(0.03, 2.0);
        models.bound_m = 0.0;
    }
    SelectionBias bias() const { return selection_bias<2>(arcs, legs, models, 60.0, 300, 1); }
};

TEST(SelectionBias, OfTheBoundWithTheFittedTimeAloneIsThatOfTheFit) {
    // The drawn processes are then the same, whichever way they are come to.
    SlowErrors at;
    at.models.tau_min_s = at.models.tau_max_s = 2.0;
    for (const double bound_m : {0.0, 0.02, 0.03}) {
        at.models.bound_m = bound_m;
        const SelectionBias bias = at.bias();
        EXPECT_GT(bias.fitted_bias_m_s, 0.005);
        EXPECT_NEAR(bias.bounded_bias_m_s / bias.fitted_bias_m_s, 1.0, 1e-6) << bound_m;
    }
    at.models.bound_m = 0.06;
    EXPECT_GT(at.bias().bounded_bias_m_s, 1.5 * at.bias().fitted_bias_m_s);
}

TEST(SelectionBias, AnErrorThatWandersAsFastForLongerIsLarger) {
    // 30 mm in two seconds is 30 mm/s^0.5: in 50 s 150 mm, which the bound of no size still has.
    SlowErrors at;
    at.models.tau_min_s = 2.0;
    at.models.tau_max_s = 50.0;
    const SelectionBias longer = at.bias();
    EXPECT_GT(longer.bounded_bias_m_s, 1.1 * longer.fitted_bias_m_s);
    // Of 3 s windows a diffusion makes no more than its whole in so long.
    EXPECT_LT(longer.bounded_bias_m_s, 3.0 * longer.fitted_bias_m_s);
}

TEST(SelectionBias, IsOfTheErrorAsLargeAsItIsAlongTheWindows) {
    // Draws of sqrt(2) times the fitted error, by the share along and by the bound.
    SlowErrors at;
    at.models.tau_min_s = at.models.tau_max_s = 2.0;
    const double even_m_s = at.bias().fitted_bias_m_s;
    at.models.along = std::sqrt(2.0);
    const SelectionBias along = at.bias();
    EXPECT_GT(along.fitted_bias_m_s, 1.2 * even_m_s);
    EXPECT_NEAR(along.bounded_bias_m_s / along.fitted_bias_m_s, 1.0, 1e-6);
    at.models.along = 1.0;
    at.models.bound_m = 0.03 * std::sqrt(2.0);
    EXPECT_NEAR(at.bias().bounded_bias_m_s / along.fitted_bias_m_s, 1.0, 0.15);
}

TEST(SelectionBias, IsTheSameForASeed) {
    const auto arcs = at_top_speed(1);
    const std::vector<WindowLeg> legs{windows_of(0, 31, 4)};
    const SelectionBias a = selection_bias<2>(arcs, legs, models(), 60.0, 100, 7);
    const SelectionBias b = selection_bias<2>(arcs, legs, models(), 60.0, 100, 7);
    const SelectionBias other = selection_bias<2>(arcs, legs, models(), 60.0, 100, 8);
    EXPECT_EQ(a.bias_m_s, b.bias_m_s);
    EXPECT_EQ(a.bias_uncertainty_m_s, b.bias_uncertainty_m_s);
    EXPECT_EQ(a.best_mean_m_s, b.best_mean_m_s);
    EXPECT_EQ(a.chosen_sd_m_s, b.chosen_sd_m_s);
    EXPECT_NE(a.bias_m_s, other.bias_m_s);
    EXPECT_EQ(a.seed, 7);
    EXPECT_EQ(a.samples, 100);
    EXPECT_EQ(a.chosen_mean_m_s, 60.0 - a.bias_m_s);
}

/// The run of [DHD22] at 10 Hz with 10 mm noise, cut so that 10 s are at top speed, through the
/// search with noise fitted to it.
struct Searched {
    ScreenedTable screened = test::recorded({.to_s = 40.0, .sigma_m = 0.010, .seed = 3});
    TrajectoryTable trajectory;
    WindowConfig config;

    Searched() {
        const auto arcs = arcs_of<2>(screened);
        const std::vector<std::span<const ArcEpoch<2>>> spans{arcs.front().epochs};
        NoiseFitOptions options;
        options.initial_jerk_density = 0.6;
        options.motion = NoiseFitOptions::Motion::constant_acceleration;
        const NoiseFit fit = fit_noise<2>(spans, options);
        trajectory = test::smoothed_with(screened, test::summary_of(fit.model));
        config.duration_tolerance_s = 0.001;
        config.monte_carlo_trials_max = 100'000;
    }
    CertifiableWindow best(bool subtract) const {
        Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
        profile.uncertainty.selection_bias =
            subtract ? SelectionTreatment::subtracted : SelectionTreatment::covered;
        return find_windows(screened, trajectory, {profile}, config).profiles.at(0).best.value();
    }
};

const BudgetRow& row_f(const CertifiableWindow& window) {
    for (const BudgetRow& row : window.budget)
        if (row.symbol == "f") return row;
    throw Failure("budget", "there is no row f", "");
}

TEST(SelectionBias, OfTheRunOfThePaperIsSomeMillimetresPerSecond) {
    const CertifiableWindow covered = Searched().best(false);
    const SelectionBias& bias = covered.selection.value();
    RecordProperty("bias_mm_per_s", std::to_string(bias.bias_m_s * 1e3));
    EXPECT_GT(bias.fitted_bias_m_s, 0.0015);
    EXPECT_LT(bias.fitted_bias_m_s, 0.005);
    // Were there a time-correlated error of the 20 mm allowed for, it would be 60 m/h: 17 mm/s.
    EXPECT_GT(bias.bounded_bias_m_s, 0.010);
    EXPECT_LT(bias.bounded_bias_m_s, 0.024);
    EXPECT_LT(bias.bias_uncertainty_m_s, 0.0005);
    EXPECT_GT(bias.candidates, 50);
    EXPECT_EQ(bias.treatment, SelectionTreatment::covered);
    // The truly best window is no faster than the run, and no slower than the chosen one.
    EXPECT_NEAR(bias.best_mean_m_s, 60.0, 0.02);
    EXPECT_NEAR(bias.chosen_mean_m_s, 60.0, 3.0 * covered.standard_uncertainty_m_s);
    // A bias is no standard deviation: covered, the larger one is beside the budget.
    EXPECT_EQ(row_f(covered).contribution_m_s, bias.bias_uncertainty_m_s);
    EXPECT_EQ(row_f(covered).estimate, 0.0);
    EXPECT_EQ(covered.bias_limit_m_s, bias.bounded_bias_m_s);
    EXPECT_GT(bias.bounded_bias_m_s, bias.fitted_bias_m_s);
    EXPECT_EQ(bias.bias_m_s, 0.5 * (bias.fitted_bias_m_s + bias.bounded_bias_m_s));
    EXPECT_EQ(bias.bias_half_range_m_s, 0.5 * (bias.bounded_bias_m_s - bias.fitted_bias_m_s));
}

TEST(SelectionBias, SubtractedTheSpeedIsLowerByItAndItsOwnUncertaintyStays) {
    const Searched run;
    const CertifiableWindow covered = run.best(false);
    const CertifiableWindow subtracted = run.best(true);
    const SelectionBias& bias = subtracted.selection.value();
    EXPECT_EQ(bias.treatment, SelectionTreatment::subtracted);
    EXPECT_EQ(bias.bias_m_s, covered.selection->bias_m_s);
    EXPECT_EQ(subtracted.speed_m_s, covered.speed_m_s - bias.bias_m_s);
    EXPECT_EQ(row_f(subtracted).contribution_m_s, bias.bias_uncertainty_m_s);
    EXPECT_EQ(row_f(subtracted).estimate, bias.bias_m_s);
    EXPECT_EQ(row_f(subtracted).sensitivity, -1.0);
    EXPECT_EQ(subtracted.standard_uncertainty_m_s, covered.standard_uncertainty_m_s);
    EXPECT_EQ(subtracted.bias_limit_m_s, bias.bias_half_range_m_s);
    EXPECT_LT(subtracted.bias_limit_m_s, covered.bias_limit_m_s);
}

TEST(SelectionBias, OfACraftThatStandsLeavesItNoNegativeSpeed) {
    EXPECT_DOUBLE_EQ(less_bias(0.5, 0.2), 0.3);
    EXPECT_EQ(less_bias(0.02, 0.15), 0.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

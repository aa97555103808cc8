#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/geodesy.h"
#include "stages/window/budget.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A window of 3 s at 10 Hz, 60 m/s towards east, from a trajectory fitted with jerk density 0.6
/// and 1.25 times the stated standard deviations, whose positions alone give 5 mm/s.
struct Scene {
    TrajectoryTable trajectory;
    WindowConfig config;
    PositionSpeed measured;
    ErrorBound bound;
    SelectionBias selection;

    Scene() {
        EstimationModel model;
        model.motion.jerk_density = 0.6;
        model.measurement_scale = 1.25;
        trajectory.estimation.horizontal =
            AxesEstimation{.noise = test::summary_of(model), .health = {}};
        fit().measurement_scale.relative_uncertainty = 0.05;
        fit().jerk_density.relative_uncertainty = 0.25;
        trajectory.facts.nominal_interval_s = 0.1;
        trajectory.facts.georeferenced = true;
        trajectory.facts.time_source = "satellites";
        trajectory.facts.vertical_measured = true;
        for (std::int64_t k = 0; k <= 30; ++k) {
            TrajectoryEpoch& row = trajectory.rows.emplace_back();
            row.epoch = k + 1;
            row.time = {k * 100'000'000};
            row.east_m = 6.0 * static_cast<double>(k);
            row.north_m = 0.0;
        }
        set_speed(60.0);
        measured.white_m_s = 0.003;
        measured.correlated_m_s = 0.004;
        measured.motion_m_s = 0.0;
        measured.speed.standard_uncertainty_m_s = 0.005;
        selection.treatment = SelectionTreatment::covered;
        selection.samples = 1000;
    }
    NoiseSummary& fit() { return trajectory.estimation.horizontal.noise; }
    void set_speed(double speed_m_s) {
        measured.speed.speed_m_s = speed_m_s;
        measured.displacement_m = 3.0 * speed_m_s;
    }
    BudgetInput input() const {
        return {.trajectory = trajectory,
                .config = config,
                .measured = measured,
                .bound = bound,
                .selection = selection,
                .first_row = 0,
                .last_row = 30,
                .duration_s = 3.0,
                .mean_interval_s = mean_interval_s,
                .reliability = reliability,
                .detection_power = 0.8,
                .fault = fault};
    }
    double mean_interval_s = 0.0;
    std::vector<UndetectedError> reliability;
    WindowFault fault;
    std::vector<BudgetRow> rows() const { return budget_of(input()); }
    BudgetRow row(const std::string& symbol) const {
        for (const BudgetRow& one : rows())
            if (one.symbol == symbol) return one;
        ADD_FAILURE() << "no row " << symbol;
        return {};
    }
    MonteCarloCheck check() const { return monte_carlo(input(), rows(), measured.speed.speed_m_s); }
};

TEST(Budget, EverySourceHasItsRowAlsoWhereItGivesNothing) {
    std::string symbols;
    for (const BudgetRow& row : Scene().rows()) {
        symbols += row.symbol;
        EXPECT_FALSE(row.source.empty()) << row.symbol;
        EXPECT_FALSE(row.note.empty()) << row.symbol;
        EXPECT_TRUE(row.type == "A" || row.type == "B") << row.symbol;
        EXPECT_NEAR(row.contribution_m_s, row.standard_uncertainty * std::abs(row.sensitivity),
                    1e-15)
            << row.symbol;
    }
    EXPECT_EQ(symbols, "wbjotkrmadf");
    for (const char* symbol : {"j", "o", "t", "k", "r", "a", "d", "f"})
        EXPECT_EQ(Scene().row(symbol).contribution_m_s, 0.0) << symbol;
}

TEST(Budget, SaysWhatEachRowTouches) {
    Scene scene;
    scene.config.calibration_standard_uncertainty_m_s = 0.006;
    std::map<RowScope, std::string> symbols;
    for (const BudgetRow& row : scene.rows())
        symbols[row.touches] += row.symbol;
    EXPECT_EQ(symbols[RowScope::source], "wjotr");
    EXPECT_EQ(symbols[RowScope::slow], "b");
    EXPECT_EQ(symbols[RowScope::fault], "d");
    EXPECT_EQ(symbols[RowScope::antenna], "a");
    EXPECT_EQ(symbols[RowScope::window], "kmf");
    EXPECT_EQ(symbols[RowScope::calibration], "q");
}

TEST(Budget, ACalibrationAddsItsStandardUncertaintyAndOnlyEnlarges) {
    Scene scene;
    const CombinedUncertainty without = combine(scene.rows());
    scene.config.calibration_standard_uncertainty_m_s = 0.006;
    const BudgetRow row = scene.row("q");
    EXPECT_EQ(row.contribution_m_s, 0.006);
    EXPECT_EQ(row.type, "B");
    const CombinedUncertainty with = combine(scene.rows());
    EXPECT_NEAR(with.standard_uncertainty, std::hypot(without.standard_uncertainty, 0.006), 1e-15);
    EXPECT_EQ(with.effective_degrees_of_freedom, without.effective_degrees_of_freedom);
    // Few degrees of freedom: by Welch and Satterthwaite, U would be smaller with the row.
    scene.fit().measurement_scale.relative_uncertainty = 0.7;
    scene.measured.correlated_m_s = 0.0;
    const auto expanded = [&] {
        const CombinedUncertainty combined = combine(scene.rows());
        return combined.standard_uncertainty *
               equivalent_coverage_factor(2.0, combined.effective_degrees_of_freedom);
    };
    scene.config.calibration_standard_uncertainty_m_s = 0.0005;
    const double beside_m_s = expanded();
    scene.config.calibration_standard_uncertainty_m_s.reset();
    EXPECT_GT(beside_m_s, expanded());
}

TEST(Budget, OnlyAnUncertaintyOfSpeedIsARow) {
    const auto stated = [](const std::string& uncertainty) {
        const Attempt attempt = read_attempt(
            "schema: attempt/1.0\nid: a\ncraft: {name: x, class: car}\nreceivers:\n"
            "  - id: one\n    recording: a.pos\n    calibration: {certificate: c, laboratory: l, "
            "date: 2026-01-02" +
                uncertainty + "}\nprofiles: [nalsa]\n",
            "f");
        return window_config(attempt, attempt.receivers[0]).calibration_standard_uncertainty_m_s;
    };
    EXPECT_NEAR(stated(", expanded_uncertainty: 0.72, unit: km/h, of: speed").value(), 0.1, 1e-15);
    EXPECT_FALSE(stated(", expanded_uncertainty: 0.72, unit: s, of: time"));
    EXPECT_FALSE(stated(""));
}

TEST(Budget, WhatScreeningLeftCountsAsOftenAsItHappens) {
    // The root mean square of an error that is uniform up to 0.97 m/s in one window of 500.
    Scene scene;
    scene.reliability = {{.hypothesis = Hypothesis::ramp, .unit = "m / s", .speed_m_s = 0.97}};
    scene.fault.prior = {.probability = 0.002, .largest_m_s = 0.97};
    const BudgetRow row = scene.row("d");
    EXPECT_NEAR(row.contribution_m_s, std::sqrt(0.002) * 0.97 / std::sqrt(3.0), 1e-15);
    EXPECT_EQ(row.type, "B");
    EXPECT_EQ(row.note,
              "up to 0.97 m/s: what would be left with a probability of 20 % or more, at most what "
              "such positions are off by; taken to happen in "
              "one window of 500 (parameter window.fault_probability), as mean square");
}

TEST(Budget, WhiteNoiseIsOneRowWithTheDegreesOfFreedomOfItsOneScale) {
    Scene scene;
    EXPECT_EQ(scene.row("w").contribution_m_s, 0.003);
    // Degrees of freedom 1 / (2 relative^2) [GUM] (G.3): 200 for 5 %, 8 for 25 %.
    EXPECT_NEAR(scene.row("w").degrees_of_freedom.value(), 200.0, 1e-9);
    EXPECT_NEAR(scene.row("j").degrees_of_freedom.value(), 8.0, 1e-9);
}

TEST(Budget, ASlowErrorThatWasFittedHasTheFitsDegreesOfFreedom) {
    Scene scene;
    scene.fit().correlated_error_detected = true;
    scene.fit().error_diffusion = test::parameter_of(0.05);
    scene.fit().error_diffusion->relative_uncertainty = 0.1;
    scene.bound.decided_by = BoundSource::floor;
    EXPECT_FALSE(scene.row("b").degrees_of_freedom.has_value());
    scene.bound.decided_by = BoundSource::fitted;
    EXPECT_NEAR(scene.row("b").degrees_of_freedom.value(), 50.0, 1e-9);
    EXPECT_EQ(scene.row("b").type, "A");
}

TEST(Budget, WhatTheModelOfTheMotionChangesIsABound) {
    Scene scene;
    scene.measured.model_m_s = 0.006;
    EXPECT_NEAR(scene.row("o").contribution_m_s, 0.006 / std::sqrt(3.0), 1e-15);
}

TEST(Budget, AClockThatNobodyVouchesForMayRunWrong) {
    // 60 m/s times a rate known to 1e-4, rectangular.
    Scene scene;
    EXPECT_EQ(scene.row("k").contribution_m_s, 0.0);
    scene.trajectory.facts.time_source = "attempt";
    EXPECT_EQ(scene.row("k").contribution_m_s, 0.0);
    scene.trajectory.facts.time_source = "unknown";
    EXPECT_NEAR(scene.row("k").contribution_m_s, 60.0 * 1e-4 / std::sqrt(3.0), 1e-12);
    scene.config.clock_rate_bound = 5e-4;
    EXPECT_NEAR(scene.row("k").contribution_m_s, 60.0 * 5e-4 / std::sqrt(3.0), 1e-12);
}

TEST(Budget, WhatAnotherReceiverDoesNotShareLeavesOutFrameClockAndWhatIsLookedFor) {
    Scene scene;
    scene.trajectory.facts.time_source = "unknown";
    scene.reliability = {{.hypothesis = Hypothesis::step, .unit = "m", .speed_m_s = 0.0346}};
    EXPECT_NEAR(own_uncertainty(scene.rows()), std::hypot(0.004, 0.003), 1e-12);
}

TEST(Budget, SlowErrorAndMotionAreThoseOfTheirParts) {
    Scene scene;
    scene.measured.motion_m_s = 0.001;
    EXPECT_EQ(scene.row("b").contribution_m_s, 0.004);
    EXPECT_EQ(scene.row("b").type, "B");
    EXPECT_FALSE(scene.row("b").degrees_of_freedom.has_value());
    EXPECT_EQ(scene.row("j").contribution_m_s, 0.001);
}

TEST(Budget, IrregularTimeStamps) {
    // Each end is off by up to half of 1 ms, rectangular: 0.5 / sqrt(3) = 0.288675 ms. Both ends
    // independently: times sqrt(2) = 0.408248 ms. At 62 m/s over 3 s: 0.408248e-3 * 62 / 3 =
    // 0.0084371 m/s (31 mm at an end are 31 / sqrt(3) * sqrt(2) / 3 = 8.437 mm/s).
    Scene scene;
    scene.set_speed(62.0);
    scene.trajectory.rows[12].time.nanoseconds += 1'000'000;
    EXPECT_NEAR(scene.row("t").standard_uncertainty, 0.408248e-3, 1e-9);
    EXPECT_NEAR(scene.row("t").sensitivity, -62.0 / 3.0, 1e-12);
    EXPECT_NEAR(scene.row("t").contribution_m_s, 0.0084371, 1e-7);
    EXPECT_EQ(scene.row("t").estimate, 3.0);
    // What the recording states of its resolution goes before what its stamps look like.
    scene.trajectory.facts.time_resolution_s = 1e-5;
    EXPECT_NEAR(scene.row("t").contribution_m_s, 0.000084371, 1e-9);
}

TEST(Budget, RegularTimeStampsAreOffByTheSame) {
    Scene scene;
    scene.trajectory.facts.time_resolution_s = 0.001;
    for (TrajectoryEpoch& row : scene.trajectory.rows)
        row.time.nanoseconds += 347'000'000;
    EXPECT_EQ(scene.row("t").contribution_m_s, 0.0);
    scene.trajectory.rows[30].time.nanoseconds += 1'000'000;  // one stamp alone
    EXPECT_GT(scene.row("t").contribution_m_s, 0.008);
}

/// Steps that alternated lost 20 ms of 3 s without a trace in row t.
TEST(Budget, WhatTheStampsOfTheWindowWanderIsInTheirRow) {
    Scene scene;
    scene.trajectory.facts.time_resolution_s = 0.001;
    scene.mean_interval_s = 0.1;
    for (std::size_t k = 1; k <= 30; ++k)
        scene.trajectory.rows[k].time.nanoseconds -=
            (k < 30 && k % 2 == 1 ? 6'000'000 : 0) + static_cast<std::int64_t>(k) * 666'667;
    EXPECT_NEAR(scene.row("t").standard_uncertainty, 0.02 / std::sqrt(3.0), 1e-6);
    EXPECT_NE(scene.row("t").note.find("in sum, 0.0200 s away"), std::string::npos);
    scene.mean_interval_s = 0.1 - 666'667e-9;  // a recording of such steps wanders nowhere
    EXPECT_NEAR(scene.row("t").standard_uncertainty, 0.408248e-3, 1e-9);
}

TEST(Budget, ResolutionOfTheCoordinates) {
    // Both ends rounded to 1 mm: 0.5 / sqrt(3) * sqrt(2) = 0.408248 mm, over 3 s 0.136083 mm/s.
    Scene scene;
    scene.trajectory.facts.position_resolution_m = 0.001;
    EXPECT_NEAR(scene.row("r").contribution_m_s, 0.136083e-3, 1e-9);
    EXPECT_EQ(scene.row("r").unit, "m");
}

TEST(Budget, ScaleOfALocalPlane) {
    // 0.001 rectangular is 0.00057735; times 60 m/s 0.034641 m/s.
    Scene scene;
    scene.trajectory.facts.georeferenced = false;
    EXPECT_NEAR(scene.row("m").contribution_m_s, 0.034641, 1e-6);
    scene.config.plane_scale_bound = 0.0004;
    EXPECT_NEAR(scene.row("m").contribution_m_s, 0.0138564, 1e-6);
}

TEST(Budget, TangentPlaneTenKilometresFromItsOrigin) {
    // A tangent plane at 10 km is short by 1 - cos(10 / 6371) = 1.23184e-6: rectangular and at
    // 60 m/s 1.23184e-6 / sqrt(3) * 60 = 4.2672e-5 m/s.
    Scene scene;
    for (TrajectoryEpoch& row : scene.trajectory.rows) {
        row.east_m = *row.east_m + 6000.0 - 180.0;  // the far end counts
        row.north_m = 8000.0;
    }
    EXPECT_NEAR(scene.row("m").contribution_m_s, 4.2672e-5, 1e-8);
}

TEST(Budget, ATypedHeightHasARowThatHoldsWhatGeodesySaysOfIt) {
    Scene scene;
    scene.config.height_bound_m = 150.0;
    const auto rows = budget_of(scene.input());
    EXPECT_EQ(std::ranges::count(rows, "h", &BudgetRow::symbol), 0);
    scene.trajectory.facts.vertical_measured = false;
    // 150 / 6371000 = 2.35442e-5, rectangular, at 60 m/s.
    EXPECT_NEAR(scene.row("h").contribution_m_s, 2.35442e-5 / std::sqrt(3.0) * 60.0, 1e-8);
    EXPECT_EQ(scene.row("h").unit, "m");
    // The same two places, 180 m apart on the ellipsoid, at two heights: how far apart they are.
    const auto apart_m = [](double height_m) {
        const auto at = [&](double longitude_deg) {
            return ecef_from_geodetic({.latitude = Angle::from_degrees(-31.6),
                                       .longitude = Angle::from_degrees(longitude_deg),
                                       .height_m = height_m})
                .m;
        };
        return (at(136.0019) - at(136.0)).norm();
    };
    const double low_m = apart_m(0.0), high_m = apart_m(150.0);
    const BudgetRow row = scene.row("h");
    EXPECT_NEAR((high_m / low_m - 1.0) * 60.0,
                row.sensitivity * row.standard_uncertainty * std::sqrt(3.0), 5e-6);
    // What 20,000 m would have added to 232 km/h.
    EXPECT_NEAR((apart_m(20000.0) / low_m - 1.0) * 232.0, 0.73, 0.01);
    scene.config.height_bound_m = 4000.0;
    EXPECT_NEAR(scene.row("h").contribution_m_s, 4000.0 / 6371000.0 / std::sqrt(3.0) * 60.0, 1e-5);
    scene.trajectory.facts.georeferenced = false;
    EXPECT_EQ(std::ranges::count(budget_of(scene.input()), "h", &BudgetRow::symbol), 0);
}

TEST(Budget, LeverArmAndRotation) {
    // 1.2 m turned by 10 degrees: chord 2 * 1.2 * sin 5 deg = 0.209174 m, rectangular 0.120766 m,
    // over 3 s 0.0402555 m/s.
    Scene scene;
    scene.config.lever_arm = Eigen::Vector3d(0.72, 0.0, -0.96);
    EXPECT_EQ(scene.row("a").contribution_m_s, 0.0);  // no rotation stated
    scene.config.rotation_bound_deg = 10.0;
    EXPECT_NEAR(scene.row("a").standard_uncertainty, 0.120766, 1e-6);
    EXPECT_NEAR(scene.row("a").contribution_m_s, 0.0402555, 1e-6);
}

TEST(Budget, SelectionCoveredOrSubtracted) {
    Scene scene;
    scene.selection.bias_m_s = 0.003;
    scene.selection.bias_uncertainty_m_s = 0.0002;
    EXPECT_EQ(scene.row("f").contribution_m_s, 0.0002);
    EXPECT_EQ(scene.row("f").estimate, 0.0);
    scene.selection.treatment = SelectionTreatment::subtracted;
    EXPECT_EQ(scene.row("f").contribution_m_s, 0.0002);
    EXPECT_EQ(scene.row("f").estimate, 0.003);
    EXPECT_EQ(scene.row("f").sensitivity, -1.0);
}

/// All sources at once.
Scene full() {
    Scene scene;
    scene.measured.motion_m_s = 0.002;
    scene.trajectory.facts.georeferenced = false;
    scene.config.plane_scale_bound = 0.0001;
    scene.trajectory.facts.position_resolution_m = 0.01;
    scene.trajectory.rows[12].time.nanoseconds += 1'000'000;
    scene.config.lever_arm = Eigen::Vector3d(0.0, 0.0, -0.1);
    scene.config.rotation_bound_deg = 5.0;
    scene.selection.bias_uncertainty_m_s = 0.0003;
    scene.measured.model_m_s = 0.001;
    scene.trajectory.facts.time_source = "unknown";
    return scene;
}

TEST(Budget, CombinesByRootSumOfSquaresAndWelchSatterthwaite) {
    double squares = 0.0;
    double fourth = 0.0;  // of those with finite degrees of freedom, over these
    int contributing = 0;
    for (const BudgetRow& row : full().rows()) {
        squares += row.contribution_m_s * row.contribution_m_s;
        if (row.degrees_of_freedom)
            fourth += std::pow(row.contribution_m_s, 4) / *row.degrees_of_freedom;
        contributing += row.contribution_m_s > 0.0 ? 1 : 0;
    }
    EXPECT_EQ(contributing, 10);  // all but the undetected error
    const CombinedUncertainty combined = combine(full().rows());
    EXPECT_NEAR(combined.standard_uncertainty, std::sqrt(squares), 1e-15);
    EXPECT_NEAR(combined.effective_degrees_of_freedom.value(), squares * squares / fourth,
                1e-9 * squares * squares / fourth);
}

/// Half the width of the 95 % interval, in standard uncertainties by the law of propagation.
double half_width(const Scene& scene) {
    const MonteCarloCheck check = scene.check();
    return 0.5 * (check.upper_m_s - check.lower_m_s) / combine(scene.rows()).standard_uncertainty;
}

TEST(MonteCarlo, AgreesWithTheLawOfPropagationWhereAllIsNormal) {
    Scene scene;
    scene.fit().measurement_scale.relative_uncertainty.reset();
    scene.fit().jerk_density.relative_uncertainty.reset();
    const MonteCarloCheck check = scene.check();
    EXPECT_TRUE(check.converged);
    EXPECT_GE(check.trials, 100'000);
    const double u = combine(scene.rows()).standard_uncertainty;
    EXPECT_NEAR(check.standard_uncertainty_m_s, u, check.tolerance_m_s);
    EXPECT_NEAR(check.mean_m_s, 60.0, check.tolerance_m_s);
    // The tolerance is two standard deviations of an end's own scatter.
    EXPECT_NEAR(check.lower_m_s, 60.0 - 1.96 * u, 2.0 * check.tolerance_m_s);
    EXPECT_NEAR(check.upper_m_s, 60.0 + 1.96 * u, 2.0 * check.tolerance_m_s);
}

TEST(MonteCarlo, AgreesInTheStandardUncertaintyWithAllSources) {
    Scene scene = full();
    scene.fit().jerk_density.relative_uncertainty = 0.05;
    const MonteCarloCheck check = scene.check();
    EXPECT_TRUE(check.converged);
    // t distributions of 200 degrees of freedom are wider by sqrt(200 / 198), 0.5 %.
    EXPECT_NEAR(check.standard_uncertainty_m_s, combine(scene.rows()).standard_uncertainty,
                check.tolerance_m_s);
}

TEST(MonteCarlo, IsNarrowerWhereARectangularSourceDominates) {
    Scene scene;
    scene.trajectory.facts.georeferenced = false;  // 35 mm/s rectangular beside 5 mm/s normal
    // 95 % of a rectangular distribution are within 0.95 sqrt(3) = 1.645 of its deviations.
    EXPECT_GT(half_width(scene), 1.63);
    EXPECT_LT(half_width(scene), 1.75);
}

TEST(MonteCarlo, IsWiderWhereFewDegreesOfFreedomDominate) {
    Scene scene;
    scene.measured.correlated_m_s = 0.0;
    scene.measured.motion_m_s = 0.02;
    scene.fit().jerk_density.relative_uncertainty = std::sqrt(0.1);  // 5 degrees of freedom
    // Student's t of 5 degrees of freedom holds 95 % within 2.571.
    EXPECT_NEAR(half_width(scene), 2.571, 0.06);
}

TEST(MonteCarlo, IsTheSameForASeed) {
    Scene scene = full();
    const MonteCarloCheck a = scene.check();
    EXPECT_EQ(a.mean_m_s, scene.check().mean_m_s);
    EXPECT_EQ(a.upper_m_s, scene.check().upper_m_s);
    scene.config.seed = 2;
    EXPECT_NE(a.mean_m_s, scene.check().mean_m_s);
    EXPECT_EQ(scene.check().seed, 2);
}

TEST(MonteCarlo, ACraftAtRestHasAResult) {
    // Time and scale have no part in a speed of nothing, which they were once divided by.
    Scene scene;
    scene.set_speed(0.0);
    scene.trajectory.facts.georeferenced = false;
    MonteCarloCheck check;
    ASSERT_NO_THROW(check = scene.check());
    // Rayleigh: the length of a vector of 5 mm/s an axis.
    EXPECT_NEAR(check.mean_m_s, 0.005 * std::sqrt(0.5 * std::numbers::pi), 1e-4);
}

TEST(MonteCarlo, AParameterThatTheDataHardlyTellIsStillPropagated) {
    // A relative uncertainty of 1 of the jerk density: half a degree of freedom by [GUM] (G.3).
    Scene scene;
    scene.measured.motion_m_s = 0.002;
    scene.fit().jerk_density.relative_uncertainty = 1.0;
    EXPECT_GE(scene.row("j").degrees_of_freedom.value(), 1.0);
    EXPECT_NO_THROW(scene.check());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include "reports/compare/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/failure.h"
#include "core/random.h"
#include "motion/chain.h"
#include "reports/document/document_text.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::size_t epochs = 120;

/// A run along east whose speed has its maximum of 20 m/s at 6 s, and its time integral.
double true_speed_m_s(double t) {
    return 20.0 - 0.25 * (t - 6.0) * (t - 6.0);
}
double true_east_m(double t) {
    return 20.0 * t - std::pow(t - 6.0, 3) / 12.0;
}

struct Sample {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    Windows windows;
    std::vector<MethodEpoch> truth;
};

/// 10 Hz, noise of 10 mm, the trajectory without error, the other methods off by known amounts.
Sample sample() {
    Sample one;
    RandomGenerator random(3);
    one.screened.facts.receiver = one.trajectory.facts.receiver = "primary";
    one.screened.facts.nominal_interval_s = one.trajectory.facts.nominal_interval_s = 0.1;
    for (std::size_t k = 0; k < epochs; ++k) {
        const double t = 0.1 * static_cast<double>(k);
        ScreenedEpoch& measured = one.screened.rows.emplace_back();
        TrajectoryEpoch& row = one.trajectory.rows.emplace_back();
        measured.epoch = row.epoch = static_cast<std::int64_t>(k) + 1;
        measured.time.nanoseconds = row.time.nanoseconds =
            100'000'000 * static_cast<std::int64_t>(k);
        measured.arc = row.arc = 1;
        measured.usable = row.usable = true;
        measured.east_m = true_east_m(t) + 0.01 * random.normal();
        measured.north_m = 0.01 * random.normal();
        measured.sigma_east_m = measured.sigma_north_m = 0.01;
        row.east_m = true_east_m(t);
        row.north_m = 0.0;
        row.speed_m_s = true_speed_m_s(t);
        row.speed_batch_m_s = true_speed_m_s(t) + 0.5;
        if (k > 0 && k + 1 < epochs) row.speed_v1_m_s = true_speed_m_s(t) - 0.25;
        row.speed_kalman_m_s = true_speed_m_s(t - 1.0);
        row.robust_east_m = 2.0 * true_east_m(t);
        row.robust_north_m = 0.0;
        one.truth.push_back(
            {.position_m = Eigen::Vector2d(true_east_m(t), 0.0), .speed_m_s = true_speed_m_s(t)});
    }
    AxesEstimation estimation;
    estimation.noise.status = NoiseBasis::fitted;
    estimation.noise.jerk_density.value = 1.0;
    estimation.noise.measurement_scale.value = 1.0;
    one.trajectory.estimation.horizontal = estimation;
    CertifiableWindow best;
    best.span = {.first_epoch = 46,
                 .last_epoch = 76,
                 .start = {4'500'000'000},
                 .duration = {3'000'000'000},
                 .start_gps = std::nullopt};
    best.speed_m_s = 19.7;
    one.windows.profiles.push_back(
        {.profile = "test",
         .rule = {.duration_s = 3.0, .definition = SpeedDefinition::displacement},
         .candidates = 90,
         .best = best,
         .indicated = std::nullopt});
    return one;
}

const CompareConfig config{.fit = {}, .duration_tolerance_s = 0.001};

Comparison compared(const Sample& one, bool with_truth = true) {
    return compare_methods(one.screened, one.trajectory, one.windows, config,
                           with_truth ? one.truth : std::vector<MethodEpoch>{});
}

MethodResult method(const Comparison& comparison, const std::string& name) {
    for (const MethodResult& result : comparison.profiles.at(0).methods)
        if (result.name.starts_with(name)) return result;
    throw std::runtime_error("no method " + name);
}

// Mean speed of the run from 4.5 s to 7.5 s: 20 less the mean of (t - 6)^2 / 4.
const double true_mean_m_s = 20.0 - 0.25 * 1.5 * 1.5 / 3.0;

TEST(Compare, EachMethodsFiguresAreItsOwn) {
    const Comparison comparison = compared(sample());
    const ProfileComparison& profile = comparison.profiles.at(0);
    EXPECT_EQ(profile.candidates, 90);
    EXPECT_NEAR(*profile.true_m_s, true_mean_m_s, 1e-12);

    const MethodResult smoother = method(comparison, "smoother of the trajectory");
    EXPECT_EQ(smoother.best_start->nanoseconds, 4'500'000'000);
    EXPECT_NEAR(*smoother.best_m_s, true_mean_m_s, 1e-12);
    EXPECT_NEAR(*smoother.rms_error_m_s, 0.0, 1e-12);
    EXPECT_NEAR(*smoother.certified_error_m_s, 0.0, 1e-12);

    // Mean of the 31 speeds, (t - 6)^2 = 0.01 k^2 for k from -15 to 15.
    const double sum_of_squares = 2.0 * 15.0 * 16.0 * 31.0 / 6.0;
    const double mean_of_31 = 20.0 - 0.25 * 0.01 * sum_of_squares / 31.0;
    const MethodResult batch = method(comparison, "batch");
    EXPECT_NEAR(*batch.best_m_s, mean_of_31 + 0.5, 1e-12);
    EXPECT_NEAR(*batch.rms_error_m_s, 0.5, 1e-12);
    EXPECT_NEAR(*batch.certified_error_m_s, mean_of_31 + 0.5 - true_mean_m_s, 1e-12);
    EXPECT_EQ(batch.window_speed, SpeedDefinition::mean_n_plus_1);
    EXPECT_NEAR(*method(comparison, "v1").rms_error_m_s, 0.25, 1e-12);

    // A filter that is 1 s late finds its best window 1 s late.
    const MethodResult late = method(comparison, "Kalman filter");
    EXPECT_EQ(late.best_start->nanoseconds, 5'500'000'000);
    EXPECT_NEAR(*late.best_m_s, mean_of_31, 1e-12);
    EXPECT_NEAR(*late.best_error_m_s, mean_of_31 - (true_east_m(8.5) - true_east_m(5.5)) / 3.0,
                1e-12);

    // Positions alone have no speed of an epoch.
    const MethodResult robust = method(comparison, "robust solution");
    EXPECT_NEAR(*robust.certified_m_s, 2.0 * true_mean_m_s, 1e-12);
    EXPECT_FALSE(robust.rms_error_m_s.has_value());

    EXPECT_FALSE(method(comparison, "v2").best_m_s.has_value());  // it has no value anywhere
    const MethodResult certified = method(comparison, "certified");
    EXPECT_NEAR(*certified.certified_error_m_s, 19.7 - true_mean_m_s, 1e-12);
}

TEST(Compare, AFullFixedLagIsTheSmootherAndALongLagIsNearIt) {
    Sample one = sample();
    for (std::size_t k = 0; k < epochs; ++k)
        one.screened.rows[k].sigma_east_m = one.screened.rows[k].sigma_north_m = 0.01;
    const EstimationModel model{.motion = {.jerk_density = 1.0}};
    std::vector<ArcEpoch<2>> arc;
    for (const ScreenedEpoch& row : one.screened.rows)
        arc.push_back({row.time.seconds(), PositionMeasurement<2>{measured_position<2>(row),
                                                                  stated_covariance<2>(row)}});
    const Chain<2> smoothed = Chain<2>(arc, model);
    const double expected_m_s =
        (smoothed.mean(75).head<2>() - smoothed.mean(45).head<2>()).norm() / 3.0;
    const Comparison comparison = compared(one);
    EXPECT_NEAR(*method(comparison, "fixed lag, full").certified_m_s, expected_m_s, 1e-9);
    EXPECT_NEAR(*method(comparison, "fixed lag 2 s (20 epochs)").certified_m_s, expected_m_s, 1e-3);
    // The sooner it must answer, the worse it knows.
    EXPECT_GT(*method(comparison, "fixed lag 0.5 s").rms_error_m_s,
              *method(comparison, "fixed lag, full").rms_error_m_s);
}

TEST(Compare, AWindowThatNobodyCertifiesIsNoCandidate) {
    Sample one = sample();
    one.trajectory.rows[59].usable = false;
    const Comparison comparison = compared(one, false);
    EXPECT_EQ(comparison.profiles[0].candidates, 90 - 31);
    // Of those left, the one that begins at 6.0 s is nearest to the maximum.
    EXPECT_EQ(method(comparison, "smoother of").best_start->nanoseconds, 6'000'000'000);
    EXPECT_FALSE(method(comparison, "smoother of").rms_error_m_s.has_value());
    EXPECT_FALSE(method(comparison, "smoother of").certified_error_m_s.has_value());
}

TEST(Compare, TruthOfAnotherTimeIsRefused) {
    Sample one = sample();
    one.truth[45] = {};
    EXPECT_THROW((void)compared(one), Failure);  // where the certified window begins
    std::ranges::fill(one.truth, MethodEpoch{});
    EXPECT_THROW((void)compared(one), Failure);
    one.windows.profiles[0].best.reset();
    EXPECT_THROW((void)compared(one), Failure);
    one = sample();
    one.truth[5] = {};  // elsewhere it is only counted
    EXPECT_EQ(compared(one).epochs_with_truth, static_cast<std::int64_t>(epochs) - 1);
}

TEST(Compare, RecordedVelocitiesAndTheEnhancedFilterWhereThereAreSome) {
    Sample one = sample();
    EXPECT_FALSE(method(compared(one), "recorded velocity").best_m_s.has_value());
    for (std::size_t k = 0; k < epochs; ++k) {
        one.screened.rows[k].recorded_velocity_east_m_s =
            true_speed_m_s(0.1 * static_cast<double>(k));
        one.screened.rows[k].recorded_velocity_north_m_s = 0.0;
    }
    EXPECT_NEAR(*method(compared(one), "recorded velocity").rms_error_m_s, 0.0, 1e-12);
    const Comparison comparison = compared(one);
    // Also where the frame is not tied to the Earth. The mean of the 30 backward differences is the
    // displacement: 10 mm at its ends, filtered.
    EXPECT_NEAR(*method(comparison, "enhanced").certified_error_m_s, 0.0, 0.015);
    EXPECT_LT(*method(comparison, "enhanced").rms_error_m_s, 0.2);
    bool said = false;
    for (const std::string& note : comparison.notes)
        said = said || note.find("0.1 m/s for the accuracy of 120 of 120") != std::string::npos;
    EXPECT_TRUE(said);
}

/// An attempt under the profile of the sample, with a record in that unit.
Attempt attempt_with(const std::string& unit) {
    Attempt attempt;
    attempt.id = "run-1";
    if (!unit.empty()) attempt.record = Record{.speed = 40.0, .unit = unit, .source = "a board"};
    return attempt;
}

TEST(CompareDocument, HasATableOfSpeedsAndOneOfErrorsAgainstATruth) {
    const std::string text =
        document_text(comparison_document(compared(sample()), attempt_with("")), 80);
    EXPECT_TRUE(text.starts_with("All estimators side by side\n"));
    for (const char* said :
         {"\nAttempt run-1, receiver primary\n", "\nTrue speed in it  71.32 km/h\n",
          "those with truth",
          // Values end where their heads end.
          "\nmethod                           by   best from, s    best  certified\n",
          "\nbatch                            N+1         4.500   73.08      73.08\n",
          "\nmethod                             RMS    best  certified\n",
          "\nbatch                            1.800   1.755      1.755\n"})
        EXPECT_NE(text.find(said), std::string::npos) << said << "\n" << text;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        EXPECT_LE(line.size(), 80U) << line;
    const std::string plain =
        document_text(comparison_document(compared(sample(), false), attempt_with("")), 80);
    EXPECT_EQ(plain.find("RMS"), std::string::npos);
    EXPECT_EQ(plain.find("rue speed"), std::string::npos);
    EXPECT_EQ(plain.find(".."), std::string::npos) << plain;
}

TEST(CompareDocument, SpeedsAreInTheRecordsUnitWithTheDecimalsOfTheMeasuredOne) {
    Sample one = sample();
    one.windows.profiles[0].best->standard_uncertainty_m_s = 0.15;
    const Document document = comparison_document(compared(one), attempt_with("kn"));
    const Block& speeds = document.sections.at(0).blocks.at(1);
    const TableRow& certified = speeds.rows.back();
    // 19.7 m/s are 38.293 kn; the expanded uncertainty of 0.3 m/s is 0.58 kn.
    EXPECT_EQ(certified.cells,
              (std::vector<std::string>{"certified", "d/T", "4.500", "38.29", "38.29"}));
    one.windows.profiles[0].best->standard_uncertainty_m_s = 1.5;
    EXPECT_EQ(comparison_document(compared(one), attempt_with("kn"))
                  .sections.at(0)
                  .blocks.at(1)
                  .rows.back()
                  .cells.at(3),
              "38.2");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

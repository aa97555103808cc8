#include "alignment_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "draws.h"

// The order and the shape of [FHB03]'s Tables 1 to 3. A converged covariance is not convergence, so
// the time counts from which the true error stays below 1 degree.
namespace runcert::RUNCERT_FILE {
namespace {

AlignmentSummary of(const AlignmentStudy& study, AlignmentStart start) {
    return summarise(study.of(start));
}

// From the middle of a turn, where a lateral acceleration shows the heading at once. Mean times
// differ by 1 and 10 s, with standard deviations of 1 and 15 s: 20 starts tell them apart.
TEST(AlignmentStudy, TrackBeforeCourseBeforeBlind) {
    AlignmentCell cell = alignment_cells().at(1);
    cell.spread_m = 0.0;
    const AlignmentStudy study =
        study_alignment(cell, {.starts = draws({.daily = 20, .study = 60}), .errors = false});
    const AlignmentSummary track = of(study, AlignmentStart::track_model);
    const AlignmentSummary course = of(study, AlignmentStart::gps_heading);
    const AlignmentSummary blind = of(study, AlignmentStart::blind);
    EXPECT_EQ(track.failed, 0);
    EXPECT_EQ(course.failed, 0);
    EXPECT_LE(track.true_s, 2.0);
    EXPECT_LE(course.true_s, 4.0);
    EXPECT_LT(track.true_s, course.true_s);
    EXPECT_LT(course.true_s, blind.true_s);
    // What fails shows in the innovations.
    EXPECT_GT(blind.failed, 0);
    EXPECT_EQ(blind.failed_unseen, 0);
    // The covariance says that it has converged long before.
    EXPECT_LT(blind.stated_s, 5.0);
    EXPECT_GT(blind.error_median_deg, 5.0);
    EXPECT_GT(blind.error_most_deg, 90.0);
}

// Both ovals, all over the lap. At 140 and 170 degrees 3 in 4 fail: fewer than half of 16 do once
// in a hundred.
TEST(AlignmentStudy, SmallErrorsConvergeAndLargeOnesDoNot) {
    for (std::size_t at : {0, 1}) {
        const AlignmentStudy study =
            study_alignment(alignment_cells().at(at), {.starts = draws({.daily = 8, .study = 24})});
        SCOPED_TRACE(study.cell);
        EXPECT_LT(of(study, AlignmentStart::track_model).true_s,
                  of(study, AlignmentStart::gps_heading).true_s);
        EXPECT_LT(of(study, AlignmentStart::gps_heading).true_s,
                  of(study, AlignmentStart::blind).true_s);
        int failed = 0, of_large = 0;
        for (std::size_t i = 0; i < std::size(alignment_errors_deg); ++i) {
            const AlignmentSummary summary = summarise(study.by_error[i]);
            EXPECT_NEAR(summary.initial_error_deg, alignment_errors_deg[i], 1e-6);
            EXPECT_EQ(summary.failed_unseen, 0);
            if (alignment_errors_deg[i] <= 80.0) {
                EXPECT_EQ(summary.failed, 0) << alignment_errors_deg[i];
            }
            if (alignment_errors_deg[i] < 140.0) continue;
            failed += summary.failed;
            of_large += summary.runs;
        }
        EXPECT_GT(2 * failed, of_large);
        const auto mean_s = [&](std::size_t i) { return summarise(study.by_error[i]).true_s; };
        EXPECT_LT(mean_s(0), mean_s(1));  // 0, 10
        EXPECT_LT(mean_s(1), mean_s(4));  // 40
        EXPECT_LT(mean_s(4), mean_s(6));  // 80
    }
}

// A vertex error s turns a triangle of 10 m by sqrt(2) s / 10 m about either axis; roll and pitch
// gain that, on a bank of 14 degrees 6 % less. The means are the car's own: a lean of half a degree
// and a slip of a quarter.
TEST(AlignmentStudy, SurfaceErrorsTurnRollAndPitch) {
    const int runs = draws({.daily = 4, .study = 24});
    const SurfaceAccuracy exact = study_surface(0.0, 0.03, runs, 1);
    for (const double vertex_m : {0.02, 0.05, 0.10}) {
        const SurfaceAccuracy one = study_surface(vertex_m, 0.03, runs, 1);
        const double turned_deg = degrees_per_radian * std::sqrt(2.0) * vertex_m / 10.0;
        for (const int axis : {0, 1})
            EXPECT_NEAR(one.sd_deg(axis), std::hypot(exact.sd_deg(axis), turned_deg),
                        0.08 * turned_deg + 0.01);
        // On a bank a wrong pitch turns the heading by its sine.
        EXPECT_NEAR(one.sd_deg(2), exact.sd_deg(2), 0.1 * turned_deg + 0.01);
        EXPECT_LT((one.mean_deg - exact.mean_deg).cwiseAbs().maxCoeff(), 0.04);
    }
    EXPECT_NEAR(exact.mean_deg.x(), -0.46, 0.1);
    EXPECT_NEAR(exact.mean_deg.y(), 0.0, 0.1);
    EXPECT_NEAR(exact.mean_deg.z(), -0.24, 0.05);
}

TEST(AlignmentStudy, PrintsThePublishedFiguresBesideOurs) {
    std::vector<AlignmentStudy> studies;
    for (AlignmentCell cell : alignment_cells()) {
        cell.spec.imu_hz = 50;
        studies.push_back(study_alignment(cell, {.starts = 2}));
    }
    const std::string first = alignment_table_1(studies), third = alignment_table_3(studies);
    EXPECT_NE(first.find(" 170 heading              >100    >143"), std::string::npos) << first;
    EXPECT_NE(third.find("Sears Point, GPS heading      113.1 +- 29.8 of 10"), std::string::npos)
        << third;
    EXPECT_NE(third.find("by 47 % at Fontana (printed: 48), 79 % at Sears Point (printed: 80);"),
              std::string::npos)
        << third;
    for (const AlignmentStudy& study : studies)
        for (const std::string& text : {first, third, alignment_figures(studies)})
            EXPECT_NE(text.find(study.cell), std::string::npos) << text;
    EXPECT_NE(alignment_figures(studies).find("40 of 60 in 100 s"), std::string::npos);
    EXPECT_NE(alignment_table_2({study_surface(0.1, 0.3, 1, 1)})
                  .find("oval, vertices 10 cm, 0.30 m/s, mean"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

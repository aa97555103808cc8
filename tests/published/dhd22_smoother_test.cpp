#include <gtest/gtest.h>

#include "dhd22_data.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

namespace runcert::published {
namespace {

constexpr const char* attempt_text = R"(schema: attempt/1.0
id: dhd22
craft: {name: simulated land yacht, class: land-yacht}
receivers: [{id: primary, recording: appendix_a_simulated_ppk.csv}]
profiles: [nalsa]
)";

struct Chain {
    Attempt attempt = read_attempt(attempt_text, "attempt");
    ScreenedTable screened;
    TrajectoryTable trajectory;
};

/// Appendix A through screening and smoothing, with the defaults of the craft's class.
const Chain& appendix_a_smoothed() {
    static const Chain chain = [] {
        Chain made;
        EnuTable table;
        table.facts = {.receiver = "primary",
                       .first_epoch = std::nullopt,
                       .georeferenced = false,
                       .vertical_measured = false,
                       .nominal_interval_s = 0.1};
        for (const PlanePosition& position : appendix_a()) {
            EnuEpoch& epoch = table.rows.emplace_back();
            epoch.epoch = static_cast<std::int64_t>(table.rows.size());
            epoch.time.nanoseconds = std::llround(position.time_s * 1e9);
            epoch.east_m = position.position.x();
            epoch.north_m = position.position.y();
            epoch.sigma_east_m = epoch.sigma_north_m = position.sigma_m;
        }
        made.screened = screen(table, screen_config(made.attempt));
        made.trajectory = smooth_trajectory(made.screened, smooth_config(made.attempt));
        return made;
    }();
    return chain;
}

double root_mean_square_error(std::optional<double> TrajectoryEpoch::*speed) {
    std::vector<double> errors;
    for (const TrajectoryEpoch& row : appendix_a_smoothed().trajectory.rows)
        if (row.*speed) errors.push_back(*(row.*speed) - true_speed_mps(row.time.seconds()));
    return statistics_of(errors).root_mean_square;
}

TEST(Dhd22Smoother, NothingOfTheSimulatedRunIsRejected) {
    const ScreeningSummary summary = summarise(appendix_a_smoothed().screened.rows);
    EXPECT_EQ(summary.usable, 451);
    EXPECT_EQ(summary.arcs, 1);
}

TEST(Dhd22Smoother, RootMeanSquareSpeedErrorOverAllEpochs) {
    for (const TrajectoryEpoch& row : appendix_a_smoothed().trajectory.rows)
        ASSERT_TRUE(row.speed_mps.has_value());
    EXPECT_LE(root_mean_square_error(&TrajectoryEpoch::speed_mps), 0.018);
    EXPECT_LE(root_mean_square_error(&TrajectoryEpoch::speed_batch_mps), 0.018);
}

TEST(Dhd22Smoother, RootMeanSquareSpeedErrorsOfThePapersMethods) {
    EXPECT_EQ(format_fixed(root_mean_square_error(&TrajectoryEpoch::speed_v1_mps), 3), "0.066");
    EXPECT_EQ(format_fixed(root_mean_square_error(&TrajectoryEpoch::speed_v2_mps), 3), "0.056");
    EXPECT_EQ(format_fixed(root_mean_square_error(&TrajectoryEpoch::speed_kalman_mps), 2), "1.11");
}

TEST(Dhd22Smoother, BatchLeastSquaresAgrees) {
    const EstimationSummary& summary = appendix_a_smoothed().trajectory.estimation;
    EXPECT_LE(summary.largest_position_difference_m, 1e-6);
    EXPECT_LE(summary.largest_velocity_difference_mps, 1e-5);
    EXPECT_EQ(summary.degrees_of_freedom, 2 * 451 - 6);
}

TEST(Dhd22Smoother, BestThreeSecondsAreAboveTheTruthByNoMoreThanWasMeasured) {
    const Chain& chain = appendix_a_smoothed();
    TrajectoryTable trajectory = chain.trajectory;
    trajectory.header.parameters = chain.attempt.parameters.at("smooth");
    const std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    const Windows windows = find_windows(chain.screened, trajectory, profiles,
                                         window_config(chain.attempt, trajectory));
    ASSERT_TRUE(windows.profiles.front().best.has_value());
    const CertifiableWindow& best = *windows.profiles.front().best;
    EXPECT_EQ(windows.profiles.front().candidates, 451 - 30);
    EXPECT_EQ(best.span.duration.nanoseconds, 3'000'000'000);
    EXPECT_EQ(best.span.last_epoch - best.span.first_epoch, 30);
    // [DHD22]'s data: the best 3 s of a smoother were seen at 60.002 to 60.003 m/s.
    EXPECT_NEAR(best.definitions.mean_n_plus_1_mps, 60.0025, 0.0015);
    EXPECT_NEAR(best.definitions.displacement_mps, best.definitions.mean_n_plus_1_mps, 0.002);
    EXPECT_GE(best.definitions.path_length_mps, best.definitions.displacement_mps);
    EXPECT_NEAR(best.methods.v1_mps.value(), 60.0068, 0.01);
}

}  // namespace
}  // namespace runcert::published

#include <gtest/gtest.h>

#include "motion_test_support.h"
#include "stages/window/instants.h"
#include "stages/window/trajectory_part.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Five minutes at 10 Hz that are quiet but for the three seconds of the window in their middle,
/// whose jerk density is twenty times as large.
struct Waited {
    Arc<2> arc;
    std::vector<ElapsedTime> times;
    EpochPair window{1500, 1530};
    EstimationModel model;

    Waited() {
        model.motion.jerk_density = 0.3;
        model.error = GaussMarkovError::steady(0.01, 1.0);
        RandomGenerator random(2);
        arc.epochs = test::simulate_arc<2>(model, 3000, 0.1, 0.010, random).arc;
        for (std::size_t k = 0; k < arc.epochs.size(); ++k) {
            times.push_back({static_cast<std::int64_t>(k) * 100'000'000});
            arc.epochs[k].time_s = times.back().seconds();
            arc.rows.push_back(k);
            if (k > 1500 && k <= 1530) arc.epochs[k].jerk_factor = 20.0;
        }
    }
};

TEST(ChangingMotion, AnInstantInAStepChangesNoState) {
    const Waited at;
    // One in the last quiet step, one in the step that the hard motion begins with.
    const ArcWithInstants<2> both =
        with_instants(at.arc, at.times, {149'930'000'000}, {150'040'000'000});
    ASSERT_EQ(both.arc.epochs.size(), at.arc.epochs.size() + 2);
    EXPECT_EQ(both.arc.epochs[both.window.first].jerk_factor, 1.0);
    EXPECT_EQ(both.arc.epochs[both.window.last].jerk_factor, 20.0);
    const Chain<2> expected = Chain<2>(at.arc.epochs, at.model);
    const Chain<2> with = Chain<2>(both.arc.epochs, at.model);
    for (std::size_t k = 1400, i = k; k < 1600; ++k, ++i) {
        if (i == both.window.first || i == both.window.last) ++i;
        ASSERT_EQ(with.mean(i).size(), 8);
        EXPECT_LT((with.mean(i) - expected.mean(k)).norm(), 1e-8) << k;
        EXPECT_TRUE(with.state(i).covariance.isApprox(expected.state(k).covariance, 1e-8)) << k;
    }
}

TEST(ChangingMotion, TheMemoryIsThatOfTheQuietestStep) {
    Waited at;
    const std::span<const ArcEpoch<2>> quiet = std::span(at.arc.epochs).first(1000);
    const std::span<const ArcEpoch<2>> hard = std::span(at.arc.epochs).subspan(1501, 30);
    EstimationModel harder = at.model;
    harder.motion.jerk_density *= 20.0;
    std::vector<ArcEpoch<2>> even(hard.begin(), hard.end());
    for (ArcEpoch<2>& epoch : even)
        epoch.jerk_factor = 1.0;
    EXPECT_NEAR(memory_s<2>(hard, at.model), memory_s<2>(even, harder), 1e-9);
    EXPECT_NEAR(memory_s<2>(at.arc.epochs, at.model), memory_s<2>(quiet, at.model), 1e-9);
    EXPECT_GT(memory_s<2>(quiet, at.model), 1.2 * memory_s<2>(hard, at.model));
}

TEST(ChangingMotion, AWindowInHardMotionHasWhatTheQuietAroundItTells) {
    const Waited at;
    const ArcPart<2> part =
        part_around(at.arc, at.times, at.window, memory_s(at.arc, at.window, at.model));
    ASSERT_FALSE(part.whole);
    const Chain<2> whole = Chain<2>(at.arc.epochs, at.model);
    const Chain<2> cut = Chain<2>(part.arc.epochs, at.model);
    for (const auto& [k, in_part] :
         {std::pair{at.window.first, part.window.first}, {at.window.last, part.window.last}}) {
        EXPECT_LT((whole.mean(k) - cut.mean(in_part)).norm(), 1e-9);
        EXPECT_TRUE(cut.state(in_part).covariance.isApprox(whole.state(k).covariance, 1e-10));
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

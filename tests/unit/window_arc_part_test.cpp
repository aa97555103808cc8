#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "motion/chain.h"
#include "stages/window/trajectory_part.h"

namespace runcert::RUNCERT_FILE {
namespace {

struct LongArc {
    Arc<2> arc;
    std::vector<ElapsedTime> times;
    EpochPair window;
};

/// An arc long against the memory of the model, with a window in its middle.
LongArc arc_with(const EstimationModel& model, double sigma_m, double interval_s) {
    LongArc made;
    made.arc.number = 3;
    std::size_t epochs = 60;
    RandomGenerator random(9);
    for (std::size_t k = 0; k < epochs; ++k) {
        made.times.push_back({std::llround(1e9 * interval_s * static_cast<double>(k))});
        made.arc.rows.push_back(7 + k);
        ArcEpoch<2>& epoch = made.arc.epochs.emplace_back();
        epoch.time_s = made.times.back().seconds();
        epoch.measurement.emplace();
        epoch.measurement->covariance = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
        epoch.measurement->position << 20.0 * epoch.time_s + sigma_m * random.normal(),
            3.0 * std::sin(0.2 * epoch.time_s) + sigma_m * random.normal();
        if (k == 40) {
            made.window = {30, 40};
            const double longest_s = 2.5 * memory_s(made.arc, made.window, model);
            epochs = std::max(epochs, static_cast<std::size_t>(longest_s / interval_s) + 41);
        }
    }
    made.window = {epochs / 2, epochs / 2 + 40};
    return made;
}

TEST(ArcPart, OfAsMuchAsTheModelRemembersTellsOfTheWindowWhatTheWholeArcTells) {
    for (const double jerk_density : {0.05, 3.0})
        for (const double sigma_m : {0.005, 1.0})
            for (const double interval_s : {0.05, 1.0})
                for (const auto& [slow_m, tau_s] :
                     {std::pair{0.0, 1.0}, {0.02, 0.5}, {0.02, 4.0}, {1.0, 4.0}}) {
                    EstimationModel model;
                    model.motion.jerk_density = jerk_density;
                    model.error = GaussMarkovError::steady(slow_m, tau_s);
                    const LongArc made = arc_with(model, sigma_m, interval_s);
                    const ArcPart<2> part = part_around(made.arc, made.times, made.window,
                                                        memory_s(made.arc, made.window, model));
                    ASSERT_LT(part.arc.epochs.size(), made.arc.epochs.size());
                    const Chain<2> whole = Chain<2>(made.arc.epochs, model);
                    const Chain<2> cut = Chain<2>(part.arc.epochs, model);
                    for (const auto& [k, in_part] :
                         {std::pair{made.window.first, part.window.first},
                          {made.window.last, part.window.last}}) {
                        const auto expected = whole.state(k);
                        const auto got = cut.state(in_part);
                        EXPECT_LT((expected.mean - got.mean).norm(), 1e-9 * (1.0 + sigma_m))
                            << jerk_density << " " << sigma_m << " " << interval_s << " " << slow_m
                            << " " << tau_s;
                        EXPECT_TRUE(got.covariance.isApprox(expected.covariance, 1e-10));
                    }
                }
}

TEST(ArcPart, IsWholeWhereTheMarginReachesBothEndsAndBeginsWithAMeasurement) {
    EstimationModel model;
    LongArc made = arc_with(model, 0.01, 0.1);
    made.arc.epochs.front().measurement.reset();
    const double all_s = made.arc.epochs.back().time_s;
    EXPECT_FALSE(part_around(made.arc, made.times, made.window, all_s).whole);
    EXPECT_EQ(part_around(made.arc, made.times, made.window, all_s).arc.rows.front(), 8U);
    made.arc.epochs.front().measurement = made.arc.epochs.back().measurement;
    const ArcPart<2> part = part_around(made.arc, made.times, made.window, all_s);
    EXPECT_TRUE(part.whole);
    EXPECT_EQ(part.arc.rows, made.arc.rows);
    EXPECT_EQ(part.window.first, made.window.first);
    const ArcPart<2> narrow = part_around(made.arc, made.times, made.window, 0.15);
    EXPECT_EQ(narrow.arc.rows.front(), made.arc.rows[made.window.first - 1]);
    EXPECT_EQ(narrow.arc.rows.back(), made.arc.rows[made.window.last + 1]);
    EXPECT_EQ(narrow.window.first, 1U);
    EXPECT_EQ(narrow.times.size(), narrow.arc.epochs.size());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include <gtest/gtest.h>

#include <cmath>

#include "core/statistics.h"
#include "motion/chain.h"
#include "stages/window/position_speed.h"
#include "stages/window/reliability.h"
#include "window_test_support.h"
#include "witness/arcs.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::recorded;

/// A run of 40 s at 10 Hz, screened with white noise as stated.
ScreenedTable screened_run() {
    ScreenedTable table = recorded({});
    ScreeningBasis& basis = table.basis;
    basis.test_size = 1e-8;
    basis.power = 0.8;
    basis.burst_epochs_max = 5;
    basis.models.push_back({.axes = TestedAxes::horizontal,
                            .noise = NoiseBasis::fitted,
                            .jerk_density = 0.6,
                            .measurement_scale = 1.0,
                            .white_scale = 1.0,
                            .error_sigma_m = 0.0,
                            .error_tau_s = 1.0});
    return table;
}

EstimationModel estimate_model() {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    model.error = GaussMarkovError::steady(0.008, 2.0);
    return model;
}

std::vector<UndetectedError> errors_of(const ScreenedTable& screened, const Arc<2>& arc,
                                       const WindowStretch<2>& stretch,
                                       SpeedDefinition definition) {
    const EstimationModel model = estimate_model();
    const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
    const SpeedWeights<2> weights = speed_weights<2>({.epochs = stretch.epochs,
                                                      .smoothed = smoothed,
                                                      .model = model,
                                                      .window = stretch.window,
                                                      .duration_s = stretch.duration_s},
                                                     {definition});
    return undetected_errors<2>(screened, arc, stretch, weights);
}

double speed_of(const WindowStretch<2>& stretch, SpeedDefinition definition) {
    return smoothed_speed(Chain<2>(stretch.epochs, estimate_model()), stretch.window,
                          stretch.duration_s, {definition})
        .speed_m_s;
}

const UndetectedError& entry(const std::vector<UndetectedError>& errors, Hypothesis hypothesis) {
    return *std::find_if(errors.begin(), errors.end(), [&](const UndetectedError& error) {
        return error.hypothesis == hypothesis;
    });
}

class Reliability : public testing::TestWithParam<SpeedDefinition> {
  public:
    ScreenedTable screened = screened_run();
    Arc<2> arc = arcs_of<2>(screened).front();
    WindowStretch<2> stretch = cut_stretch(arc, {320, 350}, 60.0);
    std::vector<UndetectedError> errors = errors_of(screened, arc, stretch, GetParam());
};

TEST_P(Reliability, NoDirectionOfAnUndetectedStepDoesMore) {
    // By brute force: at every epoch around the window a step in each of 36 directions, of the size
    // that its test finds with the power, put into the recording.
    const Chain<2> diagnosis(arc.epochs, model_of(screened.basis.models.front()));
    const double lambda = noncentrality(1e-8, 0.8, 2);
    const double before = speed_of(stretch, GetParam());
    double largest = 0.0;
    for (std::size_t k = 300; k < 380; ++k) {
        for (int i = 0; i < 36; ++i) {
            const double angle = 0.0872665 * i;
            const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
            const double size =
                std::sqrt(lambda / direction.dot(diagnosis.step(k).precision * direction));
            WindowStretch<2> moved = stretch;
            for (std::size_t j = k; j < moved.epochs.size(); ++j)
                moved.epochs[j].measurement->position += size * direction;
            const double effect = std::abs(speed_of(moved, GetParam()) - before);
            largest = std::max(largest, effect);
        }
    }
    const UndetectedError& step = entry(errors, Hypothesis::step);
    EXPECT_NEAR(step.speed_m_s, largest, 0.01 * largest);
    EXPECT_GT(step.epoch, 318);
    EXPECT_LT(step.epoch, 354);
    EXPECT_EQ(step.unit, "m");
    // A step inside the window is all of it in the displacement, smoothed over its surroundings.
    EXPECT_LT(step.speed_m_s, 1.1 * step.size / 3.0);
    EXPECT_GT(step.speed_m_s, 0.5 * step.size / 3.0);
}

TEST_P(Reliability, AnOutlierOfThatSizeDoesThat) {
    const UndetectedError& outlier = entry(errors, Hypothesis::outlier);
    const std::size_t k = static_cast<std::size_t>(outlier.epoch) - 1;
    const double before = speed_of(stretch, GetParam());
    double largest = 0.0;
    for (int i = 0; i < 360; ++i) {
        const double angle = 0.0174533 * i;
        WindowStretch<2> moved = stretch;
        moved.epochs[k].measurement->position +=
            outlier.size * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        largest = std::max(largest, std::abs(speed_of(moved, GetParam()) - before));
    }
    EXPECT_NEAR(outlier.speed_m_s, largest, 0.01 * largest);
}

TEST_P(Reliability, OneEntryForEachHypothesisLargestFirst) {
    ASSERT_EQ(errors.size(), 5U);
    for (std::size_t i = 1; i < errors.size(); ++i)
        EXPECT_GE(errors[i - 1].speed_m_s, errors[i].speed_m_s);
    EXPECT_EQ(errors.front().hypothesis, Hypothesis::ramp);  // at most as fast as it drifts
    EXPECT_LT(errors.front().speed_m_s, errors.front().size);
    // At a constant speed late stamps are a step along the track, with one unknown for two.
    const UndetectedError& late = entry(errors, Hypothesis::time_shift);
    EXPECT_LT(late.speed_m_s, entry(errors, Hypothesis::step).speed_m_s);
    EXPECT_GT(late.speed_m_s, 0.9 * entry(errors, Hypothesis::step).speed_m_s);
    EXPECT_NEAR(late.size * 60.0, entry(errors, Hypothesis::step).size,
                0.1 * entry(errors, Hypothesis::step).size);
    EXPECT_GE(entry(errors, Hypothesis::burst).last_epoch,
              entry(errors, Hypothesis::burst).epoch + 1);
}

INSTANTIATE_TEST_SUITE_P(OfEachDefinition, Reliability,
                         testing::Values(SpeedDefinition::displacement,
                                         SpeedDefinition::path_length,
                                         SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n));

TEST(ReliabilityOfAWindow, WithoutEvidenceNothingIsClaimed) {
    ScreenedTable screened = recorded({});
    const Arc<2> arc = arcs_of<2>(screened).front();
    const auto errors =
        errors_of(screened, arc, cut_stretch(arc, {320, 350}, 60.0), SpeedDefinition::displacement);
    EXPECT_TRUE(errors.empty());
}

TEST(ReliabilityOfAWindow, NoisierNeighboursHideMore) {
    ScreenedTable screened = screened_run();
    const Arc<2> arc = arcs_of<2>(screened).front();
    const WindowStretch<2> stretch = cut_stretch(arc, {320, 350}, 60.0);
    const auto quiet = errors_of(screened, arc, stretch, SpeedDefinition::displacement);
    for (ScreenedEpoch& row : screened.rows)
        row.local_variance_factor = 4.0;
    const auto noisy = errors_of(screened, arc, stretch, SpeedDefinition::displacement);
    EXPECT_NEAR(noisy.front().speed_m_s, 2.0 * quiet.front().speed_m_s, 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

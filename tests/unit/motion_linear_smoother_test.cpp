#include <gtest/gtest.h>

#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

template <int Axes>
std::vector<ArcEpoch<Axes>> measured_arc() {
    constexpr std::size_t epochs = 200;
    return test::sample_arc<Axes>(epochs, epochs);
}

template <int Axes>
std::vector<PositionVector<Axes>> positions_of(const std::vector<ArcEpoch<Axes>>& arc) {
    std::vector<PositionVector<Axes>> positions;
    for (const ArcEpoch<Axes>& epoch : arc)
        positions.push_back(epoch.measurement->position);
    return positions;
}

template <int Axes>
void expect_the_smoothers_positions(const std::vector<ArcEpoch<Axes>>& arc) {
    const Chain<Axes> linear(arc, test::singer_with_error);
    const auto positions = linear.positions_of(positions_of(arc));
    for (std::size_t k = 0; k < arc.size(); ++k)
        EXPECT_LT((positions[k] - linear.mean(k).template head<Axes>()).norm(), 1e-9) << k;
}

TEST(ChainPositions, GivesThePositionsOfTheSmoother) {
    expect_the_smoothers_positions(measured_arc<1>());
    expect_the_smoothers_positions(measured_arc<2>());
    expect_the_smoothers_positions(test::with_changing_motion(measured_arc<2>()));
    expect_the_smoothers_positions(
        test::with_changing_motion(test::at_equal_steps(measured_arc<2>())));
}

/// Four recordings: the arc's own positions, with steps put in and without, and noise alone.
template <int Axes>
void expect_lanes_as_alone(std::vector<ArcEpoch<Axes>> arc) {
    const Chain<Axes> linear(arc, test::singer_with_error);
    RandomGenerator random(4);
    std::vector<LanePositions<Axes, 4>> together(arc.size());
    std::array<std::vector<PositionVector<Axes>>, 4> alone;
    for (std::size_t l = 0; l < 4; ++l)
        for (std::size_t k = 0; k < arc.size(); ++k) {
            PositionVector<Axes> position =
                l % 2 == 0 ? arc[k].measurement->position
                           : PositionVector<Axes>(PositionVector<Axes>::Zero());
            for (double& one : position)
                one += 0.01 * random.normal();
            alone[l].push_back(position);
            for (std::size_t a = 0; a < Axes; ++a)
                together[k][a][static_cast<Eigen::Index>(l)] =
                    position(static_cast<Eigen::Index>(a));
        }
    const auto smoothed = linear.template positions_of<4>(together);
    for (std::size_t l = 0; l < 4; ++l) {
        const auto one = linear.positions_of(alone[l]);
        for (std::size_t k = 0; k < arc.size(); ++k)
            for (std::size_t a = 0; a < Axes; ++a)
                ASSERT_EQ(smoothed[k][a][static_cast<Eigen::Index>(l)],
                          one[k](static_cast<Eigen::Index>(a)))
                    << l << " " << k << " " << a;
    }
}

TEST(ChainPositions, RecordingsSideBySideAreEachAsByItself) {
    expect_lanes_as_alone<1>(measured_arc<1>());
    expect_lanes_as_alone<2>(measured_arc<2>());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

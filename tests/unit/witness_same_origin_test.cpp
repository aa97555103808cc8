#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/random.h"
#include "witness/kinds/gates.h"
#include "witness/same_origin.h"

// What was made from the positions, and what was measured beside them.

namespace runcert::RUNCERT_FILE {
namespace {

using velocities::SpeedBesidePosition;
using Rows = std::vector<SpeedBesidePosition>;

/// A craft on a curve, with white noise of the positions.
Rows recorded(double noise_m, std::uint64_t seed, double first_s = 0.0) {
    RandomGenerator random(seed);
    Rows rows;
    for (int k = 0; k < 600; ++k) {
        const double t = first_s + 0.1 * k;
        rows.push_back({.time_s = t,
                        .position_m = {400.0 * std::sin(0.05 * t) + noise_m * random.normal(),
                                       400.0 * std::cos(0.05 * t) + noise_m * random.normal()}});
    }
    return rows;
}

Rows changed(Rows rows, const std::function<Eigen::Vector2d(const SpeedBesidePosition&)>& change) {
    for (SpeedBesidePosition& row : rows)
        row.position_m = change(row);
    return rows;
}

Eigen::Vector2d rounded_to_mm(const Eigen::Vector2d& position) {
    return (position * 1000.0).array().round() / 1000.0;
}

TEST(SameOrigin, TwoReceiversHaveErrorsOfTheirOwn) {
    const Rows first = recorded(0.01, 1);
    EXPECT_FALSE(share_errors(first, recorded(0.01, 2), 0.0));
    // A better receiver, a worse one, and one at other instants.
    EXPECT_FALSE(share_errors(first, recorded(0.003, 3), 0.0));
    EXPECT_FALSE(share_errors(first, recorded(0.05, 4), 0.0));
    EXPECT_FALSE(share_errors(first, recorded(0.01, 5, 0.05), 0.0));
    EXPECT_FALSE(share_errors(first, {}, 0.0));
}

TEST(SameOrigin, ACopyHasTheErrorsOfTheFirst) {
    const Rows first = recorded(0.01, 1);
    EXPECT_TRUE(share_errors(first, first, 0.0));
    const auto moved = [&](auto change) {
        return share_errors(first, changed(first, change), 0.0);
    };
    // WitnessRecords it, turned about a little, with another antenna's sway, rounded.
    EXPECT_TRUE(moved([](const auto& row) -> Eigen::Vector2d {
        return row.position_m + Eigen::Vector2d(0.4, -0.7);
    }));
    EXPECT_TRUE(moved([](const auto& row) -> Eigen::Vector2d {
        return row.position_m + 0.5 * Eigen::Vector2d(std::sin(0.1 * row.time_s), 0.3);
    }));
    EXPECT_TRUE(moved([](const auto& row) { return rounded_to_mm(row.position_m); }));
    EXPECT_TRUE(moved([](const auto& row) -> Eigen::Vector2d { return 1.0005 * row.position_m; }));
    // The same on another clock.
    Rows later = first;
    for (SpeedBesidePosition& row : later)
        row.time_s -= 7.0;
    EXPECT_TRUE(share_errors(first, later, 7.0));
    // Every second one.
    Rows thinned;
    for (std::size_t i = 0; i < first.size(); i += 2)
        thinned.push_back(first[i]);
    EXPECT_TRUE(share_errors(first, thinned, 0.0));
}

TEST(SameOrigin, ACopyBetweenTheInstantsIsFound) {
    const Rows first = recorded(0.01, 1);
    Rows between;
    for (std::size_t i = 1; i < first.size(); ++i)
        between.push_back({.time_s = 0.5 * (first[i - 1].time_s + first[i].time_s),
                           .position_m = 0.5 * (first[i - 1].position_m + first[i].position_m)});
    EXPECT_TRUE(share_errors(first, between, 0.0));
}

/// Speeds as a weighted mean of central differences over so many rows.
Rows with_made_speeds(Rows rows, std::size_t either_side, bool smooth) {
    for (std::size_t k = either_side; k + either_side < rows.size(); ++k) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t h = smooth ? 1 : either_side; h <= either_side; ++h) {
            const double weight = static_cast<double>(h * h * (either_side + 1 - h));
            sum += weight * (rows[k + h].position_m - rows[k - h].position_m).norm() /
                   (rows[k + h].time_s - rows[k - h].time_s);
            weights += weight;
        }
        rows[k].speed_m_s = sum / weights;
    }
    return rows;
}

TEST(SameOrigin, SpeedsSmoothedFromThePositionsAreToldFromMeasuredOnes) {
    const Rows rows = recorded(0.01, 1);
    for (const std::size_t either_side : {1U, 2U, 6U, 15U, 30U})
        for (const bool smooth : {false, true}) {
            SCOPED_TRACE(either_side);
            EXPECT_TRUE(are_filtered_positions(with_made_speeds(rows, either_side, smooth)));
        }
    for (const double noise_m_s : {0.003, 0.03, 0.3}) {
        SCOPED_TRACE(noise_m_s);
        RandomGenerator random(9);
        Rows measured = rows;
        for (SpeedBesidePosition& row : measured)
            row.speed_m_s = 20.0 + noise_m_s * random.normal();
        EXPECT_FALSE(are_filtered_positions(measured));
    }
    EXPECT_FALSE(are_filtered_positions(rows));
    EXPECT_FALSE(are_filtered_positions({}));
}

TEST(SameOrigin, MeasuredSpeedsLeaveThePositionsAndMadeOnesDoNot) {
    const auto spread = [](double span_s, double sd_m) {
        return DisplacementSpread{.span_s = span_s, .sd_m = sd_m, .sd_upper_m = 1.2 * sd_m};
    };
    // A car with fixed ambiguities, and a logger on a board: of real recordings.
    EXPECT_FALSE(keep_to_positions(
        std::vector{spread(3, 0.0116), spread(10, 0.0256), spread(30, 0.0567)}, false));
    EXPECT_FALSE(keep_to_positions(
        std::vector{spread(30, 0.357), spread(100, 0.956), spread(300, 1.43)}, true));
    // Made from positions of 7 mm, and of a logger's code positions.
    EXPECT_TRUE(keep_to_positions(std::vector{spread(3, 0.01), spread(10, 0.008)}, false));
    EXPECT_TRUE(keep_to_positions(std::vector{spread(3, 0.05), spread(100, 0.06)}, true));
    // Of a short recording that cannot be said.
    EXPECT_FALSE(keep_to_positions(std::vector{spread(3, 0.001)}, false));
}

/// Gates every 60 m, passed at 60 m/s, with these errors of their distances.
GateWitness gates(const std::vector<double>& errors_m) {
    std::vector<GatePassage> passages;
    for (std::size_t i = 0; i < errors_m.size(); ++i) {
        const auto at = static_cast<double>(i);
        passages.push_back({.time_s = at,
                            .distance_m = 60.0 * at + errors_m[i],
                            .position_m = {60.0 * at, 0.0},
                            .speed_m_s = 60.0});
    }
    return {passages, {.sigma_distance_m = 0.005, .sigma_time_s = 0.0001}};
}

TEST(SameOrigin, GatesThatAgreeBetterThanTheyClaimWereMadeFromThePositions) {
    EXPECT_TRUE(gates({0.0, 0.0}).agrees_too_well());
    EXPECT_TRUE(gates({0.0, 0.0005, -0.0005, 0.0005, 0.0}).agrees_too_well());
    EXPECT_FALSE(gates({0.0, 0.012}).agrees_too_well());
    EXPECT_FALSE(gates({0.0, 0.009, -0.004, 0.011, 0.002}).agrees_too_well());
    EXPECT_FALSE(gates({0.0}).agrees_too_well());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

#include "check_decision_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stages/check/decision.h"

namespace runcert::RUNCERT_FILE {
namespace {

using decision_table::Group;
using decision_table::Row;

Threshold threshold_of_group(const Group& group) {
    return threshold_of(
        group.task.rule,
        {.speed_m_s = group.task.record * group.task.unit_m_s,
         .expanded_uncertainty_m_s = group.task.record_expanded_uncertainty * group.task.unit_m_s});
}

SpeedPosterior posterior_of(const Group& group, const Row& row) {
    SpeedPosterior posterior{
        .speed_m_s = row.speed * group.task.unit_m_s,
        .standard_uncertainty_m_s = row.standard_uncertainty * group.task.unit_m_s};
    if (row.degrees_of_freedom != decision_table::kInfinite)
        posterior.effective_degrees_of_freedom = row.degrees_of_freedom;
    return posterior;
}

TEST(DecisionTable, HoldsAHundredRows) {
    std::size_t rows = 0;
    for (const Group& group : decision_table::groups())
        rows += group.rows.size();
    EXPECT_GE(rows, 120U);
}

TEST(DecisionTable, SpeedsToReachAreThoseWorkedOutInDecimals) {
    for (const Group& group : decision_table::groups()) {
        const Threshold threshold = threshold_of_group(group);
        EXPECT_NEAR(threshold.speed_m_s / group.task.unit_m_s, group.task.speed_to_reach, 1e-10);
        EXPECT_NEAR(threshold.standard_uncertainty_m_s / group.task.unit_m_s,
                    group.task.its_standard_uncertainty, 1e-12);
    }
}

TEST(DecisionTable, EveryRowHasItsProbabilityAndOutcome) {
    for (const Group& group : decision_table::groups()) {
        const Threshold threshold = threshold_of_group(group);
        for (const Row& row : group.rows) {
            SCOPED_TRACE(testing::Message()
                         << "record " << group.task.record << ", speed " << row.speed << ", u "
                         << row.standard_uncertainty << ", level " << row.level);
            const double probability = conformance_probability(posterior_of(group, row), threshold);
            EXPECT_NEAR(probability, row.probability, 1e-9);
            EXPECT_EQ(decide(probability, row.level), row.outcome);
        }
    }
}

TEST(DecisionTable, AcceptanceLimitTellsTheAcceptedSpeedsFromTheOthers) {
    for (const Group& group : decision_table::groups()) {
        const Threshold threshold = threshold_of_group(group);
        for (const Row& row : group.rows) {
            const SpeedPosterior posterior = posterior_of(group, row);
            const double limit_m_s = acceptance_limit(posterior, threshold, row.level);
            SCOPED_TRACE(testing::Message()
                         << "speed " << row.speed << ", limit " << limit_m_s / group.task.unit_m_s);
            EXPECT_EQ(posterior.speed_m_s >= limit_m_s * (1.0 - 1e-14),
                      row.outcome == Outcome::beaten);
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

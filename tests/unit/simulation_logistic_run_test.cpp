#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "simulation/simulate.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Fields of a CSV line.
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');)
        fields.push_back(field);
    return fields;
}

/// As a table prints it; the paper's keeps the sign of a zero.
std::string printed(double value) {
    const std::string text = format_fixed(value, 6);
    return std::signbit(value) && text == "0.000000" ? "-" + text : text;
}

TEST(LogisticRun, ReproducesTable2OfThePaperToItsPrintedDigits) {
    // Deakin, Holden & Daddo 2022, table 2: all 17 rows, as text.
    std::ifstream file(RUNCERT_SOURCE_DIR "/examples/land_yacht/table_2_reference.csv");
    std::string line;
    std::getline(file, line);
    ASSERT_EQ(line,
              "epoch,time_s,distance_m,velocity_m_s,acceleration_m_s2,jerk_m_s3,east_m,north_m");
    SimulationSpec spec;  // the paper's run is the default
    spec.run.start = {1000.0, 1000.0, 0.0};
    const auto epochs = simulate(spec);
    ASSERT_EQ(epochs.size(), 451U);
    int rows = 0;
    for (; std::getline(file, line); ++rows) {
        const auto row = fields_of(line);
        ASSERT_EQ(row.size(), 8U);
        const SimulatedEpoch& epoch = epochs.at(std::stoul(row[0]) - 1);
        EXPECT_EQ(format_fixed(epoch.time_s(), 1), row[1]);
        EXPECT_EQ(printed(epoch.truth.distance_m), row[2]) << line;
        EXPECT_EQ(printed(epoch.truth.speed_m_s), row[3]) << line;
        EXPECT_EQ(printed(epoch.truth.acceleration_m_s2), row[4]) << line;
        EXPECT_EQ(printed(epoch.truth.jerk_m_s3), row[5]) << line;
        EXPECT_EQ(printed(epoch.true_enu_m.x()), row[6]) << line;
        EXPECT_EQ(printed(epoch.true_enu_m.y()), row[7]) << line;
    }
    EXPECT_EQ(rows, 17);
}

TEST(LogisticRun, HasDerivativesThatAreDerivatives) {
    const LogisticRun run{.top_speed_m_s = 64.5, .start_speed_m_s = 0.1, .half_speed_time_s = 25.0};
    const double h = 1e-3;
    for (const double t : {-3.0, 0.0, 5.0, 20.0, 24.99, 25.0, 30.0, 50.0, 80.0}) {
        const RunState before = logistic_run(run, t - h);
        const RunState now = logistic_run(run, t);
        const RunState after = logistic_run(run, t + h);
        const auto slope = [&](double RunState::*of) {
            return (after.*of - before.*of) / (2.0 * h);
        };
        EXPECT_NEAR(slope(&RunState::distance_m), now.speed_m_s, 1e-6);
        EXPECT_NEAR(slope(&RunState::speed_m_s), now.acceleration_m_s2, 1e-6);
        EXPECT_NEAR(slope(&RunState::acceleration_m_s2), now.jerk_m_s3, 1e-6);
    }
}

TEST(LogisticRun, AgreesWithTheEquationsAsThePaperWritesThem) {
    const LogisticRun run;
    const double A = 60.0;
    const double r = std::log(A / 0.01 - 1.0) / 15.0;
    for (double t = 0.0; t < 45.0; t += 0.7) {
        const double u = r * (t - 15.0);
        const RunState state = logistic_run(run, t);
        EXPECT_NEAR(state.acceleration_m_s2, A * r / (2.0 * (1.0 + std::cosh(u))), 1e-13);
        EXPECT_NEAR(state.jerk_m_s3,
                    -(A * r * r / 2.0) * std::sinh(u) / std::pow(1.0 + std::cosh(u), 2), 1e-13);
    }
}

TEST(LogisticRun, StaysFiniteFarFromTheTimeOfHalfSpeed) {
    // cosh(1000) overflows, and sinh / cosh^2 would be no number.
    for (const double t : {-1e5, 1e5}) {
        const RunState state = logistic_run({}, t);
        EXPECT_EQ(state.speed_m_s, t > 0.0 ? 60.0 : 0.0);
        EXPECT_EQ(state.acceleration_m_s2, 0.0);
        EXPECT_EQ(state.jerk_m_s3, 0.0);
    }
    EXPECT_NEAR(logistic_run({}, 1e5).distance_m, 60.0 * (1e5 - 15.0), 0.1);
}

TEST(LogisticRun, IsRefusedWhereItIsNone) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const LogisticRun& run : {LogisticRun{60.0, 30.0, 15.0}, LogisticRun{60.0, 0.0, 15.0},
                                   LogisticRun{60.0, -1.0, 15.0}, LogisticRun{60.0, 0.01, 0.0},
                                   LogisticRun{60.0, 0.01, nan}, LogisticRun{nan, 0.01, 15.0},
                                   LogisticRun{60.0, nan, 15.0}, LogisticRun{HUGE_VAL, 1.0, 15.0}})
        EXPECT_THROW((void)logistic_run(run, 1.0), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

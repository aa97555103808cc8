#include <gtest/gtest.h>

#include "dhd22_data.h"
#include "reports/run_speeds/run_speeds.h"

namespace runcert::published::RUNCERT_FILE {
namespace {

double rounded_to_mm(double value) {
    return std::round(value * 1000.0) / 1000.0;
}

/// Every row of a table of one method's speeds, to the printed millimetre per second, and its
/// printed difference from the reference to the printed micrometre per second.
void expect_table(const std::string& name, const std::vector<std::optional<double>>& speeds) {
    const auto rows = read_numbers("tests/published/data/" + name);
    ASSERT_EQ(rows.size(), 41U);
    for (const auto& row : rows) {
        const auto epoch = static_cast<std::size_t>(row[0]);
        SCOPED_TRACE(row[0]);
        ASSERT_TRUE(speeds[epoch - 1].has_value());
        EXPECT_EQ(format_fixed(*speeds[epoch - 1], 3), format_fixed(row[2], 3));
        EXPECT_NEAR(true_speed_m_s(row[1]), row[3], 0.51e-6);
        EXPECT_NEAR(rounded_to_mm(*speeds[epoch - 1]) - true_speed_m_s(row[1]), row[4], 1.01e-6);
    }
}

/// Speeds less the truth over epochs 261 to 301.
std::vector<double> errors(const std::vector<std::optional<double>>& speeds, bool round_first) {
    std::vector<double> differences;
    for (std::size_t epoch = 261; epoch <= 301; ++epoch) {
        const double speed = speeds[epoch - 1].value();
        differences.push_back((round_first ? rounded_to_mm(speed) : speed) -
                              true_speed_m_s(0.1 * static_cast<double>(epoch - 1)));
    }
    return differences;
}

TEST(Dhd22, AllRowsOfTable4AreMethodV1) {
    expect_table("table_4_v1.csv", speed_v1(appendix_a()));
}

TEST(Dhd22, AllRowsOfTable5AreMethodV2) {
    expect_table("table_5_v2.csv", speed_v2(appendix_a()));
}

TEST(Dhd22, PrintedStatisticsOfV1FromRoundedValues) {
    const Statistics v1 = statistics_of(errors(speed_v1(appendix_a()), true));
    EXPECT_EQ(format_fixed(v1.mean, 6), "0.001338");
    EXPECT_EQ(format_fixed(v1.variance, 6), "0.003928");
    EXPECT_EQ(format_fixed(std::sqrt(v1.variance), 6), "0.062677");
    EXPECT_EQ(format_fixed(v1.root_mean_square, 6), "0.061922");
}

TEST(Dhd22, PrintedStatisticsOfV2FromRoundedValues) {
    const Statistics v2 = statistics_of(errors(speed_v2(appendix_a()), true));
    EXPECT_EQ(format_fixed(v2.mean, 6), "0.000679");
    EXPECT_EQ(format_fixed(v2.variance, 6), "0.000915");
    EXPECT_EQ(format_fixed(std::sqrt(v2.variance), 6), "0.030247");
}

TEST(Dhd22, StatisticsFromUnroundedValues) {
    const Statistics v1 = statistics_of(errors(speed_v1(appendix_a()), false));
    EXPECT_EQ(format_fixed(v1.mean, 6), "0.001325");
    EXPECT_EQ(format_fixed(std::sqrt(v1.variance), 6), "0.062649");
    EXPECT_EQ(format_fixed(v1.root_mean_square, 6), "0.061895");
    const Statistics v2 = statistics_of(errors(speed_v2(appendix_a()), false));
    EXPECT_EQ(format_fixed(v2.mean, 6), "0.000592");
    EXPECT_EQ(format_fixed(std::sqrt(v2.variance), 6), "0.030283");
}

/// The run with these as its speeds.
TrajectoryTable with_speeds(const std::vector<std::optional<double>>& speeds) {
    TrajectoryTable table;
    table.facts.nominal_interval_s = 0.1;
    for (std::size_t k = 0; k < speeds.size(); ++k) {
        TrajectoryEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time = {row.epoch * 100'000'000 - 100'000'000};
        row.east_m = row.north_m = 0.0;
        row.speed_m_s = speeds[k];
        if (speeds[k]) row.arc = 1;
    }
    return table;
}

TEST(Dhd22, StatisticsOfTheAuditAreThePrintedOnes) {
    const auto differences = [](const std::vector<std::optional<double>>& speeds) {
        const std::vector<double> errors_m_s = errors(speeds, true);
        return method_speeds(with_speeds({errors_m_s.begin(), errors_m_s.end()}), 1, 41).at(0);
    };
    const MethodSpeeds v1 = differences(speed_v1(appendix_a()));
    EXPECT_EQ(v1.epochs, 41);
    EXPECT_EQ(format_fixed(v1.mean_m_s, 6), "0.001338");
    EXPECT_EQ(format_fixed(v1.standard_deviation_m_s, 6), "0.062677");
    const MethodSpeeds v2 = differences(speed_v2(appendix_a()));
    EXPECT_EQ(format_fixed(v2.mean_m_s, 6), "0.000679");
    EXPECT_EQ(format_fixed(v2.standard_deviation_m_s, 6), "0.030247");
}

// (27): A[k] = A[k-1] + (v[k] - v[k-31]) / 31.
TEST(Dhd22, TheSpeedOverARulesLengthIsTheMovingAverage) {
    const struct {
        std::vector<std::optional<double>> speeds;
        double best_m_s;
    } methods[] = {{speed_v1(appendix_a()), 60.0068}, {speed_v2(appendix_a()), 60.0045}};
    Profile rule;
    rule.duration_s = 3.0;
    for (const auto& [speeds, best_m_s] : methods) {
        const auto averages = speeds_over_length(with_speeds(speeds), rule);
        double largest_m_s = 0.0;
        for (std::size_t k = 31; k < averages.size(); ++k) {
            if (!averages[k]) continue;
            largest_m_s = std::max(largest_m_s, *averages[k]);
            if (!averages[k - 1]) continue;
            EXPECT_NEAR(*averages[k], *averages[k - 1] + (*speeds[k] - *speeds[k - 31]) / 31.0,
                        1e-11);
        }
        EXPECT_NEAR(largest_m_s, best_m_s, 0.5e-4);
    }
}

TEST(Dhd22, PrintedKalmanStates) {
    const auto states = filter_dhd22(appendix_a(), 0.1);
    struct Printed {
        std::size_t epoch;
        const char* text;
    };
    for (const Printed& row : {Printed{289, "1585.498 1585.498 42.414 42.419"},
                               Printed{290, "1589.738 1589.737 42.409 42.413"},
                               Printed{291, "1593.982 1593.976 42.417 42.408"},
                               Printed{292, "1598.229 1598.220 42.428 42.414"}}) {
        const Eigen::Vector4d& mean = states[row.epoch - 1].mean;
        EXPECT_EQ(format_fixed(mean(0), 3) + " " + format_fixed(mean(1), 3) + " " +
                      format_fixed(mean(2), 3) + " " + format_fixed(mean(3), 3),
                  row.text);
    }
}

TEST(Dhd22, PrintedSteadyCofactors) {
    const Eigen::Matrix4d covariance = filter_dhd22(appendix_a(), 0.1).back().covariance;
    EXPECT_EQ(format_fixed(covariance(0, 0), 6), "0.000036");
    EXPECT_EQ(format_fixed(covariance(0, 2), 6), "0.000080");
    EXPECT_EQ(format_fixed(covariance(2, 2), 6), "0.000400");
}

}  // namespace
}  // namespace runcert::published::RUNCERT_FILE

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "import_test_support.h"
#include "stages/import/inspect.h"

// The recorded speed skydives.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

constexpr std::int64_t three_seconds_ns = 3'000'000'000;

/// The fastest vertical stretch of exactly 3 s between two epochs.
struct VerticalBest {
    double by_heights_kmh = 0.0;        ///< best difference of the heights at both ends
    double velocities_there_kmh = 0.0;  ///< mean of the velocities of that stretch's epochs
    double by_velocities_kmh = 0.0;     ///< best mean of the velocities of a stretch's epochs
    double start_s = 0.0;               ///< of the best by heights, since the first epoch
};

/// Both ends count among the epochs: 31 of them at 10 Hz.
VerticalBest vertical_best(const std::vector<Observation>& rows) {
    VerticalBest best;
    std::size_t last = 0;
    for (std::size_t first = 0; first < rows.size(); ++first) {
        while (last < rows.size() &&
               rows[last].time.nanoseconds < rows[first].time.nanoseconds + three_seconds_ns)
            ++last;
        if (last == rows.size()) break;
        if (rows[last].time.nanoseconds != rows[first].time.nanoseconds + three_seconds_ns)
            continue;
        double sum_m_s = 0.0;
        for (std::size_t i = first; i <= last; ++i)
            sum_m_s -= *rows[i].recorded_velocity_up_m_s;
        const double velocities_kmh = 3.6 * sum_m_s / static_cast<double>(last - first + 1);
        const double heights_kmh = 3.6 * (*rows[first].height_m - *rows[last].height_m) / 3.0;
        best.by_velocities_kmh = std::max(best.by_velocities_kmh, velocities_kmh);
        if (heights_kmh <= best.by_heights_kmh) continue;
        best.by_heights_kmh = heights_kmh;
        best.velocities_there_kmh = velocities_kmh;
        best.start_s = static_cast<double>(rows[first].time.nanoseconds) * 1e-9;
    }
    return best;
}

std::optional<std::string> skydive(const std::string& name) {
    return recorded("speed_skydive/" + name + ".csv");
}

TEST(FlysightRecorded, VerticalBestThreeSeconds) {
    const auto text = skydive("flysight1_good");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *text);
    EXPECT_EQ(read.rows.size(), 20352u);
    EXPECT_EQ(read.records.bad, 0);
    const VerticalBest best = vertical_best(read.rows);
    EXPECT_NEAR(best.by_heights_kmh, 444.61, 0.02);
    EXPECT_NEAR(best.velocities_there_kmh, 443.46, 0.02);
    EXPECT_NEAR(best.by_velocities_kmh, 443.47, 0.02);
    EXPECT_NEAR(best.start_s, 1505.3, 1e-6);
    // The first epochs, before the receiver has settled, state accuracies that say so.
    EXPECT_NEAR(*read.rows[0].sigma_east_m, 149.252 / std::sqrt(2.0), 1e-9);
}

/// Stated standard deviations reach 319.54 m in the fall itself, and 435.55 m in the climb before
/// it.
TEST(FlysightRecorded, BadAccuracyAndGaps) {
    const auto text = skydive("flysight1_bad_accuracy_gaps");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *text);
    EXPECT_EQ(read.rows.size(), 6731u);
    EXPECT_EQ(read.records.bad, 0);
    const Inspection inspection = inspect(read);
    EXPECT_EQ(inspection.gaps, 46u);
    EXPECT_NEAR(inspection.longest_gap_s, 407.2, 1e-9);
    EXPECT_NEAR(*inspection.worst_horizontal_m, 435.55, 1e-6);
    const auto at_5144 =
        std::find_if(read.rows.begin(), read.rows.end(),
                     [](const Observation& row) { return row.source_line == 5144; });
    ASSERT_NE(at_5144, read.rows.end());
    EXPECT_NEAR(std::hypot(*at_5144->sigma_east_m, *at_5144->sigma_north_m), 319.537, 1e-9);
}

/// Every name in the header but the last is followed by XXX: by which column a figure is meant can
/// only be guessed, and that is refused.
TEST(FlysightRecorded, BadHeader) {
    const auto text = skydive("flysight1_bad_header");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string message = failure_of(pos_receiver(), *text);
    EXPECT_EQ(message.rfind("f:1:1: the header names no column \"time\": \"timeXXX,latXXX,", 0), 0u)
        << message;
}

/// Lines end in CR CR LF: every one is still whole.
TEST(FlysightRecorded, DoubledCarriageReturns) {
    const auto text = skydive("flysight1_crlf");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *text);
    EXPECT_EQ(read.rows.size(), 8u);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(read.rows[7].satellites, 4);
    EXPECT_EQ(std::count_if(read.notes.begin(), read.notes.end(),
                            [](const std::string& note) {
                                return note.find("two carriage returns") != std::string::npos;
                            }),
              1);
}

/// What the second FlySight logs of its own buffers, without a position.
TEST(FlysightRecorded, LogOfWorkings) {
    const auto text = skydive("flysight2_bad");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string message = failure_of(pos_receiver(), *text);
    EXPECT_EQ(message.rfind("f:1:1: the recording is a FlySight's log of its own workings", 0), 0u)
        << message;
}

TEST(FlysightRecorded, SecondFlysight) {
    const auto text = skydive("flysight2_track");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *text);
    EXPECT_EQ(read.variant, "FlySight 2");
    EXPECT_EQ(read.rows.size(), 16022u);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2024-09-17T18:56:32.200Z");
    EXPECT_NEAR(read.facts.nominal_interval_s, 0.1, 1e-9);
    EXPECT_EQ(inspect(read).gaps, 15u);
    EXPECT_NEAR(std::hypot(*read.rows[0].sigma_east_m, *read.rows[0].sigma_north_m), 635.066, 1e-9);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

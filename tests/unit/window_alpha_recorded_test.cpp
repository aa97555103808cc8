#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/geodesy.h"
#include "window_search_support.h"

// The alphas of three loggers on one rider, and what the loggers themselves printed.

namespace runcert::RUNCERT_FILE {
namespace {

using test::alpha;

/// A file of the recorded data, or nothing where they are not there.
std::optional<std::string> recorded(const std::string& name) {
    const char* folder = std::getenv("RUNCERT_DATA");
    if (!folder) return std::nullopt;
    std::ifstream file(std::string(folder) + "/windsurf_loggers/" + name, std::ios::binary);
    EXPECT_TRUE(file.good()) << name;
    return std::string(std::istreambuf_iterator<char>(file), {});
}

template <typename Value>
Value value_at(const std::string& bytes, std::size_t at) {
    Value value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

/// The epochs with a fix, times since midnight UTC; no window may span more than a second without.
SampleSeries series_of(const std::string& log) {
    constexpr std::size_t header = 512, epoch = 52;
    constexpr std::int64_t day_ms = 86'400'000;
    SampleSeries series;
    std::optional<LocalFrame> frame;
    for (std::size_t at = header; at + epoch <= log.size(); at += epoch) {
        if (value_at<std::uint8_t>(log, at + 32) < 2) continue;
        const Geodetic place{Angle::from_degrees(value_at<std::int32_t>(log, at + 4) * 1e-7),
                             Angle::from_degrees(value_at<std::int32_t>(log, at + 8) * 1e-7), 0.0};
        if (!frame) frame.emplace(place);
        const double speed_m_s = value_at<std::uint32_t>(log, at + 16) * 1e-3;
        const ElapsedTime time{value_at<std::int64_t>(log, at + 24) % day_ms * 1'000'000};
        const double step_s =
            series.times.empty() ? 0.0 : time.seconds() - series.times.back().seconds();
        const double before_m_s = series.times.empty() ? 0.0 : series.speeds_m_s.back();
        const double before_m = series.times.empty() ? 0.0 : series.path_m.back();
        const std::int64_t gaps = series.times.empty() ? 0 : series.obstacles.back();
        series.path_m.push_back(before_m + 0.5 * (before_m_s + speed_m_s) * step_s);
        series.obstacles.push_back(gaps + (step_s > 1.0 ? 1 : 0));
        series.times.push_back(time);
        series.speeds_m_s.push_back(speed_m_s);
        Eigen::Vector3d position = frame->enu_from_ecef(ecef_from_geodetic(place)).m;
        position.z() = 0.0;
        series.positions.push_back(position);
    }
    return series;
}

/// A line of the loggers' own results: "37.969 km/h 49.000 m 10:32:40 Run: 0 Alfa500".
struct Printed {
    double kmh = 0.0;
    double second_of_day = 0.0;  ///< UTC
};

std::vector<Printed> printed_alphas(const std::string& text, int distance_m) {
    std::vector<Printed> results;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        double kmh = 0.0, apart_m = 0.0;
        int hour = 0, minute = 0, second = 0, run = 0, distance = 0;
        if (std::sscanf(line.c_str(), "%lf km/h %lf m %d:%d:%d Run: %d Alfa%d", &kmh, &apart_m,
                        &hour, &minute, &second, &run, &distance) == 7 &&
            distance == distance_m)
            results.push_back({kmh, 3600.0 * (hour - 2) + 60.0 * minute + second});
    }
    return results;
}

struct Logger {
    const char* name;
    double fastest_500_kmh, fastest_250_kmh;  ///< by the same rule, computed with NumPy
};

class AlphaRecorded : public testing::TestWithParam<Logger> {};

/// The nine alphas of either length that a logger printed are the nine fastest. The times it prints
/// are some seconds after their ends.
TEST_P(AlphaRecorded, TheLoggersOwnResults) {
    const std::string name = GetParam().name;
    const auto log = recorded(name + ".oao");
    if (!log) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string results = *recorded(name + "_device_results.txt");
    const std::vector<SampleSeries> series{series_of(*log)};
    for (const auto& [distance_m, fastest_kmh] :
         {std::pair{500, GetParam().fastest_500_kmh}, {250, GetParam().fastest_250_kmh}}) {
        SCOPED_TRACE(distance_m);
        const auto windows = best_windows(series, alpha(distance_m), 9);
        const auto printed = printed_alphas(results, distance_m);
        ASSERT_EQ(windows.size(), 9u);
        ASSERT_EQ(printed.size(), 9u);
        EXPECT_NEAR(3.6 * windows[0].speed_m_s, fastest_kmh, 0.001);
        // Nor is any shorter one faster, as long as it goes out and back.
        const auto any = best_windows(series, test::any_alpha(distance_m), 9);
        ASSERT_EQ(any.size(), 9u);
        for (std::size_t i = 0; i < any.size(); ++i) {
            EXPECT_GE(any[i].speed_m_s, windows[i].speed_m_s - 1e-9);
            EXPECT_NEAR(any[i].speed_m_s, windows[i].speed_m_s, 0.01 / 3.6);
        }
        for (const FoundWindow& window : windows) {
            EXPECT_GT(window.length_m, distance_m - 2.0);
            EXPECT_LE(window.length_m, distance_m + path_rounding_m);
        }
        for (const Printed& one : printed)
            EXPECT_EQ(std::count_if(windows.begin(), windows.end(),
                                    [&](const FoundWindow& window) {
                                        const double lag_s =
                                            one.second_of_day - window.end.seconds();
                                        return lag_s > 0.0 && lag_s < 15.0 &&
                                               std::abs(3.6 * window.speed_m_s - one.kmh) < 0.065;
                                    }),
                      1)
                << one.kmh;
    }
}

INSTANTIATE_TEST_SUITE_P(All, AlphaRecorded,
                         testing::Values(Logger{"head_left", 37.909, 34.049},
                                         Logger{"head_right", 37.875, 34.088},
                                         Logger{"boom_left", 37.879, 34.091}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace runcert::RUNCERT_FILE

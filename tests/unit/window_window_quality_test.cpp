#include <gtest/gtest.h>

#include <cmath>

#include "stages/window/window_quality.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Two arcs of six epochs each, with a row between them that belongs to neither.
struct Epochs {
    ScreenedTable screened;
    std::vector<ArcRows> arcs{{.number = 1, .rows = {0, 1, 2, 3, 4, 5}},
                              {.number = 2, .rows = {7, 8, 9, 10, 11, 12}}};

    Epochs() {
        for (std::int64_t k = 0; k < 13; ++k) {
            ScreenedEpoch& row = screened.rows.emplace_back();
            row.epoch = k + 1;
            row.time.nanoseconds = 1'000'000'000 * k;
            row.usable = k != 6;
            row.sigma_east_m = row.sigma_north_m = 0.01 * static_cast<double>(k + 1);
            row.sigma_up_m = 0.5;
            row.detectable.outlier_m = k == 9 ? 3.0 : 0.1;
            row.recorded_speed_m_s = 10.0;
            row.sigma_recorded_speed_m_s = 0.2;
        }
        screened.rows[4].sigma_recorded_speed_m_s.reset();
    }
    static FoundWindow window(std::size_t series, std::size_t first, std::size_t last) {
        return {.series = series, .first = first, .last = last, .start = {}, .end = {}};
    }
};

double root_mean_square(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(WindowQuality, IsThatOfTheEpochsWithinIt) {
    Epochs epochs;
    const WindowQualities qualities(epochs.screened, epochs.arcs, {});
    const WindowQuality first = qualities(Epochs::window(0, 2, 4));
    EXPECT_NEAR(first.stated, root_mean_square({0.03, 0.04, 0.05}), 1e-12);
    EXPECT_NEAR(first.missed, 0.1, 1e-12);
    EXPECT_FALSE(first.silent);
    const WindowQuality second = qualities(Epochs::window(1, 1, 3));
    EXPECT_NEAR(second.stated, root_mean_square({0.09, 0.10, 0.11}), 1e-12);
    EXPECT_NEAR(second.missed, root_mean_square({0.1, 3.0, 0.1}), 1e-12);
    Profile with_floor;
    with_floor.uncertainty.error_floor_m["fixed"] = 0.04;
    for (ScreenedEpoch& row : epochs.screened.rows)
        row.fix = FixType::fixed;
    EXPECT_NEAR(
        WindowQualities(epochs.screened, epochs.arcs, with_floor)(Epochs::window(0, 2, 4)).stated,
        root_mean_square({0.04, 0.04, 0.05}), 1e-12);
    Profile upright;
    upright.dimension = Dimension::vertical;
    EXPECT_NEAR(
        WindowQualities(epochs.screened, epochs.arcs, upright)(Epochs::window(0, 2, 4)).stated, 0.5,
        1e-12);
}

TEST(WindowQuality, OfRecordedSpeedsSaysWhereTheirAccuracyIsNotStated) {
    const Epochs epochs;
    Profile profile;
    profile.speed_source = SpeedSource::velocity;
    const WindowQualities qualities(epochs.screened, epochs.arcs, profile);
    EXPECT_TRUE(qualities(Epochs::window(0, 2, 4)).silent);
    EXPECT_TRUE(qualities(Epochs::window(0, 4, 5)).silent);
    EXPECT_FALSE(qualities(Epochs::window(0, 0, 3)).silent);
    EXPECT_NEAR(qualities(Epochs::window(0, 0, 3)).stated, 0.2, 1e-12);
    EXPECT_EQ(qualities(Epochs::window(0, 0, 3)).missed, 0.0);
}

TEST(WindowQuality, IsBetterInOneThingOrNone) {
    const WindowQuality usual{.stated = 0.01, .missed = 0.1, .witnesses = 0b01, .silent = false};
    const auto no_better = [&](const WindowQuality& one) { return one.no_better_than(usual); };
    EXPECT_TRUE(no_better(usual));
    EXPECT_TRUE(no_better({.stated = 0.0095, .missed = 0.2, .witnesses = 0, .silent = false}));
    EXPECT_FALSE(no_better({.stated = 0.008, .missed = 0.2, .witnesses = 0b01, .silent = false}));
    EXPECT_FALSE(no_better({.stated = 0.02, .missed = 0.08, .witnesses = 0b01, .silent = false}));
    EXPECT_FALSE(no_better({.stated = 0.02, .missed = 0.2, .witnesses = 0b11, .silent = false}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

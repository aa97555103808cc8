#include <gtest/gtest.h>

#include "stages/import/raw_track.h"

// A recording as it is drawn by `inspect --plot`.

namespace runcert::RUNCERT_FILE {
namespace {

Observation at(std::int64_t tenths, std::optional<double> east, std::optional<double> north) {
    Observation row;
    row.time.nanoseconds = tenths * 100'000'000;
    row.plane_east_m = east;
    row.plane_north_m = north;
    return row;
}

TEST(RawTrack, HasTheSpeedFromEachPositionToTheNextButAcrossNoGap) {
    Observations recording;
    recording.facts.nominal_interval_s = 0.1;
    recording.rows = {at(0, 10.0, 20.0), at(1, 10.3, 20.4), at(3, 11.0, 20.4),
                      at(2, std::nullopt, std::nullopt), at(9, 11.0, 20.4)};
    recording.rows[1].sigma_east_m = 0.3;
    recording.rows[1].sigma_north_m = 0.4;
    const RawTrack track = raw_track(recording);
    const std::vector<double> in_order{0.0, 0.1, 0.2, 0.3, 0.9};
    ASSERT_EQ(track.time_s.size(), in_order.size());
    for (std::size_t i = 0; i < in_order.size(); ++i)
        EXPECT_DOUBLE_EQ(track.time_s[i], in_order[i]);
    EXPECT_NEAR(*track.east_m[1], 0.3, 1e-12);
    EXPECT_NEAR(*track.north_m[1], 0.4, 1e-12);
    EXPECT_FALSE(track.east_m[2]);
    EXPECT_NEAR(*track.position_speed_m_s[1], 5.0, 1e-9);
    for (const std::size_t none : {0U, 2U, 3U, 4U})
        EXPECT_FALSE(track.position_speed_m_s[none]) << none;
    EXPECT_NEAR(*track.sigma_horizontal_m[1], 0.5, 1e-12);
    ASSERT_EQ(track.gaps.size(), 1U);
    EXPECT_DOUBLE_EQ(track.gaps[0].first, 0.3);
    EXPECT_DOUBLE_EQ(track.gaps[0].second, 0.9);
}

TEST(RawTrack, OfGeodeticPositionsIsInMetres) {
    Observations recording;
    recording.facts.nominal_interval_s = 1.0;
    for (int i = 0; i < 2; ++i) {
        Observation row = at(10 * i, std::nullopt, std::nullopt);
        row.latitude_deg = 1e-4 * i;
        row.longitude_deg = 1e-4 * i;
        row.height_m = 0.0;
        recording.rows.push_back(row);
    }
    const RawTrack track = raw_track(recording);
    // On the equator: the radius of the meridian, and that of the equator.
    EXPECT_NEAR(*track.north_m[1], 110.574 * 0.1, 1e-3);
    EXPECT_NEAR(*track.east_m[1], 111.320 * 0.1, 1e-3);
}

TEST(RawTrack, OfNothingIsEmpty) {
    EXPECT_TRUE(raw_track({}).time_s.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

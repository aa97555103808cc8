#include <cmath>

#include "core/statistics.h"
#include "import_phase_support.h"
#include "satellites/phase_displacement.h"

namespace runcert::import_test {
namespace RUNCERT_FILE {

const Eigen::Vector3d master_m(-3749943.5172, 3683398.2394, 3600629.5295);

/// What L1's phases above the mask say between two epochs.
std::vector<PhaseChange> changes(const PhaseRecord& record, std::size_t a, std::size_t b,
                                 double mask_deg) {
    const double least = std::sin(mask_deg / 180.0 * 3.14159265358979);
    std::vector<PhaseChange> all;
    for (const PhaseSatellite& first : record.of(record.epochs[a]))
        for (const PhaseSatellite& second : record.of(record.epochs[b])) {
            if (first.id != second.id || !first.has_orbit() || first.sine_of_elevation < least)
                continue;
            const PhaseSignal& one = record.of(first)[0];
            const PhaseSignal& two = record.of(second)[0];
            if (one.code.band != 1 || two.code != one.code) continue;
            const double wavelength_m =
                speed_of_light_m_s / *carrier_frequency_hz(first.id.system, one.code.band);
            all.push_back({.satellite_m = {first.position_m, second.position_m},
                           .clock_m = {first.clock_m, second.clock_m},
                           .phase_m = wavelength_m * (two.phase_cycles - one.phase_cycles)});
        }
    return all;
}

TEST(PhaseDisplacement, TheBaseStandsStillAsComputedElsewhere) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Phases phases =
        recorded_phases("rinex_pair/yamatogawa_master.obs", "rinex_pair/yamatogawa_rover.nav");
    const PhaseRecord& record = phases.record;
    ASSERT_EQ(record.epochs.size(), 193U);
    const ReceiverPosition place = receiver_position(master_m);
    struct Row {
        std::size_t from;  // the first epoch is 280634 s of its week
        Eigen::Vector3d enu_mm;
    };
    for (const Row& row : {Row{0, {0.88, -2.15, -0.48}}, Row{60, {4.35, -2.37, -1.97}}}) {
        const auto seen = changes(record, row.from, row.from + 3, 15.0);
        const auto moved = phase_displacement(seen, place, 3.0, PhaseNoise{});
        ASSERT_TRUE(moved);
        EXPECT_LT((moved->enu_m * 1e3 - row.enu_mm).cwiseAbs().maxCoeff(), 0.1)
            << (moved->enu_m * 1e3).transpose();
        if (row.from == 0) {
            EXPECT_EQ(seen.size(), 7U);
            EXPECT_NEAR(moved->clock_m, 0.4766, 0.0001);
        }
    }
    std::vector<double> east_mm, north_mm, up_mm;
    for (std::size_t i = 0; i + 3 < record.epochs.size(); ++i) {
        const auto moved = phase_displacement(changes(record, i, i + 3, 15.0), place, 3.0, {});
        ASSERT_TRUE(moved);
        east_mm.push_back(moved->enu_m.x() * 1e3);
        north_mm.push_back(moved->enu_m.y() * 1e3);
        up_mm.push_back(moved->enu_m.z() * 1e3);
    }
    EXPECT_EQ(east_mm.size(), 190U);
    EXPECT_LT(standard_deviation(east_mm), 3.0);
    EXPECT_LT(standard_deviation(north_mm), 4.0);
    EXPECT_LT(standard_deviation(up_mm), 15.0);
}

TEST(PhaseTable, ElevationsComeOfTheReceiversOwnPlace) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Phases phases =
        recorded_phases("rinex_pair/yamatogawa_master.obs", "rinex_pair/yamatogawa_rover.nav");
    EXPECT_EQ(phases.head.epochs, 193);
    EXPECT_EQ(phases.head.nominal_interval_s, 1.0);
    EXPECT_GE(phases.head.ephemerides.size(), 9U);
    const ReceiverPosition place = receiver_position(master_m);
    for (const PhaseSatellite& satellite : phases.record.of(phases.record.epochs[100]))
        EXPECT_NEAR(satellite.sine_of_elevation,
                    line_of_sight(satellite.position_m, place).sine_of_elevation, 1e-4);
}

TEST(PhaseTable, AUbxLogBringsItsOwnOrbits) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Phases phases = recorded_phases("ubx_walk/rover.ubx", "");
    EXPECT_EQ(phases.head.epochs, 536);
    int with_orbit = 0, with_elevation = 0;
    for (const PhaseSatellite& satellite : phases.record.satellites) {
        with_orbit += satellite.has_orbit();
        with_elevation += satellite.sine_of_elevation > 0.0F;
    }
    EXPECT_GT(with_orbit, 5000);
    EXPECT_EQ(with_elevation, with_orbit);
}

TEST(PhaseTable, NavigationOfAnotherDayIsRefusedWithSatelliteAndAge) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    try {
        (void)recorded_phases("rinex_pair/yamatogawa_master.obs", "rinex_still/javad.nav");
        FAIL() << "was read";
    } catch (const Failure& failure) {
        EXPECT_TRUE(has(failure.what(), "G02")) << failure.what();
        EXPECT_TRUE(has(failure.what(), " h away")) << failure.what();
    }
}

TEST(PhaseTable, RinexWithoutNavigationIsRefused) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    EXPECT_THROW((void)recorded_phases("rinex_pair/yamatogawa_master.obs", ""), Failure);
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test

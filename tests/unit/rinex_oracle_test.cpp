#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "import_test_support.h"
#include "satellites/ephemeris.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/ubx/raw.h"
#include "store/process.h"

// RTKLIB's programs as oracles: an independent reader, and independent orbits and clocks.
namespace runcert::import_test {
namespace RUNCERT_FILE {

namespace fs = std::filesystem;

fs::path data(const std::string& name) {
    return fs::path(std::getenv("RUNCERT_DATA")) / name;
}

/// Runs one of RTKLIB's programs in a folder; what it says is dropped.
void call(const fs::path& folder, const std::string& command) {
    const std::string line =
        "cd '" + folder.string() + "' && " + command + " > /dev/null 2> /dev/null";
    ASSERT_EQ(std::system(line.c_str()), 0) << command;
}

std::vector<MeasuredEpoch> rinex_epochs(const std::string& text) {
    std::vector<MeasuredEpoch> epochs;
    (void)rinex::read_measurements({.name = "f.obs", .bytes = text},
                                   [&](MeasuredEpoch& epoch) { epochs.push_back(epoch); });
    return epochs;
}

TEST(RtklibOracle, OrbitsAndClocksAtTransmissionAreThoseOfRtklib) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const fs::path observed = data("rinex_pair/yamatogawa_master.obs");
    const fs::path broadcast = data("rinex_pair/yamatogawa_rover.nav");
    call(folder.path(),
         "rnx2rtkp -p 0 -x 4 -o s.pos '" + observed.string() + "' '" + broadcast.string() + "'");
    Ephemerides ephemerides(
        rinex::read_navigation({.name = "n", .bytes = slurp(broadcast)}).ephemerides);
    std::map<std::pair<std::int64_t, int>, SatelliteState> ours;
    for (const MeasuredEpoch& epoch : rinex_epochs(slurp(observed)))
        for (const SignalMeasurement& signal : epoch.measurements) {
            if (signal.signal.band != 1) continue;
            const auto chosen = ephemerides.choose(signal.satellite, epoch.time);
            ASSERT_TRUE(chosen);
            ours[{epoch.time.nanoseconds() / GpsTime::nanoseconds_per_second,
                  signal.satellite.number}] =
                state_at_transmission(ephemerides[*chosen], epoch.time, *signal.pseudorange_m);
        }
    std::istringstream trace(slurp(folder.path() / "s.pos.trace"));
    int compared = 0;
    for (std::string line; std::getline(trace, line);) {
        CalendarTime time;
        double second = 0.0, x = 0.0, y = 0.0, z = 0.0, clock_ns = 0.0;
        int satellite = 0;
        if (std::sscanf(line.c_str(), "4 %d/%d/%d %d:%d:%lf sat=%d rs=%lf %lf %lf dts=%lf",
                        &time.year, &time.month, &time.day, &time.hour, &time.minute, &second,
                        &satellite, &x, &y, &z, &clock_ns) != 11)
            continue;
        // Sent within the 100 ms before the whole second of its reception.
        const std::int64_t received =
            GpsTime::from_calendar(time).nanoseconds() / GpsTime::nanoseconds_per_second +
            static_cast<std::int64_t>(std::ceil(second));
        const auto found = ours.find({received, satellite});
        ASSERT_NE(found, ours.end()) << line;
        EXPECT_LT((found->second.position_m - Eigen::Vector3d(x, y, z)).cwiseAbs().maxCoeff(),
                  0.001)
            << line;
        EXPECT_NEAR(found->second.clock_s * 1e9, clock_ns, 0.001) << line;
        ++compared;
    }
    EXPECT_GT(compared, 1500);
}

using SignalKey = std::pair<Satellite, SignalCode>;

std::map<SignalKey, SignalMeasurement> by_signal(const MeasuredEpoch& epoch) {
    std::map<SignalKey, SignalMeasurement> all;
    for (const SignalMeasurement& each : epoch.measurements)
        all[{each.satellite, each.signal}] = each;
    return all;
}

TEST(RtklibOracle, RawMeasurementsOfTheWalkAreThoseOfConvbin) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    call(folder.path(), "convbin -r ubx -v 3.03 -od -os -o w.obs -n w.nav '" +
                            data("ubx_walk/rover.ubx").string() + "'");
    const std::vector<MeasuredEpoch> theirs = rinex_epochs(slurp(folder.path() / "w.obs"));
    std::vector<MeasuredEpoch> ours;
    const std::string recording = slurp(data("ubx_walk/rover.ubx"));
    const ubx::RawFile raw =
        ubx::read_raw({.name = "rover.ubx", .bytes = recording},
                      TakeMeasurements([&](MeasuredEpoch& epoch) { ours.push_back(epoch); }));
    ASSERT_EQ(ours.size(), 536U);
    ASSERT_EQ(theirs.size(), ours.size());
    int phases = 0, ranges = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        // RINEX has seven decimals of a second, and convbin writes them from a double.
        EXPECT_NEAR(theirs[i].time.seconds_since(ours[i].time), 0.0, 1e-7);
        const auto mine = by_signal(ours[i]);
        for (const auto& [key, signal] : by_signal(theirs[i])) {
            const auto found = mine.find(key);
            ASSERT_NE(found, mine.end()) << to_text(key.first) << " " << to_text(key.second);
            if (signal.phase_cycles) {
                EXPECT_NEAR(*found->second.phase_cycles, *signal.phase_cycles, 0.00051);
                ++phases;
            }
            if (signal.pseudorange_m) {
                EXPECT_NEAR(*found->second.pseudorange_m, *signal.pseudorange_m, 0.00051);
                EXPECT_NEAR(*found->second.doppler_hz, *signal.doppler_hz, 0.00051);
                ++ranges;
            }
        }
    }
    EXPECT_GT(phases, 7000);
    EXPECT_GT(ranges, 9000);
    // What its ephemerides say is what convbin wrote into its navigation file.
    const rinex::NavigationFile navigation =
        rinex::read_navigation({.name = "w.nav", .bytes = slurp(folder.path() / "w.nav")});
    std::set<Satellite> gps;
    for (const Ephemeris& theirs_of : navigation.ephemerides) {
        const auto same = std::ranges::find_if(raw.ephemerides, [&](const Ephemeris& each) {
            return each.satellite == theirs_of.satellite && each.issue == theirs_of.issue;
        });
        ASSERT_NE(same, raw.ephemerides.end()) << to_text(theirs_of.satellite);
        EXPECT_EQ(same->reference, theirs_of.reference);
        EXPECT_EQ(same->healthy, theirs_of.healthy);
        EXPECT_NEAR(same->group_delay_s, theirs_of.group_delay_s, 1e-14);
        for (const double after_s : {-3600.0, 0.0, 5400.0}) {
            const GpsTime time = same->reference.plus_nanoseconds(std::llround(after_s * 1e9));
            const SatelliteState mine = satellite_state(*same, time);
            const SatelliteState other = satellite_state(theirs_of, time);
            EXPECT_LT((mine.position_m - other.position_m).norm(), 1e-3);
            EXPECT_NEAR(mine.clock_s, other.clock_s, 1e-13);
        }
        gps.insert(theirs_of.satellite);
    }
    EXPECT_GE(gps.size(), 4U);
    std::set<Satellite> galileo;
    for (const Ephemeris& each : raw.ephemerides)
        if (each.satellite.system == SatelliteSystem::galileo) galileo.insert(each.satellite);
    EXPECT_GE(galileo.size(), 4U);
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test

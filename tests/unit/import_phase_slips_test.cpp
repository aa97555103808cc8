#include <algorithm>
#include <cmath>
#include <map>

#include "core/statistics.h"
#include "import_phase_support.h"
#include "phase_injection.h"
#include "satellites/line_of_sight.h"
#include "satellites/phase_screening.h"
#include "witness/phase_witness.h"

// Real phases, with slips put into them; bounds leave room for other draws.
namespace runcert::import_test {
namespace RUNCERT_FILE {

const Eigen::Vector3d base_m(-3749943.5172, 3683398.2394, 3600629.5295);

Phases located(const std::string& observed, const std::string& navigation) {
    Phases phases = recorded_phases(observed, navigation);
    locate_by_pseudoranges(phases.record);
    return phases;
}

/// The displacements over 3 s that phases give, and the epochs at which they begin and end.
struct Window {
    std::size_t first, second;
    WitnessedDisplacement moved;
};

std::vector<Window> windows_of_3_s(const PhaseRecord& record, const PhaseScreening& screening) {
    std::vector<Window> windows;
    for (std::size_t a = 0, b = 0; a < record.epochs.size(); ++a) {
        while (b < record.epochs.size() &&
               record.epochs[b].time_ns - record.epochs[a].time_ns < 2'990'000'000)
            ++b;
        if (b == record.epochs.size()) break;
        if (record.epochs[b].time_ns - record.epochs[a].time_ns > 3'010'000'000) continue;
        if (const auto moved = displacement_between(record, screening, a, b))
            windows.push_back({a, b, *moved});
    }
    return windows;
}

struct Scatter {
    std::size_t count = 0;
    Eigen::Vector3d deviation_mm;
};

Scatter scatter(const std::vector<Window>& windows) {
    Scatter result{.count = windows.size(), .deviation_mm = {}};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Window& window : windows)
            values.push_back(window.moved.enu_m[axis] * 1e3);
        result.deviation_mm[axis] = standard_deviation(values);
    }
    return result;
}

TEST(PhaseScreening, AGeodeticReceiverStandingStillHasNoSlipAndMillimetres) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Phases javad = located("rinex_still/javad.obs", "rinex_still/javad.nav");
    const PhaseScreening screening = screen_phases(javad.record, {});
    EXPECT_TRUE(screening.slips.empty());
    EXPECT_TRUE(screening.refusals.empty());
    EXPECT_TRUE(screening.jumps.empty());
    EXPECT_EQ(screening.pairs, 129);
    EXPECT_LT(screening.noise.white_m, 0.0012);
    const Scatter still = scatter(windows_of_3_s(javad.record, screening));
    EXPECT_EQ(still.count, 127U);
    EXPECT_LE(still.deviation_mm.x(), 3.0);
    EXPECT_LE(still.deviation_mm.y(), 3.5);
    EXPECT_LE(still.deviation_mm.z(), 8.0);
    const Phases novatel = located("rinex_still/novatel.obs", "rinex_still/novatel.nav");
    const PhaseScreening other = screen_phases(novatel.record, {});
    EXPECT_TRUE(other.slips.empty());
    EXPECT_TRUE(other.refusals.empty());
    EXPECT_EQ(windows_of_3_s(novatel.record, other).size(), 43U);
}

TEST(PhaseScreening, TheWalkIsAsFastAsItsFixedPositionsSay) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Phases walk = located("ubx_walk/rover.ubx", "");
    const PhaseScreening screening = screen_phases(walk.record, {});
    const Observations positions = import_text(pos_receiver(), *recorded("ubx_walk/rover.pos"));
    // Times agree to the receiver's clock: by tenths of a second.
    const auto tick = [](GpsTime time) { return (time.nanoseconds() + 50'000'000) / 100'000'000; };
    std::map<std::int64_t, const Observation*> fixed;
    for (const Observation& row : positions.rows)
        if (row.fix == FixType::fixed)
            fixed[tick(positions.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds))] = &row;
    const auto position_of = [](const Observation& row) {
        return ecef_from_geodetic({.latitude = Angle::from_degrees(*row.latitude_deg),
                                   .longitude = Angle::from_degrees(*row.longitude_deg),
                                   .height_m = *row.height_m})
            .m;
    };
    std::vector<double> difference_mm_s;
    double best_by_phase = 0.0, best_by_positions = 0.0;
    for (const Window& window : windows_of_3_s(walk.record, screening)) {
        const auto at = [&](std::size_t epoch) {
            return fixed.find(
                tick(walk.head.first_epoch.plus_nanoseconds(walk.record.epochs[epoch].time_ns)));
        };
        const auto from = at(window.first), to = at(window.second);
        if (from == fixed.end() || to == fixed.end()) continue;
        const ReceiverPosition place = receiver_position(position_of(*from->second));
        const Eigen::Vector3d enu_m =
            place.enu_from_ecef * (position_of(*to->second) - place.position_m);
        const double by_positions = enu_m.head<2>().norm() / 3.0;
        const double by_phase = window.moved.enu_m.head<2>().norm() / window.moved.interval_s;
        difference_mm_s.push_back((by_phase - by_positions) * 1e3);
        best_by_phase = std::max(best_by_phase, by_phase);
        best_by_positions = std::max(best_by_positions, by_positions);
    }
    EXPECT_GT(difference_mm_s.size(), 200U);
    EXPECT_LE(standard_deviation(difference_mm_s), 12.0);
    EXPECT_LE(std::abs(mean(difference_mm_s)), 2.0);
    EXPECT_NEAR(best_by_phase, best_by_positions, 0.010);
}

struct SlipCase {
    const char* observed;
    const char* navigation;
    bool is_base;
    double most_refused;
};

class InjectedSlips : public testing::TestWithParam<SlipCase> {};

TEST_P(InjectedSlips, AreFoundInRealPhasesOfOneFrequency) {
    if (!std::getenv("RUNCERT_DATA")) GTEST_SKIP() << "RUNCERT_DATA is not set";
    Phases phases = located(GetParam().observed, GetParam().navigation);
    if (GetParam().is_base)
        for (PhaseEpoch& epoch : phases.record.epochs)
            epoch.receiver_m = base_m;
    const PhaseRecord single = single_frequency(phases.record);
    struct Class {
        std::size_t satellites;
        int least, most;
        double most_wrong;
    };
    for (const Class& one : {Class{1, 1, 1, 0.005}, Class{1, 2, 2, 0.005}, Class{1, 3, 10, 0.005},
                             Class{2, 1, 10, 0.015}}) {
        const Trials trials = inject(single, one.satellites, one.least, one.most, 600, 26);
        const auto share = [&](int count) { return static_cast<double>(count) / trials.count; };
        const std::string what = fmt::format(
            "{}: {} satellites, {} to {} cycles: {} trials, {} found, {} refused, {} wrong, {} "
            "repaired, {} wrongly",
            GetParam().observed, one.satellites, one.least, one.most, trials.count, trials.found,
            trials.refused, trials.wrong, trials.repaired, trials.wrongly_repaired);
        RecordProperty("injected", what);
        if (std::getenv("RUNCERT_FIGURES")) fmt::print("{}\n", what);
        EXPECT_LE(share(trials.wrong), one.most_wrong) << what;
        EXPECT_LE(share(trials.refused), GetParam().most_refused) << what;
        if (one.satellites == 1) {
            EXPECT_EQ(trials.wrongly_repaired, 0) << what;
            EXPECT_GT(trials.repaired, trials.count / 2) << what;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Recorded, InjectedSlips,
                         testing::Values(SlipCase{"rinex_pair/yamatogawa_master.obs",
                                                  "rinex_pair/yamatogawa_rover.nav", true, 0.02},
                                         SlipCase{"ubx_walk/rover.ubx", "", false, 0.02},
                                         SlipCase{"rinex_pair/yamatogawa_rover.obs",
                                                  "rinex_pair/yamatogawa_rover.nav", false, 0.10}),
                         [](const auto& made) {
                             return std::string(made.index == 0   ? "Base"
                                                : made.index == 1 ? "Walk"
                                                                  : "Rover");
                         });

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test

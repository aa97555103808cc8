#include <cmath>

#include "core/statistics.h"
#include "import_phase_support.h"
#include "phase_injection.h"
#include "simulation/raw_measurements.h"
#include "stages/import/rinex/rinex.h"
#include "witness/phase_witness.h"

namespace runcert::import_test {
namespace RUNCERT_FILE {

std::string broadcast() {
    return slurp(std::string(RUNCERT_SOURCE_DIR) + "/examples/phase/broadcast.nav");
}

/// 60 m/s at 10 Hz, from the start.
SimulationSpec run_of(double duration_s, std::uint64_t seed) {
    SimulationSpec spec;
    spec.run = {.top_speed_m_s = 60.0, .start_speed_m_s = 29.0, .half_speed_time_s = 0.2};
    spec.run.duration_s = duration_s;
    spec.place = Geodetic{.latitude = Angle::from_degrees(-31.6),
                          .longitude = Angle::from_degrees(136.0),
                          .height_m = 110.0};
    spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
    spec.seed = static_cast<std::int64_t>(seed);
    return spec;
}

PhaseRecord simulated(const SimulationSpec& spec, const RawSpec& raw) {
    const std::string navigation = broadcast();
    const auto epochs = simulate(spec);
    const std::string text = rinex_observations_text(
        spec, raw, epochs, rinex::read_navigation({.name = "n", .bytes = navigation}).ephemerides);
    const StreamedPhases phases = import_phases(pos_receiver(), {.name = "raw.obs", .bytes = text},
                                                {{.name = "broadcast.nav", .bytes = navigation}});
    PhaseRecordBuilder builder(phases.head);
    phases.give([&](const PhaseRow& row) { builder.add(row); });
    PhaseRecord record = std::move(builder).take();
    locate_by_pseudoranges(record);
    return record;
}

class SimulatedSlips : public testing::TestWithParam<bool> {};

TEST_P(SimulatedSlips, AreFoundAt60MetresASecond) {
    const bool two_bands = GetParam();
    RawSpec raw;
    raw.bands = two_bands ? 2 : 1;
    raw.phase_noise_m = 0.0012;
    raw.clock_drift = 3e-7;
    // 10,000 epochs in all.
    std::vector<PhaseRecord> records;
    std::int64_t pairs = 0, refused = 0, excluded = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        records.push_back(simulated(run_of(99.9, seed), raw));
        const PhaseScreening clean = screen_phases(records.back(), {});
        EXPECT_NEAR(clean.noise.white_m, 0.0012, 0.0002);
        pairs += clean.pairs;
        refused += std::ssize(clean.refusals);
        excluded += std::ssize(clean.slips);
    }
    EXPECT_EQ(pairs, 5 * 999);
    EXPECT_LE(static_cast<double>(refused), 0.001 * static_cast<double>(pairs));
    EXPECT_LE(static_cast<double>(excluded), 0.001 * static_cast<double>(pairs));
    struct Class {
        std::size_t satellites;
        double least_found, most_wrong;
    };
    for (const Class& one : {Class{1, 0.99, 0.001}, Class{2, 0.98, 0.001}, Class{3, 0.98, 0.001}}) {
        Trials all;
        for (std::size_t i = 0; i < records.size(); ++i) {
            const Trials trials = inject(records[i], one.satellites, 1, 10, 400, 100 + i);
            all.count += trials.count;
            all.found += trials.found;
            all.refused += trials.refused;
            all.wrong += trials.wrong;
            all.wrongly_repaired += trials.wrongly_repaired;
        }
        const std::string what = fmt::format(
            "{} bands, {} satellites: {} trials, {} found, {} refused, {} wrong", two_bands ? 2 : 1,
            one.satellites, all.count, all.found, all.refused, all.wrong);
        if (std::getenv("RUNCERT_FIGURES")) fmt::print("{}\n", what);
        EXPECT_GE(all.found, one.least_found * all.count) << what;
        EXPECT_LE(all.wrong, one.most_wrong * all.count) << what;
        if (one.satellites == 1) {
            EXPECT_EQ(all.wrongly_repaired, 0) << what;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Bands, SimulatedSlips, testing::Bool(),
                         [](const auto& made) { return std::string(made.param ? "Two" : "One"); });

TEST(SimulatedPhases, ShowTheTrueMotionAndTheClocksJumps) {
    RawSpec raw;
    raw.clock_offset_s = 0.00049;
    raw.clock_drift = 1e-6;  // a jump at 10 s, and every 1000 s
    raw.clock_jumps = true;
    const SimulationSpec spec = run_of(30.0, 3);
    const auto truth = simulate(spec);
    const PhaseRecord record = simulated(spec, raw);
    const PhaseScreening screening = screen_phases(record, {});
    EXPECT_TRUE(screening.slips.empty());
    ASSERT_EQ(screening.jumps.size(), 1U);
    EXPECT_EQ(screening.jumps[0].milliseconds, -1);
    EXPECT_NEAR(static_cast<double>(record.epochs[screening.jumps[0].epoch].time_ns) * 1e-9, 10.1,
                0.15);
    std::vector<double> errors_m_s;
    for (std::size_t a = 0; a + 30 < record.epochs.size(); ++a) {
        const auto moved = displacement_between(record, screening, a, a + 30);
        ASSERT_TRUE(moved);
        const double true_m = (truth[a + 30].true_enu_m - truth[a].true_enu_m).norm();
        // The way over the nominal 3 s, by the speed over what the clock says they were.
        errors_m_s.push_back(moved->enu_m.head<2>().norm() / moved->interval_s - true_m / 3.0);
        EXPECT_NEAR(moved->interval_s, 3.0, 0.0011);
        EXPECT_EQ(moved->satellites, 12U);
    }
    // A jump of 1 ms at 60 m/s is 60 mm in 3 s, 20 mm/s, where it is not seen.
    for (std::size_t a = 10; a < errors_m_s.size(); ++a)
        EXPECT_LT(std::abs(errors_m_s[a]), 0.005) << a;
}

TEST(SimulatedPhases, OfOpenHalfCyclesAndOutagesAreNotUsed) {
    RawSpec raw;
    const Satellite satellite{SatelliteSystem::gps, 22};
    raw.half_cycles = {{.from_s = 5.0, .to_s = 8.0, .satellite = satellite}};
    raw.outages = {{.from_s = 12.0, .to_s = 13.0, .satellite = satellite}};
    raw.slips = {
        {.time_s = 20.0, .satellite = satellite, .band = 1, .cycles = 2.0, .is_flagged = true}};
    const PhaseRecord record = simulated(run_of(25.0, 4), raw);
    const PhaseScreening screening = screen_phases(record, {});
    EXPECT_TRUE(screening.slips.empty());
    std::vector<PhaseBreak> breaks;
    int half = 0;
    for (const PhaseSatellite& each : record.satellites) {
        if (each.id != satellite) continue;
        const PhaseFinding& finding = screening.findings[each.first_signal];
        half += finding.use == PhaseUse::half_cycle;
        if (finding.begins != PhaseBreak::none) breaks.push_back(finding.begins);
    }
    EXPECT_EQ(half, 30);
    EXPECT_EQ(breaks, (std::vector{PhaseBreak::start, PhaseBreak::gap, PhaseBreak::gap,
                                   PhaseBreak::lost_lock}));
}

TEST(SimulatedPhases, FromFiveSatellitesAreNotEnough) {
    RawSpec raw;
    raw.mask_deg = 0.0;
    PhaseRecord record = simulated(run_of(10.0, 5), raw);
    // Elevations decide: five stay above the mask.
    for (PhaseEpoch& epoch : record.epochs) {
        std::vector<double> sines;
        for (const PhaseSatellite& each : record.of(epoch))
            sines.push_back(each.sine_of_elevation);
        std::ranges::sort(sines, std::greater<>());
        for (std::size_t i = 0; i < epoch.satellites; ++i) {
            PhaseSatellite& each = record.satellites[epoch.first_satellite + i];
            if (each.sine_of_elevation < sines[4]) each.sine_of_elevation = 0.1F;
        }
    }
    const PhaseScreening screening = screen_phases(record, {});
    EXPECT_FALSE(displacement_between(record, screening, 0, 30));
}

TEST(SimulatedPhases, AnEphemerisThatChangesEndsTheArc) {
    PhaseRecord record = simulated(run_of(10.0, 6), {});
    const std::size_t changes = 50;
    for (std::size_t i = changes; i < record.epochs.size(); ++i)
        record.satellites[record.epochs[i].first_satellite].issue = 99;
    const PhaseScreening screening = screen_phases(record, {});
    const PhaseSatellite& changed = record.of(record.epochs[changes])[0];
    EXPECT_EQ(screening.findings[changed.first_signal].begins, PhaseBreak::ephemeris);
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test

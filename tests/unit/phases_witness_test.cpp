#include <Eigen/LU>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "import_phase_support.h"
#include "motion/speed.h"
#include "schemas/screened_phase/declared.h"
#include "simulation/raw_measurements.h"
#include "stages/enu/enu.h"
#include "stages/import/rinex/rinex.h"
#include "stages/screen/phases.h"
#include "stages/screen/screen.h"
#include "stages/screen/witness_check.h"
#include "stages/smooth/noise.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "stages/window/witnesses.h"
#include "witness/arcs.h"
#include "witness/screened_phases.h"

namespace runcert::import_test {
namespace RUNCERT_FILE {

const Attempt& default_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: a\ncraft: {name: a, class: land-yacht}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n",
        "attempt.yaml");
    return attempt;
}

std::string broadcast() {
    return slurp(std::string(RUNCERT_SOURCE_DIR) + "/examples/phase/broadcast.nav");
}

/// 64 m/s at 10 Hz for so long, with raw measurements beside the positions.
struct RawRun {
    SimulationSpec spec;
    std::vector<SimulatedEpoch> epochs;
    EnuTable table;
    ScreenedPhases screened;

    RawRun(double duration_s, const RawSpec& raw, double sigma_m, std::uint64_t seed = 1) {
        spec.run = {.top_speed_m_s = 64.5, .start_speed_m_s = 32.0, .half_speed_time_s = 0.2};
        spec.run.duration_s = duration_s;
        spec.place = Geodetic{.latitude = Angle::from_degrees(-31.6),
                              .longitude = Angle::from_degrees(136.0),
                              .height_m = 110.0};
        spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
        spec.white_noise = {.horizontal_m = sigma_m, .vertical_m = 2.0 * sigma_m};
        spec.seed = static_cast<std::int64_t>(seed);
        epochs = simulate(spec);
        fill_table(sigma_m);
        measure(raw);
    }

    /// From the position so many seconds after the start, or to the last recorded one.
    std::shared_ptr<const PhaseWitness<2>> witness(double jerk_density = 0.6) const {
        return std::make_shared<const PhaseWitness<2>>(
            screened.witness<2>(table, jerk_density).value());
    }
    Eigen::Vector2d true_m(double time_s) const {
        return epochs[static_cast<std::size_t>(std::lround(time_s * 10.0))].true_enu_m.head<2>();
    }

  private:
    void fill_table(double sigma_m) {
        table.facts.receiver = "primary";
        table.facts.georeferenced = true;
        table.facts.vertical_measured = false;
        table.facts.first_epoch = spec.start_gps;
        table.facts.nominal_interval_s = 0.1;
        table.origin.emplace();
        table.origin->position = *spec.place;
        for (const SimulatedEpoch& epoch : epochs) {
            EnuEpoch& row = table.rows.emplace_back();
            row.epoch = epoch.epoch;
            row.time = {epoch.time_ms * 1'000'000};
            row.east_m = epoch.measured_enu_m.x();
            row.north_m = epoch.measured_enu_m.y();
            row.sigma_east_m = row.sigma_north_m = sigma_m;
            row.fix = FixType::fixed;
        }
    }
    void measure(const RawSpec& raw) {
        const std::string navigation = broadcast();
        const std::string text = rinex_observations_text(
            spec, raw, epochs,
            rinex::read_navigation({.name = "n", .bytes = navigation}).ephemerides);
        const StreamedPhases phases =
            import_phases(pos_receiver(), {.name = "raw.obs", .bytes = text},
                          {{.name = "broadcast.nav", .bytes = navigation}});
        PhaseRecordBuilder builder(phases.head);
        phases.give([&](const PhaseRow& row) { builder.add(row); });
        screened = screen_receiver_phases(phases.head, std::move(builder).take(), table, {});
    }
};

RawSpec quiet() {
    RawSpec raw;
    raw.bands = 1;
    raw.phase_noise_m = 0.0012;
    raw.clock_drift = 3e-7;
    return raw;
}

TEST(PhaseWitness, GivesTheTrueDisplacementWithinItsCovariance) {
    const RawRun run(40.0, quiet(), 0.010);
    const auto witness = run.witness();
    double statistics = 0.0;
    int count = 0;
    for (double from_s = 1.0; from_s < 36.0; from_s += 0.5) {
        const auto moved = witness->between(from_s, from_s + 3.0);
        ASSERT_TRUE(moved) << from_s;
        EXPECT_GE(moved->satellites, 9);
        const Eigen::Vector2d error =
            moved->displacement_m - (run.true_m(from_s + 3.0) - run.true_m(from_s));
        EXPECT_LT(error.norm(), 0.02) << from_s;
        statistics += error.dot(moved->covariance_m2.inverse() * error);
        ++count;
        // Straight on, the path is as long; each step's noise across adds a little.
        EXPECT_NEAR(witness->path_between(from_s, from_s + 3.0).value(),
                    moved->displacement_m.norm(), 0.003);
    }
    // Two degrees of freedom each; the systematic rates that it allows for are not simulated.
    EXPECT_LT(statistics / count, 2.5);
    EXPECT_GT(statistics / count, 0.1);
    EXPECT_FALSE(witness->between(-1.0, 2.0));
    EXPECT_FALSE(witness->between(38.0, 41.0));
}

TEST(PhaseWitness, AnswersBetweenItsEpochs) {
    const RawRun run(20.0, quiet(), 0.010);
    const auto witness = run.witness();
    for (const double late_s : {0.01, 0.03, 0.05}) {
        const auto moved = witness->between(5.0 + late_s, 8.0 + late_s);
        ASSERT_TRUE(moved);
        const double true_m = logistic_run(run.spec.run, 8.0 + late_s).distance_m -
                              logistic_run(run.spec.run, 5.0 + late_s).distance_m;
        EXPECT_NEAR(moved->displacement_m.norm(), true_m, 0.01);
        EXPECT_GT(moved->covariance_m2(0, 0), witness->between(5.0, 8.0)->covariance_m2(0, 0));
    }
}

TEST(PhaseWitness, TurnsIntoTheFrameOfThePositions) {
    RawRun run(20.0, quiet(), 0.010);
    const auto own = run.witness()->between(5.0, 8.0);
    // A tangent plane that touches the Earth 100 km to the east: north is another direction there.
    const FrameOrigin near = *run.table.origin;
    run.table.origin->position.longitude = Angle::from_degrees(137.05);
    const auto turned = run.witness()->between(5.0, 8.0);
    ASSERT_TRUE(own && turned);
    const auto enu = [](const FrameOrigin& origin) {
        return rotation_enu_from_ecef(origin.position.latitude, origin.position.longitude);
    };
    const Eigen::Matrix3d turn = enu(*run.table.origin) * enu(near).transpose();
    const Eigen::Vector3d level(own->displacement_m.x(), own->displacement_m.y(), 0.0);
    EXPECT_LT((turned->displacement_m - (turn * level).head<2>()).norm(), 0.003);
    EXPECT_GT((turned->displacement_m - own->displacement_m).norm(), 1.0);
}

// 2e-4 s in 3 s are 6.7e-5 of the speed, and the test of the clock lets them pass.
TEST(PhaseWitness, TheRateOfTheReceiversClockIsTakenOut) {
    RawSpec raw = quiet();
    raw.clock_drift = 6e-5;
    const RawRun run(40.0, raw, 0.010);
    const auto witness = run.witness();
    double along_m = 0.0, path_m = 0.0;
    int count = 0;
    for (double from_s = 5.0; from_s < 36.0; from_s += 0.5) {
        const auto moved = witness->between(from_s, from_s + 3.0);
        ASSERT_TRUE(moved) << from_s;
        const double true_m = (run.true_m(from_s + 3.0) - run.true_m(from_s)).norm();
        along_m += moved->displacement_m.norm() - true_m;
        path_m += witness->path_between(from_s, from_s + 3.0).value() - true_m;
        ++count;
    }
    // Without the rate 11.6 mm are missing.
    EXPECT_NEAR(along_m / count, 0.0, 0.003);
    EXPECT_NEAR(path_m / count, 0.0, 0.003);
}

TEST(PhaseWitness, SaysNothingWhereTheClockJumpsOrTooFewAreLeft) {
    RawSpec raw = quiet();
    raw.clock_offset_s = 0.00049;
    raw.clock_drift = 1e-6;  // a jump at 10 s
    raw.clock_jumps = true;
    const RawRun jumps(20.0, raw, 0.010);
    EXPECT_TRUE(jumps.witness()->between(5.0, 8.0));
    EXPECT_FALSE(jumps.witness()->between(9.0, 12.0));
    RawSpec outages = quiet();
    // All but the last of GPS and of Galileo in turn, until too few are left.
    for (std::uint8_t number = 1; number <= 36; ++number)
        for (const SatelliteSystem system : {SatelliteSystem::gps, SatelliteSystem::galileo})
            if (number % 3 != 0)
                outages.outages.push_back(
                    {.from_s = 9.0, .to_s = 15.5, .satellite = {system, number}});
    const RawRun few(20.0, outages, 0.010);
    EXPECT_TRUE(few.witness()->between(5.0, 8.0));
    EXPECT_FALSE(few.witness()->between(8.0, 11.0));
}

TEST(PhaseWitness, CountsSlipsInsideAWindow) {
    RawSpec raw = quiet();
    raw.slips.push_back({.time_s = 10.0, .satellite = {SatelliteSystem::gps, 22}, .cycles = 3.0});
    const RawRun run(20.0, raw, 0.010);
    const auto witness = run.witness();
    EXPECT_EQ(witness->interruptions(8.0, 11.0).slips, 1);
    EXPECT_EQ(witness->interruptions(10.5, 13.5).slips, 0);
    EXPECT_EQ(witness->interruptions(8.0, 11.0).refusals, 0);
    const auto across = witness->between(8.0, 11.0), after = witness->between(11.0, 14.0);
    ASSERT_TRUE(across && after);
    EXPECT_EQ(across->satellites + 1, after->satellites);
}

// What 3-phase.ecsv holds is enough to be the same witness again.
TEST(PhaseWitness, IsTheSameFromTheScreenedTable) {
    RawSpec raw = quiet();
    raw.slips.push_back({.time_s = 10.0, .satellite = {SatelliteSystem::gps, 22}, .cycles = 3.0});
    const RawRun run(20.0, raw, 0.010);
    std::vector<ScreenedPhase> rows;
    give_screened_rows(run.screened, [&](const ScreenedPhase& row) { rows.push_back(row); });
    JudgedPhases again{.record = run.screened.phases->record, .screening = {}};
    PhaseScreeningBuilder builder(again.record, run.screened.head, 15.0);
    for (const ScreenedPhase& row : rows)
        builder.add(row);
    again.screening = std::move(builder).take();
    EXPECT_EQ(again.screening.slips.size(), run.screened.phases->screening.slips.size());
    const auto second =
        phase_witness<2>(std::make_shared<const JudgedPhases>(again), run.screened.head.first_epoch,
                         run.table.facts.first_epoch, run.table.origin, 0.6);
    const auto first = run.witness();
    for (const double from_s : {2.0, 8.0, 12.0}) {
        EXPECT_EQ(first->between(from_s, from_s + 3.0)->displacement_m,
                  second->between(from_s, from_s + 3.0)->displacement_m);
    }
    // Rows of another table are not taken for its own.
    PhaseScreeningBuilder other(again.record, run.screened.head, 15.0);
    EXPECT_THROW(other.add(rows[1]), Failure);
    PhaseScreeningBuilder cut(again.record, run.screened.head, 15.0);
    cut.add(rows[0]);
    EXPECT_THROW(std::move(cut).take(), Failure);
}

/// Whether the displacement of two ends of 10 mm contradicts the phases.
bool is_contradicted(const PhaseWitness<2>& witness, const Eigen::Vector2d& displacement_m,
                     double from_s, double to_s, double sigma_m) {
    PositionFigures<2> figures{.start_s = from_s, .end_s = to_s, .displacement_m = displacement_m};
    figures.speed.own_m_s = std::sqrt(2.0) * sigma_m / (to_s - from_s);
    return displacement_ratio<2>(witness.between(from_s, to_s).value(), figures) > 1.0;
}

// On positions of 10 mm, over 3 s.
TEST(PhaseWitness, FindsARampOf30MillimetresASecond) {
    constexpr double sigma_m = 0.010;
    int trials = 0, found = 0, false_alarms = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const RawRun run(60.0, quiet(), sigma_m, seed);
        const auto witness = run.witness();
        RandomGenerator random(seed);
        for (double from_s = 0.5; from_s < 56.0; from_s += 0.1) {
            const auto noise = [&] {
                return Eigen::Vector2d(sigma_m * random.normal(), sigma_m * random.normal());
            };
            const Eigen::Vector2d moved =
                run.true_m(from_s + 3.0) + noise() - run.true_m(from_s) - noise();
            const double azimuth = 2.0 * std::numbers::pi * random.uniform();
            const Eigen::Vector2d ramp =
                3.0 * 0.030 * Eigen::Vector2d(std::sin(azimuth), std::cos(azimuth));
            ++trials;
            found += is_contradicted(*witness, moved + ramp, from_s, from_s + 3.0, sigma_m);
            false_alarms += is_contradicted(*witness, moved, from_s, from_s + 3.0, sigma_m);
        }
    }
    const std::string what =
        fmt::format("{} windows: {} found, {} false", trials, found, false_alarms);
    if (std::getenv("RUNCERT_FIGURES")) fmt::print("{}\n", what);
    EXPECT_GE(found, 0.97 * trials) << what;
    EXPECT_LE(false_alarms, 0.003 * trials) << what;
}

/// A table of positions, with a ramp or an outlier in it, screened beside the phases.
ScreenedTable screened_beside(const RawRun& run, const EnuTable& table) {
    ScreenConfig config = screen_config(default_attempt());
    const auto witness = run.witness(config.jerk_density);
    return screen(table, config, {.phases = witness.get()});
}

TEST(PhaseCheck, MarksADriftAndSaysWhereTo) {
    const RawRun run(40.0, quiet(), 0.005);
    const ScreenedTable honest = screened_beside(run, run.table);
    ASSERT_EQ(honest.basis.displacements.size(), 1U);
    EXPECT_EQ(honest.basis.displacements[0].kind, WitnessKind::phases);
    EXPECT_EQ(honest.basis.displacements[0].rejected, 0);
    ASSERT_FALSE(honest.basis.displacements[0].spreads.empty());
    EXPECT_EQ(summarise(honest.rows).usable, 401);
    EXPECT_NEAR(honest.basis.displacements[0].spreads.front().sd_m, 0.0075, 0.003);

    EnuTable drifting = run.table;
    for (EnuEpoch& row : drifting.rows)
        *row.east_m += 0.1 * std::clamp(row.time.seconds() - 20.0, 0.0, 10.0);
    EXPECT_EQ(summarise(screen(drifting, screen_config(default_attempt())).rows).usable, 401);
    const ScreenedTable found = screened_beside(run, drifting);
    int marked_inside = 0;
    for (const ScreenedEpoch& row : found.rows) {
        const double time_s = row.time.seconds();
        if (row.reason != Reason::phase) continue;
        EXPECT_GT(time_s, 19.0);
        EXPECT_LT(time_s, 31.0);
        ++marked_inside;
        EXPECT_EQ(row.hypothesis, Hypothesis::phase);
        EXPECT_GT(*row.statistic, *row.threshold);
        EXPECT_GT(*row.estimated.east_m, 0.05);
        EXPECT_LT(std::abs(*row.estimated.north_m), 0.1);
    }
    EXPECT_GT(marked_inside, 80);
    EXPECT_EQ(found.basis.displacements[0].rejected, marked_inside);
}

TEST(PhaseCheck, MarksAnOutlierThatPositionsAloneKeep) {
    const RawRun run(40.0, quiet(), 0.005);
    EnuTable wrong = run.table;
    *wrong.rows[200].north_m += 0.09;
    const ScreenedTable found = screened_beside(run, wrong);
    EXPECT_FALSE(found.rows[200].usable);
    EXPECT_EQ(summarise(found.rows).usable, 400);
}

/// The best window of 3 s, of the positions alone or beside the phases.
CertifiableWindow best_of(const RawRun& run, const EnuTable& table, bool beside_phases) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    ScreenConfig screening = screen_config(default_attempt());
    const auto witness = run.witness(screening.jerk_density);
    const ScreenedTable screened =
        screen(table, screening, {.phases = beside_phases ? witness.get() : nullptr});
    const TrajectoryTable trajectory =
        smooth_trajectory(screened, smooth_config(default_attempt()));
    WindowConfig config = window_config(default_attempt(), default_attempt().receivers.front());
    config.monte_carlo_trials_max = 100'000;
    WitnessRecords beside;
    if (beside_phases) {
        beside.phases = run.screened.phases;
        beside.first_of_phases = run.screened.head.first_epoch;
    }
    const Windows windows =
        find_windows(screened, trajectory, {profile}, config, std::nullopt, beside);
    // Once an official has answered for the file of the phases.
    return (windows.with_files.empty() ? windows.profiles : windows.with_files)
        .front()
        .best.value();
}

double true_speed(const RawRun& run, const CertifiableWindow& window) {
    const auto at = [&](std::int64_t epoch) {
        return run.epochs[static_cast<std::size_t>(epoch) - 1].true_enu_m;
    };
    return (at(window.span.last_epoch) - at(window.span.first_epoch)).norm() /
           window.span.duration.seconds();
}

double row_of(const CertifiableWindow& window, std::string_view symbol) {
    const auto row = std::ranges::find(window.budget, symbol, &BudgetRow::symbol);
    return row == window.budget.end() ? -1.0 : row->contribution_m_s;
}

TEST(PhaseBudget, HoldsWhatThePhasesLeave) {
    const RawRun run(40.0, quiet(), 0.005);
    const CertifiableWindow alone = best_of(run, run.table, false);
    const CertifiableWindow beside = best_of(run, run.table, true);
    EXPECT_TRUE(alone.witnesses.empty());
    ASSERT_EQ(beside.witnesses.size(), 1U);
    const WitnessedSpeed& phases = beside.witnesses.front();
    EXPECT_EQ(phases.kind, WitnessKind::phases);
    EXPECT_GE(phases.satellites.value(), 9);
    EXPECT_LT(phases.normalised_error, 1.0);
    EXPECT_GT(phases.share, 0.9);
    EXPECT_LT(beside.standard_uncertainty_m_s, 0.5 * alone.standard_uncertainty_m_s);
    EXPECT_LE(std::abs(beside.speed_m_s - true_speed(run, beside)),
              2.0 * beside.standard_uncertainty_m_s + beside.bias_limit_m_s);
    // The rows of the witness, and of what it shares with the positions.
    EXPECT_NEAR(row_of(beside, "g"), phases.share * phases.standard_uncertainty_m_s, 1e-9);
    EXPECT_NEAR(row_of(beside, "e"),
                phases.share * std::abs(beside.evidence->witnesses[0].difference_m_s), 1e-5);
    EXPECT_NEAR(row_of(beside, "s"), std::sqrt(2.0) * 0.010 / 3.0, 1e-4);
    // Row d is that of the positions alone, as far as these count.
    EXPECT_NEAR(row_of(beside, "d"), (1.0 - phases.share) * row_of(alone, "d"), 1e-6);
    EXPECT_LT(phases.undetected_m_s, beside.reliability.front().speed_m_s);
    EXPECT_EQ(row_of(alone, "s"), -1.0);
}

// What is too slow for any test is in the interval: the difference from the phases is a row of it.
TEST(PhaseBudget, HoldsADriftThatIsNotFound) {
    int certified = 0;
    for (const double rate_m_s : {0.01, 0.02, 0.04, 0.08, 0.16}) {
        const RawRun run(40.0, quiet(), 0.005);
        EnuTable drifting = run.table;
        for (EnuEpoch& row : drifting.rows)
            *row.north_m += rate_m_s * std::max(0.0, row.time.seconds() - 20.0);
        const CertifiableWindow window = best_of(run, drifting, true);
        if (window.witnesses.empty() || contradicts(window.witnesses.front())) continue;
        ++certified;
        EXPECT_LE(std::abs(window.speed_m_s - true_speed(run, window)),
                  2.0 * window.standard_uncertainty_m_s + window.bias_limit_m_s)
            << rate_m_s;
    }
    EXPECT_GE(certified, 3);
}

// In its first minute the float solution slides by far more than the 10 mm that are taken here for
// its white noise; afterwards it does not.
TEST(RecordedPair, IsFlaggedInItsFirstMinute) {
    const auto rover = recorded("rinex_pair/yamatogawa_rover.obs");
    if (!rover) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string base = *recorded("rinex_pair/yamatogawa_master.obs");
    const std::string navigation = *recorded("rinex_pair/yamatogawa_rover.nav");
    Receiver receiver = pos_receiver();
    receiver.format = "rinex";
    receiver.solution_pass = "forward";
    const rinex::Solution solution = rinex::solve(receiver, {.name = "rover.obs", .bytes = *rover},
                                                  {.name = "base.obs", .bytes = base},
                                                  {{.name = "rover.nav", .bytes = navigation}});
    const EnuTable table =
        to_enu(rinex::read(receiver, solution, "forward.primary.pos"), std::nullopt);
    const Phases phases =
        recorded_phases("rinex_pair/yamatogawa_rover.obs", "rinex_pair/yamatogawa_rover.nav");
    const ScreenedPhases screened = screen_receiver_phases(phases.head, phases.record, table, {});
    const auto witness =
        std::make_shared<const PhaseWitness<2>>(screened.witness<2>(table, 1.0).value());

    ScreenConfig config = screen_config(default_attempt());
    config.counted_fixes = {FixType::fixed, FixType::float_ambiguities};
    const ScreenedTable positions = screen(table, config);
    const std::vector<TimedPosition<2>> usable = timed_positions<2>(positions.rows);
    int early = 0, early_flagged = 0, late = 0, late_flagged = 0;
    for (std::size_t k = 0; k + 3 < usable.size(); ++k) {
        const TimedPosition<2>&from = usable[k], &to = usable[k + 3];
        if (std::abs(to.time_s - from.time_s - 3.0) > 0.1 ||
            !witness->between(from.time_s, to.time_s))
            continue;
        PositionFigures<2> figures{.start_s = from.time_s,
                                   .end_s = to.time_s,
                                   .displacement_m = to.position - from.position};
        figures.speed.speed_m_s = figures.displacement_m.norm() / (to.time_s - from.time_s);
        figures.speed.own_m_s = std::sqrt(2.0) * 0.010 / (to.time_s - from.time_s);
        const AssessedWitness<2> heard{
            .kind = WitnessKind::phases, .receiver = {}, .motion = witness};
        const bool flagged = witnessed_speed<2>(heard, figures)->normalised_error > 1.0;
        (from.time_s < 60.0 ? early : late) += 1;
        (from.time_s < 60.0 ? early_flagged : late_flagged) += flagged ? 1 : 0;
    }
    const std::string what = fmt::format("first minute {} of {}, after {} of {}", early_flagged,
                                         early, late_flagged, late);
    if (std::getenv("RUNCERT_FIGURES")) fmt::print("{}\n", what);
    EXPECT_GE(early, 30) << what;
    EXPECT_GE(early_flagged, 0.8 * early) << what;
    EXPECT_LE(late_flagged, 0.1 * late) << what;
    // Screening allows for what the positions state of themselves, and leaves none out later.
    const ScreenedTable beside = screen(table, config, {.phases = witness.get()});
    int early_left_out = 0, late_left_out = 0;
    for (const ScreenedEpoch& row : beside.rows)
        if (row.reason == Reason::phase)
            (row.time.seconds() < 60.0 ? early_left_out : late_left_out) += 1;
    EXPECT_GE(early_left_out, 10);
    EXPECT_EQ(late_left_out, 0);
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test

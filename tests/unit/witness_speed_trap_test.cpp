#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "witness/recorded_velocities.h"
#include "witness/roster.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;

/// Towards east, from 20 m/s on ever faster; with 10 mm of white noise at 10 Hz.
double way_at(double time_s) {
    return 20.0 * time_s + 0.25 * time_s * time_s;
}
double speed_at(double time_s) {
    return 20.0 + 0.5 * time_s;
}

struct Recorded {
    std::vector<TimedPosition<2>> positions;
    Track track;

    Recorded() {
        RandomGenerator random(3);
        track.nominal_interval_s = 0.1;
        for (int k = 0; k <= 600; ++k) {
            const double time_s = 0.1 * k;
            TimedPosition<2>& measured = positions.emplace_back();
            measured.time_s = time_s;
            measured.position = {way_at(time_s) + 0.01 * random.normal(), 0.01 * random.normal()};
            TrackEpoch& epoch = track.epochs.emplace_back();
            epoch.time_s = time_s;
            epoch.usable = true;
            epoch.position_m = {way_at(time_s), 0.0, 0.0};
            epoch.velocity_m_s = {speed_at(time_s), 0.0, 0.0};
            epoch.acceleration_m_s2 = {0.5, 0.0, 0.0};
        }
    }

    std::optional<AssessedWitness<2>> heard(std::vector<SeriesSample> samples) const {
        HandedIn given;
        given.series["speed_trap"].samples = std::move(samples);
        return handed_in_witness(witness_entry(WitnessKind::speed_trap), given, positions, track,
                                 0.6);
    }
};

/// Measured over this length about a time, wrong by this; uncertain by 0.4 m/s (k = 2).
SeriesSample measured(double time_s, double length_m, double error_m_s) {
    return {.time_s = time_s,
            .value = speed_at(time_s) + error_m_s,
            .expanded_uncertainty_m_s = 0.4,
            .length_m = length_m};
}

TEST(SpeedTrap, TellsTheWayOverItsStretch) {
    const auto trap = Recorded().heard({measured(20.0, 90.0, 0.1)});
    ASSERT_TRUE(trap);
    EXPECT_FALSE(trap->is_copy);
    const double half_s = 45.0 / 30.1;
    const auto moved = trap->motion->between(20.0 - half_s, 20.0 + half_s);
    ASSERT_TRUE(moved);
    EXPECT_NEAR(moved->displacement_m.x(), 90.0, 1e-9);
    // By its speed's uncertainty over its time.
    EXPECT_NEAR(std::sqrt(moved->covariance_m2(0, 0)), 0.2 * 2.0 * half_s, 1e-6);
    EXPECT_GT(moved->covariance_m2(1, 1), 1e3);
    EXPECT_NEAR(trap->motion->path_between(20.0 - half_s, 20.0 + half_s).value(), 90.0, 1e-9);
    // A window that begins a fifth of a second earlier: by the speed there, and less sure.
    const auto earlier = trap->motion->between(20.0 - half_s - 0.2, 20.0 + half_s);
    ASSERT_TRUE(earlier);
    EXPECT_NEAR(earlier->displacement_m.x(),
                90.0 + way_at(20.0 - half_s) - way_at(20.0 - half_s - 0.2), 1e-6);
    EXPECT_GT(earlier->covariance_m2(0, 0), moved->covariance_m2(0, 0));
    EXPECT_FALSE(trap->motion->between(18.0, 20.0 + half_s));
    EXPECT_FALSE(trap->motion->between(19.0, 20.0));
}

// A gun's error lasts while it aims at the same craft: measuring more often makes it no smaller.
TEST(SpeedTrap, ARadarGunsSpeedsAddUpToAWay) {
    std::vector<SeriesSample> speeds;
    RandomGenerator random(8);
    for (int k = 0; k <= 100; ++k)
        speeds.push_back(measured(20.0 + 0.1 * k, 0.0, 0.1 + 0.02 * random.normal()));
    const auto gun = Recorded().heard(speeds);
    ASSERT_TRUE(gun);
    EXPECT_FALSE(gun->is_copy);
    const auto moved = gun->motion->between(22.0, 25.0);
    ASSERT_TRUE(moved);
    EXPECT_NEAR(moved->displacement_m.x(), way_at(25.0) - way_at(22.0) + 0.3, 0.03);
    EXPECT_NEAR(std::sqrt(moved->covariance_m2(0, 0)), 0.2 * 3.0, 1e-3);
    EXPECT_EQ(gun->motion->covered().first_s, 20.0);
    EXPECT_FALSE(gun->motion->between(28.0, 31.0));
}

TEST(SpeedTrap, NothingIsKnownAcrossABreak) {
    const auto two = Recorded().heard({measured(20.0, 60.0, 0.0), measured(30.0, 60.0, 0.0)});
    ASSERT_TRUE(two);
    EXPECT_TRUE(two->motion->between(19.0, 21.0));
    EXPECT_FALSE(two->motion->between(19.0, 29.1));
    // Of another time, or of a craft that stands.
    EXPECT_FALSE(Recorded().heard({measured(500.0, 60.0, 0.0)}));
    SeriesSample standing = measured(20.0, 60.0, 0.0);
    standing.value = 0.0;
    EXPECT_FALSE(Recorded().heard({standing}));
}

TEST(SpeedTrap, SpeedsMadeFromThePositionsAreNotHeard) {
    const Recorded run;
    const auto made_of_steps = [&](std::size_t step) {
        std::vector<SeriesSample> speeds;
        for (std::size_t k = 100; k + step < 400; k += step) {
            const TimedPosition<2>&from = run.positions[k], &to = run.positions[k + step];
            const double length_m = (to.position - from.position).norm();
            const double duration_s = to.time_s - from.time_s;
            speeds.push_back({.time_s = from.time_s + 0.5 * duration_s,
                              .value = length_m / duration_s,
                              .expanded_uncertainty_m_s = 0.4,
                              .length_m = length_m});
        }
        return speeds;
    };
    for (const std::size_t step : {1U, 5U, 30U}) {
        const auto made = run.heard(made_of_steps(step));
        ASSERT_TRUE(made);
        EXPECT_TRUE(made->is_copy) << step;
        EXPECT_NE(made->note.find("they were made from them"), std::string::npos) << made->note;
    }
}

// A kind that nobody can make, or that no key hands in, would be heard by nobody.
TEST(WitnessRoster, EveryKindThatIsHandedInHasItsSeries) {
    for (const WitnessEntry& entry : witness_roster()) {
        const FieldRule* const field = attempt_schema().find(std::string(to_text(entry.kind)));
        EXPECT_FALSE(entry.silent.empty());
        // An IMU stands beside a receiver, and is solved with its positions.
        if (entry.kind == WitnessKind::imu) {
            EXPECT_TRUE(attempt_schema().is_read_by("receivers[].imu.file", "window"));
            EXPECT_EQ(entry.make, nullptr);
            continue;
        }
        const bool is_handed_in = origin_of(entry.kind).front() == "handed_in";
        EXPECT_EQ(entry.make != nullptr, is_handed_in) << to_text(entry.kind);
        ASSERT_EQ(field != nullptr, is_handed_in) << to_text(entry.kind);
        if (field == nullptr) continue;
        EXPECT_FALSE(field->series.empty()) << field->path;
        EXPECT_TRUE(attempt_schema().is_read_by(field->path, "window")) << field->path;
        EXPECT_EQ(attempt_schema().is_read_by(field->path, "screen"), entry.screening.has_value())
            << field->path;
    }
}

// And a series is a witness's, or tells the flow that a rule bounds.
TEST(WitnessRoster, EverySeriesIsReadBySomething) {
    for (const FieldRule& field : attempt_schema().fields()) {
        if (field.series.empty()) continue;
        WitnessKind kind{};
        const bool witnesses = from_text(field.path, kind);
        const bool is_flow = std::ranges::find(field.series, "direction") != field.series.end();
        EXPECT_TRUE(witnesses || is_flow) << field.path;
        // Each quantity is known: a header alone has no sample.
        EXPECT_THROW((void)read_series("time_s\n", "s", GpsTime{}, field.series), Failure);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

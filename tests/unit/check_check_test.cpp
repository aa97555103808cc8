#include "stages/check/check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "core/uncertainty.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double kmh = 1.0 / 3.6;

Profile builtin(const char* name) {
    return read_profile(builtin_profile(name), name);
}

TEST(CoverageFactor, IsStudentsForFewDegreesOfFreedom) {
    EXPECT_EQ(equivalent_coverage_factor(2.0, std::nullopt), 2.0);
    // [GUM] table G.2: for k = 2 (95.45 %) 4.53 with 2 degrees of freedom, 2.87 with 4, 2.28 with
    // 10, 2.13 with 20, 2.05 with 50; for k = 3 (99.73 %) 3.96 with 10.
    for (const auto& [degrees, factor] :
         {std::pair{2.0, 4.53}, {4.0, 2.87}, {10.0, 2.28}, {20.0, 2.13}, {50.0, 2.05}})
        EXPECT_NEAR(equivalent_coverage_factor(2.0, degrees), factor, 0.00501) << degrees;
    EXPECT_NEAR(equivalent_coverage_factor(3.0, 10.0), 3.96, 0.00501);
    EXPECT_NEAR(equivalent_coverage_factor(2.0, 1e9), 2.0, 1e-6);
}

/// An attempt under nalsa with a window of given speed and uncertainty.
struct Scene {
    Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n"
        "record: {speed: 202.9, unit: km/h, source: published}\n",
        "attempt");
    std::vector<Profile> profiles{builtin("nalsa")};
    ReceiverFindings judged;
    ReceiverFindings secondary;

    Scene(double speed_m_s, double standard_uncertainty_m_s) {
        judged.receiver = "primary";
        judged.accuracy_source = "recording";
        set_window(judged, speed_m_s, standard_uncertainty_m_s);
        secondary.receiver = "secondary";
    }
    void set_window(ReceiverFindings& receiver, double speed_m_s, double uncertainty) const {
        ProfileWindows entry{
            .profile = "nalsa",
            .rule = {.duration_s = 3.0, .definition = SpeedDefinition::displacement},
            .candidates = 5,
            .best = CertifiableWindow{},
            .indicated = std::nullopt};
        entry.best->speed_m_s = speed_m_s;
        entry.best->standard_uncertainty_m_s = uncertainty;
        entry.best->span.duration.nanoseconds = 3'000'000'000;
        receiver.windows.profiles = {entry};
    }
    ProfileVerdict verdict(bool with_secondary = false) const {
        return check({.attempt = attempt,
                      .profiles = profiles,
                      .judged = judged,
                      .secondary = with_secondary ? &secondary : nullptr})
            .profiles.at(0);
    }
};

RequirementStatus status_of(const ProfileVerdict& verdict, const std::string& clause) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == clause) return requirement.status;
    throw std::runtime_error("no clause " + clause);
}

TEST(Check, ARecordBeaten) {
    const ProfileVerdict verdict = Scene(60.0, 0.005).verdict();
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    EXPECT_EQ(status_of(verdict, "average-over-3-s"), RequirementStatus::met);
    EXPECT_EQ(status_of(verdict, "accuracy"), RequirementStatus::met);
    EXPECT_EQ(status_of(verdict, "margin"), RequirementStatus::met);
    EXPECT_EQ(status_of(verdict, "positions-on-the-earth"), RequirementStatus::met);
    EXPECT_EQ(status_of(verdict, "secondary-method"), RequirementStatus::attest);
    EXPECT_EQ(status_of(verdict, "own-start"), RequirementStatus::attest);
    EXPECT_NEAR(*verdict.expanded_uncertainty_m_s, 0.010, 1e-12);
}

TEST(Check, FewDegreesOfFreedomWidenTheExpandedUncertainty) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best->effective_degrees_of_freedom = 4.0;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(verdict.coverage_factor, 2.87, 0.005);  // [GUM] table G.2
    EXPECT_NEAR(*verdict.expanded_uncertainty_m_s, verdict.coverage_factor * 0.005, 1e-15);
    // 0.2222 m/s over 2.87 is 0.0774: within the limit for many degrees of freedom, not for four.
    scene.judged.windows.profiles[0].best->standard_uncertainty_m_s = 0.08;
    EXPECT_EQ(status_of(scene.verdict(), "accuracy"), RequirementStatus::not_met);
    scene.judged.windows.profiles[0].best->effective_degrees_of_freedom.reset();
    EXPECT_EQ(status_of(scene.verdict(), "accuracy"), RequirementStatus::met);
}

TEST(Check, TheAccuracySaysWhatOfItTheChoiceOfTheWindowMayHaveLeft) {
    Scene scene(60.0, 0.08);  // 0.576 km/h expanded, of 0.8
    const auto accuracy = [&] {
        for (const Requirement& requirement : scene.verdict().requirements)
            if (requirement.clause == "accuracy") return requirement;
        return Requirement{};
    };
    EXPECT_TRUE(
        accuracy().evidence.starts_with("expanded uncertainty 0.58 km/h (k = 2), limit 0.8 km/h;"))
        << accuracy().evidence;
    scene.judged.windows.profiles[0].best->bias_limit_m_s = 0.1;
    EXPECT_EQ(accuracy().status, RequirementStatus::not_met);
    EXPECT_TRUE(accuracy().evidence.starts_with(
        "expanded uncertainty 0.94 km/h (k = 2, with 0.36 km/h for the choice of the window), "
        "limit 0.8 km/h"))
        << accuracy().evidence;
}

TEST(Check, ARobustEstimateThatDisagreesIsNotCertifiable) {
    Scene scene(60.0, 0.005);
    RobustSpeed robust{.speed_m_s = 60.1,
                       .difference_m_s = 0.1,
                       .limit_m_s = 0.012,
                       .agrees = false,
                       .downweighted = 3};
    scene.judged.windows.profiles[0].best->robust = robust;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    for (const char* part : {"robust", "+0.360 km/h", "0.043 km/h", "screening"})
        EXPECT_NE(verdict.reason.find(part), std::string::npos) << verdict.reason;
    robust.agrees = true;
    scene.judged.windows.profiles[0].best->robust = robust;
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    scene.judged.windows.profiles[0].best->robust.reset();
    scene.judged.estimation.robust_unsolved = 1;
    const ProfileVerdict unsolved = scene.verdict();
    EXPECT_EQ(unsolved.outcome, Outcome::not_certifiable);
    EXPECT_NE(unsolved.reason.find("did not converge"), std::string::npos);
}

WitnessedSpeed velocities_say(double difference_m_s, double normalised_error) {
    WitnessedSpeed witnessed;
    witnessed.speed_m_s = 60.0 - difference_m_s;
    witnessed.standard_uncertainty_m_s = 0.05;
    witnessed.difference_m_s = difference_m_s;
    witnessed.normalised_error = normalised_error;
    return witnessed;
}

TEST(Check, AWitnessThatAgreesStandsBesideTheSpeed) {
    Scene scene(60.0, 0.005);
    EXPECT_EQ(scene.verdict().reason.rfind("By positions alone", 0), 0U);
    scene.judged.windows.profiles[0].best->witnesses = {velocities_say(0.02, 0.2)};
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    ASSERT_EQ(verdict.witnesses.size(), 1U);
    EXPECT_EQ(verdict.witnesses.front(),
              "the recorded velocities give 215.92 km/h ± 0.36 km/h over the window, -0.072 km/h "
              "against the positions (normalised error 0.20, at most 1)");
    EXPECT_EQ(verdict.reason.find("By positions alone"), std::string::npos);
}

TEST(Check, AWitnessThatContradictsIsNotCertifiable) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best->witnesses = {velocities_say(0.5, 1.43)};
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    for (const char* part : {"recorded velocities", "-1.800 km/h", "1.43", "one of the two"})
        EXPECT_NE(verdict.reason.find(part), std::string::npos) << verdict.reason;
    EXPECT_TRUE(verdict.witnesses.empty());
}

// The best proof is below what is required; a faster window that proves less may reach it.
TEST(Check, NothingIsSaidNotToBeBeatenThatMayBe) {
    Scene scene(50.0, 0.005);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    FurtherWindow fastest;
    fastest.speed_m_s = 53.0;
    fastest.standard_uncertainty_m_s = 0.5;
    scene.judged.windows.profiles[0].fastest = fastest;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    scene.judged.windows.profiles[0].fastest->standard_uncertainty_m_s = 5.0;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_proven);
    EXPECT_NE(verdict.reason.find("may reach it"), std::string::npos) << verdict.reason;
    EXPECT_TRUE(std::ranges::any_of(verdict.notes, [](const std::string& note) {
        return note.starts_with("Another window is faster and proves less: 190 km/h");
    }));
}

TEST(Check, ADecisionThatTookTooMuchIsTheReason) {
    Scene scene(60.0, 0.005);
    LargestDecision largest;
    largest.hypothesis = Hypothesis::ramp;
    largest.first_epoch = 9001;
    largest.time_s = 900.0;
    largest.epochs = 9000;
    largest.share = 0.5;
    largest.statistic = 47.2;
    largest.threshold = 42.8;
    scene.judged.tests.largest_decision = largest;
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    scene.judged.tests.largest_decision->share = 0.7;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    for (const char* part :
         {"70 %", "50 %", "screen.decision_share_max", "drift", "epoch 9001", "47.2", "42.8"})
        EXPECT_NE(verdict.reason.find(part), std::string::npos) << verdict.reason;
}

TEST(Check, OfARecordingThatIsNotUsableTheThreeCommonestReasonsAreSaid) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best.reset();
    scene.judged.screening = {};
    std::int64_t epoch = 0;
    const auto add = [&](Reason reason, int count) {
        for (int i = 0; i < count; ++i) {
            ScreenedEpoch row;
            row.epoch = ++epoch;
            row.time.nanoseconds = epoch * 1'000'000'000;
            row.reason = reason;
            scene.judged.screening.add(row);
        }
    };
    add(Reason::no_fix, 3);
    add(Reason::accuracy_missing, 20);
    add(Reason::duplicate_time, 1);
    add(Reason::other_fix, 7);
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_NE(verdict.reason.find(
                  "none of the 31 epochs is usable: 20 accuracy not stated (first epoch 4, 4.0 s "
                  "after the first epoch; state it in the attempt, accuracy: {horizontal_m: ..., "
                  "vertical_m: ...}), "
                  "7 fix type not allowed (first epoch 25, 25.0 s after the first epoch; "
                  "screen.allowed_fixes decides which fix types may be used), 3 no solution (first "
                  "epoch 1, 1.0 s after the first epoch), and other reasons"),
              std::string::npos)
        << verdict.reason;
}

TEST(Check, EveryWindowOfAMeanIsRefusedForWhatTheBestIs) {
    const auto mean_of_two = [] {
        Scene scene(60.0, 0.005);
        scene.profiles[0].windows = 2;
        ProfileWindows& windows = scene.judged.windows.profiles[0];
        windows.rule.count = 2;
        windows.best->span.first_epoch = 101;
        windows.best->span.last_epoch = 131;
        windows.further = {{.span = windows.best->span,
                            .arc = 1,
                            .speed_m_s = 59.0,
                            .standard_uncertainty_m_s = 0.005}};
        windows.further[0].span.first_epoch = 201;
        windows.further[0].span.last_epoch = 231;
        scene.judged.records = {.total = 1000, .bad = 1, .bad_records = {}};
        scene.judged.records.bad_records.emplace_back();
        return scene;
    };
    Scene scene = mean_of_two();
    scene.judged.records.bad_records[0].epoch = 150;
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten) << scene.verdict().reason;
    EXPECT_NEAR(*scene.verdict().speed_m_s, 59.5, 1e-12);
    scene.judged.records.bad_records[0].epoch = 210;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    EXPECT_NE(scene.verdict().reason.find("could not be read"), std::string::npos);
    scene = mean_of_two();
    scene.judged.windows.profiles[0].further[0].robust = RobustSpeed{.speed_m_s = 59.1,
                                                                     .difference_m_s = 0.1,
                                                                     .limit_m_s = 0.012,
                                                                     .agrees = false,
                                                                     .downweighted = 3};
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    EXPECT_NE(scene.verdict().reason.find("robust"), std::string::npos);
}

TEST(Check, TheStatementsStandInTheVerdict) {
    const Scene scene(60.0, 0.005);
    const Verdict verdict =
        check({.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged});
    ASSERT_GE(verdict.statements.size(), 2U);
    EXPECT_NE(verdict.statements.front().find("budget"), std::string::npos);
}

TEST(Check, AnAccuracyBeyondTheLimitIsNotCertifiable) {
    // 0.8 km/h is 0.2222 m/s: twice 0.112 m/s is beyond, twice 0.111 m/s is within.
    EXPECT_EQ(Scene(60.0, 0.112).verdict().outcome, Outcome::not_certifiable);
    EXPECT_EQ(status_of(Scene(60.0, 0.112).verdict(), "accuracy"), RequirementStatus::not_met);
    EXPECT_EQ(Scene(60.0, 0.111).verdict().outcome, Outcome::beaten);
}

TEST(Check, NotBeatenAndNotProven) {
    const double required_speed = 202.9 * kmh + 1609.344 / 3600.0;
    // Phi(-2) = 0.0228 is at most 0.025, Phi(-1.9) = 0.0287 is not; Phi(1.9), Phi(2) likewise.
    EXPECT_EQ(Scene(required_speed - 0.010, 0.005).verdict().outcome, Outcome::not_beaten);
    EXPECT_EQ(Scene(required_speed - 0.0095, 0.005).verdict().outcome, Outcome::not_proven);
    EXPECT_EQ(Scene(required_speed - 0.001, 0.005).verdict().outcome, Outcome::not_proven);
    EXPECT_EQ(Scene(required_speed + 0.005, 0.005).verdict().outcome, Outcome::not_proven);
    EXPECT_EQ(Scene(required_speed + 0.0095, 0.005).verdict().outcome, Outcome::not_proven);
    EXPECT_EQ(Scene(required_speed + 0.010, 0.005).verdict().outcome, Outcome::beaten);
    EXPECT_EQ(status_of(Scene(required_speed + 0.005, 0.005).verdict(), "margin"),
              RequirementStatus::not_met);
    EXPECT_EQ(Scene(required_speed + 0.011, 0.005).verdict().outcome, Outcome::beaten);
}

TEST(Check, WithoutARecordNothingIsBeaten) {
    Scene scene(60.0, 0.005);
    scene.attempt.record.reset();
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
}

TEST(Check, WithoutAWindowNothingIsCertifiable) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best.reset();
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(verdict.speed_m_s.has_value());
    EXPECT_EQ(status_of(verdict, "average-over-3-s"), RequirementStatus::not_met);
}

TEST(Check, LocalPlaneCoordinatesAreForAPersonToAnswerFor) {
    Scene scene(60.0, 0.005);
    scene.judged.facts.georeferenced = false;
    EXPECT_EQ(status_of(scene.verdict(), "positions-on-the-earth"), RequirementStatus::attest);
    const Verdict verdict =
        check({.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged});
    EXPECT_FALSE(verdict.georeferenced);
}

/// Where a craft on a circle is, and where an antenna on it.
struct Circle {
    double speed_m_s = 60.0;
    double radius_m = 1e6;
    double ahead_m = 0.0;
    double right_m = 0.0;

    TrajectoryEpoch at(double t) const {
        const double rate = speed_m_s / radius_m;
        const double s = std::sin(rate * t), c = std::cos(rate * t);
        // The antenna goes on a circle of its own, as fast as the craft turns.
        const double across = radius_m - right_m;
        TrajectoryEpoch row;
        row.east_m = radius_m - across * c + ahead_m * s;
        row.north_m = across * s + ahead_m * c;
        row.velocity_east_m_s = rate * (across * s + ahead_m * c);
        row.velocity_north_m_s = rate * (across * c - ahead_m * s);
        row.acceleration_east_m_s2 = rate * rate * (across * c - ahead_m * s);
        row.acceleration_north_m_s2 = rate * rate * (-across * s - ahead_m * c);
        row.speed_m_s = std::hypot(*row.velocity_east_m_s, *row.velocity_north_m_s);
        row.sigma_east_m = row.sigma_north_m = 0.005;
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 0.1;
        row.usable = true;
        row.arc = 1;
        return row;
    }
};

/// The best window from 5 s to 8 s of the primary receiver's 10 s, and a secondary beside it.
struct TwoReceivers : Scene {
    Circle first, second;

    TwoReceivers() : Scene(60.0, 0.005) {
        set_window(secondary, 75.0, 0.005);  // its own best window is another
    }

    /// `later_s` is when the second recording begins, `interval_ms` its interval.
    void record(double later_s = 0.0, std::int64_t interval_ms = 100) {
        const GpsTime start = GpsTime::from_week(2200, 100'000'000'000'000);
        fill(judged, first, start, 0.0, 100);
        fill(secondary, second, start, later_s, interval_ms);
        CertifiableWindow& best = *judged.windows.profiles[0].best;
        const TrajectoryEpoch &from = judged.trajectory[50], &to = judged.trajectory[80];
        best.span.first_epoch = from.epoch;
        best.span.last_epoch = to.epoch;
        best.span.start = from.time;
        best.definitions.displacement_m_s =
            std::hypot(*to.east_m - *from.east_m, *to.north_m - *from.north_m) / 3.0;
        best.speed_m_s = best.definitions.displacement_m_s;
    }
    ProfileVerdict both() const { return verdict(true); }

  private:
    static void fill(ReceiverFindings& receiver, const Circle& course, GpsTime start,
                     double later_s, std::int64_t interval_ms) {
        receiver.facts.first_epoch =
            start.plus_nanoseconds(static_cast<std::int64_t>(later_s * 1e9));
        receiver.trajectory.clear();
        for (std::int64_t ms = 0; ms <= 10'000; ms += interval_ms) {
            TrajectoryEpoch row = course.at(later_s + 1e-3 * static_cast<double>(ms));
            row.epoch = std::ssize(receiver.trajectory) + 1;
            row.time = {ms * 1'000'000};
            receiver.trajectory.push_back(row);
        }
    }
};

std::string evidence_of(const ProfileVerdict& verdict, const std::string& clause) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == clause) return requirement.evidence;
    throw std::runtime_error("no clause " + clause);
}

TEST(Agreement, OfTheSpeedsOverThePrimarysWindow) {
    TwoReceivers scene;
    scene.second.speed_m_s = 60.013;  // E_n = 0.013 / 0.01414 = 0.92
    scene.record();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
    EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("error 0.92"), std::string::npos)
        << evidence_of(scene.both(), "secondary-method");
    EXPECT_EQ(scene.both().outcome, Outcome::beaten);
    scene.second.speed_m_s = 60.015;  // 1.06
    scene.record();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
    EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
}

TEST(Agreement, ContradictionIsNotCertifiableUnderARuleThatDoesNotAskForAnotherMethod) {
    TwoReceivers scene;
    scene.second.speed_m_s = 60.03;
    scene.record();
    std::erase_if(scene.profiles[0].clauses, [](const Clause& clause) {
        return clause.decided_by == Computation::secondary_method;
    });
    EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    for (const char* part : {"\"secondary\"", "+0.108 km/h", "2.12", "one of the two"})
        EXPECT_NE(scene.both().reason.find(part), std::string::npos) << scene.both().reason;
    EXPECT_EQ(scene.verdict(false).outcome, Outcome::beaten);
}

TEST(Agreement, TimesAreMatchedWhateverTheRecordingsBeginWith) {
    for (const double later_s : {-1.7, 0.0, 1.9, 4.93}) {
        TwoReceivers scene;
        scene.second.speed_m_s = 60.010;
        scene.second.radius_m = scene.first.radius_m = 500.0;
        scene.record(later_s);
        EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met) << later_s;
        EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("+0.03"), std::string::npos)
            << evidence_of(scene.both(), "secondary-method");
    }
}

TEST(Agreement, BetweenEpochsPositionsAreInterpolated) {
    for (const std::int64_t interval_ms : {70, 250, 1000}) {
        TwoReceivers scene;
        scene.second.radius_m = scene.first.radius_m = 300.0;
        scene.record(0.031, interval_ms);
        const ProfileVerdict verdict = scene.both();
        EXPECT_NE(evidence_of(verdict, "secondary-method").find("normalised error 0.00"),
                  std::string::npos)
            << evidence_of(verdict, "secondary-method");
    }
}

TEST(Agreement, AntennasOnTheOuterAndTheInnerSideOfATurn) {
    // 0.6 rad over 3 s: the outer antenna is faster by 2 m * 0.2 rad/s, the estimate by far less.
    TwoReceivers scene;
    scene.first.radius_m = scene.second.radius_m = 300.0;
    scene.second.right_m = -2.0;
    scene.second.ahead_m = 1.0;
    scene.record();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met)
        << evidence_of(scene.both(), "secondary-method");
    EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("normalised error 0.0"),
              std::string::npos);
    // Without a common frame the antennas' places are not known.
    scene.secondary.origin = FrameOrigin{.position = {}, .source = "attempt"};
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
}

struct CoverageCase {
    const char* name;
    void (*damage)(TwoReceivers&);
    const char* said;
};

TEST(Agreement, WithoutUsableDataOverThatTimeIsNotMet) {
    const CoverageCase cases[] = {
        {"unusable epoch", [](TwoReceivers& s) { s.secondary.trajectory[60].usable = false; },
         "unusable"},
        {"break",
         [](TwoReceivers& s) {
             for (std::size_t k = 70; k < 101; ++k)
                 s.secondary.trajectory[k].arc = 2;
         },
         "break"},
        {"bridged step", [](TwoReceivers& s) { s.secondary.bridged_epochs = {61}; }, "step"},
        {"ends before", [](TwoReceivers& s) { s.secondary.trajectory.resize(80); }, "no estimate"},
        {"begins after", [](TwoReceivers& s) { s.record(5.1); }, "no estimate"},
        {"relative times", [](TwoReceivers& s) { s.secondary.facts.first_epoch.reset(); },
         "start_gps"}};
    for (const CoverageCase& one : cases) {
        SCOPED_TRACE(one.name);
        TwoReceivers scene;
        scene.record();
        ASSERT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
        one.damage(scene);
        EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
        EXPECT_NE(evidence_of(scene.both(), "secondary-method").find(one.said), std::string::npos)
            << evidence_of(scene.both(), "secondary-method");
        EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    }
    // Outside of the window it does not matter.
    TwoReceivers scene;
    scene.record();
    scene.secondary.trajectory[49].usable = scene.secondary.trajectory[81].usable = false;
    scene.secondary.bridged_epochs = {51, 82};
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
}

TEST(Agreement, TheOthersUncertaintyIsTheLargerOfItsBudgetsAndItsEnds) {
    TwoReceivers scene;
    scene.second.speed_m_s = 60.03;
    scene.record();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
    // sqrt(2) 0.05 m / 3 s = 0.0236 m/s
    for (TrajectoryEpoch& row : scene.secondary.trajectory)
        row.sigma_east_m = row.sigma_north_m = 0.05;
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
    scene.record();
    scene.set_window(scene.secondary, 75.0, 0.02);
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
    scene.secondary.windows.profiles[0].best.reset();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
}

/// Both receivers within 0.167 km/h (k = 2), of which only 0.070 km/h is their own.
TwoReceivers that_share_most(double second_above_kmh) {
    TwoReceivers scene;
    scene.set_window(scene.judged, 60.0, 0.5 * 0.167 * kmh);
    scene.set_window(scene.secondary, 75.0, 0.5 * 0.167 * kmh);
    for (ReceiverFindings* one : {&scene.judged, &scene.secondary})
        one->windows.profiles[0].best->own_standard_uncertainty_m_s = 0.5 * 0.070 * kmh;
    scene.second.speed_m_s += second_above_kmh * kmh;
    scene.record();
    return scene;
}

TEST(Agreement, IsTestedWithWhatTheTwoDoNotShare) {
    // 0.23 / (sqrt(2) 0.070) = 2.32; with all of both, 0.23 / (sqrt(2) 0.167) = 0.97.
    TwoReceivers scene = that_share_most(0.23);
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
    EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("normalised error 2.32"),
              std::string::npos)
        << evidence_of(scene.both(), "secondary-method");
    EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    // Where windows do not say what they share.
    for (ReceiverFindings* one : {&scene.judged, &scene.secondary})
        one->windows.profiles[0].best->own_standard_uncertainty_m_s.reset();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
    EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("normalised error 0.97"),
              std::string::npos);
    // Without a window of its own the other counts as the judged one.
    scene = that_share_most(0.23);
    scene.secondary.windows.profiles[0].best.reset();
    EXPECT_NE(evidence_of(scene.both(), "secondary-method").find("normalised error 2.32"),
              std::string::npos);
}

TEST(Agreement, OfAnErrorThatBothShareSaysNothingAndWhatIsSharedIsListed) {
    TwoReceivers scene = that_share_most(0.0);
    scene.first.speed_m_s = scene.second.speed_m_s = 66.0;  // both by a tenth too fast
    scene.record();
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::met);
    const std::string evidence = evidence_of(scene.both(), "secondary-method");
    for (const char* part : {"normalised error 0.00",
                             "They share base station, satellites, atmosphere, frame and time"})
        EXPECT_NE(evidence.find(part), std::string::npos) << evidence;
}

TEST(Check, WindowsOfAnotherRuleAreRefused) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].rule.duration_s = 2.0;
    EXPECT_THROW(scene.verdict(), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

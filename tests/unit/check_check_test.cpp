#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "core/uncertainty.h"
#include "stages/check/requirements.h"

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
        ProfileWindows entry{.profile = "nalsa",
                             .rule = rule_of(profiles[0]),
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
    // Over the record that the attempt names.
    EXPECT_EQ(status_of(verdict, "margin"), RequirementStatus::attest);
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
              "the recorded velocities give 215.92 km/h ± 0.36 km/h over the window, -0.08 km/h "
              "against the 216.000 km/h of the positions (normalised error 0.20, at most 1)");
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
    scene.judged.windows.profiles[0].fastest->witnesses = {velocities_say(0.5, 1.43)};
    const ProfileVerdict contradicted = scene.verdict();
    EXPECT_EQ(contradicted.outcome, Outcome::not_proven);
    EXPECT_NE(contradicted.reason.find("which a witness contradicts, may reach it"),
              std::string::npos)
        << contradicted.reason;
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
    scene.judged.solution_source = SolutionSource::recording;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_NE(verdict.reason.find(
                  "none of the 31 epochs is usable: 20 accuracy not stated (first epoch 4, 4.0 s "
                  "after the first epoch; state it in the attempt, accuracy: {horizontal_m: ..., "
                  "vertical_m: ...}), "
                  "7 fix type not allowed (first epoch 25, 25.0 s after the first epoch; "
                  "to use other fix types, write parameters: {screen: {allowed_fixes: [fixed, "
                  "float, ...]}}), 3 no solution (first "
                  "epoch 1, 1.0 s after the first epoch), and other reasons"),
              std::string::npos)
        << verdict.reason;
    // Where nobody states them, what to write is the claim.
    scene.judged.solution_source = SolutionSource::unknown;
    EXPECT_NE(scene.verdict().reason.find(
                  "the recording states no fix type, which counts as single: if they are fixed "
                  "solutions, write solution: fixed in the receiver, a claim that somebody must "
                  "attest"),
              std::string::npos)
        << scene.verdict().reason;
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

/// A second receiver, of whose positions the window stage says so much over the window.
struct TwoReceivers : Scene {
    explicit TwoReceivers(double normalised_error) : Scene(60.0, 0.005) {
        for (ReceiverFindings* one : {&judged, &secondary})
            one->facts.first_epoch = GpsTime::from_week(2200, 100'000'000'000'000);
        WitnessedSpeed& by = judged.windows.profiles[0].best->witnesses.emplace_back();
        by.kind = WitnessKind::receiver;
        by.receiver = "secondary";
        by.speed_m_s = 60.03;
        by.standard_uncertainty_m_s = 0.01;
        by.difference_m_s = -0.03;
        by.normalised_error = normalised_error;
        by.apart_m = 0.09;
    }
    void silence() { judged.windows.profiles[0].best->witnesses.clear(); }
    ProfileVerdict both() const { return verdict(true); }
};

std::string evidence_of(const ProfileVerdict& verdict, const std::string& clause) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == clause) return requirement.evidence;
    throw std::runtime_error("no clause " + clause);
}

TEST(SecondReceiver, MeetsTheClauseWhereItAgreesAndSaysWhatTheTwoShare) {
    const TwoReceivers scene(0.92);
    const ProfileVerdict verdict = scene.both();
    EXPECT_EQ(status_of(verdict, "secondary-method"), RequirementStatus::met);
    for (const char* part : {"normalised error 0.92", "+0.108 km/h", "216.108 km/h",
                             "They share base station, satellites, atmosphere, frame and time"})
        EXPECT_NE(evidence_of(verdict, "secondary-method").find(part), std::string::npos)
            << evidence_of(verdict, "secondary-method");
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    ASSERT_EQ(verdict.witnesses.size(), 1U);
    EXPECT_NE(verdict.witnesses[0].find("the positions of receiver \"secondary\" give 216.1"),
              std::string::npos)
        << verdict.witnesses[0];
}

/// The same with what the attempt hands in: the second receiver's file.
struct UnansweredReceiver : TwoReceivers {
    explicit UnansweredReceiver(double normalised_error) : TwoReceivers(normalised_error) {
        attempt.inputs.push_back({.name = "receivers.secondary.recording",
                                  .profile = {},
                                  .origin = {.origin = "handed_in",
                                             .changes = {"speed"},
                                             .decides = {},
                                             .clause = "secondary-as-recorded"},
                                  .value = "b.pos"});
        ProfileWindows with = judged.windows.profiles[0];
        with.best->standard_uncertainty_m_s *= 0.8;
        judged.windows.with_files = {with};
        WitnessedSpeed& unanswered = judged.windows.profiles[0].best->witnesses.back();
        unanswered.unanswered = true;
        unanswered.confirms = false;
    }
    Verdict all() const {
        return check(
            {.attempt = attempt, .profiles = profiles, .judged = judged, .secondary = &secondary});
    }
};

TEST(SecondReceiver, MeetsNothingBeforeAnOfficialHasAnsweredForItsFile) {
    const Verdict verdict = UnansweredReceiver(0.92).all();
    const ProfileVerdict& before = verdict.profiles.at(0);
    EXPECT_EQ(status_of(before, "secondary-method"), RequirementStatus::attest);
    EXPECT_EQ(status_of(before, "secondary-as-recorded"), RequirementStatus::attest);
    EXPECT_TRUE(before.witnesses.empty());
    ASSERT_EQ(verdict.with_files.size(), 1U);
    const ProfileVerdict& after = verdict.with_files[0];
    EXPECT_EQ(status_of(after, "secondary-method"), RequirementStatus::met);
    EXPECT_EQ(after.witnesses.size(), 1U);
    EXPECT_LT(*after.expanded_uncertainty_m_s, *before.expanded_uncertainty_m_s);
    EXPECT_EQ(verdict.second_files, std::vector<std::string>{"secondary-as-recorded"});
    EXPECT_NE(before.second_files.find("can only contradict"), std::string::npos);
    EXPECT_NE(after.second_files.find("have answered"), std::string::npos);
}

TEST(SecondReceiver, ContradictsBeforeAnOfficialHasAnsweredForItsFile) {
    const Verdict verdict = UnansweredReceiver(1.06).all();
    EXPECT_EQ(verdict.profiles.at(0).outcome, Outcome::not_certifiable);
    EXPECT_EQ(status_of(verdict.profiles[0], "secondary-method"), RequirementStatus::not_met);
}

TEST(SecondReceiver, ThatContradictsIsNotCertifiableWhetherOrNotARuleAsksForIt) {
    TwoReceivers scene(1.06);
    EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
    EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    std::erase_if(scene.profiles[0].clauses, [](const Clause& clause) {
        return clause.decided_by == Computation::secondary_method;
    });
    EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    for (const char* part : {"\"secondary\"", "+0.108 km/h", "1.06", "one of the two"})
        EXPECT_NE(scene.both().reason.find(part), std::string::npos) << scene.both().reason;
}

TEST(SecondReceiver, ThatSaysNothingDoesNotMeetTheClause) {
    TwoReceivers scene(0.5);
    scene.silence();
    const auto says = [&](const char* why) {
        EXPECT_EQ(status_of(scene.both(), "secondary-method"), RequirementStatus::not_met);
        EXPECT_NE(evidence_of(scene.both(), "secondary-method").find(why), std::string::npos)
            << evidence_of(scene.both(), "secondary-method");
        EXPECT_EQ(scene.both().outcome, Outcome::not_certifiable);
    };
    says("no estimate over the whole of that time");
    scene.secondary.origin = FrameOrigin{.position = {}, .source = "attempt"};
    says("place on the Earth");
    scene.secondary.facts.first_epoch.reset();
    says("start_gps");
}

TEST(Check, WindowsOfAnotherRuleAreRefused) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].rule.duration_s = 2.0;
    EXPECT_THROW(scene.verdict(), Failure);
}

TEST(Check, WindowsOfTheRuleAsItWasBeforeAnyFigureOfItChangedAreRefused) {
    const auto rule = [](const std::string& window, const std::string& more) {
        return read_profile(
            fmt::format(
                "schema: profile/1.0\nid: rule\nbody: b\ntitle: t\nwindow: {{{}}}\n"
                "margin: {{kind: absolute, value: 0, unit: km/h}}\n{}clauses: "
                "[{{id: one, text: t, source: s, certainty: quoted, decided_by: attest}}]\n",
                window, more),
            "rule.yaml");
    };
    const std::string time = "duration_s: 3, definition: displacement";
    const auto part = [&](const std::string& figures) {
        return time + ", within: {from: {event: exit" + figures + "}]}";
    };
    const std::string part_of_it = part("}, to: [{event: below_start, height_m: 2256");
    const std::string alpha = "kind: alpha, distance_m: 250, definition: path_length";
    const std::string opposite = "opposite_runs: {within_s: 3600}\n";
    struct Change {
        std::string window, more, changed_window, changed_more;
    };
    for (const Change& one :
         {Change{time, "", time, "speed_of: reference_point\n"},
          {time, opposite, time, "opposite_runs: {within_s: 7200}\n"},
          {time, opposite, time, opposite + "runs: {turn_deg: 120}\n"},
          {part_of_it, "", time, ""},
          {part_of_it, "", part("}, to: [{event: below_start, height_m: 2000"), ""},
          {part_of_it, "", part(", speed_m_s: 12}, to: [{event: below_start, height_m: 2256"), ""},
          {alpha, "", alpha + ", alpha: any", ""},
          {alpha, "", alpha + ", proximity_m: 60", ""},
          {alpha, "", alpha + ", turn_deg: 60", ""}}) {
        Windows windows;
        windows.profiles = {{.profile = "rule", .rule = rule_of(rule(one.window, one.more))}};
        EXPECT_NO_THROW(windows_of(windows, rule(one.window, one.more))) << one.window;
        EXPECT_THROW(windows_of(windows, rule(one.changed_window, one.changed_more)), Failure)
            << one.changed_window << one.changed_more;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

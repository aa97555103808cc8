#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "approved.h"
#include "check_rules_support.h"

// The program's own requirements, under every rule: whose clock, whose positions, whose fix type.

namespace runcert::RUNCERT_FILE {
namespace {

using test::clause_text, test::contains, test::profile_text, test::RuleScene, test::text_of_file;

/// A run whose recording, in a table without a word on its origin, was screened and is good.
RuleScene scene() {
    RuleScene scene(profile_text(clause_text("margin")));
    scene.judged.format = "csv";
    scene.judged.time_origin = "the table's time column";
    scene.judged.solution_source = SolutionSource::recording;
    scene.judged.tests.device = DeviceSigns{.moving = 350};
    return scene;
}

TEST(OwnClauses, StandUnderEveryRuleBesideItsOwn) {
    const ProfileVerdict verdict = scene().verdict();
    // The last of what the attempt states: its class of craft, and that one attempt was made.
    const char* own[] = {"time-scale", "date-of-the-recording", "positions-as-measured",
                         "kind-of-solution", "craft-and-attempts"};
    ASSERT_EQ(verdict.requirements.size(), 1U + std::size(own));
    EXPECT_EQ(verdict.requirements[0].clause, "margin");
    for (std::size_t i = 0; i < std::size(own); ++i) {
        EXPECT_EQ(verdict.requirements[i + 1].clause, own[i]);
        EXPECT_EQ(verdict.requirements[i + 1].source, "this program's own requirement");
        EXPECT_FALSE(verdict.requirements[i + 1].text.empty());
    }
}

/// Every computation that decides a clause stands in the method's table, with what makes it fail.
TEST(OwnClauses, AndAllOthersSayInTheMethodWhatMakesThemFail) {
    const std::string method =
        text_of_file(std::filesystem::path(RUNCERT_SOURCE_DIR) / "reports/METHOD.md");
    const std::string head = "| computation | what makes it fail | by how much |\n|---|---|---|\n";
    const std::size_t begins = method.find(head);
    ASSERT_NE(begins, std::string::npos);
    std::istringstream rows(method.substr(begins + head.size()));
    std::vector<std::string> named;
    for (std::string row; std::getline(rows, row) && !row.empty();) {
        std::vector<std::string> cells;
        std::istringstream parts(row.substr(1));
        for (std::string cell; std::getline(parts, cell, '|');)
            cells.push_back(cell);
        ASSERT_EQ(cells.size(), 3U) << row;
        EXPECT_GT(std::min(cells[1].size(), cells[2].size()), 4U) << row;
        named.push_back(cells[0]);
    }
    std::vector<std::string> computations;
#define RUNCERT_NAME(word) computations.emplace_back(" `" #word "` ");
    RUNCERT_EACH_COMPUTATION(RUNCERT_NAME)
#undef RUNCERT_NAME
    std::ranges::sort(named);
    std::ranges::sort(computations);
    EXPECT_EQ(named, computations);
}

TEST(OwnClauses, GiveWayToAClauseOfTheRuleByTheSameComputation) {
    RuleScene other = scene();
    other.use(profile_text(clause_text("time_scale") + clause_text("margin")));
    const ProfileVerdict verdict = other.verdict();
    EXPECT_EQ(verdict.requirements.size(), 6U);
    EXPECT_EQ(
        std::ranges::count(verdict.requirements, Computation::time_scale, &Requirement::decided_by),
        1);
    EXPECT_EQ(other.clause("time_scale").text, "what time_scale asks");
}

TEST(RecordingDate, IsComparedWithThatOfTheAttempt) {
    RuleScene dated = scene();
    // Without a date the clause did not stand at all.
    const Requirement undated = dated.clause("date-of-the-recording");
    EXPECT_EQ(undated.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(undated.evidence, "the recording is of 2022-03-07")) << undated.evidence;
    // GPS week 2200 began on Sunday, 2022-03-06; the recording is of Monday.
    dated.attempt.date = "2022-03-07";
    EXPECT_EQ(dated.clause("date-of-the-recording").status, RequirementStatus::met);
    dated.attempt.date = "2022-03-08";
    EXPECT_EQ(dated.clause("date-of-the-recording").status, RequirementStatus::met);
    dated.attempt.date = "2022-03-09";
    const Requirement other = dated.clause("date-of-the-recording");
    EXPECT_EQ(other.status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(other.evidence, "2022-03-07")) << other.evidence;
    EXPECT_TRUE(contains(other.evidence, "2022-03-09")) << other.evidence;
    EXPECT_FALSE(contains(other.evidence, "1024")) << other.evidence;
    EXPECT_EQ(dated.verdict().outcome, Outcome::not_certifiable);
    for (const char* const rolled : {"2041-10-21", "2041-10-22", "2002-07-22"}) {
        dated.attempt.date = rolled;
        EXPECT_TRUE(contains(dated.clause("date-of-the-recording").evidence, "1024 weeks"))
            << rolled;
    }
    dated.judged.facts.first_epoch.reset();
    EXPECT_EQ(dated.clause("date-of-the-recording").status, RequirementStatus::attest);
}

/// The claimed day chose the rule: a day before the other's first one kept the rule that had ended.
TEST(RecordingDate, DecidesWhichRuleIsInForceAndTheClaimedDayDoesNot) {
    const auto asked = [](const std::string& from, const std::string& until,
                          const std::string& named) {
        RuleScene dated = scene();  // of 2022-03-07
        dated.use(profile_text(
            clause_text("margin"),
            (from.empty() ? "" : "valid_from: " + from + "\n") +
                (until.empty() ? "" : "superseded_by: next\nsuperseded_from: " + until + "\n")));
        dated.attempt.date = named;
        return dated.clause("date-of-the-recording");
    };
    EXPECT_EQ(asked("", "2022-03-08", "2022-03-07").status, RequirementStatus::met);
    EXPECT_EQ(asked("2022-03-07", "", "2022-03-07").status, RequirementStatus::met);
    const Requirement too_late = asked("", "2022-03-07", "2022-03-07");
    EXPECT_EQ(too_late.status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(too_late.evidence, "by then next had replaced the rule"))
        << too_late.evidence;
    EXPECT_EQ(asked("", "2022-03-07", "").status, RequirementStatus::not_met);
    RuleScene gone = scene();  // no day ends it: it is replaced on all of them
    gone.use(profile_text(clause_text("margin"), "superseded_by: next\n"));
    EXPECT_EQ(gone.clause("date-of-the-recording").status, RequirementStatus::not_met);
    EXPECT_EQ(asked("2022-03-08", "", "2022-03-07").status, RequirementStatus::attest);
    EXPECT_EQ(asked("2022-03-08", "", "").status, RequirementStatus::attest);
    for (const Requirement& parted :
         {asked("", "2022-03-07", "2022-03-06"), asked("", "2022-03-08", "2022-03-08"),
          asked("2022-03-07", "", "2022-03-06"), asked("2022-03-08", "", "2022-03-08")}) {
        EXPECT_EQ(parted.status, RequirementStatus::attest) << parted.evidence;
        EXPECT_TRUE(contains(parted.evidence, "on one of them the rule was not in force"))
            << parted.evidence;
    }
}

TEST(RecordingDate, IsThatOfThePlace) {
    // Monday 23:00 GPS time: in New Zealand it is Tuesday; two days before is Sunday.
    RuleScene far = scene();
    far.judged.facts.first_epoch = GpsTime::from_week(2200, 169'200'000'000'000);
    far.judged.facts.georeferenced = true;
    far.judged.origin = FrameOrigin{.position = {.latitude = Angle::from_degrees(-40.0),
                                                 .longitude = Angle::from_degrees(175.0),
                                                 .height_m = 0.0},
                                    .source = "attempt"};
    far.attempt.date = "2022-03-06";
    EXPECT_EQ(far.clause("date-of-the-recording").status, RequirementStatus::not_met);
    far.judged.origin->position.longitude = Angle::from_degrees(0.0);
    EXPECT_EQ(far.clause("date-of-the-recording").status, RequirementStatus::met);
}

/// What the recorded velocities say of the window.
void set_velocities(RuleScene& scene, double speed_m_s, double normalised_error = 0.0) {
    WitnessedSpeed witnessed;
    witnessed.speed_m_s = speed_m_s;
    witnessed.standard_uncertainty_m_s = 0.05;
    witnessed.difference_m_s = 60.0 - speed_m_s;
    witnessed.normalised_error = normalised_error;
    scene.judged.windows.profiles[0].best->witnesses = {witnessed};
}

/// 10 Hz stamped as 12 Hz: even stamps met the clause at any rate, and made a fifth more speed.
TEST(TimeScale, OfSatellitesIsMetOnlyWhereAWitnessWouldHaveShownAWrongRate) {
    RuleScene stamped = scene();
    stamped.judged.facts.time_source = "satellites";
    stamped.judged.time_origin = "GPS time of the receiver's measurements";
    const Requirement alone = stamped.clause("time-scale");
    EXPECT_EQ(alone.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(alone.evidence, "no witness shares the stamps")) << alone.evidence;
    set_velocities(stamped, 60.0);
    EXPECT_EQ(stamped.clause("time-scale").status, RequirementStatus::met);
    EXPECT_TRUE(contains(stamped.clause("time-scale").evidence, "at another rate"));
    EXPECT_EQ(stamped.clause("time-scale").decided_by, Computation::time_scale);
    // Velocities that would have agreed with any rate show none.
    stamped.best().witnesses[0].standard_uncertainty_m_s = 3.0;
    EXPECT_EQ(stamped.clause("time-scale").status, RequirementStatus::attest);
    stamped.best().witnesses.clear();
    stamped.judged.format = "rinex";
    EXPECT_EQ(stamped.clause("time-scale").status, RequirementStatus::met);
}

/// What screening says of stamps whose steps lead so far away from the nearest usual interval.
void set_steps(RuleScene& scene, double interval_s, double usual_s, double departure_s) {
    TimeStampSummary& time = scene.judged.tests.time;
    time.interval_s = interval_s;
    time.usual_interval_s = usual_s;
    time.departure_s = departure_s;
}

TEST(TimeScale, OfStepsThatNoReceiverMakesIsToAttestWhateverTheFormatSays) {
    for (const char* source : {"satellites", "attempt"}) {
        RuleScene stamped = scene();
        stamped.judged.facts.time_source = source;
        stamped.judged.facts.time_resolution_s = 0.001;
        set_steps(stamped, 0.1, 0.1, 0.00299);
        EXPECT_FALSE(contains(stamped.clause("time-scale").evidence, "lead"));
        set_steps(stamped, 0.098, 0.1, 0.706);
        const Requirement requirement = stamped.clause("time-scale");
        EXPECT_EQ(requirement.status, RequirementStatus::attest) << source;
        for (const char* part : {"lead 0.706 s away from 0.1 s", "mean step 0.098 s", "settings"})
            EXPECT_TRUE(contains(requirement.evidence, part)) << requirement.evidence;
    }
}

TEST(TimeScale, OfStampsInHundredthsIsNotBlamedForTheirRounding) {
    RuleScene stamped = scene();
    stamped.judged.facts.time_source = "satellites";
    stamped.judged.facts.time_resolution_s = 0.01;
    set_velocities(stamped, 60.0);
    set_steps(stamped, 0.0999, 0.1, 0.0119);
    EXPECT_EQ(stamped.clause("time-scale").status, RequirementStatus::met);
    set_steps(stamped, 0.0999, 0.1, 0.0121);
    EXPECT_EQ(stamped.clause("time-scale").status, RequirementStatus::attest);
}

/// Steps that alternate were looked at one by one: 20 ms of 3 s, 0.7 % of the speed, went unseen.
TEST(TimeScale, OfAWindowWhoseStepsLeadAwayInSumIsToAttestHoweverTheyAlternate) {
    RuleScene stamped = scene();
    set_velocities(stamped, 60.0);
    stamped.judged.facts.time_source = "satellites";
    stamped.judged.facts.time_resolution_s = 0.001;
    set_steps(stamped, 0.1, 0.1, 0.0);
    const auto lead_away = [&](double sum_s) {
        RuleScene other = stamped;
        for (std::size_t k = 0; k < other.rows().size(); ++k)
            other.rows()[k].time.nanoseconds -= std::llround(
                (static_cast<double>(k) / 30.0 * sum_s + (k % 2 == 1 ? 0.004 : 0.0)) * 1e9);
        return other.clause("time-scale");
    };
    EXPECT_EQ(lead_away(0.0029).status, RequirementStatus::met);
    EXPECT_EQ(lead_away(-0.0031).status, RequirementStatus::attest);
    const Requirement twenty = lead_away(0.02);
    EXPECT_EQ(twenty.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(twenty.evidence, "in sum, 0.0200 s away from 0.1 s")) << twenty.evidence;
}

TEST(TimeScale, OfACounterOrAnUnknownClockIsToAttest) {
    RuleScene unknown = scene();
    // A rate that no receiver offers has nothing to be compared with; a good one is not proof.
    for (const double rate : {0.0, -9.9e-5, 9.9e-5}) {
        unknown.judged.tests.time.rate_deviation = rate;
        const Requirement requirement = unknown.clause("time-scale");
        EXPECT_EQ(requirement.status, RequirementStatus::attest) << rate;
        EXPECT_TRUE(
            contains(requirement.evidence, "the recording cannot show whether its rate is true"));
        EXPECT_NEAR(requirement.figures.at(0).value, rate * 1e6, 1e-9);
    }
    EXPECT_EQ(unknown.verdict().outcome, Outcome::beaten);
}

TEST(TimeScale, ThatIsSatellitesByTheAttemptsWordIsToAttestWhateverItsRate) {
    RuleScene claimed = scene();
    claimed.judged.facts.time_source = "attempt";
    for (const double rate : {0.0, -2e-3}) {
        claimed.judged.tests.time.rate_deviation = rate;
        EXPECT_EQ(claimed.clause("time-scale").status, RequirementStatus::attest);
        EXPECT_TRUE(contains(claimed.clause("time-scale").evidence, "the attempt states"));
        EXPECT_NEAR(claimed.clause("time-scale").figures.at(0).value, rate * 1e6, 1e-9);
    }
}

struct WrongRate {
    double deviation;
    const char* said;
};

TEST(TimeScale, OfStampsThatRunWrongIsNotMetAndNothingIsBeaten) {
    for (const WrongRate& wrong : {WrongRate{-0.0015, "0.150 % shorter"},
                                   {-0.002, "0.200 % shorter"},
                                   {-0.004, "0.400 % shorter"},
                                   {0.002, "0.200 % longer"}}) {
        SCOPED_TRACE(wrong.said);
        RuleScene short_by = scene();
        short_by.judged.tests.time.rate_deviation = wrong.deviation;
        // Stamps of milliseconds, 351 epochs in 35 s: 5 x 0.3 ms x sqrt(401) / 40 s is 7.5e-4.
        short_by.judged.tests.time.jitter_s = 3e-4;
        const Requirement requirement = short_by.clause("time-scale");
        EXPECT_EQ(requirement.status, RequirementStatus::not_met);
        EXPECT_TRUE(contains(requirement.evidence, wrong.said)) << requirement.evidence;
        EXPECT_TRUE(contains(requirement.evidence, "time_source: satellites"));
        EXPECT_EQ(short_by.verdict().outcome, Outcome::not_certifiable);
        EXPECT_TRUE(contains(short_by.verdict().reason, "time-scale"));
    }
}

TEST(TimeScale, IsNotBlamedForWhatTheScatterOfTheStepsMakesByChance) {
    // 5 x 2 ms x sqrt(401) / 40 s = 0.0050
    RuleScene jittery = scene();
    jittery.judged.tests.time.jitter_s = 2e-3;
    const double by_chance = 5.0 * 2e-3 * std::sqrt(401.0) / 40.0;
    jittery.judged.tests.time.rate_deviation = -0.999 * by_chance;
    EXPECT_EQ(jittery.clause("time-scale").status, RequirementStatus::attest);
    jittery.judged.tests.time.rate_deviation = -1.001 * by_chance;
    EXPECT_EQ(jittery.clause("time-scale").status, RequirementStatus::not_met);
}

TEST(MeasuredPositions, WithoutAWitnessAreToAttestAndTheReasonSaysPositionsAlone) {
    const RuleScene alone = scene();
    const Requirement requirement = alone.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_EQ(requirement.evidence, "only the positions themselves could show it");
    EXPECT_TRUE(alone.verdict().witnesses.empty());
    EXPECT_EQ(alone.verdict().reason.find("By positions alone, the measured speed"), 0U)
        << alone.verdict().reason;
}

TEST(MeasuredPositions, WithVelocitiesThatAgreeAreStillToAttest) {
    RuleScene with = scene();
    set_velocities(with, 60.0);
    const Requirement requirement = with.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_EQ(requirement.evidence.find("recorded velocities give 216.00"), 4U)
        << requirement.evidence;
    const ProfileVerdict verdict = with.verdict();
    ASSERT_EQ(verdict.witnesses.size(), 1U);
    EXPECT_TRUE(contains(verdict.witnesses[0], "recorded velocities give 216.00 km/h ± 0.36 km/h"));
    EXPECT_FALSE(contains(verdict.reason, "positions alone")) << verdict.reason;
}

TEST(MeasuredPositions, HaveNoWitnessInVelocitiesThatContradict) {
    RuleScene with = scene();
    set_velocities(with, 60.1, 0.999);
    EXPECT_EQ(with.verdict().witnesses.size(), 1U);
    set_velocities(with, 60.1, 1.001);
    EXPECT_TRUE(with.verdict().witnesses.empty());
    EXPECT_EQ(with.clause("positions-as-measured").status, RequirementStatus::attest);
    EXPECT_EQ(with.verdict().outcome, Outcome::not_certifiable);
}

TEST(MeasuredPositions, HaveNoWitnessInASecondMethodThatIsTyped) {
    RuleScene with = scene();
    with.attempt.secondary_method = SecondaryMethod{.method = "radar",
                                                    .source = "protocol",
                                                    .speed = SecondaryMethod::Speed{60.01, 0.02},
                                                    .times = std::nullopt};
    EXPECT_EQ(with.clause("positions-as-measured").status, RequirementStatus::attest);
    const ProfileVerdict verdict = with.verdict();
    EXPECT_TRUE(verdict.witnesses.empty());
    EXPECT_TRUE(contains(verdict.reason, "By positions alone")) << verdict.reason;
    EXPECT_TRUE(std::ranges::count(
        verdict.notes,
        "By the attempt's own statement, the second method (radar) gives 216.036 km/h ± 0.072 "
        "km/h, +0.036 km/h against the positions' 216.000 km/h (normalised error 0.45, at most "
        "1)."));
}

TEST(MeasuredPositions, SolvedHereFromRawObservationsAreToAttestAsTheFilesAre) {
    RuleScene solved = scene();
    solved.judged.format = "rinex";
    EXPECT_EQ(solved.clause("positions-as-measured").status, RequirementStatus::attest);
    EXPECT_EQ(solved.clause("positions-as-measured").evidence,
              "positions were solved here, from raw observations that are kept; only the positions "
              "themselves could show it");
}

TEST(MeasuredPositions, SayFromWhichFilesTheHeaderSaysThatTheyWereSolved) {
    RuleScene solved = scene();
    solved.judged.processing =
        Processing{.program = "RTKLIB ver.2.4.3", .files = {"rover.obs", "base.obs"}};
    EXPECT_EQ(solved.clause("positions-as-measured").evidence,
              "positions were solved by RTKLIB ver.2.4.3 from rover.obs, base.obs, as the "
              "recording's header says; only the positions themselves could show it");
}

TEST(MeasuredPositions, OfASimulatorAreSaidToBeAndNobodyNeedsToLookForIt) {
    RuleScene simulated = scene();
    set_velocities(simulated, 60.0);
    EXPECT_TRUE(simulated.verdict().notes.empty() ||
                !contains(simulated.verdict().notes.front(), "simulated"));
    simulated.judged.simulated = true;
    const Requirement requirement = simulated.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_EQ(requirement.evidence.find("the recording says that it was simulated; "), 0U)
        << requirement.evidence;
    ASSERT_FALSE(simulated.verdict().notes.empty());
    EXPECT_TRUE(contains(simulated.verdict().notes.front(), "no craft was measured"));
}

TEST(MeasuredPositions, ThatAreHeldAreNotMetWhoeverSpeaksForThem) {
    RuleScene held = scene();
    set_velocities(held, 60.0);
    held.judged.tests.device = DeviceSigns{.moving = 350, .held = 3};
    EXPECT_EQ(held.clause("positions-as-measured").status, RequirementStatus::attest);
    held.judged.tests.device->held = 4;  // of 350 one in a hundred is 3.5
    const Requirement requirement = held.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::not_met);
    for (const char* part : {"4 of 350 positions", "repeat the one before", "held"})
        EXPECT_TRUE(contains(requirement.evidence, part)) << requirement.evidence;
    EXPECT_EQ(held.verdict().outcome, Outcome::not_certifiable);
}

TEST(MeasuredPositions, ThatAreInterpolatedAreNotMetUnlessChanceMakesThem) {
    RuleScene resampled = scene();
    set_velocities(resampled, 60.0);
    DeviceSigns& device = *resampled.judged.tests.device;
    device.interpolated = 175;  // every other one
    const Requirement requirement = resampled.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::not_met);
    for (const char* part : {"175 of 350 positions", "on a line", "interpolated", "chance makes 0"})
        EXPECT_TRUE(contains(requirement.evidence, part)) << requirement.evidence;
    EXPECT_EQ(resampled.verdict().outcome, Outcome::not_certifiable);
    // Where coordinates are coarse, so many of a steady run are in line by chance.
    device.by_chance = 60.0;
    EXPECT_EQ(resampled.clause("positions-as-measured").status, RequirementStatus::attest);
    device = {.moving = 350, .held = 0, .interpolated = 70, .by_chance = 0.0};  // a fifth
    EXPECT_EQ(resampled.clause("positions-as-measured").status, RequirementStatus::attest);
}

TEST(MeasuredPositions, ThatLookFilteredAreToAttestWhateverTheWitnesses) {
    RuleScene filtered = scene();
    set_velocities(filtered, 60.0);
    filtered.judged.tests.models = {
        {.axes = TestedAxes::horizontal, .noise = NoiseBasis::fitted, .white_scale = 0.31}};
    filtered.judged.estimation.horizontal = AxesEstimation{};
    filtered.judged.estimation.horizontal.health.autocorrelation = 0.09;
    EXPECT_FALSE(contains(filtered.clause("positions-as-measured").evidence, "; but "));
    filtered.judged.tests.models[0].white_scale = 0.29;
    EXPECT_EQ(filtered.clause("positions-as-measured").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(filtered.clause("positions-as-measured").evidence,
                         "scatter by 0.29 times what is stated"));
    filtered.judged.tests.models[0].noise = NoiseBasis::too_few_epochs;  // then it says nothing
    EXPECT_FALSE(contains(filtered.clause("positions-as-measured").evidence, "; but "));
    filtered.judged.estimation.horizontal.health.autocorrelation = 0.43;
    EXPECT_EQ(filtered.clause("positions-as-measured").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(filtered.clause("positions-as-measured").evidence,
                         "follow one another (lag 1: "
                         "+0.43)"));
    // Without a witness the signs are told too.
    filtered.judged.windows.profiles[0].best->witnesses.clear();
    EXPECT_TRUE(
        contains(filtered.clause("positions-as-measured").evidence,
                 "only the positions themselves could show it; signs found in them: innovations"));
}

TEST(MeasuredPositions, ThatSwingAfterEveryChangeOfAccelerationAreToAttest) {
    RuleScene filtered = scene();
    set_velocities(filtered, 60.0);
    // The step response of 0.3 Hz, damping 0.3, at 5 s and 20 s: by 37 %, of which 10 Hz see 36 %.
    const auto response = [](double t) {
        if (t < 0.0) return 0.0;
        const double rate = 2.0 * std::numbers::pi * 0.3, rest = std::sqrt(1.0 - 0.09);
        return 1.0 - std::exp(-0.3 * rate * t) *
                         (std::cos(rest * rate * t) + 0.3 / rest * std::sin(rest * rate * t));
    };
    for (TrajectoryEpoch& row : filtered.judged.trajectory) {
        row.speed_m_s = row.velocity_north_m_s = 60.0;
        row.acceleration_north_m_s2 =
            4.0 * (response(row.time.seconds() - 5.0) - response(row.time.seconds() - 20.0));
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 0.03;
    }
    const Requirement requirement = filtered.clause("positions-as-measured");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_TRUE(
        contains(requirement.evidence,
                 "after 2 of 2 changes of acceleration the motion overshoots and oscillates "
                 "with a period of 3.5 s, at first by 36 %"))
        << requirement.evidence;
}

TEST(KindOfSolution, ThatTheAttemptClaimsIsToAttest) {
    RuleScene claimed = scene();
    claimed.judged.solution_source = SolutionSource::attempt;
    for (ScreenedEpoch& row : claimed.rows())
        row.fix = FixType::fixed;
    claimed.best().bound.emplace().floor_m = 0.01;
    claimed.best().bound->floor_fix = FixType::fixed;
    const Requirement requirement = claimed.clause("kind-of-solution");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    for (const char* part :
         {"the recording does not state it", "the attempt states fixed",
          "in the window: fixed, whose time-correlated errors are taken to be at least "
          "0.01 m"})
        EXPECT_TRUE(contains(requirement.evidence, part)) << requirement.evidence;
}

TEST(KindOfSolution, ThatTheRecordingSaysOrNobodyIsMet) {
    RuleScene said = scene();
    EXPECT_EQ(said.clause("kind-of-solution").status, RequirementStatus::met);
    EXPECT_EQ(said.clause("kind-of-solution").evidence, "the recording states it");
    for (const auto& [source, words] :
         {std::pair{SolutionSource::unknown,
                    "the recording does not state it, so the positions count as those "
                    "of one receiver alone"},
          {SolutionSource::partly,
           "the recording states it for some positions; the others count as those of one "
           "receiver alone"}}) {
        said.judged.solution_source = source;
        EXPECT_EQ(said.clause("kind-of-solution").status, RequirementStatus::met)
            << to_text(source);
        EXPECT_EQ(said.clause("kind-of-solution").evidence, words);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

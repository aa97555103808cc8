#include <fmt/ranges.h>

#include "rules_support.h"

// What a person may get wrong about a rule, a course, a series or a second method: it is refused
// with its place and what to do, or cannot be certified, with the sentence that an official needs.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// With a millimetre of noise, as no measured position is without any.
PlaneRecording measured_northwards(double speed_m_s) {
    PlaneRecording recording = northwards(speed_m_s);
    recording.noise_m = 0.001;
    return recording;
}

const char* const three_seconds = "{duration_s: 3, definition: displacement}";
const char* const course_window = "{kind: course, distance_m: 500, definition: elapsed_time}";

struct Refused {
    std::string name;
    std::string attempt;  ///< more lines of it, from line 6 on
    std::vector<std::string> said;
};

void PrintTo(const Refused& refused, std::ostream* out) {
    *out << refused.name;
}

class RuleInput : public testing::TestWithParam<Refused> {};

TEST_P(RuleInput, IsRefusedWithItsPlaceAndWhatToDo) {
    const Refused& given = GetParam();
    const Rules rules;
    rules.put("recording.csv", measured_northwards(20.0).text());
    rules.put("unknown.yaml", profile_of("unknown", three_seconds, clause_of("aerodynamics")));
    const std::string with_unit = profile_of("without_unit", three_seconds);
    const std::string unit = ", unit: km/h";
    const std::size_t at = with_unit.find(unit);
    rules.put("without_unit.yaml",
              fmt::format("{}{}", with_unit.substr(0, at), with_unit.substr(at + unit.size())));
    rules.put("no_limit.yaml", profile_of("no_limit", three_seconds, clause_of("wind_mean")));
    rules.put("windy.yaml",
              profile_of("windy", three_seconds, clause_of("wind_mean", ", limit: 10, unit: m/s")));
    rules.put("course.yaml", profile_of("course", course_window));
    rules.put("bad.csv", "time_s,speed_m_s,direction_deg\n0,5,90\n10,six,90\n");
    rules.put("negative.csv", "time_s,speed_m_s,direction_deg\n0,-5,90\n");
    rules.put("instants.csv", "time,speed_m_s,direction_deg\n2026-03-14T03:20:00Z,5,90\n");
    const ProcessResult result = rules.certify(given.attempt);
    EXPECT_EQ(result.exit_status, 2) << result.output << result.errors;
    for (const char* part : {"error: ", "where: ", "what to do: "})
        EXPECT_TRUE(contains(result.errors, part)) << result.errors;
    EXPECT_FALSE(contains(result.errors, "fault of the program")) << result.errors;
    const std::string errors = lower_case(result.errors);  // a sentence begins with a capital
    for (const std::string& said : given.said)
        EXPECT_TRUE(contains(errors, lower_case(said))) << said << "\n" << result.errors;
    EXPECT_FALSE(fs::exists(rules.run() / "6-verdict.yaml"));
}

std::string lines(double start_m, double finish_m, double length_m) {
    return course_of({start_m}, {finish_m}, length_m);
}

const std::string on_earth =
    "{left: {latitude_deg: 1, longitude_deg: 1}, right: {latitude_deg: 1, longitude_deg: 1.1}}";

// The attempt has five lines before those of a case: schema, id, craft, receivers, profiles.
INSTANTIATE_TEST_SUITE_P(
    Bad, RuleInput,
    testing::Values(
        Refused{"UnknownComputation",
                plane_attempt("unknown.yaml"),
                {"aerodynamics", "unknown.yaml:9:", "fastest_certifiable"}},
        Refused{"MarginWithoutUnit",
                plane_attempt("without_unit.yaml"),
                {"kind: absolute needs unit", "without_unit.yaml:6:16", "Write unit: km/h"}},
        Refused{"ComputationWithoutALimit",
                plane_attempt("no_limit.yaml"),
                {"needs a figure to compare with", "no_limit.yaml:9:", "Add limit: and unit:"}},
        Refused{"NoCourse",
                plane_attempt("wssrc-500m"),
                {"the profile wssrc-500m needs a surveyed course, and the attempt gives none",
                 "attempt", "Add course: {start, finish"}},
        Refused{"CourseOfAnotherLength",
                plane_attempt("wssrc-500m", lines(50.0, 450.0, 400.0)),
                {"is for a course of 500 m, this one has 400 m",
                 "attempt.yaml:6:", "Use a profile of that length, or correct length_m"}},
        Refused{"CourseNotAsLongAsStated",
                plane_attempt("wssrc-500m", lines(50.0, 450.0, 500.0)),
                {"stated to be 500.00 m long, but the middles of its lines are 400.00 m apart",
                 "attempt.yaml:6:"}},
        Refused{"LineWithoutWidth",
                plane_attempt("course.yaml",
                              "course: {length_m: 500, length_expanded_uncertainty_m: 0, start: "
                              "{left: {east_m: 1, north_m: 2}, right: {east_m: 1, north_m: 2}}, "
                              "finish: {left: {east_m: 0, north_m: 502}, right: {east_m: 2, "
                              "north_m: 502}}}\n"),
                {"the two ends of a line of the course are the same point", "attempt.yaml:6:"}},
        Refused{"CourseOnTheEarthForAPlane",
                plane_attempt("course.yaml",
                              fmt::format("course: {{length_m: 500, "
                                          "length_expanded_uncertainty_m: 0, start: {0}, finish: "
                                          "{0}}}\n",
                                          on_earth)),
                {"the course is in geodetic coordinates, the recording in engineering coordinates",
                 "attempt.yaml:6:", "Give east_m and north_m"}},
        Refused{"RecordInAnUnknownUnit",
                plane_attempt("nalsa", "record: {speed: 10, unit: furlongs, source: s}\n"),
                {"\"furlongs\" is not one of km/h, m/s, kn, mph", "attempt.yaml:6:27"}},
        Refused{
            "RecordOfAProfileThatIsNotClaimed",
            plane_attempt("nalsa", "records: [{profile: fisly, speed: 10, unit: kn, source: s}]\n"),
            {"does not claim the profile \"fisly\"", "attempt.yaml:6:"}},
        Refused{"WindThatIsMissing",
                plane_attempt("windy.yaml", "wind: {file: absent.csv, source: mast}\n"),
                {"the file \"absent.csv\" does not exist", "attempt.yaml:6:14"}},
        Refused{"WindOutsideOfTheFolder",
                plane_attempt("windy.yaml", "wind: {file: ../bad.csv, source: mast}\n"),
                {"is outside of the attempt's folder", "attempt.yaml:6:14",
                 "Copy the file into the attempt's folder"}},
        Refused{"WindWithABadNumber",
                plane_attempt("windy.yaml", "wind: {file: bad.csv, source: mast}\n"),
                {"\"six\" is not a speed", "where: bad.csv:3:4",
                 "a measured number with a decimal point"}},
        Refused{"WindOfANegativeSpeed",
                plane_attempt("windy.yaml", "wind: {file: negative.csv, source: mast}\n"),
                {"where: negative.csv:2:3"}},
        Refused{"WindWithInstantsForARelativeTime",
                plane_attempt("windy.yaml", "wind: {file: instants.csv, source: mast}\n"),
                {"it gives instants, but the recording's times are relative", "instants.csv:1:1"}},
        Refused{
            "OverrideOfAnUnknownFigure",
            plane_attempt("nalsa", "rules: [{profile: nalsa, figure: margin.vaule, value: 2}]\n"),
            {"the profile nalsa has no figure \"margin.vaule\"",
             "attempt.yaml:6:", "Use one of: window.duration_s, margin.value"}},
        Refused{"OverrideOfAFigureThatTheRuleDoesNotHave",
                plane_attempt("nalsa",
                              "rules: [{profile: nalsa, figure: window.distance_m, value: 2}]\n"),
                {"the profile nalsa has no figure \"window.distance_m\"", "attempt.yaml:6:"}},
        Refused{
            "OverrideOutsideOfItsRange",
            plane_attempt(
                "nalsa", "rules: [{profile: nalsa, figure: accuracy.coverage_factor, value: 9}]\n"),
            {"accuracy.coverage_factor cannot be 9", "Give a figure from 1 to 4"}},
        Refused{"SecondMethodThatEndsBeforeItBegins",
                plane_attempt("nalsa",
                              "secondary: {method: gates, source: p, start_utc: "
                              "\"2026-03-14T03:20:00\", finish_utc: \"2026-03-14T03:19:00\", "
                              "time_expanded_uncertainty_s: 0.01}\n"),
                {"the finish is not after the start", "attempt.yaml:6:"}}),
    [](const auto& instance) { return instance.param.name; });

// Input that can be read, but certifies nothing.

/// Judged over a course; the requirement is that of the window.
ProfileVerdict over_course(const PlaneRecording& recording, const std::string& course) {
    const Rules rules;
    rules.put("recording.csv", recording.text());
    rules.put("course.yaml", profile_of("course", course_window));
    return rules.judge_one(plane_attempt("course.yaml", course));
}

void expect_no_window(const ProfileVerdict& verdict, const std::string& why) {
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(verdict.speed_m_s || verdict.window);
    EXPECT_EQ(requirement_of(verdict, "complete").status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(verdict.reason, why)) << verdict.reason;
    EXPECT_TRUE(any_contains(verdict.notes, "There is no window because " + why))
        << fmt::format("{}", fmt::join(verdict.notes, "\n"));
}

TEST(Gates, ThatTheTrackNeverCrosses) {
    const PlaneRecording recording = northwards(20.0);
    // Beside the track, towards east.
    expect_no_window(over_course(recording, course_of({100.0, 90.0}, {600.0, 90.0}, 500.0)),
                     "the track never crosses the start line");
    expect_no_window(over_course(recording, lines(500.0, 1000.0, 500.0)),
                     "the track crosses the start line once but never the finish line after it");
    // The other way: left and right are exchanged.
    expect_no_window(over_course(recording, course_of({-600.0, 180.0}, {-100.0, 180.0}, 500.0)),
                     "the track crosses the start line only against the course's direction, once "
                     "(are left and right exchanged?)");
}

/// To and fro, by 8 m/s and 120 m of a sine of 40 s: back over 190 m at about 15 s and again at
/// 33 s; over 300 m, 690 m and 800 m once.
double to_and_fro_m(double time_s) {
    return 8.0 * time_s + 120.0 * std::sin(2.0 * std::numbers::pi * time_s / 40.0);
}

/// When it is at a place, between two times.
double time_at_s(double along_m, double low_s, double high_s) {
    for (int step = 0; step < 60; ++step) {
        const double middle_s = 0.5 * (low_s + high_s);
        (to_and_fro_m(middle_s) < along_m ? low_s : high_s) = middle_s;
    }
    return low_s;
}

TEST(Gates, ThatAreCrossedTwice) {
    const PlaneRecording recording{
        .position_at = [](double time_s) { return PlanePosition{.north_m = to_and_fro_m(time_s)}; },
        .duration_s = 95.0};
    const ProfileVerdict verdict = over_course(recording, lines(190.0, 690.0, 500.0));
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(verdict.speed_m_s.has_value());
    for (const char* part : {"The start line was crossed 3 times before the finish line, at ",
                             "it is not known which crossing began the run"})
        EXPECT_TRUE(contains(verdict.reason, part)) << verdict.reason;
    // Lines that are crossed once.
    const ProfileVerdict once = over_course(recording, lines(300.0, 800.0, 500.0));
    ASSERT_TRUE(once.speed_m_s.has_value()) << once.reason;
    EXPECT_NEAR(*once.speed_m_s,
                500.0 / (time_at_s(800.0, 80.0, 92.0) - time_at_s(300.0, 30.0, 50.0)), 1e-4);
}

TEST(SeriesOfTheWind, ThatDoesNotCoverTheWindowIsNotCertifiable) {
    const Rules rules;
    rules.put("recording.csv", measured_northwards(20.0).text());
    rules.put("windy.yaml",
              profile_of("windy", three_seconds, clause_of("wind_mean", ", limit: 10, unit: m/s")));
    rules.put("wind.csv", "time_s,speed_m_s,direction_deg\n0,5,90\n0.5,6,90\n");
    const std::string attempt =
        plane_attempt("windy.yaml", "wind: {file: wind.csv, source: mast}\n");
    const ProfileVerdict verdict = rules.judge_one(attempt);
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    // By the name that the attempt has for it, wherever the run is made.
    EXPECT_TRUE(verdict.reason.starts_with(
        "Not met: wind_mean: wind.csv covers 0.0 s to 0.5 s from the recording's first epoch; the "
        "window is "))
        << verdict.reason;
    const std::string first = read_file(rules.run() / "6-verdict.yaml");
    rules.judge_one(attempt);
    EXPECT_EQ(first, read_file(rules.run() / "6-verdict.yaml"));

    rules.put("wind.csv", "time_s,speed_m_s,direction_deg\n0,5,90\n40,5,90\n");
    const ProfileVerdict covered = rules.judge_one(attempt);
    EXPECT_EQ(requirement_of(covered, "wind_mean").status, RequirementStatus::attest);
    EXPECT_EQ(covered.outcome, Outcome::not_proven);  // no record is named
    EXPECT_EQ(runcert({"audit", rules.run().string()}).exit_status, 0);
}

const std::string at_three_o_clock = ", start_gps: \"2026-03-14T03:20:00\"";

TEST(SecondMethod, OfReceiversThatDoNotOverlapInTimeIsNotCertifiable) {
    const Rules rules;
    rules.put("recording.csv", measured_northwards(20.0).text());
    PlaneRecording second = measured_northwards(20.0);
    second.seed += 1;
    rules.put("second.csv", second.text());
    rules.put("two.yaml", profile_of("two", three_seconds, clause_of("secondary_method")));
    const auto verdict_with = [&](const std::string& second_start) {
        return rules.judge_one(fmt::format(
            "schema: attempt/1.0\nid: rules\ncraft: {{name: yacht, class: land-yacht}}\n"
            "receivers: [{}, {}]\nprofiles: [two.yaml]\n",
            csv_receiver("primary", "recording.csv", 0.01, at_three_o_clock),
            csv_receiver("second", "second.csv", 0.01,
                         fmt::format(", start_gps: \"{}\"", second_start))));
    };
    // Until an official has answered for the second file.
    EXPECT_EQ(requirement_of(verdict_with("2026-03-14T03:20:00"), "secondary_method").status,
              RequirementStatus::attest);
    const ProfileVerdict verdict = verdict_with("2026-03-14T05:20:00");
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(verdict.reason,
                         "receiver \"second\" has no estimate over the whole of "
                         "that time"))
        << verdict.reason;
}

TEST(SecondMethod, ByTimesOfAnotherRunIsNotCertifiable) {
    const Rules rules;
    rules.put("recording.csv", measured_northwards(20.0).text());
    rules.put("course.yaml", profile_of("course", course_window, clause_of("secondary_method")));
    // The lines are crossed 2.525 s and 27.525 s after 03:19:42 UTC.
    const auto verdict_with = [&](const std::string& start, const std::string& finish) {
        return rules.judge_one(fmt::format(
            "schema: attempt/1.0\nid: rules\ncraft: {{name: yacht, class: land-yacht}}\n"
            "receivers: [{}]\nprofiles: [course.yaml]\n{}"
            "secondary: {{method: light gates, source: protocol, start_utc: \"2026-03-14T{}\", "
            "finish_utc: \"2026-03-14T{}\", time_expanded_uncertainty_s: 0.001}}\n",
            csv_receiver("primary", "recording.csv", 0.01, at_three_o_clock),
            lines(50.5, 550.5, 500.0), start, finish));
    };
    const ProfileVerdict agrees = verdict_with("03:19:44.525", "03:20:09.526");
    EXPECT_EQ(requirement_of(agrees, "secondary_method").status, RequirementStatus::attest)
        << requirement_of(agrees, "secondary_method").evidence;
    EXPECT_EQ(agrees.outcome, Outcome::not_proven) << agrees.reason;

    const ProfileVerdict another = verdict_with("04:19:44.525", "04:20:09.526");
    EXPECT_EQ(another.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(another.reason,
                         "light gates: its times are +3600.000 s and +3600.001 s off those of the "
                         "window: they are of another run, or of another clock"))
        << another.reason;

    const ProfileVerdict contradicts = verdict_with("03:19:44.525", "03:20:10.125");
    EXPECT_EQ(contradicts.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(contradicts.reason, "normalised error")) << contradicts.reason;
}

TEST(Current, ThatTheRuleSubtractsMustBeGiven) {
    const Rules rules;
    rules.put("recording.csv", measured_northwards(20.0).text());
    const std::string attempt = plane_attempt("wssrc-500m", lines(50.5, 550.5, 500.0));
    const ProfileVerdict without = rules.judge_one(attempt);
    EXPECT_EQ(without.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(without.speed_m_s.has_value());
    EXPECT_TRUE(contains(without.reason,
                         "The rule subtracts the current, which is not known for the window: give "
                         "current: in the attempt, with a series that covers it."))
        << without.reason;
    rules.put("current.csv", "time_s,speed_kn,direction_deg\n0,0.5,0\n60,0.5,0\n");
    const ProfileVerdict with = rules.judge_one(
        attempt + "current: {file: current.csv, source: m, expanded_uncertainty_m_s: 0.05}\n");
    EXPECT_NEAR(with.speed_m_s.value(), 20.0 - 0.5 * 1852.0 / 3600.0, 2e-3);
    EXPECT_GT(with.expanded_uncertainty_m_s.value(), 0.05);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

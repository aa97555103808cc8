#include <map>
#include <sstream>

#include "core/geodesy.h"
#include "core/text.h"
#include "rules_support.h"
#include "schemas/trajectory/declared.h"

// What the rules say of recordings that are made, so that their speeds are known.

namespace runcert::chain::RUNCERT_FILE {
namespace {

// A simulated recording under all rules that fit it.

/// The true path (m) of the simulated run at its times.
std::map<double, double> true_path() {
    std::istringstream lines(read_file(examples / "salt_lake" / "truth.csv"));
    std::map<double, double> path;
    std::string line;
    for (int header = 0; header < 2; ++header)
        std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream cells(line);
        std::vector<double> values;
        for (std::string cell; std::getline(cells, cell, ',');)
            values.push_back(parse_double(cell).value());
        path[values.at(0)] = std::hypot(values.at(1), values.at(2));
    }
    return path;
}

double time_at(const std::map<double, double>& path, double along_m) {
    auto after = path.begin();
    while (after->second < along_m)
        ++after;
    const auto before = std::prev(after);
    return before->first + (after->first - before->first) * (along_m - before->second) /
                               (after->second - before->second);
}

/// A line across the simulated run, in degrees.
std::string line_on_the_lake(double along_m) {
    const LocalFrame frame({.latitude = Angle::from_degrees(-31.6),
                            .longitude = Angle::from_degrees(136.0),
                            .height_m = 110.0});
    const double bearing = 160.0 * std::numbers::pi / 180.0;
    const Eigen::Vector3d ahead(std::sin(bearing), std::cos(bearing), 0.0);
    const Eigen::Vector3d right(ahead.y(), -ahead.x(), 0.0);
    const auto end = [&](double to_the_right_m) {
        const Geodetic place =
            frame.geodetic_from_enu(Enu{along_m * ahead + to_the_right_m * right});
        return fmt::format("{{latitude_deg: {:.10f}, longitude_deg: {:.10f}}}",
                           place.latitude.degrees(), place.longitude.degrees());
    };
    return fmt::format("{{left: {}, right: {}}}", end(-15.0), end(15.0));
}

TEST(OneRecording, UnderAllRulesThatFitItShowsHowTheyDiffer) {
    const Rules rules;
    rules.bring_in(examples / "salt_lake" / "recording.pos");
    rules.put("mean3.yaml", profile_of("mean3", "{duration_s: 3, definition: mean_n}"));
    rules.put("path3.yaml", profile_of("path3", "{duration_s: 3, definition: path_length}"));
    rules.put("anywhere.yaml",
              profile_of("anywhere", "{duration_s: 3, definition: displacement, ends: any}"));
    rules.put("metres.yaml",
              profile_of("metres", "{kind: distance, distance_m: 500, definition: path_length}"));
    rules.put("current.csv", "time_s,speed_m_s,direction_deg\n0,0.2,160\n30,0.2,160\n60,0.2,160\n");
    const Verdict verdict = rules.judge(fmt::format(
        "schema: attempt/1.0\nid: lake\ncraft: {{name: yacht, class: land-yacht}}\n"
        "receivers: [{{id: primary, recording: recording.pos}}]\n"
        "origin: {{latitude_deg: -31.6, longitude_deg: 136.0, height_m: 110.0}}\n"
        "record: {{speed: 222.43, unit: km/h, source: press}}\n"
        "records: [{{profile: wssrc-500m, speed: 65.45, unit: kn, source: newsletter}}]\n"
        "course: {{length_m: 500, length_expanded_uncertainty_m: 0.02, start: {}, finish: {}}}\n"
        "current: {{file: current.csv, source: meter, expanded_uncertainty_m_s: 0.04}}\n"
        "profiles: [nalsa, fisly, wssrc-500m, mean3.yaml, path3.yaml, anywhere.yaml, "
        "metres.yaml]\n",
        line_on_the_lake(1500.0), line_on_the_lake(2000.0)));
    const auto path = true_path();
    const auto fastest = [&](double duration_s) {
        const double end_s = path.rbegin()->first;
        return (path.rbegin()->second - path.lower_bound(end_s - duration_s - 1e-6)->second) /
               duration_s;
    };
    const double over_course =
        500.0 / (time_at(path, 2000.0) - time_at(path, 1500.0)) - 0.2;  // less the current
    const double over_500_m =
        500.0 / (path.rbegin()->first - time_at(path, path.rbegin()->second - 500.0));
    const double expected[] = {fastest(3.0), fastest(2.0), over_course, fastest(3.0),
                               fastest(3.0), fastest(3.0), over_500_m};
    std::string beside;
    for (const std::string& statement : verdict.statements)
        if (contains(statement, "The rules do not measure the same")) beside = statement;
    const char* const measured[] = {"(3 s, displacement over time)",
                                    "(2 s, displacement over time)",
                                    "(a course of 500 m, length over elapsed time)",
                                    "(3 s, mean of speeds)",
                                    "(3 s, path length over time)",
                                    "(3 s, displacement over time)",
                                    "(500 m, path length over time)"};
    for (std::size_t i = 0; i < verdict.profiles.size(); ++i) {
        const ProfileVerdict& profile = verdict.profiles[i];
        SCOPED_TRACE(profile.profile);
        EXPECT_NEAR(*profile.speed_m_s, expected[i], *profile.expanded_uncertainty_m_s);
        EXPECT_TRUE(
            contains(beside, fmt::format("{} {} {} {}", profile.profile, profile.shown->speed,
                                         profile.shown->unit, measured[i])))
            << beside;
    }
    const ProfileVerdict& wssrc = verdict.profiles[2];
    EXPECT_EQ(wssrc.record->unit, "kn");
    EXPECT_NEAR(*wssrc.current_subtracted_m_s, 0.2, 1e-4);
    // Below the limit, and by a series that was handed in.
    EXPECT_EQ(requirement_of(wssrc, "current").status, RequirementStatus::attest);
    EXPECT_EQ(wssrc.shown->unit, "kn");
    // A window that may begin at any instant is no slower than one between epochs.
    EXPECT_GE(*verdict.profiles[5].speed_m_s, *verdict.profiles[0].speed_m_s - 1e-9);
}

TEST(OneRecording, OfACurveIsSlowerByDisplacementThanByPath) {
    const Rules rules;
    const PlaneRecording circle{.position_at =
                                    [](double time_s) {
                                        const double angle = 30.0 / 200.0 * time_s;
                                        return PlanePosition{
                                            .east_m = 200.0 - 200.0 * std::cos(angle),
                                            .north_m = 200.0 * std::sin(angle)};
                                    },
                                .duration_s = 30.0,
                                .noise_m = 0.005};
    rules.put("recording.csv", circle.text());
    rules.put("chord.yaml", profile_of("chord", "{duration_s: 3, definition: displacement}"));
    rules.put("path.yaml", profile_of("path", "{duration_s: 3, definition: path_length}"));
    const Verdict verdict = rules.judge(plane_attempt(
        "chord.yaml, path.yaml", "record: {speed: 107.5, unit: km/h, source: none}\n", 0.005));
    const ProfileVerdict &chord = verdict.profiles.at(0), &path = verdict.profiles.at(1);
    EXPECT_NEAR(*chord.speed_m_s, 2.0 * 200.0 * std::sin(0.225) / 3.0,
                *chord.expanded_uncertainty_m_s);
    EXPECT_NEAR(*path.speed_m_s, 30.0, *path.expanded_uncertainty_m_s);
    EXPECT_GT(*path.speed_m_s, *chord.speed_m_s + 0.2);
    EXPECT_EQ(chord.outcome, Outcome::not_beaten) << chord.reason;
    EXPECT_EQ(path.outcome, Outcome::beaten) << path.reason;
    for (const ProfileVerdict& profile : verdict.profiles)
        EXPECT_TRUE(any_contains(profile.notes,
                                 "The definition of speed matters here: path length "
                                 "over time"));
}

/// Out at 22 m/s and back at 18 m/s, between rests of 8 s.
PlanePosition out_and_back(double time_s) {
    const auto run_m = [](double since_s, double top_m_s) {
        // 2 m/s^2 up, 10 s at the top speed, 2 m/s^2 down.
        const double gains_s = 0.5 * top_m_s;
        const double up_s = std::clamp(since_s, 0.0, gains_s);
        const double level_s = std::clamp(since_s - gains_s, 0.0, 10.0);
        const double down_s = std::clamp(since_s - gains_s - 10.0, 0.0, gains_s);
        return up_s * up_s + top_m_s * (level_s + down_s) - down_s * down_s;
    };
    return {.east_m = 0.0, .north_m = run_m(time_s - 8.0, 22.0) - run_m(time_s - 48.0, 18.0)};
}

TEST(OppositeRuns, HaveTheMeanOfBoth) {
    const Rules rules;
    const PlaneRecording recording{
        .position_at = out_and_back, .duration_s = 84.0, .noise_m = 0.005};
    rules.put("recording.csv", recording.text());
    rules.put("pair.yaml",
              profile_of("pair", "{duration_s: 3, definition: displacement}",
                         clause_of("opposite_runs"), "opposite_runs: {within_s: 3600}\n"));
    const std::string attempt = plane_attempt("pair.yaml", "", 0.005);
    const ProfileVerdict verdict = rules.judge_one(attempt);
    EXPECT_NEAR(*verdict.speed_m_s, 20.0, *verdict.expanded_uncertainty_m_s);
    const Requirement pair = requirement_of(verdict, "opposite_runs");
    EXPECT_EQ(pair.status, RequirementStatus::met) << pair.evidence;
    EXPECT_NEAR(pair.figures.at(0).value, 22.0, 0.1);
    EXPECT_NEAR(pair.figures.at(1).value, 18.0, 0.1);
    EXPECT_TRUE(any_contains(verdict.notes, "The speed is the mean of 2 windows"));
    ASSERT_EQ(verdict.runs.size(), 2U);
    EXPECT_NEAR(std::remainder(verdict.runs[0].heading_deg, 360.0), 0.0, 0.1);
    EXPECT_NEAR(verdict.runs[1].heading_deg, 180.0, 0.1);

    // The two lie 40 s apart.
    const ProfileVerdict refused = rules.judge_one(
        attempt + "rules: [{profile: pair, figure: opposite_runs.within_s, value: 20}]\n");
    EXPECT_EQ(refused.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(any_contains({requirement_of(refused, "opposite_runs").evidence},
                             "of 2 runs with a certifiable window no two are in opposite "
                             "directions within 20 s"));
    EXPECT_TRUE(any_contains(refused.notes, "opposite_runs.within_s is 20 s, not 3600 s"));
}

// A course whose lines are crossed at known times.

struct CourseRun {
    double speed_m_s, heading_deg, start_m, finish_turned_deg;
};

PlaneRecording along(const CourseRun& run, double noise_m, std::uint64_t seed) {
    return {.position_at =
                [run](double time_s) {
                    const double heading = run.heading_deg * std::numbers::pi / 180.0;
                    return PlanePosition{.east_m = run.speed_m_s * time_s * std::sin(heading),
                                         .north_m = run.speed_m_s * time_s * std::cos(heading)};
                },
            .duration_s = std::ceil((run.start_m + 600.0) / run.speed_m_s),
            .noise_m = noise_m,
            .seed = seed};
}

std::string course_for(const CourseRun& run) {
    return course_of({run.start_m, run.heading_deg, 0.0},
                     {run.start_m + 500.0, run.heading_deg, run.finish_turned_deg}, 500.0);
}

const char* const course_window = "{kind: course, distance_m: 500, definition: elapsed_time}";

TEST(Course, WithoutNoiseTheSpeedIsTheLengthOverTheTime) {
    for (const CourseRun& run : {CourseRun{20.0, 0.0, 100.0, 0.0},       // on epochs
                                 CourseRun{20.0, 0.0, 101.3, 0.0},       // between them
                                 CourseRun{37.0, 123.0, 95.7, 0.0},      // elsewhere between them
                                 CourseRun{41.7, 288.0, 80.1, 25.0}}) {  // a line askew
        const Rules rules;
        rules.put("recording.csv", along(run, 0.0, 1).text());
        rules.put("course.yaml", profile_of("course", course_window));
        const ProfileVerdict verdict =
            rules.judge_one(plane_attempt("course.yaml", course_for(run), 0.001));
        ASSERT_TRUE(verdict.speed_m_s.has_value()) << verdict.reason;
        EXPECT_NEAR(*verdict.speed_m_s / run.speed_m_s, 1.0, 1e-6) << run.speed_m_s;
        EXPECT_NEAR(verdict.window->start.seconds(), run.start_m / run.speed_m_s, 1e-5);
        EXPECT_NEAR(verdict.window->duration.seconds(), 500.0 / run.speed_m_s, 2e-5);
    }
}

/// About 40 m/s towards north and none towards east, both accelerations random walks: the jerk is
/// white noise of 0.15 m s^-2.5, as the motion model has it. Steps of a millisecond.
class RandomMotion {
  public:
    static constexpr double step_s = 1e-3, jerk_density = 0.15;

    RandomMotion(double duration_s, std::uint64_t seed) {
        RandomGenerator random(1000 + seed);
        Eigen::Vector2d position(0.0, 0.0), velocity(0.0, 40.0), acceleration(0.0, 0.0);
        for (double time_s = 0.0; time_s < duration_s + 1.0; time_s += step_s) {
            positions_m_.push_back(position);
            position += step_s * (velocity + 0.5 * step_s * acceleration);
            velocity += step_s * acceleration;
            const double east = random.normal(), north = random.normal();
            acceleration += jerk_density * std::sqrt(step_s) * Eigen::Vector2d(east, north);
        }
    }
    PlanePosition operator()(double time_s) const {
        const Eigen::Vector2d& at =
            positions_m_.at(static_cast<std::size_t>(std::llround(time_s / step_s)));
        return {.east_m = at.x(), .north_m = at.y()};
    }
    /// When it first is so far north.
    double time_s(double north_m) const {
        std::size_t k = 1;
        while (positions_m_.at(k).y() < north_m)
            ++k;
        const double before = positions_m_[k - 1].y(), after = positions_m_[k].y();
        return step_s * (static_cast<double>(k) - (after - north_m) / (after - before));
    }

  private:
    std::vector<Eigen::Vector2d> positions_m_;
};

struct Covered {
    int certified = 0, fitted = 0;
    int white = 0;             ///< by the positions at the lines alone
    double mean_square = 0.0;  ///< of the error over the standard uncertainty of these
};

/// Of the speed between two smoothed positions far apart in time, by their own uncertainties.
double two_positions_m_s(const Rules& rules, const WindowSpan& span) {
    const TrajectoryTable table =
        read_trajectory(read_file(rules.run() / "4-trajectory.ecsv"), "4-trajectory");
    const auto sigma_m = [&](std::int64_t epoch) {
        return table.rows.at(static_cast<std::size_t>(epoch - 1)).sigma_north_m.value();
    };
    return std::hypot(sigma_m(span.first_epoch), sigma_m(span.last_epoch)) /
           span.duration.seconds();
}

/// How often the true speed of a course is within the certified uncertainty; within that which is
/// estimated of the recording; and within that of the smoothed positions at its lines, which is all
/// that there is here: the others hold time-correlated errors as well, which the data cannot
/// exclude.
Covered covered_courses(int seeds) {
    constexpr double duration_s = 24.0, start_m = 101.3, finish_m = 601.3;
    Covered covered;
    for (int k = 1; k <= seeds; ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        const RandomMotion motion(duration_s, seed);
        const PlaneRecording recording{
            .position_at = motion, .duration_s = duration_s, .noise_m = 0.01, .seed = seed};
        const double true_m_s = 500.0 / (motion.time_s(finish_m) - motion.time_s(start_m));
        const Rules rules;
        rules.put("recording.csv", recording.text());
        rules.put("course.yaml", profile_of("course", course_window));
        const ProfileVerdict verdict = rules.judge_one(plane_attempt(
            "course.yaml",
            course_of({.along_m = start_m, .half_width_m = 500.0},
                      {.along_m = finish_m, .half_width_m = 500.0}, 500.0) +
                "parameters: {window: {monte_carlo_trials_max: 100000, selection_samples: "
                "100}}\n"));
        if (!verdict.speed_m_s) throw std::runtime_error(verdict.reason);
        const CertifiableWindow best = rules.windows().profiles.at(0).best.value();
        const double error = *verdict.speed_m_s - true_m_s;
        const double white = two_positions_m_s(rules, best.span);
        if (std::abs(error) <= *verdict.expanded_uncertainty_m_s) ++covered.certified;
        if (std::abs(best.fitted->speed_m_s - true_m_s) <=
            2.0 * best.fitted->standard_uncertainty_m_s)
            ++covered.fitted;
        if (std::abs(error) <= 2.0 * white) ++covered.white;
        covered.mean_square += error * error / (white * white) / seeds;
    }
    return covered;
}

TEST(Course, WithNoiseTheSpeedIsWithinItsUncertainty) {
    const Covered covered = covered_courses(20);
    EXPECT_EQ(covered.certified, 20);
    EXPECT_GE(covered.fitted, 19);
    // A binomial deviate of 20 at 95 % is below 16 in 0.3 % of the cases.
    EXPECT_GE(covered.white, 16);
    // Chi-squared of 20 degrees over 20 is between 0.3 and 2.3 in 99.8 % of them.
    EXPECT_GT(covered.mean_square, 0.3);
    EXPECT_LT(covered.mean_square, 2.3);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

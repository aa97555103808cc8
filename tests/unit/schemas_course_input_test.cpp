#include "schemas_rule_input_support.h"

// What an attempt says of the course, of wind and current, and of a second method.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace rule_input_test;

TEST(CourseInput, ACourseInTheRecordingsPlane) {
    const Course course = read(course_of("{east_m: -10, north_m: 0.25}")).course.value();
    EXPECT_EQ(course.length_m, 502.25);
    EXPECT_EQ(course.length_expanded_uncertainty_m, 0.02);
    EXPECT_EQ(course.start.left.plane_m, (std::array<double, 2>{-10.0, 0.25}));
    EXPECT_EQ(course.start.right.plane_m, (std::array<double, 2>{10.0, 0.0}));
    EXPECT_EQ(course.finish.left.plane_m, (std::array<double, 2>{-10.0, 500.0}));
    EXPECT_EQ(course.finish.right.plane_m, (std::array<double, 2>{10.0, 500.5}));
    EXPECT_FALSE(course.start.left.geodetic);
    EXPECT_EQ(course.place, "f:8:3");
}

TEST(CourseInput, ACourseOnTheEarth) {
    const Course course = read(R"(course:
  length_m: 500
  length_expanded_uncertainty_m: 0
  start: {left: {latitude_deg: 35.5, longitude_deg: 137.25}, right: {latitude_deg: 35.25, longitude_deg: 137.5}}
  finish: {left: {latitude_deg: -35.5, longitude_deg: -137.25}, right: {latitude_deg: 0, longitude_deg: 0}}
)")
                              .course.value();
    EXPECT_EQ(course.start.left.geodetic->latitude.degrees(), 35.5);
    EXPECT_EQ(course.start.left.geodetic->longitude.degrees(), 137.25);
    EXPECT_EQ(course.start.left.geodetic->height_m, 0.0);
    EXPECT_EQ(course.start.right.geodetic->longitude.degrees(), 137.5);
    EXPECT_EQ(course.finish.left.geodetic->latitude.degrees(), -35.5);
    EXPECT_EQ(course.finish.right.geodetic->latitude.degrees(), 0.0);
    EXPECT_FALSE(course.finish.right.plane_m);
}

TEST(CourseInput, BadCoursesAreNamedWithTheirPlace) {
    const std::string good = course_of("{east_m: -10, north_m: 0.25}");
    const std::string two =
        "a point has two coordinates. Give latitude_deg and longitude_deg, or "
        "east_m and north_m";
    expect_refused({
        {course_of("{east_m: -10}"), "f:10:17", two},
        {course_of("{}"), "f:10:17", two},
        {course_of("{latitude_deg: 35}"), "f:10:17", two},
        {course_of("{latitude_deg: 35, north_m: 1}"), "f:10:17", two},
        {course_of("{east_m: 0, north_m: 1, latitude_deg: 35}"), "f:10:17", two},
        {course_of("{east_m: 0, north_m: 1, latitude_deg: 35, longitude_deg: 137}"), "f:10:17",
         two},
        {course_of("{latitude_deg: 91, longitude_deg: 137}"), "f:10:32", "91 is above 90 deg"},
        {course_of("{latitude_deg: 5, longitude_deg: 361}"), "f:10:50", "361 is above 360 deg"},
        {course_of("{east: 0, north_m: 1}"), "f:10:18", "Did you mean \"east_m\""},
        {replaced(good, "length_m: 502.25", "length_m: 0"), "f:8:13", "0 is below 1 m"},
        {replaced(good, "  length_expanded_uncertainty_m: 0.02\n", ""), "f:8:3",
         "\"length_expanded_uncertainty_m\" is missing"},
        {replaced(good, "_m: 0.02", "_m: -0.02"), "f:9:34", "-0.02 is below 0 m"},
        {replaced(good, ", right: {east_m: 10, north_m: 0}", ""), "f:10:10",
         "\"right\" is missing"},
        {replaced(good, "finish", "end"), "f:11:3", "unknown key \"end\" in course"},
    });
}

TEST(CourseInput, WindAndCurrent) {
    const Attempt attempt = read(R"(wind: {file: wind.csv, source: mast at the start}
current: {file: day 1/current.csv, source: float, expanded_uncertainty_m_s: 0.05}
)");
    EXPECT_EQ(attempt.wind->file, "wind.csv");
    EXPECT_EQ(attempt.wind->source, "mast at the start");
    EXPECT_EQ(attempt.wind->place, "f:7:14");
    EXPECT_EQ(attempt.current->file, "day 1/current.csv");
    EXPECT_EQ(attempt.current->source, "float");
    EXPECT_EQ(attempt.current->expanded_uncertainty_m_s, 0.05);
    expect_refused({
        {"wind: {file: wind.csv}\n", "f:7:7", "\"source\" is missing"},
        {"wind: {source: mast}\n", "f:7:7", "\"file\" is missing"},
        {"wind: wind.csv\n", "f:7:7", "not a map"},
        {"wind: {file: w.csv, source: m, expanded_uncertainty_m_s: 1}\n", "f:7:32", "unknown key"},
        {"current: {file: c.csv, source: float}\n", "f:7:10",
         "\"expanded_uncertainty_m_s\" is missing"},
        {"current: {file: c.csv, source: float, expanded_uncertainty_m_s: 11}\n", "f:7:65",
         "11 is above 10 m / s"},
    });
}

TEST(CourseInput, ASecondMethodSaysASpeed) {
    const Attempt attempt = read(
        "secondary: {method: radar, source: sheet 3, speed: 100, unit: kn, "
        "expanded_uncertainty: 0.5}\n");
    const SecondaryMethod& second = attempt.secondary_method.value();
    EXPECT_EQ(second.method, "radar");
    EXPECT_EQ(second.source, "sheet 3");
    EXPECT_DOUBLE_EQ(second.speed->speed_m_s, 185200.0 / 3600.0);
    EXPECT_DOUBLE_EQ(second.speed->expanded_uncertainty_m_s, 926.0 / 3600.0);
    EXPECT_FALSE(second.times);
}

TEST(CourseInput, ASecondMethodSaysTwoTimes) {
    for (const char* zone : {"", "Z"}) {
        const Attempt attempt = read(std::string("secondary:\n  method: gates\n  source: sheet 4\n"
                                                 "  start_utc: \"2022-03-18T08:51:04.300") +
                                     zone + "\"\n  finish_utc: \"2022-03-18T08:51:24.125\"\n" +
                                     "  time_expanded_uncertainty_s: 0.02\n");
        const auto& times = attempt.secondary_method->times.value();
        EXPECT_EQ(to_iso(times.start), "2022-03-18T08:51:22.300");  // 18 leap seconds
        EXPECT_EQ(to_iso(times.finish), "2022-03-18T08:51:42.125");
        EXPECT_EQ(times.expanded_uncertainty_s, 0.02);
        EXPECT_FALSE(attempt.secondary_method->speed);
    }
}

TEST(CourseInput, BadSecondMethodsAreNamedWithTheirPlace) {
    const auto second = [](const std::string& rest) {
        return "secondary: {method: m, source: s" + rest + "}\n";
    };
    const std::string speed = ", speed: 100, unit: kn, expanded_uncertainty: 0.5";
    const std::string times =
        ", start_utc: \"2022-03-18T08:51:04\", finish_utc: \"2022-03-18T08:51:24\", "
        "time_expanded_uncertainty_s: 0.02";
    const std::string either =
        "a second method says a speed, or two times. Give speed, unit and "
        "expanded_uncertainty; or start_utc, finish_utc and time_expanded_uncertainty_s";
    const std::string together =
        "start_utc, finish_utc and time_expanded_uncertainty_s belong together. Give all of them";
    expect_refused({
        {second(""), "f:7:12", either},
        {second(speed + times), "f:7:12", either},
        {second(", speed: 100"), "f:7:12", "speed, unit and expanded_uncertainty belong together"},
        {second(", speed: 100, unit: kn"), "f:7:12", "Give all of them"},
        {second(", unit: kn, expanded_uncertainty: 0.5"), "f:7:12", "belong together"},
        {second(", start_utc: \"2022-03-18T08:51:04\""), "f:7:12", together},
        {second(speed + ", finish_utc: \"2022-03-18T08:51:04\""), "f:7:12", together},
        {second(replaced(speed, "kn", "knots")), "f:7:53", "\"knots\" is not one of km/h"},
        {second(replaced(times, "08:51:24", "08:51:04")), "f:7:81",
         "the finish is not after the start. Correct the times"},
        {second(replaced(times, "08:51:24", "08:50:24")), "f:7:81", "the finish is not after"},
        {second(replaced(times, "08:51:24", "8:51:24")), "f:7:81", "secondary.finish_utc"},
        {second(replaced(times, "03-18T08:51:04", "02-30T08:51:04")), "f:7:46",
         "secondary.start_utc"},
        {second(replaced(times, "08:51:04", "08:51:04+01:00")), "f:7:46", "secondary.start_utc"},
        {second(replaced(times, "0.02", "-1")), "f:7:133", "-1 is below 0 s"},
        {replaced(second(speed), "method: m, ", ""), "f:7:12", "\"method\" is missing"},
    });
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

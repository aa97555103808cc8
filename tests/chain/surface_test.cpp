#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>

#include "chain_support.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "schemas/screened/screened.h"
#include "schemas/surface/declared.h"
#include "schemas/verdict/declared.h"

// A craft on a surveyed course: from the attempt to marked heights, and from earlier runs to a
// surface that checks another one.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr double antenna_m = 1.2;

Geodetic origin() {
    return {.latitude = Angle::from_degrees(-31.6),
            .longitude = Angle::from_degrees(136.0),
            .height_m = 110.0};
}

/// The course: 0.5 % uphill towards east, banked by 3 % towards north.
double ground_m(double east_m, double north_m) {
    return 2.0 + 0.005 * east_m + 0.03 * north_m;
}

/// At rest for 5 s, 4 m/s^2 up to 60 m/s at 20 s, steady until 40 s.
double path_m(double time_s) {
    const double pulling_s = std::clamp(time_s - 5.0, 0.0, 15.0);
    return 2.0 * pulling_s * pulling_s + 60.0 * std::max(0.0, time_s - 20.0);
}

struct RunSpec {
    double north_m = 0.0;
    std::uint64_t seed = 1;
    double lifted_m = 0.0;  ///< from 25 s to 35 s
};

std::string recording(const RunSpec& spec) {
    const LocalFrame frame(origin());
    RandomGenerator random(spec.seed);
    std::string text = "time,lat,lon,height\n";
    for (int k = 0; k <= 400; ++k) {
        const double time_s = 0.1 * k, east_m = path_m(time_s);
        const bool lifted = time_s >= 25.0 && time_s < 35.0;
        const Geodetic place = frame.geodetic_from_enu(
            {{east_m + 0.01 * random.normal(), spec.north_m + 0.01 * random.normal(),
              ground_m(east_m, spec.north_m) + antenna_m + (lifted ? spec.lifted_m : 0.0) +
                  0.015 * random.normal()}});
        text += fmt::format("{:.1f},{:.10f},{:.10f},{:.4f}\n", time_s, place.latitude.degrees(),
                            place.longitude.degrees(), place.height_m);
    }
    return text;
}

/// The vertices of the course in the local frame of the origin, their heights lowered.
std::string survey(double lowered_m) {
    std::string text = "vertex,east,north,up\n";
    for (int i = 0; i <= 34; ++i)
        for (const double north_m : {-20.0, 20.0}) {
            const double east_m = 50.0 * i - 25.0;
            text += fmt::format("{},{},{},{:.4f}\n", 2 * i + (north_m > 0.0 ? 2 : 1), east_m,
                                north_m, ground_m(east_m, north_m) - lowered_m);
        }
    return text;
}

std::string triangles() {
    std::string text = "vertex_1,vertex_2,vertex_3\n";
    for (int i = 0; i < 34; ++i)
        text +=
            fmt::format("{0},{1},{2}\n{0},{2},{3}\n", 2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2);
    return text;
}

constexpr const char* surveyed =
    "\n    surface: {file: vertices.csv, triangles: triangles.csv, frame: local_plane, unit: m, "
    "source: a survey, vertical_sd_m: 0.05}";

/// A folder of attempts over the course.
class Course {
  public:
    explicit Course(double lowered_m = 0.0) {
        write_file_atomically(folder_.path() / "vertices.csv", survey(lowered_m));
        write_file_atomically(folder_.path() / "triangles.csv", triangles());
    }

    fs::path file(const std::string& name) const { return folder_.path() / name; }

    ProcessResult certified(const std::string& id, const RunSpec& spec,
                            const std::string& surface = {}) const {
        write_file_atomically(file(id + ".csv"), recording(spec));
        write_file_atomically(file(id + ".yaml"), fmt::format(R"(schema: attempt/1.0
id: {0}
craft: {{name: simulated yacht, class: land-yacht}}
place: a simulated lake
officials: [{{role: measurer}}]
receivers:
  - id: primary
    recording: {0}.csv
    format: csv
    frame: geodetic
    columns: {{time: time, latitude: lat, longitude: lon, height: height}}
    accuracy: {{horizontal_m: 0.010, vertical_m: 0.015}}
    solution: fixed
    antenna_height_m: {1}{2}
origin: {{latitude_deg: -31.6, longitude_deg: 136.0, height_m: 110.0}}
record: {{speed: 150, unit: km/h, source: "a simulation"}}
profiles: [nalsa]
)",
                                                              id, antenna_m, surface));
        return certify(file(id + ".yaml"), file("out-" + id), {"--no-render"});
    }
    ScreenedTable screened(const std::string& id) const {
        const fs::path table = file("out-" + id) / "3-screened.ecsv";
        return read_screened(read_file(table), table.string());
    }
    Verdict verdict(const std::string& id) const {
        return read_verdict(read_file(file("out-" + id) / "6-verdict.yaml"), "6-verdict.yaml");
    }

  private:
    TemporaryFolder folder_;
};

std::optional<double> figure_named(const Verdict& verdict, const std::string& name) {
    for (const Figure& figure : verdict.profiles.at(0).course)
        if (figure.name == name) return figure.value;
    return std::nullopt;
}

TEST(SurfaceChain, HeightsAreComparedAndTheCourseIsThatOfTheSurface) {
    const Course course;
    const ProcessResult certified = course.certified("level", {}, surveyed);
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const ScreenedTable table = course.screened("level");
    ASSERT_TRUE(table.basis.surface);
    EXPECT_EQ(table.basis.surface->compared, 401);
    EXPECT_EQ(table.basis.surface->rejected, 0);
    EXPECT_NEAR(table.basis.surface->offset_m, 0.0, 0.005);
    const Verdict verdict = course.verdict("level");
    // Above the ellipsoid, which falls below the plane by 0.3 m in 2 km.
    EXPECT_NEAR(figure_named(verdict, "slope of the ground under the window").value_or(0), 0.51,
                0.015);
    EXPECT_NEAR(figure_named(verdict, "slope of the window").value_or(0), 0.51, 0.05);
    // Who surveyed it, and how high the antenna is, are for the measurer to answer for.
    const auto& requirements = verdict.profiles.at(0).requirements;
    EXPECT_EQ(std::ranges::count(requirements, "surface-as-surveyed", &Requirement::clause), 1);
    const ProcessResult verified =
        runcert({"verify", course.file("out-level").string(), "--recompute"});
    EXPECT_NE(verified.exit_status, 2) << verified.errors;
    EXPECT_NE(verified.output.find("identical: all 7 files"), std::string::npos) << verified.output;
    const ProcessResult audit = runcert({"audit", course.file("out-level").string()});
    EXPECT_EQ(audit.exit_status, 0) << audit.errors;
    EXPECT_NE(audit.output.find("Heights above the surface"), std::string::npos) << audit.output;
    const ProcessResult exported = runcert({"export", course.file("out-level").string(), "--format",
                                            "csv", "--table", "surface", "--out", "-"});
    EXPECT_EQ(exported.exit_status, 0) << exported.errors;
    EXPECT_NE(exported.output.find("triangle,68,"), std::string::npos);
}

TEST(SurfaceChain, ASolutionHalfAMetreTooHighForTenSecondsIsMarked) {
    const Course course;
    const ProcessResult certified = course.certified("lifted", {.lifted_m = 0.5}, surveyed);
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const ScreenedTable table = course.screened("lifted");
    EXPECT_GE(table.basis.surface->rejected, 95);
    for (const ScreenedEpoch& row : table.rows)
        EXPECT_EQ(row.usable, row.time.seconds() < 24.95 || row.time.seconds() > 34.95)
            << row.time.seconds();
    const ProcessResult audit = runcert({"audit", course.file("out-lifted").string()});
    EXPECT_TRUE(std::regex_search(audit.output,
                                  std::regex(R"(left out:\s+contradicted\s+by\s+the\s+surface)")))
        << audit.output;
}

TEST(SurfaceChain, AHeightAboveTheGeoidIsNamedWithItsMetres) {
    const ProcessResult certified = Course(36.4).certified("geoid", {}, surveyed);
    EXPECT_EQ(certified.exit_status, 2);
    EXPECT_NE(certified.errors.find("he antenna is 36.40 m above where the surface has it, in "
                                    "the median, everywhere alike"),
              std::string::npos)
        << certified.errors;
    EXPECT_NE(certified.errors.find("undulation_m: 36.40"), std::string::npos) << certified.errors;
}

TEST(SurfaceChain, EarlierRunsCheckAnotherOneAndNeverThemselves) {
    const Course course;
    std::vector<std::string> arguments{"surface"};
    for (int i = 0; i < 5; ++i) {
        const std::string id = fmt::format("pass-{}", i);
        const ProcessResult one = course.certified(
            id, {.north_m = 6.0 * i - 12.0, .seed = static_cast<std::uint64_t>(i) + 10});
        ASSERT_NE(one.exit_status, 2) << one.errors;
        arguments.push_back(course.file("out-" + id).string());
    }
    arguments.insert(arguments.end(), {"--out", course.file("course.ecsv").string()});
    const ProcessResult made = runcert(arguments);
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_EQ(runcert(arguments).exit_status, 2);  // it is there
    const SurfaceTable surface = read_surface(read_file(course.file("course.ecsv")), "course.ecsv");
    EXPECT_EQ(surface.made_from.size(), 5U);
    EXPECT_LT(surface.vertical_sd_m, 0.025);
    constexpr const char* own =
        "\n    surface: {file: course.ecsv, source: runs of the day before}";
    const ProcessResult another =
        course.certified("another", {.north_m = 3.0, .seed = 99, .lifted_m = 0.5}, own);
    ASSERT_NE(another.exit_status, 2) << another.errors;
    const ScreenedTable table = course.screened("another");
    EXPECT_GE(table.basis.surface->rejected, 95);
    EXPECT_NEAR(table.basis.surface->scatter_m, 0.02, 0.01);
    const ProcessResult itself = course.certified("pass-2", {.north_m = 0.0, .seed = 12}, own);
    EXPECT_EQ(itself.exit_status, 2);
    EXPECT_NE(itself.errors.find("he surface was made from this recording itself (run pass-2)"),
              std::string::npos)
        << itself.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

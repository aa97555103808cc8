#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "chain_support.h"
#include "core/decimal.h"
#include "core/text.h"
#include "inertial/attitude.h"
#include "schemas/attitude/declared.h"
#include "schemas/windows/windows.h"

// examples/oval: a car with an IMU on a banked oval that was surveyed. Its attitude starts on the
// surface, and the axes of the IMU are judged by it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr double rad = radians_per_degree;

/// The example, certified with its attempt and survey changed.
class OvalExample {
  public:
    using Change = std::function<std::string(std::string)>;

    explicit OvalExample(const Change& of_attempt = {}, const Change& of_survey = {}) {
        fs::copy(examples / "oval", folder());
        const auto change = [&](const char* name, const Change& how) {
            if (how) write_file_atomically(folder() / name, how(read_file(folder() / name)));
        };
        change("attempt.yaml", of_attempt);
        change("surface.xml", of_survey);
        certified_ = certify(folder() / "attempt.yaml", run(), {"--no-render"});
        EXPECT_LT(certified_.exit_status, 2) << certified_.errors;
    }

    fs::path folder() const { return temporary_.path() / "oval"; }
    fs::path run() const { return temporary_.path() / "run"; }
    AttitudeTable attitude() const {
        return read_attitude(read_file(run() / "4-attitude.ecsv"), "4-attitude.ecsv");
    }
    CertifiableWindow window() const {
        return *read_windows(read_file(run() / "5-windows.yaml"), "f").profiles.at(0).best;
    }

  private:
    TemporaryFolder temporary_;
    ProcessResult certified_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return text.replace(text.find(from), from.size(), to);
}

std::vector<double> numbers_of(const std::string& line, char between) {
    std::vector<double> numbers;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t to = std::min(line.find(between, from), line.size());
        numbers.push_back(parse_double(line.substr(from, to - from)).value());
        from = to + 1;
    }
    return numbers;
}

/// The strip of the survey, turned about its middle line: every row of four vertices by an angle.
std::string turned_across(const std::string& survey, double angle_rad) {
    std::string text;
    std::vector<std::array<std::string, 2>> row;  // what stands before and after the numbers
    std::vector<std::vector<double>> places;
    for (const std::string& line : lines_of(survey)) {
        const std::size_t open = line.find("<P id="), close = line.find("</P>");
        if (open == std::string::npos) {
            text += line + "\n";
            continue;
        }
        const std::size_t from = line.find('>', open) + 1;
        row.push_back({line.substr(0, from), line.substr(close)});
        places.push_back(numbers_of(line.substr(from, close - from), ' '));
        if (row.size() < 4) continue;
        for (std::size_t i = 0; i < 4; ++i) {
            const double across_m =
                (i < 2 ? -1.0 : 1.0) * std::hypot(places[i][0] - (places[0][0] + places[3][0]) / 2,
                                                  places[i][1] - (places[0][1] + places[3][1]) / 2);
            text += fmt::format("{}{:.4f} {:.4f} {:.4f}{}\n", row[i][0], places[i][0], places[i][1],
                                places[i][2] + across_m * std::tan(angle_rad), row[i][1]);
        }
        row.clear();
        places.clear();
    }
    EXPECT_TRUE(row.empty());
    return text;
}

TEST(OvalExample, StartsOnTheSurfaceAndFindsTheAttitude) {
    const OvalExample example;
    const AttitudeTable attitude = example.attitude();
    ASSERT_EQ(attitude.consistency.standing, InertialStanding::consistent)
        << attitude.consistency.reason;
    EXPECT_EQ(attitude.consistency.start, InertialStart::surface);
    ASSERT_TRUE(attitude.consistency.start_on_surface);
    const SurfaceStart& start = *attitude.consistency.start_on_surface;
    EXPECT_NEAR(start.sigma_roll_deg, 10.0, 0.1);
    const auto lines = lines_of(read_file(examples / "oval/truth.csv"));
    double most_deg = 0.0;
    std::size_t known = 0;
    for (std::size_t i = 0; i < attitude.rows.size(); ++i) {
        const AttitudeEpoch& row = attitude.rows[i];
        if (!row.roll_deg) continue;
        const std::vector<double> truth = numbers_of(lines.at(i + 2), ',');
        const std::size_t columns = truth.size();
        if (known++ == 0) {
            // Body roll and slip of the car, and ten metres of flat triangle on the curve.
            EXPECT_NEAR(start.roll_deg, truth[columns - 3], 2.5);
            EXPECT_NEAR(start.pitch_deg, truth[columns - 2], 2.5);
            // The course is that of the first second, and the car turns by 6 degrees in it.
            EXPECT_NEAR(start.heading_deg, truth[columns - 1], 4.0);
        }
        most_deg = std::max({most_deg, std::abs(*row.roll_deg - truth[columns - 3]),
                             std::abs(*row.pitch_deg - truth[columns - 2])});
    }
    EXPECT_GE(known, attitude.rows.size() - 10);
    EXPECT_LT(most_deg, 0.06);
    const CertifiableWindow best = example.window();
    const auto place = [&](double time_s) {
        const auto truth =
            numbers_of(lines.at(static_cast<std::size_t>(std::llround(10.0 * time_s)) + 2), ',');
        return Eigen::Vector2d(truth[1], truth[2]);
    };
    const double start_s = best.span.start.seconds(), duration_s = best.span.duration.seconds();
    EXPECT_NEAR(best.speed_m_s, (place(start_s + duration_s) - place(start_s)).norm() / duration_s,
                2.0 * best.standard_uncertainty_m_s);
    // The window's stage solves again from the same start.
    const ProcessResult verified = runcert({"verify", example.run().string(), "--recompute"});
    EXPECT_NE(verified.exit_status, 2) << verified.errors;
    EXPECT_NE(verified.output.find("identical: all 9 files"), std::string::npos) << verified.output;
    const ProcessResult audit = runcert({"audit", example.run().string()});
    EXPECT_NE(audit.output.find("the surface under the craft, and the course along it"),
              std::string::npos)
        << audit.output;
    EXPECT_NE(attitude.mount.judgement.find("The axes are as stated."), std::string::npos)
        << attitude.mount.judgement;
}

TEST(OvalExample, TheMountOfTheBoxIsFoundAgainstTheSurface) {
    // The IMU's axes are the craft's; the attempt says that they are turned.
    const OvalExample example([](const std::string& attempt) {
        return replaced(attempt, "      grade: tactical\n",
                        "      grade: tactical\n      mount_deg: {roll: 1.5, pitch: -2, yaw: 3}\n");
    });
    const AttitudeTable attitude = example.attitude();
    const Eigen::Matrix3d level = rotation_of({});
    const Eigen::Matrix3d stated =
        level.transpose() * rotation_of({1.5 * rad, -2.0 * rad, 3.0 * rad});
    const EulerAngles remains = euler_angles(level * stated.transpose());
    ASSERT_TRUE(attitude.mount.on_surface);
    const MountAngles& found = *attitude.mount.on_surface;
    EXPECT_NEAR(found.roll, remains.roll / rad, 0.2);
    EXPECT_NEAR(found.pitch, remains.pitch / rad, 0.2);
    EXPECT_NEAR(found.yaw, std::remainder(remains.heading / rad, 360.0), 0.2);
    EXPECT_NEAR(attitude.mount.sigma_on_surface->roll, 0.2, 0.05);
    EXPECT_NE(attitude.mount.judgement.find("The axes are not as stated"), std::string::npos)
        << attitude.mount.judgement;
    // Against the level the bank of the straight, 3 degrees, is in the roll.
    EXPECT_NEAR(attitude.mount.remaining->roll - found.roll, -3.0, 0.35);
}

TEST(OvalExample, AWrongSurfaceLeavesSpeedAndAttitudeAsTheyAre) {
    const auto without = [](const std::string& attempt) {
        const std::size_t from = attempt.find("    surface:\n"), to = attempt.find("\norigin:");
        return attempt.substr(0, from) + attempt.substr(to + 1);
    };
    const OvalExample none(without);
    EXPECT_EQ(none.attitude().consistency.start, InertialStart::course);
    EXPECT_FALSE(none.attitude().mount.on_surface);
    EXPECT_EQ(read_file(none.run() / "4-attitude.ecsv").find("surface"), std::string::npos);
    const CertifiableWindow expected = none.window();
    for (const double turned_deg : {0.0, 5.0, -5.0}) {
        // Stated so roughly that no height is marked for it.
        const OvalExample example(
            [](const std::string& attempt) {
                return replaced(attempt, "vertical_sd_m: 0.02", "vertical_sd_m: 0.1");
            },
            [&](const std::string& survey) { return turned_across(survey, turned_deg * rad); });
        EXPECT_EQ(example.attitude().consistency.start, InertialStart::surface) << turned_deg;
        const CertifiableWindow found = example.window();
        EXPECT_EQ(found.span.start.nanoseconds, expected.span.start.nanoseconds) << turned_deg;
        EXPECT_EQ(found.speed_m_s, expected.speed_m_s) << turned_deg;
        EXPECT_NEAR(*found.points.reference_point_speed_m_s,
                    *expected.points.reference_point_speed_m_s,
                    1e-3 * *expected.points.reference_point_expanded_uncertainty_m_s)
            << turned_deg;
        // The axes that such a surface shows are turned by as much.
        ASSERT_TRUE(example.attitude().mount.on_surface);
        EXPECT_NEAR(example.attitude().mount.on_surface->roll, turned_deg, 0.3);
    }
}

TEST(OvalExample, ATapeAndAFrameThatAreWrongAreSaid) {
    const OvalExample lower([](const std::string& attempt) {
        return replaced(attempt, "antenna_height_m: 1.5", "antenna_height_m: 1.2");
    });
    const std::string verdict = read_file(lower.run() / "6-verdict.yaml");
    EXPECT_NE(verdict.find("is 0.28 m above where surface and antenna height have it"),
              std::string::npos);
    TemporaryFolder folder;
    fs::copy(examples / "oval", folder.path() / "oval");
    write_file_atomically(folder.path() / "oval/attempt.yaml",
                          replaced(read_file(examples / "oval/attempt.yaml"), "frame: local_plane",
                                   "frame: geodetic\n      heights: ellipsoid"));
    const ProcessResult refused =
        certify(folder.path() / "oval/attempt.yaml", folder.path() / "run", {"--no-render"});
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_NE(refused.errors.find("not where coordinates of that frame are"), std::string::npos)
        << refused.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE

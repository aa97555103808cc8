// Geodesy against PROJ's `cct` (package proj-bin), an implementation that shares nothing with
// GeographicLib's but the ellipsoid.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "core/random.h"
#include "core/text.h"

namespace runcert::RUNCERT_FILE {
namespace {

bool have_cct() {
    return std::system("cct --version >/dev/null 2>&1") == 0;
}

/// The first three numbers of each line that `cct` answers to the points.
std::vector<Eigen::Vector3d> run_cct(const std::string& operation,
                                     const std::vector<Eigen::Vector3d>& points) {
    const std::string base =
        (std::filesystem::temp_directory_path() / fmt::format("runcert_cct_{}", getpid())).string();
    {
        std::ofstream in(base + ".in");
        for (const auto& p : points)
            in << fmt::format("{:.14f} {:.14f} {:.9f} 0\n", p[0], p[1], p[2]);
    }
    const std::string command = fmt::format("cct -d 12 {0} '{1}.in' > '{1}.out'", operation, base);
    if (std::system(command.c_str()) != 0) ADD_FAILURE() << command;
    std::vector<Eigen::Vector3d> answers;
    std::ifstream out(base + ".out");
    for (std::string line; std::getline(out, line);) {
        std::istringstream fields(line);
        std::array<std::string, 3> f;
        fields >> f[0] >> f[1] >> f[2];
        answers.emplace_back(parse_double(f[0]).value(), parse_double(f[1]).value(),
                             parse_double(f[2]).value());
    }
    std::filesystem::remove(base + ".in");
    std::filesystem::remove(base + ".out");
    return answers;
}

Geodetic geodetic(const Eigen::Vector3d& longitude_latitude_height) {
    return {Angle::from_degrees(longitude_latitude_height[1]),
            Angle::from_degrees(longitude_latitude_height[0]), longitude_latitude_height[2]};
}

TEST(GeodesyAgainstProj, LocalFrame) {
    if (!have_cct()) GTEST_SKIP() << "cct (proj-bin) is not installed";
    const Eigen::Vector3d origins[] = {{136.977574275, 35.134709483, 104.728},
                                       {136.5, -30.9, 0.0},
                                       {-0.1, 51.5, 50.0},
                                       {-68.3, -54.8, 10.0},
                                       {15.6, 78.2, 500.0},
                                       {179.99, 10.0, -20.0},
                                       {0.0, 0.0, 0.0}};
    RandomGenerator random(31);
    double worst_m = 0.0;
    for (const Eigen::Vector3d& o : origins) {
        // Up to 20 km away; the origin itself first.
        std::vector<Eigen::Vector3d> points = {o};
        for (int i = 0; i < 300; ++i) {
            const double distance_deg = 0.18 * random.uniform();
            const double bearing = 6.283185307179586 * random.uniform();
            points.emplace_back(
                o[0] + distance_deg * std::sin(bearing) / std::cos(geodetic(o).latitude.radians()),
                o[1] + distance_deg * std::cos(bearing), 2000 * random.uniform() - 200);
        }
        const auto expected = run_cct(
            fmt::format("+proj=pipeline +step +proj=cart +ellps=WGS84 +step +proj=topocentric "
                        "+ellps=WGS84 +lon_0={} +lat_0={} +h_0={}",
                        o[0], o[1], o[2]),
            points);
        ASSERT_EQ(expected.size(), points.size());
        const LocalFrame frame(geodetic(o));
        for (std::size_t i = 0; i < points.size(); ++i)
            worst_m = std::max(
                worst_m, (frame.enu_from_geodetic(geodetic(points[i])).m - expected[i]).norm());
    }
    RecordProperty("worst_mm", fmt::format("{:.3g}", 1e3 * worst_m));
    EXPECT_LT(worst_m, 1e-8);
}

TEST(GeodesyAgainstProj, Ecef) {
    if (!have_cct()) GTEST_SKIP() << "cct (proj-bin) is not installed";
    RandomGenerator random(32);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 500; ++i)
        points.emplace_back(360 * random.uniform() - 180, 180 * random.uniform() - 90,
                            9000 * random.uniform() - 400);
    const auto expected = run_cct("+proj=cart +ellps=WGS84", points);
    ASSERT_EQ(expected.size(), points.size());
    double worst_m = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
        worst_m =
            std::max(worst_m, (ecef_from_geodetic(geodetic(points[i])).m - expected[i]).norm());
    RecordProperty("worst_mm", fmt::format("{:.3g}", 1e3 * worst_m));
    EXPECT_LT(worst_m, 1e-8);
}

TEST(GeodesyAgainstProj, Utm) {
    if (!have_cct()) GTEST_SKIP() << "cct (proj-bin) is not installed";
    RandomGenerator random(33);
    double worst_m = 0.0;
    double worst_back_m = 0.0;
    for (const UtmZone zone :
         {UtmZone{55, false}, {54, false}, {53, true}, {30, true}, {1, false}, {60, true}}) {
        std::vector<Eigen::Vector3d> points;
        for (int i = 0; i < 200; ++i) {
            const double latitude_deg = 0.01 + 83 * random.uniform();
            points.emplace_back(6 * zone.zone - 183 + 7 * random.uniform() - 3.5,
                                zone.northern ? latitude_deg : -latitude_deg, 0.0);
        }
        const auto expected = run_cct(fmt::format("+proj=utm +ellps=WGS84 +zone={}{}", zone.zone,
                                                  zone.northern ? "" : " +south"),
                                      points);
        ASSERT_EQ(expected.size(), points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const UtmCoordinates utm = utm_from_geodetic(zone, geodetic(points[i]));
            worst_m = std::max(worst_m, std::hypot(utm.easting_m - expected[i][0],
                                                   utm.northing_m - expected[i][1]));
            const Geodetic back =
                geodetic_from_utm(zone, expected[i][0], expected[i][1], points[i][2]);
            worst_back_m = std::max(
                worst_back_m,
                (ecef_from_geodetic(back).m - ecef_from_geodetic(geodetic(points[i])).m).norm());
        }
    }
    RecordProperty("worst_mm", fmt::format("{:.3g}", 1e3 * worst_m));
    RecordProperty("worst_back_mm", fmt::format("{:.3g}", 1e3 * worst_back_m));
    EXPECT_LT(worst_m, 2e-8);
    EXPECT_LT(worst_back_m, 2e-8);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

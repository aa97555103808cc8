#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "chain_support.h"
#include "core/geodesy.h"
#include "core/text.h"
#include "schemas/trajectory/declared.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

// Real recordings, certified, and the reference that one of them has. They lie in the folder
// RUNCERT_DATA.

namespace runcert::chain {

struct Tables {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    YamlValue verdict;
};

inline constexpr const char* base_station =
    "origin: {latitude_deg: 35.134709483, longitude_deg: 136.977574275, height_m: 104.728}\n";

inline Tables certified_anew(const fs::path& recording, const std::string& more) {
    const TemporaryFolder folder;
    write_file_atomically(
        folder.path() / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: recorded\ncraft: {{name: car, class: car}}\n"
                    "receivers: [{{id: primary, recording: \"{}\"}}]\nprofiles: [nalsa]\n{}",
                    bring(recording, folder.path()), more));
    const fs::path run = folder.path() / "run";
    const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    return {read_screened(read_file(run / "3-screened.ecsv"), "3-screened.ecsv"),
            read_trajectory(read_file(run / "4-trajectory.ecsv"), "4-trajectory.ecsv"),
            read_yaml(run / "6-verdict.yaml")};
}

/// The same once for all tests of the process.
inline const Tables& certified(const fs::path& recording, const std::string& more = {}) {
    static std::map<std::pair<fs::path, std::string>, Tables> made;
    const auto key = std::pair(recording, more);
    const auto found = made.find(key);
    return found != made.end() ? found->second
                               : made.emplace(key, certified_anew(recording, more)).first->second;
}

/// Positions of the reference by GPS time of week in milliseconds, in the run's local frame.
inline std::map<std::int64_t, Eigen::Vector2d> reference_positions(const fs::path& file,
                                                                   const LocalFrame& frame) {
    std::map<std::int64_t, Eigen::Vector2d> positions;
    std::istringstream lines(read_file(file));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream cells(line);
        std::vector<double> values;
        for (std::string cell; std::getline(cells, cell, ',');)
            values.push_back(parse_double(trim(cell)).value());
        positions[std::llround(values.at(0) * 1e3)] =
            frame.enu_from_ecef({{values.at(5), values.at(6), values.at(7)}}).m.head<2>();
    }
    return positions;
}

/// The certifiable windows of an arc: usable at every row from the first to the last.
inline std::vector<EpochPair> certifiable(const ScreenedTable& screened, const Arc<2>& arc) {
    std::vector<ElapsedTime> times;
    for (const std::size_t row : arc.rows)
        times.push_back(screened.rows[row].time);
    const auto ends = window_ends(times, 3.0, 0.001, screened.facts.nominal_interval_s);
    std::vector<EpochPair> windows;
    for (std::size_t first = 0; first < ends.size(); ++first) {
        bool usable = ends[first].has_value();
        for (std::size_t row = arc.rows[first]; usable && row <= arc.rows[*ends[first]]; ++row)
            usable = screened.rows[row].usable;
        if (usable) windows.push_back({first, *ends[first]});
    }
    return windows;
}

/// The base station of the urban car, as the origin of its frame.
inline LocalFrame urban_frame() {
    return LocalFrame({.latitude = Angle::from_degrees(35.134709483),
                       .longitude = Angle::from_degrees(136.977574275),
                       .height_m = 104.728});
}

/// The reference's position at a time of the table.
inline Eigen::Vector2d position_at(const std::map<std::int64_t, Eigen::Vector2d>& reference,
                                   const RecordingFacts& facts, ElapsedTime time) {
    const GpsTime at = facts.first_epoch.value().plus_nanoseconds(time.nanoseconds);
    return reference.at(std::llround(static_cast<double>(at.nanoseconds_of_week()) * 1e-6));
}

}  // namespace runcert::chain

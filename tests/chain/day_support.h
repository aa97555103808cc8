#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/random.h"
#include "simulation/recording_text.h"
#include "simulation/simulate.h"

// Days of simulated recordings, for tests of what handles many attempts. Links with
// runcert_simulation.

namespace runcert::chain {

/// A run that a receiver saw at 10 Hz: another for every seed, within what a land yacht can do.
inline SimulationSpec random_run(std::uint64_t seed, int epochs) {
    RandomGenerator random(seed);
    const auto between = [&random](double low, double high) {
        return low + (high - low) * random.uniform();
    };
    SimulationSpec spec;
    const double top_m_s = between(45.0, 65.0);
    // However long the recording, the run is one of its last half minute, so that the tangent plane
    // that it is made in stays level.
    const double duration_s = (epochs - 1) / 10.0;
    const double half_time_s = std::max(0.4 * duration_s, duration_s - 25.0);
    // The logistic's largest acceleration is A r / 4.
    const double rate_per_s = 4.0 * between(3.0, 6.0) / top_m_s;
    spec.run = {.top_speed_m_s = top_m_s,
                .start_speed_m_s = top_m_s / (1.0 + std::exp(rate_per_s * half_time_s)),
                .half_speed_time_s = half_time_s,
                .duration_s = duration_s};
    spec.run.bearing_deg = between(0.0, 360.0);
    spec.place = Geodetic{.latitude = Angle::from_degrees(-31.6),
                          .longitude = Angle::from_degrees(136.0),
                          .height_m = 110.0};
    spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
    spec.white_noise = {.horizontal_m = 0.003, .vertical_m = 0.006};
    spec.correlated_error = {.horizontal_m = 0.006, .vertical_m = 0.012, .correlation_time_s = 1.5};
    spec.seed = static_cast<std::int64_t>(seed);
    spec.recording = {.decimals_m = 4,
                      .decimals_deg = 9,
                      .accuracy = {.horizontal_m = 0.0067, .vertical_m = 0.0134}};
    return spec;
}

/// Makes a day of `count` attempts, run-0001 and so on, each with a recording of its own of so many
/// epochs at 10 Hz (at least 100), and returns its file, FOLDER/day.yaml. The same bytes each time.
inline std::filesystem::path make_day(const std::filesystem::path& folder, int count, int epochs) {
    std::filesystem::create_directories(folder / "recordings");
    std::string attempts;
    for (int i = 1; i <= count; ++i) {
        const SimulationSpec spec = random_run(static_cast<std::uint64_t>(i), epochs);
        std::ofstream(folder / fmt::format("recordings/{:04}.pos", i), std::ios::binary)
            << rtklib_pos_text(spec, simulate(spec));
        attempts += fmt::format("  - {{id: run-{0:04}, recording: recordings/{0:04}.pos}}\n", i);
    }
    std::ofstream(folder / "day.yaml", std::ios::binary)
        << "schema: day/1.0\n"
           "id: simulated-day\n"
           "defaults:\n"
           "  craft: {name: simulated, class: land-yacht}\n"
           "  officials: [{role: measurer}]\n"
           "  record: {speed: 202.9, unit: km/h, source: \"NALSA, 2009\"}\n"
           "  profiles: [nalsa]\n"
           "attempts:\n"
        << attempts;
    return folder / "day.yaml";
}

}  // namespace runcert::chain

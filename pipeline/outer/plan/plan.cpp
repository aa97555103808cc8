#include "plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <map>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "core/text.h"
#include "run/chain.h"
#include "schemas/profile/profile.h"
#include "schemas/verdict/declared.h"
#include "simulation/recording_text.h"
#include "simulation/simulate.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store/yaml_output.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double half_speed_s = 25.0, duration_s = 75.0;
constexpr double fixed_best_m = 0.05;  ///< worse positions are not of fixed ambiguities
constexpr const char* recording_name = "recording.csv";
constexpr const char* wheel_name = "wheel.csv";

SimulationSpec spec_of(const PlannedEquipment& equipment, const PlannedRun& run,
                       std::int64_t seed) {
    constexpr double white_share = 0.2;
    SimulationSpec spec;
    spec.run.top_speed_m_s = run.speed_m_s;
    spec.run.start_speed_m_s = 0.1;
    spec.run.half_speed_time_s = half_speed_s;
    spec.run.duration_s = duration_s;
    spec.run.rate_hz = equipment.rate_hz;
    spec.seed = seed;
    spec.start_gps = GpsTime::from_calendar({2026, 3, 14, 3, 20, 18, 0});
    const double white_m = std::sqrt(white_share) * equipment.accuracy_m;
    const double correlated_m = std::sqrt(1.0 - white_share) * equipment.accuracy_m;
    spec.white_noise = {.horizontal_m = white_m, .vertical_m = 2.0 * white_m};
    spec.correlated_error = {
        .horizontal_m = correlated_m, .vertical_m = 2.0 * correlated_m, .correlation_time_s = 1.5};
    return spec;
}

/// Geodetic coordinates, and velocities where they are recorded.
std::string recording_text(const PlannedEquipment& equipment, const SimulationSpec& spec,
                           std::span<const SimulatedEpoch> epochs, const Geodetic& origin) {
    const LocalFrame frame(origin);
    RandomGenerator random(static_cast<std::uint64_t>(spec.seed) + 7'000'003);
    const Eigen::Vector3d along = direction_of(spec.run);
    std::string text = "time_s,latitude,longitude,height,velocity_east,velocity_north\n";
    for (const SimulatedEpoch& epoch : epochs) {
        const Eigen::Vector3d& enu = epoch.measured_enu_m;
        const Geodetic at = frame.geodetic_from_enu({{enu[0], enu[1], enu[2]}});
        text += fmt::format("{:.3f},{:.10f},{:.10f},{:.4f}", epoch.time_s(), at.latitude.degrees(),
                            at.longitude.degrees(), at.height_m);
        for (const int axis : {0, 1})
            text += equipment.velocities_m_s
                        ? fmt::format(",{:.4f}", epoch.truth.speed_m_s * along[axis] +
                                                     *equipment.velocities_m_s * random.normal())
                        : ",";
        text += '\n';
    }
    return text;
}

Json receiver_of(const PlannedEquipment& equipment, const SimulationSpec& spec) {
    Json columns{{"time", "time_s"},
                 {"latitude", "latitude"},
                 {"longitude", "longitude"},
                 {"height", "height"}};
    Json accuracy{{"horizontal_m", equipment.accuracy_m},
                  {"vertical_m", std::min(10.0, 2.0 * equipment.accuracy_m)}};
    if (equipment.velocities_m_s) {
        columns["velocity_east"] = "velocity_east";
        columns["velocity_north"] = "velocity_north";
        accuracy["velocity_mps"] = *equipment.velocities_m_s;
    }
    return {{"id", "primary"},
            {"recording", recording_name},
            {"format", "csv"},
            {"columns", columns},
            {"frame", "geodetic"},
            {"start_gps", to_iso(*spec.start_gps, 3)},
            {"time_source", "satellites"},
            {"solution", equipment.accuracy_m <= fixed_best_m ? "fixed" : "single"},
            {"accuracy", accuracy}};
}

std::string attempt_text(const PlannedEquipment& equipment, const PlannedRun& run,
                         const SimulationSpec& spec, const Geodetic& origin) {
    Json attempt{{"schema", "attempt/1.0"},
                 {"id", "planned"},
                 {"craft", {{"name", "planned"}, {"class", run.craft_class}}},
                 {"date", "2026-03-14"},
                 {"receivers", Json::array({receiver_of(equipment, spec)})},
                 {"origin",
                  {{"latitude_deg", origin.latitude.degrees()},
                   {"longitude_deg", origin.longitude.degrees()},
                   {"height_m", origin.height_m}}},
                 {"record", {{"speed", run.record_m_s}, {"unit", "m/s"}, {"source", "planned"}}},
                 {"profiles", Json::array({run.rule})}};
    if (equipment.accuracy_m > fixed_best_m)
        attempt["parameters"] = {{"screen", {{"allowed_fixes", Json::array({"single"})}}}};
    if (equipment.wheel_m_s) attempt["wheel"] = {{"file", wheel_name}, {"source", "a wheel"}};
    return to_yaml_text(attempt);
}

/// The verdict of the stages on what is in a folder.
Verdict verdict_of(const fs::path& folder, const std::string& text, const fs::path& programs) {
    const fs::path file = folder / "attempt.yaml";
    const Attempt attempt = read_attempt(text, file.string());
    const RunInMaking run{.attempt = attempt,
                          .text = text,
                          .source = {.file = file},
                          .folder = folder / "run",
                          .known_as = folder,
                          .programs = programs};
    make_directory(run.folder);
    try {
        make_run(
            run, [](const Step& step) { return step.products.empty() && step.name != "claim"; },
            [](const StageDone&) {});
    } catch (const StageFailed& failed) {
        throw Failure("the simulated attempt", message_of(failed),
                      "Ask for other equipment or another speed");
    }
    const fs::path verdict = run.folder / products::verdict_file;
    return read_verdict(read_file(verdict), verdict.string());
}

Prospect prospect_of(const ProfileVerdict& verdict) {
    Prospect prospect{.speed_m_s = verdict.speed_m_s,
                      .expanded_uncertainty_m_s = verdict.expanded_uncertainty_m_s,
                      .required_speed_m_s = verdict.required_speed_m_s.value_or(0.0),
                      .proven = verdict.outcome == Outcome::beaten,
                      .reason = verdict.reason};
    if (verdict.decision)
        prospect.margin_m_s = verdict.decision->acceptance_limit_m_s - prospect.required_speed_m_s;
    std::map<std::string, int> roles;
    for (const Requirement& one : verdict.requirements) {
        if (one.status == RequirementStatus::not_met)
            prospect.not_met.push_back(one.clause + ": " + one.evidence);
        if (one.status == RequirementStatus::attest)
            ++roles[one.answered_by ? one.answered_by->role : "judge"];
    }
    for (const auto& [role, count] : roles)
        prospect.to_attest.push_back(fmt::format("{} by {}", count, role));
    return prospect;
}

/// Failure where no simulated run holds a window of the rule.
void require_short_window(const std::string& rule) {
    const Profile profile = read_profile(std::string(builtin_profile(rule)), rule);
    const double longest_s = 0.4 * duration_s;
    if (!profile.evidence && profile.window_kind == WindowKind::time &&
        profile.duration_s <= longest_s)
        return;
    throw Failure(
        "--rule",
        fmt::format("the rule {} does not measure one window of at most {:g} s", rule, longest_s),
        "Plan by a rule of a few seconds; for others, simulate an attempt and certify it");
}

}  // namespace

double formula_uncertainty_m_s(const PlannedEquipment& equipment) {
    return 2.0 * equipment.accuracy_m * static_cast<double>(equipment.rate_hz) / std::sqrt(2.0);
}

Prospect simulate_prospect(const PlannedEquipment& equipment, const PlannedRun& run,
                           std::int64_t seed) {
    require_short_window(run.rule);
    const Geodetic origin{.latitude = Angle::from_degrees(-31.6),
                          .longitude = Angle::from_degrees(136.0),
                          .height_m = 110.0};
    const SimulationSpec spec = spec_of(equipment, run, seed);
    const std::vector<SimulatedEpoch> epochs = simulate(spec);
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / recording_name,
                          recording_text(equipment, spec, epochs, origin));
    if (equipment.wheel_m_s) {
        SimulatedWheel wheel;
        wheel.noise_m_s = *equipment.wheel_m_s;
        write_file_atomically(
            folder.path() / wheel_name,
            wheel_csv_text(simulate_wheel(wheel, static_cast<std::uint64_t>(seed), epochs), epochs,
                           spec.start_gps));
    }
    return prospect_of(
        verdict_of(folder.path(), attempt_text(equipment, run, spec, origin), run.programs)
            .profiles.front());
}

Prospect median_prospect(const PlannedEquipment& equipment, const PlannedRun& run, int attempts) {
    std::vector<std::future<Prospect>> begun;  // side by side: each waits for programs
    for (int seed = 1; seed <= attempts; ++seed)
        begun.push_back(std::async(std::launch::async, simulate_prospect, equipment, run, seed));
    std::vector<Prospect> all;
    for (std::future<Prospect>& one : begun)
        all.push_back(one.get());
    const auto middle = all.begin() + attempts / 2;
    std::nth_element(all.begin(), middle, all.end(), [](const Prospect& a, const Prospect& b) {
        constexpr double never = 1e9;  // what cannot be certified comes last
        return a.expanded_uncertainty_m_s.value_or(never) <
               b.expanded_uncertainty_m_s.value_or(never);
    });
    middle->proven = 2 * std::ranges::count(all, true, &Prospect::proven) > attempts;
    return *middle;
}

std::vector<std::string> other_equipment(const PlannedEquipment& equipment, const PlannedRun& run,
                                         bool proves) {
    constexpr std::array accuracies_m{0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0};
    constexpr std::array<std::int64_t, 8> rates_hz{25, 20, 10, 8, 5, 4, 2, 1};
    constexpr double good_velocities_m_s = 0.05;
    const auto would = [&](const PlannedEquipment& other) {
        return median_prospect(other, run, planned_attempts).proven;
    };
    std::optional<double> accuracy_m;
    for (const double one : accuracies_m) {
        if ((one > equipment.accuracy_m) != proves) continue;
        PlannedEquipment other = equipment;
        other.accuracy_m = one;
        if (!would(other)) break;
        accuracy_m = one;
    }
    std::optional<std::int64_t> rate_hz;
    for (const std::int64_t one : rates_hz) {
        if (!proves || one >= equipment.rate_hz) continue;
        PlannedEquipment other = equipment;
        other.rate_hz = one;
        if (!would(other)) break;
        rate_hz = one;
    }
    std::vector<std::string> words;
    if (accuracy_m) words.push_back(fmt::format("positions to {:g} m", *accuracy_m));
    if (rate_hz) words.push_back(fmt::format("{} Hz", *rate_hz));
    if (!proves && !equipment.velocities_m_s) {
        PlannedEquipment other = equipment;
        other.velocities_m_s = good_velocities_m_s;
        if (would(other))
            words.push_back(fmt::format("velocities good to {:g} m/s", good_velocities_m_s));
    }
    return words;
}

}  // namespace runcert

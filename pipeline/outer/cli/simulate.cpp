#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/failure.h"
#include "outer_commands.h"
#include "schemas/attempt/attempt.h"
#include "schemas/simulation/simulation.h"
#include "simulation/course_surface.h"
#include "simulation/raw_measurements.h"
#include "simulation/recording_text.h"
#include "stages/import/rinex/rinex.h"
#include "store/atomic_file.h"
#include "store/yaml_output.h"
#include "witness/inertial_input.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* raw_name = "raw.obs";
constexpr const char* navigation_name = "broadcast.nav";
constexpr const char* imu_name = "imu.csv";
constexpr const char* wheel_name = "wheel.csv";
constexpr const char* surface_name = "surface.xml";

std::string recording_name(const SimulationSpec& spec) {
    return spec.place ? "recording.pos" : "recording.csv";
}

Json plane_columns(const SimulationSpec& spec) {
    Json columns = {{"time", "time_s"}, {"east", "east_m"}, {"north", "north_m"}};
    columns["up"] = spec.recording.with_up ? Json("up_m") : Json(nullptr);
    if (!spec.faults.float_fixes.empty()) columns["fix"] = "fix";
    return columns;
}

LeverArm sum(const LeverArm& a, const LeverArm& b, double sign = 1.0) {
    return {a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]};
}

/// Where a tape found antenna and reference point, and the IMU that was recorded.
void add_craft(const SimulatedCraft& craft, const std::optional<SimulatedImu>& imu,
               Json& receiver) {
    const LeverArm antenna = sum(craft.antenna, craft.tape_error);
    if (!imu) {
        // The leeway varies by a fifth.
        receiver["antenna_motion"] = {
            {"height_m", std::max(0.0, sum(craft.reference_point, antenna, -1.0)[2])},
            {"roll_deg", craft.roll.amplitude_deg},
            {"pitch_deg", craft.pitch.amplitude_deg},
            {"roll_period_s", 1.0 / craft.roll.frequency_hz},
            {"leeway_deg", 1.2 * std::abs(craft.leeway_deg)}};
        return;
    }
    receiver["imu"] = {{"file", imu_name},
                       {"columns",
                        {{"time", "time_s"},
                         {"gyro_x", "gx"},
                         {"gyro_y", "gy"},
                         {"gyro_z", "gz"},
                         {"accelerometer_x", "ax"},
                         {"accelerometer_y", "ay"},
                         {"accelerometer_z", "az"}}},
                       {"axes", {{"x", "forward"}, {"y", "right"}, {"z", "down"}}},
                       {"gyro_unit", "rad/s"},
                       {"accelerometer_unit", "m/s2"},
                       {"samples", "interval_end"},
                       {"grade", members_json(imu->grade)},
                       {"antenna_m", members_json(antenna)},
                       {"reference_point_m", members_json(craft.reference_point)}};
}

Json receiver_of(const SimulationSpec& spec) {
    Json receiver = {{"id", "primary"}, {"recording", recording_name(spec)}};
    if (spec.place) {
        receiver["format"] = "rtklib-pos";
        if (spec.raw) {
            receiver["phase"] = raw_name;
            receiver["navigation"] = navigation_name;
        }
        if (spec.craft) add_craft(*spec.craft, spec.imu, receiver);
        if (spec.surface) {
            constexpr double least_stated_m = 0.001;
            receiver["antenna_height_m"] =
                spec.surface->below_m - spec.craft->antenna[2] - spec.craft->tape_error[2];
            receiver["surface"] = {
                {"file", surface_name},
                {"frame", "local_plane"},
                {"vertical_sd_m", std::max(spec.surface->vertical_sd_m, least_stated_m)},
                {"tilt_max_deg", std::min(90.0, std::ceil(spec.craft->roll.amplitude_deg +
                                                          spec.craft->pitch.amplitude_deg))},
                {"source", "a survey, simulated"}};
        }
        return receiver;
    }
    receiver["format"] = "csv";
    receiver["columns"] = plane_columns(spec);
    receiver["frame"] = "local_plane";
    if (spec.faults.float_fixes.empty()) receiver["solution"] = "fixed";
    receiver["accuracy"] = {{"horizontal_m", spec.recording.accuracy.horizontal_m}};
    if (spec.recording.with_up)
        receiver["accuracy"]["vertical_m"] = spec.recording.accuracy.vertical_m;
    if (spec.start_gps) receiver["start_gps"] = to_iso(*spec.start_gps, 3);
    return receiver;
}

Json wheel_of(const SimulatedWheel& wheel) {
    Json series = {{"file", wheel_name}, {"source", "a wheel, simulated"}};
    if (wheel.stated_scale) {
        series["scale"] = *wheel.stated_scale;
        series["expanded_uncertainty_scale"] = wheel.expanded_uncertainty_scale.value();
    }
    return series;
}

/// The attempt that certifies the recording as it stands. What an attempt's field table refuses of
/// the spec's own part is a Failure at that part.
std::string attempt_text(const SimulationDocument& simulation) {
    Json said = simulation.attempt;
    const auto make = [&](const char* key, Json value) {
        if (said.contains(key))
            throw Failure(simulation.attempt_place,
                          fmt::format("the attempt: \"{}\" follows from the simulation", key),
                          "Remove it");
        said[key] = std::move(value);
    };
    make("schema", attempt_schema().name() + "/" + attempt_schema().version());
    make("receivers", Json::array({receiver_of(simulation)}));
    if (simulation.place)
        make("origin", {{"latitude_deg", simulation.place->latitude.degrees()},
                        {"longitude_deg", simulation.place->longitude.degrees()},
                        {"height_m", simulation.place->height_m}});
    if (simulation.wheel) make("wheel", wheel_of(*simulation.wheel));
    Json attempt;
    for (const FieldRule& rule : attempt_schema().fields())
        if (said.contains(rule.path)) attempt[rule.path] = said[rule.path];
    attempt.update(said);  // what is no key of it, too, which is refused below
    std::string text =
        "# Written by runcert simulate: the recording is simulated.\n" + to_yaml_text(attempt);
    try {
        (void)read_attempt(text, "attempt.yaml");
    } catch (const Failure& failure) {
        throw Failure(simulation.attempt_place, "the attempt: " + failure.problem(),
                      failure.remedy());
    }
    return text;
}

using NewFile = std::pair<std::string, std::string>;  ///< its name and its text

/// Writes all or, where one exists already, none: a genuine recording may have the name.
void write_new_files(const fs::path& folder, const std::vector<NewFile>& files) {
    for (const auto& [name, text] : files)
        if (fs::exists(folder / name))
            throw Failure((folder / name).string(), "the file exists already",
                          "Name another folder, or remove the file");
    make_directory(folder);
    for (const auto& [name, text] : files)
        write_file_atomically(folder / name, text);
}

struct SimulateOptions {
    std::string spec, out;
};

int simulate_to_folder(const SimulateOptions& options) {
    const std::string& spec_file = options.spec;
    const fs::path folder = options.out;
    const SimulationDocument simulation = read_simulation(read_handwritten(spec_file), spec_file);
    const std::vector<SimulatedEpoch> epochs = simulate(simulation);
    std::vector<NewFile> files{
        {recording_name(simulation), simulation.place ? rtklib_pos_text(simulation, epochs)
                                                      : plane_csv_text(simulation, epochs)},
        {"truth.csv", truth_csv_text(epochs)},
        {"attempt.yaml", attempt_text(simulation)}};
    if (simulation.raw) {
        const fs::path navigation = fs::path(spec_file).parent_path() / simulation.raw->navigation;
        const std::string broadcast = read_file(navigation);
        const auto orbits =
            rinex::read_navigation({.name = navigation.string(), .bytes = broadcast});
        files.push_back({raw_name, rinex_observations_text(simulation, *simulation.raw, epochs,
                                                           orbits.ephemerides)});
        files.push_back({navigation_name, broadcast});
    }
    if (simulation.imu)
        files.push_back(
            {imu_name, imu_csv_text(simulate_imu(simulation, imu_noise(simulation.imu->grade)),
                                    *simulation.start_gps)});
    if (simulation.surface)
        files.push_back(
            {surface_name, landxml_text(simulate_surface(simulation), *simulation.start_gps)});
    if (simulation.wheel)
        files.push_back(
            {wheel_name,
             wheel_csv_text(simulate_wheel(*simulation.wheel,
                                           static_cast<std::uint64_t>(simulation.seed), epochs),
                            epochs, simulation.start_gps)});
    write_new_files(folder, files);
    fmt::print(
        "recording  {}\n"
        "truth      {}\n"
        "attempt    {}\n"
        "next       runcert certify {}\n",
        (folder / recording_name(simulation)).string(), (folder / "truth.csv").string(),
        (folder / "attempt.yaml").string(), (folder / "attempt.yaml").string());
    return 0;
}

}  // namespace

void add_simulate(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<SimulateOptions>(
        app, chosen, "simulate",
        "Make the recording of a run whose true speed is known, and its attempt",
        simulate_to_folder);
    line.text("SPEC", options.spec, "the simulation's file (YAML)", CommandLine::required);
    line.text("--out", options.out, "folder to write", CommandLine::required);
    line.footer(fmt::format(
        "Writes recording.pos (or recording.csv, in an engineering CRS), truth.csv and "
        "attempt.yaml; with raw: raw.obs and broadcast.nav, with imu: imu.csv, with wheel: "
        "wheel.csv, with surface: surface.xml. Each of them but the orbits, which are real, says "
        "that it is simulated; so "
        "does a report made from them.\n\n"
        "A simulation (schema simulation/1.0; examples/salt_lake/spec.yaml is one):\n\n"
        "  schema: simulation/1.0\n"
        "  run: {{top_speed_m_s: 60, half_speed_time_s: 15, duration_s: 45, rate_hz: 10}}\n"
        "  white_noise: {{horizontal_m: 0.010}}\n\n"
        "Every key:\n{}",
        simulation_schema().field_table()));
}

}  // namespace runcert

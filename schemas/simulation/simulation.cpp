#include "schemas/simulation/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/document.h"

namespace runcert {

YamlNode simulation_field_table_node();

namespace {

using Json = nlohmann::ordered_json;

constexpr double smallest_accuracy_m = 0.0001;  // that attempt/1.0 and a .pos can state

double default_real(std::string_view field) {
    return simulation_schema().find(field)->default_value.real();
}
std::int64_t default_integer(std::string_view field) {
    return simulation_schema().find(field)->default_value.integer();
}

Eigen::Vector3d read_enu(const YamlValue& map) {
    return {map["east_m"].optional_real().value_or(0.0),
            map["north_m"].optional_real().value_or(0.0),
            map["up_m"].optional_real().value_or(0.0)};
}

/// A time of an epoch: milliseconds, because recordings are written with three decimals.
std::int64_t read_milliseconds(const YamlValue& value) {
    const double milliseconds = value.real() * 1000.0;
    if (std::abs(milliseconds - std::round(milliseconds)) > 1e-6)
        value.fail(fmt::format("{} s is no whole number of milliseconds", value.text()),
                   "Give three decimals at most");
    return std::llround(milliseconds);
}

LogisticRun read_run(const YamlValue& run) {
    const LogisticRun logistic{.top_speed_m_s = run["top_speed_m_s"].real(),
                               .start_speed_m_s = run["start_speed_m_s"].optional_real().value_or(
                                   default_real("run.start_speed_m_s")),
                               .half_speed_time_s = run["half_speed_time_s"].real()};
    try {
        require_valid(logistic);
    } catch (const Failure& failure) {
        run.fail(failure.problem(), failure.remedy());
    }
    return logistic;
}

std::int64_t read_interval_ms(const YamlValue& rate) {
    const std::int64_t rate_hz = rate.integer();
    if (1000 % rate_hz != 0)
        rate.fail(fmt::format("epochs at {} Hz are no whole number of milliseconds apart", rate_hz),
                  "Give 1, 2, 4, 5, 8, 10, 20, 25, 40, 50 or 100");
    return 1000 / rate_hz;
}

void read_motion(const YamlValue& run, SimulationSpec& spec) {
    spec.run = read_run(run);
    spec.duration_ms = read_milliseconds(run["duration_s"]);
    spec.interval_ms = read_interval_ms(run["rate_hz"]);
    spec.bearing = Angle::from_degrees(
        run["bearing_deg"].optional_real().value_or(default_real("run.bearing_deg")));
    spec.start_enu_m = read_enu(run["start"]);
}

std::optional<GpsTime> read_start(const YamlValue& value) {
    if (!value.exists()) return std::nullopt;
    try {
        const GpsTime start = parse_gps_iso(value.text());
        if (start.nanoseconds() % 1'000'000 == 0) return start;
    } catch (const Failure& failure) {
        value.fail(failure.problem(), failure.remedy());
    }
    value.fail("the time has a fraction of a millisecond", "Give three decimals at most");
}

void read_place(const YamlValue& document, SimulationSpec& spec) {
    spec.start = read_start(document["start_gps"]);
    const YamlValue place = document["place"];
    if (!place.exists()) return;
    spec.place = Geodetic{.latitude = Angle::from_degrees(place["latitude_deg"].real()),
                          .longitude = Angle::from_degrees(place["longitude_deg"].real()),
                          .height_m = place["height_m"].real()};
    if (!spec.start)
        place.fail("geodetic coordinates are recorded in GPS time, and no start is given",
                   "Add start_gps: \"YYYY-MM-DDTHH:MM:SS.sss\" to the document");
}

ErrorSigmas read_sigmas(const YamlValue& map) {
    if (!map.exists()) return {};
    return {.horizontal_m = map["horizontal_m"].real(),
            .vertical_m = map["vertical_m"].optional_real().value_or(0.0)};
}

void read_errors(const YamlValue& document, SimulationSpec& spec) {
    spec.white = read_sigmas(document["white_noise"]);
    const YamlValue correlated = document["correlated_error"];
    spec.correlated = read_sigmas(correlated);
    if (correlated.exists()) spec.correlation_time_s = correlated["correlation_time_s"].real();
    spec.seed = static_cast<std::uint64_t>(
        document["seed"].optional_integer().value_or(default_integer("seed")));
}

void require_within_run(const YamlValue& time, const SimulationSpec& spec) {
    if (time.real() * 1000.0 > static_cast<double>(spec.duration_ms))
        time.fail(
            fmt::format("{} s is after the end of the run", time.text()),
            fmt::format("Give a time up to {} s", static_cast<double>(spec.duration_ms) / 1000.0));
}

/// The number of the epoch that an outlier names.
std::int64_t read_outlier_epoch(const YamlValue& outlier, const SimulationSpec& spec) {
    const YamlValue epoch = outlier["epoch"];
    const YamlValue time = outlier["time_s"];
    if (epoch.exists() == time.exists())
        outlier.fail("an outlier is named by epoch or by time_s", "Give one of the two");
    if (time.exists()) {
        require_within_run(time, spec);
        const std::int64_t time_ms = read_milliseconds(time);
        if (time_ms % spec.interval_ms != 0)
            time.fail(fmt::format("there is no epoch at {} s", time.text()),
                      fmt::format("Epochs are {} ms apart, from 0 s", spec.interval_ms));
        return time_ms / spec.interval_ms + 1;
    }
    const std::int64_t last = spec.duration_ms / spec.interval_ms + 1;
    if (epoch.integer() > last)
        epoch.fail(fmt::format("there is no epoch {}", epoch.text()),
                   fmt::format("The run has {} epochs", last));
    return epoch.integer();
}

std::vector<TimeStretch> read_stretches(const YamlValue& list, const SimulationSpec& spec) {
    std::vector<TimeStretch> stretches;
    for (const YamlValue& entry : list.list()) {
        require_within_run(entry["from_s"], spec);
        stretches.push_back({.from_s = entry["from_s"].real(), .to_s = entry["to_s"].real()});
        if (stretches.back().to_s <= stretches.back().from_s)
            entry.fail("the stretch ends before it begins, or at once", "Give to_s above from_s");
    }
    return stretches;
}

void read_faults(const YamlValue& faults, SimulationSpec& spec) {
    for (const YamlValue& entry : faults["outliers"].list())
        spec.faults.outliers.push_back(
            {.epoch = read_outlier_epoch(entry, spec), .enu_m = read_enu(entry)});
    for (const YamlValue& entry : faults["steps"].list()) {
        require_within_run(entry["time_s"], spec);
        spec.faults.steps.push_back({.time_s = entry["time_s"].real(), .enu_m = read_enu(entry)});
    }
    for (const YamlValue& entry : faults["ramps"].list()) {
        require_within_run(entry["from_s"], spec);
        spec.faults.ramps.push_back({.from_s = entry["from_s"].real(),
                                     .to_s = entry["to_s"].real(),
                                     .enu_m_s = {entry["east_m_s"].optional_real().value_or(0.0),
                                                 entry["north_m_s"].optional_real().value_or(0.0),
                                                 entry["up_m_s"].optional_real().value_or(0.0)}});
        if (spec.faults.ramps.back().to_s <= spec.faults.ramps.back().from_s)
            entry.fail("the drift ends before it begins, or at once", "Give to_s above from_s");
    }
    spec.faults.gaps = read_stretches(faults["gaps"], spec);
    spec.faults.float_fixes = read_stretches(faults["float_fixes"], spec);
}

void read_recording(const YamlValue& recording, SimulationSpec& spec) {
    RecordingStyle& style = spec.recording;
    style.decimals_m = static_cast<int>(recording["decimals_m"].optional_integer().value_or(
        default_integer("recording.decimals_m")));
    style.decimals_deg = static_cast<int>(recording["decimals_deg"].optional_integer().value_or(
        default_integer("recording.decimals_deg")));
    if (const YamlValue up = recording["up"]; up.exists()) style.with_up = up.boolean();
    if (spec.place && !style.with_up)
        recording["up"].fail("geodetic coordinates are recorded with their heights",
                             "Leave `up` out, or simulate in an engineering CRS, without `place`");
    if (const YamlValue accuracy = recording["accuracy"]; accuracy.exists()) {
        style.accuracy = read_sigmas(accuracy);
        return;
    }
    const auto total = [](double white_m, double correlated_m) {
        return std::max(smallest_accuracy_m,
                        std::sqrt(white_m * white_m + correlated_m * correlated_m));
    };
    style.accuracy = {.horizontal_m = total(spec.white.horizontal_m, spec.correlated.horizontal_m),
                      .vertical_m = total(spec.white.vertical_m, spec.correlated.vertical_m)};
}

Satellite read_satellite(const YamlValue& value) {
    Satellite satellite;
    if (!from_text(value.text(), satellite))
        value.fail(fmt::format("\"{}\" is no satellite", escape_for_message(value.text())),
                   "Name it as RINEX does: G02, E11");
    return satellite;
}

std::vector<SatelliteStretch> read_satellite_stretches(const YamlValue& list,
                                                       const SimulationSpec& spec) {
    std::vector<SatelliteStretch> stretches;
    const std::vector<TimeStretch> times = read_stretches(list, spec);
    std::size_t i = 0;
    for (const YamlValue& entry : list.list())
        stretches.push_back(
            {.stretch = times[i++], .satellite = read_satellite(entry["satellite"])});
    return stretches;
}

RawSpec read_raw(const YamlValue& map, const SimulationSpec& spec) {
    if (!spec.place)
        map.fail("raw measurements need a place on the Earth, and none is given", "Add place");
    RawSpec raw;
    const auto real = [&](const char* key) {
        return map[key].optional_real().value_or(default_real(fmt::format("raw.{}", key)));
    };
    raw.mask_deg = real("mask_deg");
    raw.two_bands = map["bands"].optional_integer().value_or(default_integer("raw.bands")) == 2;
    raw.phase_noise_m = real("phase_noise_m");
    raw.phase_multipath_m = real("phase_multipath_m");
    raw.multipath_time_s = real("multipath_time_s");
    raw.pseudorange_noise_m = real("pseudorange_noise_m");
    raw.doppler_noise_hz = real("doppler_noise_hz");
    raw.clock_offset_s = real("clock_offset_s");
    raw.clock_drift = real("clock_drift");
    raw.clock_jumps = map["clock_jumps"].exists() && map["clock_jumps"].boolean();
    for (const YamlValue& entry : map["slips"].list()) {
        require_within_run(entry["time_s"], spec);
        SlipFault slip;
        slip.time_s = entry["time_s"].real();
        slip.satellite = read_satellite(entry["satellite"]);
        slip.band = static_cast<std::uint8_t>(
            entry["band"].optional_integer().value_or(default_integer("raw.slips[].band")));
        slip.cycles = entry["cycles"].real();
        slip.is_flagged = entry["flagged"].exists() && entry["flagged"].boolean();
        raw.slips.push_back(slip);
    }
    raw.half_cycles = read_satellite_stretches(map["half_cycles"], spec);
    raw.outages = read_satellite_stretches(map["outages"], spec);
    return raw;
}

/// The attempt's own part, with what an attempt cannot do without.
Json read_attempt_part(const YamlValue& part) {
    Json attempt = part.exists() ? json_from_yaml(part) : Json::object();
    const auto fill = [&](const char* key, Json value) {
        if (!attempt.contains(key) || attempt[key].is_null()) attempt[key] = std::move(value);
    };
    fill("id", "simulated-run");
    fill("craft", {{"name", "simulated"}, {"class", "land-yacht"}});
    fill("officials", Json::array({{{"role", "measurer"}}}));
    fill("profiles", Json::array({"nalsa"}));
    return attempt;
}

}  // namespace

const DocumentSchema& simulation_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(simulation_field_table_node(), "schemas/simulation/v1.yaml");
    return schema;
}

SimulationDocument read_simulation(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, simulation_schema());

    SimulationDocument simulation;
    SimulationSpec& spec = simulation.spec;
    read_motion(document["run"], spec);
    read_place(document, spec);
    read_errors(document, spec);
    read_faults(document["faults"], spec);
    read_recording(document["recording"], spec);
    if (const YamlValue raw = document["raw"]; raw.exists()) {
        simulation.raw = read_raw(raw, spec);
        simulation.navigation = raw["navigation"].text();
    }
    simulation.attempt = read_attempt_part(document["attempt"]);
    simulation.attempt_place =
        document["attempt"].exists() ? document["attempt"].place() : document.place();
    return simulation;
}

}  // namespace runcert

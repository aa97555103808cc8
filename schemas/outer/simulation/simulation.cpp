#include "schemas/simulation/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "schemas/common/document.h"

namespace runcert {

YamlNode simulation_field_table_node();

namespace {

using Json = nlohmann::ordered_json;

constexpr double smallest_accuracy_m = 0.0001;  // that attempt/1.0 and a .pos can state

/// Times of epochs are milliseconds, because recordings are written with three decimals.
void require_milliseconds(const YamlValue& time) {
    const double milliseconds = time.real() * 1000.0;
    if (std::abs(milliseconds - std::round(milliseconds)) > 1e-6)
        time.fail(fmt::format("{} s is no whole number of milliseconds", time.text()),
                  "Give three decimals at most");
}

void require_sound_run(const YamlValue& map, const LogisticRun& run) {
    try {
        require_valid(run);
    } catch (const Failure& failure) {
        map.fail(failure.problem(), failure.remedy());
    }
    require_milliseconds(map["duration_s"]);
}

void require_sound_start(const YamlValue& document, const SimulationSpec& spec) {
    if (spec.start_gps && spec.start_gps->nanoseconds() % 1'000'000 != 0)
        document["start_gps"].fail("the time has a fraction of a millisecond",
                                   "Give three decimals at most");
}

void require_within_run(const YamlValue& time, const LogisticRun& run) {
    const auto last_ms = static_cast<double>(duration_ms(run));
    if (time.real() * 1000.0 > last_ms)
        time.fail(fmt::format("{} s is after the end of the run", time.text()),
                  fmt::format("Give a time up to {} s", last_ms / 1000.0));
}

/// The number of the epoch that an outlier names.
std::int64_t outlier_epoch(const YamlValue& outlier, const LogisticRun& run) {
    const YamlValue epoch = outlier["epoch"];
    const YamlValue time = outlier["time_s"];
    if (time.exists()) {
        require_within_run(time, run);
        require_milliseconds(time);
        const std::int64_t time_ms = std::llround(time.real() * 1000.0);
        if (time_ms % interval_ms(run) != 0)
            time.fail(fmt::format("there is no epoch at {} s", time.text()),
                      fmt::format("Epochs are {} ms apart, from 0 s", interval_ms(run)));
        return time_ms / interval_ms(run) + 1;
    }
    const std::int64_t last = duration_ms(run) / interval_ms(run) + 1;
    if (epoch.integer() > last)
        epoch.fail(fmt::format("there is no epoch {}", epoch.text()),
                   fmt::format("The run has {} epochs", last));
    return epoch.integer();
}

void take_faults(const YamlValue& faults, SimulationSpec& spec) {
    const std::vector<YamlValue> outliers = faults["outliers"].list();
    for (std::size_t i = 0; i < outliers.size(); ++i)
        spec.faults.outliers[i].epoch = outlier_epoch(outliers[i], spec.run);
}

void take_accuracy(const YamlValue& recording, SimulationSpec& spec) {
    if (recording["accuracy"].exists()) return;
    const auto total = [](double white_m, double correlated_m) {
        return std::max(smallest_accuracy_m,
                        std::sqrt(white_m * white_m + correlated_m * correlated_m));
    };
    const WhiteNoise& white = spec.white_noise;
    const CorrelatedError& correlated = spec.correlated_error;
    spec.recording.accuracy = {.horizontal_m = total(white.horizontal_m, correlated.horizontal_m),
                               .vertical_m = total(white.vertical_m, correlated.vertical_m)};
}

void require_on_the_craft(const YamlValue& craft) {
    constexpr double largest_m = 100.0;
    for (const char* const arm : {"antenna_m", "reference_point_m", "tape_error_m"})
        for (const char* const axis : {"forward", "right", "down"})
            if (const double m = craft[arm][axis].optional_real().value_or(0.0);
                std::abs(m) > largest_m)
                craft[arm].fail(
                    fmt::format("{} m is beyond any craft", m),
                    fmt::format("Give metres forward, right and down, up to {}", largest_m));
}

void require_sound_surface(const YamlValue& surface, const SimulationSpec& spec) {
    if (surface.exists() && spec.surface->spacing_m > spec.surface->width_m)
        surface.fail("the vertices are further apart than the strip is wide",
                     "Give a spacing_m of at most width_m");
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
        DocumentSchema::read(simulation_field_table_node(), "schemas/outer/simulation/v1.yaml");
    return schema;
}

std::int64_t duration_ms(const LogisticRun& run) {
    return std::llround(run.duration_s * 1000.0);
}

std::int64_t interval_ms(const LogisticRun& run) {
    return 1000 / run.rate_hz;
}

void require_valid(const LogisticRun& run) {
    // Written so that NaN fails too.
    if (!(run.half_speed_time_s > 0.0) || !std::isfinite(run.half_speed_time_s))
        throw Failure("run", "the time of half speed is not a positive number of seconds",
                      "Give the time t0 at which the speed is half the top speed");
    if (!(run.start_speed_m_s > 0.0 && run.start_speed_m_s < run.top_speed_m_s / 2.0) ||
        !std::isfinite(run.top_speed_m_s))
        throw Failure("run",
                      fmt::format("the speed at the start, {} m/s, is not between 0 and half the "
                                  "top speed of {} m/s",
                                  run.start_speed_m_s, run.top_speed_m_s),
                      "The speed must grow from the start to the time t0, when it is half the top "
                      "speed");
}

SimulationDocument read_simulation(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, simulation_schema());
    SimulationDocument simulation{read_members<SimulationSpec>(document)};
    require_sound_run(document["run"], simulation.run);
    require_sound_start(document, simulation);
    take_faults(document["faults"], simulation);
    take_accuracy(document["recording"], simulation);
    for (const char* const time :
         {"faults.steps[].time_s", "faults.ramps[].from_s", "faults.gaps[].from_s",
          "faults.float_fixes[].from_s", "raw.slips[].time_s", "raw.half_cycles[].from_s",
          "raw.outages[].from_s"})
        for (const YamlValue& value : values_at(document, time))
            require_within_run(value, simulation.run);
    require_on_the_craft(document["craft"]);
    require_sound_surface(document["surface"], simulation);
    const YamlValue attempt = document["attempt"];
    simulation.attempt = read_attempt_part(attempt);
    simulation.attempt_place = attempt.exists() ? attempt.place() : document.place();
    return simulation;
}

}  // namespace runcert

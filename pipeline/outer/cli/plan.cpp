#include "plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/figures.h"
#include "core/prose.h"
#include "core/text.h"
#include "outer_commands.h"
#include "reports/plot/plot.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

struct PlanOptions {
    std::string rule, record, speed, craft_class = "land-yacht", plot;
    std::vector<std::string> witnesses;
    std::int64_t rate_hz = 0;
    double accuracy_m = 0.0;
    bool json = false;
};

struct GivenSpeed {
    double m_s = 0.0;
    const SpeedUnit* unit = nullptr;
};

/// "202.9 km/h".
GivenSpeed read_speed(const std::string& text, const std::string& option) {
    const std::size_t blank = text.find(' ');
    const auto value = parse_double(text.substr(0, blank));
    const auto unit = std::ranges::find(
        speed_units(),
        blank == std::string::npos ? "km/h" : trim(std::string_view(text).substr(blank)),
        &SpeedUnit::name);
    if (!value || !(*value > 0.0) || unit == speed_units().end())
        throw Failure(option, fmt::format("\"{}\" is no speed", escape_for_message(text)),
                      "Write a figure and its unit: km/h, m/s, kn or mph");
    return {*value / unit->per_m_s, &*unit};
}

template <class Names>
void require_one_of(const std::string& given, const Names& names, const std::string& option) {
    if (std::ranges::find(names, given) != names.end()) return;
    throw Failure(option, fmt::format("there is no \"{}\"", escape_for_message(given)),
                  fmt::format("Use one of {}", fmt::join(names, ", ")));
}

/// A line of the plan: with some of the witnesses.
struct PlanLine {
    std::string name;
    PlannedEquipment equipment;
    Prospect prospect;
};

void add_witness(PlannedEquipment& equipment, const std::string& given) {
    const std::size_t equals = given.find('=');
    const std::string kind = given.substr(0, equals);
    require_one_of(kind, std::vector<std::string>{"velocities", "wheel"}, "--witness");
    const auto size =
        equals == std::string::npos ? std::nullopt : parse_double(given.substr(equals + 1));
    if (!size || *size < 0.001 || *size > 10.0)
        throw Failure(
            "--witness",
            fmt::format("\"{}\" does not say how good it is", escape_for_message(given)),
            fmt::format("Write {}=0.05, its standard deviation in m/s (0.001 to 10)", kind));
    (kind == "wheel" ? equipment.wheel_m_s : equipment.velocities_m_s) = *size;
}

/// Positions alone, with each witness, with all.
std::vector<PlanLine> lines_of(const PlanOptions& options, const PlannedRun& run) {
    const PlannedEquipment alone{.rate_hz = options.rate_hz, .accuracy_m = options.accuracy_m};
    PlannedEquipment all = alone;
    std::vector<PlanLine> lines{{"positions alone", alone, {}}};
    for (const std::string& witness : options.witnesses) {
        PlannedEquipment one = alone;
        add_witness(one, witness);
        add_witness(all, witness);
        lines.push_back({"with " + witness + " m/s", one, {}});
    }
    if (options.witnesses.size() > 1) lines.push_back({"with all of them", all, {}});
    for (PlanLine& line : lines)
        line.prospect = median_prospect(line.equipment, run, planned_attempts);
    return lines;
}

std::string in_unit(const std::optional<double>& speed_m_s, const SpeedUnit& unit) {
    return speed_m_s ? fmt::format("{:.2f} {}", *speed_m_s * unit.per_m_s, unit.name)
                     : std::string("none");
}

void print_plan(const std::vector<PlanLine>& lines, const PlannedRun& run, const SpeedUnit& unit,
                const std::vector<std::string>& others) {
    const Prospect& best = lines.back().prospect;
    fmt::print("plan     {}, {} Hz, positions to {:g} m; {} at {}, required {}\n\n", run.rule,
               lines.front().equipment.rate_hz, lines.front().equipment.accuracy_m, run.craft_class,
               in_unit(run.speed_m_s, unit), in_unit(best.required_speed_m_s, unit));
    fmt::print("{:<32}{:<16}{:<24}\n", "", "U (k = 2)", "must exceed required by");
    for (const PlanLine& line : lines)
        fmt::print("{:<32}{:<16}{:<24}{}\n", line.name,
                   in_unit(line.prospect.expanded_uncertainty_m_s, unit),
                   in_unit(line.prospect.margin_m_s, unit),
                   line.prospect.proven ? "proves it" : "does not prove it");
    fmt::print("{:<32}{:<16}\n\n", "one epoch, by [DHD22] (24)",
               in_unit(formula_uncertainty_m_s(lines.front().equipment), unit));
    for (const std::string& requirement : best.not_met)
        fmt::print("not met  {}\n", plain_text(requirement));
    if (!best.to_attest.empty())
        fmt::print("beside   requirements to be attested: {}\n", listed(best.to_attest));
    if (!others.empty())
        fmt::print("{}  {}\n", best.proven ? "cheaper" : "instead",
                   "would do, each alone: " + listed(others));
    else if (!best.proven)
        fmt::print("instead  nothing that was tried proves it: a higher speed would\n");
    if (!best.proven) fmt::print("why      {}\n", plain_text(best.reason));
}

Json prospect_json(const PlanLine& line) {
    const Prospect& one = line.prospect;
    Json json{{"with", line.name}, {"proven", one.proven}, {"reason", one.reason}};
    for (const auto& [name, value] : {std::pair("speed_m_s", one.speed_m_s),
                                      {"expanded_uncertainty_m_s", one.expanded_uncertainty_m_s},
                                      {"margin_m_s", one.margin_m_s}})
        json[name] = value ? Json(*value) : Json(nullptr);
    json["not_met"] = one.not_met;
    json["to_attest"] = one.to_attest;
    return json;
}

void print_json(const std::vector<PlanLine>& lines, const PlannedRun& run,
                const std::vector<std::string>& others) {
    Json json{{"rule", run.rule},
              {"craft_class", run.craft_class},
              {"rate_hz", lines.front().equipment.rate_hz},
              {"accuracy_m", lines.front().equipment.accuracy_m},
              {"speed_m_s", run.speed_m_s},
              {"required_speed_m_s", lines.back().prospect.required_speed_m_s},
              {"formula_24_m_s", formula_uncertainty_m_s(lines.front().equipment)},
              {"lines", Json::array()},
              {lines.back().prospect.proven ? "cheaper" : "instead", others}};
    for (const PlanLine& line : lines)
        json["lines"].push_back(prospect_json(line));
    fmt::print("{}\n", json.dump(2));
}

/// The least excess that is proved, over the accuracy of positions, as a page.
void write_plot(const std::vector<PlanLine>& lines, const PlannedRun& run, const SpeedUnit& unit,
                const std::string& file) {
    Curve curve{.name = "least excess over the required speed", .kind = "line", .colour = "blue"};
    Range x, y;
    y.widen(0.0);
    PlannedEquipment other = lines.back().equipment;
    for (const double factor : {0.5, 1.0, 2.0, 4.0, 8.0}) {
        other.accuracy_m = factor * lines.back().equipment.accuracy_m;
        const Prospect prospect = median_prospect(other, run, 1);
        if (!prospect.margin_m_s) continue;
        curve.add(other.accuracy_m, *prospect.margin_m_s * unit.per_m_s);
        x.widen(other.accuracy_m);
        y.widen(curve.y.back());
    }
    Plot plot{.kind = "plan",
              .title = fmt::format("What can be proved by {} at {} Hz", run.rule, other.rate_hz),
              .x_label = "standard deviation of a position (m)",
              .y_label = fmt::format("least excess ({})", unit.name)};
    plot.add(std::move(curve));
    plot.set_axes(x, y);
    write_new_file(file, "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<title>" +
                             svg_text(plot.title) + "</title>\n<h1>" + svg_text(plot.title) +
                             "</h1>\n" + plot_svg(plot) + "\n");
}

int plan(const PlanOptions& options) {
    require_one_of(options.rule, builtin_profiles(), "--rule");
    constexpr std::array rates_hz{1, 2, 4, 5, 8, 10, 20, 25, 40, 50, 100};
    if (std::ranges::find(rates_hz, options.rate_hz) == rates_hz.end())
        throw Failure("--rate", fmt::format("no receiver is simulated at {} Hz", options.rate_hz),
                      fmt::format("Use one of {}", fmt::join(rates_hz, ", ")));
    require_one_of(options.craft_class, attempt_schema().find("craft.class")->values, "--craft");
    const GivenSpeed record = read_speed(options.record, "--record");
    PlannedRun run{.rule = options.rule,
                   .craft_class = options.craft_class,
                   .record_m_s = record.m_s,
                   .speed_m_s = 1.03 * record.m_s};
    if (!options.speed.empty()) run.speed_m_s = read_speed(options.speed, "--speed").m_s;
    if (!options.plot.empty() && !options.plot.ends_with(".html"))
        throw Failure("--plot",
                      fmt::format("\"{}\" is no name for a page", escape_for_message(options.plot)),
                      "Give a name that ends with .html");
    if (std::filesystem::exists(std::filesystem::symlink_status(options.plot)))
        throw Failure(options.plot, "the file exists; nothing was written",
                      "Choose another name, or remove the file");
    const std::vector<PlanLine> lines = lines_of(options, run);
    const std::vector<std::string> others =
        other_equipment(lines.back().equipment, run, lines.back().prospect.proven);
    if (!options.plot.empty()) write_plot(lines, run, *record.unit, options.plot);
    if (options.json)
        print_json(lines, run, others);
    else
        print_plan(lines, run, *record.unit, others);
    return lines.back().prospect.proven ? 0 : 1;
}

}  // namespace

void add_plan(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<PlanOptions>(
        app, chosen, "plan", "What a day's equipment can prove, by attempts that are simulated",
        plan);
    line.text("--rule", options.rule, "rule that it is judged by (runcert explain --profiles)",
              CommandLine::required);
    line.integer("--rate", options.rate_hz, "epochs a second (1 to 100)", 1, 100);
    line.number("--accuracy", options.accuracy_m,
                "standard deviation of a position, of each axis, in metres", 0.001, 10.0);
    line.texts("--witness", options.witnesses,
               "what is recorded beside, with its standard deviation in m/s: velocities=0.05, "
               "wheel=0.02; may be repeated");
    line.text("--record", options.record, "record to beat: \"202.9 km/h\"", CommandLine::required);
    line.text("--speed", options.speed, "speed that is hoped for (default: 3 % above the record)");
    line.text("--craft", options.craft_class, "class of the craft (default: land-yacht)");
    line.text("--plot", options.plot,
              "draw what can be proved over the accuracy, as a page (HTML)");
    line.flag("--json", options.json, "one JSON document instead of text");
    line.footer(
        "Five attempts with this equipment are simulated and go through all stages; the median "
        "counts.\nErrors of positions are of the size given, a fifth of their variance white, the "
        "rest correlated over\n1.5 s. What is not simulated, such as a wrong ambiguity or an IMU, "
        "can only be worse or better.\nExit status: 0 the equipment proves that speed, 1 it does "
        "not, 2 it could not be computed.");
}

}  // namespace runcert

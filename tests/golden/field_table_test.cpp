#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "golden_files.h"

// The field tables themselves, and that the golden files have all that is in them.

namespace runcert::RUNCERT_FILE {
namespace {

using Names = std::set<std::string>;

/// Real numbers that are no physical quantity, or whose unit stands in a field beside them.
const Names without_unit{
    "correlation_east_north", "correlation_east_up",
    "correlation_north_up",  // a column each
    "ratio", "statistic", "threshold", "speed_statistic", "speed_threshold",
    "summary.variance_factor", "estimation.variance_factor", "estimation.variance_factor_applied",
    "profiles[].coverage_factor", "with_files[].coverage_factor", "results[].coverage_factor",
    "noise.passes", "accuracy.coverage_factor", "accuracy.limit", "margin.value", "record.speed",
    "attempt.record.speed",  // unit beside it
    "parameters.screen.gap_factor", "parameters.screen.false_alarm_rate",
    "parameters.screen.family_false_alarm_rate", "parameters.screen.power",
    "parameters.screen.ratio_min", "parameters.screen.noise_scale_min",
    "parameters.smooth.robust_scale", "parameters.window.plane_scale_bound",
    "parameters.window.clock_rate_bound", "robust_weight",
    // of a fit of the noise, and of a filter
    "relative_uncertainty", "noise.measurement_scale.value", "noise.singer_gain",
    "noise.error_gain", "noise.white_scale", "posterior[].weight", "posterior[].measurement_scale",
    "health.mean_statistic", "health.lower", "health.upper", "health.autocorrelation_stated",
    "health.autocorrelation", "health.largest_condition", "health.largest_asymmetry",
    // of a budget, where the unit stands beside
    "best.effective_degrees_of_freedom", "budget[].degrees_of_freedom", "budget[].estimate",
    "budget[].standard_uncertainty", "budget[].sensitivity", "bound.along",
    // of screening, and of what it cannot find, where the unit stands beside
    "screening.family_false_alarm_rate", "screening.test_size", "screening.power",
    "screening.models[].measurement_scale", "screening.models[].white_scale",
    "screening.fix_types[].variance_factor", "screening.device.by_chance",
    "screening.velocity.sigma_ratio", "screening.largest_decision.share",
    "screening.largest_decision.statistic", "screening.largest_decision.threshold",
    "parameters.screen.decision_share_max", "parameters.screen.time_share_max",
    "parameters.screen.velocity_share_max", "screening.velocity.contradicted_share",
    "witnesses[].normalised_error", "witnesses[].share", "fault_probability", "fault_posterior",
    "chance_error", "disagreement", "chosen_fault_probability", "screening.time.rate_deviation",
    "correlation_estimated", "local_variance_factor", "best.detection_power", "reliability[].size",
    // of rules, where the unit stands beside, and probabilities
    "record.expanded_uncertainty", "records[].speed", "records[].expanded_uncertainty",
    "rules[].value", "secondary.speed", "secondary.expanded_uncertainty", "decision.probability",
    "decision.by_uncertainty", "decision.by_faults", "decision.tail_risk", "decision.level",
    "decision.risk", "results[].probability", "results[].level", "best.probability", "best.level",
    "clauses[].limit", "figures[].limit", "course[].limit", "figures[].value",
    "figures[].expanded_uncertainty", "course[].value", "course[].expanded_uncertainty",
    "overrides[].rule", "overrides[].used",
    // of a device, where the unit stands beside
    "device_deduction.speed",
    // of a calibration, and of a wheel
    "calibration.expanded_uncertainty", "wheel.scale", "wheel.stated_scale",
    "wheel.expanded_uncertainty_scale",
    // of an IMU, whose scale's unit stands in keys beside it, and of what is made of it
    "imu.gyro_scale", "imu.accelerometer_scale", "imu.scale_error", "clock.drift",
    "consistency.normalised_innovations", "consistency.autocorrelation", "consistency.beyond_share",
    "innovation_east", "innovation_north", "innovation_up", "quaternion_w", "quaternion_x",
    "quaternion_y", "quaternion_z"};

/// Whether the path, or its end after a point, stands in that list.
bool may_lack_unit(const std::string& path) {
    return std::any_of(without_unit.begin(), without_unit.end(), [&](const std::string& name) {
        return path == name || path.ends_with("." + name);
    });
}

const Names known_types{"text", "integer", "real", "boolean", "map", "list", "any"};
const Names known_keys{"type",   "unit",        "required",    "values",      "min",
                       "max",    "decimals",    "default",     "description", "limits",
                       "origin", "changes",     "decides",     "clause",      "read_by",
                       "series", "before_rule", "question",    "why",         "example",
                       "apart",  "names_file",  "always_asked"};

std::vector<std::string> schema_names() {
    std::vector<std::string> names;
    const std::string folder = std::string(RUNCERT_SOURCE_DIR) + "/schemas";
    for (const std::string& ring : {folder, folder + "/outer"})
        for (const auto& entry : std::filesystem::directory_iterator(ring))
            if (exists(entry.path() / "v1.yaml")) names.push_back(entry.path().filename());
    EXPECT_GE(names.size(), 20U);
    return names;
}

TEST(FieldTables, EveryFieldIsDescribedAndPhysicalQuantitiesHaveAUnit) {
    for (const std::string& name : schema_names()) {
        SCOPED_TRACE(name);
        const DocumentSchema schema = DocumentSchema::parse(golden::field_table(name), name);
        EXPECT_EQ(schema.name(), name == "common" ? "header" : name);
        EXPECT_EQ(schema.version(), "1.0");
        Names paths;
        for (const FieldRule& rule : schema.fields()) {
            SCOPED_TRACE(rule.path);
            EXPECT_TRUE(paths.insert(rule.path).second);
            EXPECT_GE(rule.description.size(), 2U);
            for (const std::string& type : rule.types)
                EXPECT_TRUE(known_types.contains(type));
            for (const std::string& key : schema.source()["fields"][rule.path].keys())
                EXPECT_TRUE(known_keys.contains(key)) << key;
            if (rule.types == std::vector<std::string>{"real"}) {
                EXPECT_EQ(rule.unit.empty(), may_lack_unit(rule.path));
            } else {
                EXPECT_TRUE(rule.unit.empty() || rule.unit == "Hz");
            }
            // What stands inside another field: that field is there, and may hold it.
            const std::size_t end = rule.path.find_last_of('.');
            std::string parent = rule.path.ends_with("[]")
                                     ? rule.path.substr(0, rule.path.size() - 2)
                                     : rule.path.substr(0, end == std::string::npos ? 0 : end);
            if (parent.empty()) continue;
            const FieldRule* holder = schema.find(parent);
            ASSERT_NE(holder, nullptr);
            const char* type = rule.path.ends_with("[]") ? "list" : "map";
            EXPECT_EQ(std::count(holder->types.begin(), holder->types.end(), type), 1);
        }
    }
}

TEST(FieldTables, EveryColumnIsDescribedAndPhysicalQuantitiesHaveAUnit) {
    for (const char* name : {"observations", "enu", "screened", "trajectory", "attitude"}) {
        SCOPED_TRACE(name);
        const TableSchema schema =
            TableSchema::read(parse_yaml(golden::field_table(name), name), name);
        EXPECT_GE(schema.columns().size(), 20U);
        for (const EcsvColumn& column : schema.columns()) {
            EXPECT_GE(column.description.size(), 2U) << column.name;
            const bool without =
                column.type != CellType::real || without_unit.contains(column.name);
            EXPECT_EQ(column.unit.empty(), without) << column.name;
        }
    }
}

TEST(FieldTables, GoldenTablesHaveExactlyTheColumns) {
    for (const golden::GoldenFile& file : golden::all_files()) {
        if (!file.is_table) continue;
        SCOPED_TRACE(file.path);
        const std::string text = golden::text_of(file.path);
        const EcsvReader table(text, file.path);
        const TableSchema schema =
            TableSchema::read(parse_yaml(golden::field_table(file.kind.schema), "v1"), "v1");
        ASSERT_EQ(table.columns().size(), schema.columns().size());
        for (std::size_t i = 0; i < table.columns().size(); ++i) {
            const EcsvColumn& own = schema.columns()[i];
            EXPECT_EQ(table.columns()[i].name, own.name);
            EXPECT_EQ(table.columns()[i].type, own.type) << own.name;
            EXPECT_EQ(table.columns()[i].unit, own.unit) << own.name;
            EXPECT_EQ(table.columns()[i].decimals, own.decimals) << own.name;
            EXPECT_EQ(table.columns()[i].description, own.description) << own.name;
        }
    }
}

/// The paths of all that a document holds, as a field table writes them.
void collect(const YamlValue& value, const std::string& path, Names& paths) {
    if (!path.empty()) paths.insert(path);
    for (const std::string& key : value.keys())
        collect(value[key], path.empty() ? key : path + "." + key, paths);
    if (value.is_list())
        for (const YamlValue& item : value.list())
            collect(item, path + "[]", paths);
}

TEST(FieldTables, GoldenFilesHaveEveryField) {
    std::map<std::string, Names> found;  // by schema
    for (const golden::GoldenFile& file : golden::all_files()) {
        SCOPED_TRACE(file.path);
        const std::string text = golden::text_of(file.path);
        collect({file.is_table ? EcsvReader(text, "f").meta() : parse_yaml(text, "f"), "f"}, "",
                found[file.kind.schema]);
    }
    for (const auto& [name, names] : found) {
        SCOPED_TRACE(name);
        const DocumentSchema schema = DocumentSchema::parse(golden::field_table(name), "v1");
        for (const FieldRule& rule : schema.fields())
            EXPECT_TRUE(names.contains(rule.path) || rule.path.ends_with(".*")) << rule.path;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

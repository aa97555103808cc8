#include <algorithm>
#include <filesystem>
#include <set>

#include "golden_files.h"

// The field tables themselves, and that the golden files have all that is in them.

namespace runcert {
namespace {

using Names = std::set<std::string>;

/// Real numbers that are no physical quantity, or whose unit stands in a field beside them.
const Names without_unit{"correlation_east_north",
                         "correlation_east_up",
                         "correlation_north_up",  // a column each
                         "ratio",
                         "statistic",
                         "threshold",
                         "summary.variance_factor",
                         "estimation.variance_factor",
                         "estimation.variance_factor_applied",
                         "profiles[].coverage_factor",
                         "accuracy.coverage_factor",
                         "accuracy.limit",
                         "margin.value",
                         "record.speed",
                         "attempt.record.speed",  // unit beside it
                         "parameters.screen.gap_factor",
                         "parameters.screen.false_alarm_rate"};

const Names known_types{"text", "integer", "real", "boolean", "map", "list", "any"};
const Names known_keys{"type", "unit",     "required", "values",     "min",
                       "max",  "decimals", "default",  "description"};

std::vector<std::string> schema_names() {
    std::vector<std::string> names;
    const std::string folder = std::string(RUNCERT_SOURCE_DIR) + "/schemas";
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (exists(entry.path() / "v1.yaml")) names.push_back(entry.path().filename());
    EXPECT_GE(names.size(), 9U);
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
                EXPECT_EQ(rule.unit.empty(), without_unit.contains(rule.path));
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
    for (const char* name : {"observations", "enu", "screened", "trajectory"}) {
        SCOPED_TRACE(name);
        const TableSchema schema = TableSchema::parse(golden::field_table(name), name);
        EXPECT_GE(schema.columns().size(), 20U);
        for (const EcsvColumn& column : schema.columns()) {
            EXPECT_GE(column.description.size(), 2U) << column.name;
            const bool without =
                column.type != CellType::real || without_unit.contains(column.name);
            EXPECT_EQ(column.unit.empty(), without) << column.name;
        }
    }
}

TEST(FieldTables, GoldenTablesHaveExactlyTheColumnsOfTheirSchema) {
    for (const auto& file : golden::files) {
        if (!std::string(file.name).ends_with(".ecsv")) continue;
        SCOPED_TRACE(file.name);
        const std::string text = golden::text_of(file.name);
        const EcsvReader table(text, file.name);
        const TableSchema schema = TableSchema::parse(golden::field_table(file.schema), "v1");
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

TEST(FieldTables, GoldenFilesHaveEveryFieldOfTheirSchema) {
    for (const auto& file : golden::files) {
        SCOPED_TRACE(file.name);
        const std::string text = golden::text_of(file.name);
        const bool is_table = std::string(file.name).ends_with(".ecsv");
        Names found;
        collect({is_table ? EcsvReader(text, "f").meta() : parse_yaml(text, "f"), "f"}, "", found);
        const DocumentSchema schema = DocumentSchema::parse(golden::field_table(file.schema), "v1");
        for (const FieldRule& rule : schema.fields()) {
            if (rule.path.ends_with(".*")) continue;
            EXPECT_TRUE(found.contains(rule.path)) << rule.path;
        }
    }
}

}  // namespace
}  // namespace runcert

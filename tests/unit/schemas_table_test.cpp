#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "schemas/enu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "store_test_support.h"

// What holds for every product that is a table, tried on the golden files.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

std::string golden(const std::string& name) {
    return test::slurp(std::string(RUNCERT_SOURCE_DIR) + "/tests/golden/v1.0/" + name);
}

/// 2-enu.ecsv of revision 1.1, with one more column, described by `column`, and one more field.
std::string newer_enu(const std::string& column) {
    std::string text = golden("2-enu.ecsv");
    text = replaced(text, "name: enu\n#     version: \"1.0\"", "name: enu\n#     version: \"1.1\"");
    text = replaced(text, "# delimiter",
                    "#   - {name: later, datatype: int64" + column + "}\n# delimiter");
    text = replaced(text, "#   receiver:", "#   added_later: 1\n#   receiver:");
    text = replaced(text, ",source_file\n", ",source_file,later\n");
    std::string out;
    bool in_rows = false;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        const std::string line = text.substr(at, end - at);
        out += line + (in_rows ? ",7\n" : "\n");
        in_rows = in_rows || line.ends_with(",later");
        at = end + 1;
    }
    return out;
}

TEST(TableVersion, ANewerRevisionIsReadUnlessItMustBeUnderstood) {
    EXPECT_EQ(read_enu(newer_enu(""), "f").rows.size(), 5U);
    EXPECT_EQ(read_enu(newer_enu(", meta: {required: false}"), "f").rows.at(3).north_m, 6.324);
    const auto said = failure_of([] { read_enu(newer_enu(", meta: {required: true}"), "f"); });
    EXPECT_TRUE(said.contains("the column \"later\" is not known")) << said.problem;
    const std::string same_revision =
        replaced(newer_enu(""), "version: \"1.1\"", "version: \"1.0\"");
    EXPECT_TRUE(failure_of([&] {
                    read_enu(replaced(same_revision, "#   added_later: 1\n", ""), "f");
                }).contains("the column \"later\" is not known"));
    EXPECT_TRUE(
        failure_of([&] { read_enu(same_revision, "f"); }).contains("unknown key \"added_later\""));
}

TEST(TableSchema, DeviationsFromTheFieldTable) {
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"name: enu\n#     version: \"1.0\"", "name: enu\n#     version: \"2.0\"",
         "version \"2.0\""},
        {"name: enu\n#     version", "name: screened\n#     version",
         "schema \"screened\", expected"},
        {"unit: \"m / s\"", "unit: km / h", "\"km / h\", expected float64 in \"m / s\""},
        {"name: east\n#     unit: m\n", "name: east\n", "\"east\" is float64 in \"\""},
        {"name: epoch\n#     datatype: int64", "name: epoch\n#     datatype: float64",
         "the column \"epoch\" is float64"},
        {"georeferenced: true", "georeferenced: yes", "neither true nor false"},
        {"#   receiver: primary\n", "", "the key \"receiver\" is missing"},
        {"first_epoch_gps: \"2022-03-18", "first_epoch_gps: \"2022-02-30", "the day 30"},
        {"nominal_interval_s: 0.1", "nominal_interval_s: -0.1", "is below 0 s"},
        {"source: attempt", "source: guess", "\"guess\" is not one of attempt, first_epoch"},
        {"source_revision: \"0123456789ab\"\n", "source_revison: \"0123456789ab\"\n",
         "Did you mean \"source_revision\""},
        {",fixed,17,", ",fxed,17,", "column \"fix\": \"fxed\" is not one of the known words"},
        {",fixed,17,", ",,17,", "column \"fix\": the cell is empty but must not be"},
        {"1,0.000000000,", "1,0.0000000001,", "at most nine decimals"},
        {"1,0.000000000,", ",0.000000000,", "column \"epoch\": the cell is empty"},
    };
    const std::string text = golden("2-enu.ecsv");
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_enu(replaced(text, c.from, c.to), "f"); });
        EXPECT_TRUE(said.where.starts_with("f")) << c.to << ": " << said.where;
        EXPECT_TRUE(said.contains(c.said)) << c.to << ": " << said.problem;
    }
    // A cell's place: line 5 of the rows, column of its first character.
    const auto said = failure_of([&] { read_enu(replaced(text, "\n5,0.4", "\n5,x.4"), "f"); });
    EXPECT_TRUE(said.where.ends_with(":3")) << said.where;
}

TEST(TableSchema, ColumnsMayStandInAnyOrder) {
    // epoch and time change places, in the header and in the rows.
    std::string text = golden("2-enu.ecsv");
    const std::size_t epoch = text.find("#   - name: epoch");
    const std::size_t time = text.find("#   - name: time");
    const std::size_t east = text.find("#   - name: east");
    text = text.substr(0, epoch) + text.substr(time, east - time) +
           text.substr(epoch, time - epoch) + text.substr(east);
    text = replaced(text, "epoch,time,", "time,epoch,");
    for (int i = 0; i < 5; ++i) {
        const std::string number = std::to_string(i + 1);
        const std::string seconds = "0." + std::to_string(i) + "00000000";
        text = replaced(text, "\n" + number + "," + seconds, "\n" + seconds + "," + number);
    }
    const EnuTable table = read_enu(text, "f");
    EXPECT_EQ(table.rows.at(3).epoch, 4);
    EXPECT_EQ(table.rows.at(3).time.nanoseconds, 300'000'000);
}

TEST(TableSchema, WriterRefusesWhatIsNotFinite) {
    EnuTable table = read_enu(golden("2-enu.ecsv"), "f");
    table.rows.at(0).east_m = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(failure_of([&] { write_enu(table); }).where, "column east");
    table = read_enu(golden("2-enu.ecsv"), "f");
    table.facts.nominal_interval_s = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(failure_of([&] { write_enu(table); }).contains("not a finite number"));
}

/// A table whose second column, and a field, came with revision 1.1.
struct GrownRow {
    std::int64_t epoch = 0;
    std::optional<double> later;
};

constexpr const char* grown_table = R"(schema: grown
version: "1.1"
fields:
  added: {type: integer, since: "1.1", description: "a field that came later"}
columns:
  - {name: epoch, type: integer, description: "number"}
  - {name: later, type: real, decimals: 1, since: "1.1", description: "a column that came later"}
)";

TEST(TableRevision, AColumnOfThisRevisionMayBeMissingInAnEarlierOneOnly) {
    const TableFormat<GrownRow> format(
        grown_table, "grown",
        {column<GrownRow, &GrownRow::epoch>("epoch"), column<GrownRow, &GrownRow::later>("later")});
    nlohmann::ordered_json meta = header_json({});
    meta["added"] = 7;
    const std::vector<GrownRow> rows{{1, 2.5}};
    const std::string text = format.write(meta, rows);
    EXPECT_EQ(format.read(text, "f").rows.at(0).later, 2.5);

    std::string without = replaced(text, "\nepoch,later\n1,2.5\n", "\nepoch\n1\n");
    const std::size_t begin = without.find("#   - name: later");
    ASSERT_NE(begin, std::string::npos) << text;
    without.erase(begin, without.find("# delimiter") - begin);
    EXPECT_TRUE(
        failure_of([&] { format.read(without, "f"); }).contains("the column \"later\" is missing"));

    const auto earlier = [](const std::string& of) {
        return replaced(of, "version: \"1.1\"", "version: \"1.0\"");
    };
    const auto field = failure_of([&] { format.read(earlier(without), "f"); });
    EXPECT_TRUE(
        field.contains("added: the field needs revision 1.1 of the schema grown; the file "
                       "follows grown/1.0"))
        << field.problem;
    const auto no_field = [](const std::string& of) { return replaced(of, "#   added: 7\n", ""); };
    EXPECT_FALSE(format.read(earlier(no_field(without)), "f").rows.at(0).later);
    const auto said = failure_of([&] { format.read(earlier(no_field(text)), "f"); });
    EXPECT_TRUE(
        said.contains("the column \"later\" needs revision 1.1 of the schema grown; the "
                      "file follows grown/1.0"))
        << said.problem;
}

TEST(TableRevision, ARequiredFieldOfThisRevisionIsRequiredInIt) {
    const std::string text =
        replaced(golden("4-trajectory.ecsv"), "#     batch_stretches: 2\n", "");
    EXPECT_TRUE(failure_of([&] {
                    read_trajectory(text, "f");
                }).contains("the key \"batch_stretches\" is missing"));
}

struct OneColumn {
    double always = 0.0;
    std::optional<double> sometimes;
};

TEST(TableRevision, AColumnAddedLaterIsBoundToAnOptional) {
    const std::string table =
        "schema: sample\nversion: \"1.1\"\nfields: {}\ncolumns:\n"
        "  - {name: a, type: real, decimals: 1, since: \"1.1\", description: a}\n";
    EXPECT_NO_THROW(
        TableFormat<OneColumn>(table, "f", {column<OneColumn, &OneColumn::sometimes>("a")}));
    EXPECT_TRUE(failure_of([&] {
                    TableFormat<OneColumn>(table, "f",
                                           {column<OneColumn, &OneColumn::always>("a")});
                }).contains("does not follow the field table"));
    const std::string first = replaced(table, ", since: \"1.1\"", "");
    EXPECT_NO_THROW(
        TableFormat<OneColumn>(first, "f", {column<OneColumn, &OneColumn::always>("a")}));
}

// --- astropy -----------------------------------------------------------------------------------

constexpr const char* describe = R"(
import json, sys
import numpy as np
from astropy import units
from astropy.table import Table
t = Table.read(sys.argv[1], format='ascii.ecsv')
columns = []
for c in t.columns.values():
    assert c.unit is None or not isinstance(c.unit, units.UnrecognizedUnit), c.unit
    mask = np.broadcast_to(getattr(c, 'mask', False), len(c)).tolist()
    columns.append({'name': c.name, 'unit': str(c.unit or ''), 'kind': c.dtype.kind,
                    'values': [None if m else v for v, m in zip(c.tolist(), mask)]})
if 'acceleration_east' in t.colnames:
    t['acceleration_east'].unit.to('km / h2')
print(json.dumps({'columns': columns, 'meta': t.meta}))
)";

void expect_equal(const EcsvReader& ours, std::size_t column, const nlohmann::json& theirs) {
    if (ours.is_missing(column)) {
        EXPECT_TRUE(theirs.is_null());
        return;
    }
    switch (ours.columns()[column].type) {
        case CellType::boolean:
            EXPECT_EQ(ours.boolean(column), theirs.get<bool>());
            break;
        case CellType::integer:
            EXPECT_EQ(ours.integer(column), theirs.get<std::int64_t>());
            break;
        case CellType::real:
            EXPECT_EQ(ours.real(column), theirs.get<double>());
            break;
        case CellType::text:
            EXPECT_EQ(ours.text(column), theirs.get<std::string>());
            break;
    }
}

TEST(ProductTables, AstropyReadsTheSame) {
    if (!test::python_has("astropy")) GTEST_SKIP() << "python3-astropy is not installed";
    const struct {
        const char* name;
        std::string text;
    } tables[] = {
        {"observations", write_observations(read_observations(golden("1-observations.ecsv"), "f"))},
        {"enu", write_enu(read_enu(golden("2-enu.ecsv"), "f"))},
        {"screened", write_screened(read_screened(golden("3-screened.ecsv"), "f"))},
        {"trajectory", write_trajectory(read_trajectory(golden("4-trajectory.ecsv"), "f"))},
    };
    const TemporaryFolder folder;
    for (const auto& table : tables) {
        SCOPED_TRACE(table.name);
        const std::string file = (folder.path() / table.name).string();
        test::spill(file, table.text);
        const auto found = nlohmann::ordered_json::parse(test::python(describe, {file}));
        EcsvReader ours(table.text, table.name);
        const std::size_t columns = ours.columns().size();
        ASSERT_EQ(found["columns"].size(), columns);
        std::size_t row = 0;
        for (; ours.next_row(); ++row)
            for (std::size_t i = 0; i < columns; ++i) {
                SCOPED_TRACE(ours.columns()[i].name);
                expect_equal(ours, i, found["columns"][i]["values"].at(row));
            }
        EXPECT_GE(row, 5U);
        for (std::size_t i = 0; i < columns; ++i) {
            EXPECT_EQ(found["columns"][i]["name"], ours.columns()[i].name);
            EXPECT_EQ(found["columns"][i]["unit"], ours.columns()[i].unit);
            EXPECT_EQ(found["columns"][i]["values"].size(), row);
        }
        EXPECT_EQ(found["meta"], json_from_yaml({ours.meta(), "f"}));
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE

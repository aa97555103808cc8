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

TEST(TableSchema, DeviationsFromTheFieldTable) {
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"name: enu\n#     version: \"1.0\"", "name: enu\n#     version: \"2.0\"",
         "version \"2.0\""},
        {"name: enu\n#     version: \"1.0\"", "name: enu\n#     version: \"1.1\"",
         "version \"1.1\" of the schema enu is not known"},
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

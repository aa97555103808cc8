#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "store/ecsv.h"
#include "store_test_support.h"

// Tables against astropy, the format's own implementation, both ways.

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;
using test::python;
using test::python_has;
using test::spill;

class EcsvAstropy : public testing::Test {
  protected:
    void SetUp() override {
        if (!python_has("astropy")) GTEST_SKIP() << "python3-astropy is not installed";
    }
    std::string file() const { return (folder_.path() / "t.ecsv").string(); }

  private:
    TemporaryFolder folder_;
};

/// Prints a table as JSON: names, units, types, descriptions, values (masked ones as null), meta.
constexpr const char* describe = R"(
import json, sys
import numpy as np
from astropy.table import Table
t = Table.read(sys.argv[1], format='ascii.ecsv')
columns = []
for c in t.columns.values():
    mask = np.broadcast_to(getattr(c, 'mask', False), len(c)).tolist()
    columns.append({'name': c.name, 'unit': str(c.unit) if c.unit else '', 'kind': c.dtype.kind,
        'description': c.description or '', 'format': c.format or '',
        'values': [None if m else v for v, m in zip(c.tolist(), mask)]})
print(json.dumps({'columns': columns, 'meta': t.meta}))
)";

TEST_F(EcsvAstropy, ReadsWhatWeWrite) {
    const Json meta = {{"schema", {{"name", "observations"}, {"version", "1.0"}}},
                       {"text",
                        {"1.0",
                         "1e3",
                         "0x1f",
                         "0o17",
                         "2026-11-21",
                         "yes",
                         "No",
                         "true",
                         "null",
                         "~",
                         "",
                         " x ",
                         "a: b",
                         "#c",
                         "- d",
                         "12:30:45",
                         "\xc2\xb5m",
                         "\xe5\x90\x8d\xe5\x8f\xa4\xe5\xb1\x8b",
                         "\xf0\x9f\x98\x80",
                         "line\nline",
                         "tab\tx",
                         "quote \"x\" 'y'",
                         "back\\slash",
                         ".inf",
                         ".nan",
                         "=",
                         "<<",
                         "%x",
                         "@x",
                         "`x",
                         "!x",
                         "&x",
                         "*x",
                         "nan"}},
                       {"numbers", {0, -1, 9223372036854775807, 0.1, 1e-6, 1e20, -2.5e-300, 1.0}},
                       {"flags", {true, false, nullptr}},
                       {"empty", {Json::object(), Json::array()}},
                       {"deep", {{"list", {{{"a", 1}, {"b", {1, 2, {{"c", nullptr}}}}}, {}}}}},
                       {"1", "a key that looks like a number"},
                       {"yes", "a key that looks like true"}};
    EcsvWriter out(
        {{.name = "flag", .type = CellType::boolean, .unit = {}, .description = "yes or no"},
         {.name = "count", .type = CellType::integer, .unit = {}, .description = {}},
         {.name = "speed", .unit = "m / s", .decimals = 6, .description = "a: b #c \"d\""},
         {.name = "turn", .unit = "deg", .decimals = 11, .description = {}},
         {.name = "force", .unit = "m / s2", .decimals = 1, .description = {}},
         {.name = "word", .type = CellType::text, .unit = {}, .description = {}},
         {.name = "time", .unit = "s", .decimals = 9, .description = {}}},
        meta);
    const char* words[] = {"a,b", "say \"x\"", "#first", "nan", "True", "--", "N/A", "1", "a  b"};
    std::int64_t row = 0;
    for (const char* word : words) {
        row % 3 == 0 ? out.missing() : out.boolean(row % 2 == 0);
        row % 4 == 1 ? out.missing() : out.integer(row == 0 ? INT64_MIN : INT64_MAX - row);
        row % 5 == 2 ? out.missing() : out.real(-0.125 * static_cast<double>(row));
        out.real(136.97757427512);
        out.real(1e300);
        row == 8 ? out.missing() : out.text(word);
        out.seconds(row * 100'000'001 - 1);
        ++row;
    }
    spill(file(), std::move(out).take());

    const Json found = Json::parse(python(describe, {file()}));
    EXPECT_EQ(found["meta"], meta);
    const Json& columns = found["columns"];
    ASSERT_EQ(columns.size(), 7U);
    const auto each = [&](const char* key) {
        Json list = Json::array();
        for (const Json& column : columns)
            list.push_back(column[key]);
        return list;
    };
    EXPECT_EQ(each("name"), Json({"flag", "count", "speed", "turn", "force", "word", "time"}));
    EXPECT_EQ(each("unit"), Json({"", "", "m / s", "deg", "m / s2", "", "s"}));
    EXPECT_EQ(each("kind"), Json({"b", "i", "f", "f", "f", "U", "f"}));
    EXPECT_EQ(each("description"), Json({"yes or no", "", "a: b #c \"d\"", "", "", "", ""}));
    for (std::int64_t i = 0; i < row; ++i) {
        const auto value = [&](std::size_t column) {
            return columns[column]["values"][static_cast<std::size_t>(i)];
        };
        EXPECT_EQ(value(0), i % 3 == 0 ? Json() : Json(i % 2 == 0)) << i;
        EXPECT_EQ(value(1), i % 4 == 1 ? Json() : Json(i == 0 ? INT64_MIN : INT64_MAX - i)) << i;
        EXPECT_EQ(value(2), i % 5 == 2 ? Json() : Json(-0.125 * static_cast<double>(i))) << i;
        EXPECT_EQ(value(3), Json(136.97757427512));
        EXPECT_EQ(value(4), Json(1e300));
        EXPECT_EQ(value(5), i == 8 ? Json() : Json(words[i]));
        EXPECT_EQ(value(6).get<double>(), static_cast<double>(i * 100'000'001 - 1) / 1e9);
    }
}

TEST_F(EcsvAstropy, KeepsARowThatIsMissing) {
    EcsvWriter out({{.name = "a", .type = CellType::integer, .unit = {}, .description = {}}}, {});
    out.integer(1);
    out.missing();
    out.integer(3);
    spill(file(), std::move(out).take());
    EXPECT_EQ(Json::parse(python(describe, {file()}))["columns"][0]["values"],
              Json({1, nullptr, 3}));
}

/// A table with everything that a user of astropy would put into one of ours.
constexpr const char* make = R"(
import sys
from collections import OrderedDict
import numpy as np
from astropy.table import Table, MaskedColumn
t = Table(masked=True)
t['flag'] = MaskedColumn([True, False, True, False], mask=[False, False, False, True])
t['count'] = MaskedColumn(np.array([1, -2**63, 2**63 - 1, 0]), mask=[True, False, False, False])
t['speed'] = MaskedColumn([61.5, 1e-300, 1e300, -0.1], mask=[False, True, False, False],
                          unit='m/s', description='how fast: "x" # y', format='%.3f')
t['word'] = MaskedColumn(['a,b', 'say "x"', '#1', 'q'], mask=[False, False, False, True])
t['turn'] = np.array([1.0, 0.1, 2.0 / 3.0, 136.97757427512])
t['turn'].unit = 'deg'
t['speed'].meta['required'] = True
t['speed'].info.format = None
t.meta = MAP(schema=MAP(name='x', version='1.0'), ordered=OrderedDict(b=1, a=OrderedDict(z='1.0')),
             plain={'list': [1, 2.5, None, True, OrderedDict(k='yes')]},
             text='\u00b5 \U0001F600 2026-11-21')
t.write(sys.argv[1], format='ascii.ecsv', delimiter=',')
)";

TEST_F(EcsvAstropy, WeReadWhatItWrites) {
    for (const char* map : {"dict", "OrderedDict"}) {
        SCOPED_TRACE(map);
        std::filesystem::remove(file());
        std::string script = make;
        for (std::size_t at; (at = script.find("MAP")) != std::string::npos;)
            script.replace(at, 3, map);
        python(script, {file()});
        const std::string text = test::slurp(file());
        EcsvReader in(text, "t.ecsv");
        ASSERT_EQ(in.columns().size(), 5U);
        EXPECT_EQ(in.columns()[2].unit, "m / s");
        EXPECT_EQ(in.columns()[2].description, "how fast: \"x\" # y");
        EXPECT_EQ(in.columns()[4].unit, "deg");
        const YamlNode& meta = in.meta();
        EXPECT_EQ(meta["schema"]["name"].scalar(), "x");
        EXPECT_EQ(meta["ordered"]["a"]["z"].scalar(), "1.0");
        EXPECT_EQ(meta["plain"]["list"][4]["k"].scalar(), "yes");
        EXPECT_EQ(meta["text"].scalar(), "\xc2\xb5 \xf0\x9f\x98\x80 2026-11-21");

        ASSERT_TRUE(in.next_row());
        EXPECT_TRUE(in.boolean(0));
        EXPECT_TRUE(in.is_missing(1));
        EXPECT_EQ(in.real(2), 61.5);
        EXPECT_EQ(in.text(3), "a,b");
        EXPECT_EQ(in.real(4), 1.0);
        ASSERT_TRUE(in.next_row());
        EXPECT_FALSE(in.boolean(0));
        EXPECT_EQ(in.integer(1), INT64_MIN);
        EXPECT_TRUE(in.is_missing(2));
        EXPECT_EQ(in.text(3), "say \"x\"");
        EXPECT_EQ(in.seconds(4), 100'000'000);
        ASSERT_TRUE(in.next_row());
        EXPECT_EQ(in.integer(1), INT64_MAX);
        EXPECT_EQ(in.real(2), 1e300);
        EXPECT_EQ(in.text(3), "#1");
        EXPECT_EQ(in.real(4), 2.0 / 3.0);
        ASSERT_TRUE(in.next_row());
        EXPECT_TRUE(in.is_missing(0));
        EXPECT_EQ(in.real(2), -0.1);
        EXPECT_TRUE(in.is_missing(3));
        EXPECT_EQ(in.real(4), 136.97757427512);
        EXPECT_FALSE(in.next_row());
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
